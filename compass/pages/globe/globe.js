// A globe of Mars that one can turn: what it shows, and how it obeys. No library and no network.
class Globe extends Drawing {
  constructor(root) {
    super();
    this.root = root;
    const scene = this.scene = JSON.parse(root.querySelector("script").textContent);
    scene.path = unpack(scene.path, Float32Array);
    this.relief = unpack(scene.relief, Uint8Array);
    if (scene.worth) {
      scene.worth.covariance = unpack(scene.worth.covariance, Float64Array);
      scene.worth.lit = unpack(scene.worth.lit, Float64Array);
      scene.worth.sun = unpack(scene.worth.sun, Float64Array);
    }
    this.graded = Object.fromEntries(scene.fields.map(field => [field.name, field]));
    this.shades = [...scene.shades, scene.none];  // the last where there is no fix
    this.sinMask = Math.sin(scene.mask_deg * RAD);
    this.cells = [];
    for (let i = 0; i < ROWS; i++)
      for (let j = 0; j < COLUMNS; j++)
        this.cells.push(place(scene, (89 - 2 * i) * RAD, (1 + 2 * j) * RAD, 0));
    this.stations = scene.stations.map(s => ({...s, ...place(
      scene, s.latitude_deg * RAD, s.longitude_deg * RAD, s.height_km),
      sinMask: Math.sin(s.mask_deg * RAD)}));
    this.values = new Uint8Array(ROWS * COLUMNS);
    this.time = 0; this.lon = 20 * RAD; this.lat = 25 * RAD; this.zoom = 1; this.playing = false;
    this.asked = null;  // where on the disc values are wanted, in radii; the middle by the keyboard
    this.canvas = root.querySelector("canvas");
    this.readout = root.querySelector(".readout");
    this.disc = document.createElement("canvas");
    this.part = name => root.querySelector(`[name=${name}]`);
    this.listen();
    root.closest("figure")?.querySelector("img.still")?.classList.add("paper-only");
    root.hidden = false;
    this.legend(); this.fit(); this.move(0);
  }

  listen() {
    const on = (what, name, act) => what.addEventListener(name, act);
    on(this.part("play"), "click", () => this.play(!this.playing));
    on(this.part("time"), "input", e => this.move(Number(e.target.value)));
    on(this.part("far"), "click", () => { this.zoom = this.zoom > .5 ? this.far() : 1; this.draw(); });
    for (const name of ["field", "caps", "tracks", "gaps", "stars"])
      if (this.part(name)) on(this.part(name), "change", () => { this.legend(); this.move(this.time); });
    on(this.canvas, "keydown", e => this.key(e));
    on(this.canvas, "pointerdown", e => {
      this.held = [e.clientX, e.clientY]; this.canvas.setPointerCapture(e.pointerId);
    });
    on(this.canvas, "pointerup", () => { this.held = null; });
    on(this.canvas, "pointercancel", () => { this.held = null; });
    on(this.canvas, "pointermove", e => this.pointed(e));
    on(this.canvas, "pointerleave", () => { this.asked = null; this.tell(); });
    on(this.canvas, "blur", () => { this.asked = null; this.draw(); });
    on(this.canvas, "wheel", e => {  // until it is clicked, the wheel scrolls the page
      if (document.activeElement !== this.canvas) return;
      e.preventDefault(); this.zoomed(Math.exp(-e.deltaY / 600));
    });
    new ResizeObserver(() => { this.fit(); this.draw(); }).observe(this.canvas);
  }

  key(e) {
    const act = {
      ArrowLeft: () => this.turn(-.1, 0), ArrowRight: () => this.turn(.1, 0),
      ArrowUp: () => this.turn(0, .1), ArrowDown: () => this.turn(0, -.1),
      "+": () => this.zoomed(1.15), "-": () => this.zoomed(1 / 1.15),
      " ": () => this.play(!this.playing),
    }[e.key];
    if (!act) return;
    e.preventDefault();
    this.asked = [0, 0];
    act();
  }

  far() {  // Mars's radius over the farthest satellite's, with a rim
    let most = 0;
    for (let j = 0; j < this.scene.path.length; j += 3)
      most = Math.max(most, Math.hypot(this.scene.path[j], this.scene.path[j + 1], this.scene.path[j + 2]));
    return .94 * this.scene.equatorial_km / most;
  }

  turn(lon, lat) {
    this.lon += lon; this.lat = Math.min(Math.max(this.lat + lat, -Math.PI / 2), Math.PI / 2);
    this.draw();
  }

  zoomed(factor) { this.zoom = Math.min(Math.max(this.zoom * factor, .03), 6); this.draw(); }

  play(on) {
    this.playing = on;
    this.part("play").textContent = on ? "Pause" : "Play";
    this.readout.ariaLive = on ? "off" : "polite";
    let last = performance.now();
    const step = now => {
      if (!this.playing) return;
      const next = this.time + (now - last) / 24000 * this.scene.duration_s;
      last = now;
      this.move(next > this.scene.duration_s ? 0 : next);
      requestAnimationFrame(step);
    };
    if (on) requestAnimationFrame(step);
  }

  move(time) {
    this.time = time;
    const slider = this.part("time");
    slider.value = time;
    const h = Math.floor(time / 3600), m = Math.floor(time % 3600 / 60);
    const words = `${h} h ${String(m).padStart(2, "0")} min`;
    this.root.querySelector("output").textContent = words;
    slider.setAttribute("aria-valuetext", `${words} after the epoch`);
    this.sky = new Sky(this.scene, time);
    this.paint(); this.draw();
  }

  at(latitude, longitude, time) {  // of any place on the surface, degrees
    const sky = time === this.time ? this.sky : new Sky(this.scene, time);
    return sky.seen(place(this.scene, latitude * RAD, longitude * RAD, 0), this.sinMask);
  }

  paint() {
    const field = this.part("field").value, {sky, sinMask} = this;
    if (field === "relief") return;
    const graded = this.graded[field], last = this.scene.count_colours.length - 1;
    this.cells.forEach((cell, k) => {
      const value = sky.value(field, cell, sinMask);
      this.values[k] = graded ? this.shadeOf(graded, value) : Math.min(value, last);
    });
  }

  shadeOf({range: [low, high]}, value) {
    const shades = this.shades.length - 1;
    if (!Number.isFinite(value)) return shades;
    return within(Math.floor(Math.log(value / low) / Math.log(high / low) * shades), 0, shades - 1);
  }

  legend() {
    const field = this.part("field").value, box = this.root.querySelector(".legend");
    const swatch = (colour, words) => {
      const item = document.createElement("span"), patch = document.createElement("i");
      patch.style.background = `rgb(${colour})`;
      item.append(patch, words);
      return item;
    };
    const graded = this.graded[field], {count_colours: counts, none} = this.scene;
    box.replaceChildren(...(
      graded ? [...graded.ticks.map(v => swatch(this.shades[this.shadeOf(graded, v * 1.0001)], this.words(graded, v))),
                swatch(none, "no fix")] :
      field === "count" ? counts.map((x, k) => swatch(x, k === counts.length - 1 && k < this.scene.names.length ? `${k} or more` : `${k}`)) : []));
  }

  words({unit}, value) {
    if (!Number.isFinite(value)) return "none";
    return `${Number(value.toPrecision(3))}${unit && ` ${unit}`}`;
  }

  fit() {
    const size = Math.max(Math.round(this.canvas.clientWidth * Math.min(devicePixelRatio, 2)), 200);
    if (this.canvas.width !== size) this.canvas.width = this.canvas.height = size;
  }

  pointed(e) {
    const box = this.canvas.getBoundingClientRect(), scale = this.canvas.width / box.width;
    if (this.held) {
      const turn = scale / this.radius;
      const [dx, dy] = [e.clientX - this.held[0], e.clientY - this.held[1]];
      this.held = [e.clientX, e.clientY];
      this.turn(-dx * turn, dy * turn);
      return;
    }
    this.asked = [((e.clientX - box.left) * scale - this.canvas.width / 2) / this.radius,
                  (this.canvas.height / 2 - (e.clientY - box.top) * scale) / this.radius];
    this.tell();
  }

  // Values of the place that is pointed at, or in the middle for who steers by the keyboard.
  tell() {
    const [x, y] = this.asked ?? [1, 1], {readout} = this;
    if (x * x + y * y >= 1) { readout.textContent = readout.dataset.hint; return; }
    const z = Math.sqrt(1 - x * x - y * y), v = [0, 1, 2].map(i => x * this.axes[0][i] + y * this.axes[1][i] + z * this.axes[2][i]);
    const lat = Math.asin(within(v[2], -1, 1)) / RAD, lon = Math.atan2(v[1], v[0]) / RAD;
    const found = this.at(lat, lon, this.time);
    const values = Object.values(this.graded).map(field => `${field.title} ${this.words(field, found[field.name])}`);
    readout.textContent = `${Math.abs(lat).toFixed(1)}° ${lat < 0 ? "S" : "N"}, ${Math.abs(lon).toFixed(1)}° ${lon < 0 ? "W" : "E"}: ${found.count} in view, ${values.join(", ")}`;
  }
}

addEventListener("DOMContentLoaded", () => {
  for (const root of document.querySelectorAll(".globe")) root.globe = new Globe(root);
});

// A globe of Mars that one can turn: what the satellites see at a moment, computed here from their
// paths by the same formulas as the maps. No library and no network; a plain 2-D canvas.
"use strict";
(() => {
const ROWS = 90, COLUMNS = 180, RAD = Math.PI / 180;
const unpack = (text, Kind) => {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  return new Kind(bytes.buffer);
};
const turned = (v, angle) => {  // about the spin axis
  const c = Math.cos(angle), s = Math.sin(angle);
  return [c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]];
};

// Surface points of the figure with their verticals, by cell and for any place; km.
function place(scene, latitude, longitude, height) {
  const a = scene.equatorial_km, b = scene.polar_km;
  const u = [Math.cos(latitude) * Math.cos(longitude), Math.cos(latitude) * Math.sin(longitude),
             Math.sin(latitude)];
  const r = 1 / Math.sqrt((u[0] * u[0] + u[1] * u[1]) / (a * a) + u[2] * u[2] / (b * b));
  const n = [u[0] / (a * a), u[1] / (a * a), u[2] / (b * b)];
  const long = Math.hypot(...n);
  const up = n.map(x => x / long);
  return {p: u.map((x, k) => r * x + height * up[k]), up};
}

// Where the satellites are at a time: a cubic through four samples of each path, Mars-fixed km.
function positions(scene, time) {
  const at = Math.min(Math.max(time / scene.step_s, 0), scene.samples - 1.000001);
  const k = Math.floor(at), f = at - k, n = 3 * scene.names.length, out = new Float64Array(n);
  const row = j => Math.min(Math.max(j, 0), scene.samples - 1) * n;
  const [before, here, next, after] = [row(k - 1), row(k), row(k + 1), row(k + 2)];
  const p = scene.path;
  for (let j = 0; j < n; j++) {
    const p1 = p[here + j], p2 = p[next + j];
    const p0 = k > 0 ? p[before + j] : 3 * p1 - 3 * p2 + p[after + j];
    const p3 = k < scene.samples - 2 ? p[after + j] : 3 * p2 - 3 * p1 + p[before + j];
    out[j] = p0 * (-f * (f - 1) * (f - 2)) / 6 + p1 * ((f + 1) * (f - 1) * (f - 2)) / 2 +
             p2 * (-(f + 1) * f * (f - 2)) / 2 + p3 * ((f + 1) * f * (f - 1)) / 6;
  }
  return out;
}

// How many satellites a place sees above the mask, and its GDOP: sqrt of the trace of the inverse
// of H^T H, rows of H being (direction, 1); infinite with fewer than four or singular geometry.
function seen(satellites, p, up, sinMask, wantDop) {
  let count = 0;
  const m = new Float64Array(10);
  for (let j = 0; j < satellites.length; j += 3) {
    const x = satellites[j] - p[0], y = satellites[j + 1] - p[1], z = satellites[j + 2] - p[2];
    const d = Math.sqrt(x * x + y * y + z * z);
    if (x * up[0] + y * up[1] + z * up[2] < sinMask * d) continue;
    count++;
    if (wantDop) {
      const a = x / d, b = y / d, c = z / d;
      m[0] += a * a; m[1] += a * b; m[2] += a * c; m[3] += a; m[4] += b * b; m[5] += b * c;
      m[6] += b; m[7] += c * c; m[8] += c; m[9] += 1;
    }
  }
  return {count, gdop: wantDop && count > 3 ? gdop(m) : Infinity};
}

// Cholesky's factor L of the 4 by 4 matrix; the trace of the inverse is the sum of squares of 1/L.
function gdop(m) {
  const a = [[m[0]], [m[1], m[4]], [m[2], m[5], m[7]], [m[3], m[6], m[8], m[9]]];
  for (let i = 0; i < 4; i++) {
    for (let j = 0; j <= i; j++) {
      let s = a[i][j];
      for (let k = 0; k < j; k++) s -= a[i][k] * a[j][k];
      if (i === j) {
        if (s < 1e-12) return Infinity;
        a[i][i] = Math.sqrt(s);
      } else a[i][j] = s / a[j][j];
    }
  }
  let trace = 0;
  for (let column = 0; column < 4; column++) {
    const w = [0, 0, 0, 0];
    for (let i = column; i < 4; i++) {
      let s = i === column ? 1 : 0;
      for (let k = column; k < i; k++) s -= a[i][k] * w[k];
      w[i] = s / a[i][i];
      trace += w[i] * w[i];
    }
  }
  return Math.sqrt(trace);
}

class Globe {
  constructor(root) {
    this.root = root;
    const scene = this.scene = JSON.parse(root.querySelector("script").textContent);
    scene.path = unpack(scene.path, Float32Array);
    this.relief = unpack(scene.relief, Uint8Array);
    this.colours = {count: scene.count_colours, gdop: scene.gdop_colours};
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
    this.canvas = root.querySelector("canvas");
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
    on(this.canvas, "wheel", e => {
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
    if (act) { e.preventDefault(); act(); }
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
    this.satellites = positions(this.scene, time);
    this.paint(); this.draw();
  }

  at(latitude, longitude, time) {  // of any place on the surface, degrees
    const {p, up} = place(this.scene, latitude * RAD, longitude * RAD, 0);
    return seen(positions(this.scene, time), p, up, this.sinMask, true);
  }

  paint() {
    const field = this.part("field").value;
    if (field === "relief") return;
    const dop = field === "gdop", last = this.colours[field].length - 1;
    this.cells.forEach((cell, k) => {
      const found = seen(this.satellites, cell.p, cell.up, this.sinMask, dop);
      this.values[k] = dop ? this.dopColour(found.gdop) : Math.min(found.count, last);
    });
  }

  dopColour(value) {
    if (!Number.isFinite(value)) return this.colours.gdop.length - 1;  // grey
    const [low, high] = this.scene.gdop_range, shades = this.colours.gdop.length - 1;
    const share = Math.log(value / low) / Math.log(high / low);
    return Math.min(Math.max(Math.floor(share * shades), 0), shades - 1);
  }

  legend() {
    const field = this.part("field").value, box = this.root.querySelector(".legend");
    const swatch = (colour, words) => {
      const item = document.createElement("span"), patch = document.createElement("i");
      patch.style.background = `rgb(${colour})`;
      item.append(patch, words);
      return item;
    };
    const c = this.colours;
    box.replaceChildren(...(
      field === "count" ? c.count.map((x, k) => swatch(x, k === c.count.length - 1 ? `${k} or more` : `${k}`)) :
      field === "gdop" ? [...this.scene.gdop_ticks.map(v => swatch(c.gdop[this.dopColour(v * 1.0001)], `${v}`)),
                          swatch(c.gdop[c.gdop.length - 1], "none")] : []));
  }

  fit() {
    const size = Math.max(Math.round(this.canvas.clientWidth * Math.min(devicePixelRatio, 2)), 200);
    if (this.canvas.width !== size) this.canvas.width = this.canvas.height = size;
  }

  // axes of the view, Mars-fixed: to the right, up, and out towards the viewer
  view() {
    const stars = this.part("stars").checked;
    const lon = this.lon - (stars ? this.scene.spin_rad_s * this.time : 0);
    const [cl, sl, cf, sf] = [Math.cos(lon), Math.sin(lon), Math.cos(this.lat), Math.sin(this.lat)];
    return [[-sl, cl, 0], [-sf * cl, -sf * sl, cf], [cf * cl, cf * sl, sf]];
  }

  draw() {
    const g = this.canvas.getContext("2d"), size = this.canvas.width;
    this.axes = this.view();
    this.radius = .47 * size * this.zoom;
    g.fillStyle = "#0e1116"; g.fillRect(0, 0, size, size);
    g.lineJoin = "round"; g.font = `${Math.round(size / 42)}px system-ui, sans-serif`;
    if (this.zoom < .5) this.orbits(g, false);
    this.surface(g, size);
    this.grid(g);
    if (this.part("gaps")?.checked) this.gaps(g);
    if (this.part("tracks").checked) this.tracks(g);
    if (this.part("caps").checked) this.caps(g);
    this.marks(g);
    if (this.zoom < .5) this.orbits(g, true);
    this.dots(g);
  }

  surface(g, size) {
    const across = Math.min(Math.round(2 * this.radius), 420), [right, up, out] = this.axes;
    if (across < 4) return;
    this.disc.width = this.disc.height = across;
    const pen = this.disc.getContext("2d"), image = pen.createImageData(across, across);
    const field = this.part("field").value, half = across / 2, data = image.data;
    for (let row = 0, k = 0; row < across; row++) {
      const y = (half - row - .5) / half;
      for (let column = 0; column < across; column++, k += 4) {
        const x = (column + .5 - half) / half, rest = 1 - x * x - y * y;
        if (rest <= 0) continue;
        const z = Math.sqrt(rest);
        const vx = x * right[0] + y * up[0] + z * out[0], vy = x * right[1] + y * up[1] + z * out[1];
        const vz = y * up[2] + z * out[2];
        const down = (Math.PI / 2 - Math.asin(Math.max(-1, Math.min(1, vz)))) / RAD;
        let east = Math.atan2(vy, vx) / RAD;
        if (east < 0) east += 360;
        const shade = this.shade(down, east), cell = Math.min(down >> 1, ROWS - 1) * COLUMNS + Math.min(east >> 1, COLUMNS - 1);
        const colour = field === "relief" ? [214, 138, 100] : this.colours[field][this.values[cell]];
        const light = (field === "relief" ? .35 + .9 * shade : .72 + .4 * shade) * (.55 + .45 * Math.sqrt(z));
        data[k] = colour[0] * light; data[k + 1] = colour[1] * light; data[k + 2] = colour[2] * light;
        data[k + 3] = 255;
      }
    }
    pen.putImageData(image, 0, 0);
    const r = this.radius;
    g.imageSmoothingEnabled = true;
    g.drawImage(this.disc, size / 2 - r, size / 2 - r, 2 * r, 2 * r);
  }

  shade(down, east) {  // relief between its four nearest cells, 0 to 1
    const r = Math.min(Math.max((down - 1) / 2, 0), ROWS - 1.001), c = ((east - 1) / 2 + COLUMNS) % COLUMNS;
    const i = Math.floor(r), j = Math.floor(c), f = r - i, e = c - j, next = (j + 1) % COLUMNS, t = this.relief;
    return ((t[i * COLUMNS + j] * (1 - e) + t[i * COLUMNS + next] * e) * (1 - f) +
            (t[(i + 1) * COLUMNS + j] * (1 - e) + t[(i + 1) * COLUMNS + next] * e) * f) / 255;
  }

  // canvas place of a Mars-fixed point in radii; the third is towards the viewer
  project(v) {
    const half = this.canvas.width / 2, dot = a => a[0] * v[0] + a[1] * v[1] + a[2] * v[2];
    return [half + this.radius * dot(this.axes[0]), half - this.radius * dot(this.axes[1]), dot(this.axes[2])];
  }

  // a line over points; only what the globe does not hide
  line(g, points, colour, width, hides = (p, v) => p[2] < 0) {
    g.strokeStyle = colour; g.lineWidth = width * this.canvas.width / 600;
    g.beginPath();
    let down = false;
    for (const v of points) {
      const p = this.project(v);
      if (hides(p, v)) { down = false; continue; }
      if (down) g.lineTo(p[0], p[1]); else g.moveTo(p[0], p[1]);
      down = true;
    }
    g.stroke();
  }

  behind(p) {  // hidden by the disc
    const half = this.canvas.width / 2;
    return p[2] < 0 && Math.hypot(p[0] - half, p[1] - half) < this.radius;
  }

  grid(g) {
    const on = (lat, lon) => [Math.cos(lat) * Math.cos(lon), Math.cos(lat) * Math.sin(lon), Math.sin(lat)];
    const steps = Array.from({length: 91}, (_, k) => k);
    for (let lon = 0; lon < 360; lon += 30)
      this.line(g, steps.map(k => on((2 * k - 90) * RAD, lon * RAD)), "rgba(255,255,255,.22)", .7);
    for (let lat = -60; lat <= 60; lat += 30)
      this.line(g, steps.map(k => on(lat * RAD, 4 * k * RAD)), "rgba(255,255,255,.22)", .7);
  }

  unit(k) {
    const s = this.satellites, d = Math.hypot(s[3 * k], s[3 * k + 1], s[3 * k + 2]);
    return {u: [s[3 * k] / d, s[3 * k + 1] / d, s[3 * k + 2] / d], d};
  }

  caps(g) {
    const mask = this.scene.mask_deg * RAD;
    this.scene.names.forEach((_, n) => {
      const {u, d} = this.unit(n);
      const cap = Math.acos(this.scene.equatorial_km * Math.cos(mask) / d) - mask;
      const side = Math.abs(u[2]) < .9 ? [u[1], -u[0], 0] : [0, u[2], -u[1]];
      const long = Math.hypot(...side), a = side.map(x => x / long);
      const b = [u[1] * a[2] - u[2] * a[1], u[2] * a[0] - u[0] * a[2], u[0] * a[1] - u[1] * a[0]];
      const rim = Array.from({length: 121}, (_, k) => {
        const c = Math.cos(k * 3 * RAD), s = Math.sin(k * 3 * RAD), w = Math.sin(cap);
        return u.map((x, i) => x * Math.cos(cap) + w * (c * a[i] + s * b[i]));
      });
      this.line(g, rim, this.scene.sky[this.scene.groups[n]], 1.1);
    });
  }

  tracks(g) {
    const {path, samples, names} = this.scene, every = Math.max(1, Math.floor(samples / 600));
    names.forEach((_, n) => {
      const points = [];
      for (let k = 0; k < samples; k += every) {
        const j = 3 * (k * names.length + n), d = Math.hypot(path[j], path[j + 1], path[j + 2]);
        points.push([path[j] / d, path[j + 1] / d, path[j + 2] / d]);
      }
      this.line(g, points, this.scene.sky[this.scene.groups[n]], .9);
    });
  }

  // gap polygons turn with their plane's satellites, and Mars turns below them
  gaps(g) {
    for (const gap of this.scene.gaps) {
      const angle = gap.rate_rad_s * this.time, [c, s] = [Math.cos(angle), Math.sin(angle)], k = gap.pole;
      const outline = gap.outline.map(v => {
        const dot = (k[0] * v[0] + k[1] * v[1] + k[2] * v[2]) * (1 - c);
        const cross = [k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2], k[0] * v[1] - k[1] * v[0]];
        const now = v.map((x, i) => x * c + cross[i] * s + k[i] * dot);
        return turned(now, -(this.scene.meridian_rad + this.scene.spin_rad_s * this.time));
      });
      this.line(g, outline, "#ffffff", 2);
    }
  }

  // orbits as they stand among the stars at this moment, to scale
  orbits(g, front) {
    const {path, samples, step_s, names, periods_s, equatorial_km, spin_rad_s} = this.scene;
    names.forEach((_, n) => {
      const points = [], most = Math.min(samples - 1, Math.ceil(periods_s[n] / step_s));
      for (let k = 0; k <= most; k++) {
        const j = 3 * (k * names.length + n);
        const v = [path[j] / equatorial_km, path[j + 1] / equatorial_km, path[j + 2] / equatorial_km];
        points.push(turned(v, spin_rad_s * (k * step_s - this.time)));
      }
      const hides = p => (p[2] < 0) === front || this.behind(p);
      this.line(g, points, this.scene.sky[this.scene.groups[n]], front ? 1.3 : .7, hides);
    });
  }

  label(g, words, x, y) {
    const long = g.measureText(words).width;
    if (x + long > this.canvas.width) x -= long + this.canvas.width / 40;
    g.lineWidth = this.canvas.width / 200; g.strokeStyle = "rgba(14,17,22,.8)"; g.fillStyle = "#fff";
    g.strokeText(words, x, y); g.fillText(words, x, y);
  }

  dot(g, x, y, size, colour) {
    g.beginPath(); g.arc(x, y, size * this.canvas.width / 600, 0, 7); g.fillStyle = colour; g.fill();
    g.strokeStyle = "#fff"; g.lineWidth = this.canvas.width / 500; g.stroke();
  }

  marks(g) {
    const shift = this.canvas.width / 75;
    if (this.zoom > .5) for (const [name, lat, lon] of this.scene.places) {
      const p = this.project([Math.cos(lat * RAD) * Math.cos(lon * RAD), Math.cos(lat * RAD) * Math.sin(lon * RAD), Math.sin(lat * RAD)]);
      if (p[2] < .25) continue;
      this.dot(g, p[0], p[1], 1.5, "#fff"); this.label(g, name, p[0] + shift / 2, p[1] - shift / 3);
    }
    for (const s of this.stations) {
      const long = Math.hypot(...s.p), p = this.project(s.p.map(x => x / long));
      const found = seen(this.satellites, s.p, s.up, s.sinMask, true);
      s.now = found;
      if (p[2] < 0) continue;
      const size = this.canvas.width / 75, enough = found.count >= this.scene.fold;
      g.fillStyle = enough ? "#3ddc84" : "#ff5c4d"; g.strokeStyle = "#0e1116"; g.lineWidth = size / 6;
      g.beginPath(); g.rect(p[0] - size / 2, p[1] - size / 2, size, size); g.fill(); g.stroke();
      if (this.zoom > .5) this.label(g, `${s.name}: ${found.count}`, p[0] + shift, p[1] + shift / 2);
    }
    const words = this.stations.map(s => `${s.name} sees ${s.now.count}`).join(", ");
    this.root.querySelector(".stations").textContent = words;
  }

  dots(g) {
    const few = this.scene.names.length <= 30;
    this.scene.names.forEach((name, n) => {
      const {u, d} = this.unit(n), far = this.zoom < .5;
      const p = this.project(far ? u.map(x => x * d / this.scene.equatorial_km) : u);
      if (far ? this.behind(p) : p[2] < 0) return;
      this.dot(g, p[0], p[1], 4, this.scene.sky[this.scene.groups[n]]);
      if (few) this.label(g, name, p[0] + this.canvas.width / 90, p[1] - this.canvas.width / 120);
    });
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
    const x = ((e.clientX - box.left) * scale - this.canvas.width / 2) / this.radius;
    const y = (this.canvas.height / 2 - (e.clientY - box.top) * scale) / this.radius;
    const readout = this.root.querySelector(".readout");
    if (x * x + y * y >= 1) { readout.textContent = readout.dataset.hint; return; }
    const z = Math.sqrt(1 - x * x - y * y), v = [0, 1, 2].map(i => x * this.axes[0][i] + y * this.axes[1][i] + z * this.axes[2][i]);
    const lat = Math.asin(v[2]) / RAD, lon = Math.atan2(v[1], v[0]) / RAD;
    const found = this.at(lat, lon, this.time);
    const dop = Number.isFinite(found.gdop) ? found.gdop.toPrecision(3) : "none";
    readout.textContent = `latitude ${lat.toFixed(1)}°, longitude ${lon.toFixed(1)}° E: ${found.count} in view, GDOP ${dop}`;
  }
}

addEventListener("DOMContentLoaded", () => {
  for (const root of document.querySelectorAll(".globe")) root.globe = new Globe(root);
});
})();

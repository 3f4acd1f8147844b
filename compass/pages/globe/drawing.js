// The globe as it is drawn at a moment, on a plain 2-D canvas.
const ROWS = 90, COLUMNS = 180;

class Drawing {
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
    if (this.asked?.every(x => x === 0)) this.crosshair(g, size / 2);
    this.tell();
  }

  crosshair(g, half) {  // what the keyboard points at
    const arm = half / 18;
    g.strokeStyle = "#fff"; g.lineWidth = half / 150;
    g.beginPath();
    for (const [x, y] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
      g.moveTo(half + .3 * arm * x, half + .3 * arm * y); g.lineTo(half + arm * x, half + arm * y);
    }
    g.stroke();
  }

  surface(g, size) {
    const across = Math.min(Math.round(2 * this.radius), 420), [right, up, out] = this.axes;
    if (across < 4) return;
    this.disc.width = this.disc.height = across;
    const pen = this.disc.getContext("2d"), image = pen.createImageData(across, across);
    const field = this.part("field").value, half = across / 2, data = image.data;
    const colours = field === "count" ? this.scene.count_colours : this.shades;
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
        const colour = field === "relief" ? [214, 138, 100] : colours[this.values[cell]];
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
    const half = this.canvas.width / 2, [right, up, out] = this.axes;
    return [half + this.radius * dot(right, v), half - this.radius * dot(up, v), dot(out, v)];
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

  above(k) {  // the zenith of a satellite, and how far it is from the centre
    const {r} = this.sky, v = [r[3 * k], r[3 * k + 1], r[3 * k + 2]];
    return {u: unit(v), d: Math.hypot(...v)};
  }

  caps(g) {
    const mask = this.scene.mask_deg * RAD;
    this.scene.names.forEach((_, n) => {
      const {u, d} = this.above(n);
      const cap = Math.acos(this.scene.equatorial_km * Math.cos(mask) / d) - mask;
      const a = unit(Math.abs(u[2]) < .9 ? [u[1], -u[0], 0] : [0, u[2], -u[1]]), b = cross(u, a);
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
        const along = dot(k, v) * (1 - c), across = cross(k, v);
        const now = v.map((x, i) => x * c + across[i] * s + k[i] * along);
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
    const graded = this.graded[this.part("field").value];
    for (const s of this.stations) {
      const p = this.project(unit(s.p));
      s.now = this.sky.seen(s, s.sinMask);
      if (p[2] < 0) continue;
      const size = this.canvas.width / 75, enough = s.now.count >= this.scene.fold;
      g.fillStyle = enough ? "#3ddc84" : "#ff5c4d"; g.strokeStyle = "#0e1116"; g.lineWidth = size / 6;
      g.beginPath(); g.rect(p[0] - size / 2, p[1] - size / 2, size, size); g.fill(); g.stroke();
      const value = graded ? this.words(graded, s.now[graded.name]) : s.now.count;
      if (this.zoom > .5) this.label(g, `${s.name}: ${value}`, p[0] + shift, p[1] + shift / 2);
    }
    const words = this.stations.map(s => `${s.name} sees ${s.now.count}` +
      (graded ? `, ${graded.title} ${this.words(graded, s.now[graded.name])}` : "")).join("; ");
    this.root.querySelector(".stations").textContent = words;
  }

  dots(g) {
    const few = this.scene.names.length <= 30;
    this.scene.names.forEach((name, n) => {
      const {u, d} = this.above(n), far = this.zoom < .5;
      const p = this.project(far ? u.map(x => x * d / this.scene.equatorial_km) : u);
      if (far ? this.behind(p) : p[2] < 0) return;
      this.dot(g, p[0], p[1], 4, this.scene.sky[this.scene.groups[n]]);
      if (few) this.label(g, name, p[0] + this.canvas.width / 90, p[1] - this.canvas.width / 120);
    });
  }
}

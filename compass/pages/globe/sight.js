// What a place sees at a moment and what its fix is worth there, computed here from the satellites'
// paths by the same formulas as the maps: compass/core/dop.py and error.py.
"use strict";
const RAD = Math.PI / 180, EPS = 2 ** -52;
const unpack = (text, Kind) => {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  return new Kind(bytes.buffer);
};
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = v => { const long = Math.hypot(...v); return v.map(x => x / long); };
const within = (x, low, high) => Math.min(Math.max(x, low), high);
const turned = (v, angle) => {  // about the spin axis
  const c = Math.cos(angle), s = Math.sin(angle);
  return [c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]];
};

// Where a surface point of the figure is, km, and which way is up there.
function place(scene, latitude, longitude, height) {
  const a = scene.equatorial_km, b = scene.polar_km;
  const u = [Math.cos(latitude) * Math.cos(longitude), Math.cos(latitude) * Math.sin(longitude),
             Math.sin(latitude)];
  const r = 1 / Math.sqrt((u[0] * u[0] + u[1] * u[1]) / (a * a) + u[2] * u[2] / (b * b));
  const up = unit([u[0] / (a * a), u[1] / (a * a), u[2] / (b * b)]);
  return {p: u.map((x, k) => r * x + height * up[k]), up};
}

// Where the satellites are at a time and how they move, Mars-fixed, km and km/s: a cubic through the
// four samples of each path about it.
function states(scene, time) {
  const {path, samples, step_s} = scene, n = 3 * scene.names.length;
  const at = within(time / step_s, 0, samples - 1);
  const first = within(Math.floor(at) - 1, 0, samples - 4), s = at - first;
  const r = new Float64Array(n), v = new Float64Array(n);
  for (let i = 0; i < 4; i++) {
    let weight = 1, rate = 0;
    for (let j = 0; j < 4; j++) {
      if (j === i) continue;
      rate = (rate * (s - j) + weight) / (i - j);
      weight *= (s - j) / (i - j);
    }
    for (let k = 0; k < n; k++) {
      r[k] += weight * path[(first + i) * n + k];
      v[k] += rate / step_s * path[(first + i) * n + k];
    }
  }
  return {r, v};
}

// GDOP, and the sigmas of position, horizontal, height and time: of weighted moments of lines of
// sight, in closed form; with weights of 1 dilutions.
function dops(m, up) {
  const [n, xx, yy, zz, xy, xz, yz, x, y, z] = m, w = 1 / n;
  const a = xx - x * x * w, b = yy - y * y * w, c = zz - z * z * w;
  const d = xy - x * y * w, e = xz - x * z * w, f = yz - y * z * w;
  const aa = b * c - f * f, bb = a * c - e * e, cc = a * b - d * d;
  const ab = e * f - d * c, ac = d * f - e * b, bc = d * e - a * f;
  const det = a * aa + d * ab + e * ac;
  if (!(det > 64 * EPS * n * n * n)) return Array(5).fill(Infinity);
  const form = v => (aa * v[0] * v[0] + bb * v[1] * v[1] + cc * v[2] * v[2] +
                     2 * (ab * v[0] * v[1] + ac * v[0] * v[2] + bc * v[1] * v[2])) / det;
  const position = (aa + bb + cc) / det, height = form(up), time = w + form([x, y, z]) * w * w;
  return [position + time, position, position - height, height, time].map(v => Math.sqrt(Math.max(v, 0)));
}

// What the satellites are at a moment for those who look up.
class Sky {
  constructor(scene, time) {
    this.time = time;
    Object.assign(this, states(scene, time));
    this.worth = scene.worth;
    if (!this.worth) return;
    const spin = scene.spin_rad_s, {sun} = this.worth, days = sun.length / 3 - 1;
    this.axes = scene.names.map((_, k) => {  // radial, along, cross of orbits among the stars
      const [x, y, z] = this.r.subarray(3 * k, 3 * k + 3), [vx, vy, vz] = this.v.subarray(3 * k, 3 * k + 3);
      const radial = unit([x, y, z]), side = unit(cross(radial, [vx - spin * y, vy + spin * x, vz]));
      return [radial, cross(side, radial), side];
    });
    const at = within(time / scene.duration_s, 0, 1) * days, k = Math.min(Math.floor(at), days - 1);
    const between = [0, 1, 2].map(i => sun[3 * k + i] * (k + 1 - at) + sun[3 * k + 3 + i] * (at - k));
    this.sun = turned(unit(between), -(scene.meridian_rad + spin * time));
  }

  // How many a place sees above the mask; `m` gets the moments of their lines of sight, each
  // weighed by `weigh` of satellite, line of sight, distance and sine of the elevation.
  look({p, up}, sinMask, m, weigh) {
    let count = 0;
    m.fill(0);
    for (let j = 0; j < this.r.length; j += 3) {
      let x = this.r[j] - p[0], y = this.r[j + 1] - p[1], z = this.r[j + 2] - p[2];
      const d = Math.sqrt(x * x + y * y + z * z), sine = (x * up[0] + y * up[1] + z * up[2]) / d;
      if (sine < sinMask) continue;
      count++;
      if (!weigh) continue;
      x /= d; y /= d; z /= d;
      const w = weigh(j / 3, x, y, z, d, sine), wx = w * x, wy = w * y, wz = w * z;
      m[0] += w; m[1] += wx * x; m[2] += wy * y; m[3] += wz * z; m[4] += wx * y; m[5] += wx * z;
      m[6] += wy * z; m[7] += wx; m[8] += wy; m[9] += wz;
    }
    return count;
  }

  count(spot, sinMask) { return this.look(spot, sinMask, MOMENTS, null); }

  gdop(spot, sinMask) {
    const count = this.look(spot, sinMask, MOMENTS, () => 1);
    return count < 4 ? Infinity : dops(MOMENTS, spot.up)[0];
  }

  // Errors of a fix by weighted least squares, metres, one sigma, by their names.
  errors(spot, sinMask) {
    const {worth} = this, lit = worth.delay_m2 > 0 ? this.lit(dot(spot.up, this.sun)) : 0;
    const count = this.look(spot, sinMask, MOMENTS, (...sight) => 1 / this.variance(lit, ...sight));
    const [, position, horizontal, vertical, time] = count < 4 ? Array(5).fill(Infinity) : dops(MOMENTS, spot.up);
    return {
      error_horizontal_m: Math.sqrt(horizontal ** 2 + worth.horizontal_m2),
      error_vertical_m: vertical,
      error_position_m: Math.sqrt(position ** 2 + worth.horizontal_m2),
      error_time_m: Math.sqrt(time ** 2 + worth.time_m2),
    };
  }

  // Variance of a range, m^2: orbit and clock along the line of sight, receiver, ionosphere.
  variance(lit, k, x, y, z, d, sine) {
    const {worth} = this, {covariance: c} = worth, first = c.length > 16 ? 16 * k : 0;
    const [radial, along, side] = this.axes[k], u = [x, y, z];
    const e = [dot(radial, u), dot(along, u), dot(side, u), 1];
    let orbit = 0;
    for (let i = 0; i < 4; i++) for (let j = 0; j < 4; j++) orbit += e[i] * e[j] * c[first + 4 * i + j];
    const heard = worth.noise_m + worth.zenith_m / Math.max(sine, worth.lowest_sine), d2 = d * d;
    const through = worth.delay_m2 * lit / (1 - worth.shell2 * (1 - sine * sine));
    return orbit + heard * heard + d2 * (worth.loop_m2_km2 + worth.loop_m2_km4 * d2) + through;
  }

  lit(cosine) {  // share of the ionosphere's variance that the Sun leaves
    const table = this.worth.lit, at = (cosine + 1) / 2 * (table.length - 1);
    const k = within(Math.floor(at), 0, table.length - 2);
    return table[k] + (at - k) * (table[k + 1] - table[k]);
  }

  // All that a place has.
  seen(spot, sinMask) {
    const more = this.worth ? this.errors(spot, sinMask) : {};
    return {count: this.count(spot, sinMask), gdop: this.gdop(spot, sinMask), ...more};
  }

  // One of it.
  value(field, spot, sinMask) {
    return field === "count" ? this.count(spot, sinMask) :
      field === "gdop" ? this.gdop(spot, sinMask) : this.errors(spot, sinMask)[field];
  }
}
const MOMENTS = new Float64Array(10);

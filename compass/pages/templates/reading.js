// Pictures that answer: point at a map, a curve, a bar or a span, or go there by the arrow keys, and read the
// values that are kept beside the drawing. No library and no network.
"use strict";
(() => {
const {say} = compassTip;
const half = bits => {  // half-precision float
  const sign = bits & 0x8000 ? -1 : 1, power = bits >> 10 & 31, rest = bits & 1023;
  if (power === 31) return rest ? NaN : sign * Infinity;
  return sign * (power ? 2 ** (power - 15) * (1 + rest / 1024) : rest * 2 ** -24);
};
const degrees = (v, positive, negative) =>
  `${Math.abs(v).toFixed(1)}° ${v < 0 ? negative : positive}`;
const turned = v => v - 360 * Math.round(v / 360);
const told = ([,,, name], v) => name === "latitude" ? degrees(v, "N", "S")
  : name === "longitude" ? degrees(turned(v), "E", "W") : say(v);
const nearest = (list, v) => {
  let best = 0;
  list.forEach((w, k) => { if (Math.abs(w - v) < Math.abs(list[best] - v)) best = k; });
  return best;
};

async function unpack(panel) {
  const bytes = Uint8Array.from(atob(panel.values), c => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const words = new Uint16Array(await new Response(stream).arrayBuffer());
  panel.cells = Array.from(words, bits => half(bits) * panel.scale);
}

// Place and value under a point of a Mollweide map; null outside its rim.
function onMap(panel, x, y) {
  const [left, top, right, bottom] = panel.box;
  const u = 2 * (x - left) / (right - left) - 1, w = 1 - 2 * (y - top) / (bottom - top);
  if (Math.abs(w) > 1 || !panel.cells) return null;
  const t = Math.asin(w), c = Math.cos(t);
  const lat = Math.asin((2 * t + Math.sin(2 * t)) / Math.PI) * 180 / Math.PI;
  const lon = c < 1e-9 ? 0 : 180 * u / c;
  if (Math.abs(lon) > 180) return null;
  const row = nearest(panel.lat, lat), column = nearest(panel.lon, lon);
  const value = panel.cells[row * panel.lon.length + column];
  return {x, y, lines: [
    `${degrees(panel.lat[row], "N", "S")}, ${degrees(panel.lon[column], "E", "W")}`,
    `${panel.label}: ${say(value)}`]};
}

const along = ([low, high, log], v) =>
  log ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low);
const rising = list => list.every((v, k) => !k || v >= list[k - 1]) && list.length > 1;

// Values of the curves at a point: of those that run along the axis all, else the nearest point.
function onCurves(panel, x, y) {
  const [left, top, right, bottom] = panel.box;
  if (x < left || x > right || y < top || y > bottom) return null;
  const place = (line, k) => [left + along(panel.x, line.x[k]) * (right - left),
                              bottom - along(panel.y, line.y[k]) * (bottom - top)];
  const found = [];
  let closest = null;
  for (const line of panel.lines) {
    let at = -1, short = Infinity;
    const run = rising(line.x);
    line.x.forEach((_, k) => {
      const [px, py] = place(line, k), away = run ? Math.abs(px - x) : Math.hypot(px - x, py - y);
      if (away < short) { short = away; at = k; }
    });
    const one = {line, at, short, place: place(line, at)};
    if (run) { if (short < (right - left) / 20) found.push(one); }
    else if (short < .03 && (!closest || short < closest.short)) closest = one;
  }
  if (closest) found.unshift(closest);
  if (!found.length) return null;
  const head = found[0].line.x[found[0].at];
  const off = f => Math.abs(f.place[1] - y), most = 12;  // of many curves those near the pointer
  const shown = found.length > most ? [...found].sort((a, b) => off(a) - off(b)).slice(0, most) : found;
  const lines = shown.map(f =>
    `${f.line.name || panel.y[3] || panel.title || "value"}: ${told(panel.y, f.line.y[f.at])}`);
  if (found.some(f => f.line.name) && panel.y[3]) lines.unshift(panel.y[3]);
  if (shown.length < found.length) lines.push(`and ${found.length - shown.length} more`);
  return {x: found[0].place[0], y: found[0].place[1],
          lines: [`${panel.x[3] || "across"}: ${told(panel.x, head)}`, ...lines]};
}

// A place of the picture in the numbers of the axes; none outside of them.
function inside(panel, x, y) {
  const [left, top, right, bottom] = panel.box;
  if (x < left || x > right || y < top || y > bottom) return null;
  const back = ([low, high, log], part) =>
    log ? low * (high / low) ** part : low + part * (high - low);
  return [back(panel.x, (x - left) / (right - left)), back(panel.y, (bottom - y) / (bottom - top))];
}

// The row of spans at a point: the span it lies in, or between which two.
function onRows(panel, x, y) {
  const at = inside(panel, x, y);
  const row = at && panel.rows[Math.round(at[1])];
  if (!row) return null;
  const k = row.from.findIndex((from, j) => from <= at[0] && at[0] <= row.to[j]);
  const told = k < 0 ? `not at ${say(at[0])}` : `from ${row.from[k]} to ${row.to[k]}`;
  return {x, y, lines: [row.name, told, panel.x[3]]};
}

// The bar at a point, or over and under it.
function onBars(panel, x, y) {
  const at = inside(panel, x, y);
  if (!at) return null;
  const [a, b] = at;
  const bar = panel.bars.find(({corners: [x0, y0, x1, y1]}) => x0 <= a && a <= x1 && y0 <= b && b <= y1)
    || panel.bars.find(({corners: [x0, y0, x1, y1]}) => panel.flat ? y0 <= b && b <= y1 : x0 <= a && a <= x1);
  return bar ? {x, y, lines: [bar.name, `${panel.of || panel.title || "value"}: ${say(bar.value)}`]} : null;
}

const found = (panel, x, y) =>
  (panel.lines ? onCurves : panel.rows ? onRows : panel.bars ? onBars : onMap)(panel, x, y);

class Reading {
  constructor(root) {
    this.root = root;
    this.panels = JSON.parse(root.querySelector("script").textContent);
    this.tip = root.appendChild(document.createElement("div"));
    this.tip.className = "tip";
    this.tip.setAttribute("aria-live", "polite");
    this.dot = root.appendChild(document.createElement("span"));
    root.tabIndex = 0;
    root.setAttribute("role", "application");
    root.setAttribute("aria-label", `${root.querySelector("img").alt} ` +
      "Point at it, or go through it by the arrow keys, to read values.");
    const [l, t, r, b] = this.panels[0].box;
    this.at = [(l + r) / 2, (t + b) / 2];
    this.ready = Promise.all(this.panels.filter(p => p.values).map(unpack));
    root.addEventListener("pointermove", e => this.point(e));
    root.addEventListener("pointerdown", e => this.point(e));
    // a finger that is lifted leaves too: what it touched stays said
    root.addEventListener("pointerleave", e => { if (e.pointerType !== "touch") this.hide(); });
    root.addEventListener("blur", () => this.hide());
    root.addEventListener("keydown", e => this.key(e));
  }
  point(e) {
    const box = this.root.querySelector("img").getBoundingClientRect();
    this.show((e.clientX - box.left) / box.width, (e.clientY - box.top) / box.height);
  }
  key(e) {
    const step = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[e.key];
    if (e.key === "Escape") this.hide();
    if (!step) return;
    e.preventDefault();
    const by = e.shiftKey ? .05 : .01;
    this.show(...this.at.map((v, k) => Math.min(Math.max(v + by * step[k], 0), 1)));
    // on a narrow page the picture is wider than its place: what is read must not leave it
    for (const shown of [this.tip, this.dot]) shown.scrollIntoView({block: "nearest", inline: "nearest"});
  }
  show(x, y) {
    this.at = [x, y];
    const told = this.panels.reduce((one, panel) => one || found(panel, x, y), null);
    if (!told) return this.hide();
    const {width, height} = this.root.querySelector("img").getBoundingClientRect();
    compassTip.tell(this.tip, told.lines, told.x * width,
      high => Math.min(told.y * height - high - 8, height - high), width);
    this.dot.style.display = "block";
    this.dot.style.left = `${told.x * width}px`;
    this.dot.style.top = `${told.y * height}px`;
  }
  hide() { this.tip.style.display = this.dot.style.display = "none"; }
}

addEventListener("DOMContentLoaded", () => {
  for (const root of document.querySelectorAll(".reading")) root.reading = new Reading(root);
});
})();

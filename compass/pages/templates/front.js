// Candidates of a study on any two axes: point at one to see what it is, drag over a part (or press a
// button, or a key) to see it larger, hide groups by the legend. Drawn at the size shown, so that letters keep theirs.
"use strict";
(() => {
const FRONT = 1;  // the first group is of all that are feasible, those after it are few
const make = (name, attributes, text) => {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
};
const {say} = compassTip;

// Round numbers between two, about `wanted` of them; whole numbers for what is counted.
function ticks(low, high, wanted, whole) {
  const rough = (high - low) / Math.max(wanted, 1), power = 10 ** Math.floor(Math.log10(rough));
  let step = [1, 2, 5, 10].find(k => k * power >= rough) * power;
  if (whole) step = Math.max(1, Math.round(step));
  const out = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; k++)
    out.push(Number((k * step).toPrecision(12)));
  return out;
}

// A label in two lines if it is too long for one.
const broken = (label, room) => {
  if (label.length * 6.7 < room) return [label];
  const words = label.split(" "), half = label.length / 2;
  let first = words.shift();
  while (words.length && first.length + words[0].length < half + 4) first += ` ${words.shift()}`;
  return words.length ? [first, words.join(" ")] : [first];
};

class Front {
  constructor(root) {
    Object.assign(this, JSON.parse(root.querySelector("script").textContent));
    this.root = root;
    this.svg = root.querySelector("svg");
    this.plot = root.querySelector(".plot");
    this.tip = root.querySelector(".tip");
    this.hidden = new Set();
    root.closest("figure").querySelector("img.still")?.classList.add("paper-only");
    root.hidden = false;
    this.x = 0;
    this.y = this.second;
    for (const axis of ["x", "y"])
      root.querySelector(`[name=${axis}]`).addEventListener("change", e => {
        this[axis] = Number(e.target.value);
        this.all();
      });
    for (const [name, act] of [["nearer", () => this.zoom(1 / 1.5)], ["farther", () => this.zoom(1.5)], ["all", () => this.all()]])
      root.querySelector(`[name=${name}]`).addEventListener("click", act);
    this.plot.addEventListener("keydown", e => this.key(e));
    this.plot.addEventListener("blur", () => { this.tip.style.display = "none"; });
    this.svg.addEventListener("pointermove", e => this.move(e));
    this.svg.addEventListener("pointerdown", e => this.move(e, true));
    this.svg.addEventListener("pointerup", e => this.up(e));
    this.svg.addEventListener("pointercancel", () => this.drop());
    // a finger that is lifted leaves too: what it touched stays said
    this.svg.addEventListener("pointerleave", e => { if (e.pointerType !== "touch") this.tip.style.display = "none"; });
    this.svg.addEventListener("dblclick", () => this.all());
    this.legend();
    new ResizeObserver(() => this.draw()).observe(this.plot);
    this.all();
  }
  legend() {
    const row = this.root.querySelector(".legend");
    this.groups.forEach((group, k) => {
      const label = row.appendChild(document.createElement("label"));
      const box = label.appendChild(document.createElement("input"));
      box.type = "checkbox";
      box.checked = true;
      box.addEventListener("change", () => {
        this.hidden[box.checked ? "delete" : "add"](k);
        this.draw();
      });
      const mark = label.appendChild(make("svg", {width: 16, height: 16, "aria-hidden": true}));
      mark.appendChild(this.mark(group, 8, 8));
      label.append(group.label);
    });
  }
  // Ends of both axes with all in between: in logarithms where the largest is many times the least.
  all() {
    this.logs = [];
    this.ends = [this.x, this.y].map((axis, a) => {
      const values = this.groups.flatMap(g => g.columns[axis]).filter(v => v !== null);
      if (!values.length) return [0, 1];
      let low = Math.min(...values), high = Math.max(...values);
      this.logs[a] = low > 0 && high > 5 * low && !this.axes[axis].whole;
      if (this.logs[a]) [low, high] = [Math.log10(low), Math.log10(high)];
      const room = (high - low || Math.abs(high) || 1) * .04;
      return [low - room, high + room];
    });
    this.draw();
  }
  at(a, v) { return this.logs[a] ? Math.log10(v) : v; }
  ticks(a, wanted) {
    const [low, high] = this.ends[a];
    if (!this.logs[a]) return ticks(low, high, wanted, this.axes[a ? this.y : this.x].whole);
    const per = high - low < 1.2 ? [1, 1.5, 2, 3, 4, 5, 7] : high - low < 2.5 ? [1, 2, 5] : [1], out = [];
    for (let p = Math.floor(low); p <= high; p++)
      for (const k of per)
        if (Math.log10(k) + p >= low && Math.log10(k) + p <= high) out.push(Number((k * 10 ** p).toPrecision(6)));
    return out.length > 1 ? out : ticks(10 ** low, 10 ** high, wanted, false).filter(v => v > 0);
  }
  mark(group, x, y) {
    const r = group.size, style = {fill: group.colour, stroke: group.size > 5 ? "#23262b" : "none"};
    if (group.shape === "diamond")
      return make("path", {d: `M${x},${y - r}L${x + r},${y}L${x},${y + r}L${x - r},${y}Z`, ...style});
    if (group.shape === "star") {
      const at = k => [x + Math.sin(k * Math.PI / 5) * (k % 2 ? .45 : 1.15) * r,
                       y - Math.cos(k * Math.PI / 5) * (k % 2 ? .45 : 1.15) * r];
      return make("path", {d: `M${Array.from({length: 10}, (_, k) => at(k)).join("L")}Z`, ...style});
    }
    return make("circle", {cx: x, cy: y, r, ...style, "fill-opacity": group.faint ? .55 : 1});
  }
  draw() {
    const width = this.plot.clientWidth;
    if (!width) return;
    const height = Math.round(Math.min(Math.max(width * .72, 300), 540));
    const frame = this.frame = {left: 74, right: width - 12, top: 10, bottom: height - 48};
    this.svg.setAttribute("width", width);
    this.svg.setAttribute("height", height);
    this.svg.replaceChildren();
    const [[x0, x1], [y0, y1]] = this.ends;
    this.px = v => frame.left + (this.at(0, v) - x0) / (x1 - x0) * (frame.right - frame.left);
    this.py = v => frame.bottom - (this.at(1, v) - y0) / (y1 - y0) * (frame.bottom - frame.top);
    for (const v of this.ticks(0, width / 90)) {
      this.svg.append(
        make("line", {x1: this.px(v), x2: this.px(v), y1: frame.top, y2: frame.bottom, class: "grid"}),
        make("text", {x: this.px(v), y: frame.bottom + 17, "text-anchor": "middle"}, say(v)));
    }
    for (const v of this.ticks(1, height / 70)) {
      this.svg.append(
        make("line", {x1: frame.left, x2: frame.right, y1: this.py(v), y2: this.py(v), class: "grid"}),
        make("text", {x: frame.left - 6, y: this.py(v) + 4, "text-anchor": "end"}, say(v)));
    }
    const middle = (frame.top + frame.bottom) / 2;
    broken(this.axes[this.x].label, frame.right - frame.left).forEach((text, k, {length}) => this.svg.append(
      make("text", {x: (frame.left + frame.right) / 2, y: height - 4 - 14 * (length - 1 - k),
        "text-anchor": "middle", class: "title x"}, text)));
    broken(this.axes[this.y].label, frame.bottom - frame.top).forEach((text, k) => this.svg.append(
      make("text", {x: 12 + 14 * k, y: middle, "text-anchor": "middle", class: "title y",
        transform: `rotate(-90 ${12 + 14 * k} ${middle})`}, text)));
    this.points = [];
    this.groups.forEach((group, g) => {
      if (this.hidden.has(g)) return;
      group.columns[this.x].forEach((x, k) => {
        const y = group.columns[this.y][k];
        if (x === null || y === null) return;
        const point = {group, g, k, x: this.px(x), y: this.py(y)};
        if (point.x < frame.left || point.x > frame.right || point.y < frame.top || point.y > frame.bottom) return;
        if (group.doubt) this.bars(group, point, x, y);
        const drawn = this.mark(group, point.x, point.y);
        drawn.classList.add("point");
        this.svg.append(drawn);
        if (group.ringed)
          this.svg.append(make("circle", {cx: point.x, cy: point.y, r: 13, class: "ring"}));
        this.points.push(point);
      });
    });
  }
  // How far another sampling may move it, on both axes, as far as the frame goes.
  bars(group, point, x, y) {
    const f = this.frame, within = (v, low, high) => Math.min(Math.max(v, low), high);
    const end = (map, v, low, high) => {
      const at = map(v);
      return within(Number.isFinite(at) ? at : low === f.left ? low : high, low, high);
    };
    const [across, up] = [group.doubt[this.x], group.doubt[this.y]];
    if (across) {
      const [x1, x2] = [x - across, x + across].map(v => end(this.px, v, f.left, f.right));
      this.svg.append(make("line", {x1, x2, y1: point.y, y2: point.y, class: "doubt"}));
    }
    if (up) {
      const [y1, y2] = [y - up, y + up].map(v => end(this.py, v, f.top, f.bottom));
      this.svg.append(make("line", {x1: point.x, x2: point.x, y1, y2, class: "doubt"}));
    }
  }
  // What a candidate is, and each of its figures.
  tell(point) {
    const {group, k} = point;
    const figures = this.axes.map((axis, a) => [axis, group.columns[a][k], group.told[a]?.[k]]).filter(f => f[1] !== null);
    const lines = [group.names[k], ...figures.slice(0, 9).map(([axis, v, told]) =>
      told ? `${axis.title}: ${told}` : `${axis.label}: ${say(v)}${axis.sampled ? ", sampled" : ""}`)];
    if (group.few) lines[0] = `${group.label}: ${lines[0]}`;
    compassTip.tell(this.tip, lines, point.x,
      high => Math.min(point.y - high / 2, this.frame.bottom - high), this.plot.clientWidth);
    this.here = point;
  }
  near(x, y) {
    let best = null, short = 14;
    for (const point of this.points) {  // those drawn last lie on top
      const away = Math.hypot(point.x - x, point.y - y) - (point.group.few ? 3 : 0);
      if (away <= short) { short = away; best = point; }
    }
    return best;
  }
  move(e, down) {
    const box = this.svg.getBoundingClientRect(), x = e.clientX - box.left, y = e.clientY - box.top;
    if (down) { this.from = [x, y]; this.svg.setPointerCapture(e.pointerId); }
    if (this.from && e.buttons && e.pointerType !== "touch") {
      this.svg.querySelector(".drag")?.remove();
      this.svg.append(make("rect", {class: "drag", x: Math.min(x, this.from[0]), y: Math.min(y, this.from[1]),
        width: Math.abs(x - this.from[0]), height: Math.abs(y - this.from[1])}));
    }
    const found = this.near(x, y);
    if (found) this.tell(found); else this.tip.style.display = "none";
  }
  // End of a drag: where it began.
  drop() {
    const from = this.from;
    this.from = null;
    this.svg.querySelector(".drag")?.remove();
    return from;
  }
  up(e) {
    const began = this.drop();
    if (!began || e.pointerType === "touch") return;
    const box = this.svg.getBoundingClientRect(), f = this.frame;
    const within = ([x, y]) => [Math.min(Math.max(x, f.left), f.right), Math.min(Math.max(y, f.top), f.bottom)];
    const from = within(began), to = within([e.clientX - box.left, e.clientY - box.top]);
    if (Math.abs(to[0] - from[0]) < 12 || Math.abs(to[1] - from[1]) < 12) return;
    const [[x0, x1], [y0, y1]] = this.ends;
    const x = [from[0], to[0]].map(v => x0 + (v - f.left) / (f.right - f.left) * (x1 - x0)).sort((a, b) => a - b);
    const y = [from[1], to[1]].map(v => y0 + (f.bottom - v) / (f.bottom - f.top) * (y1 - y0)).sort((a, b) => a - b);
    this.ends = [x, y];
    this.draw();
  }
  zoom(by) {
    const {group, k} = this.here || {};
    this.ends = this.ends.map(([low, high], a) => {
      const held = group ? group.columns[a ? this.y : this.x][k] : null;
      const middle = held === null ? (low + high) / 2 : this.at(a, held);
      return [middle - (middle - low) * by, middle + (high - middle) * by];
    });
    this.draw();
  }
  key(e) {
    if (e.key === "+" || e.key === "=") this.zoom(1 / 1.5);
    else if (e.key === "-") this.zoom(1.5);
    else if (e.key === "0") this.all();
    else if (e.key === "Escape") this.tip.style.display = "none";
    else if (e.key === "ArrowRight" || e.key === "ArrowLeft") {
      const few = this.points.filter(p => p.g >= FRONT).sort((a, b) => a.x - b.x || a.y - b.y);
      const at = few.findIndex(p => this.here && p.group === this.here.group && p.k === this.here.k);
      const next = e.key === "ArrowRight" ? at + 1 : (at < 0 ? few.length : at) - 1;
      if (few.length) this.tell(few[(next + few.length) % few.length]);
    } else return;
    e.preventDefault();
  }
}

addEventListener("DOMContentLoaded", () => {
  for (const root of document.querySelectorAll(".front")) root.front = new Front(root);
});
})();

// What a picture says where it is pointed at: a few lines beside the point, never outside of it.
"use strict";
const compassTip = {
  // A number as a reader wants it: three digits, four of large ones.
  say: v => v === null ? "none" : Number.isNaN(v) ? "no value" : !Number.isFinite(v) ? "∞"
    : v === 0 ? "0" : Number(v.toPrecision(Math.abs(v) < 1000 ? 3 : 4)).toLocaleString("en", {maximumSignificantDigits: 6}),
  // Write the lines, at `x` and beside it; `y` gives the top for the tip's height.
  tell(tip, lines, x, y, room) {
    tip.replaceChildren(...lines.map(text => {
      const line = document.createElement("div");
      line.textContent = text;
      return line;
    }));
    tip.style.display = "block";
    const wide = tip.offsetWidth, high = tip.offsetHeight;
    tip.style.left = `${Math.max(x + 13 + wide > room ? x - 13 - wide : x + 13, 0)}px`;
    tip.style.top = `${Math.max(y(high), 0)}px`;
  },
};

"use strict";
// Axes on a canvas: what search and compare pages draw on.

/** Okabe and Ito's colours, dark ones first. */
const TONES = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8a6d3b", "#7f7f7f", "#7b61c4", "#b8336a"];

/** A number on an axis: short. */
function tick(x) {
  const size = Math.abs(x);
  if (size >= 1e6 || (size > 0 && size < 1e-3)) return x.toExponential(1).replace(".0e", "e").replace("e+", "e");
  return (+x.toPrecision(4)).toLocaleString("en", { maximumFractionDigits: 6 });
}

/** Values at equal steps of 1, 2 or 5 times a power of ten; powers of ten on a logarithmic axis. */
function ticks([low, high], log, most) {
  const all = [];
  if (log) {
    const [from, to] = [Math.ceil(Math.log10(low) - 1e-9), Math.floor(Math.log10(high) + 1e-9)], by = Math.max(1, Math.ceil((to - from) / most));
    for (let e = from; e <= to; e += by) all.push(10 ** e);
    if (all.length > 1) return all;
    all.length = 0;
  }
  const rough = (high - low) / most, power = 10 ** Math.floor(Math.log10(rough)), step = power * [1, 2, 5, 10].find(k => k * power >= rough);
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) all.push(k * step);
  return all;
}

/** The least and the greatest finite number, a little apart; with `log` only positive ones. */
function extent(lists, log) {
  let [low, high] = [Infinity, -Infinity];
  for (const list of lists)
    for (const x of list) if (Number.isFinite(x) && (!log || x > 0)) {
      if (x < low) low = x;
      if (x > high) high = x;
    }
  if (low > high) return log ? [1, 10] : [0, 1];
  if (low < high) return [low, high];
  return log ? [low / 2, low * 2] : [low - 0.5 * (Math.abs(low) || 1), high + 0.5 * (Math.abs(high) || 1)];
}

class Chart {
  constructor(canvas) {
    this.canvas = canvas;
    this.to = canvas.getContext("2d");
  }

  /** Clears it and draws axes. `x` and `y`: label, range, log. */
  begin(x, y) {
    const { canvas, to } = this, ratio = Math.min(window.devicePixelRatio || 1, 3), w = canvas.clientWidth, h = canvas.clientHeight;
    [canvas.width, canvas.height] = [Math.round(w * ratio), Math.round(h * ratio)];
    to.setTransform(ratio, 0, 0, ratio, 0, 0);
    Object.assign(this, { x, y, w, h });
    to.font = "12px system-ui, sans-serif";
    const marks = ticks(y.range, y.log, Math.max(2, Math.floor(h / 55)));
    this.left = Math.min(w / 3, 34 + Math.max(...marks.map(v => to.measureText(tick(v)).width), 0));
    [this.right, this.top, this.bottom] = [w - 12, 10, h - 40];
    [to.strokeStyle, to.fillStyle, to.lineWidth] = [style("--rule"), style("--soft"), 1];
    [to.textAlign, to.textBaseline] = ["right", "middle"];
    for (const v of marks) {
      const at = Math.round(this.py(v)) + 0.5;
      this.line([[this.left, at], [this.right, at]]);
      to.fillText(tick(v), this.left - 6, at);
    }
    [to.textAlign, to.textBaseline] = ["center", "top"];
    for (const v of ticks(x.range, x.log, Math.max(2, Math.floor((w - this.left) / 80)))) {
      const at = Math.round(this.px(v)) + 0.5;
      this.line([[at, this.top], [at, this.bottom]]);
      // The last number stays within the canvas.
      to.fillText(tick(v), Math.min(at, w - to.measureText(tick(v)).width / 2), this.bottom + 5);
    }
    to.fillText(x.label, (this.left + this.right) / 2, this.bottom + 22, this.right - this.left);
    to.save();
    to.translate(4, (this.top + this.bottom) / 2);
    to.rotate(-Math.PI / 2);
    to.fillText(y.label, 0, 0, this.bottom - this.top);
    to.restore();
  }

  line(points) {
    this.to.beginPath();
    points.forEach(([x, y], k) => k ? this.to.lineTo(x, y) : this.to.moveTo(x, y));
    this.to.stroke();
  }

  part(axis, v) {
    const [low, high] = axis.range;
    return axis.log ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low);
  }

  value(axis, part) {
    const [low, high] = axis.range;
    return axis.log ? low * (high / low) ** part : low + part * (high - low);
  }

  px(v) { return this.left + this.part(this.x, v) * (this.right - this.left); }
  py(v) { return this.bottom - this.part(this.y, v) * (this.bottom - this.top); }
  atX(p) { return this.value(this.x, (p - this.left) / (this.right - this.left)); }
  atY(p) { return this.value(this.y, (this.bottom - p) / (this.bottom - this.top)); }

  /** Draws within the axes only. */
  inside(draw) {
    const { to } = this;
    to.save();
    to.beginPath();
    to.rect(this.left, this.top - 4, this.right - this.left, this.bottom - this.top + 8);
    to.clip();
    draw(to);
    to.restore();
  }

  /** A function that goes up in steps. */
  steps(xs, ys, colour, width, alpha = 1) {
    this.inside(to => {
      [to.strokeStyle, to.lineWidth, to.globalAlpha] = [colour, width, alpha];
      const points = [];
      for (let k = 0; k < xs.length; k++) {
        const x = this.x.log ? Math.max(xs[k], this.x.range[0]) : xs[k];
        if (k) points.push([this.px(x), this.py(ys[k - 1])]);
        points.push([this.px(x), this.py(ys[k])]);
      }
      this.line(points);
    });
  }
}

/** A note beside the pointer; `lines` is empty to hide it. */
function tip(event, lines) {
  const box = $("tip");
  box.hidden = lines.length === 0;
  if (box.hidden) return;
  box.replaceChildren(...lines.map(line => make("div", line)));
  const { clientX: x, clientY: y } = event;
  box.style.left = `${Math.max(4, Math.min(x + 14, innerWidth - box.offsetWidth - 8))}px`;
  box.style.top = `${y + 18 + box.offsetHeight > innerHeight ? y - box.offsetHeight - 10 : y + 18}px`;
}

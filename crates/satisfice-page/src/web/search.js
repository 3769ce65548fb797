"use strict";
// The page of a search: hits over any two axes and over all of them, what is brushed, growth, table.

const ROWS = 100;
/** More axes side by side cannot be told apart. */
const SIDE_BY_SIDE = 14;

function decode(header) {
  const { arrays } = header;
  const axes = header.axes.map((name, k) => ({ name, values: arrays[`axis ${k}`] }));
  const own = [["F", "fitness"], ["evaluation", "evaluation"], ["seconds", "seconds"]].map(([name, key]) => ({ name, values: arrays[key], own: true }));
  const n = arrays.fitness.length;
  return { ...header, axes: [...axes, ...own], n, trace: growth(arrays, n === header.total), by: Sources.of(header), arrays: undefined };
}

/** Evaluations, seconds and hits, in order: what the search noted now and then, and every hit if all are listed. */
function growth(arrays, all) {
  const points = Array.from(arrays["trace hits"], (hits, k) => [arrays["trace evaluations"][k], arrays["trace seconds"][k], hits]);
  if (all) {
    const order = Array.from(arrays.evaluation, (_, k) => k).sort((a, b) => arrays.evaluation[a] - arrays.evaluation[b]);
    order.forEach((k, before) => points.push([arrays.evaluation[k], arrays.seconds[k], before + 1]));
    points.sort((a, b) => a[0] - b[0] || a[2] - b[2]);
  }
  return [0, 1, 2].map(k => Float64Array.from(points, point => point[k]));
}

class SearchPage {
  constructor(data) {
    this.data = data;
    /** What is brushed: from and to, by axis. */
    this.brushes = new Map();
    this.row = 0;
    this.picked = -1;
    this.axes = new Map(data.axes.map(axis => [axis.name, axis]));
    this.fitness = this.axes.get("F").values;
    const order = Uint32Array.from({ length: data.n }, (_, k) => k);
    this.order = order.sort((a, b) => this.fitness[a] - this.fitness[b] || a - b);
    this.filter();
  }

  filter() {
    const { n } = this.data, kept = this.kept = new Uint8Array(n).fill(1);
    for (const [name, [low, high]] of this.brushes) {
      const { values } = this.axes.get(name);
      for (let k = 0; k < n; k++) if (!(values[k] >= low && values[k] <= high)) kept[k] = 0;
    }
    this.listed = this.order.filter(k => kept[k]);
    this.row = 0;
  }

  brush(name, range) {
    if (range) this.brushes.set(name, [Math.min(...range), Math.max(...range)]); else this.brushes.delete(name);
    this.filter();
    this.show();
  }

  clear() {
    this.brushes.clear();
    this.filter();
    this.show();
  }

  /** The solution as text. */
  solution(k) {
    const { texts, axes } = this.data;
    return texts ? texts[k] : `(${axes.filter(axis => !axis.own).map(axis => digits(axis.values[k])).join(", ")})`;
  }

  about(k) {
    const line = this.solution(k), most = 160;
    const lines = [line.length > most ? `${line.slice(0, most)}…` : line, `F ${digits(this.fitness[k])}`];
    return [...lines, `evaluation ${count(this.axes.get("evaluation").values[k])}`, `after ${duration(this.axes.get("seconds").values[k])}`];
  }

  // Drawing

  show() {
    const { data } = this;
    const lines = [["Hits", `${count(data.total)}${data.reference === null ? "" : ` of ${count(data.reference)}`}${data.reference ? ` (${share(data.total / data.reference)})` : ""}`]];
    if (data.n < data.total) lines.push(["In this page", `${count(data.n)} of them, evenly chosen`]);
    if (this.brushes.size) lines.push(["Selected", count(this.listed.length)]);
    facts($("facts"), [...lines, ...data.facts]);
    $("chips").replaceChildren(...[...this.brushes].map(([name, [low, high]]) => {
      const chip = make("button", `${name}: ${tick(low)} to ${tick(high)} ✕`);
      chip.type = "button";
      chip.setAttribute("aria-label", `Do not filter by ${name}`);
      chip.onclick = () => this.brush(name, null);
      return chip;
    }));
    $("clear").hidden = this.brushes.size === 0;
    this.draw();
    this.table();
  }

  draw() {
    this.scatter();
    this.parallel();
    this.growth();
    this.data.by?.draw();
  }

  /** F between 0 and 1, for colours. */
  tint(k) {
    const [low, high] = this.fitnessRange ??= extent([this.fitness]);
    return (this.fitness[k] - low) / (high - low);
  }

  colour(k) {
    const t = this.tint(k), mix = (a, b, s) => a.map((c, i) => Math.round(c + s * (b[i] - c)));
    const [near, middle, far] = [[230, 82, 0], [184, 97, 158], [0, 107, 191]];
    return `rgb(${t < 0.5 ? mix(near, middle, 2 * t) : mix(middle, far, 2 * t - 1)})`;
  }

  scatter() {
    const chart = this.plane, axis = which => this.axes.get($(which).value);
    const frame = which => ({ label: axis(which).name, range: padded(extent([axis(which).values])) });
    chart.begin(frame("xaxis"), frame("yaxis"));
    const [xs, ys] = [axis("xaxis").values, axis("yaxis").values], r = this.data.n > 5000 ? 1.5 : this.data.n > 500 ? 2.5 : 3.5;
    chart.inside(to => {
      for (const wanted of [0, 1]) {
        to.globalAlpha = wanted ? (this.data.n > 2000 ? 0.6 : 0.9) : 0.12;
        for (let k = 0; k < this.data.n; k++) {
          if (this.kept[k] !== wanted) continue;
          to.fillStyle = wanted ? this.colour(k) : style2("--soft");
          to.beginPath();
          to.arc(chart.px(xs[k]), chart.py(ys[k]), r, 0, 7);
          to.fill();
        }
      }
      to.globalAlpha = 1;
      this.box(to, chart);
      if (this.picked >= 0) {
        [to.strokeStyle, to.lineWidth] = [style("--ink"), 2];
        to.beginPath();
        to.arc(chart.px(xs[this.picked]), chart.py(ys[this.picked]), 7, 0, 7);
        to.stroke();
      }
    });
  }

  /** What is brushed in the plane. */
  box(to, chart) {
    const side = (which, p) => {
      const range = this.brushes.get($(which).value);
      return range ? range.map(p) : null;
    };
    const [x, y] = [side("xaxis", v => chart.px(v)), side("yaxis", v => chart.py(v))];
    if (!x && !y) return;
    const [[x0, x1], [y1, y0]] = [x ?? [chart.left, chart.right], y ?? [chart.bottom, chart.top]];
    [to.strokeStyle, to.lineWidth] = [style("--accent"), 1.5];
    to.strokeRect(x0, y0, x1 - x0, y1 - y0);
  }

  /** Every hit as a line across axes that stand side by side. */
  parallel() {
    const canvas = $("parallel"), own = this.data.axes.filter(axis => !axis.own);
    this.sides = [...own.slice(0, SIDE_BY_SIDE - 3), ...this.data.axes.filter(axis => axis.own)];
    $("omitted").textContent = own.length > SIDE_BY_SIDE - 3 ? `The first ${SIDE_BY_SIDE - 3} of ${own.length} coordinates.` : "";
    const ratio = Math.min(window.devicePixelRatio || 1, 3), w = canvas.clientWidth, h = canvas.clientHeight, to = canvas.getContext("2d");
    [canvas.width, canvas.height] = [w * ratio, h * ratio];
    to.scale(ratio, ratio);
    const [top, bottom] = [34, h - 22], gap = (w - 70) / (this.sides.length - 1);
    this.lanes = this.sides.map((axis, k) => ({ axis, x: 35 + k * gap, range: axis.range ??= extent([axis.values]), top, bottom }));
    const y = (lane, v) => bottom - (v - lane.range[0]) / (lane.range[1] - lane.range[0]) * (bottom - top);
    // More lines than this hide each other: some are drawn, all are filtered.
    const step = Math.ceil(this.data.n / 4000);
    for (const wanted of [0, 1]) {
      to.globalAlpha = wanted ? Math.max(0.08, Math.min(0.7, 60 / Math.max(1, this.listed.length / step))) : 0.05;
      for (let k = 0; k < this.data.n; k += step) {
        if (this.kept[k] !== wanted) continue;
        to.strokeStyle = wanted ? this.colour(k) : style2("--soft");
        to.beginPath();
        this.lanes.forEach((lane, i) => i ? to.lineTo(lane.x, y(lane, lane.axis.values[k])) : to.moveTo(lane.x, y(lane, lane.axis.values[k])));
        to.stroke();
      }
    }
    to.globalAlpha = 1;
    if (step > 1) $("omitted").textContent += ` Every ${step}th hit is drawn.`;
    to.font = "12px system-ui, sans-serif";
    for (const lane of this.lanes) {
      [to.strokeStyle, to.fillStyle, to.textAlign, to.lineWidth] = [style("--soft"), style("--ink"), "center", 1];
      to.strokeRect(lane.x, top, 0, bottom - top);
      to.fillText(lane.axis.name, lane.x, 12, gap - 4);
      to.fillStyle = style("--soft");
      to.fillText(tick(lane.range[1]), lane.x, 28, gap - 4);
      to.fillText(tick(lane.range[0]), lane.x, h - 8, gap - 4);
      const range = this.brushes.get(lane.axis.name);
      if (!range) continue;
      const [from, until] = range.map(v => y(lane, Math.max(lane.range[0], Math.min(lane.range[1], v))));
      [to.strokeStyle, to.lineWidth] = [style("--accent"), 2];
      to.strokeRect(lane.x - 6, until - 2, 12, from - until + 4);
    }
  }

  growth() {
    const [evaluations, seconds, hits] = this.data.trace, { reference } = this.data;
    for (const [chart, xs, label, log] of [[this.byEvaluations, evaluations, "evaluations"], [this.byTime, seconds.map(t => 1e3 * t), "time (ms)"]]) {
      const counted = chart === this.byEvaluations, log = counted && $("log").checked;
      const high = Math.max(reference ?? 0, hits[hits.length - 1] ?? 1, 1), x = extent([xs], log);
      chart.begin({ label, range: log ? x : [0, x[1]], log }, { label: "hits", range: [0, 1.04 * high] });
      if (reference !== null) chart.inside(to => {
        [to.strokeStyle, to.fillStyle, to.textAlign, to.textBaseline] = [style("--soft"), style("--soft"), "left", "top"];
        to.setLineDash([5, 4]);
        chart.line([[chart.left, chart.py(reference)], [chart.right, chart.py(reference)]]);
        to.fillText(`all ${count(reference)}`, chart.left + 6, chart.py(reference) + 4);
      });
      chart.steps([0, ...xs], [0, ...hits], style("--accent"), 2);
      const range = this.brushes.get(counted ? "evaluation" : "seconds");
      if (range) chart.inside(to => {
        const [from, until] = range.map(v => chart.px(Math.max(counted ? v : 1e3 * v, chart.x.range[0])));
        [to.fillStyle, to.globalAlpha] = [style("--accent"), 0.15];
        to.fillRect(from, chart.top, until - from, chart.bottom - chart.top);
      });
    }
  }

  table() {
    const own = this.data.axes.filter(axis => !axis.own), columns = this.data.texts ? [] : own, rows = this.listed.subarray(this.row, this.row + ROWS);
    const head = make("tr"), names = [...(this.data.texts ? ["solution"] : columns.map(axis => axis.name)), "F", "evaluation", "after"];
    head.append(...names.map(name => make("th", name)));
    const lines = Array.from(rows, k => {
      const row = make("tr", undefined, k === this.picked ? "picked" : "");
      if (this.data.texts) {
        const cell = make("td", this.solution(k));
        cell.title = this.solution(k);
        row.append(cell);
      }
      row.append(...[...columns.map(axis => digits(axis.values[k])), digits(this.fitness[k]), count(this.axes.get("evaluation").values[k]), duration(this.axes.get("seconds").values[k])].map(text => make("td", text, "number")));
      row.tabIndex = 0;
      row.onclick = () => this.pick(k);
      row.onkeydown = event => event.key === "Enter" && this.pick(k);
      return row;
    });
    $("hits").replaceChildren(head, ...lines);
    const n = this.listed.length;
    $("listed").textContent = n === 0 ? (this.data.n ? "No hit is selected." : "There are no hits.") : `${count(this.row + 1)} to ${count(this.row + rows.length)} of ${count(n)}, the least F first`;
    $("pages").hidden = n <= ROWS;
    $("back").disabled = this.row === 0;
    $("more").disabled = this.row + ROWS >= n;
    $("copy").disabled = n === 0;
  }

  pick(k) {
    this.picked = k;
    this.scatter();
    this.table();
    facts($("pickedfacts"), k < 0 ? [] : [["Solution", this.solution(k)], ["F", digits(this.fitness[k])], ["Evaluation", count(this.axes.get("evaluation").values[k])], ["Found after", duration(this.axes.get("seconds").values[k])]]);
    $("picked").hidden = k < 0;
  }

  /** The selected hits as CSV, numbers with all their digits. */
  csv() {
    const axes = this.data.texts ? this.data.axes.filter(axis => axis.own) : this.data.axes;
    // Quoted where it has to be; a text that a spreadsheet would compute gets an apostrophe.
    const cell = text => {
      const safe = /^[=+@\t\r-]/.test(text) && Number.isNaN(+text) ? `'${text}` : text;
      return /[",\n\r]/.test(safe) ? `"${safe.replaceAll('"', '""')}"` : safe;
    };
    const head = [...(this.data.texts ? ["solution"] : []), ...axes.map(axis => axis.name)];
    const lines = Array.from(this.listed, k => [...(this.data.texts ? [this.data.texts[k]] : []), ...axes.map(axis => String(axis.values[k]))]);
    return [head, ...lines].map(line => line.map(cell).join(",")).join("\n") + "\n";
  }

  async copy() {
    const text = this.csv();
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      // Pages from disk may not be allowed to; the older way is.
      const area = make("textarea", text);
      document.body.append(area);
      area.select();
      document.execCommand("copy");
      area.remove();
    }
    $("copied").textContent = `${count(this.listed.length)} lines copied`;
  }

  // What the visitor does

  wire() {
    const names = [...this.axes.keys()], options = chosen => names.map(name => Object.assign(make("option", name), { value: name, selected: name === chosen }));
    const own = this.data.axes.filter(axis => !axis.own).map(axis => axis.name);
    $("xaxis").append(...options(own[0] ?? "evaluation"));
    $("yaxis").append(...options(own[1] ?? "F"));
    $("faxis").append(...options("F"));
    for (const which of ["xaxis", "yaxis"]) $(which).onchange = () => this.scatter();
    $("log").onchange = () => { this.growth(); this.data.by?.draw(); };
    [this.plane, this.byEvaluations, this.byTime] = ["scatter", "evaluations", "times"].map(id => new Chart($(id)));
    $("filter").onsubmit = event => {
      event.preventDefault();
      const ends = [$("from"), $("until")].map((input, k) => input.value === "" ? [-Infinity, Infinity][k] : +input.value);
      if (ends.some(x => Number.isFinite(x))) this.brush($("faxis").value, ends);
    };
    $("clear").onclick = () => this.clear();
    $("copy").onclick = () => this.copy();
    $("back").onclick = () => { this.row -= ROWS; this.table(); };
    $("more").onclick = () => { this.row += ROWS; this.table(); };
    this.wirePlane();
    this.wireParallel();
    this.wireGrowth(this.byEvaluations, "evaluation", 1);
    this.wireGrowth(this.byTime, "seconds", 1e-3);
    addEventListener("resize", () => this.draw());
    onScheme(() => this.draw());
  }

  wirePlane() {
    const chart = this.plane;
    drag($("scatter"), {
      over: event => {
        const k = this.near(event.offsetX, event.offsetY);
        tip(event, k < 0 ? [] : this.about(k));
      },
      drag: ([x0, y0], [x1, y1]) => {
        this.brushes.set($("xaxis").value, [chart.atX(x0), chart.atX(x1)].sort((a, b) => a - b));
        if ($("yaxis").value !== $("xaxis").value) this.brushes.set($("yaxis").value, [chart.atY(y0), chart.atY(y1)].sort((a, b) => a - b));
        this.filter();
        this.show();
      },
      click: event => this.pick(this.near(event.offsetX, event.offsetY)),
    });
  }

  /** The hit at a place of the plane. */
  near(x, y) {
    const [xs, ys] = ["xaxis", "yaxis"].map(which => this.axes.get($(which).value).values), chart = this.plane;
    let [best, least] = [-1, 12];
    for (let k = 0; k < this.data.n; k++) {
      const away = this.kept[k] ? Math.hypot(chart.px(xs[k]) - x, chart.py(ys[k]) - y) : Infinity;
      if (away < least) [best, least] = [k, away];
    }
    return best;
  }

  wireParallel() {
    const lane = x => this.lanes.reduce((best, lane) => Math.abs(lane.x - x) < Math.abs(best.x - x) ? lane : best);
    const value = ({ range: [low, high], top, bottom }, y) => low + (bottom - y) / (bottom - top) * (high - low);
    drag($("parallel"), {
      over: event => tip(event, []),
      drag: ([x, y0], [, y1]) => this.brush(lane(x).axis.name, [value(lane(x), y0), value(lane(x), y1)]),
      click: event => this.brush(lane(event.offsetX).axis.name, null),
    });
  }

  wireGrowth(chart, name, unit) {
    drag(chart.canvas, {
      over: event => {
        const x = chart.atX(event.offsetX), [evaluations, seconds, hits] = this.data.trace, xs = name === "seconds" ? seconds : evaluations;
        let k = -1;
        while (k + 1 < xs.length && xs[k + 1] <= x * unit) k++;
        tip(event, k < 0 ? [] : [many(hits[k], "hit"), many(evaluations[k], "evaluation"), duration(seconds[k])]);
      },
      drag: ([x0], [x1]) => this.brush(name, [unit * chart.atX(x0), unit * chart.atX(x1)]),
      click: () => this.brush(name, null),
    });
  }
}

const padded = ([low, high]) => [low - 0.03 * (high - low), high + 0.03 * (high - low)];

/** `style` for inner loops: asked once a turn of the event loop. */
const styles = new Map();
function style2(name) {
  if (!styles.size) queueMicrotask(() => styles.clear());
  if (!styles.has(name)) styles.set(name, style(name));
  return styles.get(name);
}

/** Tells a move over a canvas, a drag across it and a click apart. */
function drag(canvas, { over, drag, click }) {
  let from = null, moved = false;
  canvas.onpointerdown = event => { from = [event.offsetX, event.offsetY]; moved = false; canvas.setPointerCapture?.(event.pointerId); };
  canvas.onpointermove = event => {
    if (!from) return over(event);
    const to = [event.offsetX, event.offsetY];
    if (moved || Math.hypot(to[0] - from[0], to[1] - from[1]) > 4) {
      moved = true;
      tip(event, []);
      drag(from, to);
    }
  };
  canvas.onpointerup = event => { if (from && !moved) click(event); from = null; };
  canvas.onpointercancel = () => from = null;
  canvas.onpointerleave = event => tip(event, []);
}

start(header => {
  const page = window.page = new SearchPage(decode(header));
  page.wire();
  page.show();
});

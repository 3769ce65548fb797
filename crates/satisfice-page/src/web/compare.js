"use strict";
// The page of a comparison: engines switched on and off, seeds as thin lines, figures under the pointer.

/** Values at which medians are taken. */
const GRID = 240;

function decode(header) {
  const { arrays } = header;
  let at = 0;
  const groups = header.groups.map(group => ({
    ...group,
    engines: group.engines.map(({ name, runs }) => ({
      name,
      runs: runs.map(({ seed, points }) => {
        const [evaluations, seconds, hits] = ["evaluations", "seconds", "hits"].map(key => arrays[key].subarray(at, at + points));
        at += points;
        return { seed, evaluations, seconds, hits };
      }),
    })),
  }));
  return { ...header, groups, arrays: undefined };
}

/** Hits by x: a function that goes up in steps. */
function by(xs, ys, x) {
  let [low, high] = [0, xs.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (xs[middle] > x) high = middle; else low = middle + 1;
  }
  return low ? ys[low - 1] : 0;
}

function quartiles(values) {
  const sorted = Float64Array.from(values).sort(), last = sorted.length - 1;
  const at = part => { const p = part * last, k = Math.floor(p); return sorted[k] + (p - k) * ((sorted[k + 1] ?? sorted[k]) - sorted[k]); };
  return [at(0.25), at(0.5), at(0.75)];
}

class Comparison {
  constructor(data) {
    this.data = data;
    this.engines = [...new Set(data.groups.flatMap(group => group.engines.map(engine => engine.name)))];
    this.shown = new Set(this.engines);
    this.colours = new Map(this.engines.map((name, k) => [name, TONES[k % TONES.length]]));
    this.figures = [];
  }

  wire() {
    $("engines").append(...this.engines.map(name => {
      const label = make("label"), box = Object.assign(make("input"), { type: "checkbox", checked: true }), dot = make("i");
      dot.style.background = this.colours.get(name);
      box.onchange = () => { box.checked ? this.shown.add(name) : this.shown.delete(name); this.draw(); };
      label.append(box, dot, make("span", name));
      return label;
    }));
    const all = on => () => {
      this.shown = new Set(on ? this.engines : []);
      $("engines").querySelectorAll("input").forEach(box => box.checked = on);
      this.draw();
    };
    $("all").onclick = all(true);
    $("none").onclick = all(false);
    for (const id of ["seeds", "log"]) $(id).onchange = () => this.draw();
    $("charts").append(...this.data.groups.map(group => this.figure(group)));
    addEventListener("resize", () => this.draw());
    onScheme(() => this.draw());
    this.draw();
  }

  figure(group) {
    const figure = make("figure"), row = make("div", undefined, "pair");
    figure.append(make("h2", group.title), row);
    const reference = group.reference === null ? "" : `All hits: ${count(group.reference)}. `;
    const kinds = group.timed ? ["evaluations", "seconds"] : ["evaluations"];
    for (const kind of kinds) {
      const canvas = make("canvas", undefined, "plot");
      canvas.tabIndex = 0;
      canvas.setAttribute("role", "img");
      canvas.setAttribute("aria-label", `${group.title}: hits against ${kind}; the table below has the figures at the end`);
      row.append(canvas);
      const shown = { group, kind, chart: new Chart(canvas) };
      canvas.onpointermove = event => this.over(event, shown);
      canvas.onpointerleave = event => tip(event, []);
      this.figures.push(shown);
    }
    figure.append(make("figcaption", `${reference}Thick: the median of the seeds. Thin: each seed.`), this.table(group));
    return figure;
  }

  table(group) {
    const wide = make("div", undefined, "wide"), table = make("table"), head = make("tr");
    head.append(...["engine", "seeds", "hits at the end: median", "least", "most", ...(group.reference ? ["recall"] : [])].map(text => make("th", text)));
    table.append(head, ...group.engines.map(({ name, runs }) => {
      const ends = runs.map(run => run.hits[run.hits.length - 1] ?? 0), [, median] = quartiles(ends), row = make("tr");
      const cells = [runs.length, digits(median), Math.min(...ends), Math.max(...ends), ...(group.reference ? [share(median / group.reference)] : [])];
      row.append(make("td", name), ...cells.map(text => make("td", text, "number")));
      return row;
    }));
    wide.append(table);
    return wide;
  }

  draw() {
    for (const figure of this.figures) this.drawOne(figure);
  }

  drawOne(figure) {
    const { group, kind, chart } = figure, log = $("log").checked, unit = kind === "seconds" ? 1e3 : 1;
    const engines = group.engines.filter(engine => this.shown.has(engine.name)), runs = engines.flatMap(engine => engine.runs);
    const xs = runs.map(run => run[kind]), [low, high] = extent(xs, true), most = Math.max(1, group.reference ?? 0, ...runs.map(run => run.hits[run.hits.length - 1] ?? 0));
    const range = log ? [unit * low, unit * high] : [0, unit * high];
    chart.begin({ label: kind === "seconds" ? "time (ms)" : "evaluations", range, log }, { label: "hits", range: [0, 1.04 * most] });
    if (group.reference !== null) chart.inside(to => {
      to.strokeStyle = style("--soft");
      to.setLineDash([5, 4]);
      chart.line([[chart.left, chart.py(group.reference)], [chart.right, chart.py(group.reference)]]);
    });
    const grid = Float64Array.from({ length: GRID }, (_, k) => chart.value(chart.x, k / (GRID - 1)));
    figure.curves = engines.map(({ name, runs }) => {
      const colour = this.colours.get(name);
      if ($("seeds").checked) for (const run of runs) chart.steps(run[kind].map(x => unit * x), run.hits, colour, 0.8, Math.max(0.15, Math.min(0.5, 4 / runs.length)));
      const at = Array.from(grid, x => quartiles(runs.map(run => by(run[kind], run.hits, x / unit))));
      return { name, colour, at, seeds: runs.length };
    });
    for (const { colour, at } of figure.curves) chart.inside(to => {
      [to.strokeStyle, to.lineWidth] = [colour, 2.4];
      chart.line(at.map(([, median], k) => [chart.px(grid[k]), chart.py(median)]));
    });
  }

  /** The figures of every engine at the pointer, the most hits first. */
  over(event, { group, kind, chart, curves }) {
    const part = (event.offsetX - chart.left) / (chart.right - chart.left);
    if (!curves.length || part < 0 || part > 1) return tip(event, []);
    const k = Math.round(part * (GRID - 1)), x = chart.value(chart.x, k / (GRID - 1));
    const lines = curves.map(curve => [curve, curve.at[k]]).sort(([, a], [, b]) => b[1] - a[1]);
    tip(event, [kind === "seconds" ? `after ${duration(x / 1e3)}` : `after ${count(Math.round(x))} evaluations`,
      ...lines.map(([{ name }, [low, median, high]]) => `${name}: ${digits(median)}${group.reference ? `, ${share(median / group.reference)}` : ""} (quartiles ${digits(low)} to ${digits(high)})`)]);
  }
}

start(header => {
  const page = window.page = new Comparison(decode(header));
  page.wire();
});

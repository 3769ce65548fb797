"use strict";
// Which sources an engine with several took its candidates from, and what each of them found.

class Sources {
  /** `names`, and by source the candidates and hits so far at each of some numbers of evaluations. */
  constructor({ names, evaluations, proposed, hits }) {
    const used = names.map((_, k) => k).filter(k => proposed[k].at(-1) > 0);
    Object.assign(this, { evaluations, names: used.map(k => names[k]), proposed: used.map(k => proposed[k]), hits: used.map(k => hits[k]) });
    [this.shares, this.found] = ["sourceshares", "sourcehits"].map(id => new Chart($(id)));
    for (const chart of [this.shares, this.found]) {
      chart.canvas.onpointermove = event => tip(event, this.about(this.rowAt(chart.atX(event.offsetX))));
      chart.canvas.onpointerleave = event => tip(event, []);
    }
    this.table();
  }

  static of({ sources, arrays }) {
    if (!sources.length) return null;
    const [proposed, hits] = ["proposed", "hits"].map(what => sources.map((_, k) => arrays[`source ${what} ${k}`]));
    return new Sources({ names: sources, evaluations: arrays["source evaluations"], proposed, hits });
  }

  tone(k) { return TONES[k % TONES.length]; }

  /** What a source proposed between two rows, as a share of what all did. */
  share(row) {
    const since = counts => counts[row] - (row ? counts[row - 1] : 0), made = this.proposed.map(since), all = made.reduce((a, b) => a + b, 0);
    return made.map(part => all ? part / all : 0);
  }

  rowAt(x) {
    const row = this.evaluations.findIndex(end => end >= x);
    return row < 0 ? this.evaluations.length - 1 : row;
  }

  about(row) {
    const shares = this.share(row), from = row ? this.evaluations[row - 1] : 0;
    const lines = this.names.map((name, k) => [shares[k], `${name}: ${share(shares[k])}, ${count(this.hits[k][row])} hits so far`]);
    return [`evaluations ${count(from + 1)} to ${count(this.evaluations[row])}`, ...lines.sort((a, b) => b[0] - a[0]).map(([, line]) => line)];
  }

  draw() {
    const { shares, found, evaluations } = this, x = { label: "evaluations", range: extent([[1], evaluations], true), log: $("log").checked };
    shares.begin(x, { label: "share of the candidates", range: [0, 1] });
    shares.inside(to => evaluations.forEach((end, row) => {
      const [left, right] = [row ? evaluations[row - 1] : 1, end].map(v => shares.px(Math.max(v, 1)));
      let below = 0;
      this.share(row).forEach((part, k) => {
        to.fillStyle = this.tone(k);
        to.fillRect(left, shares.py(below + part), right - left + 0.5, shares.py(below) - shares.py(below + part));
        below += part;
      });
    }));
    found.begin(x, { label: "hits", range: [0, 1.04 * Math.max(1, ...this.hits.map(hits => hits.at(-1)))] });
    this.hits.forEach((hits, k) => found.steps(evaluations, hits, this.tone(k), 2));
  }

  table() {
    const head = make("tr");
    head.append(...["", "source", "candidates", "hits"].map(name => make("th", name)));
    const rows = this.names.map((name, k) => {
      const row = make("tr"), mark = make("td");
      const box = make("span", undefined, "tone");
      box.style.background = this.tone(k);
      mark.append(box);
      row.append(mark, make("td", name), ...[this.proposed, this.hits].map(counts => make("td", count(counts[k].at(-1)), "number")));
      return row;
    });
    $("sourcetable").replaceChildren(head, ...rows);
    $("sources").hidden = false;
  }
}

"use strict";
// The page of a scene: decodes it, draws it, and lets it be looked into.

/** Frames slower than this while something moves show less, and say so. */
const SLOW = 40;
const ROWS = 100;
const PALE = [[.62, .80, .93], [.93, .88, .76], [.65, .86, .78], [.90, .76, .84], [.80, .80, .80], [.72, .74, .95]];
const [VERMILION, PURPLE, BLUE, ORANGE] = [[.90, .32, 0], [.72, .38, .62], [0, .42, .75], [.96, .62, .05]];

/** To a world in which z points upwards: which coordinate each one is, and its sign. */
const upright = { x: [[1, 1], [2, 1], [0, 1]], y: [[0, 1], [2, -1], [1, 1]], z: [[0, 1], [1, 1], [2, 1]] };

/** Positions between -1 and 1, three by three. */
function positions(places, header) {
  const all = new Float32Array(places.length), unit = 2 / (2 ** header.bits - 1);
  upright[header.up].forEach(([from, sign], to) => {
    for (let k = 0; k < all.length; k += 3) all[k + to] = sign * (places[k + from] * unit - 1);
  });
  return all;
}

/** Every edge once, by its lower, then its higher vertex: their order is their number. */
function edgesOf(body) {
  if (body.edges) return body.edges;
  const { triangles: t, lines: l } = body, n = body.places[0].length / 3, keys = new Float64Array(t.length + l.length / 2);
  let at = 0;
  const add = (v, w) => { if (v !== w) keys[at++] = Math.min(v, w) * n + Math.max(v, w); };
  for (let k = 0; k < t.length; k += 3) { add(t[k], t[k + 1]); add(t[k + 1], t[k + 2]); add(t[k + 2], t[k]); }
  for (let k = 0; k < l.length; k += 2) add(l[k], l[k + 1]);
  const sorted = keys.subarray(0, at).sort(), ends = new Uint32Array(2 * at);
  let edges = 0;
  for (let k = 0; k < at; k++)
    if (k === 0 || sorted[k] !== sorted[k - 1]) {
      ends[edges++] = Math.floor(sorted[k] / n);
      ends[edges++] = sorted[k] % n;
    }
  return body.edges = ends.slice(0, edges);
}

function decode(header) {
  const { arrays } = header;
  const frames = header.frames;
  const bodies = header.bodies.map(({ name, moved }, number) => {
    const triangles = sums(arrays[`triangles ${number}`], 1), lines = sums(arrays[`lines ${number}`], 1);
    const places = [];
    let before = null;
    moved.forEach((frame, k) => {
      const stored = arrays[`places ${number} ${frame}`];
      before = before ? added(stored, before) : sums(stored, 3);
      const now = positions(before, header);
      for (let f = frame; f < (moved[k + 1] ?? frames.length); f++) places[f] = now;
    });
    return { name, triangles, lines, places, shown: true };
  });
  const a = sums(arrays["point 0"], 3), b = added(arrays["point 1"], a);
  const [from, to] = [positions(a, header), positions(b, header)], n = a.length / 3, ends = new Float32Array(6 * n);
  for (let k = 0; k < n; k++) {
    ends.set(from.subarray(3 * k, 3 * k + 3), 6 * k);
    ends.set(to.subarray(3 * k, 3 * k + 3), 6 * k + 3);
  }
  const contacts = { ends, count: n, body: [0, 1].map(s => sums(arrays[`body ${s}`], 1)), feature: [0, 1].map(s => sums(arrays[`feature ${s}`], 1)), kind: [0, 1].map(s => arrays[`kind ${s}`]) };
  for (const name of ["distance", "evaluation", "seconds", "impact"]) contacts[name] = arrays[name];
  let first = 0;
  for (const frame of frames) {
    frame.first = first;
    frame.found = frame.contacts - frame.missed;
    first += frame.contacts;
  }
  const scene = { ...header, bodies, frames, contacts };
  delete scene.arrays;
  return scene;
}

/** Triangles whose corners are merged within cells: fewer, and still a surface. */
function coarse(bodies, most) {
  for (let cells = 128; ; cells *= 0.7) {
    let total = 0;
    const lists = bodies.map(({ triangles, places: [p] }) => {
      const stands = new Map(), stand = new Uint32Array(p.length / 3);
      for (let v = 0; v < stand.length; v++) {
        const [x, y, z] = [0, 1, 2].map(k => Math.floor((p[3 * v + k] + 1) / 2 * cells)), key = (x * 512 + y) * 512 + z;
        if (!stands.has(key)) stands.set(key, v);
        stand[v] = stands.get(key);
      }
      const kept = [];
      for (let k = 0; k < triangles.length; k += 3) {
        const [a, b, c] = [stand[triangles[k]], stand[triangles[k + 1]], stand[triangles[k + 2]]];
        if (a !== b && b !== c && c !== a) kept.push(a, b, c);
      }
      total += kept.length / 3;
      return Uint32Array.from(kept);
    });
    if (total <= most || cells < 8) return lists;
  }
}

class Scene {
  constructor(scene) {
    this.scene = scene;
    this.camera = new Camera();
    this.frame = 0;
    this.time = Infinity;
    this.picked = -1;
    this.row = 0;
    this.most = Infinity;
    this.part = 1;
    this.mode = "edges";
    const all = scene.contacts.seconds;
    this.last = all ? all.reduce((most, t) => t > most ? t : most, 0) : 0;
    this.colours = [["one", "the same"]];
    if (scene.contacts.impact) this.colours.unshift(["impact", "by time of impact"]);
    if (all) this.colours.unshift(["seconds", "by time found"]);
    if (scene.contacts.distance) this.colours.unshift(["distance", "by distance"]);
    if (scene.contacts.impact) this.colours.sort(([name]) => name === "impact" ? -1 : 0);
    this.colour = this.colours[0][0];
    this.tint();
  }

  get now() { return this.scene.frames[this.frame]; }

  /** How many contacts of this frame were found by the time that is set. */
  found(time = this.time) {
    const { first, found } = this.now, { seconds } = this.scene.contacts;
    if (!seconds || time >= this.last) return found;
    let [low, high] = [first, first + found];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (seconds[middle] > time) high = middle; else low = middle + 1;
    }
    return low - first;
  }

  // Drawing

  open(canvas) {
    const { bodies, contacts } = this.scene;
    this.triangles = bodies.reduce((sum, body) => sum + body.triangles.length / 3, 0);
    const stage = this.stage = new Stage(canvas), { gl } = stage;
    for (const body of bodies) {
      body.indices = stage.indices(body.triangles);
      body.buffer = stage.buffer(body.places[0]);
      body.drawn = body.places[0];
    }
    // The lines of more triangles would cover the surfaces.
    if (this.triangles > 12000) this.mode = "shaded";
    this.buffers = { ends: stage.pairBuffer(contacts.ends, 6), values: stage.pairBuffer(this.values, 1) };
    gl.canvas.addEventListener("webglcontextlost", () => this.say("The graphics card has dropped this page. Load it again to see the scene."));
  }

  say(text) {
    $("message").textContent = text;
    $("message").hidden = false;
  }

  /** Numbers from 0 to 1 for the colours of the contacts; -1 for missed ones. */
  tint() {
    const { contacts, frames } = this.scene, values = new Float32Array(contacts.count), known = contacts[this.colour];
    this.range = [Infinity, -Infinity];
    for (const { first, found } of frames)
      for (let k = first; known && k < first + found; k++) {
        if (known[k] < this.range[0]) this.range[0] = known[k];
        if (known[k] > this.range[1]) this.range[1] = known[k];
      }
    const [least, most] = this.range;
    for (const { first, found, missed } of frames) {
      for (let k = first; k < first + found; k++) values[k] = known && most > least ? (known[k] - least) / (most - least) || 0 : 0;
      values.fill(-1, first + found, first + found + missed);
    }
    this.values = values;
    if (this.stage) this.stage.pairBuffer(values, 1, this.buffers.values);
  }

  tones() {
    return [VERMILION, PURPLE, BLUE, JSON.parse(style("--missed")), ORANGE];
  }

  draw() {
    if (!this.stage) return;
    const { stage, scene, mode } = this, { gl } = stage, paper = JSON.parse(style("--paper"));
    const less = this.moving || this.hurried;
    stage.fine = this.smooth && !less;
    stage.begin(this.camera, paper);
    const see = mode === "clear" ? 0.3 : 1;
    scene.bodies.forEach((body, number) => {
      if (!body.shown) return;
      const places = body.places[this.frame], tone = PALE[number % PALE.length];
      if (body.drawn !== places) stage.buffer(body.drawn = places, gl.ARRAY_BUFFER, body.buffer);
      body.buffer.count = places.length / 3;
      const dark = tone.map(c => 0.5 * c);
      if (body.triangles.length) {
        const indices = less && this.coarse ? body.coarse : body.indices;
        stage.body(body.buffer, indices, gl.TRIANGLES, mode === "lines" ? [...paper, 1] : [...tone, see], mode !== "lines", this.part);
      }
      const withLines = (mode === "edges" || mode === "lines") && !(less && this.slowLines);
      if (withLines || (body.lines.length && !body.triangles.length)) {
        body.lined ??= stage.indices(edgesOf(body));
        stage.body(body.buffer, body.lined, gl.LINES, [...(mode === "lines" ? dark : tone.map(c => 0.72 * c)), 1], false);
      }
      if (!body.triangles.length && !body.lines.length) stage.body(body.buffer, null, gl.POINTS, [...dark, 1], false);
    });
    const { first, found, missed } = this.now;
    const tones = this.tones(), [behind, missedBehind] = this.early ? [0, 0] : [0.22, 0.1];
    const how = { radius: this.radius(), line: 0.8, tones, behind, most: less ? this.most : Infinity };
    if ($("missed").checked) stage.pairs(this.buffers, first + found, missed, { ...how, behind: missedBehind });
    stage.pairs(this.buffers, first, this.found(), how);
    this.drawPicked(tones);
    this.status();
  }

  /** Many contacts have smaller dots. */
  radius() {
    return Math.max(1.6, Math.min(4.5, 4.5 - 1.1 * Math.log10(Math.max(1, this.found() / 100))));
  }

  /** The picked contact, larger, with the outlines of its features. */
  drawPicked(tones) {
    if (this.picked < 0) return;
    const { stage, scene } = this, k = this.picked, outlines = [];
    for (const side of [0, 1]) {
      const body = scene.bodies[scene.contacts.body[side][k]], corners = this.corners(side, k), p = body.places[this.frame];
      const at = v => [...p.subarray(3 * v, 3 * v + 3)];
      corners.forEach((v, i) => outlines.push([...at(v), ...at(corners[(i + 1) % corners.length])]));
    }
    const draw = (ends, value, radius, line) => {
      const few = { ends: stage.pairBuffer(ends.flat(), 6), values: stage.pairBuffer(Array(ends.length).fill(value), 1) };
      stage.pairs(few, 0, ends.length, { radius, line, tones, behind: 0.6 });
      Object.values(few).forEach(buffer => stage.gl.deleteBuffer(buffer));
    };
    draw(outlines, 2, 2, 1.4);
    draw([[...scene.contacts.ends.subarray(6 * k, 6 * k + 6)]], this.values[k], 6, 1.4);
  }

  kind(side, k) { return this.scene.kinds[this.scene.contacts.kind[side][k]]; }

  /** The vertices of a feature of a contact. */
  corners(side, k) {
    const body = this.scene.bodies[this.scene.contacts.body[side][k]], feature = this.scene.contacts.feature[side][k];
    const kind = this.kind(side, k);
    if (kind === "vertex") return [feature];
    return kind === "triangle" ? [...body.triangles.subarray(3 * feature, 3 * feature + 3)] : [...edgesOf(body).subarray(2 * feature, 2 * feature + 2)];
  }

  status() {
    const shown = this.found() + ($("missed").checked ? this.now.missed : 0), parts = [];
    const less = this.moving || this.hurried, drawn = less && this.coarse ? this.coarse : this.triangles;
    parts.push(drawn < this.triangles ? `${count(drawn)} of ${count(this.triangles)} triangles` : many(drawn, "triangle"));
    const few = less && shown > this.most ? Math.ceil(shown / Math.ceil(shown / this.most)) : shown;
    parts.push(few < shown ? `${count(few)} of ${count(shown)} contacts` : many(shown, "contact"));
    if (drawn < this.triangles || few < shown) parts.push(this.hurried ? "so that it moves" : "while it moves");
    $("status").textContent = parts.join(", ");
  }

  /** Draws soon, once. */
  later() {
    if (this.waits) return;
    this.waits = true;
    requestAnimationFrame(() => { this.waits = false; this.draw(); });
  }

  /** Something moves: draws less until it rests, where all would be slow. */
  move() {
    this.moving = true;
    clearTimeout(this.rest);
    this.rest = setTimeout(() => { this.moving = false; this.later(); }, 250);
    this.later();
  }

  /** Milliseconds for one picture. */
  took() {
    this.stage.finish();
    const start = performance.now();
    this.draw();
    this.stage.finish();
    return performance.now() - start;
  }

  /** A first picture, before anything is known of how long one takes: of a large scene a sample, and no contacts behind bodies. */
  first() {
    this.early = true;
    [this.hurried, this.slowLines, this.part, this.most] = [true, true, Math.min(1, 20000 / this.triangles), 2000];
    this.draw();
    [this.hurried, this.slowLines, this.part, this.most] = [false, false, 1, Infinity];
    this.early = false;
  }

  /** Decides from a sample what is left out: while something moves, or always where one picture would take a second. */
  measure() {
    const { triangles, scene: { bodies, contacts } } = this, mode = this.mode;
    if (triangles < 10000 && contacts.count < 1000) return void (this.smooth = true);
    [this.hurried, this.mode, this.most, this.part] = [true, "shaded", 1, Math.min(1, 10000 / triangles)];
    this.took();
    const one = this.took() / (this.part * triangles || 1);
    [this.part, this.most] = [0, 1000];
    const pair = this.took() / Math.min(1000, contacts.count || 1);
    [this.part, this.most, this.mode] = [1, Infinity, mode];
    const all = one * triangles + pair * this.found(), half = SLOW / 2;
    this.slowLines = 2.5 * one * triangles > SLOW;
    if (one * triangles > half) {
      const lists = coarse(bodies, Math.max(10000, half / one));
      bodies.forEach((body, k) => body.coarse = this.stage.indices(lists[k]));
      this.coarse = lists.reduce((sum, list) => sum + list.length / 3, 0);
    }
    if (pair * this.found() > half) this.most = Math.max(300, Math.floor(half / pair));
    this.hurried = all > 1000;
    this.smooth = all < 200;
    $("everything").hidden = !this.hurried;
    $("everything").textContent = `Draw all, about ${duration(all / 1000)} a picture`;
  }

  // Looking

  reset() {
    if (!this.stage) return;
    this.fit();
    this.later();
  }

  /** Looks at everything. */
  fit() {
    const { width, height } = this.stage.size();
    const { bodies, contacts, frames } = this.scene, vertices = bodies.reduce((sum, body) => sum + body.places[0].length, 0);
    // Everything of every frame, so that nothing leaves the window; of long films some frames.
    const step = Math.ceil(frames.length * vertices / 6e6), all = new Set();
    for (let f = 0; f < frames.length; f += step) for (const body of bodies) all.add(body.places[f]);
    for (const body of bodies) all.add(body.places[this.frame]);
    this.camera.fit([...all, contacts.ends], width, height);
  }

  /** The contact at a place of the canvas, in pixels of the page; -1 for none. */
  at(x, y) {
    const { clientWidth: w, clientHeight: h } = this.stage.canvas, { ends } = this.scene.contacts, { first, found, missed } = this.now;
    const all = [[first, first + this.found()]];
    if ($("missed").checked) all.push([first + found, first + found + missed]);
    let [best, least] = [-1, Infinity];
    for (const [from, to] of all)
      for (let k = from; k < to; k++) {
        const [px, py, pz] = this.camera.project(ends.subarray(6 * k, 6 * k + 3), w, h);
        const [qx, qy, qz] = this.camera.project(ends.subarray(6 * k + 3, 6 * k + 6), w, h);
        const square = (qx - px) ** 2 + (qy - py) ** 2;
        const t = square > 0 ? Math.max(0, Math.min(1, ((x - px) * (qx - px) + (y - py) * (qy - py)) / square)) : 0;
        const away = Math.hypot(px + t * (qx - px) - x, py + t * (qy - py) - y);
        // Of dots under the finger the one in front; otherwise the nearest.
        const rank = away <= this.radius() ? pz + t * (qz - pz) - 100 : away;
        if (away < 12 && rank < least) [best, least] = [k, rank];
      }
    return best;
  }

  pick(k) {
    this.picked = k;
    this.showPicked();
    this.later();
  }

  /** The contact `by` places further in this frame. */
  step(by) {
    const { first } = this.now, n = this.found();
    if (n) this.pick(this.picked < first ? (by > 0 ? first : first + n - 1) : first + (this.picked - first + by + n) % n);
  }

  closer() {
    const k = this.picked, { ends } = this.scene.contacts;
    if (k < 0 || !this.stage) return;
    this.camera.centre = [0, 1, 2].map(i => (ends[6 * k + i] + ends[6 * k + 3 + i]) / 2);
    const points = [0, 1].flatMap(side => this.corners(side, k).map(v => this.scene.bodies[this.scene.contacts.body[side][k]].places[this.frame].subarray(3 * v, 3 * v + 3)));
    const reach = Math.max(...points.map(p => Math.hypot(...this.camera.centre.map((c, i) => p[i] - c))), 1e-4);
    this.camera.zoom = Math.min(2e4, 0.35 / reach, 40 * this.camera.zoom);
    this.move();
  }

  setFrame(frame) {
    this.frame = Math.max(0, Math.min(this.scene.frames.length - 1, Math.round(frame)));
    this.picked = -1;
    this.row = 0;
    this.show();
    this.move();
  }

  /** `time` in seconds. */
  setTime(time) {
    this.time = time >= this.last ? Infinity : Math.max(0, time);
    const { first, found } = this.now;
    if (this.picked >= first + this.found() && this.picked < first + found) this.picked = -1;
    this.row = 0;
    this.show();
    this.move();
  }
}

"use strict";
// What stands beside and below the view of a scene: legend, sliders, the contact that is picked, the table; keys and fingers.

class Panel extends Scene {
  /** Everything that is said of what is shown. */
  show() {
    const { now, scene } = this, found = this.found(), all = now.hits ?? now.found, lines = [];
    const done = found < now.found;
    const reference = now.reference === null ? "" : ` of ${count(now.reference)}`;
    // In a motion the pairs that are still to come are not missing.
    const recall = now.reference && !scene.contacts.impact ? ` (${share((done ? found : all) / now.reference)})` : "";
    lines.push([done || scene.contacts.impact ? "Hits by then" : "Hits", `${count(done ? found : all)}${reference}${recall}`]);
    if (now.found < all) lines.push(["In this page", `${count(now.found)} of them, evenly chosen`]);
    if (scene.method) lines.push(["Found by", scene.method]);
    if (scene.threshold !== null) lines.push(["Closer than", digits(scene.threshold)]);
    facts($("facts"), [...lines, ...now.facts, ...scene.facts]);
    $("frametext").textContent = now.label || `${this.frame + 1} of ${scene.frames.length}`;
    $("frame").value = this.frame;
    if (!$("times").hidden) {
      const { seconds, evaluation } = scene.contacts, last = now.first + found - 1;
      $("time").value = this.time === Infinity ? 1000 : 1000 * this.time / this.last;
      $("timetext").textContent = `${duration(Math.min(this.time, this.last))}: ${many(found, "hit")}`
        + (evaluation && found ? `, ${many(evaluation[last], "evaluation")}` : "");
      this.grow(seconds);
    }
    $("missing").hidden = now.missed === 0;
    $("missedtext").textContent = `${count(now.missed)} missed`;
    this.legend();
    this.showPicked();
    this.table();
  }

  legend() {
    const [least, most] = this.range, name = this.colour, text = name === "seconds" ? duration : digits;
    $("scale").hidden = !(most > least);
    $("least").textContent = text(least);
    $("most").textContent = text(most);
  }

  /** Hits against time, with a line at the time that is set. */
  grow(seconds) {
    const canvas = $("growth"), ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = 56;
    [canvas.width, canvas.height] = [w * ratio, h * ratio];
    const to = canvas.getContext("2d"), { first, found } = this.now;
    to.scale(ratio, ratio);
    const x = t => 1 + (w - 2) * t / (this.last || 1), y = n => h - 3 - (h - 8) * n / (found || 1), step = Math.max(1, Math.floor(found / w));
    to.beginPath();
    to.moveTo(x(0), y(0));
    for (let k = 0; k < found; k += step) to.lineTo(x(seconds[first + k]), y(k + 1));
    to.lineTo(x(this.last), y(found));
    [to.strokeStyle, to.lineWidth] = [style("--accent"), 1.5];
    to.stroke();
    const at = x(Math.min(this.time, this.last));
    to.fillStyle = style("--ink");
    to.fillRect(at - 0.5, 0, 1, h);
  }

  feature(side, k) {
    const { scene } = this, { body, feature } = scene.contacts, name = scene.bodies[body[side][k]].name;
    return [name, `${this.kind(side, k)} ${feature[side][k]}`];
  }

  showPicked() {
    const k = this.picked, { scene } = this, { contacts } = scene;
    $("picked").hidden = k < 0;
    $("hint").hidden = k >= 0 || contacts.count === 0;
    if (k < 0) return;
    const lines = [0, 1].map(side => {
      const [name, feature] = this.feature(side, k), corners = this.corners(side, k);
      return [name, feature + (this.kind(side, k) === "edge" && corners.length ? ` (vertices ${corners.join(" and ")})` : "")];
    });
    if (contacts.distance) lines.push(["Distance", digits(contacts.distance[k])]);
    if (contacts.impact) lines.push(["Time of impact", digits(contacts.impact[k])]);
    if (k >= this.now.first + this.now.found) lines.push(["Missed", "this pair exists and was not found"]);
    else {
      if (contacts.seconds) lines.push(["Found after", duration(contacts.seconds[k])]);
      if (contacts.evaluation) lines.push(["Evaluation", count(contacts.evaluation[k])]);
      if (scene.method) lines.push(["Found by", scene.method]);
    }
    facts($("pickedfacts"), lines);
  }

  /** A page of the contacts shown, by distance if it is known. */
  table() {
    const { contacts, scene } = this, c = scene.contacts, { first } = this.now, n = this.found();
    const order = Uint32Array.from({ length: n }, (_, k) => first + k);
    if (c.distance) order.sort((a, b) => c.distance[a] - c.distance[b] || a - b);
    const rows = order.subarray(this.row, this.row + ROWS), columns = [["distance", "distance", digits], ["impact", "time of impact", digits], ["evaluation", "evaluation", count], ["seconds", "found after", duration]].filter(([name]) => c[name]);
    const head = make("tr");
    head.append(...["body", "feature", "body", "feature", ...columns.map(([, title]) => title)].map(title => make("th", title)));
    const lines = Array.from(rows, k => {
      const row = make("tr");
      row.append(...[0, 1].flatMap(side => this.feature(side, k)).map(text => make("td", text)), ...columns.map(([name, , text]) => make("td", text(c[name][k]), "number")));
      row.tabIndex = 0;
      row.onclick = () => { this.pick(k); $("view").scrollIntoView({ block: "nearest" }); };
      row.onkeydown = event => event.key === "Enter" && row.onclick();
      return row;
    });
    $("contacts").replaceChildren(head, ...lines);
    $("listed").textContent = n === 0 ? "There are none." : `${count(this.row + 1)} to ${count(this.row + rows.length)} of ${count(n)}${c.distance ? ", the closest first" : ""}`;
    $("pages").hidden = n <= ROWS;
    $("back").disabled = this.row === 0;
    $("more").disabled = this.row + ROWS >= n;
  }

  /** Moves a slider to its end, or stops it. */
  play(which) {
    if (this.playing) return this.stop();
    this.playing = which;
    $(`play${which}`).textContent = "❚❚";
    const { frames } = this.scene, span = which === "time" ? 6000 : Math.max(1500, 120 * frames.length);
    const from = which === "time" ? (this.time >= this.last ? 0 : this.time / this.last) : this.frame >= frames.length - 1 ? 0 : this.frame / (frames.length - 1);
    const begin = performance.now() - from * span;
    const step = () => {
      if (this.playing !== which) return;
      const part = Math.min(1, (performance.now() - begin) / span);
      if (which === "time") this.setTime(part * this.last);
      else if (Math.round(part * (frames.length - 1)) !== this.frame) this.setFrame(part * (frames.length - 1));
      if (part < 1) requestAnimationFrame(step); else this.stop();
    };
    step();
  }

  stop() {
    for (const which of ["time", "frame"]) $(`play${which}`).textContent = "▶";
    this.playing = null;
  }

  // What the visitor does

  wire() {
    const { scene } = this;
    $("about").textContent = scene.bodies.length === 1 ? "1 body" : `${count(scene.bodies.length)} bodies`;
    $("frames").hidden = scene.frames.length < 2;
    $("frame").max = scene.frames.length - 1;
    $("times").hidden = !(this.last > 0);
    [$("time").max, $("time").step] = [1000, "any"];
    $("frame").oninput = () => { this.stop(); this.setFrame(+$("frame").value); };
    $("time").oninput = () => { this.stop(); this.setTime(+$("time").value / 1000 * this.last); };
    for (const which of ["time", "frame"]) $(`play${which}`).onclick = () => this.play(which);
    $("colour").append(...this.colours.map(([name, text]) => Object.assign(make("option", text), { value: name })));
    $("colour").onchange = () => { this.colour = $("colour").value; this.tint(); this.legend(); this.later(); };
    $("mode").value = this.mode;
    $("mode").onchange = () => { this.mode = $("mode").value; this.later(); };
    $("missed").onchange = () => this.later();
    $("everything").onclick = () => { this.hurried = false; $("everything").hidden = true; this.later(); };
    $("reset").onclick = () => this.reset();
    $("before").onclick = () => this.step(-1);
    $("after").onclick = () => this.step(1);
    $("closer").onclick = () => this.closer();
    $("forget").onclick = () => this.pick(-1);
    $("back").onclick = () => { this.row -= ROWS; this.table(); };
    $("more").onclick = () => { this.row += ROWS; this.table(); };
    this.listBodies();
    if (this.stage) this.wireView($("canvas"));
    onScheme(() => { this.show(); this.later(); });
    document.addEventListener("keydown", event => this.key(event));
  }

  listBodies() {
    const { bodies } = this.scene, listed = bodies.slice(0, 500);
    $("bodies").append(...listed.map((body, number) => {
      const line = make("li"), label = make("label"), box = Object.assign(make("input"), { type: "checkbox", checked: true }), dot = make("i");
      dot.style.background = `rgb(${PALE[number % PALE.length].map(c => 255 * c)})`;
      box.onchange = () => { body.shown = box.checked; this.later(); };
      const faces = body.triangles.length / 3;
      const name = make("span");
      // A name that is written from right to left does not turn what follows.
      name.append(make("bdi", body.name), `: ${faces ? many(faces, "triangle") : `${count(body.places[0].length / 3)} vertices`}`);
      label.append(box, dot, name);
      line.append(label);
      return line;
    }));
    if (listed.length < bodies.length) $("bodies").append(make("li", `and ${count(bodies.length - listed.length)} more`));
  }

  wireView(canvas) {
    const fingers = new Map();
    let moved = 0;
    canvas.onpointerdown = event => {
      canvas.setPointerCapture?.(event.pointerId);
      fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
      moved = fingers.size > 1 ? 99 : 0;
    };
    canvas.onpointermove = event => {
      const before = fingers.get(event.pointerId);
      if (!before) return;
      const now = [event.offsetX, event.offsetY], [dx, dy] = [now[0] - before[0], now[1] - before[1]], h = canvas.clientHeight;
      moved += Math.abs(dx) + Math.abs(dy);
      if (moved < 4) return;
      if (fingers.size === 2) {
        const other = [...fingers].find(([id]) => id !== event.pointerId)[1], gap = p => Math.hypot(p[0] - other[0], p[1] - other[1]);
        this.camera.scale(gap(now) / Math.max(1, gap(before)));
        this.camera.move(dx / 2, dy / 2, h);
      } else if (event.shiftKey || event.buttons === 2 || event.buttons === 4) this.camera.move(dx, dy, h);
      else this.camera.turn(dx * 0.008, dy * 0.008);
      fingers.set(event.pointerId, now);
      this.move();
    };
    const up = event => {
      if (fingers.delete(event.pointerId) && moved < 4 && event.type === "pointerup") this.pick(this.at(event.offsetX, event.offsetY));
    };
    canvas.onpointerup = up;
    canvas.onpointercancel = up;
    canvas.oncontextmenu = event => event.preventDefault();
    canvas.addEventListener("wheel", event => {
      event.preventDefault();
      const h = canvas.clientHeight, by = Math.exp(-0.0015 * event.deltaY * (event.deltaMode ? 30 : 1));
      // What is under the pointer stays there.
      const [x, y] = [event.offsetX - canvas.clientWidth / 2, event.offsetY - h / 2];
      this.camera.move(-x, -y, h);
      this.camera.scale(by);
      this.camera.move(x, y, h);
      this.move();
    }, { passive: false });
    canvas.ondblclick = () => this.closer();
    new ResizeObserver(() => { this.show(); this.later(); }).observe(canvas);
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || ["SELECT", "INPUT"].includes(event.target.tagName)) return;
    if (event.target.tagName === "BUTTON" && event.key === " ") return;
    const onView = event.target === $("canvas"), h = $("canvas").clientHeight, which = $("frames").hidden ? "time" : "frame";
    const arrow = (x, y) => onView && (event.shiftKey ? this.camera.move(-40 * x, -40 * y, h) : this.camera.turn(-0.1 * x, -0.1 * y), this.move(), true);
    const done = {
      ArrowLeft: () => arrow(-1, 0), ArrowRight: () => arrow(1, 0), ArrowUp: () => arrow(0, -1), ArrowDown: () => arrow(0, 1),
      "+": () => (this.camera.scale(1.25), this.move(), true), "=": () => (this.camera.scale(1.25), this.move(), true), "-": () => (this.camera.scale(0.8), this.move(), true),
      " ": () => !$(`${which}s`).hidden && (this.play(which), true),
      ",": () => (this.setFrame(this.frame - 1), true), ".": () => (this.setFrame(this.frame + 1), true),
      "[": () => (this.setTime(Math.min(this.time, this.last) - this.last / 50), true), "]": () => (this.setTime(this.time + this.last / 50), true),
      n: () => (this.step(1), true), p: () => (this.step(-1), true), f: () => (this.closer(), true), r: () => (this.reset(), true),
      Escape: () => (this.pick(-1), true),
    }[event.key];
    if (done?.()) event.preventDefault();
  }
}

start(header => {
  const scene = window.page = new Panel(decode(header));
  try {
    scene.open($("canvas"));
  } catch (error) {
    scene.stage = null;
    scene.say(`This browser shows no WebGL 2 (${error.message}): the scene cannot be drawn. The contacts are in the table below.`);
  }
  if (scene.stage) {
    scene.fit();
    scene.first();
  }
  // The rest waits until the first picture is seen.
  return new Promise(done => requestAnimationFrame(() => setTimeout(done))).then(() => {
    performance.mark("first picture");
    scene.wire();
    scene.show();
    if (!scene.stage) return;
    scene.measure();
    scene.draw();
  });
});

"use strict";
// Draws a scene by WebGL 2: bodies, and contacts as dots joined by a line.

const BODY_VERTEX = `#version 300 es
in vec3 place; uniform mat4 view; uniform vec3 scale; uniform float dot_size; out vec3 seen;
void main() { gl_Position = view * vec4(place, 1.0); seen = gl_Position.xyz * scale; gl_PointSize = dot_size; }`;

// The normal is that of the triangle as it is seen, so that none has to be stored.
const BODY_FRAGMENT = `#version 300 es
precision highp float; in vec3 seen; uniform vec4 colour; uniform bool lit; out vec4 result;
void main() {
  float light = 1.0;
  if (lit) { vec3 n = normalize(cross(dFdx(seen), dFdy(seen))); light = 0.5 + 0.5 * abs(dot(n, vec3(0.28, 0.45, 0.85))); }
  result = vec4(colour.rgb * light, colour.a);
}`;

// A pair is a line with round ends, as wide in pixels at any distance. Its four corners are vertices of their own: a renderer in
// software draws each instance of an instanced call by itself.
const PAIR_VERTEX = `#version 300 es
in vec3 a; in vec3 b; in float value;
uniform mat4 view; uniform vec2 size; uniform float radius; uniform float lift;
out vec2 local; out float half_length; out float tint;
void main() {
  tint = value;
  vec2 corner = vec2(float(gl_VertexID & 1), float((gl_VertexID >> 1) & 1)) * 2.0 - 1.0;
  vec4 from = view * vec4(a, 1.0), to = view * vec4(b, 1.0);
  vec2 p = 0.5 * size * from.xy, q = 0.5 * size * to.xy;
  float apart = length(q - p);
  vec2 along = apart > 1e-3 ? (q - p) / apart : vec2(1.0, 0.0);
  half_length = 0.5 * apart;
  local = corner * vec2(half_length + radius + 1.5, radius + 1.5);
  vec2 at = 0.5 * (p + q) + local.x * along + local.y * vec2(-along.y, along.x);
  gl_Position = vec4(2.0 * at / size, mix(from.z, to.z, 0.5 + 0.5 * corner.x) - lift, 1.0);
}`;

const PAIR_FRAGMENT = `#version 300 es
precision highp float; in vec2 local; in float half_length; in float tint;
uniform float radius; uniform float line; uniform vec3 tones[5]; uniform float opacity; out vec4 result;
void main() {
  float ends = length(vec2(abs(local.x) - half_length, local.y)) - radius;
  float bar = max(abs(local.y) - line, abs(local.x) - half_length);
  float outside = min(ends, bar);
  float cover = clamp(0.5 - outside, 0.0, 1.0);
  if (cover < 0.02) discard;
  vec3 tone = tint > 1.5 ? tones[4] : tint < 0.0 ? tones[3] : tint < 0.5 ? mix(tones[0], tones[1], 2.0 * tint) : mix(tones[1], tones[2], 2.0 * tint - 1.0);
  result = vec4(tone * (outside > -1.0 ? 0.75 : 1.0), cover * opacity);
}`;

class Stage {
  /** Whether to draw with more pixels than the screen has. */
  fine = false;

  constructor(canvas) {
    // Edges are smoothed by drawing at rest with twice the pixels: every picture with several samples would be slow in software.
    const gl = canvas.getContext("webgl2", { antialias: false, alpha: false });
    if (!gl) throw new Error("no WebGL 2");
    this.gl = gl;
    this.canvas = canvas;
    this.bodyProgram = this.program(BODY_VERTEX, BODY_FRAGMENT, ["place"]);
    this.pairProgram = this.program(PAIR_VERTEX, PAIR_FRAGMENT, ["a", "b", "value"]);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  }

  program(vertex, fragment, inputs) {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    inputs.forEach((name, place) => gl.bindAttribLocation(program, place, name));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    const at = {};
    for (let k = 0; k < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); k++) {
      const name = gl.getActiveUniform(program, k).name.replace("[0]", "");
      at[name] = gl.getUniformLocation(program, name);
    }
    return { program, at };
  }

  buffer(data, kind = this.gl.ARRAY_BUFFER, old = this.gl.createBuffer()) {
    const gl = this.gl;
    gl.bindVertexArray(null);
    gl.bindBuffer(kind, old);
    gl.bufferData(kind, data, gl.STATIC_DRAW);
    return old;
  }

  indices(data) {
    return { buffer: this.buffer(data, this.gl.ELEMENT_ARRAY_BUFFER), count: data.length };
  }

  /** The size of the window in pixels of the screen. */
  size() {
    const ratio = this.fine ? 2 : Math.min(window.devicePixelRatio || 1, 2), { clientWidth, clientHeight } = this.canvas;
    const [width, height] = [Math.max(1, Math.round(clientWidth * ratio)), Math.max(1, Math.round(clientHeight * ratio))];
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
    return { width, height, ratio };
  }

  begin(camera, background) {
    const gl = this.gl, { width, height, ratio } = this.size();
    this.view = camera.matrix(width, height);
    this.pixel = 2 / (camera.zoom * height);
    this.ratio = ratio;
    gl.viewport(0, 0, width, height);
    gl.clearColor(...background, 1);
    gl.depthMask(true);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const { program, at } = this.bodyProgram;
    gl.useProgram(program);
    gl.uniformMatrix4fv(at.view, false, this.view);
    // Depth is not enlarged with the picture; for the light it has to be, and the width is that of the height.
    gl.uniform3f(at.scale, width / height, 1, -4 * camera.zoom);
    gl.uniform1f(at.dot_size, 3 * ratio);
  }

  /** Triangles, lines or points of a body, or a share of its triangles. */
  body(places, indices, shape, colour, lit, share = 1) {
    const gl = this.gl, { program, at } = this.bodyProgram;
    gl.useProgram(program);
    gl.bindBuffer(gl.ARRAY_BUFFER, places);
    gl.enableVertexAttribArray(0);
    for (const k of [1, 2]) gl.disableVertexAttribArray(k);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.uniform4f(at.colour, ...colour);
    gl.uniform1i(at.lit, lit ? 1 : 0);
    const seeThrough = colour[3] < 1;
    (seeThrough ? gl.enable : gl.disable).call(gl, gl.BLEND);
    gl.depthMask(!seeThrough);
    // Lines lie on surfaces, which give way a little.
    (shape === gl.TRIANGLES ? gl.enable : gl.disable).call(gl, gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    if (!indices) return gl.drawArrays(shape, 0, places.count);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices.buffer);
    gl.drawElements(shape, share < 1 ? 3 * Math.ceil(share * indices.count / 3) : indices.count, gl.UNSIGNED_INT, 0);
  }

  /** Binds the two triangles of each of these pairs, every `step`th; returns how many pairs. */
  quads(first, n, step) {
    const few = Math.ceil(n / step), key = `${first} ${n} ${step}`;
    if (this.bound === key) {
      this.gl.bindBuffer(this.gl.ELEMENT_ARRAY_BUFFER, this.quadBuffer);
      return few;
    }
    const all = new Uint32Array(6 * few);
    for (let k = 0; k < few; k++) {
      const v = 4 * (first + k * step);
      all.set([v, v + 1, v + 2, v + 2, v + 1, v + 3], 6 * k);
    }
    this.quadBuffer = this.buffer(all, this.gl.ELEMENT_ARRAY_BUFFER, this.quadBuffer);
    this.bound = key;
    return few;
  }

  /** A buffer of pairs: `width` numbers of each, four times. */
  pairBuffer(data, width, old) {
    const all = new Float32Array(4 * data.length);
    for (let k = 0; k < data.length; k += width)
      for (let corner = 0; corner < 4; corner++) for (let i = 0; i < width; i++) all[4 * k + corner * width + i] = data[k + i];
    return this.buffer(all, this.gl.ARRAY_BUFFER, old);
  }

  /** Pairs `first..first + n`, about `most` of them if there are more, those behind a body fainter. `tones`: near, middle, far, missed, picked. */
  pairs({ ends, values }, first, n, { radius, line, tones, most = Infinity, behind }) {
    if (n <= 0) return;
    const gl = this.gl, { program, at } = this.pairProgram;
    gl.useProgram(program);
    for (const [place, buffer, length, stride, offset] of [[0, ends, 3, 24, 0], [1, ends, 3, 24, 12], [2, values, 1, 4, 0]]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, length, gl.FLOAT, false, stride, offset);
    }
    const drawn = this.quads(first, n, Math.max(1, Math.ceil(n / most)));
    gl.uniformMatrix4fv(at.view, false, this.view);
    gl.uniform2f(at.size, this.canvas.width, this.canvas.height);
    gl.uniform1f(at.radius, radius * this.ratio);
    gl.uniform1f(at.line, line * this.ratio);
    // Dots are in front of the surface that they lie on.
    gl.uniform1f(at.lift, Math.min(0.02, 0.5 * radius * this.ratio * this.pixel));
    gl.uniform3fv(at.tones, tones.flat());
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    for (const [test, opacity] of [[gl.GREATER, behind], [gl.LEQUAL, 1]]) {
      if (opacity === 0) continue;
      gl.depthFunc(test);
      gl.uniform1f(at.opacity, opacity);
      gl.drawElements(gl.TRIANGLES, 6 * drawn, gl.UNSIGNED_INT, 0);
    }
    gl.depthFunc(gl.LEQUAL);
    gl.depthMask(true);
  }

  /** Waits until all is drawn; the only way to learn how long it takes. */
  finish() {
    this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, new Uint8Array(4));
  }
}

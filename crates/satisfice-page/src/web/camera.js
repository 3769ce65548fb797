"use strict";
// A parallel projection of a world in which z points upwards.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

class Camera {
  constructor() {
    this.azimuth = -76 * Math.PI / 180;
    this.elevation = 24 * Math.PI / 180;
    this.centre = [0, 0, 0];
    this.zoom = 1;
  }

  /** Directions of the window's axes and of the eye. */
  axes() {
    const [c, s] = [Math.cos(this.azimuth), Math.sin(this.azimuth)];
    const [ce, se] = [Math.cos(this.elevation), Math.sin(this.elevation)];
    return { right: [-s, c, 0], up: [-se * c, -se * s, ce], eye: [ce * c, ce * s, se] };
  }

  turn(by, rise) {
    this.azimuth -= by;
    this.elevation = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.elevation + rise));
  }

  /** Moves what is seen by pixels. */
  move(x, y, height) {
    const { right, up } = this.axes(), unit = 2 / (this.zoom * height);
    this.centre = this.centre.map((c, k) => c - unit * (x * right[k] - y * up[k]));
  }

  scale(by) {
    this.zoom = Math.max(0.05, Math.min(2e4, this.zoom * by));
  }

  /** Shows all points from the present direction. */
  fit(points, width, height) {
    const { right, up, eye } = this.axes(), directions = [right, up, eye], low = [9, 9, 9], high = [-9, -9, -9];
    for (const list of points)
      for (let k = 0; k < list.length; k += 3)
        for (let axis = 0; axis < 3; axis++) {
          const d = directions[axis], x = d[0] * list[k] + d[1] * list[k + 1] + d[2] * list[k + 2];
          if (x < low[axis]) low[axis] = x;
          if (x > high[axis]) high[axis] = x;
        }
    if (low[0] > high[0]) return;
    const middle = low.map((x, k) => (x + high[k]) / 2);
    this.centre = [0, 1, 2].map(k => middle[0] * right[k] + middle[1] * up[k] + middle[2] * eye[k]);
    const wide = Math.max(high[0] - low[0], 1e-6) * height / width, tall = Math.max(high[1] - low[1], 1e-6);
    this.zoom = 1.84 / Math.max(wide, tall);
  }

  /** From positions to the cube of WebGL, column by column. */
  matrix(width, height) {
    const { right, up, eye } = this.axes(), c = this.centre;
    const rows = [[right, this.zoom * height / width], [up, this.zoom], [eye, -0.25]];
    const m = new Float32Array(16);
    rows.forEach(([axis, by], row) => {
      for (let k = 0; k < 3; k++) m[4 * k + row] = by * axis[k];
      m[12 + row] = -by * dot(axis, c);
    });
    m[15] = 1;
    return m;
  }

  /** Pixels from the upper left corner, and depth: smaller is nearer. */
  project(p, width, height) {
    const { right, up, eye } = this.axes(), d = [p[0] - this.centre[0], p[1] - this.centre[1], p[2] - this.centre[2]];
    const unit = this.zoom * height / 2;
    return [width / 2 + unit * dot(right, d), height / 2 - unit * dot(up, d), -dot(eye, d)];
  }
}

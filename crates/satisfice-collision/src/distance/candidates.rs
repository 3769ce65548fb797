//! A careful floating-point guess of the nearest pair of features: every pair of their parts is tried and the best kept.
//!
//! Nothing depends on the guess being right; `extended` and `exact` prove or replace it.

use super::Point;
use super::vector::{add, cross, dot, scale, sub};
use super::vertex_edge::parameter;

/// Barycentric weights of a point on each feature, padded with zeros.
#[derive(Debug, Clone, Copy)]
pub(super) struct Guess {
    squared: f64,
    pub(super) a: [f64; 3],
    pub(super) b: [f64; 3],
}

/// The edges of a hull of this many points, as pairs of vertex numbers.
pub(super) fn edges(vertices: usize) -> &'static [[usize; 2]] {
    match vertices {
        1 => &[],
        2 => &[[0, 1]],
        _ => &[[0, 1], [1, 2], [2, 0]],
    }
}

/// The nearest pair of points among all critical pairs of parts, in floating point.
pub(super) fn nearest(a: &[Point], b: &[Point]) -> Guess {
    let mut best = Guess {
        squared: f64::INFINITY,
        a: [0.0; 3],
        b: [0.0; 3],
    };
    for (i, &p) in a.iter().enumerate() {
        for (j, &q) in b.iter().enumerate() {
            best.consider(sub(p, q), &[(i, 1.0)], &[(j, 1.0)]);
        }
        for &[j, k] in edges(b.len()) {
            let e = sub(b[k], b[j]);
            let t = parameter(p, b[j], e);
            best.consider(
                sub(sub(p, b[j]), scale(e, t)),
                &[(i, 1.0)],
                &[(j, 1.0 - t), (k, t)],
            );
        }
        if let [q, r, s] = *b
            && let Some((v, [x, y, z])) = face(p, q, r, s)
        {
            best.consider(v, &[(i, 1.0)], &[(0, x), (1, y), (2, z)]);
        }
    }
    for (j, &q) in b.iter().enumerate() {
        for &[i, k] in edges(a.len()) {
            let e = sub(a[k], a[i]);
            let t = parameter(q, a[i], e);
            best.consider(
                sub(sub(a[i], q), scale(e, -t)),
                &[(i, 1.0 - t), (k, t)],
                &[(j, 1.0)],
            );
        }
        if let [p, r, s] = *a
            && let Some((v, [x, y, z])) = face(q, p, r, s)
        {
            best.consider(scale(v, -1.0), &[(0, x), (1, y), (2, z)], &[(j, 1.0)]);
        }
    }
    for &[i, k] in edges(a.len()) {
        for &[j, l] in edges(b.len()) {
            if let Some((v, s, t)) = crossing(a[i], a[k], b[j], b[l]) {
                best.consider(v, &[(i, 1.0 - s), (k, s)], &[(j, 1.0 - t), (l, t)]);
            }
        }
    }
    best
}

impl Guess {
    /// A guess of the parts alone: vertices with a weight above 0.
    pub(super) fn of_parts(a: [f64; 3], b: [f64; 3]) -> Self {
        Self { squared: 0.0, a, b }
    }

    fn consider(&mut self, v: Point, a: &[(usize, f64)], b: &[(usize, f64)]) {
        let squared = dot(v, v);
        if squared < self.squared {
            *self = Self {
                squared,
                a: spread(a),
                b: spread(b),
            };
        }
    }
}

fn spread(weights: &[(usize, f64)]) -> [f64; 3] {
    let mut all = [0.0; 3];
    for &(k, weight) in weights {
        all[k] = weight;
    }
    all
}

/// Difference and weights if `p` projects into the inside of the triangle.
fn face(p: Point, q: Point, r: Point, s: Point) -> Option<(Point, [f64; 3])> {
    let (x, y, w) = (sub(r, q), sub(s, q), sub(p, q));
    let n = cross(x, y);
    let nn = dot(n, n);
    let (t, u) = (dot(n, cross(w, y)) / nn, dot(n, cross(x, w)) / nn);
    (t > 0.0 && u > 0.0 && t + u < 1.0).then(|| (scale(n, dot(n, w) / nn), [1.0 - t - u, t, u]))
}

/// Difference and parameters if the lines `p q` and `r s` come nearest inside both segments.
fn crossing(p: Point, q: Point, r: Point, s: Point) -> Option<(Point, f64, f64)> {
    let (d, e, w) = (sub(q, p), sub(s, r), sub(p, r));
    let n = cross(d, e);
    let nn = dot(n, n);
    let (x, y) = (dot(n, cross(e, w)) / nn, dot(n, cross(d, w)) / nn);
    (x > 0.0 && x < 1.0 && y > 0.0 && y < 1.0).then(|| {
        let v = sub(add(w, scale(d, x)), scale(e, y));
        (v, x, y)
    })
}

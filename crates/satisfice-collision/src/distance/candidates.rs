//! A floating-point guess of the closest points: every pair of parts is tried and the best kept.
//!
//! No answer depends on the guess; `extended` and `exact` prove or replace it.

use super::vector::{dot, scale, sub};
use super::{Point, Triangle, closest};

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

/// The closest pair of points among all critical pairs of parts, in floating point.
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
            let t = closest::on_segment(p, b[j], e);
            best.consider(
                sub(sub(p, b[j]), scale(e, t)),
                &[(i, 1.0)],
                &[(j, 1.0 - t), (k, t)],
            );
        }
        if let Ok(face) = <&Triangle>::try_from(b)
            && let Some((v, [x, y, z])) = closest::inside_triangle(p, face)
        {
            best.consider(v, &[(i, 1.0)], &[(0, x), (1, y), (2, z)]);
        }
    }
    for (j, &q) in b.iter().enumerate() {
        for &[i, k] in edges(a.len()) {
            let e = sub(a[k], a[i]);
            let t = closest::on_segment(q, a[i], e);
            best.consider(
                sub(sub(a[i], q), scale(e, -t)),
                &[(i, 1.0 - t), (k, t)],
                &[(j, 1.0)],
            );
        }
        if let Ok(face) = <&Triangle>::try_from(a)
            && let Some((v, [x, y, z])) = closest::inside_triangle(q, face)
        {
            best.consider(scale(v, -1.0), &[(0, x), (1, y), (2, z)], &[(j, 1.0)]);
        }
    }
    for &[i, k] in edges(a.len()) {
        for &[j, l] in edges(b.len()) {
            if let Some((v, s, t)) = closest::inside_segments(&[a[i], a[k]], &[b[j], b[l]]) {
                best.consider(v, &[(i, 1.0 - s), (k, s)], &[(j, 1.0 - t), (l, t)]);
            }
        }
    }
    best
}

impl Guess {
    /// A guess of the parts alone: those vertices with a positive weight.
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

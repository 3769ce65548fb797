//! Brute force over all vertex pairs: the reference for every faster method.

use crate::distance::{Threshold, vertex_vertex};
use crate::mesh::Adjacency;

/// All pairs `[i, j]` with `|a_i - b_j| < delta`, sorted. Exact for all finite coordinates. Cost: O(|a| |b|).
///
/// ```
/// use satisfice_collision::{distance::Threshold, oracle};
/// let a = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
/// let b = [[1.5, 0.0, 0.0]];
/// assert_eq!(oracle::pairs_between(&a, &b, Threshold::new(1.0)?), [[1, 0]]);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[must_use]
pub fn pairs_between(a: &[[f64; 3]], b: &[[f64; 3]], threshold: Threshold) -> Vec<[u32; 2]> {
    let columns = Columns::new(b);
    let mut pairs = Vec::new();
    for (i, &p) in a.iter().enumerate() {
        if columns.candidates(p, 0, threshold) > 0 {
            for (j, q) in b.iter().enumerate() {
                if vertex_vertex::within(&p, q, threshold) {
                    pairs.push([i as u32, j as u32]);
                }
            }
        }
    }
    pairs
}

/// All pairs `[i, j]` of one body with `i < j`, `|a_i - a_j| < delta` and `j` not among the `excluded` of `i`, sorted.
/// Exact for all finite coordinates. Cost: O(|a|^2 / 2).
#[must_use]
pub fn pairs_within(a: &[[f64; 3]], excluded: &Adjacency, threshold: Threshold) -> Vec<[u32; 2]> {
    let columns = Columns::new(a);
    let mut pairs = Vec::new();
    for (i, &p) in a.iter().enumerate() {
        if columns.candidates(p, i + 1, threshold) > 0 {
            for (j, q) in a.iter().enumerate().skip(i + 1) {
                let (i, j) = (i as u32, j as u32);
                if !excluded.contains(i, j) && vertex_vertex::within(&p, q, threshold) {
                    pairs.push([i, j]);
                }
            }
        }
    }
    pairs
}

/// Coordinates by axis, so that the compiler can use vector instructions.
struct Columns {
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
}

impl Columns {
    fn new(points: &[[f64; 3]]) -> Self {
        let column = |k: usize| points.iter().map(|p| p[k]).collect();
        Self {
            x: column(0),
            y: column(1),
            z: column(2),
        }
    }

    /// An upper bound of the number of points from `start` on that are closer to `p` than the threshold.
    fn candidates(&self, p: [f64; 3], start: usize, threshold: Threshold) -> u32 {
        // Six roundings make the computed square too large by a factor below 1 + 4 EPSILON; underflow adds less than the
        // smallest normal number.
        let limit = threshold.squared_above() * (1.0 + 8.0 * f64::EPSILON) + f64::MIN_POSITIVE;
        let [x, y, z] = [&self.x[start..], &self.y[start..], &self.z[start..]];
        let mut count = 0;
        for ((x, y), z) in x.iter().zip(y).zip(z) {
            let [u, v, w] = [x - p[0], y - p[1], z - p[2]];
            count += u32::from(u * u + v * v + w * w <= limit);
        }
        count
    }
}

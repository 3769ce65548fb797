//! The distance of two points, rounded to the correct side of delta.

use crate::distance::{Threshold, vertex_vertex};
use crate::mesh::Mesh;

/// F of a pair of points: within a few units in the last place, and below delta exactly if the distance is.
#[derive(Debug, Clone, Copy)]
pub(super) struct PointMetric {
    threshold: Threshold,
    /// Squares below the first are certainly below delta^2; squares above the second are certainly not.
    band: [f64; 2],
}

impl PointMetric {
    pub(super) fn new(threshold: Threshold) -> Self {
        Self {
            threshold,
            band: band(threshold),
        }
    }

    #[inline]
    pub(super) fn distance(&self, p: &[f64; 3], q: &[f64; 3]) -> f64 {
        let square = square(p, q);
        // Above 1e300 a sum may have overflowed.
        if square < self.band[0] || (square > self.band[1] && square < 1e300) {
            square.sqrt()
        } else {
            self.resolve(p, q)
        }
    }

    /// The distances, with the same bits as from `distance`; `false` if one of them is a rare case.
    #[inline]
    pub(super) fn distances<const N: usize>(&self, d: &[[f64; N]; 3], distances: &mut [f64]) -> bool {
        let mut trusted = true;
        for (lane, distance) in distances.iter_mut().enumerate().take(N) {
            let square = d[0][lane] * d[0][lane] + d[1][lane] * d[1][lane] + d[2][lane] * d[2][lane];
            trusted &= (square < self.band[0]) | ((square > self.band[1]) & (square < 1e300));
            *distance = square.sqrt();
        }
        trusted
    }

    /// The rare cases: squares within rounding of delta^2, and squares that underflow or overflow.
    #[cold]
    fn resolve(&self, p: &[f64; 3], q: &[f64; 3]) -> f64 {
        if p == q {
            return 0.0;
        }
        let delta = self.threshold.get();
        let distance = vertex_vertex::proximity(p, q).distance.min(f64::MAX);
        if vertex_vertex::within(p, q, self.threshold) {
            distance.min(delta.next_down())
        } else {
            distance.max(delta)
        }
    }
}

#[inline]
pub(super) fn square(p: &[f64; 3], q: &[f64; 3]) -> f64 {
    let [x, y, z] = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    x * x + y * y + z * z
}

/// F of an excluded pair: finite, at least delta, and at least every distance within the body.
pub(super) fn far(mesh: &Mesh, delta: f64) -> f64 {
    let [x, y, z] = mesh.bounds().extents();
    x.hypot(y).hypot(z).next_up().max(delta).min(f64::MAX)
}

/// `|p - q|^2` from three differences, three products and two sums: within 6 roundings of the true square, unless a
/// significant product underflows.
fn band(threshold: Threshold) -> [f64; 2] {
    const SLACK: f64 = 8.0 * f64::EPSILON;
    // Below this, a product that underflowed may be significant.
    const TINY: f64 = 1e-270;
    let below = threshold.squared_below() * (1.0 - SLACK);
    let above = threshold.squared_above() * (1.0 + SLACK);
    [if below < TINY { 0.0 } else { below }, above.max(TINY)]
}

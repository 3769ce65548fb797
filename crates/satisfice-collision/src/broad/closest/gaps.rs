//! Lower bounds of the distances of boxes of two bodies.
//!
//! Boxes are compared in `f64`, so that bodies may be far apart: what is wrong by a rounding of `f32` is the box of a feature in
//! the frame of its own body, not the way between the bodies. With the names of `relative`, a side is wrong by at most
//! e = e_b + sqrt(3) r e_a and 2^-45 times all lengths involved, and the gap g of two boxes proves a distance of at least
//! (g - 2 sqrt(3) e) / s_b.

use crate::broad::boxes::Group;
use crate::broad::frame::power_of_two;
use crate::broad::pair_query::PairQuery;
use crate::broad::relative::Composition;

/// Eight boxes in `f64`.
struct Wide {
    lower: [[f64; 8]; 3],
    upper: [[f64; 8]; 3],
}

/// How the first tree lies in the frame of the second, and what gaps of boxes prove there.
pub(super) struct Gaps {
    matrix: [[f64; 3]; 3],
    shift: [f64; 3],
    /// A gap exceeds the distance by at most this.
    error: f64,
    scale: f64,
}

impl Gaps {
    pub(super) fn new(way: &Composition) -> Self {
        let side = way.b_error
            + 1.7321 * way.ratio * way.a_error
            + power_of_two(-45) * way.lengths
            + power_of_two(-140);
        // squares of larger numbers could overflow, and then nothing is proved
        let sane = way.lengths < power_of_two(500);
        Self {
            matrix: way.matrix.map(|row| row.map(|m| m * way.ratio)),
            shift: way.shift,
            error: if sane { 3.4642 * side } else { f64::INFINITY },
            scale: way.scale,
        }
    }

    /// Of a body with itself.
    pub(super) fn within(query: &PairQuery<'_>) -> Self {
        let frame = &query.a.0.frame;
        Self {
            matrix: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            shift: [0.0; 3],
            error: 3.4642 * (frame.error + power_of_two(-45) * frame.half) + power_of_two(-140),
            scale: frame.scale,
        }
    }

    /// Boxes with a gap whose square is greater are further apart than `distance`.
    pub(super) fn limit(&self, distance: f64) -> f64 {
        let limit = (distance * self.scale + self.error) * (1.0 + power_of_two(-48));
        limit * limit
    }

    /// Boxes of the first tree in the frame of the second.
    #[inline(always)]
    fn bring(&self, of: &Group) -> Wide {
        let mut wide = Wide {
            lower: [[0.0; 8]; 3],
            upper: [[0.0; 8]; 3],
        };
        for i in 0..3 {
            for l in 0..8 {
                let (mut centre, mut half) = (self.shift[i], 0.0);
                for k in 0..3 {
                    let (low, high) = (f64::from(of.lower[k][l]), f64::from(of.upper[k][l]));
                    centre += self.matrix[i][k] * (0.5 * (low + high));
                    half += self.matrix[i][k].abs() * (0.5 * (high - low));
                }
                wide.lower[i][l] = centre - half;
                wide.upper[i][l] = centre + half;
            }
        }
        wide
    }

    /// The squared gaps between eight boxes and eight others.
    #[inline(always)]
    pub(super) fn squares(&self, a: &Group, b: &Group) -> [[f64; 8]; 8] {
        let a = self.bring(a);
        let mut squares = [[0.0; 8]; 8];
        for k in 0..3 {
            for (i, row) in squares.iter_mut().enumerate() {
                let (low, high) = (a.lower[k][i], a.upper[k][i]);
                for (l, square) in row.iter_mut().enumerate() {
                    let below = f64::from(b.lower[k][l]) - high;
                    let above = low - f64::from(b.upper[k][l]);
                    let gap = if below > above { below } else { above };
                    // not NaN, which proves nothing
                    let gap = if gap > 0.0 { gap } else { 0.0 };
                    *square += gap * gap;
                }
            }
        }
        squares
    }
}

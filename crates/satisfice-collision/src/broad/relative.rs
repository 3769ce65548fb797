//! How one body lies in the frame of another: a rotation, a scale and a shift in `f32`, and what their rounding costs.
//!
//! With world = R p + t, the frame of b holds q = (R_b^T (R_a p + t_a - t_b) - o_b) s_b. Errors on every axis, in the unit of
//! that frame, with r = s_b / s_a <= 1, h the largest coordinate of a in its own frame and c the shift: e_b for b's own
//! coordinates; sqrt(3) r e_a for a's; the `f32` matrix, three products and three sums of numbers up to sqrt(3) r h and c:
//! below 8u (2 r h + |c|); the `f64` arithmetic of posing and of this composition: below 2^-46 times all lengths involved (a
//! rotation matrix made from a rounded quaternion is orthonormal within 2^-50). A box turned with its centre and the absolute
//! matrix is wrong by no more. h is below 2 unless the body is larger than any power of two can bring there.

use super::boxes::Group;
use super::directions::Directions;
use super::frame::{Filter, LocalFrame, U, power_of_two};
use crate::Placement;
use crate::simd::Eight;

/// How the frame of one posed body lies in that of another, in `f64`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Composition {
    /// A rotation.
    pub(crate) matrix: [[f64; 3]; 3],
    /// In the unit of the second frame.
    pub(crate) shift: [f64; 3],
    pub(crate) turned: bool,
    /// The unit of the first frame in that of the second; at most 1.
    pub(crate) ratio: f64,
    /// The scale of the second frame.
    pub(crate) scale: f64,
    /// The sum of all lengths involved, in the unit of the second frame.
    pub(crate) lengths: f64,
    pub(crate) a_half: f64,
    pub(crate) b_half: f64,
    pub(crate) a_error: f64,
    pub(crate) b_error: f64,
    /// Whether either body has coordinates that are far.
    pub(crate) has_far: bool,
}

impl Composition {
    /// From the frame `a` of a body at `pose_a` into the frame `b` of one at `pose_b`. Wants `b.scale <= a.scale`.
    pub(crate) fn new(a: &LocalFrame, pose_a: &Placement, b: &LocalFrame, pose_b: &Placement) -> Self {
        let (ra, rb) = (pose_a.rotation(), pose_b.rotation());
        let (ta, tb) = (pose_a.translation(), pose_b.translation());
        let ratio = b.scale / a.scale;
        let product = |i: usize, j: usize| (0..3).map(|k| rb[k][i] * ra[k][j]).sum::<f64>();
        let turned = ra != rb;
        let matrix: [[f64; 3]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                if turned {
                    product(i, j)
                } else {
                    f64::from(u8::from(i == j))
                }
            })
        });
        // o_a and the translations, turned into b's axes; their difference first, where it may cancel
        let moved: [f64; 3] = std::array::from_fn(|k| ta[k] - tb[k]);
        let shift: [f64; 3] = std::array::from_fn(|i| {
            let translation = (0..3).map(|k| rb[k][i] * moved[k]).sum::<f64>();
            let origin = if turned {
                (0..3).map(|j| matrix[i][j] * a.origin[j]).sum::<f64>() - b.origin[i]
            } else {
                a.origin[i] - b.origin[i]
            };
            (translation + origin) * b.scale
        });
        let largest = |v: &[f64; 3]| v.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        let lengths = [&ta, &tb, &a.origin, &b.origin]
            .map(largest)
            .iter()
            .map(|l| l * b.scale)
            .sum::<f64>()
            + a.half * ratio
            + b.half;
        Self {
            matrix,
            shift,
            turned,
            ratio,
            scale: b.scale,
            lengths,
            a_half: a.half,
            b_half: b.half,
            a_error: a.error,
            b_error: b.error,
            has_far: a.has_far || b.has_far,
        }
    }
}

/// Brings coordinates of one frame into another.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Relative {
    matrix: [[f32; 3]; 3],
    shift: [f32; 3],
    /// The absolute values of the matrix.
    absolute: [[f32; 3]; 3],
    /// Whether this changes nothing.
    same: bool,
    turned: bool,
    /// One over the scale of the matrix.
    inverse: f32,
}

impl Relative {
    /// From one frame into another, and what `f32` distances there say about the threshold `delta`.
    pub(crate) fn new(way: &Composition, delta: f64) -> (Self, Filter) {
        let Composition {
            turned,
            ratio,
            a_half,
            b_half,
            lengths,
            ..
        } = *way;
        let c = way.shift.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        let error = way.b_error
            + 1.7321 * ratio * way.a_error
            + 8.0 * U * (2.0 * ratio * a_half + c)
            + power_of_two(-46) * lengths
            + power_of_two(-140);
        let scaled = delta * way.scale;
        // beyond this f32 squares could overflow: let everything pass to the exact decision
        let sane = c < power_of_two(55) && scaled < power_of_two(55) && error.is_finite();
        let error = if sane { error } else { f64::INFINITY };
        let matrix = way.matrix.map(|row| row.map(|m| (m * ratio) as f32));
        let relative = Self {
            matrix,
            absolute: matrix.map(|row| row.map(f32::abs)),
            same: false,
            shift: if sane {
                way.shift.map(|s| s as f32)
            } else {
                [0.0; 3]
            },
            turned,
            // a matrix of denormal numbers says nothing about directions
            inverse: if ratio > power_of_two(-100) {
                (1.0 / ratio) as f32
            } else {
                0.0
            },
        };
        let half = c + 2.0 * (ratio * a_half).max(b_half);
        (relative, Filter::new(scaled, error, half))
    }

    /// Within one frame.
    pub(crate) fn same() -> Self {
        Self {
            matrix: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            absolute: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            same: true,
            shift: [0.0; 3],
            turned: false,
            inverse: 1.0,
        }
    }

    /// Whether the axes differ.
    #[inline(always)]
    pub(crate) fn is_turned(&self) -> bool {
        self.turned
    }

    /// One point.
    #[inline(always)]
    pub(crate) fn point(&self, q: [f32; 3]) -> [f32; 3] {
        std::array::from_fn(|i| {
            let m = self.matrix[i];
            m[0] * q[0] + m[1] * q[1] + m[2] * q[2] + self.shift[i]
        })
    }

    /// Four directions, turned but not scaled.
    #[inline(always)]
    pub(crate) fn directions(&self, of: &Directions) -> Directions {
        std::array::from_fn(|i| {
            let m = self.matrix[i].map(|m| m * self.inverse);
            std::array::from_fn(|l| m[0] * of[0][l] + m[1] * of[1][l] + m[2] * of[2][l])
        })
    }

    /// Eight points, one per lane; `room` is for the answer, where it differs from the question.
    #[inline(always)]
    pub(crate) fn points<'r>(&self, c: &'r [Eight; 3], room: &'r mut [Eight; 3]) -> &'r [Eight; 3] {
        if self.same {
            return c;
        }
        if self.turned {
            turn(&self.matrix, c, room);
            shift(room, self.shift);
        } else {
            self.moved(c, room);
        }
        room
    }

    #[inline(always)]
    fn moved(&self, c: &[Eight; 3], to: &mut [Eight; 3]) {
        for i in 0..3 {
            for l in 0..8 {
                to[i][l] = self.matrix[i][i] * c[i][l] + self.shift[i];
            }
        }
    }

    /// Boxes around eight boxes; `room` is for the answer, where it differs from the question.
    #[inline(always)]
    pub(crate) fn boxes<'r>(&self, of: &'r Group, room: &'r mut Group) -> &'r Group {
        if self.same {
            return of;
        }
        if !self.turned {
            self.moved(&of.lower, &mut room.lower);
            self.moved(&of.upper, &mut room.upper);
            return room;
        }
        let (mut centre, mut half) = ([[0.0; 8]; 3], [[0.0; 8]; 3]);
        for k in 0..3 {
            for l in 0..8 {
                centre[k][l] = 0.5 * (of.lower[k][l] + of.upper[k][l]);
                half[k][l] = 0.5 * (of.upper[k][l] - of.lower[k][l]);
            }
        }
        let (mut turned_centre, mut turned_half) = ([[0.0; 8]; 3], [[0.0; 8]; 3]);
        turn(&self.matrix, &centre, &mut turned_centre);
        shift(&mut turned_centre, self.shift);
        turn(&self.absolute, &half, &mut turned_half);
        for i in 0..3 {
            for l in 0..8 {
                room.lower[i][l] = turned_centre[i][l] - turned_half[i][l];
                room.upper[i][l] = turned_centre[i][l] + turned_half[i][l];
            }
        }
        room
    }
}

// Loops rather than closures, which are compiled for the vector unit only where the compiler chooses to inline them.

#[inline(always)]
fn turn(matrix: &[[f32; 3]; 3], c: &[Eight; 3], to: &mut [Eight; 3]) {
    for i in 0..3 {
        let m = matrix[i];
        for l in 0..8 {
            to[i][l] = m[0] * c[0][l] + m[1] * c[1][l] + m[2] * c[2][l];
        }
    }
}

#[inline(always)]
fn shift(c: &mut [Eight; 3], by: [f32; 3]) {
    for (axis, by) in c.iter_mut().zip(by) {
        for c in axis {
            *c += by;
        }
    }
}

//! Proofs in floating point about a hull whose corners move: apart, near, crossing.
//!
//! # Error bounds
//! u = 2^-53. The frame holds `w^ = fl(a_i - b_j)` at both ends of the step, times a power of two, so each component has
//! a relative error of at most u; `size` bounds all components and lies in [1, 2). Underflow adds at most 2^-1070 anywhere and vanishes in
//! `TINY`. A direction n is an exact vector, whatever it was meant to be.
//!
//! **Apart.** `fl(n.w^)` differs from `n.w` by less than `4.01 u sum_k |n_k w_k|`: the component, three products, two sums.
//! We subtract `8 u fl(sum)` and `TINY`. The results G0, G1 are at most `n.w` at both ends of the step, so the line between them
//! is at most `n.w(t)` for all t. Where it is at least `delta |n|`, rounded up, for every corner, the hull is not nearer than
//! delta. The times at which the line crosses that value are rounded towards the safe side.
//!
//! **At a time.** `w(t)` as computed, `w0 + t (w1 - w0)`, is off by at most `6 u size` a component.
//!
//! **Near.** A point `w + u x + v y` computed from such corners with weights that may leave the hull by 4u is off by less than
//! `100 u size` a component, below `256 u size` in length.
//!
//! **Crossing.** If the volume `det(w, x, y)` has different signs at two times, and the origin is inside the hull all the time
//! seen along some axis, the hull contains the origin at some time between: at the root of the volume the origin lies in the
//! plane of the face, and a plane that is not seen edge-on is seen one to one. With components off by at most `e = 20 u size`
//! (of x and y too), and bounds X, Y of those of x and y, the volume is off by less than
//! `6 (e (XY + WX + WY) + 6 u WXY)` plus terms of second order; we use 16 in place of 6 after adding e to every bound. Inside
//! is a matter of cross products of two corners along an axis. These are quadratic in the time, so their coefficients
//! in Bernstein's form bound them; each is off by less than `4 e W + 4 u W^2 < 100 u W^2`; we use `256 u`.

use super::cubic::Volumes;
use super::hull::{Face, Hull};
use super::motion::PairMotion;
use super::nearest::Nearest;
use super::vector::{along, cross, dot, largest, sub};
use crate::distance::Point;

/// 2^-53.
pub(super) const U: f64 = f64::EPSILON / 2.0;
/// More than all underflows of a sum of products.
pub(super) const TINY: f64 = 1e-300;
/// Sizes outside `[1 / RANGE, RANGE]` are left to integers.
pub(super) const RANGE: f64 = 1e250;
/// How far on each side of a computed root of the volume its sign is examined.
const WIDTHS: [f64; 7] = [1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2];

/// The differences of a pair at both ends of the step, and delta, in one unit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Swept<const K: usize> {
    from: [Point; K],
    to: [Point; K],
    /// No component is larger.
    size: f64,
    /// At least delta.
    above: f64,
    /// At most delta.
    below: f64,
    /// Whether delta is 0, so that a hit is a distance of 0.
    is_touching: bool,
}

impl<const K: usize> Swept<K> {
    /// `None` if a coordinate is not finite, or if the differences are all 0, huge or tiny.
    #[inline(always)]
    pub(super) fn new<const M: usize, const N: usize>(motion: &PairMotion<M, N>, delta: f64) -> Option<Self> {
        let mut from = [[0.0; 3]; K];
        let mut to = [[0.0; 3]; K];
        let (mut size, mut sum) = (0.0_f64, 0.0);
        for i in 0..M {
            for j in 0..N {
                let (p, q) = (
                    sub(motion.from_a[i], motion.from_b[j]),
                    sub(motion.to_a[i], motion.to_b[j]),
                );
                from[i * N + j] = p;
                to[i * N + j] = q;
                size = size.max(largest(p)).max(largest(q));
                // NaN and infinity stay in the sum.
                sum += (p[0] + p[1] + p[2]) + (q[0] + q[1] + q[2]);
            }
        }
        let is_in_range = sum.abs() < RANGE && size < RANGE && size > 1.0 / RANGE;
        // NaN is in no range.
        if !is_in_range {
            return None;
        }
        let scale = inverse_power_of_two(size);
        for p in from.iter_mut().chain(&mut to) {
            *p = p.map(|x| x * scale);
        }
        let is_touching = delta == 0.0;
        let delta = delta * scale;
        Some(Self {
            from,
            to,
            size: size * scale,
            above: delta * (1.0 + 4.0 * U) + TINY,
            below: delta * (1.0 - 4.0 * U) - TINY,
            is_touching,
        })
    }

    /// Whether a hit is a distance of 0.
    #[inline(always)]
    pub(super) fn is_for_touching(&self) -> bool {
        self.is_touching
    }

    /// The corners at a time, approximately.
    #[inline(always)]
    pub(super) fn at(&self, time: f64) -> [Point; K] {
        std::array::from_fn(|k| along(self.from[k], sub(self.to[k], self.from[k]), time))
    }

    /// The times around `time` (in `[0, 1]`) at which `direction` proves the hull apart; `None` if not at `time` itself.
    #[inline(always)]
    pub(super) fn apart_around(&self, direction: Point, time: f64) -> Option<(f64, f64)> {
        let scale = largest(direction);
        // A direction too short for the bounds, or none.
        if scale.is_nan() || scale <= 1e-100 {
            return None;
        }
        let n = direction.map(|x| x * (1.0 / scale));
        let threshold = self.above * (dot(n, n).sqrt() * (1.0 + 8.0 * U));
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        for k in 0..K {
            let from = lower_bound(n, self.from[k]) - threshold;
            let to = lower_bound(n, self.to[k]) - threshold;
            if from < 0.0 {
                if to < 0.0 {
                    return None;
                }
                // Rounded up; the quotient has three roundings.
                first = first.max(from / (from - to) * (1.0 + 8.0 * U));
            } else if to < 0.0 {
                last = last.min(from / (from - to) * (1.0 - 8.0 * U));
            }
        }
        (first <= time && time < last).then_some((first, last))
    }

    /// Whether the guess proves a distance below delta.
    #[inline(always)]
    pub(super) fn is_near(&self, nearest: &Nearest) -> bool {
        let room = self.below - 256.0 * U * self.size;
        room > 0.0 && dot(nearest.point, nearest.point) * (1.0 + 8.0 * U) < room * room * (1.0 - 2.0 * U)
    }

    /// A time by which the hull, one with a face, provably contains the origin, at or after the first time that it does so
    /// between `first` and `last`, as far as the roots of the volume can be told apart from misses.
    pub(super) fn crossing<H: Hull<K>>(&self, first: f64, last: f64) -> Option<f64> {
        let volumes = self.volumes(H::PARTS.face?, first, last);
        let length = last - first;
        volumes.sign_changes().into_iter().flatten().find_map(|part| {
            let root = first + length * volumes.root(part);
            WIDTHS.iter().find_map(|width| {
                let (low, high) = ((root - width).max(first), (root + width).min(last));
                self.crosses::<H>(low, high)?.then_some(high)
            })
        })
    }

    /// Whether the hull provably contains the origin at some time in `first..=last`; `None` if the volume does not provably
    /// change its sign.
    fn crosses<H: Hull<K>>(&self, first: f64, last: f64) -> Option<bool> {
        let face = H::PARTS.face?;
        let (p, q) = (self.at(first), self.at(last));
        let [i, j, k] = face.corners;
        let (before, after) = (self.volume([p[i], p[j], p[k]]), self.volume([q[i], q[j], q[k]]));
        if before * after >= 0.0 {
            return None;
        }
        let normal = cross(sub(p[j], p[i]), sub(p[k], p[i])).map(f64::abs);
        let axis = (0..3).fold(0, |best, k| if normal[k] > normal[best] { k } else { best });
        let sides = |side: usize| self.side(&p, &q, H::SIDES[side], axis);
        Some(if face.is_parallelogram {
            sides(0) * sides(1) < 0 && sides(2) * sides(3) < 0
        } else {
            let first = sides(0);
            first != 0 && sides(1) == first && sides(2) == first
        })
    }

    /// The volume of the corners `w`, `w + x`, `w + y`: a number of its sign, or 0 if that is not certain.
    fn volume(&self, [w, p, q]: [Point; 3]) -> f64 {
        let (x, y) = (sub(p, w), sub(q, w));
        let error = 20.0 * U * self.size;
        let volume = dot(w, cross(x, y));
        let (w, x, y) = (largest(w) + error, largest(x) + error, largest(y) + error);
        let bound = 16.0 * (error * (x * y + w * x + w * y) + 6.0 * U * w * x * y);
        if volume.abs() > bound {
            volume.signum()
        } else {
            0.0
        }
    }

    /// The sign of the cross product of two corners along `axis` from one time to another; 0 if it is not certain that it
    /// has one sign.
    fn side(&self, p: &[Point; K], q: &[Point; K], [i, j]: [usize; 2], axis: usize) -> i32 {
        let (k, l) = ((axis + 1) % 3, (axis + 2) % 3);
        let cross = |a: Point, b: Point| a[k] * b[l] - a[l] * b[k];
        let bound = 256.0 * U * self.size * self.size;
        let coefficients = [
            cross(p[i], p[j]),
            0.5 * (cross(p[i], q[j]) + cross(q[i], p[j])),
            cross(q[i], q[j]),
        ];
        if coefficients.iter().all(|&c| c > bound) {
            1
        } else if coefficients.iter().all(|&c| c < -bound) {
            -1
        } else {
            0
        }
    }

    /// Whether the volume provably has one sign from `first` to `last`: the hull never contains the origin.
    #[inline(always)]
    pub(super) fn is_never_flat<H: Hull<K>>(&self, first: f64, last: f64) -> bool {
        H::PARTS
            .face
            .is_some_and(|face| self.volumes(face, first, last).have_one_sign())
    }

    /// The volume from `first` to `last`.
    #[inline(always)]
    fn volumes(&self, face: Face, first: f64, last: f64) -> Volumes {
        let corners = |p: &[Point; K]| {
            let [i, j, k] = face.corners;
            (p[i], sub(p[j], p[i]), sub(p[k], p[i]))
        };
        let ((w0, x0, y0), (w1, x1, y1)) = (corners(&self.at(first)), corners(&self.at(last)));
        let error = 20.0 * U * self.size;
        let bound = |a: Point, b: Point| largest(a).max(largest(b)) + error;
        let (w, x, y) = (bound(w0, w1), bound(x0, x1), bound(y0, y1));
        let (n00, n11) = (cross(x0, y0), cross(x1, y1));
        let (m, n) = (cross(x0, y1), cross(x1, y0));
        let n01 = [m[0] + n[0], m[1] + n[1], m[2] + n[2]];
        Volumes {
            coefficients: [
                dot(w0, n00),
                (dot(w1, n00) + dot(w0, n01)) / 3.0,
                (dot(w0, n11) + dot(w1, n01)) / 3.0,
                dot(w1, n11),
            ],
            error: 16.0 * (error * (x * y + w * x + w * y) + 6.0 * U * w * x * y),
        }
    }
}

/// At most `n.w`.
#[inline(always)]
fn lower_bound(n: Point, w: Point) -> f64 {
    let [x, y, z] = [n[0] * w[0], n[1] * w[1], n[2] * w[2]];
    (x + y + z) - (8.0 * U * (x.abs() + y.abs() + z.abs()) + TINY)
}

/// `2^-e` for `2^e <= x < 2^(e + 1)`, a normal number within [`RANGE`].
#[inline(always)]
pub(super) fn inverse_power_of_two(x: f64) -> f64 {
    f64::from_bits(0x7fe0_0000_0000_0000 - (x.to_bits() & 0x7ff0_0000_0000_0000))
}

//! The fast filter: coordinates in `f32`, relative to a local origin and scaled by a power of two, with a proved error.
//!
//! A point x becomes q = fl32(fl64((x - o) s)), s a power of two. With u = 2^-24 and |x - o| <= M on every axis,
//! |q - (x - o) s| <= e := M s (u + 2^-48) + 2^-149 (the last term is `f32` underflow). The `f32` squared distance of two
//! points that are wrong by e on every axis belongs to a distance that differs from the true one by at most 2 sqrt(3) e
//! before rounding, and the seven roundings of (dx dx + dy dy) + dz dz, fused or not, change its root by a factor within
//! 1 +- 4u, or by less than 2^-72 where squares underflow. So, with E = 2 sqrt(3) e + 2^-70 and d = delta s:
//! below `definitely_inside_sq` = ((d - E)(1 - 5u))^2 every pair is a hit, from `definitely_outside_sq` = ((d + E)(1 + 5u))^2 on none is, and only what lies
//! between has to be decided exactly. The same holds for the gap between boxes whose sides are wrong by at most e.
//!
//! If few points are far from all others, M is that of the others, the core. A coordinate beyond it is wrong in proportion to
//! its own size, and boxes with such a one are compared in `f64`: see `gaps`.

use super::robust::Core;
use crate::Aabb;

/// Unit roundoff of `f32`.
pub(crate) const U: f64 = 1.0 / (1 << 24) as f64;

/// A local frame for points inside one box.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LocalFrame {
    pub(crate) origin: [f64; 3],
    /// A power of two.
    pub(crate) scale: f64,
    /// Which world axis each local axis is.
    axes: [usize; 3],
    /// Coordinates in the frame are at most this, in absolute value, unless they are far.
    pub(crate) half: f64,
    /// Coordinates in the frame are wrong by at most this, unless they are far.
    pub(crate) error: f64,
    /// Whether some are far: they are beyond `half`, wrong in proportion to their size, and held at [`EDGE`].
    pub(crate) has_far: bool,
    /// The largest absolute coordinate from the origin, in the unit of the world.
    pub(crate) farthest: f64,
}

/// Coordinates beyond this are held at it. Whatever a box has there may reach to infinity.
pub(crate) const EDGE: f32 = (1_u128 << 100) as f32;

/// What `f32` squared distances in a frame allow to conclude.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Filter {
    /// Squared distances below this are hits.
    pub(crate) definitely_inside_sq: f32,
    /// Squared distances from this on are none.
    pub(crate) definitely_outside_sq: f32,
    /// No hit lies further apart than this along any axis; covers the rounding of a coordinate plus or minus it.
    pub(crate) reach: f32,
    /// No hit has a larger gap along a direction, as computed by `separating_axis`.
    pub(crate) apart: f32,
}

impl LocalFrame {
    /// The frame for points inside `bounds` in which `delta` is between 1 and 2 and the longest axis the last, unless
    /// that would leave the range in which `f32` squares are finite.
    pub(crate) fn for_threshold(bounds: &Aabb, delta: f64) -> Self {
        let mut frame = Self::new(bounds, -exponent(delta), 50);
        let extent = |k: usize| bounds.max[k] / 2.0 - bounds.min[k] / 2.0;
        frame.axes.sort_by(|&i, &j| extent(i).total_cmp(&extent(j)));
        frame
    }

    /// The frame for points inside `bounds` in which coordinates are below 2, and at least 1 for the largest of them unless all
    /// are denormal; axes as in the world. If few of many points are far away, this is the frame of the others.
    pub(crate) fn unit(bounds: &Aabb, points: &[[f64; 3]]) -> Self {
        let core = if points.len() < FEW {
            None
        } else {
            Core::find(points.len(), |point| points[point], bounds)
        };
        match core {
            None => Self::new(bounds, 1022, 0),
            Some(Core { centre, half }) => {
                let farthest = largest_from(&centre, bounds);
                Self {
                    has_far: true,
                    farthest,
                    ..Self::around(centre, half, 1022, 0)
                }
            }
        }
    }

    /// Scaled by `2^wanted`, but so that coordinates stay below `2^(most + 1)`.
    fn new(bounds: &Aabb, wanted: i32, most: i32) -> Self {
        let origin: [f64; 3] = std::array::from_fn(|k| bounds.min[k] / 2.0 + bounds.max[k] / 2.0);
        Self::around(origin, largest_from(&origin, bounds), wanted, most)
    }

    fn around(origin: [f64; 3], half: f64, wanted: i32, most: i32) -> Self {
        let farthest = half;
        let scale = power_of_two(wanted.min(most - exponent(half)).clamp(-1022, 1022));
        let half = half * scale;
        let error = half * (U + U * U) + power_of_two(-149);
        Self {
            origin,
            scale,
            axes: [0, 1, 2],
            half,
            error,
            has_far: false,
            farthest,
        }
    }

    /// A place in the frame, held at the edge if it lies beyond.
    #[inline(always)]
    pub(crate) fn held(&self, place: [f32; 3]) -> [f32; 3] {
        if self.has_far {
            place.map(|c| c.clamp(-EDGE, EDGE))
        } else {
            place
        }
    }

    /// Where a point of the box lies in the frame.
    #[inline(always)]
    pub(crate) fn place(&self, point: &[f64; 3]) -> [f32; 3] {
        std::array::from_fn(|k| {
            let axis = self.axes[k];
            ((point[axis] - self.origin[axis]) * self.scale) as f32
        })
    }

    /// The world axis of each local axis, and a fourth lane that stays where it is.
    pub(crate) fn axes(&self) -> [u32; 4] {
        let [x, y, z] = self.axes.map(|axis| axis as u32);
        [x, y, z, 3]
    }

    /// What can be concluded in this frame about the threshold `delta` (finite, positive).
    pub(crate) fn filter(&self, delta: f64) -> Filter {
        Filter::new(delta * self.scale, self.error, self.half)
    }
}

impl Filter {
    /// For a threshold and coordinates up to `half` that are wrong by up to `error`, in the unit of the frame.
    pub(crate) fn new(delta: f64, error: f64, half: f64) -> Self {
        let apart = (delta + 3.4642 * error + 24.0 * U * half) * (1.0 + 1e-4);
        let error = 3.4642 * error + power_of_two(-70);
        let square = |d: f64| (d * d) as f32;
        let inner = (delta - error) * (1.0 - 5.0 * U);
        let outer = (delta + error) * (1.0 + 5.0 * U);
        Self {
            definitely_inside_sq: if inner > 0.0 {
                square(inner).next_down()
            } else {
                0.0
            },
            // finite, so that an empty box, infinitely far away, never passes
            definitely_outside_sq: square(outer).next_up().min(f32::MAX),
            // the subtraction and addition of a reach round once more, at the size of a coordinate
            apart: apart as f32,
            reach: ((outer + 2.0 * half * U) * (1.0 + 2.0 * U)) as f32,
        }
    }
}

/// Of fewer points, none is told from the others.
const FEW: usize = 32;

/// The largest absolute coordinate in a box, from an origin inside it.
fn largest_from(origin: &[f64; 3], bounds: &Aabb) -> f64 {
    (0..3)
        .map(|k| (bounds.max[k] - origin[k]).max(origin[k] - bounds.min[k]))
        .fold(0.0, f64::max)
}

/// `floor(log2(x))` of a positive `x`; the least exponent for zero and subnormal numbers.
pub(crate) fn exponent(x: f64) -> i32 {
    (x.to_bits() >> 52 & 0x7ff) as i32 - 1023
}

/// `2^e` for `e` in -1022..=1023, exactly.
pub(crate) fn power_of_two(e: i32) -> f64 {
    f64::from_bits(((e + 1023) as u64) << 52)
}

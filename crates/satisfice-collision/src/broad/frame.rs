//! The fast filter: coordinates in `f32`, relative to a local origin and scaled by a power of two, with a proved error.
//!
//! A point x becomes q = fl32(fl64((x - o) s)), s a power of two. With u = 2^-24 and |x - o| <= M on every axis,
//! |q - (x - o) s| <= e := M s (u + 2^-48) + 2^-149 (the last term is `f32` underflow). The `f32` squared distance of two
//! such points therefore belongs to a distance that differs from the true one by at most 2 sqrt(3) e before rounding, and
//! the seven roundings of (dx dx + dy dy) + dz dz, fused or not, change its root by a factor within 1 +- 4u, or by less than
//! 2^-72 where squares underflow. So, with E = 2 sqrt(3) e + 2^-70 and d = delta s:
//! below `sure` = ((d - E)(1 - 5u))^2 every pair is a hit, from `limit` = ((d + E)(1 + 5u))^2 on none is, and only what lies
//! between has to be decided exactly.

use crate::Aabb;

/// Unit roundoff of `f32`.
const U: f64 = 1.0 / (1 << 24) as f64;

/// A local frame for points inside one box, and what its rounding allows to conclude about a threshold.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    origin: [f64; 3],
    scale: f64,
    /// Which world axis each local axis is: the longest comes last.
    axes: [usize; 3],
    /// Squared `f32` distances below this are hits.
    pub(crate) sure: f32,
    /// Squared `f32` distances from this on are none.
    pub(crate) limit: f32,
    /// No hit lies further apart than this along any local axis.
    pub(crate) reach: f32,
}

impl Frame {
    /// The frame for points inside `bounds` and the threshold `delta` (finite, positive).
    pub(crate) fn new(bounds: &Aabb, delta: f64) -> Self {
        let origin: [f64; 3] = std::array::from_fn(|k| bounds.min[k] / 2.0 + bounds.max[k] / 2.0);
        let half = (0..3)
            .map(|k| (bounds.max[k] - origin[k]).max(origin[k] - bounds.min[k]))
            .fold(0.0, f64::max);
        // delta s lies in [1, 2) unless M s would leave the range in which f32 squares are finite
        let exponent = (-exponent(delta)).min(50 - exponent(half)).clamp(-1000, 1000);
        let scale = power_of_two(exponent);
        let mut axes = [0, 1, 2];
        let extent = |k: usize| bounds.max[k] / 2.0 - bounds.min[k] / 2.0;
        axes.sort_by(|&i, &j| extent(i).total_cmp(&extent(j)));
        let (half, delta) = (half * scale, delta * scale);
        let coordinate = half * (U + U * U) + power_of_two(-149);
        let error = 3.4642 * coordinate + power_of_two(-70);
        let square = |d: f64| (d * d) as f32;
        let inner = (delta - error) * (1.0 - 5.0 * U);
        let outer = (delta + error) * (1.0 + 5.0 * U);
        Self {
            origin,
            scale,
            axes,
            sure: if inner > 0.0 {
                square(inner).next_down()
            } else {
                0.0
            },
            limit: square(outer).next_up(),
            // the subtraction and addition of a reach round once more, at the size of a coordinate
            reach: ((outer + 2.0 * half * U) * (1.0 + 2.0 * U)) as f32,
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
}

/// `floor(log2(x))` of a positive `x`; the least exponent for zero and subnormal numbers.
fn exponent(x: f64) -> i32 {
    (x.to_bits() >> 52 & 0x7ff) as i32 - 1023
}

/// `2^e` for `e` in -1022..=1023, exactly.
fn power_of_two(e: i32) -> f64 {
    f64::from_bits(((e + 1023) as u64) << 52)
}

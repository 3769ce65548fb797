//! Arithmetic on `[f64; 3]` in the order that the error bounds of this module assume: no fused operations.

use crate::distance::Point;
pub(super) use crate::distance::vector::{cross, dot, sub};

/// `p + s d`.
#[inline(always)]
pub(super) fn along(p: Point, d: Point, s: f64) -> Point {
    [p[0] + s * d[0], p[1] + s * d[1], p[2] + s * d[2]]
}

/// The largest component in absolute value; NaN is passed over.
#[inline(always)]
pub(super) fn largest(p: Point) -> f64 {
    p[0].abs().max(p[1].abs()).max(p[2].abs())
}

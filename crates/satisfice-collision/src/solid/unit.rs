//! A unit and an origin in which no product of coordinates overflows or vanishes.

use super::hull::sub;
use crate::broad::{exponent, power_of_two};
use crate::distance::Point;

/// Coordinates within it are below 2 in absolute value.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unit {
    origin: Point,
    /// Of the power of two that coordinates are multiplied by.
    exponent: i32,
}

impl Unit {
    /// `None` if all points are one, or too far apart for their differences to be finite.
    pub(super) fn of(points: impl Iterator<Item = Point> + Clone) -> Option<Self> {
        let origin = points.clone().next()?;
        let away = points.flat_map(|p| sub(p, origin));
        let size = away.fold(0.0_f64, |most, c| most.max(c.abs()));
        (size > 0.0 && size.is_finite()).then(|| Self {
            origin,
            exponent: -exponent(size),
        })
    }

    pub(super) fn place(&self, point: Point) -> Point {
        sub(point, self.origin).map(|c| times(c, self.exponent))
    }

    /// A length in the unit of the mesh.
    pub(super) fn back(&self, length: f64) -> f64 {
        times(length, -self.exponent)
    }
}

/// In two steps, since the power alone may be out of range.
fn times(x: f64, exponent: i32) -> f64 {
    x * power_of_two(exponent / 2) * power_of_two(exponent - exponent / 2)
}

//! Points all of whose coordinates are numbers.

use super::Point;
use crate::error::Error;

pub(crate) const AXES: [char; 3] = ['x', 'y', 'z'];

/// The point, if all of its coordinates are finite.
///
/// # Errors
/// [`Error::NonFiniteVertex`], which names `vertex`.
pub(crate) fn finite(vertex: usize, point: Point) -> Result<Point, Error> {
    match point.iter().position(|c| !c.is_finite()) {
        None => Ok(point),
        Some(k) => Err(Error::NonFiniteVertex {
            vertex,
            axis: AXES[k],
            value: point[k],
        }),
    }
}

/// Refuses points of which one is not finite.
///
/// # Errors
/// [`Error::NonFiniteVertex`], which names the first one.
pub(crate) fn all_finite(points: impl IntoIterator<Item = Point>) -> Result<(), Error> {
    let mut numbered = points.into_iter().enumerate();
    numbered.try_for_each(|(vertex, point)| finite(vertex, point).map(|_| ()))
}

//! Axes as the model sees them: coordinates from 0 to 1, axes of width zero left out.

use crate::scalar::Real;
use crate::space::{AxisKind, Space};

/// Which values of an axis are near each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    /// Those with a small difference.
    Line,
    /// The same, around a circle.
    Circle,
    /// None: two categories are as far apart as any others.
    Category,
    /// A place of a permutation of so many: a line of ranks.
    Place(u32),
}

/// One axis that has more than one value.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unit {
    /// Its number in the space.
    pub(super) axis: usize,
    /// Number of values of an integer axis, 0 for a continuous one.
    pub(super) cells: f64,
    pub(super) width: f64,
    pub(super) shape: Shape,
}

impl Unit {
    /// By how much two coordinates differ: around the circle on a circle, by one cell between any two categories.
    #[inline]
    pub(super) fn difference(&self, a: f64, b: f64) -> f64 {
        let d = a - b;
        match self.shape {
            Shape::Line | Shape::Place(_) => d,
            Shape::Circle => d - d.round(),
            Shape::Category => f64::from(u8::from(d != 0.0)) / self.cells,
        }
    }

    /// The centre of the cell of `x` on an integer axis, `x` on a continuous one.
    #[inline]
    pub(super) fn round(&self, x: f64) -> f64 {
        if self.cells > 0.0 {
            ((x * self.cells).floor().clamp(0.0, self.cells - 1.0) + 0.5) / self.cells
        } else {
            x
        }
    }
}

/// The axes of a space that have more than one value.
#[derive(Debug, Clone, Default)]
pub(super) struct Units {
    pub(super) axes: Vec<Unit>,
}

impl Units {
    pub(super) fn of<S: Real>(space: &Space<S>) -> Self {
        let axes = space.axes().iter().enumerate();
        let several = axes.filter(|(_, axis)| axis.lower() < axis.upper());
        Self {
            axes: several
                .map(|(j, axis)| Unit {
                    axis: j,
                    cells: if axis.is_integer() {
                        axis.width().f64()
                    } else {
                        0.0
                    },
                    width: axis.width().f64(),
                    shape: match axis.kind() {
                        AxisKind::Categorical => Shape::Category,
                        #[expect(
                            clippy::cast_possible_truncation,
                            clippy::cast_sign_loss,
                            reason = "a u32, whole"
                        )]
                        AxisKind::Place => Shape::Place(axis.upper().f64() as u32 + 1),
                        AxisKind::Continuous | AxisKind::Integer if space.is_periodic(j) => Shape::Circle,
                        AxisKind::Continuous | AxisKind::Integer => Shape::Line,
                    },
                })
                .collect(),
        }
    }

    pub(super) fn shapes(&self) -> Vec<Shape> {
        self.axes.iter().map(|unit| unit.shape).collect()
    }

    /// Puts coordinates on the centre of their cell, and the keys of a permutation on their ranks: where the model knows them.
    pub(super) fn round(&self, x: &mut [f64]) {
        let mut next = 0;
        while next < self.axes.len() {
            let first = next;
            let unit = self.axes[first];
            next += 1;
            if let Shape::Place(count) = unit.shape {
                next = (first + count as usize).min(x.len());
                rank(&mut x[first..next]);
            } else {
                x[first] = unit.round(x[first]);
            }
        }
    }

    /// Whether all axes go from one end to the other, without categories and ranks.
    pub(super) fn are_ordered(&self) -> bool {
        self.axes.iter().all(|unit| unit.shape == Shape::Line)
    }

    pub(super) fn len(&self) -> usize {
        self.axes.len()
    }

    /// The coordinates of a position that is inside: on an integer axis, those of the centre of its cell.
    pub(super) fn of_position<S: Real>(&self, space: &Space<S>, position: &[S], out: &mut Vec<f64>) {
        out.clear();
        out.extend(self.axes.iter().map(|unit| {
            let axis = &space.axes()[unit.axis];
            let position = position[unit.axis];
            if axis.is_integer() {
                ((axis.value(position) - axis.lower()).f64() + 0.5) / unit.cells
            } else {
                (position - axis.start()).f64() / unit.width
            }
        }));
        if self.axes.iter().any(|unit| matches!(unit.shape, Shape::Place(_))) {
            self.round(out);
        }
    }

    /// Writes the position of coordinates in [0, 1].
    pub(super) fn to_position<S: Real>(&self, space: &Space<S>, units: &[f64], position: &mut [S]) {
        for (axis, x) in space.axes().iter().zip(&mut *position) {
            *x = axis.position(axis.lower());
        }
        for (unit, &share) in self.axes.iter().zip(units) {
            let axis = &space.axes()[unit.axis];
            position[unit.axis] = axis.position(axis.value(axis.at(share)));
        }
    }

    /// Number of points, infinite with a continuous axis.
    pub(super) fn cardinality(&self) -> f64 {
        self.axes
            .iter()
            .map(|unit| {
                if unit.cells > 0.0 {
                    unit.cells
                } else {
                    f64::INFINITY
                }
            })
            .product()
    }

    /// The point of number `index` of a space of integer axes only, the first axis fastest.
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "numbers of cells of a small space"
    )]
    pub(super) fn nth(&self, index: usize, out: &mut [f64]) {
        let mut rest = index;
        for (x, unit) in out.iter_mut().zip(&self.axes) {
            let cells = (unit.cells as usize).max(1);
            *x = ((rest % cells) as f64 + 0.5) / unit.cells;
            rest /= cells;
        }
    }

    #[expect(clippy::cast_precision_loss, reason = "a number of axes")]
    pub(super) fn saved(&self) -> Vec<f64> {
        let axes = self.axes.iter();
        axes.flat_map(|unit| [unit.axis as f64, unit.cells, unit.width, unit.shape.code()])
            .collect()
    }

    /// `None` if the list is not whole.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number of axes"
    )]
    pub(super) fn restored(saved: &[f64]) -> Option<Self> {
        let (axes, []) = saved.as_chunks::<4>() else {
            return None;
        };
        let unit = |&[axis, cells, width, code]: &[f64; 4]| {
            Some(Unit {
                axis: axis as usize,
                cells,
                width,
                shape: Shape::of_code(code)?,
            })
        };
        let axes: Option<Vec<Unit>> = axes.iter().map(unit).collect();
        Some(Self { axes: axes? })
    }
}

impl Shape {
    fn code(self) -> f64 {
        match self {
            Self::Line => 0.0,
            Self::Circle => 1.0,
            Self::Category => 2.0,
            Self::Place(count) => 2.0 + f64::from(count),
        }
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number that `code` wrote"
    )]
    fn of_code(code: f64) -> Option<Self> {
        match code as u32 {
            0 => Some(Self::Line),
            1 => Some(Self::Circle),
            2 => Some(Self::Category),
            more if f64::from(more) == code => Some(Self::Place(more - 2)),
            _ => None,
        }
    }
}

/// Turns keys into the middles of their ranks; of equal keys, the earlier place has the lower rank.
#[expect(clippy::cast_precision_loss, reason = "a number of places")]
fn rank(keys: &mut [f64]) {
    let mut order: Vec<usize> = (0..keys.len()).collect();
    order.sort_by(|&a, &b| keys[a].total_cmp(&keys[b]));
    let count = keys.len() as f64;
    for (rank, place) in order.into_iter().enumerate() {
        keys[place] = (rank as f64 + 0.5) / count;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;

    fn mixed() -> Space<f64> {
        let axes = [
            Axis::continuous(1e-3, 1e3).logarithmic(),
            Axis::continuous(0.0, 360.0).periodic(),
            Axis::categorical(5),
            Axis::integer(3, 3),
            Axis::integer(0, 9),
        ];
        Space::new(axes.into_iter().chain(Axis::permutation(3))).unwrap()
    }

    #[test]
    fn differences_go_around_circles_and_are_alike_between_categories() {
        let units = Units::of(&mixed());
        let difference = |j: usize, a: f64, b: f64| units.axes[j].difference(a, b);
        approx::assert_relative_eq!(difference(1, 0.95, 0.05), -0.1, max_relative = 1e-12);
        approx::assert_relative_eq!(difference(0, 0.95, 0.05), 0.9, max_relative = 1e-12);
        assert_eq!(
            (
                difference(2, 0.1, 0.9),
                difference(2, 0.3, 0.5),
                difference(2, 0.3, 0.3)
            ),
            (0.2, 0.2, 0.0)
        );
    }

    #[test]
    fn logarithmic_axes_are_equal_shares_of_the_logarithm_and_keys_are_ranks() {
        let (space, mut out) = (mixed(), Vec::new());
        let units = Units::of(&space);
        let position = [0.0, 90.0, 2.3, 3.5, 4.9, 0.7, 0.1, 0.2];
        units.of_position(&space, &position, &mut out);
        let expected = [0.5, 0.25, 0.5, 0.45, 5.0 / 6.0, 1.0 / 6.0, 0.5];
        for (x, expected) in out.iter().zip(expected) {
            approx::assert_relative_eq!(*x, expected, max_relative = 1e-12);
        }
        let mut rounded = vec![0.5, 0.25, 0.41, 0.49, 0.9, 0.2, 0.3];
        units.round(&mut rounded);
        for (x, expected) in rounded.iter().zip(expected) {
            approx::assert_relative_eq!(*x, expected, max_relative = 1e-12);
        }
        let again = Units::restored(&units.saved()).unwrap();
        assert_eq!(again.shapes(), units.shapes());
        assert!(Units::restored(&[0.0, 0.0, 1.0, 2.5]).is_none() || Shape::of_code(3.5).is_none());
    }
}

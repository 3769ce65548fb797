//! Axes as the model sees them: coordinates from 0 to 1, axes of width zero left out.

use crate::scalar::Real;
use crate::space::Space;

/// One axis that has more than one value.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unit {
    /// Its number in the space.
    pub(super) axis: usize,
    /// Number of values of an integer axis, 0 for a continuous one.
    pub(super) cells: f64,
    pub(super) width: f64,
}

impl Unit {
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
                })
                .collect(),
        }
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
        axes.flat_map(|unit| [unit.axis as f64, unit.cells, unit.width])
            .collect()
    }

    /// `None` if the list is not whole.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number of axes"
    )]
    pub(super) fn restored(saved: &[f64]) -> Option<Self> {
        let (axes, []) = saved.as_chunks::<3>() else {
            return None;
        };
        let unit = |&[axis, cells, width]: &[f64; 3]| Unit {
            axis: axis as usize,
            cells,
            width,
        };
        Some(Self {
            axes: axes.iter().map(unit).collect(),
        })
    }
}

//! The cells of a grid by which points with a radius are filed.

use crate::scalar::{Real, floor};

/// Edge of a cell in radii. A ball then meets one cell or two on each axis, or three where the scalar's rounding is as
/// coarse as the radius.
pub(super) const EDGE: f64 = 4.0;

/// The cell of `x` on one axis. Monotone in `x`, roundings included.
pub(super) fn own_cell<S: Real>(x: S, radius: S) -> S {
    let edge = radius * S::of(EDGE);
    let cell = if radius == S::zero() {
        x
    } else if edge.is_finite() {
        floor(x / edge)
    } else {
        S::zero()
    };
    cell + S::zero() // -0.0 and 0.0 are one cell
}

/// The cell of `x` on one axis, and the first and the last one that a solution within the radius may be in.
///
/// The usual way costs one division: where `x` is in its cell, in [0, 1), says which neighbours are within the radius,
/// and a hundredth more for what `x / edge` is rounded by, as long as that is small.
#[inline]
pub(super) fn cells_near<S: Real>(x: S, radius: S) -> [S; 3] {
    let scaled = x / (radius * S::of(EDGE));
    if is_precise(scaled) {
        let cell = floor(scaled) + S::zero();
        let place = scaled - cell;
        let reach = S::of(1.01 / EDGE);
        let first = if place < reach { cell - S::one() } else { cell };
        let last = if place > S::one() - reach {
            cell + S::one()
        } else {
            cell
        };
        return [cell, first, last];
    }
    cells_near_by_ends(x, radius)
}

/// The same for all other `x`: coordinates so large that they are as coarse as the cells, or infinite.
#[cold]
fn cells_near_by_ends<S: Real>(x: S, radius: S) -> [S; 3] {
    // A little more than the radius, so that rounding in `same` loses nothing.
    let reach = radius * S::of(1.0 + 1e-6);
    let within = |x: S| x.max(S::min_value()).min(S::max_value());
    [
        own_cell(x, radius),
        own_cell(within(x - reach), radius),
        own_cell(within(x + reach), radius),
    ]
}

/// Coordinates over this share of the number of cells that the scalar tells apart are examined with more care.
const COARSE: f64 = 1.0 / 4096.0;

/// Whether rounding moves a place by little, in edges.
fn is_precise<S: Real>(scaled: S) -> bool {
    scaled.abs() < S::of(COARSE) / S::epsilon()
}

/// The next cell, also where whole numbers are no longer next to each other.
pub(super) fn next_cell<S: Real>(cell: S) -> S {
    cell + (cell.abs() * S::epsilon() * S::of(0.75)).max(S::one())
}

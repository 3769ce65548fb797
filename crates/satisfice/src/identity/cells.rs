//! The cells of a grid by which points with a radius are filed.

use core::hash::BuildHasher;

use super::{FINELY_HASHED, KEYS};
use crate::scalar::{Real, floor};

/// Edge of a cell in radii. A ball then meets one cell or two on each axis, or three where the scalar's rounding is as
/// coarse as the radius.
pub(super) const EDGE: f64 = 4.0;
/// The same where many points are in one cell: of the two or three cells that a ball meets on each axis few combinations are near enough.
/// Smaller ones are more to look up, larger ones hold more to compare with.
pub(super) const FINE_EDGE: f64 = 1.5;

/// The cell of `x` on one axis. Monotone in `x`, roundings included.
pub(super) fn own_cell<S: Real>(x: S, radius: S, edge: f64) -> S {
    let edge = radius * S::of(edge);
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
pub(super) fn cells_near<S: Real>(x: S, radius: S, edge: f64) -> [S; 3] {
    let scaled = x / (radius * S::of(edge));
    if is_precise(scaled) {
        let cell = floor(scaled) + S::zero();
        let place = scaled - cell;
        let reach = S::of(1.01 / edge);
        let first = if place < reach { cell - S::one() } else { cell };
        let last = if place > S::one() - reach {
            cell + S::one()
        } else {
            cell
        };
        return [cell, first, last];
    }
    cells_near_by_ends(x, radius, edge)
}

/// The same for all other `x`: coordinates so large that they are as coarse as the cells, or infinite.
#[cold]
fn cells_near_by_ends<S: Real>(x: S, radius: S, edge: f64) -> [S; 3] {
    // A little more than the radius, so that rounding in `same` loses nothing.
    let reach = radius * S::of(1.0 + 1e-6);
    let within = |x: S| x.max(S::min_value()).min(S::max_value());
    [
        own_cell(x, radius, edge),
        own_cell(within(x - reach), radius, edge),
        own_cell(within(x + reach), radius, edge),
    ]
}

/// Coordinates over this share of the number of cells that the scalar tells apart are examined with more care.
const COARSE: f64 = 1.0 / 4096.0;

/// Cells that a ball meets on one axis, at most: three, and one more where the scalar's rounding is as coarse as the radius.
const MOST_NEAR: usize = 4;
/// Axes whose cells are combined before the others'.
const HALF: usize = FINELY_HASHED / 2;
const MOST_COMBINED: usize = MOST_NEAR.pow(HALF as u32);
/// Squared distances, in radii, of what may be the same are at most this, by what places in cells and distances are rounded.
const FARTHEST: f64 = 1.001;

/// A fine key or a part of one, and the square of the least distance, in radii, of what is filed there.
#[derive(Debug, Clone, Copy, Default)]
struct Near {
    key: u64,
    square: f64,
}

/// Up to `N` of them.
#[derive(Debug, Clone, Copy)]
struct NearKeys<const N: usize> {
    keys: [Near; N],
    count: usize,
}

impl<const N: usize> NearKeys<N> {
    fn new() -> Self {
        Self {
            keys: [Near::default(); N],
            count: 0,
        }
    }

    #[inline]
    fn push(&mut self, near: Near) {
        if let Some(place) = self.keys.get_mut(self.count) {
            *place = near;
            self.count += 1;
        }
    }

    #[inline]
    fn as_slice(&self) -> &[Near] {
        &self.keys[..self.count]
    }
}

/// The cells on each axis that a solution within the radius may be in, its own first.
#[derive(Debug)]
pub(super) struct FineCells {
    axes: [NearKeys<MOST_NEAR>; FINELY_HASHED],
    count: usize,
}

impl FineCells {
    pub(super) fn new() -> Self {
        Self {
            axes: [NearKeys::new(); FINELY_HASHED],
            count: 0,
        }
    }

    /// Adds the next axis, if there is room.
    #[inline]
    pub(super) fn add<S: Real>(&mut self, x: S, radius: S) {
        let axis = self.count;
        let Some(parts) = self.axes.get_mut(axis) else {
            return;
        };
        self.count += 1;
        let [own, first, last] = cells_near(x, radius, FINE_EDGE);
        let scaled = x / (radius * S::of(FINE_EDGE));
        let place = is_precise(scaled).then(|| (scaled - own).f64());
        parts.push(Near {
            key: part_of_key(axis, own),
            square: 0.0,
        });
        let mut cell = first;
        loop {
            if cell != own {
                // A thousandth is left for what places are rounded by; where they say nothing, so does the distance.
                let least = place.map_or(0.0, |place| {
                    let cells = if cell < own { place } else { 1.0 - place };
                    (cells * FINE_EDGE - 1e-3).max(0.0)
                });
                parts.push(Near {
                    key: part_of_key(axis, cell),
                    square: least * least,
                });
            }
            if cell >= last {
                return;
            }
            cell = next_cell(cell).min(last);
        }
    }

    /// Visits the exclusive or of `key` and one part of each axis, for all cells that a ball may meet, until `visit` returns `true`;
    /// returns whether it did.
    pub(super) fn visit(mut self, key: u64, visit: &mut impl FnMut(u64) -> bool) -> bool {
        while self.count < FINELY_HASHED {
            let key = part_of_key(self.count, 0.0);
            self.axes[self.count].push(Near { key, square: 0.0 });
            self.count += 1;
        }
        let (first, second) = self.axes.split_at(HALF);
        let (first, mut second) = (combined(first), combined(second));
        // The nearest first, so that the rest is too far as soon as one is.
        let count = second.count;
        second.keys[..count].sort_unstable_by(|a, b| a.square.total_cmp(&b.square));
        first.as_slice().iter().any(|a| {
            let near = second.as_slice().iter();
            near.take_while(|b| a.square + b.square <= FARTHEST)
                .any(|b| visit(key ^ a.key ^ b.key))
        })
    }
}

/// One part of each axis, for all combinations that a ball may meet.
fn combined(axes: &[NearKeys<MOST_NEAR>]) -> NearKeys<MOST_COMBINED> {
    let mut all = NearKeys::new();
    let [first, second, third] = axes else { return all };
    for a in first.as_slice() {
        for b in second.as_slice() {
            for c in third.as_slice() {
                let square = a.square + b.square + c.square;
                if square <= FARTHEST {
                    all.push(Near {
                        key: a.key ^ b.key ^ c.key,
                        square,
                    });
                }
            }
        }
    }
    all
}

/// Whether rounding moves a place by little, in edges.
fn is_precise<S: Real>(scaled: S) -> bool {
    scaled.abs() < S::of(COARSE) / S::epsilon()
}

/// The next cell, also where whole numbers are no longer next to each other.
pub(super) fn next_cell<S: Real>(cell: S) -> S {
    cell + (cell.abs() * S::epsilon() * S::of(0.75)).max(S::one())
}

/// The part of a fine key that comes from one axis: a key is the exclusive or of the parts of all.
pub(super) fn part_of_key<S: Real>(axis: usize, cell: S) -> u64 {
    KEYS.hash_one([axis as u64, cell.to_word()])
}

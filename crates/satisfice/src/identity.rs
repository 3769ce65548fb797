//! When two solutions are the same answer.

use core::hash::{BuildHasher, Hash, Hasher};

use foldhash::fast::FixedState;

use crate::scalar::{Real, floor};
use crate::space::Region;

/// The seed of every key; fixed, so that a run is the same on every machine.
const KEYS: FixedState = FixedState::with_seed(0x5a71_5f1c_e000_2012);

/// Defines whether two solutions count as one answer, and gives the keys under which an archive finds them.
///
/// It is implemented for every type that is `Eq + Hash` (a pair of indices, a vector of integers): there, *same* is *equal*.
/// For real coordinates use [`Located`], which is the same as another one within a radius.
///
/// Law: if `a.same(&b)`, then `a.key()` is among the keys that `b.visit_keys` visits, and the other way round.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not define when two solutions are the same answer",
    label = "`Identity` is not implemented for `{Self}`",
    note = "types that are `Eq + Hash`, such as `[u32; 2]` or `Vec<u32>`, implement it: there, same is equal",
    note = "for real coordinates, such as `Vec<f64>`, use `satisfice::Located`: points within a radius are the same"
)]
pub trait Identity {
    /// The hash under which the solution is filed.
    fn key(&self) -> u64;
    /// Whether both are the same answer. It must be symmetric.
    fn same(&self, other: &Self) -> bool;
    /// Visits the keys under which a solution that is the same may be filed, until `visit` returns `true`; returns
    /// whether it did.
    #[inline]
    fn visit_keys(&self, visit: &mut impl FnMut(u64) -> bool) -> bool {
        visit(self.key())
    }
}

// Without this the compiler asks for `f64: Eq`, where `Located` is the answer.
#[diagnostic::do_not_recommend]
impl<T: Eq + Hash> Identity for T {
    #[inline]
    fn key(&self) -> u64 {
        KEYS.hash_one(self)
    }
    #[inline]
    fn same(&self, other: &Self) -> bool {
        self == other
    }
}

/// A point of a continuous space that counts once per separation radius: two are the same if their Euclidean distance is
/// at most the radius, which a problem gives all its solutions alike.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Located<S> {
    /// Coordinates, in the units of the space.
    pub coordinates: Vec<S>,
    /// Radius within which two count as one, >= 0; 0 means equal coordinates only.
    pub separation: S,
}

/// At most this many coordinates are hashed; the true distance decides, so more would only cost more look-ups.
const HASHED: usize = 3;

impl<S: Real> Located<S> {
    /// A solution at these coordinates.
    #[must_use]
    pub fn new(coordinates: &[S], separation: S) -> Self {
        Self {
            coordinates: coordinates.to_vec(),
            separation,
        }
    }

    /// Whether all points of `region` are the same as this one: whether its farthest corner is.
    ///
    /// That decides for all of them, rounding included: differences, quotients, squares and sums are monotone in every
    /// coordinate on either side of this point, and rounding keeps the order.
    #[must_use]
    pub fn covers(&self, region: &Region<S>) -> bool {
        let ends = region.lower.iter().zip(&region.upper);
        let farthest = self.coordinates.iter().zip(ends).map(|(&x, (&lower, &upper))| {
            if (x - lower).abs() > (x - upper).abs() {
                lower
            } else {
                upper
            }
        });
        region.lower.len() == self.coordinates.len() && self.is_within(farthest)
    }

    #[inline]
    fn is_within(&self, other: impl Iterator<Item = S>) -> bool {
        let mut pairs = self.coordinates.iter().zip(other);
        if self.separation == S::zero() {
            return pairs.all(|(&a, b)| a == b);
        }
        // Divided before it is squared: the square of a small or of a large radius is no number of use.
        let square = pairs.fold(S::zero(), |sum, (&a, b)| {
            let d = (a - b) / self.separation;
            sum + d * d
        });
        square <= S::one()
    }

    /// The cell of `x` on one axis. Monotone in `x`, roundings included.
    fn cell(&self, x: S) -> S {
        let edge = self.separation * S::of(EDGE);
        let cell = if self.separation == S::zero() {
            x
        } else if edge.is_finite() {
            floor(x / edge)
        } else {
            S::zero()
        };
        cell + S::zero() // -0.0 and 0.0 are one cell
    }

    fn own_cells(&self) -> [S; HASHED] {
        let mut cells = [S::zero(); HASHED];
        for (cell, &x) in cells.iter_mut().zip(&self.coordinates) {
            *cell = self.cell(x);
        }
        cells
    }

    /// The cell of `x` on one axis, and the first and the last one that a solution within the radius may be in.
    ///
    /// The usual way costs one division: where `x` is in its cell, in [0, 1), says which neighbours are within the radius, a
    /// quarter, and a hundredth more for what `x / edge` is rounded by, as long as that is small.
    #[inline]
    fn cells_near(&self, x: S) -> [S; 3] {
        let scaled = x / (self.separation * S::of(EDGE));
        if scaled.abs() < S::of(COARSE) / S::epsilon() {
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
        self.cells_near_by_ends(x)
    }

    /// The same for all other `x`: radius 0, and coordinates so large that they are as coarse as the cells, or infinite.
    #[cold]
    fn cells_near_by_ends(&self, x: S) -> [S; 3] {
        // A little more than the radius, so that rounding in `same` loses nothing.
        let reach = self.separation * S::of(1.0 + 1e-6);
        let within = |x: S| x.max(S::min_value()).min(S::max_value());
        [
            self.cell(x),
            self.cell(within(x - reach)),
            self.cell(within(x + reach)),
        ]
    }
}

/// Coordinates over this share of the number of cells that the scalar tells apart are looked at with more care.
const COARSE: f64 = 1.0 / 4096.0;

/// Edge of a cell in radii. A ball then meets one cell or two on each axis, or three where the scalar's rounding is as
/// coarse as the radius.
const EDGE: f64 = 4.0;

/// One word after the other: hashing them as an array costs three times as much.
#[inline]
fn hash_cells<S: Real>(cells: [S; HASHED]) -> u64 {
    let mut hasher = KEYS.build_hasher();
    for cell in cells {
        hasher.write_u64(cell.to_word());
    }
    hasher.finish()
}

/// The next cell, also where whole numbers are no longer next to each other.
fn next_cell<S: Real>(cell: S) -> S {
    cell + (cell.abs() * S::epsilon() * S::of(0.75)).max(S::one())
}

impl<S: Real> Identity for Located<S> {
    fn key(&self) -> u64 {
        hash_cells(self.own_cells())
    }

    fn same(&self, other: &Self) -> bool {
        self.is_within(other.coordinates.iter().copied())
    }

    fn visit_keys(&self, visit: &mut impl FnMut(u64) -> bool) -> bool {
        let mut ends = [[S::zero(); 2]; HASHED];
        let mut own = [S::zero(); HASHED];
        let mut cells = [S::zero(); HASHED];
        for (((end, own), cell), &x) in ends
            .iter_mut()
            .zip(&mut own)
            .zip(&mut cells)
            .zip(&self.coordinates)
        {
            [*own, end[0], end[1]] = self.cells_near(x);
            *cell = end[0];
        }
        // Its own first: what is the same is most often filed there.
        if visit(hash_cells(own)) {
            return true;
        }
        loop {
            if cells != own && visit(hash_cells(cells)) {
                return true;
            }
            // The next combination, the first axis fastest.
            let Some(axis) = (0..HASHED).find(|&axis| cells[axis] < ends[axis][1]) else {
                return false;
            };
            cells[axis] = next_cell(cells[axis]).min(ends[axis][1]);
            for earlier in 0..axis {
                cells[earlier] = ends[earlier][0];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn same_is_found<S: Real>() {
        let mut rng = crate::SearchRng::new(7);
        let mut same = 0;
        for trial in 0..60_000 {
            let dimension = 1 + trial % 5;
            let separation = S::of([0.0, 1e-3, 0.5, 0.02, 1e-30, 1e300, f64::INFINITY][trial % 7]);
            let size = S::of([1.0, 100.0, 1e6, 1e-3, 1e38][trial % 11 % 5]);
            // Round numbers, where cells begin, and others.
            let round = |x: S, rng: &mut crate::SearchRng| if rng.uniform() < 0.5 { x.round() } else { x };
            let mut a = Vec::new();
            let mut b = Vec::new();
            for _ in 0..dimension {
                let x = round(size * S::of(2.0 * rng.uniform() - 1.0), &mut rng);
                let step = S::of(1.1 * rng.uniform().round() * (2.0 * rng.uniform() - 1.0));
                a.push(x);
                b.push(x + separation.min(size) * step);
            }
            let (a, b) = (Located::new(&a, separation), Located::new(&b, separation));
            for (a, b) in [(&a, &b), (&b, &a)] {
                let mut visited = 0;
                let found = b.visit_keys(&mut |key| {
                    visited += 1;
                    key == a.key()
                });
                assert!(found || !a.same(b), "{a:?} {b:?}");
                assert!(visited <= 27, "{visited} keys for {b:?}");
                same += u32::from(a.same(b));
            }
        }
        assert!(same > 50_000, "the test looks at {same} pairs that are the same");
    }

    #[test]
    fn whatever_is_the_same_is_found_by_its_keys() {
        same_is_found::<f64>();
    }

    #[test]
    fn whatever_is_the_same_is_found_by_its_keys_in_f32() {
        same_is_found::<f32>();
    }

    #[test]
    fn negative_zero_is_zero() {
        let (a, b) = (Located::new(&[0.0_f64], 0.0), Located::new(&[-0.0], 0.0));
        assert!(a.same(&b) && b.visit_keys(&mut |key| key == a.key()));
    }
}

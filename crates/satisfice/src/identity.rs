//! When two solutions are the same answer.

use core::hash::{BuildHasher, Hash};

use foldhash::fast::FixedState;

use crate::scalar::Real;

/// The seed of every key; fixed, so that a run is the same on every machine.
const KEYS: FixedState = FixedState::with_seed(0x5a71_5f1c_e000_2012);

/// Says whether two solutions count as one answer, and gives keys by which an archive finds them fast.
///
/// Implemented for everything `Eq + Hash` (a pair of indices, a vector of integers), where *same* is *equal*. A
/// solution of real coordinates is best a [`Located`], which is the same as another within a radius.
///
/// Law: if `a.same(&b)`, then `a.key()` is among the keys that `b.visit_keys` visits, and the other way round.
pub trait Identity {
    /// A hash under which the solution is filed.
    fn key(&self) -> u64;
    /// Whether both are the same answer. Symmetric.
    fn same(&self, other: &Self) -> bool;
    /// Visits the keys under which a solution that is the same may be filed, until `visit` returns `true`; returns
    /// whether it did.
    #[inline]
    fn visit_keys(&self, visit: &mut dyn FnMut(u64) -> bool) -> bool {
        visit(self.key())
    }
}

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
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

    /// Cells have twice the separation as edge, so that a ball meets at most two cells on each hashed axis.
    fn cell(&self, axis: usize, shift: S) -> u64 {
        let x = self.coordinates[axis];
        let cell = if self.separation > S::zero() {
            ((x + shift) / (self.separation + self.separation)).floor()
        } else {
            x
        };
        // -0.0 and 0.0 are one cell.
        (cell + S::zero()).to_word()
    }
}

impl<S: Real> Identity for Located<S> {
    fn key(&self) -> u64 {
        let mut cells = [0; HASHED];
        for (axis, cell) in cells.iter_mut().enumerate().take(self.coordinates.len()) {
            *cell = self.cell(axis, S::zero());
        }
        KEYS.hash_one(cells)
    }

    fn same(&self, other: &Self) -> bool {
        let square = self
            .coordinates
            .iter()
            .zip(&other.coordinates)
            .fold(S::zero(), |sum, (&a, &b)| sum + (a - b) * (a - b));
        square <= self.separation * self.separation
    }

    fn visit_keys(&self, visit: &mut dyn FnMut(u64) -> bool) -> bool {
        let hashed = self.coordinates.len().min(HASHED);
        // A little more than the radius, so that rounding in `same` and in the division below loses nothing.
        let reach = self.separation * S::of(1.0 + 1e-6);
        let mut ends = [[0; 2]; HASHED];
        for (axis, end) in ends.iter_mut().enumerate().take(hashed) {
            *end = [self.cell(axis, -reach), self.cell(axis, reach)];
        }
        for corner in 0..1_usize << hashed {
            let mut cells = [0; HASHED];
            let mut repeated = false;
            for axis in 0..hashed {
                let side = corner >> axis & 1;
                repeated |= side == 1 && ends[axis][0] == ends[axis][1];
                cells[axis] = ends[axis][side];
            }
            if !repeated && visit(KEYS.hash_one(cells)) {
                return true;
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_is_the_same_is_found_by_its_keys() {
        let mut rng = crate::SearchRng::new(7);
        for trial in 0..20_000 {
            let dimension = 1 + trial % 5;
            let separation = [0.0, 1e-3, 0.5][trial % 3];
            let a: Vec<f64> = (0..dimension).map(|_| 2.0 * rng.uniform() - 1.0).collect();
            let b: Vec<f64> = a
                .iter()
                .map(|x| x + separation * (2.0 * rng.uniform() - 1.0))
                .collect();
            let (a, b) = (Located::new(&a, separation), Located::new(&b, separation));
            let found = b.visit_keys(&mut |key| key == a.key());
            assert!(found || !a.same(&b), "{a:?} {b:?}");
        }
    }

    #[test]
    fn negative_zero_is_zero() {
        let (a, b) = (Located::new(&[0.0_f64], 0.0), Located::new(&[-0.0], 0.0));
        assert!(a.same(&b) && b.visit_keys(&mut |key| key == a.key()));
    }
}

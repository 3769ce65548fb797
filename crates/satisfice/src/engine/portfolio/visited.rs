//! Which lattice points have been proposed: a bounded memory that forgets before it grows too large.

use crate::scalar::Real;
use crate::space::Space;

/// At most this many points are remembered exactly: 32 MiB.
const MOST: usize = 1 << 22;
/// An empty slot; no point has this key.
const EMPTY: u64 = u64::MAX;

/// A set of lattice points, exact up to half of `MOST` points. Beyond, a new point takes the place of an old one, so that a point
/// may be proposed again but none is ever held for visited that was not (but for 64-bit collisions in spaces of 2^63
/// points and more).
///
/// Cost: a multiplication an axis and one cache line. Memory: 8 to 32 bytes a point.
#[derive(Debug, Clone, Default)]
pub(super) struct Visited {
    slots: Vec<u64>,
    points: usize,
    forgot: bool,
    /// Number of points of the space, if it is below 2^63.
    cardinality: Option<u64>,
}

crate::saved_struct!(Visited {
    slots,
    points,
    forgot,
    cardinality
});

impl Visited {
    pub(super) fn new<S: Real>(space: &Space<S>) -> Self {
        let count = space.cardinality().filter(|&count| count < 9.2e18);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "checked; exact below 2^53"
        )]
        Self {
            slots: vec![EMPTY; 1 << 10],
            points: 0,
            forgot: false,
            cardinality: count.map(|count| count as u64),
        }
    }

    /// Remembers the point at a position that is inside; returns whether it was new.
    #[inline]
    pub(super) fn insert<S: Real>(&mut self, space: &Space<S>, position: &[S]) -> bool {
        let key = self.key(space, position);
        self.insert_key(key)
    }

    /// Whether the point at a position that is inside is remembered.
    #[inline]
    pub(super) fn contains<S: Real>(&self, space: &Space<S>, position: &[S]) -> bool {
        let key = self.key(space, position);
        let start = spread(key) as usize & (self.slots.len() - 1) & !3;
        self.slots[start..start + 4].contains(&key)
    }

    fn insert_key(&mut self, key: u64) -> bool {
        if 2 * self.points >= self.slots.len() && self.slots.len() < MOST {
            self.grow();
        }
        // Four neighbouring slots stay in one cache line.
        let start = spread(key) as usize & (self.slots.len() - 1) & !3;
        for slot in &mut self.slots[start..start + 4] {
            if *slot == key {
                return false;
            }
            if *slot == EMPTY {
                *slot = key;
                self.points += 1;
                return true;
            }
        }
        if self.slots.len() < MOST {
            self.grow();
            return self.insert_key(key);
        }
        self.forgot = true;
        self.slots[start + (key & 3) as usize] = key;
        true
    }

    /// Whether every point of the space has been proposed.
    pub(super) fn is_all(&self) -> bool {
        !self.forgot && self.cardinality == Some(self.points as u64)
    }

    /// Whether so much of the space is visited that uniform draws would mostly repeat.
    pub(super) fn is_dense(&self) -> bool {
        !self.forgot
            && self
                .cardinality
                .is_some_and(|count| self.points as u64 * 2 > count)
    }

    /// The place of a point in the order of the lattice, or a hash where the space has 2^63 points and more.
    #[inline]
    fn key<S: Real>(&self, space: &Space<S>, position: &[S]) -> u64 {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a cell of an axis is a whole number"
        )]
        let cell = |(axis, &x): (&crate::Axis<S>, &S)| (axis.value(x) - axis.lower()).f64() as u64;
        let cells = space.axes().iter().zip(position).map(|pair| (pair.0, cell(pair)));
        if self.cardinality.is_some() {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "likewise")]
            cells.fold(0, |key, (axis, cell)| key * (axis.width().f64() as u64) + cell)
        } else {
            cells.fold(1, |key, (_, cell)| spread(key ^ cell)) & !(1 << 63)
        }
    }

    /// Writes the position of the `index`-th point of the lattice; the inverse of `key`.
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "as in `key`"
    )]
    pub(super) fn point<S: Real>(space: &Space<S>, mut index: u64, position: &mut [S]) {
        for (axis, x) in space.axes().iter().zip(position).rev() {
            let count = axis.width().f64() as u64;
            *x = axis.position(axis.lower() + S::of((index % count) as f64));
            index /= count;
        }
    }

    fn grow(&mut self) {
        let old = core::mem::take(&mut self.slots);
        self.slots = vec![EMPTY; 2 * old.len()];
        self.points = 0;
        for key in old.into_iter().filter(|&key| key != EMPTY) {
            self.insert_key(key);
        }
    }
}

#[inline]
fn spread(key: u64) -> u64 {
    let key = (key ^ (key >> 32)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    key ^ (key >> 29)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::{Axis, SearchRng};

    #[test]
    fn agrees_with_an_ordered_set_while_nothing_is_forgotten() {
        let space =
            Space::<f64>::new([Axis::integer(-3, 60), Axis::integer(0, 999), Axis::integer(5, 5)]).unwrap();
        let (mut visited, mut set, mut rng) = (Visited::new(&space), BTreeSet::new(), SearchRng::new(1));
        let mut position = [0.0; 3];
        for _ in 0..100_000 {
            rng.position(&space, &mut position);
            let cells = [position[0].floor() as i64, position[1].floor() as i64];
            assert_eq!(visited.insert(&space, &position), set.insert(cells));
        }
        assert_eq!(visited.points, set.len());
        assert!(visited.is_dense() && !visited.is_all());
    }

    #[test]
    fn the_order_of_the_lattice_covers_it() {
        let space = Space::<f32>::new([Axis::integer(-3, 4), Axis::integer(0, 6)]).unwrap();
        let mut visited = Visited::new(&space);
        let mut position = [0.0; 2];
        for index in 0..56 {
            assert!(!visited.is_all());
            Visited::point(&space, index, &mut position);
            assert!(space.contains(&position) && visited.insert(&space, &position));
            assert_eq!(visited.key(&space, &position), index);
        }
        assert!(visited.is_all());
    }
}

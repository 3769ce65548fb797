//! Which lattice points have been proposed: a bounded memory that forgets before it grows too large.

use crate::scalar::Real;
use crate::space::{AxisKind, Space};

/// Tables that the points are spread over. Each grows by itself, and moves few points when it does: one table for all would
/// stop the search for tens of milliseconds when it grows at a million points.
const SHARDS: usize = 16;
/// Slots of a table at first, and at most: half of them are used, so 2^21 points are remembered exactly, in 32 MiB.
const FIRST: usize = 1 << 6;
const MOST: usize = 1 << 18;
/// Points of a table in a checkpoint of a search that cannot be repeated.
const MOST_SAVED: usize = 1 << 12;
/// An empty slot; every key of a point is less.
const EMPTY: u64 = u64::MAX;
/// A lattice of at most this many points has a bit for each: at most 1 MiB, of which only the parts in use take memory.
const BITS: u64 = 1 << 23;

/// A set of lattice points, exact up to 2^21 points. Beyond, a new point takes the place of an old one, so that a point may be
/// proposed again but none is ever taken for visited that was not (but for 64-bit collisions in spaces of 2^63 points and
/// more). A lattice of at most 2^23 points has a bit for each point instead.
///
/// Cost: a multiplication an axis and a cache line or two. Memory: about 16 to 32 bytes a point, 8 KiB at least.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
#[serde(from = "Keys", into = "Keys")]
pub(super) struct Visited {
    /// A bit for each point, or none and tables instead.
    bits: Vec<u64>,
    shards: Vec<Shard>,
    /// The number of cells of each axis.
    cells: Vec<u64>,
    points: usize,
    forgot: bool,
    /// Number of points of the space, if it is below 2^63.
    cardinality: Option<u64>,
}

/// A table with open addressing and linear probing, at most half full. On the way from a key's first slot to its own there are only
/// smaller keys: the place of each follows from which keys there are, not from the order in which they came (Amble, Knuth 1974, Ordered
/// hash tables, The Computer Journal 17), so that a checkpoint need only say which.
#[derive(Debug, Clone)]
struct Shard {
    slots: Vec<u64>,
    points: usize,
}

/// What became of a key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Entered {
    New,
    Known,
    /// It is in the place of another one, or forgotten already.
    Replacing,
}

impl Shard {
    fn new() -> Self {
        Self {
            slots: vec![EMPTY; FIRST],
            points: 0,
        }
    }

    /// The slot of a key, or the one where it would be.
    #[inline]
    fn slot(&self, hash: u64, key: u64) -> usize {
        let last = self.slots.len() - 1;
        #[expect(clippy::cast_possible_truncation, reason = "the lowest bits are wanted")]
        let mut slot = hash as usize & last;
        while self.slots[slot] < key {
            slot = (slot + 1) & last;
        }
        slot
    }

    fn insert(&mut self, hash: u64, key: u64) -> Entered {
        let slot = self.slot(hash, key);
        if self.slots[slot] == key {
            return Entered::Known;
        }
        if 2 * self.points < self.slots.len() {
            self.put(slot, key);
            self.points += 1;
            return Entered::New;
        }
        if self.slots.len() < MOST {
            let twice = vec![EMPTY; 2 * self.slots.len()];
            for key in core::mem::replace(&mut self.slots, twice) {
                if key != EMPTY {
                    self.put(self.slot(spread(key), key), key);
                }
            }
            return self.insert(hash, key);
        }
        // Replace the key that is there, which keeps every probe sequence in order. An empty slot stays empty, so that every
        // search ends; the point is then forgotten at once.
        if self.slots[slot] != EMPTY {
            self.slots[slot] = key;
        }
        Entered::Replacing
    }

    /// The keys, in the order of their slots.
    fn keys(&self) -> impl Iterator<Item = u64> {
        self.slots.iter().copied().filter(|&key| key != EMPTY)
    }

    /// The same with the first of its keys.
    fn first(&self, count: usize) -> Self {
        let mut first = Self::new();
        for key in self.keys().take(count) {
            first.insert(spread(key), key);
        }
        first
    }

    /// Puts a key into the slot where it belongs, and moves larger ones on.
    fn put(&mut self, mut slot: usize, mut key: u64) {
        let last = self.slots.len() - 1;
        while key != EMPTY {
            if key < self.slots[slot] {
                core::mem::swap(&mut key, &mut self.slots[slot]);
            }
            slot = (slot + 1) & last;
        }
    }
}

/// What is saved of [`Visited`]: of tables, the keys of each in order, as differences.
#[derive(serde::Serialize, serde::Deserialize)]
struct Keys {
    bits: Vec<u64>,
    tables: Vec<Vec<u64>>,
    cells: Vec<u64>,
    points: usize,
    forgot: bool,
    cardinality: Option<u64>,
}

impl From<Visited> for Keys {
    fn from(visited: Visited) -> Self {
        let differences = |shard: Shard| {
            let mut keys: Vec<u64> = shard.keys().collect();
            keys.sort_unstable();
            let mut before = 0;
            for key in &mut keys {
                *key -= core::mem::replace(&mut before, *key);
            }
            keys
        };
        Self {
            bits: visited.bits,
            tables: visited.shards.into_iter().map(differences).collect(),
            cells: visited.cells,
            points: visited.points,
            forgot: visited.forgot,
            cardinality: visited.cardinality,
        }
    }
}

impl From<Keys> for Visited {
    fn from(keys: Keys) -> Self {
        let table = |differences: Vec<u64>| {
            let mut shard = Shard::new();
            let mut key = 0_u64;
            for difference in differences {
                key = key.saturating_add(difference).min(EMPTY - 1);
                shard.insert(spread(key), key);
            }
            shard
        };
        let mut shards: Vec<Shard> = keys.tables.into_iter().map(table).collect();
        if keys.bits.is_empty() {
            // A damaged state may have fewer.
            shards.resize(SHARDS, Shard::new());
        }
        Self {
            bits: keys.bits,
            shards,
            cells: keys.cells,
            points: keys.points,
            forgot: keys.forgot,
            cardinality: keys.cardinality,
        }
    }
}

impl Visited {
    pub(super) fn new<S: Real>(space: &Space<S>) -> Self {
        let count = space.cardinality().filter(|&count| count < 9.2e18);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "checked; exact below 2^53"
        )]
        let cardinality = count.map(|count| count as u64);
        let few = cardinality.filter(|&count| count <= BITS);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole numbers, few words"
        )]
        Self {
            bits: vec![0; few.map_or(0, |count| count.div_ceil(64) as usize)],
            shards: vec![Shard::new(); if few.is_some() { 0 } else { SHARDS }],
            cells: space.axes().iter().map(|axis| axis.choices() as u64).collect(),
            points: 0,
            forgot: false,
            cardinality,
        }
    }

    /// Remembers the point at a position that is inside; returns whether it was new.
    #[inline]
    pub(super) fn insert<S: Real>(&mut self, space: &Space<S>, position: &[S]) -> bool {
        let key = self.key(space, position);
        if !self.bits.is_empty() {
            let (word, bit) = bit_of(key);
            // A damaged state may have too few.
            let Some(word) = self.bits.get_mut(word) else {
                return false;
            };
            let is_new = *word & bit == 0;
            *word |= bit;
            self.points += usize::from(is_new);
            return is_new;
        }
        let hash = spread(key);
        let entered = self.shards[shard_of(hash)].insert(hash, key);
        self.points += usize::from(entered == Entered::New);
        self.forgot |= entered == Entered::Replacing;
        entered != Entered::Known
    }

    /// Whether the point at a position that is inside is remembered.
    #[inline]
    pub(super) fn contains<S: Real>(&self, space: &Space<S>, position: &[S]) -> bool {
        let key = self.key(space, position);
        if !self.bits.is_empty() {
            let (word, bit) = bit_of(key);
            return self.bits.get(word).is_none_or(|word| word & bit != 0);
        }
        let hash = spread(key);
        let shard = &self.shards[shard_of(hash)];
        shard.slots[shard.slot(hash, key)] == key
    }

    /// The same with the points that a checkpoint has room for, if it need not repeat the search: some may then be proposed once more.
    pub(super) fn shortened(&self) -> Self {
        let mut short = Self {
            shards: self.shards.iter().map(|shard| shard.first(MOST_SAVED)).collect(),
            bits: self.bits.clone(),
            cells: self.cells.clone(),
            ..*self
        };
        if self.is_large() {
            short.points = short.shards.iter().map(|shard| shard.points).sum();
            short.forgot |= short.points < self.points;
        }
        short
    }

    /// Whether points are looked up in tables.
    pub(super) fn is_large(&self) -> bool {
        self.bits.is_empty()
    }

    /// Whether every point of the space has been proposed.
    pub(super) fn is_all(&self) -> bool {
        !self.forgot && self.cardinality == Some(self.points as u64)
    }

    /// Number of points that are not visited, where none was forgotten.
    pub(super) fn unvisited(&self) -> Option<u64> {
        let count = self.cardinality.filter(|_| !self.forgot)?;
        Some(count - self.points as u64)
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
        let cell = |(j, (axis, &x)): (usize, (&crate::Axis<S>, &S))| {
            if axis.kind() == AxisKind::Place {
                axis.inversions(&position[j..]) as u64
            } else {
                (axis.value(x) - axis.lower()).f64() as u64
            }
        };
        let cells = space.axes().iter().zip(position).enumerate().map(cell);
        if self.cardinality.is_some() {
            let cells = cells.zip(&self.cells);
            cells.fold(0, |key, (cell, count)| {
                key.wrapping_mul(*count).wrapping_add(cell)
            })
        } else {
            cells.fold(1, |key, cell| spread(key ^ cell)) & !(1 << 63)
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
        let axes = space.axes();
        for (j, axis) in axes.iter().enumerate().rev() {
            let count = axis.choices() as u64;
            let cell = S::of((index % count) as f64);
            index /= count;
            if axis.kind() == AxisKind::Place {
                position[j] = cell;
                axis.insert_rank(&mut position[j..]);
            } else {
                position[j] = axis.position(axis.lower() + cell);
            }
        }
        for (axis, x) in axes.iter().zip(position) {
            if axis.kind() == AxisKind::Place {
                *x = axis.key_of_rank(*x);
            }
        }
    }
}

/// The word of a key, and its bit there.
#[inline]
fn bit_of(key: u64) -> (usize, u64) {
    ((key / 64) as usize, 1 << (key % 64))
}

#[inline]
fn spread(key: u64) -> u64 {
    let key = (key ^ (key >> 32)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    key ^ (key >> 29)
}

/// The table of a hash: by its highest bits, which choose no slot.
#[inline]
fn shard_of(hash: u64) -> usize {
    (hash >> 60) as usize
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

    /// The orders of a permutation are numbered among the integers beside it.
    #[test]
    fn the_order_of_the_lattice_covers_permutations() {
        let axes = [Axis::integer(2, 4)].into_iter().chain(Axis::permutation(4));
        let space =
            Space::<f64>::new(axes.chain([Axis::categorical(2)]).chain(Axis::permutation(3))).unwrap();
        assert_eq!(space.cardinality(), Some(864.0));
        let (mut visited, mut all) = (Visited::new(&space), BTreeSet::new());
        let (mut position, mut values) = ([0.0; 9], [0.0; 9]);
        for index in 0..864 {
            Visited::point(&space, index, &mut position);
            assert!(space.contains(&position) && visited.insert(&space, &position));
            assert_eq!(visited.key(&space, &position), index);
            space.values(&position, &mut values);
            space.check_values(&values).unwrap();
            assert!(all.insert(values.map(|x| x as u8)));
        }
        assert!(visited.is_all());
        // Equal keys are ranked in their order.
        assert_eq!(
            visited.key(&space, &[2.0, 0.5, 0.5, 0.5, 0.5, 0.0, 0.1, 0.1, 0.1]),
            0
        );
    }

    #[test]
    fn beyond_its_memory_it_forgets_but_invents_nothing() {
        let space = Space::<f64>::lattice(2, 4096).unwrap();
        let mut visited = Visited::new(&space);
        let mut position = [0.0; 2];
        let held = |visited: &Visited| {
            visited
                .shards
                .iter()
                .map(|shard| shard.slots.len())
                .sum::<usize>()
        };
        for index in (0..6_000_000).step_by(2) {
            Visited::point(&space, index, &mut position);
            assert!(visited.insert(&space, &position));
        }
        assert!(visited.forgot && !visited.is_all());
        assert!(held(&visited) <= SHARDS * MOST);
        let mut remembered = 0_u32;
        for index in 0..6_000_000 {
            Visited::point(&space, index, &mut position);
            let known = visited.contains(&space, &position);
            assert!(!known || index % 2 == 0, "{index} was never there");
            remembered += u32::from(known);
        }
        assert!(remembered > 2_000_000, "{remembered}");
    }

    #[test]
    fn a_short_one_has_some_of_the_points() {
        let space = Space::<f64>::lattice(2, 4096).unwrap();
        let (mut visited, mut position) = (Visited::new(&space), [0.0; 2]);
        for index in 0..200_000 {
            Visited::point(&space, 2 * index, &mut position);
            visited.insert(&space, &position);
            if index == 1_000 {
                let short = visited.shortened();
                assert_eq!((short.points, short.forgot), (visited.points, false));
            }
        }
        let short = visited.shortened();
        let points = (0..400_000).filter(|&index| {
            Visited::point(&space, index, &mut position);
            short.contains(&space, &position)
        });
        let points: Vec<u64> = points.collect();
        assert_eq!(points.len(), SHARDS * MOST_SAVED);
        assert!(points.iter().all(|index| index % 2 == 0));
        assert!(short.points == points.len() && short.forgot);
        // Of a small lattice all points are kept: a bit for each.
        let space = Space::<f64>::lattice(2, 1000).unwrap();
        let mut all = Visited::new(&space);
        for index in 0..1_000_000 {
            Visited::point(&space, index, &mut position);
            all.insert(&space, &position);
        }
        assert!(all.shortened().is_all());
    }

    #[test]
    fn it_takes_few_bytes_a_point() {
        let space = Space::<f64>::lattice(2, 4096).unwrap();
        let (mut visited, mut rng) = (Visited::new(&space), SearchRng::new(2));
        let mut position = [0.0; 2];
        for n in 1..300_000_usize {
            rng.position(&space, &mut position);
            visited.insert(&space, &position);
            if n.is_multiple_of(10_000) {
                let slots: usize = visited.shards.iter().map(|shard| shard.slots.len()).sum();
                assert!(slots * 8 <= 36 * visited.points, "{slots} slots for {n}");
            }
        }
    }
}

//! What is known of each candidate, found by its position.

use crate::scalar::Real;

/// Slots of the table at first.
const FIRST: usize = 1 << 6;
/// The index of an empty slot.
const EMPTY: u32 = u32::MAX;
/// The bits of a count that say that the candidate has been proposed, and that it is evaluated: then it has both.
const PROPOSED: u32 = 1 << 31;
const EVALUATED: u32 = 1 << 30 | PROPOSED;
/// A candidate has fewer parts.
pub(super) const MOST_PARTS: u32 = 1 << 30;

/// A neighbour of evaluated points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    key: u64,
    /// Sum of the fitness of its expanded neighbours; once it is evaluated, its own fitness.
    pub(super) sum: f64,
    /// How many these neighbours are; once it is evaluated, how many parts of its own neighbours are entered.
    count: u32,
    /// Its place in the order in which candidates were met.
    pub(super) index: u32,
}

impl Candidate {
    const NONE: Self = Self {
        key: 0,
        sum: 0.0,
        count: 0,
        index: EMPTY,
    };

    pub(super) fn is_proposed(&self) -> bool {
        self.count & PROPOSED != 0
    }

    pub(super) fn propose(&mut self) {
        self.count |= PROPOSED;
    }

    /// Adds the fitness of an expanded neighbour; returns their number.
    pub(super) fn meet(&mut self, fitness: f64) -> u32 {
        self.sum += fitness;
        self.count += 1;
        self.count
    }

    /// Whether it waits to be proposed, and as many neighbours have been met.
    pub(super) fn waits(&self, count: u32) -> bool {
        self.count == count
    }

    pub(super) fn is_evaluated(&self) -> bool {
        self.count & EVALUATED == EVALUATED
    }

    pub(super) fn evaluate(&mut self, fitness: f64) {
        (self.sum, self.count) = (fitness, EVALUATED);
    }

    /// Whether it is evaluated, and a part of its neighbours is the next to enter.
    pub(super) fn waits_to_expand(&self, part: u32) -> bool {
        self.count == EVALUATED | part
    }

    pub(super) fn expand(&mut self, part: u32) {
        self.count = EVALUATED | (part + 1);
    }
}

/// All candidates, in the order in which they were met, and a table of them with open addressing and linear probing, at most three
/// quarters full.
///
/// The table holds all that is asked for beside each key, so that a look-up among a million candidates waits for one line of
/// memory; and whoever looks up many has these lines fetched together, by [`fetch`](Self::fetch).
#[derive(Debug, Default)]
pub(super) struct CandidateTable<S> {
    slots: Vec<Candidate>,
    positions: Vec<S>,
    count: usize,
}

impl<S: Real> CandidateTable<S> {
    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// Number of coordinates of all of them.
    pub(super) fn coordinates(&self) -> usize {
        self.positions.len()
    }

    /// The position of a candidate.
    pub(super) fn position(&self, index: u32, dimension: usize) -> &[S] {
        &self.positions[index as usize * dimension..(index as usize + 1) * dimension]
    }

    /// The candidate with an index.
    pub(super) fn get(&mut self, index: u32, dimension: usize) -> &mut Candidate {
        let slot = self.slot(key(self.position(index, dimension)));
        &mut self.slots[slot]
    }

    /// The indices of candidates that were proposed and are not known to be evaluated, in order.
    pub(super) fn only_proposed(&self) -> Vec<u32> {
        let known = self.slots.iter().filter(|slot| slot.index != EMPTY);
        let proposed = known.filter(|slot| slot.count & EVALUATED == PROPOSED);
        let mut indices: Vec<u32> = proposed.map(|slot| slot.index).collect();
        indices.sort_unstable();
        indices
    }

    /// The indices of evaluated candidates with their fitness, in any order.
    pub(super) fn evaluated(&self) -> Vec<(u32, f64)> {
        let known = self.slots.iter().filter(|slot| slot.index != EMPTY);
        let evaluated = known.filter(|slot| slot.is_evaluated());
        evaluated.map(|slot| (slot.index, slot.sum)).collect()
    }

    /// Makes room for so many more.
    pub(super) fn reserve(&mut self, more: usize) {
        let wanted = (self.count + more).saturating_mul(4) / 3;
        if wanted >= self.slots.len() {
            let larger = vec![Candidate::NONE; (wanted + 1).max(FIRST).next_power_of_two()];
            for candidate in core::mem::replace(&mut self.slots, larger) {
                if candidate.index != EMPTY {
                    let slot = self.slot(candidate.key);
                    self.slots[slot] = candidate;
                }
            }
        }
    }

    /// Has the slots of keys fetched from memory, all at the same time.
    pub(super) fn fetch(&self, keys: &[u64]) {
        let read = |all: u32, &key: &u64| all ^ self.slots[self.first(key)].index;
        core::hint::black_box(keys.iter().fold(0, read));
    }

    /// The candidate with a key and a position, new or known. There has to be [room](Self::reserve).
    pub(super) fn enter(&mut self, key: u64, position: &[S]) -> &mut Candidate {
        let slot = self.slot(key);
        let candidate = &mut self.slots[slot];
        if candidate.index == EMPTY {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "2^32 candidates do not fit in memory"
            )]
            let index = self.count as u32;
            *candidate = Candidate {
                key,
                index,
                ..Candidate::NONE
            };
            self.count += 1;
            self.positions.extend_from_slice(position);
        }
        candidate
    }

    /// Where the search for a key begins: by its highest bits, so that a table that grows is copied from end to end.
    fn first(&self, key: u64) -> usize {
        #[expect(clippy::cast_possible_truncation, reason = "below the number of slots")]
        let first = (key >> (64 - self.slots.len().trailing_zeros())) as usize;
        first
    }

    /// The slot of a key, or the empty one where it would be.
    fn slot(&self, key: u64) -> usize {
        let mut slot = self.first(key);
        while self.slots[slot].index != EMPTY && self.slots[slot].key != key {
            slot = (slot + 1) & (self.slots.len() - 1);
        }
        slot
    }
}

/// A hash of a position; two that share one are taken for the same, at odds of 2^-64. In four lanes, so that many axes do not wait for
/// each other.
pub(super) fn key<S: Real>(position: &[S]) -> u64 {
    let mix = |hash: u64, word: u64| {
        let hash = (hash.rotate_left(23) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        hash ^ (hash >> 32)
    };
    let mut lanes = [0, 1, 2, 3];
    let groups = position.chunks_exact(lanes.len());
    let rest = groups.remainder();
    for group in groups {
        for (lane, x) in lanes.iter_mut().zip(group) {
            *lane = mix(*lane, x.to_word());
        }
    }
    let words = rest.iter().map(|x| x.to_word());
    lanes.into_iter().chain(words).fold(0, mix)
}

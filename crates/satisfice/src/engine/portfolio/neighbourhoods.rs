//! Best-first exhaustion of the neighbourhoods that the problem itself names.

use std::collections::BinaryHeap;

use hashbrown::HashTable;

use crate::batch::{Batch, Outcome};
use crate::context::{Context, points_at_once};
use crate::scalar::{Real, ordered};
use crate::state::{Reader, Saved, State};

/// Once this many candidates are known, only hits are expanded: some 60 MB at two axes.
const MOST: usize = 1 << 20;

/// Most coordinates of candidates, which bounds the memory of many axes: 128 MB in double precision.
const MOST_COORDINATES: usize = 1 << 24;

/// The count of an entry for an evaluated point whose neighbours are not entered yet: this bit, and how many
/// [parts](points_at_once) of them are.
const UNEXPANDED: u32 = 1 << 31;

/// A neighbour of evaluated points.
#[derive(Debug, Clone, Copy, serde::Serialize, serde::Deserialize)]
struct Candidate {
    key: u64,
    /// Sum of the fitness of its expanded neighbours, and how many they are; once it is evaluated, its own fitness.
    sum: f64,
    count: u32,
    proposed: bool,
}

/// An entry of the queue, best first: predicted fitness as ordered bits, then the order of entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
struct Entry {
    /// Complemented, because the heap gives its greatest.
    unfitness: u64,
    unage: u64,
    candidate: u32,
    /// The candidate's count at entry: an entry that a later one has replaced is passed over. Or [`UNEXPANDED`] and a part.
    count: u32,
}

/// The graph that the problem's neighbours span, explored from the hits, the candidate with the least predicted fitness
/// first.
///
/// A candidate's fitness is predicted by the mean of its evaluated neighbours', shrunk by one observation towards the mean of
/// all candidates so far. Unlike breadth-first order, this crosses the gaps between patches of hits.
///
/// Lazily, the neighbours of an evaluated point are entered when it is their turn, as predicted from this point alone. Most
/// points that miss never come to that, which saves dozens of entries an evaluation; but then they do not tell against the
/// candidates that they share with hits, either.
#[derive(Debug, Default)]
pub(super) struct Neighbourhoods<S> {
    lazy: bool,
    candidates: Vec<Candidate>,
    positions: Vec<S>,
    table: HashTable<u32>,
    heap: BinaryHeap<Entry>,
    entries: u64,
    /// Sum and number of the fitness of evaluated candidates.
    sum: f64,
    count: f64,
}

impl<S: Real> Neighbourhoods<S> {
    /// Forgets everything, and sets whether to be lazy.
    pub(super) fn begin(&mut self, lazy: bool) {
        *self = Self {
            lazy,
            ..Self::default()
        };
    }

    /// Whether there is a candidate to try.
    pub(super) fn has_more(&self) -> bool {
        !self.heap.is_empty()
    }

    /// Takes note of the hits of a batch, and of the misses that are near to a hit, by their place in the batch.
    pub(super) fn expand_all(
        &mut self,
        context: &dyn Context<S>,
        batch: &Batch<S>,
        outcomes: &[Outcome<S>],
        is_near: impl Fn(usize) -> bool,
    ) {
        for (i, (position, outcome)) in batch.points().zip(outcomes).enumerate() {
            match *outcome {
                Outcome::Hit(fitness) => self.expand(context, position, fitness, true),
                Outcome::Miss(fitness) if is_near(i) => self.expand(context, position, fitness, false),
                _ => {}
            }
        }
    }

    /// Takes note of an evaluated point, whose neighbours become candidates.
    fn expand(&mut self, context: &dyn Context<S>, position: &[S], fitness: S, is_hit: bool) {
        if self.positions.len() >= MOST_COORDINATES || !is_hit && self.candidates.len() >= MOST {
            return;
        }
        let fitness = fitness.f64();
        let index = self.index_of(position);
        let candidate = &mut self.candidates[index as usize];
        (candidate.proposed, candidate.sum) = (true, fitness);
        if self.lazy {
            self.enter(index, f64::midpoint(fitness, self.prior(fitness)), UNEXPANDED);
        } else {
            self.expand_part(context, index, position, 0);
        }
    }

    /// Makes candidates of a part of the neighbours of an evaluated point, and enters it once more if more are left.
    fn expand_part(&mut self, context: &dyn Context<S>, index: u32, position: &[S], part: u32) {
        let fitness = self.candidates[index as usize].sum;
        let prior = self.prior(fitness);
        let size = points_at_once(position.len());
        let start = part as usize * size;
        context.neighbours(position, start..start + size, &mut |_, neighbour| {
            self.meet(neighbour, fitness, prior);
        });
        if part + 1 < UNEXPANDED && context.neighbour_count(position) > start + size {
            self.enter(index, f64::midpoint(fitness, prior), UNEXPANDED | (part + 1));
        }
    }

    /// The prior of a candidate's fitness: the mean of all candidates so far, or the given one before there are any.
    fn prior(&self, fitness: f64) -> f64 {
        if self.count > 0.0 {
            self.sum / self.count
        } else {
            fitness
        }
    }

    fn enter(&mut self, candidate: u32, predicted: f64, count: u32) {
        self.entries += 1;
        self.heap.push(Entry {
            unfitness: !ordered(predicted),
            unage: !self.entries,
            candidate,
            count,
        });
    }

    fn meet(&mut self, position: &[S], fitness: f64, prior: f64) {
        let index = self.index_of(position);
        let candidate = &mut self.candidates[index as usize];
        if candidate.proposed {
            return;
        }
        candidate.sum += fitness;
        candidate.count += 1;
        let (sum, count) = (candidate.sum, candidate.count);
        self.enter(index, (sum + prior) / (f64::from(count) + 1.0), count);
    }

    /// The candidate at a position, new or known.
    fn index_of(&mut self, position: &[S]) -> u32 {
        let key = key(position);
        let known = self.table.find(key, |&i| self.candidates[i as usize].key == key);
        if let Some(&index) = known {
            return index;
        }
        #[expect(
            clippy::cast_possible_truncation,
            reason = "2^32 candidates do not fit in memory"
        )]
        let index = self.candidates.len() as u32;
        self.candidates.push(Candidate {
            key,
            sum: 0.0,
            count: 0,
            proposed: false,
        });
        self.positions.extend_from_slice(position);
        self.table
            .insert_unique(key, index, |&i| self.candidates[i as usize].key);
        index
    }

    /// Writes the best candidate; `false` when there is none.
    pub(super) fn propose(&mut self, context: &dyn Context<S>, position: &mut [S]) -> bool {
        let dimension = position.len();
        while let Some(entry) = self.heap.pop() {
            let index = entry.candidate as usize;
            let candidate = &mut self.candidates[index];
            let at = index * dimension..(index + 1) * dimension;
            if entry.count & UNEXPANDED != 0 {
                position.copy_from_slice(&self.positions[at]);
                self.expand_part(context, entry.candidate, position, entry.count & !UNEXPANDED);
            } else if !candidate.proposed && candidate.count == entry.count {
                candidate.proposed = true;
                position.copy_from_slice(&self.positions[at]);
                return true;
            }
        }
        false
    }

    /// Counts a candidate and its fitness.
    pub(super) fn count(&mut self, fitness: S) {
        if fitness.is_finite() {
            self.sum += fitness.f64();
            self.count += 1.0;
        }
    }
}

impl<S: Real> Neighbourhoods<S> {
    pub(super) fn save(&self, state: &mut State) {
        self.candidates.save(state);
        self.positions.save(state);
        // The order inside a heap does not matter: equal entries do not occur.
        self.heap.clone().into_sorted_vec().save(state);
        self.entries.save(state);
        [self.sum, self.count].save(state);
    }
    pub(super) fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), crate::Error> {
        self.candidates = from.read()?;
        self.positions = from.read()?;
        self.heap = from.read::<Vec<Entry>>()?.into();
        self.entries = from.read()?;
        [self.sum, self.count] = from.read()?;
        self.table = HashTable::new();
        let candidates = &self.candidates;
        for (index, candidate) in (0..).zip(candidates) {
            self.table
                .insert_unique(candidate.key, index, |&i: &u32| candidates[i as usize].key);
        }
        Ok(())
    }

    /// Whether restored parts fit each other and the space.
    pub(super) fn fit(&self, dimension: usize) -> bool {
        let count = self.candidates.len();
        self.positions.len() == count * dimension
            && self.heap.iter().all(|entry| (entry.candidate as usize) < count)
    }
}

/// A hash of a position; two that share one are taken for the same, at odds of 2^-64. In four lanes, so that many axes do not wait for
/// each other.
fn key<S: Real>(position: &[S]) -> u64 {
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

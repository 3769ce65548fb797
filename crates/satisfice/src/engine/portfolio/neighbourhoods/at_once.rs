//! Neighbours that become candidates as soon as their point is evaluated.

use std::collections::BinaryHeap;

use super::candidates::{CandidateTable, MOST_PARTS, key};
use super::journal::{Entry, Journal};
use crate::context::{Context, points_at_once};
use crate::scalar::{Real, ordered};
use crate::state::{Reader, Saved, State};

/// Once this many candidates are known, only hits are expanded: some 110 MB at two axes.
const MOST: usize = 1 << 20;

/// The same once so many entries of the queue were made: of few candidates that are met often, or many that are met twice.
const MOST_ENTRIES: u64 = 1 << 21;

/// Most coordinates of candidates, which bounds the memory of many axes: 128 MB in double precision.
const MOST_COORDINATES: usize = 1 << 24;

/// The count of an entry for an evaluated point whose neighbours are not entered yet: this bit, and how many
/// [parts](points_at_once) of them are.
const UNEXPANDED: u32 = 1 << 31;

/// An entry of the queue, best first: predicted fitness as ordered bits, then the order of entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Queued {
    /// Complemented, because the heap gives its greatest.
    unfitness: u64,
    unage: u64,
    candidate: u32,
    /// The candidate's count at entry: an entry that a later one has replaced is passed over. Or [`UNEXPANDED`] and a part.
    count: u32,
}

/// What waits to be proposed or expanded, best first.
#[derive(Debug, Default)]
struct Queue {
    heap: BinaryHeap<Queued>,
    /// How many have been entered.
    entries: u64,
}

/// The graph that the problem's neighbours span, explored from the hits, the candidate with the least predicted fitness
/// first.
///
/// A candidate's fitness is predicted by the mean of its evaluated neighbours', shrunk by one observation towards the mean of
/// all candidates so far. Unlike breadth-first order, this crosses the gaps between patches of hits. Cost: a look-up and an entry for
/// each neighbour of an evaluated point.
///
/// A checkpoint holds the [journal](Journal) and which candidates were proposed; the rest is [made again](Self::make_again).
#[derive(Debug, Default)]
pub(super) struct NeighboursAtOnce<S> {
    candidates: CandidateTable<S>,
    queue: Queue,
    /// Sum and number of the fitness of evaluated candidates.
    sum: f64,
    count: f64,
    journal: Journal<S>,
    /// What was restored, and which candidates were proposed and not entered as evaluated by then.
    restored: Option<(Journal<S>, Vec<u32>)>,
    /// The neighbours of a point, and their keys. Not saved: filled anew each time.
    listed: Vec<S>,
    keys: Vec<u64>,
}

impl<S: Real> NeighboursAtOnce<S> {
    /// Whether there is a candidate to try.
    pub(super) fn has_more(&self) -> bool {
        !self.queue.heap.is_empty()
    }

    /// Takes entries that others have replaced from the top of the queue. How many there are depends on whether the candidates were
    /// [made again](Self::make_again), so that they must not count as candidates to try.
    pub(super) fn pass_over(&mut self, dimension: usize) {
        while let Some(&Queued { candidate, count, .. }) = self.queue.heap.peek() {
            let candidate = self.candidates.get(candidate, dimension);
            let waits = if count & UNEXPANDED == 0 {
                candidate.waits(count)
            } else {
                candidate.waits_to_expand(count & !UNEXPANDED)
            };
            if waits {
                return;
            }
            self.queue.heap.pop();
        }
    }

    /// Whether no more misses are expanded.
    pub(super) fn is_full(&self) -> bool {
        self.candidates.len() >= MOST
            || self.queue.entries >= MOST_ENTRIES
            || self.candidates.coordinates() >= MOST_COORDINATES
    }

    /// The evaluated candidates with their fitness, in the order in which they were met.
    pub(super) fn evaluated(&self, dimension: usize) -> impl Iterator<Item = (&[S], f64)> {
        let mut evaluated = self.candidates.evaluated();
        evaluated.sort_unstable_by_key(|&(index, _)| index);
        let with_position = move |(index, fitness)| (self.candidates.position(index, dimension), fitness);
        evaluated.into_iter().map(with_position)
    }

    /// Takes note of an evaluated point, whose neighbours become candidates. After some of these, candidates are to be
    /// [passed over](Self::pass_over).
    pub(super) fn expand(&mut self, context: &dyn Context<S>, position: &[S], fitness: f64, is_hit: bool) {
        let room = self.candidates.coordinates() < MOST_COORDINATES;
        if room && (is_hit || !self.is_full()) {
            self.expand_as(Visit::First, context, position, fitness);
        }
    }

    fn expand_as(&mut self, visit: Visit, context: &dyn Context<S>, position: &[S], fitness: f64) {
        let known = self.candidates.len();
        self.candidates.reserve(1);
        let candidate = self.candidates.enter(key(position), position);
        if candidate.is_evaluated() {
            // It says nothing new.
            return;
        }
        candidate.evaluate(fitness);
        let index = candidate.index;
        self.journal
            .point(index, fitness, (index as usize == known).then_some(position));
        self.expand_part(context, index, 0, visit);
    }

    /// Makes candidates of a part of the neighbours of an evaluated point, and enters it once more if more are left.
    fn expand_part(&mut self, context: &dyn Context<S>, index: u32, part: u32, visit: Visit) {
        let dimension = context.space().dimension();
        let candidate = self.candidates.get(index, dimension);
        candidate.expand(part);
        let fitness = candidate.sum;
        if part > 0 {
            self.journal.part(index, part);
        }
        let prior = self.prior(fitness);
        let size = points_at_once(dimension);
        let start = part as usize * size;
        let position = self.candidates.position(index, dimension);
        let (listed, keys) = (&mut self.listed, &mut self.keys);
        listed.clear();
        keys.clear();
        let mut list = |_, neighbour: &[S]| {
            listed.extend_from_slice(neighbour);
            keys.push(key(neighbour));
        };
        match visit {
            Visit::First => context.neighbours(position, start..start + size, &mut list),
            Visit::Again => context.neighbours_again(position, start..start + size, &mut list),
        }
        let has_more =
            part + 1 < MOST_PARTS && context.neighbour_count(position) > start.saturating_add(size);
        self.candidates.reserve(self.keys.len());
        self.candidates.fetch(&self.keys);
        for (&key, neighbour) in self.keys.iter().zip(self.listed.chunks_exact(dimension)) {
            let candidate = self.candidates.enter(key, neighbour);
            if !candidate.is_proposed() {
                let count = candidate.meet(fitness);
                let predicted = (candidate.sum + prior) / (f64::from(count) + 1.0);
                self.queue.push(candidate.index, predicted, count);
            }
        }
        if has_more {
            self.queue
                .push(index, f64::midpoint(fitness, prior), UNEXPANDED | (part + 1));
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

    /// Writes the best candidate; `false` when there is none. The first of the queue is never one that another has replaced.
    pub(super) fn propose(&mut self, context: &dyn Context<S>, position: &mut [S]) -> bool {
        let dimension = position.len();
        while let Some(queued) = self.queue.heap.pop() {
            let index = queued.candidate;
            let is_point = queued.count & UNEXPANDED == 0;
            if is_point {
                self.candidates.get(index, dimension).propose();
                position.copy_from_slice(self.candidates.position(index, dimension));
            } else {
                self.expand_part(context, index, queued.count & !UNEXPANDED, Visit::First);
            }
            self.pass_over(dimension);
            if is_point {
                return true;
            }
        }
        false
    }

    /// Counts a candidate and its fitness.
    pub(super) fn count(&mut self, fitness: S) {
        if fitness.is_finite() {
            self.count_finite(fitness.f64());
        }
    }

    fn count_finite(&mut self, fitness: f64) {
        self.sum += fitness;
        self.count += 1.0;
        self.journal.count(fitness);
    }

    /// Makes the candidates of a restored search again, by the same steps. What is then queued besides, because it was proposed or
    /// entered by then, is passed over.
    pub(super) fn make_again(&mut self, context: &dyn Context<S>) {
        let Some((journal, proposed)) = self.restored.take() else {
            return;
        };
        let dimension = context.space().dimension();
        journal.replay(dimension, |entry| {
            match entry {
                Entry::Point(Ok(index), fitness) => {
                    let position = self.candidates.position(index, dimension).to_vec();
                    self.expand_as(Visit::Again, context, &position, fitness);
                }
                Entry::Point(Err(position), fitness) => {
                    self.expand_as(Visit::Again, context, position, fitness);
                }
                Entry::Part(index, part) => self.expand_part(context, index, part, Visit::Again),
                Entry::Count(fitness) => self.count_finite(fitness),
            }
            self.candidates.len()
        });
        for index in proposed {
            if (index as usize) < self.candidates.len() {
                self.candidates.get(index, dimension).propose();
            }
        }
        self.pass_over(dimension);
    }

    pub(super) fn save(&self, state: &mut State) {
        if let Some((journal, proposed)) = &self.restored {
            journal.save(state);
            proposed.save(state);
        } else {
            self.journal.save(state);
            self.candidates.only_proposed().save(state);
        }
    }

    pub(super) fn restore(from: &mut Reader<'_>) -> Result<Self, crate::Error> {
        Ok(Self {
            restored: Some((Journal::restore(from)?, from.read()?)),
            ..Self::default()
        })
    }

    /// Whether restored parts fit each other and the space.
    pub(super) fn fit(&self, dimension: usize) -> bool {
        self.restored
            .as_ref()
            .is_none_or(|(journal, _)| journal.fits(dimension))
    }
}

/// Whether neighbours are visited for the first time, or to make candidates again.
#[derive(Debug, Clone, Copy)]
enum Visit {
    First,
    Again,
}

impl Queue {
    fn push(&mut self, candidate: u32, predicted: f64, count: u32) {
        self.entries += 1;
        self.heap.push(Queued {
            unfitness: !ordered(predicted),
            unage: !self.entries,
            candidate,
            count,
        });
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::super::rooks::{Rooks, SIDE, rooks};
    use super::*;
    use crate::SearchRng;

    /// Proposes a point, evaluates it or not, counts it or not; now and then a point of others.
    fn step(all: &mut NeighboursAtOnce<f64>, context: &Rooks, rng: &mut SearchRng) -> Option<[f64; 2]> {
        let mut position = [0.0; 2];
        let is_own = all.propose(context, &mut position);
        if !is_own || rng.random_bool(0.1) {
            position = [0, 1].map(|_| f64::from(rng.random_range(0..SIDE as u32)));
        }
        let fitness = ((7.0 * position[0]).sin() * (3.0 * position[1]).cos() * 100.0).round() / 100.0;
        if rng.random_bool(0.8) {
            all.expand(context, &position, fitness, false);
            all.pass_over(2);
        }
        if rng.random_bool(0.8) {
            all.count(fitness);
        }
        is_own.then_some(position)
    }

    #[test]
    fn what_is_made_again_goes_on_as_it_would_have() {
        let context = rooks();
        let mut all = NeighboursAtOnce::default();
        let mut rng = SearchRng::new(8);
        for _ in 0..60 {
            step(&mut all, &context, &mut rng);
        }
        let mut state = State::default();
        all.save(&mut state);
        let calls = context.calls.get();
        let mut again = NeighboursAtOnce::restore(&mut Reader::new(&state)).unwrap();
        assert!(again.fit(2));
        // Saved once more before anything is made again.
        let mut same = State::default();
        again.save(&mut same);
        assert!(same == state);
        again.make_again(&context);
        assert_eq!(context.calls.get(), calls, "calls are not counted twice");
        let mut same = State::default();
        again.save(&mut same);
        assert!(same == state);
        let mut rng_again = rng.clone();
        for i in 0..60 {
            let (one, other) = (
                step(&mut all, &context, &mut rng),
                step(&mut again, &context, &mut rng_again),
            );
            assert_eq!(one, other, "{i}");
        }
    }

    #[test]
    fn a_checkpoint_takes_few_bytes_for_each_evaluated_point() {
        let context = rooks();
        let mut all = NeighboursAtOnce::default();
        let mut rng = SearchRng::new(3);
        for _ in 0..100 {
            step(&mut all, &context, &mut rng);
        }
        assert!(all.candidates.len() > 10_000, "{}", all.candidates.len());
        let mut state = State::default();
        all.save(&mut state);
        assert!(state.0.len() < 3000, "{}", state.0.len());
    }
}

//! Neighbours that become candidates as soon as their point is evaluated.

use std::collections::{BTreeSet, BinaryHeap};

use super::candidates::{Candidate, CandidateTable, key};
use crate::context::{Context, points_at_once};
use crate::engine::portfolio::visited::Visited;
use crate::error::Error;
use crate::scalar::{Real, ordered};
use crate::state::{Reader, Saved, State, read_rows, write_rows};

/// So many candidates wait at least, the best ones, and up to twice as many.
const MOST: usize = 1 << 12;

/// After so many predictions only hits are expanded.
const MOST_PREDICTIONS: u64 = 1 << 21;

/// The queue is made anew after so many entries, which bounds its memory: most of it may be replaced ones by then.
const MOST_ENTRIES: usize = 8 * MOST;

/// Outside lattices, so many points that miss are known not to be proposed twice.
const MOST_KNOWN: usize = 1 << 20;

/// An entry of the queue, best first: predicted fitness as ordered bits, then the order of entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
struct Queued {
    /// Complemented, because the heap gives its greatest.
    unfitness: u64,
    unage: u64,
    row: u32,
}

/// The graph that the problem's neighbours span, explored from the hits, the candidate with the least predicted fitness
/// first.
///
/// A candidate's fitness is predicted by the mean of its evaluated neighbours', shrunk by one observation towards the mean of
/// all candidates so far. Unlike breadth-first order, this crosses the gaps between patches of hits. Only the best candidates are kept; once
/// none is left, those next to hits are entered again. Cost: a look-up and an entry for each neighbour of an evaluated point.
#[derive(Debug, Default)]
pub(super) struct NeighboursAtOnce<S> {
    candidates: CandidateTable<S>,
    /// Entries of candidates; one that a later one has replaced is passed over.
    queue: BinaryHeap<Queued>,
    /// How many neighbours were predicted.
    predictions: u64,
    /// How many entries there were, and how many of these since the queue was made anew.
    entries: u64,
    recent: usize,
    /// Sum and number of the fitness of evaluated candidates.
    sum: f64,
    count: f64,
    /// Outside lattices, where nobody knows which points were visited: keys of the points that were proposed or expanded.
    known: BTreeSet<u64>,
    /// The hits, with their fitness.
    hits: Vec<S>,
    hit_fitness: Vec<f64>,
    /// Whether a candidate was forgotten since hits were last entered again, and the next hit that is.
    forgot: bool,
    again: usize,
}

impl<S: Real> NeighboursAtOnce<S> {
    /// Whether there may be a candidate to try.
    pub(super) fn has_more(&self) -> bool {
        self.candidates.len() > 0 || self.forgot || self.again < self.hit_fitness.len()
    }

    /// Whether no more misses are expanded.
    pub(super) fn is_full(&self) -> bool {
        self.predictions >= MOST_PREDICTIONS
    }

    /// The hits with their fitness.
    pub(super) fn hits(&self, dimension: usize) -> impl Iterator<Item = (&[S], f64)> {
        let hits = self.hits.chunks_exact(dimension);
        hits.zip(self.hit_fitness.iter().copied())
    }

    /// Takes note of an evaluated point, whose neighbours become candidates. `visited`: the points of a lattice that were proposed.
    pub(super) fn expand(
        &mut self,
        context: &dyn Context<S>,
        visited: Option<&Visited>,
        position: &[S],
        (fitness, is_hit): (f64, bool),
    ) {
        let key = key(position);
        if let Some(row) = self.candidates.find(key) {
            self.candidates.remove(row);
        }
        if is_hit {
            // It is entered again only if a candidate is forgotten from here on.
            if self.again == self.hit_fitness.len() {
                self.again += 1;
            }
            self.hits.extend_from_slice(position);
            self.hit_fitness.push(fitness);
        }
        if visited.is_none() && (is_hit || self.known.len() < MOST_KNOWN) {
            self.known.insert(key);
        }
        if is_hit || !self.is_full() {
            self.expand_part(context, visited, position, fitness, 0);
        }
    }

    /// Makes candidates of a part of the neighbours of an evaluated point, and enters it if more are left.
    fn expand_part(
        &mut self,
        context: &dyn Context<S>,
        visited: Option<&Visited>,
        position: &[S],
        fitness: f64,
        part: u32,
    ) {
        let size = points_at_once(position.len());
        let start = (part as usize).saturating_mul(size);
        let end = start.saturating_add(size);
        let prior = if self.count > 0.0 {
            self.sum / self.count
        } else {
            fitness
        };
        context.neighbours(position, start..end, &mut |_, neighbour| {
            self.predict(context, visited, neighbour, (fitness, prior));
        });
        if part < u32::MAX && context.neighbour_count(position) > end {
            let row = self.candidates.add(Candidate::rest(fitness, part + 1), position);
            self.enter(row, f64::midpoint(fitness, prior));
        }
        if self.recent >= MOST_ENTRIES || self.candidates.len() >= 2 * MOST {
            self.make_queue_anew();
        }
    }

    /// Predicts the fitness of a neighbour of an evaluated point, unless it was proposed before.
    fn predict(
        &mut self,
        context: &dyn Context<S>,
        visited: Option<&Visited>,
        neighbour: &[S],
        (fitness, prior): (f64, f64),
    ) {
        self.predictions = self.predictions.saturating_add(1);
        let key = key(neighbour);
        let row = if let Some(row) = self.candidates.find(key) {
            row
        } else {
            let is_known = visited.map_or_else(
                || self.known.contains(&key),
                |visited| visited.contains(context.space(), neighbour),
            );
            if is_known {
                return;
            }
            self.candidates.add(Candidate::new(key), neighbour)
        };
        let predicted = self.candidates.get_mut(row).meet(fitness, prior);
        self.enter(row, predicted);
    }

    /// Enters a candidate, in place of its last entry.
    fn enter(&mut self, row: u32, predicted: f64) {
        // Whatever a damaged state says.
        self.entries = self.entries.wrapping_add(1);
        self.recent = self.recent.saturating_add(1);
        self.candidates.get_mut(row).entry = self.entries;
        self.queue.push(Queued {
            unfitness: !ordered(predicted),
            unage: !self.entries,
            row,
        });
    }

    /// Whether no later entry has replaced this one.
    fn is_latest(&self, queued: &Queued) -> bool {
        self.candidates.get(queued.row).entry == !queued.unage
    }

    /// Forgets the entries that others have replaced and, if there are too many, the worst candidates.
    fn make_queue_anew(&mut self) {
        let mut entries = core::mem::take(&mut self.queue).into_vec();
        entries.retain(|queued| self.is_latest(queued));
        if entries.len() >= 2 * MOST {
            // The worst come first.
            let last = entries.len() - MOST - 1;
            entries.select_nth_unstable(last);
            self.forgot = true;
            for forgotten in entries.drain(..=last) {
                self.candidates.remove(forgotten.row);
            }
        }
        self.recent = 0;
        self.queue = entries.into();
    }

    /// Writes the best candidate; `false` when there is none, or none next to the hit that was entered again.
    pub(super) fn propose(
        &mut self,
        context: &dyn Context<S>,
        visited: Option<&Visited>,
        position: &mut [S],
    ) -> bool {
        loop {
            let Some(queued) = self.queue.pop() else {
                // One hit at a time: its neighbours may all be known, and time may be out.
                if self.enter_again(context, visited, position) && !self.queue.is_empty() {
                    continue;
                }
                return false;
            };
            if !self.is_latest(&queued) {
                continue;
            }
            let candidate = *self.candidates.get(queued.row);
            position.copy_from_slice(self.candidates.position(queued.row, position.len()));
            self.candidates.remove(queued.row);
            if candidate.part > 0 {
                self.expand_part(context, visited, position, candidate.sum, candidate.part);
                continue;
            }
            if visited.is_none() && self.known.len() < MOST_KNOWN {
                self.known.insert(candidate.key);
            }
            return true;
        }
    }

    /// Enters the neighbours of the next hit once more, if candidates were forgotten; `false` when all were.
    fn enter_again(
        &mut self,
        context: &dyn Context<S>,
        visited: Option<&Visited>,
        position: &mut [S],
    ) -> bool {
        if self.again >= self.hit_fitness.len() && core::mem::take(&mut self.forgot) {
            self.again = 0;
        }
        let Some(&fitness) = self.hit_fitness.get(self.again) else {
            return false;
        };
        let start = self.again * position.len();
        position.copy_from_slice(&self.hits[start..start + position.len()]);
        self.again += 1;
        self.expand_part(context, visited, position, fitness, 0);
        true
    }

    /// Counts a candidate and its fitness.
    pub(super) fn count(&mut self, fitness: S) {
        if fitness.is_finite() {
            self.sum += fitness.f64();
            self.count += 1.0;
        }
    }

    pub(super) fn save(&self, state: &mut State, dimension: usize) {
        let mut entries: Vec<Queued> = self.queue.iter().copied().collect();
        entries.retain(|queued| self.is_latest(queued));
        entries.sort_unstable();
        let candidates: Vec<Candidate> = entries
            .iter()
            .map(|queued| *self.candidates.get(queued.row))
            .collect();
        let position = |queued: &Queued| self.candidates.position(queued.row, dimension);
        let positions: Vec<S> = entries.iter().flat_map(position).copied().collect();
        let unfitness: Vec<u64> = entries.iter().map(|queued| queued.unfitness).collect();
        Saved::save(&(candidates, unfitness), state);
        write_rows(state, &positions, dimension);
        Saved::save(&(self.predictions, self.entries, self.recent), state);
        Saved::save(&(self.sum, self.count, self.forgot, self.again), state);
        Saved::save(&self.known, state);
        write_rows(state, &self.hits, dimension);
        write_rows(state, &self.hit_fitness, 1);
    }

    pub(super) fn restore(from: &mut Reader<'_>) -> Result<Self, Error> {
        let (candidates, unfitness): (Vec<Candidate>, Vec<u64>) = from.read()?;
        let positions: Vec<S> = read_rows(from)?;
        let (predictions, entries, recent) = from.read()?;
        let (sum, count, forgot, again) = from.read()?;
        let mut restored = Self {
            predictions,
            entries,
            recent,
            sum,
            count,
            forgot,
            again,
            known: from.read()?,
            hits: read_rows(from)?,
            hit_fitness: read_rows(from)?,
            ..Self::default()
        };
        let dimension = (positions.len() / candidates.len().max(1)).max(1);
        let rows = candidates.into_iter().zip(positions.chunks_exact(dimension));
        for ((candidate, position), unfitness) in rows.zip(unfitness) {
            let key = key(position);
            let row = restored.candidates.add(Candidate { key, ..candidate }, position);
            restored.queue.push(Queued {
                unfitness,
                unage: !candidate.entry,
                row,
            });
        }
        Ok(restored)
    }

    /// Whether restored parts fit each other and the space.
    pub(super) fn fit(&self, dimension: usize) -> bool {
        let hits = self.hit_fitness.len().checked_mul(dimension);
        self.candidates.fit(dimension) && hits == Some(self.hits.len())
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::super::rooks::{SIDE, rooks};
    use super::*;
    use crate::SearchRng;

    fn expand(all: &mut NeighboursAtOnce<f64>, position: [f64; 2], fitness: f64, is_hit: bool) {
        all.expand(&rooks(), None, &position, (fitness, is_hit));
    }

    fn propose(all: &mut NeighboursAtOnce<f64>) -> Option<[f64; 2]> {
        let mut position = [0.0; 2];
        all.propose(&rooks(), None, &mut position).then_some(position)
    }

    /// Proposes a point, evaluates it or not, counts it or not; now and then a point of others.
    fn step(all: &mut NeighboursAtOnce<f64>, rng: &mut SearchRng) -> Option<[f64; 2]> {
        let own = propose(all);
        let position = own
            .filter(|_| rng.random_bool(0.9))
            .unwrap_or_else(|| [0, 1].map(|_| f64::from(rng.random_range(0..SIDE as u32))));
        let fitness = ((7.0 * position[0]).sin() * (3.0 * position[1]).cos() * 100.0).round() / 100.0;
        if rng.random_bool(0.8) {
            expand(all, position, fitness, fitness < -0.9);
        }
        if rng.random_bool(0.8) {
            all.count(fitness);
        }
        own
    }

    fn saved(all: &NeighboursAtOnce<f64>) -> State {
        let mut state = State::default();
        all.save(&mut state, 2);
        state
    }

    #[test]
    fn what_is_restored_goes_on_as_it_would_have() {
        let mut all = NeighboursAtOnce::default();
        let mut rng = SearchRng::new(8);
        for steps in [3, 60, 200] {
            for _ in 0..steps {
                step(&mut all, &mut rng);
            }
            let state = saved(&all);
            let mut again = NeighboursAtOnce::restore(&mut Reader::new(&state)).unwrap();
            assert!(again.fit(2) && saved(&again) == state);
            let (mut one, mut other) = (rng.clone(), rng.clone());
            for i in 0..60 {
                assert_eq!(step(&mut all, &mut one), step(&mut again, &mut other), "{i}");
            }
        }
        assert!(all.forgot, "not all have room");
    }

    #[test]
    fn few_candidates_are_kept_and_their_checkpoint_is_small() {
        let mut all = NeighboursAtOnce::default();
        let mut rng = SearchRng::new(3);
        let mut most = 0;
        for _ in 0..2000 {
            step(&mut all, &mut rng);
            most = most.max(all.candidates.len());
        }
        assert!((MOST..=2 * MOST + 2 * SIDE).contains(&most), "{most}");
        assert!(all.queue.len() <= most + MOST_ENTRIES + 2 * SIDE);
        let size = saved(&all).0.len();
        assert!(size < 400_000, "{size}");
    }

    #[test]
    fn what_was_forgotten_next_to_a_hit_comes_last() {
        let mut all = NeighboursAtOnce::default();
        let is_next = |x: &[f64; 2]| (x[0] == 3.0) != (x[1] == 5.0);
        expand(&mut all, [3.0, 5.0], 9.0, true);
        for i in 20..60 {
            expand(&mut all, [f64::from(i); 2], 1.0, false);
        }
        assert!(all.forgot && all.candidates.len() >= MOST);
        let mut seen = Vec::new();
        while let Some(position) = propose(&mut all) {
            seen.push(position);
            all.count(1.0);
        }
        assert!(!all.has_more());
        let next = seen.iter().filter(|x| is_next(x)).count();
        assert_eq!(next, 398, "each once");
        assert!(seen[..MOST - 398].iter().all(|x| !is_next(x)));
        assert!(seen.len() > 2 * MOST);
    }
}

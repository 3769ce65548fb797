//! Neighbours that become candidates when it is their turn.

use core::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

use super::candidates::key;
use crate::context::{Context, points_at_once};
use crate::error::Error;
use crate::scalar::{Real, ordered};
use crate::state::{Reader, Saved, State, read_rows, write_rows};

/// All hits wait. Of the points that miss the best ones do: so many, and up to as many again (or as there are hits that wait, if these are
/// more) before the list is cut. With more, neighbours of ever worse points come before anything else is tried.
const MOST: usize = 1 << 4;

/// Outside lattices, so many points are known not to be expanded twice; then only hits are expanded.
const MOST_KNOWN: usize = 1 << 20;

/// An evaluated point whose neighbours are to be proposed, least F first, then the earliest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
struct Waiting {
    /// As ordered bits.
    fitness: u64,
    age: u64,
    /// The [part](points_at_once) of its neighbours that is next.
    part: u32,
    row: u32,
}

/// The graph that the problem's neighbours span, explored from the hits: all neighbours of the point with the least F, then those of the
/// next one. Whoever proposes them passes over points that are visited.
///
/// Where evaluations are cheap that finds more in the same time than [to predict each neighbour](super::at_once): it takes a fraction of the
/// time, and less in each evaluation.
#[derive(Debug, Default)]
pub(super) struct LateNeighbours<S> {
    queue: BinaryHeap<Reverse<Waiting>>,
    /// How many have been entered, and how many misses since the worst were forgotten.
    entries: u64,
    misses: usize,
    /// The points that wait, each in its row, and the rows that are free.
    rows: Vec<S>,
    free: Vec<u32>,
    /// The neighbours that are proposed next, and how many of these coordinates were.
    listed: Vec<S>,
    proposed: usize,
    /// Outside lattices, where nobody knows which points were visited: keys of the points that were entered.
    known: BTreeSet<u64>,
}

impl<S: Real> LateNeighbours<S> {
    pub(super) fn has_more(&self) -> bool {
        self.proposed < self.listed.len() || !self.queue.is_empty()
    }

    /// Enters an evaluated point.
    pub(super) fn expand(&mut self, context: &dyn Context<S>, position: &[S], fitness: f64, is_hit: bool) {
        if !context.space().is_discrete() {
            let room = is_hit || self.known.len() < MOST_KNOWN;
            if !room || !self.known.insert(key(position)) {
                return;
            }
        }
        let dimension = position.len();
        let row = if let Some(row) = self.free.pop() {
            let place = row as usize * dimension;
            self.rows[place..place + dimension].copy_from_slice(position);
            row
        } else {
            let Ok(row) = u32::try_from(self.rows.len() / dimension.max(1)) else {
                return;
            };
            self.rows.extend_from_slice(position);
            row
        };
        self.entries += 1;
        self.queue.push(Reverse(Waiting {
            fitness: ordered(fitness),
            age: self.entries,
            part: 0,
            row,
        }));
        self.misses += usize::from(!is_hit);
        if self.misses >= MOST.max(self.queue.len() / 2) {
            self.misses = 0;
            self.forget_worst(ordered(context.threshold().f64()));
        }
    }

    /// Forgets the worst misses beyond [`MOST`]. Cost: O(n) for n points that wait, at most once for n/2 misses that are entered.
    fn forget_worst(&mut self, threshold: u64) {
        let mut waiting = core::mem::take(&mut self.queue).into_vec();
        let misses = waiting
            .iter()
            .filter(|point| point.0.fitness >= threshold)
            .count();
        if let Some(last) = misses.checked_sub(MOST + 1) {
            // The worst come first.
            waiting.select_nth_unstable(last);
            let forgotten = waiting.drain(..=last);
            self.free.extend(forgotten.map(|Reverse(point)| point.row));
        }
        self.queue = waiting.into();
    }

    /// Writes the next neighbour; `false` when there is none.
    pub(super) fn propose(&mut self, context: &dyn Context<S>, position: &mut [S]) -> bool {
        let dimension = position.len();
        while self.proposed >= self.listed.len() {
            let Some(Reverse(point)) = self.queue.pop() else {
                return false;
            };
            let Waiting { part, row, .. } = point;
            let place = row as usize * dimension;
            let of = &self.rows[place..place + dimension];
            let size = points_at_once(dimension);
            let start = (part as usize).saturating_mul(size);
            let end = start.saturating_add(size);
            let listed = &mut self.listed;
            listed.clear();
            self.proposed = 0;
            context.neighbours(of, start..end, &mut |_, neighbour| {
                listed.extend_from_slice(neighbour);
            });
            if part < u32::MAX && context.neighbour_count(of) > end {
                let part = part + 1;
                self.queue.push(Reverse(Waiting { part, ..point }));
            } else {
                self.free.push(row);
            }
        }
        position.copy_from_slice(&self.listed[self.proposed..self.proposed + dimension]);
        self.proposed += dimension;
        true
    }

    pub(super) fn save(&self, state: &mut State, dimension: usize) {
        let mut waiting: Vec<Waiting> = self.queue.iter().map(|&Reverse(point)| point).collect();
        waiting.sort_unstable();
        let row = |point: &Waiting| {
            let place = point.row as usize * dimension;
            &self.rows[place..place + dimension]
        };
        let rows: Vec<S> = waiting.iter().flat_map(row).copied().collect();
        for (point, row) in waiting.iter_mut().zip(0..) {
            point.row = row;
        }
        Saved::save(&waiting, state);
        Saved::save(&(self.entries, self.misses), state);
        write_rows(state, &rows, dimension);
        write_rows(state, &self.listed[self.proposed..], dimension);
        Saved::save(&self.known, state);
    }

    pub(super) fn restore(from: &mut Reader<'_>) -> Result<Self, Error> {
        let waiting: Vec<Waiting> = from.read()?;
        // Whatever a damaged state says.
        let renumbered = waiting.into_iter().zip(0..);
        let renumbered = renumbered.map(|(point, row)| Reverse(Waiting { row, ..point }));
        let queue = renumbered.collect();
        let (entries, misses) = from.read()?;
        Ok(Self {
            queue,
            entries,
            misses,
            rows: read_rows(from)?,
            free: Vec::new(),
            listed: read_rows(from)?,
            proposed: 0,
            known: from.read()?,
        })
    }

    /// Whether restored parts fit each other and the space.
    pub(super) fn fit(&self, dimension: usize) -> bool {
        let waiting = self.queue.len().checked_mul(dimension);
        waiting == Some(self.rows.len()) && self.listed.len().is_multiple_of(dimension.max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::super::rooks::{Rooks, rooks};
    use super::*;
    use crate::SearchRng;

    /// Proposes so many points and enters every other one as a miss.
    fn steps(late: &mut LateNeighbours<f64>, context: &Rooks, count: usize) -> Vec<[f64; 2]> {
        let mut position = [0.0; 2];
        let step = |i: usize| {
            assert!(late.propose(context, &mut position));
            if i.is_multiple_of(2) {
                let fitness = (7.0 * position[0]).sin() * (3.0 * position[1]).cos() + 2.0;
                late.expand(context, &position, fitness, false);
            }
            position
        };
        (0..count).map(step).collect()
    }

    #[test]
    fn all_neighbours_of_the_best_point_come_before_those_of_the_next() {
        let context = rooks();
        let mut late = LateNeighbours::default();
        for (position, fitness) in [([3.0, 5.0], 2.0), ([7.0, 9.0], 1.0), ([8.0, 2.0], 2.0)] {
            late.expand(&context, &position, fitness, false);
        }
        let mut position = [0.0; 2];
        let mut seen = Vec::new();
        while late.propose(&context, &mut position) {
            seen.push(position);
        }
        assert!(!late.has_more());
        // All but itself, in each of both directions: more than are listed at once.
        assert_eq!(seen.len(), 3 * 398);
        for (centre, part) in [[7.0, 9.0], [3.0, 5.0], [8.0, 2.0]].iter().zip(seen.chunks(398)) {
            assert!(
                part.iter().all(|x| (x[0] == centre[0]) != (x[1] == centre[1])),
                "{centre:?}"
            );
        }
        assert_eq!(late.rows.len(), 6, "rows are used again");
    }

    #[test]
    fn a_restored_list_goes_on_as_it_would_have() {
        let context = rooks();
        let mut late = LateNeighbours::default();
        late.expand(&context, &[3.0, 5.0], 0.5, true);
        steps(&mut late, &context, 1111);
        let mut state = State::default();
        late.save(&mut state, 2);
        let mut again = LateNeighbours::restore(&mut Reader::new(&state)).unwrap();
        assert!(again.fit(2) && !again.fit(3));
        assert_eq!(steps(&mut late, &context, 999), steps(&mut again, &context, 999));
        let save = |late: &LateNeighbours<f64>| {
            let mut state = State::default();
            late.save(&mut state, 2);
            state
        };
        assert!(save(&late) == save(&again));
    }

    #[test]
    fn where_no_point_is_remembered_none_is_expanded_twice() {
        let mut context = rooks();
        let mut late = LateNeighbours::default();
        let mut position = [0.0; 2];
        let mut count = |context: &Rooks| {
            for fitness in [1.0, 2.0] {
                late.expand(context, &[3.0, 5.0], fitness, false);
            }
            core::iter::from_fn(|| late.propose(context, &mut position).then_some(())).count()
        };
        assert_eq!([count(&context), count(&context)], [2 * 398, 2 * 398]);
        context.space = crate::Space::new([crate::Axis::continuous(0.0, 200.0); 2]).unwrap();
        assert_eq!([count(&context), count(&context)], [398, 0]);
    }

    #[test]
    fn the_worst_misses_are_forgotten_and_no_hit_is() {
        let context = rooks();
        let mut late = LateNeighbours::default();
        let mut rng = SearchRng::new(1);
        let mut misses: Vec<f64> = (0..3 * MOST).map(|_| 1.0 + rng.uniform()).collect();
        for (i, &miss) in misses.iter().enumerate() {
            late.expand(&context, &[1.0, 2.0], miss, false);
            if i % 3 == 0 {
                late.expand(&context, &[1.0, 2.0], -miss, true);
            }
        }
        // A third of them hits.
        assert!(late.queue.len() <= 4 * MOST && late.rows.len() <= 2 * (4 * MOST + 1));
        misses.sort_by(f64::total_cmp);
        let kept: Vec<u64> = late
            .queue
            .into_sorted_vec()
            .iter()
            .rev()
            .map(|point| point.0.fitness)
            .collect();
        let hits = kept.partition_point(|&fitness| fitness < ordered(0.0));
        assert_eq!(hits, MOST);
        let best: Vec<u64> = misses.iter().map(|&miss| ordered(miss)).collect();
        assert_eq!(kept[hits..hits + MOST / 2], best[..MOST / 2]);
    }
}

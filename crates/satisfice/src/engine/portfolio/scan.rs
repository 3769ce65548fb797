//! The enumeration of a lattice that the budget has room for.

use super::visited::Visited;
use crate::context::Context;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::Space;

/// Lattices of at most this many points are enumerated from the start.
const SMALL: u64 = 4096;

/// The pace of fewer evaluations says little: the first ones may take a hundred times as long.
const PACED: u64 = 256;

/// A search is stale when it has gone without a new hit for as long as an enumeration takes to meet this many, by the hits known:
/// a search that still finds has such pauses, too.
const PATIENCE: u64 = 16;

/// Goes through all points of a lattice once, in its order, from a random point on, so that the lanes of a search begin at
/// different ones.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Scan {
    /// Number of points; 0 where there is no lattice, or none that can be counted.
    points: u64,
    /// The point that comes next, and how many have been passed; none are before the first is drawn.
    next: u64,
    passed: u64,
    started: bool,
    /// Hits known, and the evaluation at which the last of them was new.
    hits: usize,
    latest: u64,
    /// Whether nothing but this enumeration goes on.
    alone: bool,
}

impl Scan {
    pub(super) fn new<S: Real>(space: &Space<S>) -> Self {
        let lattice = space.axes().iter().all(crate::Axis::is_integer);
        let count = space.cardinality().filter(|&count| lattice && count < 9e15);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number below 2^53"
        )]
        Self {
            points: count.map_or(0, |count| count as u64),
            ..Self::default()
        }
    }

    /// Whether every point has been passed.
    pub(super) fn is_over(&self) -> bool {
        self.points > 0 && self.passed == self.points
    }

    /// Whether the rest of the lattice is to be enumerated now, with nothing beside. It has to fit into what the budget has left, of
    /// which `reserve` is the share that is not the engine's; under a limit of time alone, at the pace so far, less what the sources' thinking
    /// took: an evaluation with it has cost as much as `mean_cost` without. And it has to be due:
    /// the lattice is small, or mostly visited, or soon it would no longer fit, or the search finds no more than it would.
    pub(super) fn goes_alone<S: Real>(
        &mut self,
        context: &dyn Context<S>,
        visited: &Visited,
        reserve: f64,
        batch: usize,
        mean_cost: f64,
    ) -> bool {
        if self.alone || self.points == 0 {
            return self.alone;
        }
        // A point that was visited is passed without an evaluation, as long as it is remembered.
        let rest = visited
            .unvisited()
            .unwrap_or(self.points)
            .min(self.points - self.passed) as f64;
        let (made, used) = (context.evaluations(), context.elapsed_share());
        let due = self.points <= SMALL || visited.is_dense() || self.search_is_stale(made, context.hits());
        self.alone = if let Some(planned) = context.evaluations_planned() {
            let room = planned as f64 * (1.0 - reserve) - 1.0;
            rest <= room && (due || rest + 2.0 * batch as f64 > room)
        } else if used > 0.0 {
            let (takes, left) = (rest * used / mean_cost, (1.0 - used) * made as f64);
            takes <= left && (due || (made >= PACED && takes > left / 2.0))
        } else {
            self.points <= SMALL
        };
        self.alone
    }

    /// Whether an enumeration promises as much as the search now does: by what it last found, or because half of the points are
    /// visited anyway.
    fn search_is_stale(&mut self, made: u64, hits: usize) -> bool {
        if hits > self.hits {
            (self.hits, self.latest) = (hits, made);
        }
        let wait = self.points / (hits as u64 + 1) * PATIENCE;
        made.saturating_sub(self.latest) > wait || made > self.points / 2
    }

    /// Writes the next point that is not remembered as visited; `false` at the end.
    pub(super) fn next<S: Real>(
        &mut self,
        space: &Space<S>,
        visited: &Visited,
        rng: &mut SearchRng,
        position: &mut [S],
    ) -> bool {
        if !self.started {
            self.started = true;
            let points = usize::try_from(self.points).unwrap_or(usize::MAX);
            self.next = rng.below(points) as u64;
        }
        while self.passed < self.points {
            Visited::point(space, self.next, position);
            self.next = (self.next + 1) % self.points;
            self.passed += 1;
            if !visited.contains(space, position) {
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
    fn every_point_comes_once_but_those_visited_before() {
        let space = Space::<f64>::lattice(2, 30).unwrap();
        for seed in 0..5 {
            let (mut scan, mut rng) = (Scan::new(&space), SearchRng::new(seed));
            let (mut visited, mut position) = (Visited::new(&space), [0.0; 2]);
            for _ in 0..300 {
                rng.position(&space, &mut position);
                visited.insert(&space, &position);
            }
            let left = visited.unvisited().unwrap();
            let mut passed = 0;
            while scan.next(&space, &visited, &mut rng, &mut position) {
                assert!(visited.insert(&space, &position), "{position:?} came before");
                passed += 1;
            }
            assert!(scan.is_over() && visited.is_all() && passed == left);
        }
    }

    #[test]
    fn nothing_is_scanned_where_points_cannot_be_counted() {
        for space in [
            Space::<f64>::cube(2, 0.0, 1.0).unwrap(),
            Space::lattice(12, 10_000).unwrap(),
        ] {
            assert!(Scan::new(&space).points == 0 && !Scan::new(&space).is_over());
        }
    }
}

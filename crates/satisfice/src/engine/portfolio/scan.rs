//! The enumeration of a lattice that the budget has room for.

use super::credit::Credit;
use super::visited::Visited;
use crate::batch::Outcome;
use crate::context::Context;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::Space;

/// Lattices of at most this many points are enumerated from the start.
const SMALL: u64 = 4096;

/// Where time alone is limited, this share of what the search costs goes into samples of the enumeration, to know what it finds.
const SAMPLED: f64 = 0.1;
/// The enumeration is better than the search if it is with so many standard deviations fewer hits than were found.
const CERTAIN: f64 = 2.0;

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
    /// Whether the batch that is out is a sample; points of all samples, and new hits among them.
    samples: bool,
    sampled: u64,
    found: u64,
}

impl Scan {
    pub(super) fn new<S: Real>(space: &Space<S>) -> Self {
        let count = space.cardinality();
        let count = count.filter(|&count| space.is_discrete() && count < 9e15);
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

    /// Whether points of the lattice are to be enumerated now: all of the rest, with nothing beside from now on, or a sample.
    ///
    /// An enumeration has to fit into the budget that is left, less its probes and the `awaited` points that are proposed and not answered; under
    /// a limit of time alone, at the pace of bare evaluations so far. And it has to be due. It is where the lattice is small, half visited, or
    /// the search has gone stale; under a limit of evaluations, also when it would not fit any more later; under one of time, where samples of
    /// it have found more hits for their cost than the search lately.
    pub(super) fn goes_on<S: Real>(
        &mut self,
        context: &dyn Context<S>,
        visited: &Visited,
        awaited: usize,
        batch: usize,
        all: &Credit,
    ) -> bool {
        self.samples = false;
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
            let room = room(planned, context.probe_share(), awaited);
            rest <= room && (due || rest + 2.0 * batch as f64 > room)
        } else if used > 0.0 {
            let (takes, left) = (rest * used / all.mean_cost(), (1.0 - used) * made as f64);
            takes <= left && (due || self.is_better_by_samples(batch, all))
        } else {
            self.points <= SMALL
        };
        self.samples &= !self.alone;
        self.alone || self.samples
    }

    /// Whether the samples have surely found more hits for their cost than the search lately; if not, it may be time for the next sample. The
    /// first one waits until the search has had its share, too: where hits are easy to go on from, it only needs a few.
    fn is_better_by_samples(&mut self, batch: usize, all: &Credit) -> bool {
        self.samples = (self.sampled + batch as u64) as f64 <= SAMPLED * all.cost();
        let found = self.found as f64;
        (found - CERTAIN * found.sqrt()) * all.price() > self.sampled as f64
    }

    /// Whether the batch that is out is a sample.
    pub(super) fn is_sample(&self) -> bool {
        self.samples
    }

    /// Learns what became of a sample, or of a part of one.
    pub(super) fn learn<S: Real>(&mut self, outcomes: &[Outcome<S>]) {
        self.sampled += outcomes.len() as u64;
        self.found += outcomes.iter().filter(|outcome| outcome.is_hit()).count() as u64;
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

/// For how many more points a budget has room, of which some are probes and some are awaited.
fn room(planned: u64, probes: f64, awaited: usize) -> f64 {
    let ours = match probes > 0.0 {
        true => planned as f64 * (1.0 - probes) - 1.0,
        false => planned as f64,
    };
    ours - awaited as f64
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
    fn probes_and_points_that_are_out_leave_less_room() {
        assert_eq!(room(1000, 0.25, 32), 717.0);
        assert_eq!(room(1000, 0.0, 32), 968.0);
    }

    #[test]
    fn samples_tell_whether_an_enumeration_finds_more_than_the_search() {
        let space = Space::<f64>::lattice(2, 1000).unwrap();
        let outcome = |hit: bool| {
            if hit {
                Outcome::Hit(0.0)
            } else {
                Outcome::Miss(1.0)
            }
        };
        // The search hits every `price` evaluations, the enumeration every 100.
        for (price, expected) in [(10, false), (1000, true)] {
            let (mut scan, mut all) = (Scan::new(&space), Credit::default());
            let mut alone = false;
            for n in 0..100_000 {
                all.count(n % price == 0, 1.0);
                alone |= scan.is_better_by_samples(100, &all);
                if scan.samples && !alone {
                    let sample: Vec<_> = (0..100).map(|i| outcome(i == 50)).collect();
                    sample.iter().for_each(|outcome| all.count(outcome.is_hit(), 1.0));
                    scan.learn(&sample);
                }
            }
            assert_eq!(alone, expected, "{scan:?}");
            let most = SAMPLED * all.cost() + 100.0;
            assert!((1.0..most).contains(&(scan.sampled as f64)), "{scan:?}");
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

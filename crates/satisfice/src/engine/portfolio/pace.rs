//! What a candidate of each source costs, its own thinking included, where time alone is scarce.

use crate::clock::{PASSES, Stopwatch};

/// So many turns of a source are all measured, then one of `SELDOM`: a look at the clock takes time, too.
const FIRST: u32 = 16;
const SELDOM: u32 = 8;
/// The weight of a new measurement is at least one in so many.
const MEMORY: u32 = 16;
/// A measurement counts for at most so many times what was expected: the machine had something else to do.
const MOST: f64 = 8.0;

/// A mean of the latest measurements, in nanoseconds.
#[derive(Debug, Clone, Copy, Default)]
struct Lately {
    mean: f64,
    turns: u32,
}

impl Lately {
    /// Whether this turn is to be measured.
    fn is_due(&mut self) -> bool {
        self.turns = self.turns.saturating_add(1);
        // The first turn prepares the others.
        (2..=FIRST).contains(&self.turns) || self.turns.is_multiple_of(SELDOM)
    }

    fn add(&mut self, nanoseconds: f64) {
        if self.mean == 0.0 {
            self.mean = nanoseconds;
        } else {
            let weight = 1.0 / f64::from(self.turns.clamp(1, MEMORY));
            self.mean += weight * (nanoseconds.min(MOST * self.mean) - self.mean);
        }
    }
}

/// The time that sources take, by their place among the names of all.
#[derive(Debug)]
pub(super) struct Pace<const SOURCES: usize> {
    timed: bool,
    /// Of a proposal.
    proposals: [Lately; SOURCES],
    /// Of what a source learns from a candidate.
    lessons: [Lately; SOURCES],
    /// Of the evaluation of a candidate and of what is done with every candidate.
    common: Lately,
    away: Option<Stopwatch>,
    /// What thinking costs in evaluations, by the measurements above.
    costs: [f64; SOURCES],
}

impl<const SOURCES: usize> Pace<SOURCES> {
    /// `timed`: whether time alone is limited.
    pub(super) fn new(timed: bool) -> Self {
        Self {
            timed: timed && PASSES,
            proposals: [Lately::default(); SOURCES],
            lessons: [Lately::default(); SOURCES],
            common: Lately::default(),
            away: None,
            costs: [0.0; SOURCES],
        }
    }

    pub(super) fn is_timed(&self) -> bool {
        self.timed
    }

    /// Begins a turn of a source; the stopwatch, if it is measured.
    pub(super) fn proposes(&mut self, source: usize) -> Option<Stopwatch> {
        (self.timed && self.proposals[source].is_due()).then(Stopwatch::start)
    }

    /// The end of a turn with so many proposals.
    pub(super) fn proposed(&mut self, source: usize, watch: Option<Stopwatch>, proposals: u64) {
        if let Some(watch) = watch {
            self.proposals[source].add(watch.stop() as f64 / proposals.max(1) as f64);
            self.weigh(source);
        }
    }

    pub(super) fn learns(&mut self, source: usize) -> Option<Stopwatch> {
        (self.timed && self.lessons[source].is_due()).then(Stopwatch::start)
    }

    pub(super) fn learned(&mut self, source: usize, watch: Option<Stopwatch>, candidates: usize) {
        if let Some(watch) = watch {
            self.lessons[source].add(watch.stop() as f64 / candidates.max(1) as f64);
            self.weigh(source);
        }
    }

    /// Sends a batch to be evaluated.
    pub(super) fn sends(&mut self) {
        self.away = (self.timed && self.common.is_due()).then(Stopwatch::start);
    }

    /// A batch is back.
    pub(super) fn receives(&mut self, candidates: usize) {
        if let Some(watch) = self.away.take() {
            self.common.add(watch.stop() as f64 / candidates.max(1) as f64);
        }
    }

    fn weigh(&mut self, source: usize) {
        let own = self.proposals[source].mean + self.lessons[source].mean;
        if self.common.mean > 0.0 {
            self.costs[source] = own / self.common.mean;
        }
    }

    /// Evaluations that could be made in the time of one from this source, if no source took time to think: 1 where time is not scarce.
    #[inline]
    pub(super) fn cost(&self, source: usize) -> f64 {
        1.0 + self.costs[source]
    }

    /// The same without the evaluation, for what was worked out but not proposed: 1 where time is not scarce.
    pub(super) fn idle_cost(&self, source: usize) -> f64 {
        if self.timed { self.costs[source] } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_clock_everything_costs_an_evaluation() {
        let mut pace = Pace::<2>::new(false);
        assert!(pace.proposes(0).is_none() && pace.learns(0).is_none());
        pace.sends();
        pace.receives(10);
        assert_eq!([pace.cost(0), pace.idle_cost(1)], [1.0, 1.0]);
    }

    #[test]
    fn thinking_costs_what_it_takes() {
        let mut pace = Pace::<2>::new(true);
        pace.common.add(100.0);
        pace.proposals[1].add(250.0);
        pace.lessons[1].add(50.0);
        pace.weigh(1);
        assert_eq!([pace.cost(0), pace.cost(1), pace.idle_cost(1)], [1.0, 4.0, 3.0]);
    }

    #[test]
    fn an_interruption_hardly_counts() {
        let mut lately = Lately::default();
        let due = (0..1000).filter(|_| lately.is_due()).count();
        assert_eq!(due, 15 + 123);
        lately.add(100.0);
        lately.add(1e9);
        assert!(lately.mean < 150.0, "{lately:?}");
    }
}

//! When to stop: time, evaluations, hits, patience, cancellation, in any combination.

use core::time::Duration;

use crate::error::Error;

pub use crate::cancel::Cancel;

/// The limits of a time slice. The first limit reached ends it.
///
/// ```
/// use satisfice::Budget;
/// use std::time::Duration;
/// let budget = Budget::time(Duration::from_millis(100)).and_evaluations(1_000_000).and_hits(10);
/// # let _ = budget;
/// ```
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub struct Budget {
    /// Wall time, from the start of the slice.
    pub time: Option<Duration>,
    /// Evaluations: candidates that reach the accounting, deleted ones included, and bounds that the problem gave.
    pub evaluations: Option<u64>,
    /// Distinct hits.
    pub hits: Option<u64>,
    /// Evaluations in succession without a new hit.
    #[serde(default)]
    pub patience: Option<u64>,
    /// Evaluations to which schedules relate, if not the budget itself.
    pub horizon: Option<u64>,
    /// How many evaluations can go on at once, where that is known.
    #[serde(default)]
    pub parallel: Option<usize>,
    /// A flag that cancels the slice.
    #[serde(skip)]
    pub cancel: Option<Cancel>,
}

impl Budget {
    /// The most evaluations at once.
    pub const MOST_PARALLEL: usize = 65_536;

    /// A budget of wall time.
    #[must_use]
    pub fn time(time: Duration) -> Self {
        Self {
            time: Some(time),
            ..Self::default()
        }
    }
    /// A budget of wall time in milliseconds.
    ///
    /// ```
    /// assert_eq!(satisfice::Budget::millis(100).time, Some(std::time::Duration::from_millis(100)));
    /// ```
    #[must_use]
    pub fn millis(milliseconds: u64) -> Self {
        Self::time(Duration::from_millis(milliseconds))
    }
    /// A budget of evaluations: reproducible.
    ///
    /// Evaluations are then taken to be expensive. The default engine may think for about a millisecond on each of the first 1,000, whatever F
    /// costs: a search of 1,000 to 10,000 evaluations of a cheap F of two coordinates takes about half a second, a longer one, which is planned without a model of
    /// F, a few microseconds an evaluation. If time matters as well, [limit it](Budget::and_time), too ([`Portfolio`](crate::engine::Portfolio)).
    #[must_use]
    pub fn evaluations(evaluations: u64) -> Self {
        Self {
            evaluations: Some(evaluations),
            ..Self::default()
        }
    }
    /// A budget of hits. Alone it may never end: add another limit unless the number of hits is known.
    #[must_use]
    pub fn hits(hits: u64) -> Self {
        Self {
            hits: Some(hits),
            ..Self::default()
        }
    }
    /// A budget that ends when the flag is raised.
    #[must_use]
    pub fn until(cancel: &Cancel) -> Self {
        Self {
            cancel: Some(cancel.clone()),
            ..Self::default()
        }
    }
    /// Also limits wall time.
    #[must_use]
    pub fn and_time(mut self, time: Duration) -> Self {
        self.time = Some(time);
        self
    }
    /// Also limits evaluations.
    #[must_use]
    pub fn and_evaluations(mut self, evaluations: u64) -> Self {
        self.evaluations = Some(evaluations);
        self
    }
    /// Also limits hits.
    #[must_use]
    pub fn and_hits(mut self, hits: u64) -> Self {
        self.hits = Some(hits);
        self
    }
    /// Also ends after so many evaluations in succession without a new hit, those before the first hit included.
    ///
    /// Deleted candidates count as evaluations. The slice up to there is the same as without this limit. Several
    /// [islands](crate::Search::islands) count all their evaluations, and end when they exchange their hits.
    ///
    /// ```
    /// use satisfice::{from_fn, Budget, Search, Space, StopReason};
    ///
    /// let disc = from_fn(Space::lattice(2, 1000)?, 2.5, |x: &[f64]| (x[0] - 500.0).hypot(x[1] - 200.0));
    /// let report = Search::named("descent-flood")?.run(&disc, &Budget::millis(10_000).and_patience(5_000))?;
    /// assert_eq!((report.hit_count(), report.stop_reason), (21, StopReason::Patience));
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    #[must_use]
    pub fn and_patience(mut self, evaluations: u64) -> Self {
        self.patience = Some(evaluations);
        self
    }
    /// Also ends when the flag is raised.
    #[must_use]
    pub fn and_until(mut self, cancel: &Cancel) -> Self {
        self.cancel = Some(cancel.clone());
        self
    }
    /// Relates schedules to this many evaluations instead of the budget, so that a short run is a prefix of a long one.
    #[must_use]
    pub fn with_horizon(mut self, evaluations: u64) -> Self {
        self.horizon = Some(evaluations);
        self
    }

    /// Says how many evaluations can go on at once: the number of workers or threads, 1 by default.
    ///
    /// From 1 to [`Budget::MOST_PARALLEL`]. The default engine and `surrogate` as a rule propose at least so many points at a time, so
    /// that no worker waits; a walk, a descent or a swarm has batches of its own, which
    /// [`Search::in_full_batches`](crate::Search::in_full_batches) shows. The number is part of the search, like a seed: reports
    /// depend on it, and not on how many threads or workers there really are.
    ///
    /// ```
    /// use satisfice::{from_fn, Budget, Search, Space};
    ///
    /// // 400 simulations, eight at a time.
    /// let ring = from_fn(Space::cube(2, -2.0, 2.0)?, 0.05, |x: &[f64]| (x[0].hypot(x[1]) - 1.0).abs());
    /// let mut search = Search::new();
    /// let mut slice = search.start(&ring, &Budget::evaluations(400).with_parallel(8))?;
    /// assert!(slice.ask()?.len() >= 8);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    #[must_use]
    pub fn with_parallel(mut self, evaluations: usize) -> Self {
        self.parallel = Some(evaluations);
        self
    }

    /// # Errors
    /// [`Error::Budget`] if nothing limits the slice, or if a limit is zero.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let counts = [self.evaluations, self.hits, self.patience];
        if self.time.is_none() && counts.iter().all(Option::is_none) && self.cancel.is_none() {
            return Err(Error::Budget(
                "nothing limits it: give a time, a number of evaluations or of hits, or a patience",
            ));
        }
        if self.time.is_some() && !crate::clock::PASSES {
            return Err(Error::Budget(
                "there is no clock here: limit the evaluations or the hits",
            ));
        }
        if self.time == Some(Duration::ZERO) {
            return Err(Error::Budget("the time is zero: give at least a microsecond"));
        }
        if self.evaluations == Some(0) {
            return Err(Error::Budget(
                "the number of evaluations is zero: give at least 1",
            ));
        }
        if self.hits == Some(0) {
            return Err(Error::Budget("the number of hits is zero: give at least 1"));
        }
        if self.patience == Some(0) {
            return Err(Error::Budget(
                "the patience is zero: give at least 1 evaluation without a new hit",
            ));
        }
        if self.horizon == Some(0) {
            return Err(Error::Budget("the horizon is zero: give at least 1 evaluation"));
        }
        if self
            .parallel
            .is_some_and(|parallel| !(1..=Self::MOST_PARALLEL).contains(&parallel))
        {
            return Err(Error::Budget(
                "evaluations at once (`parallel`) are from 1 to 65536",
            ));
        }
        Ok(())
    }

    /// Whether time is limited and evaluations are not: only then may a search depend on the clock.
    pub(crate) fn is_timed(&self) -> bool {
        self.time.is_some() && self.horizon.or(self.evaluations).is_none()
    }

    /// Share used, in `[0, 1]`.
    #[expect(clippy::cast_precision_loss, reason = "a share needs no more than 53 bits")]
    pub(crate) fn share(&self, evaluations: u64, elapsed: Duration) -> f64 {
        let by_count = match self.horizon.or(self.evaluations) {
            Some(limit) => evaluations as f64 / limit as f64,
            None => 0.0,
        };
        let by_time = match self.time {
            Some(limit) if self.horizon.is_none() => elapsed.as_secs_f64() / limit.as_secs_f64(),
            _ => 0.0,
        };
        by_count.max(by_time).min(1.0)
    }
}

/// Why a slice ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum StopReason {
    /// The time was up.
    Time,
    /// The evaluations were spent.
    Evaluations,
    /// Enough hits.
    Hits,
    /// Too many evaluations in succession brought no new hit.
    Patience,
    /// [`Cancel::cancel`] was called.
    Cancelled,
    /// An observer asked to stop.
    Observer,
    /// The engine had nothing more to propose.
    Exhausted,
    /// The whole space was evaluated or excluded by bounds.
    Covered,
    /// The problem panicked, and the run was to [catch that](crate::RunOptions::catch_panics).
    Panicked,
    /// Memory ended before all that was found could be listed.
    Memory,
}

/// For people, as the end of a line about the time.
impl core::fmt::Display for StopReason {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Time => "stopped by time",
            Self::Evaluations => "stopped by evaluations",
            Self::Hits => "stopped by hits",
            Self::Patience => "stopped by patience",
            Self::Cancelled => "cancelled",
            Self::Observer => "stopped by an observer",
            Self::Exhausted => "ended because the engine has nothing more to propose",
            Self::Covered => "finished",
            Self::Panicked => "ended by a panic of the problem",
            Self::Memory => "stopped where memory ended",
        })
    }
}

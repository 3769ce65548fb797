//! The search: engines, settings and hits, slice after slice.

mod checkpoint;
mod contradiction;
#[cfg(test)]
mod crafted_tests;
mod driven;
mod kept;
mod lane;
mod lanes;
mod options;
mod reporting;
mod resume;
mod rounds;
mod running;
mod slice;
mod stage;
mod stepper;
mod steps;
mod tickets;

use std::sync::Arc;

use crate::budget::Budget;
use crate::engine::{ConfiguredEngine, WarmStart};
use crate::error::Error;
use crate::problem::SatisficingProblem;
use crate::report::Report;
use crate::seed::SearchRng;

pub use checkpoint::{Checkpoint, Contents, Fingerprint, Unfinished};
pub use options::RunOptions;
pub use rounds::{IslandRound, Rounds};
pub use stepper::Stepper;
pub use tickets::{Asked, Order, Ticket, TicketCounts, TicketEvent, TicketLog, Tickets, Told};

use kept::KeptSearch;

/// A search: engine, settings and hits, for one problem or for one that moves from slice to slice.
///
/// It holds no problem: [`Search::run`] is given one for each time slice. A second call runs the next slice, warm from the
/// hits of the last one, and replaces them.
///
/// ```
/// use satisfice::{engine, from_fn, Budget, Search, Space};
///
/// // All x in [-2, 2]^2 near the unit circle, a new answer every 0.2.
/// let problem = from_fn(Space::cube(2, -2.0, 2.0)?, 0.01, |x: &[f64]| (x[0].hypot(x[1]) - 1.0).abs())
///     .separation(0.2);
/// let mut search = Search::with(engine::LatestHitQpso { particles: 60, ..Default::default() }).seed(7);
/// let report = search.run(&problem, &Budget::evaluations(20_000))?;
/// println!("{report}");
/// assert!(report.hit_count() >= 15);
/// for hit in report.hits().take(3) {
///     println!("{:?}: F = {} at evaluation {}", hit.solution.coordinates, hit.fitness, hit.evaluation);
/// }
/// # Ok::<(), satisfice::Error>(())
/// ```
///
/// # Panics of the problem
/// A panic of the problem's methods leaves [`Search::run`] like any other, on any number of threads, and the hits of that
/// slice are lost, unless [`RunOptions::catch_panics`] is set. The search can be used afterwards: the next slice is warm from
/// the last one that ended, with engines and random numbers as new.
///
/// # Problems behind a pointer
/// `P` may be unsized: `Search::<dyn SatisficingProblem<Scalar = f64, Solution = T>>::new()` runs on
/// `&dyn SatisficingProblem<Scalar = f64, Solution = T>`.
pub struct Search<P: SatisficingProblem + ?Sized> {
    kept: KeptSearch<P::Scalar, P::Solution>,
}

/// A search by the default engine, as [`Search::new`].
impl<P: SatisficingProblem + ?Sized> Default for Search<P> {
    fn default() -> Self {
        Self::new()
    }
}

impl<P: SatisficingProblem + ?Sized> core::fmt::Debug for Search<P> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Search")
            .field("engine", &self.kept.engine)
            .field("seed", &self.kept.seed)
            .field("threads", &self.kept.threads)
            .field("islands", &self.kept.islands)
            .field("slices", &self.kept.slices)
            .finish_non_exhaustive()
    }
}

impl<P: SatisficingProblem + ?Sized> Search<P> {
    /// A search by the [default engine](crate::engine::default), which uses whatever the problem offers. Where evaluations alone
    /// are limited, it may think for about a millisecond on each of the first 1,000: see [`Budget::evaluations`].
    #[must_use]
    pub fn new() -> Self {
        Self::with(crate::engine::default())
    }

    /// A search by this engine: its settings, or [your own](ConfiguredEngine::custom). Settings are checked when a slice
    /// begins.
    #[must_use]
    pub fn with(engine: impl Into<ConfiguredEngine<P::Scalar>>) -> Self {
        Self {
            kept: KeptSearch::new(engine.into()),
        }
    }

    /// A search by the engine with this name, for command lines; its parameters are [`set`](Search::set) by name.
    ///
    /// # Errors
    /// [`Error::Unknown`] with the nearest name.
    pub fn named(name: &str) -> Result<Self, Error> {
        Ok(Self::with(ConfiguredEngine::named(name)?))
    }

    /// Sets a parameter of the engine by its name. Engines are rebuilt for the next slice.
    ///
    /// ```
    /// use satisfice::{from_fn, Budget, Search, Space};
    /// let problem = from_fn(Space::lattice(2, 50)?, 3.0, |x: &[f64]| x[0] + x[1]);
    /// let report = Search::named("latest-hit-qpso")?
    ///     .set("particles", "60")?
    ///     .run(&problem, &Budget::evaluations(20_000))?;
    /// assert_eq!(report.hit_count(), 6);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`ConfiguredEngine::set`].
    pub fn set(mut self, name: &str, text: &str) -> Result<Self, Error> {
        self.kept.engine = self.kept.engine.set(name, text)?;
        self.kept.lanes.clear();
        Ok(self)
    }

    /// The seed, 0 by default. Setting it restarts the sequence of random numbers.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Self {
        self.kept.seed = seed;
        for (stream, lane) in (0..).zip(&mut self.kept.lanes) {
            lane.rng = SearchRng::stream(seed, stream);
        }
        self
    }

    /// The number of threads that evaluate, 1 by default, 0 for as many as there are cores. **Needs the feature `rayon`:**
    /// without it one thread works, whatever the number, and no error says so. Reports under a budget of evaluations do not depend on it.
    ///
    /// With one island, threads share each batch that is worth it. [`Budget::with_parallel`] tells the engine how large batches have to
    /// be; under a limit of time alone, it is the number of threads. An engine that proposes one point at a time keeps one of them
    /// busy. With several [islands](Search::islands), threads share the islands.
    #[must_use]
    pub fn threads(mut self, threads: usize) -> Self {
        self.kept.threads = threads;
        self.kept.pool = None;
        self
    }

    /// How many calls of the fitness in the slice that ended last were in batches that several threads shared. With one island
    /// and several threads, few of them mean that the engine's batches are too small, or the fitness too cheap: then
    /// [islands](Search::islands) keep the threads busy. It is no part of a report, which does not depend on threads.
    #[must_use]
    pub fn shared_calls(&self) -> u64 {
        self.kept.shared_calls
    }

    /// How many points of the slice that ended last were proposed at least as many at a time as [`Budget::with_parallel`] says, with
    /// one island. Few of them mean that the engine does not follow it. Like the calls above, it is no part of a report; of eager tickets it is
    /// not known.
    #[must_use]
    pub fn in_full_batches(&self) -> u64 {
        self.kept.in_full_batches
    }

    /// The number of islands, from 1 (the default) to 65,536: engines side by side, each with an equal share of the
    /// evaluations, which share the hits they find. For a fitness so cheap that one engine cannot keep several threads busy.
    ///
    /// The number of islands is part of the search, like a seed. A hit is listed when the islands exchange: after 256
    /// evaluations of each, then 512, then every 1,024. It carries the evaluation count and the time of the exchange. Each
    /// island has a state of its own; the hits are there once. Where points within a separation are one answer, two islands may find
    /// two such points between two exchanges, and one is listed: that of the island that comes first. Every hit that was evaluated is the same as a
    /// listed one, unless a limit ends the slice at an exchange. An island that has covered a part of the space by a hit that is not listed
    /// proves nothing from then on; the first island always can. Random numbers are streams of one seed; the first
    /// island's is that of a search with one island. Uniform probes come at the end, after the engines.
    ///
    /// ```
    /// use satisfice::{from_fn, Budget, Search, Space};
    ///
    /// // The 1,245 lattice points of a disc, among a million.
    /// let problem = from_fn(Space::lattice(2, 1000)?, 20.0, |x: &[f64]| (x[0] - 700.0).hypot(x[1] - 300.0));
    /// let report = Search::new().islands(4).threads(2).seed(7).run(&problem, &Budget::evaluations(40_000))?;
    /// assert_eq!(report.hit_count(), 1_245);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    #[must_use]
    pub fn islands(mut self, islands: usize) -> Self {
        self.kept.islands = islands;
        self.kept.lanes.clear();
        self
    }

    /// How slices after the first use the hits before; by default as the engine prefers.
    #[must_use]
    pub fn warm_start(mut self, rule: WarmStart) -> Self {
        self.kept.warm_start = Some(rule);
        self
    }

    /// Points that the next slice evaluates first, as values: one number per axis, inside the bounds and whole on integer axes. They
    /// are counted like all others. Engines are told of them: descents start at the best ones, models learn
    /// from all; swarms follow those that hit.
    ///
    /// A slice refuses to begin with a point that is not of the space: [`Error::StartPoint`] says which one.
    ///
    /// ```
    /// use satisfice::{from_fn, Budget, Search, Space};
    /// // A needle in a million points, and a guess that is near.
    /// let problem = from_fn(Space::lattice(2, 1000)?, 0.5, |x: &[f64]| (x[0] - 700.0).hypot(x[1] - 300.0));
    /// let mut search = Search::named("descent")?.start_from([[690.0, 305.0]]);
    /// let report = search.run(&problem, &Budget::evaluations(60))?;
    /// assert_eq!(report.hit_count(), 1);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    #[must_use]
    pub fn start_from<X: AsRef<[P::Scalar]>>(mut self, points: impl IntoIterator<Item = X>) -> Self {
        self.kept.starts = points.into_iter().map(|point| point.as_ref().to_vec()).collect();
        self
    }

    /// The share of the evaluations to spend on uniform probes, from 0 (none) to 0.5; by default as the engine prefers,
    /// which is 0 for every engine from the literature and 0.02 for the default, but none if that makes fewer than ten.
    ///
    /// From the probes the report [estimates the hits not seen](crate::Report::unseen), with an interval. Their hits are
    /// listed, but the engine is not told of them: its own sequence of points is the same as without probes, unless it plans with the
    /// evaluations that are left, as the default does.
    ///
    /// ```
    /// use satisfice::{engine, from_fn, Budget, Search, Space};
    /// // 21 lattice points of a disc, in a space of 10^4.
    /// let problem = from_fn(Space::lattice(2, 100)?, 2.5, |x: &[f64]| (x[0] - 50.0).hypot(x[1] - 20.0));
    /// let mut search = Search::named("random")?.seed(1).probes(0.2);
    /// let report = search.run(&problem, &Budget::evaluations(5_000))?;
    /// let unseen = report.unseen.expect("1,000 probes were made");
    /// let (lower, upper) = unseen.interval;
    /// let truth = 21.0 - report.hit_count() as f64;
    /// assert!(lower <= truth && truth <= upper.expect("a lattice is finite"), "{unseen}");
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    #[must_use]
    pub fn probes(mut self, share: f64) -> Self {
        self.kept.probes = Some(share);
        self
    }

    /// Forgets the hits so far: the next slice starts cold.
    pub fn clear(&mut self) {
        self.kept.previous = Arc::default();
    }

    /// Runs one time slice on `problem`.
    ///
    /// # Errors
    /// [`Error::Budget`] for a budget that is empty or zero, [`Error::Threshold`] for a threshold of NaN,
    /// [`Error::Parameter`] for a setting out of range, [`Error::SpaceChanged`] if the number of axes differs from that of
    /// the slice before, [`Error::StartPoint`] for a start point outside the space, [`Error::State`] if the search was resumed and
    /// this is another problem, [`Error::Threads`].
    pub fn run(&mut self, problem: &P, budget: &Budget) -> Result<Report<P::Solution>, Error> {
        self.run_with(problem, budget, RunOptions::new())
    }

    /// Runs one time slice on `problem`, with an observer, with checkpoints, or catching panics.
    ///
    /// # Errors
    /// As [`Search::run`].
    pub fn run_with(
        &mut self,
        problem: &P,
        budget: &Budget,
        options: RunOptions<'_, P::Solution>,
    ) -> Result<Report<P::Solution>, Error> {
        let mut budget = budget.clone();
        if options.cancel.is_some() {
            budget.cancel.clone_from(&options.cancel);
        }
        let Stepper { problem, driven } = self.start(problem, &budget)?;
        driven.drive(&problem, options)
    }

    /// Begins a slice that is driven by hand. A slice that was saved unfinished is forgotten.
    ///
    /// # Errors
    /// As [`Search::run`].
    pub fn start<'a>(&'a mut self, problem: &'a P, budget: &Budget) -> Result<Stepper<'a, P>, Error> {
        let running = self.kept.start(&problem, budget)?;
        Ok(Stepper::new(&mut self.kept, problem, running))
    }
}

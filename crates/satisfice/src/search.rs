//! The loop: engine, ledger, archive, slice after slice.

mod checkpoint;
mod islands;
mod slice;
mod steps;

use std::sync::Arc;

use crate::archive::Archive;
use crate::batch::Outcome;
use crate::budget::{Budget, StopReason};
use crate::catalogue::Description;
use crate::engine::{Ask, ConfiguredEngine, Engine, Origin, WarmStart};
use crate::error::Error;
use crate::identity::Identity;
use crate::observer::Observer;
use crate::probes::Probes;
use crate::problem::SatisficingProblem;
use crate::report::{Completeness, Report};
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::threads::Threads;
use crate::unseen::Unseen;
use crate::view::View;

pub use checkpoint::{Checkpoint, Saving, Unfinished};
pub use islands::Islands;
use islands::NoEngine;
use slice::Slice;
use steps::SingleSteps;

/// An engine that asks for more this often without proposing anything has nothing to propose.
const EMPTY_ASKS: usize = 1000;

/// A search: engine, settings and the set C, for one problem or for one that moves from slice to slice.
///
/// It borrows no problem: [`Search::run`] is given one for each time slice. A second call goes on with the next slice,
/// warm from the hits of the last one, whose C it replaces.
///
/// ```
/// use satisfice::{engine, from_fn, Budget, Search, Space};
///
/// // All x in [-2, 2]^2 near the unit circle, a new answer every 0.2.
/// let problem = from_fn(Space::cube(2, -2.0, 2.0)?, 0.01, |x: &[f64]| (x[0].hypot(x[1]) - 1.0).abs())
///     .separation(0.2);
/// let mut search = Search::new(engine::build("latest-hit-qpso")?).seed(7);
/// let report = search.run(&problem, &Budget::evaluations(20_000))?;
/// println!("{report}");
/// assert!(report.hit_count() >= 15);
/// for hit in report.hits().take(3) {
///     println!("{:?} at evaluation {}", hit.solution.coordinates, hit.evaluation);
/// }
/// # Ok::<(), satisfice::Error>(())
/// ```
pub struct Search<S, T> {
    engine: Box<dyn Engine<S>>,
    configured: ConfiguredEngine<S>,
    description: Description,
    seed: u64,
    threads: usize,
    warm_start: Option<WarmStart>,
    probes: Option<f64>,
    rng: SearchRng,
    slices: u64,
    dimension: Option<usize>,
    previous: Arc<Archive<T>>,
    pool: Option<Threads>,
    slice: Option<Slice<S, T>>,
    /// The problem of the slice that has begun or ended last.
    problem: Option<Description>,
}

/// A search by the [default engine](crate::engine::default), which uses whatever the problem offers.
impl<S: Real, T: Identity + Clone + Send + Sync> Default for Search<S, T> {
    fn default() -> Self {
        Self::new(crate::engine::default())
    }
}

impl<S: Real, T: Identity + Clone + Send + Sync> Search<S, T> {
    /// A search by this engine: given by its settings, [by name](crate::engine::build), or
    /// [your own](ConfiguredEngine::custom). Settings are checked when the search begins.
    #[must_use]
    pub fn new(engine: impl Into<ConfiguredEngine<S>>) -> Self {
        let configured = engine.into();
        let description = Description {
            name: configured.name().to_owned(),
            parameters: configured.parameters(),
        };
        let engine = match configured.build() {
            Ok(engine) => engine,
            Err(_) => Box::new(NoEngine), // `begin` says what is wrong
        };
        Self {
            engine,
            configured,
            description,
            seed: 0,
            threads: 1,
            warm_start: None,
            probes: None,
            rng: SearchRng::new(0),
            slices: 0,
            dimension: None,
            previous: Arc::default(),
            pool: None,
            slice: None,
            problem: None,
        }
    }

    /// The seed, 0 by default. Setting it begins the sequence of random numbers anew.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self.rng = SearchRng::new(seed);
        self
    }

    /// How many threads evaluate, 1 by default, 0 for as many as there are cores. Needs the feature `rayon`; without it one
    /// thread works. Reports under an evaluation budget do not depend on it.
    #[must_use]
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = threads;
        self.pool = None;
        self
    }

    /// How slices after the first make use of the hits before; by default as the engine wants it.
    #[must_use]
    pub fn warm_start(mut self, rule: WarmStart) -> Self {
        self.warm_start = Some(rule);
        self
    }

    /// The share of the evaluations to spend on uniform probes, from 0 (none) to 0.5; by default as the engine wants it,
    /// which is 0 for every engine from the literature.
    ///
    /// From the probes the report [estimates the hits not seen](crate::Report::unseen), with an interval. Their hits enter C,
    /// but the engine is not told of them: its own sequence of points stays as it is without probes.
    ///
    /// ```
    /// use satisfice::{engine, from_fn, Budget, Search, Space};
    /// // 21 lattice points of a disc, in a space of 10^4.
    /// let problem = from_fn(Space::lattice(2, 100)?, 2.5, |x: &[f64]| (x[0] - 50.0).hypot(x[1] - 20.0));
    /// let mut search = Search::new(engine::build("random")?).seed(1).probes(0.2);
    /// let report = search.run(&problem, &Budget::evaluations(5_000))?;
    /// let unseen = report.unseen.expect("1,000 probes were made");
    /// let (lower, upper) = unseen.interval;
    /// let truth = 21.0 - report.hit_count() as f64;
    /// assert!(lower <= truth && truth <= upper.expect("a lattice is finite"), "{unseen}");
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    #[must_use]
    pub fn probes(mut self, share: f64) -> Self {
        self.probes = Some(share);
        self
    }

    /// Forgets the hits so far: the next slice starts cold.
    pub fn clear(&mut self) {
        self.previous = Arc::default();
    }

    /// Runs one time slice on `problem`.
    ///
    /// # Errors
    /// [`Error::Budget`] for a budget that is empty or zero, [`Error::Threshold`] for a threshold of NaN,
    /// [`Error::Parameter`] for a share of [probes](Search::probes) outside [0, 0.5],
    /// [`Error::SpaceChanged`] if the number of axes is another than in the slice before, [`Error::Threads`].
    pub fn run<P>(&mut self, problem: &P, budget: &Budget) -> Result<Report<T>, Error>
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        self.run_observed(problem, budget, &mut ())
    }

    /// The same while somebody watches.
    ///
    /// # Errors
    /// As [`Search::run`].
    pub fn run_observed<P>(
        &mut self,
        problem: &P,
        budget: &Budget,
        observer: &mut dyn Observer<T>,
    ) -> Result<Report<T>, Error>
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        self.begin(problem, budget)?;
        self.drive(problem, observer, None)
    }

    /// The same while checkpoints are kept.
    ///
    /// # Errors
    /// As [`Search::run`].
    pub fn run_saving<P>(
        &mut self,
        problem: &P,
        budget: &Budget,
        observer: &mut dyn Observer<T>,
        saving: Saving<'_, T>,
    ) -> Result<Report<T>, Error>
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        self.begin(problem, budget)?;
        self.drive(problem, observer, Some(saving))
    }

    /// Runs the slice that has begun to its end.
    fn drive<P>(
        &mut self,
        problem: &P,
        observer: &mut dyn Observer<T>,
        mut saving: Option<Saving<'_, T>>,
    ) -> Result<Report<T>, Error>
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        if self.pool.is_none() {
            self.pool = Some(Threads::new(self.threads)?);
        }
        // While an engine advances by itself, no checkpoint can be taken.
        let alone = saving.is_none();
        while self.propose(problem, alone.then_some(&mut *observer)) {
            if let (Some(slice), Some(pool)) = (&mut self.slice, &self.pool) {
                slice.ledger.evaluate(problem, &mut slice.candidates, pool);
            }
            self.save_if_due(&mut saving);
            self.settle(problem, observer);
            if let (Some(slice), Some(pool)) = (&self.slice, &self.pool)
                && slice.ledger.has_shared()
            {
                pool.rouse();
            }
        }
        if let Some(saving) = saving {
            saving.at_the_end(self);
        }
        self.finish(problem)
    }

    /// Begins a slice that is driven by hand: then [`ask`](Search::ask), evaluate, [`tell`](Search::tell) until `ask` gives
    /// nothing, then [`finish`](Search::finish). A slice that has begun before and was not finished is dropped.
    ///
    /// ```
    /// # use satisfice::{engine, from_fn, Budget, SatisficingProblem, Search, Space};
    /// # let problem = from_fn(Space::lattice(2, 50)?, 3.0, |x: &[f64]| x[0] + x[1]);
    /// let mut search = Search::new(engine::build("random")?);
    /// search.begin(&problem, &Budget::evaluations(5000))?;
    /// loop {
    ///     let candidates = search.ask(&problem)?;
    ///     if candidates.is_empty() {
    ///         break;
    ///     }
    ///     // On a cluster, in a simulator, in another language:
    ///     let fitness: Vec<f64> = candidates.iter().map(|c| problem.fitness(c)).collect();
    ///     search.tell(&problem, &fitness)?;
    /// }
    /// let report = search.finish(&problem)?;
    /// assert_eq!(report.hit_count(), 6);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Search::run`].
    pub fn begin<P>(&mut self, problem: &P, budget: &Budget) -> Result<(), Error>
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        budget.check()?;
        self.configured.check()?;
        if problem.threshold().is_nan() {
            return Err(Error::Threshold);
        }
        let now = problem.space().dimension();
        match self.dimension {
            Some(before) if before != now => return Err(Error::SpaceChanged { before, now }),
            _ => self.dimension = Some(now),
        }
        let rule = self.warm_start.unwrap_or_else(|| self.engine.warm_start());
        if rule == WarmStart::Cold {
            self.clear();
        }
        let share = self.probes.unwrap_or_else(|| self.engine.probes());
        let probes = Probes::new(share, self.seed, self.slices)?;
        let mut begun = Slice::begin(budget, now, probes);
        if rule != WarmStart::Verify {
            begun.verified = self.previous.len();
        }
        let slice = self.slice.insert(begun);
        self.problem = Some(problem.description());
        self.engine.begin(&slice.view(problem, &self.previous));
        Ok(())
    }

    /// The next solutions to evaluate, none of them in C; none at all when the slice is over.
    ///
    /// # Errors
    /// [`Error::Tell`] where the last ones have not been told.
    pub fn ask<P>(&mut self, problem: &P) -> Result<&[T], Error>
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        if let Some(slice) = self.slice.as_ref().filter(|slice| slice.outstanding) {
            return Err(Error::Tell {
                wanted: slice.candidates.live().len(),
                got: 0,
            });
        }
        while self.propose(problem, None) {
            match &mut self.slice {
                Some(slice) if !slice.candidates.live().is_empty() => {
                    slice.outstanding = true;
                    break;
                }
                // All of them are in C: that is settled without anybody's help.
                _ => self.settle(problem, &mut ()),
            }
        }
        Ok(match &self.slice {
            Some(slice) if slice.outstanding => slice.candidates.live(),
            _ => &[],
        })
    }

    /// Tells the fitness of what [`ask`](Search::ask) gave, in its order.
    ///
    /// # Errors
    /// [`Error::Tell`] where the number of values is another.
    pub fn tell<P>(&mut self, problem: &P, fitness: &[S]) -> Result<(), Error>
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        match &mut self.slice {
            Some(slice) if slice.outstanding => {
                slice.candidates.take_fitness(fitness)?;
                slice.outstanding = false;
                slice.ledger.evaluated_elsewhere(fitness.len());
            }
            _ => {
                return Err(Error::Tell {
                    wanted: 0,
                    got: fitness.len(),
                });
            }
        }
        self.settle(problem, &mut ());
        Ok(())
    }

    /// Ends the slice and reports. One that is not over counts as cancelled.
    ///
    /// # Errors
    /// [`Error::State`] where no slice has begun.
    pub fn finish<P>(&mut self, problem: &P) -> Result<Report<T>, Error>
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        let mut slice = self
            .slice
            .take()
            .ok_or_else(|| Error::State("no slice has begun".to_owned()))?;
        let (elapsed, overshoot) = slice.ledger.close(slice.archive.len());
        let stop_reason = slice.ledger.stop.unwrap_or(StopReason::Cancelled);
        slice.ledger.counts.neighbour_calls = slice.calls.neighbours.get();
        slice.ledger.count_bounds(slice.calls.bounds.get());
        // A hit that only a probe found belies an engine that says it has covered everything.
        let proved = stop_reason == StopReason::Covered && slice.archive.hidden() == 0;
        let unseen = if proved {
            Some(Unseen::nothing(slice.probes.count()))
        } else {
            slice.probes.estimate(problem, &slice.archive)
        };
        slice.archive.rest();
        self.previous = Arc::new(slice.archive);
        self.slices += 1;
        Ok(Report {
            problem: problem.description(),
            engine: self.description.clone(),
            scalar: S::NAME.to_owned(),
            seed: self.seed,
            slice: self.slices - 1,
            budget: slice.ledger.budget,
            probe_share: slice.probes.share(),
            stop_reason,
            counts: slice.ledger.counts,
            elapsed,
            overshoot,
            completeness: if proved {
                Completeness::Proved
            } else {
                Completeness::Unknown
            },
            unseen,
            trace: slice.ledger.trace,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            archive: Arc::clone(&self.previous),
        })
    }

    /// Fills the batch and prepares its candidates; `false` when the slice is over or pauses. With an observer, an engine that can
    /// advances by itself on the way.
    #[inline]
    fn propose<P>(&mut self, problem: &P, alone: Option<&mut dyn Observer<T>>) -> bool
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        let proposed = self.propose_next(problem, alone);
        if let Some(slice) = &mut self.slice {
            slice.pending = proposed;
        }
        proposed
    }

    fn propose_next<P>(&mut self, problem: &P, mut alone: Option<&mut dyn Observer<T>>) -> bool
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        let Some(slice) = &mut self.slice else {
            return false;
        };
        let deletes = self.engine.deletes();
        if let Some(pending) = slice.resumed.take() {
            slice.propose_again(problem, &self.previous, &pending, deletes);
            return true;
        }
        let mut idle = 0;
        loop {
            if slice.ledger.is_over() || slice.ledger.counts.evaluations >= slice.pause {
                return false;
            }
            if slice.is_verifying(&self.previous) {
                let limit = slice.ledger.remaining();
                slice.propose_previous(problem, &self.previous, limit);
                return true;
            }
            slice.candidates.probing = slice.probes.is_due(slice.ledger.counts.evaluations);
            if slice.candidates.probing {
                slice.probes.propose(problem, &mut slice.batch);
                slice.prepare(problem, true);
                return true;
            }
            slice.origin = Origin::Engine;
            if slice.last != Ask::More || idle >= EMPTY_ASKS {
                let covered = slice.last == Ask::Covered;
                slice.ledger.stop = Some(if covered {
                    StopReason::Covered
                } else {
                    StopReason::Exhausted
                });
                return false;
            }
            if let Some(observer) = &mut alone
                && slice.last == Ask::More
            {
                let mut steps = SingleSteps {
                    problem,
                    ledger: &mut slice.ledger,
                    candidates: &mut slice.candidates,
                    archive: &mut slice.archive,
                    probes: &slice.probes,
                    observer: *observer,
                    deletes,
                    pause: slice.pause,
                    over: false,
                };
                if self.engine.advance(&mut self.rng, &mut steps) {
                    idle = 0;
                    continue;
                }
            }
            slice.batch.clear();
            // Not by `Slice::view`: the batch is borrowed beside it.
            let view = View {
                problem,
                archive: &slice.archive,
                previous: &self.previous,
                ledger: &slice.ledger,
                calls: &slice.calls,
                scratches: &slice.scratches,
            };
            slice.last = self.engine.ask(&view, &mut self.rng, &mut slice.batch);
            let bounds = slice.calls.bounds.get();
            let works = bounds > slice.ledger.counts.bound_calls;
            if works {
                slice.ledger.count_bounds(bounds);
            }
            if !slice.batch.is_empty() {
                slice.prepare(problem, deletes);
                return true;
            }
            // An engine that works on bounds has not come to its end.
            idle = if works { 0 } else { idle + 1 };
        }
    }

    /// Settles the batch and tells the engine.
    #[inline]
    fn settle<P>(&mut self, problem: &P, observer: &mut dyn Observer<T>)
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        let Some(slice) = &mut self.slice else { return };
        slice.pending = false;
        slice
            .ledger
            .settle(problem, &mut slice.candidates, &mut slice.archive, observer);
        if slice.candidates.probing {
            slice
                .probes
                .take(problem, &slice.batch, &slice.candidates.outcomes, &slice.archive);
            slice.ledger.counts.probes = slice.probes.count();
            return;
        }
        if slice.origin == Origin::WarmStart {
            slice.ledger.counts.verified += slice.candidates.outcomes.len() as u64;
            if slice.batch.is_empty() {
                return; // a problem that does not encode: the engine has nothing to see
            }
        }
        if slice.origin == Origin::Engine
            && slice.last == Ask::Covered
            && !slice.candidates.outcomes.contains(&Outcome::NotEvaluated)
        {
            // That was the last of the space, even where the budget ends with it.
            slice.ledger.stop = Some(StopReason::Covered);
        }
        let view = slice.view(problem, &self.previous);
        self.engine
            .tell(&view, &slice.batch, &slice.candidates.outcomes, slice.origin);
    }
}

//! What a search keeps from slice to slice, and how a slice begins. Compiled once for each type of solution.

use std::sync::Arc;

use super::checkpoint::Fingerprint;
use super::lane::{Lane, RunningLane};
use super::lanes::{self, Exchange, LanesProgress};
use super::running::Running;
use super::slice::Slice;
use crate::accounting::{Reached, Unlisted};
use crate::archive::Archive;
use crate::budget::{Budget, StopReason};
use crate::engine::{ConfiguredEngine, WarmStart};
use crate::error::Error;
use crate::identity::Identity;
use crate::probes::Probes;
use crate::problem::AnyProblem;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::threads::Threads;

/// The most lanes of a search.
pub(super) const MOST_LANES: usize = 65_536;

/// A search, whatever the type of its problem.
pub(super) struct KeptSearch<S, T> {
    pub(super) engine: ConfiguredEngine<S>,
    pub(super) seed: u64,
    pub(super) threads: usize,
    pub(super) islands: usize,
    pub(super) warm_start: Option<WarmStart>,
    pub(super) probes: Option<f64>,
    /// Points that the next slice evaluates first.
    pub(super) starts: Vec<Vec<S>>,
    pub(super) slices: u64,
    /// Number of axes, once a slice has begun.
    pub(super) dimension: Option<usize>,
    /// The hits of the slice that ended last.
    pub(super) previous: Arc<Archive<T>>,
    /// Engines and random numbers; none before the first slice and after a panic.
    pub(super) lanes: Vec<Lane<S>>,
    pub(super) pool: Option<Threads>,
    /// Calls of the fitness that several threads shared, in the slice that ended last.
    pub(super) shared_calls: u64,
    /// Points in batches as large as the budget asked for, in that slice.
    pub(super) in_full_batches: u64,
    /// The slice that had begun when the search was saved.
    pub(super) unfinished: Option<Running<S, T>>,
    /// The problem of the slice that began last.
    pub(super) problem: Option<Fingerprint>,
    /// Whether that problem is the one of a checkpoint, and no slice has begun since.
    pub(super) resumed: bool,
}

impl<S: Real, T: Identity + Clone + Send + Sync> KeptSearch<S, T> {
    pub(super) fn new(engine: ConfiguredEngine<S>) -> Self {
        Self {
            engine,
            seed: 0,
            threads: 1,
            islands: 1,
            warm_start: None,
            probes: None,
            starts: Vec::new(),
            slices: 0,
            dimension: None,
            previous: Arc::default(),
            lanes: Vec::new(),
            pool: None,
            shared_calls: 0,
            in_full_batches: 0,
            unfinished: None,
            problem: None,
            resumed: false,
        }
    }

    /// Begins a slice.
    pub(super) fn start(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        budget: &Budget,
    ) -> Result<Running<S, T>, Error> {
        let (probes, rule) = self.prepare(problem, budget)?;
        self.begin(problem, budget, &probes, rule)
    }

    /// Checks everything and builds the engines, before a slice begins.
    pub(super) fn prepare(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        budget: &Budget,
    ) -> Result<(Probes, WarmStart), Error> {
        budget.check()?;
        let now = self.check(problem)?;
        self.check_resumed(problem)?;
        for (index, point) in self.starts.iter().enumerate() {
            let checked = problem.space().check_values(point);
            checked.map_err(|error| Error::StartPoint {
                index,
                reason: error.to_string(),
            })?;
        }
        self.resumed = false;
        self.unfinished = None;
        self.build_lanes()?;
        let first = &self.lanes[0].engine;
        let rule = self.warm_start.unwrap_or_else(|| first.warm_start());
        let share = self.probes.unwrap_or_else(|| {
            let (share, planned) = (first.probes(), budget.evaluations);
            // A proof needs no estimate.
            let is_proof = self.islands == 1 && Probes::leave_no_room(problem.space(), share, planned);
            let is_unprobed = is_proof || Probes::are_too_few(share, planned);
            if is_unprobed { 0.0 } else { share }
        });
        let probes = Probes::new(share, self.seed, self.slices)?;
        if rule == WarmStart::Cold {
            self.previous = Arc::default();
            for lane in &mut self.lanes {
                lane.engine = self.engine.build()?;
            }
        }
        self.dimension = Some(now);
        self.problem = Some(Fingerprint::of(problem));
        Ok((probes, rule))
    }

    /// Checks what does not depend on the budget; returns the number of axes.
    pub(super) fn check(&self, problem: &AnyProblem<'_, S, T>) -> Result<usize, Error> {
        self.engine.check()?;
        if !(1..=MOST_LANES).contains(&self.islands) {
            return Err(Error::parameter(
                "islands",
                self.islands,
                "a number from 1 to 65536",
            ));
        }
        if problem.threshold().is_nan() {
            return Err(Error::Threshold);
        }
        let now = problem.space().dimension();
        match self.dimension {
            Some(before) if before != now => Err(Error::SpaceChanged { before, now }),
            _ => Ok(now),
        }
    }

    /// Builds the engines, unless they are there.
    pub(super) fn build_lanes(&mut self) -> Result<(), Error> {
        if self.lanes.len() != self.islands {
            self.lanes = (0..self.islands as u64)
                .map(|stream| {
                    Ok(Lane {
                        engine: self.engine.build()?,
                        rng: SearchRng::stream(self.seed, stream),
                    })
                })
                .collect::<Result<_, Error>>()?;
        }
        Ok(())
    }

    /// Begins the slice in every lane.
    pub(super) fn begin(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        budget: &Budget,
        probes: &Probes,
        rule: WarmStart,
    ) -> Result<Running<S, T>, Error> {
        let (dimension, count) = (problem.space().dimension(), self.lanes.len());
        let hits = self.previous.len();
        let to_verify = |lane: usize| match rule {
            WarmStart::Verify => lanes::verified_by(lane, count, hits),
            WarmStart::Cold | WarmStart::Engine => hits..hits,
        };
        let exchange = if count > 1 {
            let common = Slice::begin(budget, dimension, probes.clone(), 0..0, Reached::default());
            Some(Exchange {
                common,
                progress: LanesProgress::new(count),
            })
        } else {
            None
        };
        let mut running = Running {
            lanes: Vec::with_capacity(count),
            exchange,
        };
        let starts = self.take_starts(problem);
        let at_once = self.threads_at_once(budget);
        for (number, mut lane) in core::mem::take(&mut self.lanes).into_iter().enumerate() {
            let (own_budget, own_probes) = match &running.exchange {
                Some(_) => (
                    lanes::share_of(budget, number, count, probes.share()),
                    Probes::new(0.0, self.seed, self.slices)?,
                ),
                None => (budget.clone(), probes.clone()),
            };
            let mut slice = Slice::begin(
                &own_budget,
                dimension,
                own_probes,
                to_verify(number),
                Reached::default(),
            );
            slice.ledger.at_once = at_once;
            slice.ledger.islands = count;
            slice.ledger.unlisted = running.exchange.is_some().then(Unlisted::nothing);
            slice.set_starts(&starts[lanes::verified_by(number, count, starts.len())]);
            if own_budget.evaluations == Some(0) {
                slice.ledger.stop = Some(StopReason::Evaluations); // fewer evaluations than lanes
            } else {
                lane.engine.begin(&slice.view(problem, &self.previous));
            }
            running.lanes.push(RunningLane { lane, slice });
        }
        running.pause_for_exchange();
        Ok(running)
    }

    /// Where time is limited and evaluations are not, a report depends on the machine anyway: then as many evaluations go on at once as there
    /// are threads, unless the budget says how many.
    pub(super) fn threads_at_once(&self, budget: &Budget) -> usize {
        if budget.is_timed() && budget.parallel.is_none() && self.islands == 1 {
            Threads::most(self.threads)
        } else {
            1
        }
    }

    /// The positions that the slice evaluates first.
    pub(super) fn take_starts(&mut self, problem: &AnyProblem<'_, S, T>) -> Vec<Vec<S>> {
        let mut starts = core::mem::take(&mut self.starts);
        for point in &mut starts {
            problem.space().positions(point);
        }
        starts
    }
}

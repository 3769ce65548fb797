//! Continuing a search that was saved.

use super::Search;
use super::kept::KeptSearch;
use core::time::Duration;

use super::checkpoint::{Checkpoint, Contents, Fingerprint, Unfinished, fits, named};
use super::lane::{Lane, RunningLane};
use super::lanes::Exchange;
use super::options::RunOptions;
use super::running::Running;
use super::slice::Slice;
use super::stage::{Pending, Stage};
use super::stepper::Stepper;
use crate::accounting::Reached;
use crate::archive::KnownHits;
use crate::best::BestSoFar;
use crate::budget::Cancel;
use crate::engine::ConfiguredEngine;
use crate::error::Error;
use crate::identity::Identity;
use crate::probes::Probes;
use crate::problem::{AnyProblem, SatisficingProblem};
use crate::report::Report;
use crate::scalar::Real;
use crate::state::{Reader, State};

/// More evaluations than any slice makes.
const TOO_MANY: u64 = 1 << 62;
/// More time than any slice takes: about 35,000 years.
const TOO_LONG: Duration = Duration::from_secs(1 << 40);

impl<P: SatisficingProblem + ?Sized> Search<P> {
    /// The search that was saved, with the same engine and parameters. A slice that had not ended is continued by
    /// [`run_resumed`](Search::run_resumed) or, by hand, [`start_resumed`](Search::start_resumed). The number of
    /// [threads](Search::threads) is not saved.
    ///
    /// # Errors
    /// [`Error::State`] if version, scalar or engine differ, or if the data do not fit each other; errors of the engine's
    /// parameters.
    pub fn resume(
        checkpoint: Checkpoint<P::Solution>,
        engine: impl Into<ConfiguredEngine<P::Scalar>>,
    ) -> Result<Self, Error> {
        let kept = KeptSearch::resume(checkpoint, engine.into())?;
        Ok(Self { kept })
    }

    /// Runs the slice that had not ended when the search was saved to its end. Its budget is the one it began with, with the
    /// [cancellation of the options](RunOptions::cancel).
    ///
    /// # Errors
    /// [`Error::State`] if no slice has begun, or if it began with another problem: another
    /// [description](SatisficingProblem::description), space or threshold; [`Error::SpaceChanged`], [`Error::Threshold`],
    /// [`Error::Threads`].
    pub fn run_resumed(
        &mut self,
        problem: &P,
        options: RunOptions<'_, P::Solution>,
    ) -> Result<Report<P::Solution>, Error> {
        if let Some(running) = &mut self.kept.unfinished {
            running.set_cancel(options.cancel.as_ref());
        }
        let Stepper { problem, driven } = self.start_resumed(problem)?;
        driven.drive(&problem, options)
    }

    /// Continues the slice that had not ended when the search was saved, by hand.
    ///
    /// # Errors
    /// As [`Search::run_resumed`].
    pub fn start_resumed<'a>(&'a mut self, problem: &'a P) -> Result<Stepper<'a, P>, Error> {
        let running = self.kept.start_resumed(&problem)?;
        Ok(Stepper::new(&mut self.kept, problem, running))
    }

    /// The same, with a flag that cancels the slice, in place of the one that it began with.
    ///
    /// # Errors
    /// As [`Search::run_resumed`].
    pub fn start_resumed_until<'a>(
        &'a mut self,
        problem: &'a P,
        cancel: &Cancel,
    ) -> Result<Stepper<'a, P>, Error> {
        if let Some(running) = &mut self.kept.unfinished {
            running.set_cancel(Some(cancel));
        }
        self.start_resumed(problem)
    }
}

impl<S: Real, T: Identity + Clone + Send + Sync> KeptSearch<S, T> {
    /// The search that was saved.
    fn resume(checkpoint: Checkpoint<T>, engine: ConfiguredEngine<S>) -> Result<Self, Error> {
        let (mut search, saved, lanes) = Self::resume_parts(checkpoint, engine)?;
        if saved.tickets.is_some() {
            return Err(Error::State(
                "its slice has tickets: `Tickets::resume` continues it".to_owned(),
            ));
        }
        if !lanes.is_empty() && lanes.len() != search.islands {
            return Err(Error::State("it has another number of lanes".to_owned()));
        }
        if saved.unfinished.is_some() {
            search.unfinished = Some(restore(saved, lanes)?);
        } else {
            search.lanes = lanes;
        }
        Ok(search)
    }

    /// The search, the rest of the checkpoint, and its engines.
    #[expect(clippy::type_complexity, reason = "three things")]
    pub(super) fn resume_parts(
        checkpoint: Checkpoint<T>,
        engine: ConfiguredEngine<S>,
    ) -> Result<(Self, Contents<T>, Vec<Lane<S>>), Error> {
        let saved = checkpoint.contents;
        fits("version", &saved.version, env!("CARGO_PKG_VERSION"))?;
        fits("scalar", &saved.scalar, S::NAME)?;
        let mut search = Self::new(engine);
        (search.islands, search.seed) = (saved.islands, saved.seed);
        fits("engine", &named(&saved.engine), &named(&search.description()))?;
        search.warm_start = saved.warm_start;
        search.probes = saved.probes;
        search.starts = saved
            .starts
            .iter()
            .map(|at| at.iter().map(|&x| S::of(x)).collect())
            .collect();
        search.slices = saved.slices;
        search.dimension = saved.dimension;
        search.previous = saved.previous.clone();
        search.problem.clone_from(&saved.problem);
        search.resumed = true;
        let lanes = saved
            .lanes
            .iter()
            .map(|state| Lane::restore(&search.engine, state))
            .collect::<Result<Vec<_>, Error>>()?;
        Ok((search, saved, lanes))
    }

    /// Checks that the problem is the one that the search was saved with.
    pub(super) fn check_saved(&self, problem: &AnyProblem<'_, S, T>) -> Result<(), Error> {
        self.check(problem)?;
        match &self.problem {
            Some(saved) => saved.check::<S>(&Fingerprint::of(problem)),
            None => Ok(()),
        }
    }

    /// Continues the slice that had not ended when the search was saved.
    fn start_resumed(&mut self, problem: &AnyProblem<'_, S, T>) -> Result<Running<S, T>, Error> {
        self.check_saved(problem)?;
        let running = self.unfinished.take();
        let mut running = running.ok_or_else(|| Error::State("no slice has begun".to_owned()))?;
        for lane in &mut running.lanes {
            lane.slice.ledger.at_once = self.threads_at_once(&lane.slice.ledger.budget);
            lane.slice.ledger.islands = self.islands;
        }
        self.resumed = false;
        Ok(running)
    }

    /// # Errors
    /// [`Error::State`] if the search was saved with a problem of another name.
    pub(super) fn check_resumed(&self, problem: &AnyProblem<'_, S, T>) -> Result<(), Error> {
        match &self.problem {
            Some(saved) if self.resumed => {
                fits("problem", &saved.description.name, &problem.description().name)
            }
            _ => Ok(()),
        }
    }
}

/// The slice of all lanes.
pub(super) fn restore<S: Real, T: Identity + Clone + Send + Sync>(
    saved: Contents<T>,
    lanes: Vec<Lane<S>>,
) -> Result<Running<S, T>, Error> {
    let dimension = saved
        .dimension
        .ok_or_else(|| Error::State("a slice without axes".to_owned()))?;
    let previous = saved.previous.len();
    let reported = saved
        .unfinished
        .map(|slice| Slice::restore(slice, dimension, previous));
    let Some(reported) = reported.transpose()? else {
        return Err(Error::State("no slice has begun".to_owned()));
    };
    let misfit = || Error::State("its lanes do not fit its slice".to_owned());
    let (slices, exchange) = match saved.exchange {
        None => (vec![reported], None),
        Some((slices, progress)) if progress.fits(lanes.len()) => {
            let mut slices = slices
                .into_iter()
                .map(|slice| Slice::restore(slice, dimension, previous))
                .collect::<Result<Vec<_>, Error>>()?;
            if slices.iter().any(|slice| slice.ledger.unlisted.is_none()) {
                return Err(misfit());
            }
            let common = reported;
            let mut exchange = Exchange { common, progress };
            if exchange.is_searching() {
                exchange.share(slices.iter_mut());
            }
            (slices, Some(exchange))
        }
        Some(_) => return Err(misfit()),
    };
    if slices.is_empty() || slices.len() != lanes.len() || (lanes.len() > 1) != exchange.is_some() {
        return Err(misfit());
    }
    let lanes = lanes.into_iter().zip(slices);
    let mut running = Running {
        lanes: lanes.map(|(lane, slice)| RunningLane { lane, slice }).collect(),
        exchange,
    };
    running.pause_for_exchange();
    Ok(running)
}

impl<S: Real> Lane<S> {
    fn restore(engine: &ConfiguredEngine<S>, state: &State) -> Result<Self, Error> {
        let mut reader = Reader::new(state);
        let rng = reader.read()?;
        let mut engine = engine.build()?;
        engine.restore(&mut reader)?;
        reader.finish()?;
        Ok(Self { engine, rng })
    }
}

impl<S: Real, T: Identity + Clone + Send + Sync> Slice<S, T> {
    pub(super) fn restore(saved: Unfinished<T>, dimension: usize, previous: usize) -> Result<Self, Error> {
        let mut reader = Reader::new(&saved.state);
        let last = reader.read()?;
        let probes: Probes = reader.read()?;
        let (from, to): (usize, usize) = (reader.read()?, reader.read()?);
        let pending: Option<Pending<S>> = reader.read()?;
        let starts: Vec<S> = reader.read()?;
        let (sources, next_row) = (reader.read()?, reader.read()?);
        reader.finish()?;
        saved.check(previous, from, to)?;
        if pending
            .as_ref()
            .is_some_and(|pending| !pending.positions.len().is_multiple_of(dimension.max(1)))
            || !starts.len().is_multiple_of(dimension.max(1))
        {
            return Err(Error::State("a batch of another dimension".to_owned()));
        }
        let mut archive = saved.archive;
        if archive.len() as u64 != saved.hits
            || !saved
                .probe_only
                .iter()
                .all(|&index| archive.set_probe_only(index))
        {
            return Err(Error::State("its list of hits is not complete".to_owned()));
        }
        let mut hits = KnownHits::from(archive);
        if saved.unlisted.is_some() {
            hits.set_listed(Some(saved.listed).filter(|listed| !listed.is_empty()));
        }
        let reached = Reached {
            counts: saved.counts,
            archive: hits,
            best: BestSoFar::from(saved.best),
            trace: saved.trace,
            stop: saved.stop,
            elapsed: saved.elapsed,
        };
        let mut slice = Self::begin(&saved.budget, dimension, probes, from..to, reached);
        slice.last = last;
        slice.starts = starts;
        slice.ledger.unlisted = saved.unlisted;
        (slice.sources, slice.next_row) = (sources, next_row);
        if let Some(pending) = pending {
            slice.stage = Stage::Repeat(pending);
        }
        Ok(slice)
    }
}

impl<T> Unfinished<T> {
    /// Checks the numbers that could otherwise overflow or point beyond a list.
    fn check(&self, previous: usize, from: usize, to: usize) -> Result<(), Error> {
        let mut budget = self.budget.clone();
        // Its cancellation may have been its only limit, and a lane may have no evaluations at all.
        budget.cancel = Some(Cancel::new());
        budget.evaluations = budget.evaluations.filter(|&evaluations| evaluations > 0);
        budget.check()?;
        let counts = &self.counts;
        let counted = [
            counts.evaluations,
            counts.fitness_calls,
            counts.duplicates,
            counts.bound_calls,
        ];
        if self.elapsed > TOO_LONG {
            return Err(Error::State("its time is out of range".to_owned()));
        }
        if counted.iter().any(|&count| count > TOO_MANY) || from > to || to > previous {
            return Err(Error::State("its counts are out of range".to_owned()));
        }
        Ok(())
    }
}

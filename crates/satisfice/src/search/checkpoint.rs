//! A search saved as plain data, and resumed.

use core::time::Duration;
use std::sync::Arc;

use super::{Search, Slice};
use crate::archive::Archive;
use crate::batch::Batch;
use crate::budget::{Budget, Cancel, StopReason};
use crate::candidates::Candidates;
use crate::catalogue::Description;
use crate::engine::{ConfiguredEngine, Origin, WarmStart};
use crate::error::Error;
use crate::evaluate::Ledger;
use crate::identity::Identity;
use crate::observer::Observer;
use crate::probes::Probes;
use crate::problem::SatisficingProblem;
use crate::report::{Counts, Report, TracePoint};
use crate::scalar::Real;
use crate::state::{Reader, Saved, State};
use crate::view::{Calls, Scratches};

/// A search at one moment, as plain data: [`Search::resume`] goes on from it as if nothing had been, all but the times.
///
/// Taken at any time: between slices, between batches, and while a batch is out to be evaluated. With the feature `serde`
/// it can be written and read; numbers are kept bit by bit.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: serde::Serialize",
        deserialize = "T: serde::Deserialize<'de> + Identity"
    ))
)]
pub struct Checkpoint<T> {
    /// The version of this crate: another one may go on otherwise, and is refused.
    pub version: String,
    /// `f32` or `f64`.
    pub scalar: String,
    /// The engine and its parameters.
    pub engine: Description,
    /// The problem of the slice that has begun or ended last.
    pub problem: Option<Description>,
    /// The seed.
    pub seed: u64,
    /// The rule of warm starts, where one was set.
    pub warm_start: Option<WarmStart>,
    /// The share of probes, where one was set.
    pub probes: Option<f64>,
    /// How many slices have ended.
    pub slices: u64,
    /// Number of axes, once a slice has begun.
    pub dimension: Option<usize>,
    /// C of the slice that has ended last.
    pub previous: Arc<Archive<T>>,
    /// The slice that has begun and not ended.
    pub slice: Option<Unfinished<T>>,
    /// The random numbers' and the engine's state.
    state: State,
    /// Of both states.
    checksum: u64,
}

/// A slice that has begun and not ended.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: serde::Serialize",
        deserialize = "T: serde::Deserialize<'de> + Identity"
    ))
)]
pub struct Unfinished<T> {
    /// Its budget, without the cancellation.
    pub budget: Budget,
    /// Time so far.
    pub elapsed: Duration,
    /// Counts so far.
    pub counts: Counts,
    /// The trace so far.
    pub trace: Vec<TracePoint>,
    /// Why it has ended, where it has only to be reported. Never a cancellation: that is what is resumed from.
    pub stop: Option<StopReason>,
    /// C so far.
    pub archive: Archive<T>,
    /// |C|, to notice a list that is not complete.
    hits: u64,
    /// Members of C that only probes have found.
    hidden: Vec<u32>,
    state: State,
}

/// A batch that was proposed and not settled.
#[derive(serde::Serialize, serde::Deserialize)]
pub(super) struct Pending<S> {
    origin: Origin,
    probing: bool,
    positions: Vec<S>,
    /// Fitness of what had to be evaluated, as far as it was computed.
    computed: Vec<Option<S>>,
}

/// Where checkpoints go while a slice runs, and how often.
pub struct Saving<'a, T> {
    every: Duration,
    next: Duration,
    saved: bool,
    save: &'a mut dyn FnMut(&Checkpoint<T>),
}

impl<T> core::fmt::Debug for Saving<'_, T> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Saving")
            .field("every", &self.every)
            .finish_non_exhaustive()
    }
}

impl<'a, T> Saving<'a, T> {
    /// Calls `save` at the beginning, about every so often (and for at most a tenth of the time), when the slice is cancelled,
    /// and at its end.
    pub fn every(every: Duration, save: &'a mut dyn FnMut(&Checkpoint<T>)) -> Self {
        Self {
            every,
            next: Duration::ZERO,
            saved: false,
            save,
        }
    }

    /// The last checkpoint, unless it is the one of a cancellation.
    pub(super) fn at_the_end<S: Real>(self, search: &Search<S, T>)
    where
        T: Identity + Clone + Send + Sync,
    {
        if !self.saved {
            (self.save)(&search.checkpoint());
        }
    }
}

impl<S: Real, T: Identity + Clone + Send + Sync> Search<S, T> {
    /// The search as it is now. Cost: a copy of C and of the engine's state.
    ///
    /// ```
    /// use satisfice::{engine, from_fn, Budget, Search, Space};
    /// let problem = from_fn(Space::lattice(2, 50)?, 3.0, |x: &[f64]| x[0] + x[1]);
    /// let budget = Budget::evaluations(5000);
    /// let mut search = Search::new(engine::build("walk")?).seed(3);
    /// search.run(&problem, &budget)?;
    /// let saved = search.checkpoint();
    /// let mut resumed = Search::resume(saved, engine::build("walk")?)?;
    /// let (one, two) = (search.run(&problem, &budget)?, resumed.run(&problem, &budget)?);
    /// assert!(one.hits().map(|hit| hit.evaluation).eq(two.hits().map(|hit| hit.evaluation)));
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    #[must_use]
    pub fn checkpoint(&self) -> Checkpoint<T> {
        let mut state = State::default();
        self.rng.save(&mut state);
        self.engine.save(&mut state);
        let slice = self.slice.as_ref().map(Slice::save);
        let checksum = checksum(&state, slice.as_ref().map(|slice| &slice.state));
        Checkpoint {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            scalar: S::NAME.to_owned(),
            engine: self.description.clone(),
            problem: self.problem.clone(),
            seed: self.seed,
            warm_start: self.warm_start,
            probes: self.probes,
            slices: self.slices,
            dimension: self.dimension,
            previous: Arc::clone(&self.previous),
            slice,
            state,
            checksum,
        }
    }

    /// The search that was saved, with an engine built with the same parameters. A slice that had not ended goes on with
    /// [`run_resumed`](Search::run_resumed), or by hand; the number of [threads](Search::threads) is not saved.
    ///
    /// # Errors
    /// [`Error::State`] where version, scalar or engine are others, or the data is damaged.
    pub fn resume(checkpoint: Checkpoint<T>, engine: impl Into<ConfiguredEngine<S>>) -> Result<Self, Error> {
        let fits = |what: &str, saved: &str, now: &str| {
            if saved == now {
                Ok(())
            } else {
                Err(Error::State(format!("its {what} is {saved}, not {now}")))
            }
        };
        fits("version", &checkpoint.version, env!("CARGO_PKG_VERSION"))?;
        fits("scalar", &checkpoint.scalar, S::NAME)?;
        let mut search = Self::new(engine);
        search.configured.check()?;
        fits("engine", &named(&checkpoint.engine), &named(&search.description))?;
        let slice_state = checkpoint.slice.as_ref().map(|slice| &slice.state);
        if checkpoint.checksum != checksum(&checkpoint.state, slice_state) {
            return Err(Error::State("it is damaged".to_owned()));
        }
        let mut reader = Reader::new(&checkpoint.state);
        search.rng = reader.read()?;
        search.engine.restore(&mut reader)?;
        reader.finish()?;
        search.problem = checkpoint.problem;
        search.seed = checkpoint.seed;
        search.warm_start = checkpoint.warm_start;
        search.probes = checkpoint.probes;
        search.slices = checkpoint.slices;
        search.dimension = checkpoint.dimension;
        search.previous = checkpoint.previous;
        if let Some(slice) = checkpoint.slice {
            let dimension = search
                .dimension
                .ok_or_else(|| Error::State("a slice without axes".to_owned()))?;
            search.slice = Some(Slice::restore(slice, dimension)?);
        }
        Ok(search)
    }

    /// Runs the slice that had not ended when the search was saved to its end. Its budget is the one it began with;
    /// `cancel` takes the place of the cancellation, which is not saved.
    ///
    /// # Errors
    /// [`Error::State`] where no slice has begun or it has begun with another problem (by its
    /// [description](SatisficingProblem::description)), [`Error::SpaceChanged`], [`Error::Threshold`], [`Error::Threads`].
    pub fn run_resumed<P>(
        &mut self,
        problem: &P,
        cancel: Option<&Cancel>,
        observer: &mut dyn Observer<T>,
        saving: Option<Saving<'_, T>>,
    ) -> Result<Report<T>, Error>
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        let Some(slice) = &mut self.slice else {
            return Err(Error::State("no slice has begun".to_owned()));
        };
        if problem.threshold().is_nan() {
            return Err(Error::Threshold);
        }
        let (before, now) = (slice.batch.dimension(), problem.space().dimension());
        if before != now {
            return Err(Error::SpaceChanged { before, now });
        }
        let description = problem.description();
        if self.problem.as_ref().is_some_and(|saved| *saved != description) {
            let saved = self.problem.as_ref().map(named).unwrap_or_default();
            return Err(Error::State(format!(
                "its problem is {saved}, not {}",
                named(&description)
            )));
        }
        slice.ledger.budget.cancel = cancel.cloned();
        self.drive(problem, observer, saving)
    }

    /// Saves a batch that a cancellation has cut short before it is settled, so that it can be completed; and now and then.
    #[inline]
    pub(super) fn save_if_due(&self, saving: &mut Option<Saving<'_, T>>) {
        let (Some(saving), Some(slice)) = (saving, &self.slice) else {
            return;
        };
        let cancelled = slice.ledger.stop == Some(StopReason::Cancelled);
        let now = slice.ledger.clock.seen();
        if cancelled || (slice.ledger.stop.is_none() && now >= saving.next) {
            let begun = slice.ledger.clock.elapsed();
            (saving.save)(&self.checkpoint());
            let end = slice.ledger.clock.elapsed();
            saving.next = end.saturating_add(saving.every.max((end - begun) * 9));
            saving.saved = cancelled;
        }
    }
}

impl<S: Real, T: Identity + Clone + Send + Sync> Slice<S, T> {
    fn save(&self) -> Unfinished<T> {
        let mut counts = self.ledger.counts;
        counts.neighbour_calls = self.calls.neighbours.get();
        counts.bound_calls = self.calls.bounds.get();
        let mut state = State::default();
        self.last.save(&mut state);
        self.probes.save(&mut state);
        let pending = self.pending();
        // Hits of the slice before are proposed again from where this batch of them began.
        let again = pending.as_ref().map_or(0, |pending| match pending.origin {
            Origin::WarmStart => self.candidates.outcomes.len(),
            Origin::Engine | Origin::Exhaustion => 0,
        });
        (self.verified - again).save(&mut state);
        pending.save(&mut state);
        Unfinished {
            budget: Budget {
                cancel: None,
                ..self.ledger.budget.clone()
            },
            elapsed: self.ledger.clock.elapsed(),
            counts,
            trace: self.ledger.trace.clone(),
            stop: self.ledger.stop.filter(|&stop| stop != StopReason::Cancelled),
            archive: self.archive.clone(),
            hits: self.archive.len() as u64,
            hidden: self.archive.hidden_indices(),
            state,
        }
    }

    fn pending(&self) -> Option<Pending<S>> {
        let probing = self.candidates.probing;
        self.pending.then(|| Pending {
            // A probe's batch leaves the origin of the batch before it.
            origin: if probing { Origin::Engine } else { self.origin },
            probing,
            positions: self.batch.positions().to_vec(),
            computed: self.candidates.computed(),
        })
    }

    fn restore(saved: Unfinished<T>, dimension: usize) -> Result<Self, Error> {
        let mut reader = Reader::new(&saved.state);
        let last = reader.read()?;
        let probes: Probes = reader.read()?;
        let verified = reader.read()?;
        let resumed: Option<Pending<S>> = reader.read()?;
        reader.finish()?;
        saved.check_budget()?;
        let mut archive = saved.archive;
        if archive.len() as u64 != saved.hits || !saved.hidden.iter().all(|&index| archive.hide(index)) {
            return Err(Error::State("its list of hits is not complete".to_owned()));
        }
        let positions = resumed.as_ref().map(|pending| pending.positions.clone());
        let batch = Batch::from_positions(positions.unwrap_or_default(), dimension)
            .ok_or_else(|| Error::State("a batch of another dimension".to_owned()))?;
        let calls = Calls::default();
        calls.neighbours.set(saved.counts.neighbour_calls);
        calls.bounds.set(saved.counts.bound_calls);
        Ok(Self {
            ledger: Ledger::reopen(
                &saved.budget,
                saved.counts,
                saved.trace,
                saved.stop,
                saved.elapsed,
            ),
            archive,
            batch,
            candidates: Candidates::default(),
            probes,
            origin: Origin::Engine,
            verified,
            verify_to: usize::MAX,
            last,
            calls,
            scratches: Scratches::default(),
            outstanding: false,
            pending: false,
            pause: u64::MAX,
            resumed,
        })
    }

    /// Prepares a batch that was pending when the slice was saved.
    pub(super) fn propose_again<P>(
        &mut self,
        problem: &P,
        previous: &Archive<T>,
        pending: &Pending<S>,
        deletes: bool,
    ) where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        let limit = self.ledger.remaining();
        self.candidates.probing = pending.probing;
        if pending.origin == Origin::WarmStart {
            self.propose_previous(problem, previous, limit);
        } else {
            self.origin = pending.origin;
            let deletes = deletes || pending.probing;
            self.candidates
                .prepare(problem, &self.archive, &mut self.batch, limit, deletes);
        }
        self.candidates.resume(&pending.computed);
    }
}

impl<T> Unfinished<T> {
    /// The budget as it was checked when the slice began; its cancellation may have been all that limited it.
    fn check_budget(&self) -> Result<(), Error> {
        let mut budget = self.budget.clone();
        budget.cancel = Some(Cancel::new());
        budget.check()
    }
}

fn named(description: &Description) -> String {
    let parameters: Vec<String> = description
        .parameters
        .iter()
        .map(|(name, text)| format!("{name}={text}"))
        .collect();
    format!("{} {{{}}}", description.name, parameters.join(", "))
}

/// FNV-1a over bytes (Fowler, Noll, Vo 1991): finds damage, not malice.
fn checksum(state: &State, slice: Option<&State>) -> u64 {
    let bytes = state.0.iter().chain(slice.into_iter().flat_map(|state| &state.0));
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte))
            .wrapping_mul(0x0000_0100_0000_01b3)
            .rotate_left(29)
    })
}

//! A slice of several islands whose rounds run elsewhere: in other processes, on other machines.

use core::time::Duration;
use std::sync::Arc;

use super::Search;
use super::checkpoint::Checkpoint;
use super::driven::Driven;
use super::kept::KeptSearch;
use super::lane::RunningLane;
use super::lanes::Exchange;
use super::resume::restore;
use super::running::{Running, Turn, first_lane};
use super::stage::Stage;
use super::stepper::Stepper;
use crate::budget::{Budget, Cancel, StopReason};
use crate::engine::ConfiguredEngine;
use crate::error::Error;
use crate::identity::Identity;
use crate::observer::Observer;
use crate::problem::{AnyProblem, SatisficingProblem};
use crate::report::Report;
use crate::scalar::Real;

/// A slice of several [islands](Search::islands) that run elsewhere, round by round.
///
/// [`round`](Rounds::round) gives what each island has to do until the islands exchange their hits: plain data, which can be
/// sent to any process. There it is [run](IslandRound::run) and sent back, and [`take`](Rounds::take) enters it. A round that
/// was lost with its worker is run again from the same data, and gives the same. Under a budget of evaluations the report is
/// that of [`Search::run`], but for times, wherever the islands run.
///
/// A round is 256 evaluations of each island, then 512, then 1,024. What is sent holds the hits that all islands know and the
/// state of the island's engine; what is sent back, the hits of the round in their place.
///
/// ```
/// use satisfice::{engine, from_fn, Budget, IslandRound, Rounds, Search, Space};
///
/// let problem = from_fn(Space::lattice(2, 1000)?, 20.0, |x: &[f64]| (x[0] - 700.0).hypot(x[1] - 300.0));
/// let (search, budget) = (Search::new().islands(4).seed(7), Budget::evaluations(40_000));
/// let mut rounds = Rounds::begin(search, problem.clone(), &budget)?;
/// loop {
///     let round = rounds.round(&mut ());
///     if round.is_empty() {
///         break; // the islands have ended
///     }
///     let workers: Vec<_> = round
///         .into_iter()
///         .map(|island| {
///             let (sent, problem) = (serde_json::to_string(&island), problem.clone());
///             std::thread::spawn(move || {
///                 let island: IslandRound<_> = serde_json::from_str(&sent.expect("it is plain data"))?;
///                 Ok::<_, Box<dyn std::error::Error + Send + Sync>>(island.run(engine::default(), &problem, None)?)
///             })
///         })
///         .collect();
///     for worker in workers {
///         let island = worker.join().expect("workers do not panic").expect("the data are whole");
///         rounds.take(island)?;
///     }
/// }
/// rounds.evaluate_probes();
/// assert_eq!(rounds.finish().hit_count(), 1_245);
/// # Ok::<(), satisfice::Error>(())
/// ```
pub struct Rounds<P: SatisficingProblem + ?Sized> {
    search: Search<P>,
    problem: Arc<P>,
    running: Running<P::Scalar, P::Solution>,
    /// Whether probes are out.
    asked: bool,
    /// Whether it was ended from outside.
    ended: bool,
}

impl<P: SatisficingProblem + ?Sized> core::fmt::Debug for Rounds<P> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Rounds")
            .field("search", &self.search)
            .finish_non_exhaustive()
    }
}

/// What one island does in one round. See [`Rounds`].
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
#[serde(bound = "T: serde::Serialize + serde::de::DeserializeOwned + Identity")]
pub struct IslandRound<T> {
    /// Which island it is, from 0.
    island: usize,
    /// Evaluations of the island at the end of the round.
    until: u64,
    /// The island as a search of its own.
    state: Checkpoint<T>,
}

impl<T: Identity + Clone + Send + Sync> IslandRound<T> {
    /// Which island it is, from 0.
    #[must_use]
    pub fn island(&self) -> usize {
        self.island
    }

    /// The same round, of a slice that has run for so long: to be set when it is sent, under a budget of time.
    #[must_use]
    pub fn at(mut self, elapsed: Duration) -> Self {
        if let Some(slice) = &mut self.state.contents.unfinished {
            slice.elapsed = elapsed;
        }
        self
    }

    /// The island as a search that pauses at the end of the round: [`Search::start_resumed`] gives its points until then, and
    /// [`done`](IslandRound::done) takes it after them. `engine` is that of the search.
    ///
    /// # Errors
    /// As [`Search::resume`].
    pub fn search<P>(&self, engine: impl Into<ConfiguredEngine<P::Scalar>>) -> Result<Search<P>, Error>
    where
        P: SatisficingProblem<Solution = T> + ?Sized,
    {
        let mut search = Search::resume(self.state.clone(), engine)?;
        let lane = first_lane(&mut search.kept.unfinished);
        let lane = lane.ok_or_else(|| Error::State("no round has begun".to_owned()))?;
        lane.slice.pause = self.until;
        Ok(search)
    }

    /// The round after its end: when [`ask`](Stepper::ask) gives nothing more, or, with the fitness of the first candidates that it
    /// gave, when the time is up.
    ///
    /// # Errors
    /// [`Error::Tell`] for more values than candidates.
    pub fn done<P>(self, mut stepper: Stepper<'_, P>, fitness: &[P::Scalar]) -> Result<Self, Error>
    where
        P: SatisficingProblem<Solution = T> + ?Sized,
    {
        if !fitness.is_empty() || stepper.driven.is_out() {
            stepper.driven.end_with(&stepper.problem, fitness)?;
            let lane = first_lane(&mut stepper.driven.running);
            if let Some(lane) = lane {
                lane.slice.ledger.stop = Some(StopReason::Time);
            }
        }
        let mut state = stepper.checkpoint();
        if let Some(slice) = &mut state.contents.unfinished {
            slice.listed = Arc::default(); // whoever takes the round has them
        }
        Ok(Self { state, ..self })
    }

    /// Runs the round on the calling thread. `engine` and `problem` are those of the search.
    ///
    /// # Errors
    /// As [`Search::resume`] and [`Search::run_resumed`]; [`Error::State`] if it was cancelled.
    pub fn run<P>(
        self,
        engine: impl Into<ConfiguredEngine<P::Scalar>>,
        problem: &P,
        cancel: Option<&Cancel>,
    ) -> Result<Self, Error>
    where
        P: SatisficingProblem<Solution = T> + ?Sized,
    {
        let mut search = self.search::<P>(engine)?;
        let mut stepper = match cancel {
            Some(cancel) => search.start_resumed_until(problem, cancel)?,
            None => search.start_resumed(problem)?,
        };
        stepper.driven.run_to_pause(&stepper.problem);
        if cancel.is_some_and(Cancel::is_cancelled) {
            return Err(Error::State("the round was cancelled".to_owned()));
        }
        self.done(stepper, &[])
    }
}

impl<P: SatisficingProblem + ?Sized> Rounds<P> {
    /// Begins the slice.
    ///
    /// # Errors
    /// As [`Search::run`]; [`Error::Parameter`] for a search of one island.
    pub fn begin(mut search: Search<P>, problem: impl Into<Arc<P>>, budget: &Budget) -> Result<Self, Error> {
        if search.kept.islands < 2 {
            return Err(Error::parameter(
                "islands",
                search.kept.islands,
                "at least 2 to run in rounds",
            ));
        }
        let problem = problem.into();
        let running = search.kept.start(&&*problem, budget)?;
        Ok(Self {
            search,
            problem,
            running,
            asked: false,
            ended: false,
        })
    }

    /// Continues a slice of several islands that was saved, wherever these ran.
    ///
    /// # Errors
    /// As [`Search::resume`] and [`Search::run_resumed`].
    pub fn resume(
        checkpoint: Checkpoint<P::Solution>,
        engine: impl Into<ConfiguredEngine<P::Scalar>>,
        problem: impl Into<Arc<P>>,
    ) -> Result<Self, Error> {
        let problem = problem.into();
        let mut search = Search::<P>::resume(checkpoint, engine)?;
        search.kept.check_saved(&&*problem)?;
        let running = search
            .kept
            .unfinished
            .take()
            .filter(|running| running.exchange.is_some());
        let running =
            running.ok_or_else(|| Error::State("no slice of several islands has begun".to_owned()))?;
        search.kept.resumed = false;
        Ok(Self {
            search,
            problem,
            running,
            asked: false,
            ended: false,
        })
    }

    /// What the islands have to do: those that have not reached the exchange. If all have, they exchange their hits, of which
    /// the observer is told, and begin the next round. None once the islands have ended.
    ///
    /// Cost: a copy of the state of each island's engine, and of its hits since the last exchange.
    pub fn round(&mut self, observer: &mut dyn Observer<P::Solution>) -> Vec<IslandRound<P::Solution>> {
        let Running {
            lanes,
            exchange: Some(exchange),
        } = &mut self.running
        else {
            return Vec::new();
        };
        while exchange.is_searching() && exchange.is_due(lanes) {
            exchange.between_rounds(lanes, observer);
        }
        if !exchange.is_searching() {
            return Vec::new();
        }
        let elapsed = exchange.common.ledger.clock.elapsed();
        let due = lanes.iter().enumerate();
        let due = due.filter(|(_, lane)| !Exchange::is_due(exchange, core::slice::from_ref(*lane)));
        due.map(|(island, lane)| {
            let mut state = self.search.kept.save(None);
            state.contents.islands = 1;
            state.contents.lanes = vec![lane.lane.save()];
            state.contents.unfinished = Some(lane.slice.save());
            let until = lane.slice.pause;
            IslandRound { island, until, state }.at(elapsed)
        })
        .collect()
    }

    /// Enters a round that was run.
    ///
    /// # Errors
    /// [`Error::State`] for an island that there is not, or for a round that has not come to its end or is not one of this
    /// search; errors of [`Search::resume`].
    pub fn take(&mut self, done: IslandRound<P::Solution>) -> Result<(), Error> {
        let misfit = || Error::State("the round does not fit the search".to_owned());
        let (_, saved, lanes) = KeptSearch::resume_parts(done.state, self.search.kept.engine.clone())?;
        let lane = restore(saved, lanes)?.lanes.into_iter().next();
        let mut lane: RunningLane<_, _> = lane.ok_or_else(misfit)?;
        lane.slice.pause = done.until;
        let Some(exchange) = &self.running.exchange else {
            return Err(misfit());
        };
        let place = self.running.lanes.get_mut(done.island).ok_or_else(misfit)?;
        let fits = exchange.is_searching()
            && place.slice.pause == done.until
            && exchange.is_due(core::slice::from_ref(&lane))
            && lane.slice.ledger.archive.found().len() >= place.slice.ledger.archive.found().len();
        if !fits {
            return Err(misfit());
        }
        let listed = place.slice.ledger.archive.listed().cloned();
        lane.slice.ledger.archive.set_listed(listed);
        *place = lane;
        Ok(())
    }

    /// Uniform probes to evaluate after the islands have ended; none while these have rounds to run, or when the slice is over.
    pub fn ask_probes(&mut self) -> &[P::Solution] {
        let Some(exchange) = &mut self.running.exchange else {
            return &[];
        };
        while !self.asked && !self.ended && exchange.propose_probes(&&*self.problem) {
            let common = &mut exchange.common;
            if let Stage::Settle(from) = common.stage {
                common.stage = Stage::Asked(from);
            }
            if common.candidates.live().is_empty() {
                common
                    .ledger
                    .evaluated_elsewhere(common.candidates.outcomes.len());
                exchange.settle_probes(&&*self.problem, &mut ());
            } else {
                self.asked = true;
            }
        }
        if self.asked {
            exchange.common.candidates.live()
        } else {
            &[]
        }
    }

    /// Tells the fitness of what [`ask_probes`](Rounds::ask_probes) gave, in its order.
    ///
    /// # Errors
    /// [`Error::Tell`] if nothing was asked, or for another number of values.
    pub fn tell_probes(&mut self, fitness: &[P::Scalar]) -> Result<(), Error> {
        let exchange = self.running.exchange.as_mut().filter(|_| self.asked);
        let Some(exchange) = exchange else {
            return Err(Error::Tell {
                wanted: 0,
                got: fitness.len(),
            });
        };
        let common = &mut exchange.common;
        common.candidates.take_fitness(fitness)?;
        common.ledger.evaluated_elsewhere(fitness.len());
        self.asked = false;
        exchange.settle_probes(&&*self.problem, &mut ());
        Ok(())
    }

    /// Evaluates all probes here.
    pub fn evaluate_probes(&mut self) {
        loop {
            let probes = self.ask_probes().to_vec();
            if probes.is_empty() {
                return;
            }
            let values: Vec<_> = probes.iter().map(|probe| self.problem.fitness(probe)).collect();
            if self.tell_probes(&values).is_err() {
                return;
            }
        }
    }

    /// Ends the slice for a reason from outside, with what the islands had found in the rounds that were taken.
    pub fn end(&mut self, reason: StopReason) {
        self.asked = false;
        self.ended = true;
        if let Some(exchange) = &mut self.running.exchange {
            exchange.common.stage = Stage::Propose;
        }
        self.running.end(reason);
    }

    /// The search and the slice as they are now; rounds that are out are run again after resuming.
    #[must_use]
    pub fn checkpoint(&self) -> Checkpoint<P::Solution> {
        self.search.kept.save(Some(&self.running))
    }

    /// The slice as it is, without its hits.
    #[must_use]
    pub fn progress(&self) -> crate::report::TracePoint {
        let ledger = &self.running.reported().ledger;
        crate::report::TracePoint {
            evaluations: ledger.counts.evaluations,
            elapsed_seconds: ledger.clock.elapsed().as_secs_f64(),
            hits: ledger.archive.len() as u64,
        }
    }

    /// Ends the slice and reports. One that is not over counts as cancelled.
    #[must_use]
    pub fn finish(mut self) -> Report<P::Solution> {
        self.search.kept.report(&&*self.problem, self.running)
    }
}

impl<S: Real, T: Identity + Clone + Send + Sync> Driven<'_, S, T> {
    /// Whether a batch is out.
    fn is_out(&self) -> bool {
        self.turn != Turn::Over
    }

    /// Runs the only lane until it pauses or the slice is over.
    fn run_to_pause(&mut self, problem: &AnyProblem<'_, S, T>) {
        let previous = Arc::clone(&self.kept.previous);
        if let Some(lane) = first_lane(&mut self.running) {
            lane.advance(problem, &previous, None);
        }
        self.turn = Turn::Over;
    }
}

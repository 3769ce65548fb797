//! Islands: several engines side by side on one problem, each with a share of the budget, which share the hits they find.

use std::sync::Arc;

use super::Search;
use crate::batch::{Batch, Outcome};
use crate::budget::{Budget, StopReason};
use crate::context::Context;
use crate::engine::{Ask, ConfiguredEngine, Engine, Origin, WarmStart};
use crate::error::Error;
use crate::identity::Identity;
use crate::observer::Observer;
use crate::problem::SatisficingProblem;
use crate::report::{Counts, Report};
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::state::{Reader, State};
use crate::threads::Threads;

/// Evaluations of an island before the first exchange of hits; then twice as many, and so on.
const FIRST_ROUND: u64 = 256;
/// The most of them: enough that threads spend their time searching, few enough that little is found twice.
const LONGEST_ROUND: u64 = 1024;

/// Islands: several engines side by side on one problem, each with an equal share of the evaluations, which share
/// the hits they find: one island's hits are deleted for all. For a fitness so cheap that a single engine cannot keep more than one thread busy.
///
/// The number of islands is part of the search, like a seed; on how many [threads](Islands::threads) they live is not: under
/// a budget of evaluations the report is the same. A hit enters C when the islands exchange, after 256 evaluations of each
/// of them, then 512, then every 1,024, and carries the evaluation count and the time of the exchange. Every island keeps a C of
/// its own, so memory grows with their number. Seeds are streams of one seed; the first island's is that of a plain [`Search`].
///
/// Bounds, neighbours, warm starts and budgets work as in a [`Search`]; uniform probes, where an engine wants any, come at the
/// end, after the engines. There are no checkpoints.
///
/// ```
/// use satisfice::{engine, from_fn, Budget, Islands, Space};
///
/// // The 1,245 lattice points of a disc, among a million.
/// let problem = from_fn(Space::lattice(2, 1000)?, 20.0, |x: &[f64]| (x[0] - 700.0).hypot(x[1] - 300.0));
/// let mut islands = Islands::new(4, || engine::build("portfolio"))?.seed(7).threads(2);
/// let report = islands.run(&problem, &Budget::evaluations(40_000))?;
/// assert_eq!(report.hit_count(), 1_245);
/// # Ok::<(), satisfice::Error>(())
/// ```
pub struct Islands<S, T> {
    /// Keeps the books and the common C; its own engine never proposes anything.
    common: Search<S, T>,
    islands: Vec<Search<S, T>>,
    warm_start: Option<WarmStart>,
    probes: Option<f64>,
    /// What the islands have found twice each by itself, as of the last exchange.
    duplicates: u64,
    /// How many of the hits in each island's own C are known to all.
    told: Vec<usize>,
}

impl<S: Real, T: Identity + Clone + Send + Sync> Islands<S, T> {
    /// So many islands, with an engine each.
    ///
    /// # Errors
    /// [`Error::Parameter`] for no islands at all or more than 65,536, and any error of `build`.
    pub fn new(
        count: usize,
        mut build: impl FnMut() -> Result<ConfiguredEngine<S>, Error>,
    ) -> Result<Self, Error> {
        if !(1..=65_536).contains(&count) {
            return Err(Error::parameter("islands", count, "a number from 1 to 65536"));
        }
        let islands = (0..count)
            .map(|_| Ok(Search::new(build()?)))
            .collect::<Result<Vec<_>, Error>>()?;
        let mut common = Search::new(ConfiguredEngine::custom(&islands[0].description.name, || {
            NoEngine
        }));
        common.description = islands[0].description.clone();
        let shown = ("islands".to_owned(), count.to_string());
        common.description.parameters.push(shown);
        Ok(Self {
            common,
            islands,
            warm_start: None,
            probes: None,
            duplicates: 0,
            told: Vec::new(),
        }
        .seed(0))
    }

    /// The seed, 0 by default.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Self {
        self.common = self.common.seed(seed);
        for (stream, island) in (0..).zip(&mut self.islands) {
            island.seed = seed;
            island.rng = SearchRng::stream(seed, stream);
        }
        self
    }

    /// On how many threads the islands live, 1 by default, 0 for as many as there are cores; more than islands are of no use.
    /// Needs the feature `rayon`; without it one thread works.
    #[must_use]
    pub fn threads(mut self, threads: usize) -> Self {
        self.common = self.common.threads(threads);
        self
    }

    /// As [`Search::warm_start`]. Hits of the slice before are shared out, and each is verified by one island.
    #[must_use]
    pub fn warm_start(mut self, rule: WarmStart) -> Self {
        self.warm_start = Some(rule);
        self
    }

    /// As [`Search::probes`], but all of them at the end.
    #[must_use]
    pub fn probes(mut self, share: f64) -> Self {
        self.probes = Some(share);
        self
    }

    /// Forgets the hits so far: the next slice starts cold.
    pub fn clear(&mut self) {
        self.common.clear();
    }

    /// Runs one time slice on `problem`.
    ///
    /// # Errors
    /// As [`Search::run`].
    pub fn run<P>(&mut self, problem: &P, budget: &Budget) -> Result<Report<T>, Error>
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        self.run_observed(problem, budget, &mut ())
    }

    /// The same while somebody watches: told of hits and of progress at every exchange.
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
        let share = self.begin(problem, budget)?;
        let threads = match self.common.pool.take() {
            Some(threads) => threads,
            None => Threads::new(self.common.threads)?,
        };
        let (mut round, mut until) = (FIRST_ROUND, 0);
        loop {
            until += round;
            round = (2 * round).min(LONGEST_ROUND);
            threads.for_each(self.islands.iter_mut(), |island| {
                island.advance_until(problem, until);
            });
            let over = self.exchange(observer);
            let covered = |island: &Search<S, T>| island.stop() == Some(StopReason::Covered);
            let islands = &self.islands;
            if over || islands.iter().any(covered) || islands.iter().all(|island| island.stop().is_some()) {
                break;
            }
        }
        let reason = self.close(problem)?;
        self.common.pool = Some(threads);
        self.probe(problem, share, reason, observer);
        self.common.finish(problem)
    }

    /// Begins the slice everywhere; returns the share of probes.
    fn begin<P>(&mut self, problem: &P, budget: &Budget) -> Result<f64, Error>
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        self.duplicates = 0;
        self.told = vec![0; self.islands.len()];
        let first = &self.islands[0].engine;
        let rule = self.warm_start.unwrap_or_else(|| first.warm_start());
        let share = self.probes.unwrap_or_else(|| first.probes());
        self.common.warm_start = Some(rule);
        self.common.probes = Some(share);
        self.common.begin(problem, budget)?;
        let previous = Arc::clone(&self.common.previous);
        let count = self.islands.len();
        // What is spent on probes in the end.
        let engines = budget
            .evaluations
            .map(|all| all - probes_of(all, share).min(all.saturating_sub(1)));
        for (i, island) in self.islands.iter_mut().enumerate() {
            island.slice = None;
            let mut own = budget.clone();
            if let Some(all) = engines {
                let own_share = all / count as u64 + u64::from((i as u64) < all % count as u64);
                if own_share == 0 {
                    continue; // fewer evaluations than islands
                }
                own.evaluations = Some(own_share);
            }
            own.horizon = budget.horizon.map(|all| all.div_ceil(count as u64));
            own.time = budget
                .time
                .map(|time| time.mul_f64(1.0 - share).max(core::time::Duration::from_nanos(1)));
            island.warm_start = Some(rule);
            island.probes = Some(0.0);
            island.previous = Arc::clone(&previous);
            island.begin(problem, &own)?;
            if let (Some(slice), WarmStart::Verify) = (&mut island.slice, rule) {
                slice.verified = i * previous.len() / count;
                slice.verify_to = (i + 1) * previous.len() / count;
            }
        }
        Ok(share)
    }

    /// Moves the islands' new hits into the common C, in the order of the islands, and from there into those of the
    /// others. Returns
    /// whether that was the last exchange, by the common limits or an observer's word.
    fn exchange(&mut self, observer: &mut dyn Observer<T>) -> bool {
        let Some(common) = &mut self.common.slice else {
            return true;
        };
        // What two islands have found at the same time counts as found twice.
        let twice = common.ledger.counts.duplicates - self.duplicates;
        let mut counts = total(&self.islands);
        self.duplicates = counts.duplicates;
        counts.duplicates += twice;
        common.ledger.take_over(counts, &common.archive, observer);
        let known = common.archive.len();
        let mut finders = Vec::new();
        for (i, island) in self.islands.iter().enumerate() {
            let Some(slice) = &island.slice else { continue };
            for solution in &slice.archive.solutions()[self.told[i]..] {
                if common.ledger.is_closed_to_hits() {
                    return true;
                }
                if common.ledger.enter(solution, &mut common.archive, observer) {
                    finders.push(i);
                }
            }
        }
        // The engines are not told, but what others have found is deleted for them: whoever finds a cluster exhausts it.
        // With engines that were told, each exhausted what all had found.
        let news = &common.archive.solutions()[known..];
        for (i, island) in self.islands.iter_mut().enumerate() {
            let Some(slice) = &mut island.slice else { continue };
            let (now, seconds) = (
                slice.ledger.counts.evaluations,
                slice.ledger.clock.seen().as_secs_f64(),
            );
            for (solution, &finder) in news.iter().zip(&finders) {
                if finder != i {
                    slice.archive.insert(solution.clone(), now, seconds);
                }
            }
            self.told[i] = slice.archive.len();
        }
        common.ledger.is_closed_to_hits()
    }

    /// Ends the islands' slices; returns why.
    fn close<P>(&mut self, problem: &P) -> Result<StopReason, Error>
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        use StopReason::{Cancelled, Covered, Evaluations, Hits, Observer, Time};
        let mut reasons = Vec::new();
        let mut sum = Counts::default();
        for island in &mut self.islands {
            if island.slice.is_some() {
                let report = island.finish(problem)?;
                sum += report.counts;
                reasons.push(report.stop_reason);
            }
        }
        if let Some(common) = &mut self.common.slice {
            common.calls.neighbours.set(sum.neighbour_calls);
            common.calls.bounds.set(sum.bound_calls);
            common.ledger.counts.bound_calls = sum.bound_calls;
            if let Some(reason @ (Hits | Observer)) = common.ledger.stop {
                return Ok(reason);
            }
        }
        // One that has covered the space has done so for all.
        let order = [Covered, Cancelled, Time, Evaluations, Hits];
        let reason = order.into_iter().find(|reason| reasons.contains(reason));
        Ok(reason.unwrap_or(StopReason::Exhausted))
    }

    /// Makes the probes, on the common C, and says why the slice has ended.
    fn probe<P>(&mut self, problem: &P, share: f64, reason: StopReason, observer: &mut dyn Observer<T>)
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        let Self { common, .. } = self;
        let Some(spent) = common.slice.as_ref().map(|slice| slice.ledger.counts.evaluations) else {
            return;
        };
        let wanted = match reason {
            StopReason::Evaluations if share > 0.0 => u64::MAX, // all that was kept for them
            StopReason::Evaluations | StopReason::Time | StopReason::Exhausted => {
                probes_of(spent, share / (1.0 - share))
            }
            _ => 0,
        };
        while let (Some(slice), Some(pool)) = (&mut common.slice, &common.pool) {
            slice.ledger.stop = None;
            let made = slice.probes.count();
            if made >= wanted || slice.ledger.is_over() {
                slice.ledger.stop = Some(reason);
                return;
            }
            slice.candidates.probing = true;
            slice.probes.propose(problem, &mut slice.batch);
            slice
                .batch
                .truncate(usize::try_from(wanted - made).unwrap_or(usize::MAX));
            slice.prepare(problem, true);
            slice.ledger.evaluate(problem, &mut slice.candidates, pool);
            common.settle(problem, observer);
        }
    }
}

impl<S: Real, T: Identity + Clone + Send + Sync> Search<S, T> {
    /// Goes on with the slice until it is over or has made so many evaluations.
    fn advance_until<P>(&mut self, problem: &P, evaluations: u64)
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        if let Some(slice) = &mut self.slice {
            slice.pause = evaluations;
        }
        let threads = Threads::default();
        while self.propose(problem, Some(&mut ())) {
            if let Some(slice) = &mut self.slice {
                slice.ledger.evaluate(problem, &mut slice.candidates, &threads);
            }
            self.settle(problem, &mut ());
        }
    }

    /// Why the slice has ended, where it has; one that has not begun has spent what it had.
    fn stop(&self) -> Option<StopReason> {
        match &self.slice {
            Some(slice) => slice.ledger.stop,
            None => Some(StopReason::Evaluations),
        }
    }
}

/// What the ledgers of all islands have counted.
fn total<S, T>(islands: &[Search<S, T>]) -> Counts {
    let slices = islands.iter().filter_map(|island| island.slice.as_ref());
    slices.fold(Counts::default(), |mut sum, slice| {
        sum += slice.ledger.counts;
        sum
    })
}

/// This share of so many evaluations, rounded up.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "not negative, and a conversion from float saturates"
)]
fn probes_of(evaluations: u64, share: f64) -> u64 {
    (evaluations as f64 * share).ceil() as u64
}

/// In the place of the engine where only books are kept.
pub(super) struct NoEngine;

impl<S: Real> Engine<S> for NoEngine {
    fn begin(&mut self, _: &dyn Context<S>) {}
    fn ask(&mut self, _: &dyn Context<S>, _: &mut SearchRng, _: &mut Batch<S>) -> Ask {
        Ask::Exhausted
    }
    fn tell(&mut self, _: &dyn Context<S>, _: &Batch<S>, _: &[Outcome<S>], _: Origin) {}
    fn save(&self, _: &mut State) {}
    fn restore(&mut self, _: &mut Reader<'_>) -> Result<(), Error> {
        Ok(())
    }
}

#[cfg(test)]
#[path = "islands_tests.rs"]
mod tests;

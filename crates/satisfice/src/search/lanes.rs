//! Several lanes: how they share the budget, exchange their hits, and end together.
//!
//! A hit enters the archive when the lanes exchange, after 256 evaluations of each of them, then 512, then every 1,024. Between
//! two exchanges lanes know nothing of each other, so the number of threads they run on changes nothing.
//!
//! Two lanes may meanwhile find hits that are the same answer without being the same as the same solutions, as points within a radius of
//! each other. The first is listed, and the lane of the other one forgets its own. What that lane had rejected because of it is listed
//! unless it is the same as a listed hit; but what it had covered by it is not covered, and the lane proves nothing from then on. The
//! first lane never forgets a hit, since its hits come first.

use core::ops::Range;
use core::time::Duration;
use std::sync::Arc;

use super::lane::RunningLane;
use super::slice::Slice;
use super::stage::{BatchSource, Stage};
use crate::accounting::Unlisted;
use crate::budget::{Budget, StopReason};
use crate::identity::Identity;
use crate::observer::Observer;
use crate::problem::AnyProblem;
use crate::report::Counts;
use crate::scalar::Real;
use crate::threads::{Items, Threads};

/// Evaluations of a lane before the first exchange; then twice as many, and so on.
const FIRST_ROUND: u64 = 256;
/// The most of them: enough that threads spend their time searching, few enough that little is found twice.
const LONGEST_ROUND: u64 = 1024;

/// What several lanes have in common.
pub(super) struct Exchange<S, T> {
    /// The accounts and the archive of all lanes; probes are made here, after the lanes.
    pub(super) common: Slice<S, T>,
    pub(super) progress: LanesProgress,
}

/// How far the lanes are.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(super) struct LanesProgress {
    /// Evaluations of each lane before the next exchange, and in the round after it.
    until: u64,
    next_round: u64,
    /// Whether all hits that each lane has found are listed, so that what it has covered is covered.
    proves: Vec<bool>,
    /// Duplicates counted by the lanes themselves, as of the last exchange.
    duplicates: u64,
    /// Why the lanes have ended, once they have.
    ended: Option<StopReason>,
}

impl LanesProgress {
    pub(super) fn new(lanes: usize) -> Self {
        Self {
            until: FIRST_ROUND,
            next_round: 2 * FIRST_ROUND,
            proves: vec![true; lanes],
            duplicates: 0,
            ended: None,
        }
    }

    pub(super) fn until(&self) -> u64 {
        self.until
    }

    /// The progress to resume from: what was cancelled goes on.
    pub(super) fn to_go_on(&self) -> Self {
        Self {
            ended: self.ended.filter(|&reason| reason != StopReason::Cancelled),
            ..self.clone()
        }
    }

    /// Whether it fits a search of so many lanes.
    pub(super) fn fits(&self, lanes: usize) -> bool {
        self.proves.len() == lanes
    }
}

/// The budget of lane `lane` of `count`, under a share of probes.
pub(super) fn share_of(budget: &Budget, lane: usize, count: usize, probes: f64) -> Budget {
    let (lane, count) = (lane as u64, count as u64);
    let mut own = budget.clone();
    own.evaluations = budget.evaluations.map(|all| {
        let engines = all - probes_of(all, probes).min(all.saturating_sub(1));
        engines / count + u64::from(lane < engines % count)
    });
    own.patience = None; // that of all lanes together
    own.horizon = budget.horizon.map(|all| all.div_ceil(count));
    own.time = budget.time.map(|time| match probes == 0.0 {
        true => time,
        // a share above 0 leaves no more than can be told
        false => time.mul_f64(1.0 - probes).max(Duration::from_nanos(1)),
    });
    own
}

/// The hits of the slice before, of so many, that lane `lane` of `count` verifies.
pub(super) fn verified_by(lane: usize, count: usize, hits: usize) -> Range<usize> {
    lane * hits / count..(lane + 1) * hits / count
}

impl<S: Real, T: Identity + Clone + Send + Sync> Exchange<S, T> {
    /// Whether the lanes are still at work.
    pub(super) fn is_searching(&self) -> bool {
        self.progress.ended.is_none()
    }

    /// Runs the lanes, side by side on the threads, up to the next exchange, or until `keep` has passed.
    pub(super) fn run_round(
        &self,
        lanes: &mut [RunningLane<S, T>],
        problem: &AnyProblem<'_, S, T>,
        previous: &crate::archive::Archive<T>,
        threads: &Threads,
        keep: Option<Duration>,
    ) {
        // A round is hundreds of evaluations.
        threads.for_each(lanes.iter_mut(), Items::Long, |lane| {
            lane.advance(problem, previous, keep);
        });
    }

    /// Whether all lanes have reached the exchange.
    pub(super) fn is_due(&self, lanes: &[RunningLane<S, T>]) -> bool {
        lanes.iter().all(|lane| {
            let slice = &lane.slice;
            matches!(slice.stage, Stage::Propose)
                && (slice.ledger.stop.is_some() || slice.ledger.counts.evaluations >= slice.pause)
        })
    }

    /// Exchanges hits, and begins the next round or ends the search of the lanes.
    pub(super) fn between_rounds(&mut self, lanes: &mut [RunningLane<S, T>], observer: &mut dyn Observer<T>) {
        let over = self.exchange(lanes, observer);
        self.common.ledger.correct_trace();
        let stops = || lanes.iter().map(|lane| lane.slice.ledger.stop);
        let covered = stops().any(|stop| stop == Some(StopReason::Covered));
        if over || covered || stops().all(|stop| stop.is_some()) {
            self.progress.ended = Some(self.end(lanes));
            return;
        }
        self.progress.until = self.progress.until.saturating_add(self.progress.next_round);
        self.progress.next_round = (2 * self.progress.next_round).min(LONGEST_ROUND);
        self.share(lanes.iter_mut().map(|lane| &mut lane.slice));
        for lane in lanes {
            lane.slice.pause = self.progress.until;
        }
    }

    /// Moves the lanes' new hits into the common archive, in the order of the lanes. Returns whether that was the last exchange, by
    /// the common limits or by an observer.
    fn exchange(&mut self, lanes: &mut [RunningLane<S, T>], observer: &mut dyn Observer<T>) -> bool {
        let (common, progress) = (&mut self.common, &mut self.progress);
        // Hits that two lanes have found at the same time count as found twice.
        let twice = common
            .ledger
            .counts
            .duplicates
            .saturating_sub(progress.duplicates);
        let mut counts = total(lanes.iter().map(|lane| lane.slice.ledger.counts));
        progress.duplicates = counts.duplicates;
        counts.duplicates += twice;
        common.ledger.sync_counts(counts, observer);
        common.record_sources(lanes.iter().map(|lane| lane.lane.engine.sources()));
        // Until they are handed out again, nobody else holds the hits that are listed.
        for lane in lanes.iter_mut() {
            lane.slice.ledger.archive.set_listed(None);
        }
        common.ledger.archive.take_back();
        let listed = self.list_found(lanes, observer);
        let Some(forgets) = listed.filter(|_| self.list_rejected(lanes, observer)) else {
            return true;
        };
        let common = &mut self.common.ledger;
        common.stop_if_stale();
        let over = common.stops_before_more();
        for (i, lane) in lanes.iter_mut().enumerate() {
            let ledger = &mut lane.slice.ledger;
            self.progress.proves[i] &= !forgets[i];
            if !self.progress.proves[i] && ledger.stop == Some(StopReason::Covered) {
                ledger.stop = Some(StopReason::Exhausted);
            }
            // It had as many hits as are wanted, but not all of them are listed.
            if !over && ledger.stop == Some(StopReason::Hits) {
                ledger.stop = None;
            }
            ledger.archive.clear_found();
            ledger.unlisted = Some(Unlisted::nothing());
        }
        over
    }

    /// Lets the lanes know of all hits that are listed. The engines are not told, but hits of other lanes are deleted for them: the lane
    /// that finds a cluster searches it. When engines were told, each lane searched around the hits of all.
    pub(super) fn share<'a>(&mut self, lanes: impl Iterator<Item = &'a mut Slice<S, T>>)
    where
        S: 'a,
        T: 'a,
    {
        let listed = self.common.ledger.archive.share();
        for lane in lanes {
            lane.ledger.archive.set_listed(Some(Arc::clone(&listed)));
        }
    }

    /// Lists what the lanes have found. Returns which of the lanes have found a hit that is not listed; `None` at the limits.
    fn list_found(
        &mut self,
        lanes: &[RunningLane<S, T>],
        observer: &mut dyn Observer<T>,
    ) -> Option<Vec<bool>> {
        let common = &mut self.common.ledger;
        let mut forgets = vec![false; lanes.len()];
        for (i, lane) in lanes.iter().enumerate() {
            let ledger = &lane.slice.ledger;
            if let Some(best) = ledger.best.get() {
                common.offer_from_lane(best);
            }
            for hit in ledger.archive.found().iter() {
                if common.stops_before_more() {
                    return None;
                }
                if !common.insert_from_lane(hit.solution, hit.fitness, observer) {
                    common.counts.duplicates += 1;
                    forgets[i] |= !common.archive.all().holds(hit.solution);
                }
            }
        }
        Some(forgets)
    }

    /// Lists what the lanes have rejected, where nothing listed is the same; `false` at the limits.
    fn list_rejected(&mut self, lanes: &mut [RunningLane<S, T>], observer: &mut dyn Observer<T>) -> bool {
        let common = &mut self.common.ledger;
        for lane in lanes {
            let ledger = &mut lane.slice.ledger;
            let unlisted = ledger.unlisted.as_mut();
            let rejected = unlisted.map(|unlisted| core::mem::take(&mut unlisted.rejected));
            for (solution, fitness) in rejected.into_iter().flatten() {
                if common.stops_before_more() {
                    return false;
                }
                if common.insert_from_lane(&solution, fitness, observer) {
                    // The lane has counted it as found twice; a crafted checkpoint may not have.
                    let counts = [
                        &mut ledger.counts.duplicates,
                        &mut common.counts.duplicates,
                        &mut self.progress.duplicates,
                    ];
                    for count in counts {
                        *count = count.saturating_sub(1);
                    }
                }
            }
        }
        true
    }

    /// Ends the lanes; returns why.
    fn end(&mut self, lanes: &[RunningLane<S, T>]) -> StopReason {
        use StopReason::{Cancelled, Covered, Evaluations, Hits, Observer, Panicked, Patience, Time};
        let sum = total(lanes.iter().map(|lane| lane.slice.counts()));
        let common = &mut self.common;
        common.calls.neighbours.set(sum.neighbour_calls);
        common.calls.bounds.set(sum.bound_calls);
        common.ledger.counts.bound_calls = sum.bound_calls;
        if let Some(reason @ (Hits | Observer | Patience)) = common.ledger.stop {
            return reason;
        }
        // A lane that has covered the space has covered it for all.
        let order = [Covered, Panicked, Cancelled, Time, Evaluations, Hits];
        let has = |reason| lanes.iter().any(|lane| lane.slice.ledger.stop == Some(reason));
        let reason = order.into_iter().find(|&reason| has(reason));
        reason.unwrap_or(StopReason::Exhausted)
    }

    /// Proposes the next probes in the common archive; `false`, with the reason in the accounts, if the slice is over.
    pub(super) fn propose_probes(&mut self, problem: &AnyProblem<'_, S, T>) -> bool {
        let Some(reason) = self.progress.ended else {
            return false;
        };
        let common = &mut self.common;
        if let Stage::Repeat(pending) = core::mem::replace(&mut common.stage, Stage::Propose) {
            common.propose_again(problem, &crate::archive::Archive::default(), pending, true);
            return true;
        }
        let share = common.probes.share();
        let made = common.probes.count();
        let searched = common.ledger.counts.evaluations - made;
        let wanted = match reason {
            StopReason::Evaluations if share > 0.0 => u64::MAX, // all that was kept for them
            StopReason::Evaluations | StopReason::Time | StopReason::Exhausted => {
                probes_of(searched, share / (1.0 - share))
            }
            _ => 0,
        };
        common.ledger.stop = None;
        if made >= wanted || common.ledger.is_over() {
            // Cancelled, the slice can be resumed; all other limits come too late to change the reason.
            if common.ledger.stop != Some(StopReason::Cancelled) {
                common.ledger.stop = Some(reason);
            }
            return false;
        }
        let most = usize::try_from(wanted - made).unwrap_or(usize::MAX);
        common.propose_probes(problem, most);
        true
    }

    /// Ends the slice where the time ended the search of the lanes: there is none left for probes. After other limits there is.
    pub(super) fn end_if_late(&mut self) {
        if self.progress.ended == Some(StopReason::Time) {
            self.common.ledger.stop.get_or_insert(StopReason::Time);
        }
    }

    /// Settles a batch of probes.
    pub(super) fn settle_probes(&mut self, problem: &AnyProblem<'_, S, T>, observer: &mut dyn Observer<T>) {
        let common = &mut self.common;
        if matches!(
            common.stage,
            Stage::Settle(BatchSource::Probes) | Stage::Asked(BatchSource::Probes)
        ) {
            common.stage = Stage::Propose;
            common.ledger.settle(problem, &mut common.candidates, observer);
            common.settle_probes(problem);
        }
    }
}

fn total(counts: impl Iterator<Item = Counts>) -> Counts {
    counts.fold(Counts::default(), |mut sum, counts| {
        sum += counts;
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

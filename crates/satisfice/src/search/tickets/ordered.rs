//! Answers that reach the engines in the order asked: each lane has a batch out, which is settled when it is complete.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use crate::archive::Archive;
use crate::budget::StopReason;
use crate::engine::Origin;
use crate::identity::Identity;
use crate::problem::AnyProblem;
use crate::scalar::Real;
use crate::search::lanes::Exchange;
use crate::search::running::{Running, Turn};
use crate::search::stage::Stage;

use super::Told;

/// A slice with its batches that are out.
pub(super) struct Ordered<S, T> {
    pub(super) running: Running<S, T>,
    /// Batches that are out, by the order in which they were proposed.
    out: BTreeMap<u64, Out<S>>,
    proposed: u64,
    /// Of which batch each open ticket is.
    open: BTreeMap<u64, u64>,
    /// Batches of which not all has been given out.
    free: VecDeque<u64>,
    /// Lanes that may have something to propose: they have no batch out, and have not said since the last exchange that they pause.
    idle: BTreeSet<usize>,
    /// Values from elsewhere that wait for a batch to be settled, with their positions.
    pub(super) informed: Vec<(T, S, Vec<S>)>,
    /// Whether a proposal was forgotten: then nothing is proved.
    pub(super) has_gaps: bool,
    /// Values that were taken and dropped, because an earlier one of their batch had ended the slice.
    pub(super) unused: u64,
}

/// A batch that is out.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(super) struct Out<S> {
    /// Whose it is.
    pub(super) turn: Turn,
    /// The tickets of those given out, in the order of the batch and ascending.
    pub(super) tickets: Vec<u64>,
    /// One for each solution of the batch.
    pub(super) answers: Vec<Answer<S>>,
}

/// What is known of a solution that is out.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) enum Answer<S> {
    Awaited,
    Value(S),
    Forgotten,
}

impl<S: Real> Out<S> {
    /// Whether not all of it has been given out.
    fn has_more(&self) -> bool {
        self.tickets.len() < self.answers.len()
    }

    /// Its open tickets.
    fn open(&self) -> impl Iterator<Item = u64> {
        let pairs = self.tickets.iter().zip(&self.answers);
        let open = pairs.filter(|&(_, answer)| *answer == Answer::Awaited);
        open.map(|(&ticket, _)| ticket)
    }

    fn is_answered(&self) -> bool {
        !self.answers.contains(&Answer::Awaited)
    }

    fn computed(&self) -> Vec<Option<S>> {
        let value = |answer: &Answer<S>| match *answer {
            Answer::Value(value) => Some(value),
            Answer::Awaited | Answer::Forgotten => None,
        };
        self.answers.iter().map(value).collect()
    }
}

impl<S: Real, T: Identity + Clone + Send + Sync> Ordered<S, T> {
    pub(super) fn new(running: Running<S, T>) -> Self {
        Self {
            out: BTreeMap::new(),
            proposed: 0,
            open: BTreeMap::new(),
            free: VecDeque::new(),
            idle: (0..running.lanes.len()).collect(),
            running,
            informed: Vec::new(),
            has_gaps: false,
            unused: 0,
        }
    }

    /// Gives out the next solution under a number; `None` if others have to be answered first or the slice is over.
    pub(super) fn next(
        &mut self,
        number: u64,
        problem: &AnyProblem<'_, S, T>,
        previous: &Archive<T>,
    ) -> Option<T> {
        loop {
            while let Some(&batch) = self.free.front() {
                let Some(out) = self.out.get_mut(&batch).filter(|out| out.has_more()) else {
                    self.free.pop_front();
                    continue;
                };
                let slice = self.running.slice_at(out.turn)?;
                let solution = slice.candidates.live().get(out.tickets.len())?.clone();
                out.tickets.push(number);
                self.open.insert(number, batch);
                return Some(solution);
            }
            let proposed = self.propose(problem, previous);
            self.withdraw_proofs();
            if !proposed {
                return None;
            }
        }
    }

    /// Lets the next lane propose that has no batch out, or lets the lanes exchange; `false` if none of it is possible.
    fn propose(&mut self, problem: &AnyProblem<'_, S, T>, previous: &Archive<T>) -> bool {
        let Running { lanes, exchange } = &mut self.running;
        let searching = exchange.as_ref().is_none_or(Exchange::is_searching);
        if searching {
            while let Some(&lane) = self.idle.first() {
                // Where that panics, the lane stays among those that may propose.
                let proposed = lanes[lane].propose(problem, previous, None);
                self.idle.remove(&lane);
                if proposed {
                    self.register(Turn::Lane(lane), problem, previous);
                    return true;
                }
            }
        }
        let (Some(exchange), true) = (exchange, self.out.is_empty()) else {
            return false;
        };
        if searching {
            exchange.between_rounds(lanes, &mut ());
            self.idle = (0..lanes.len()).collect();
            return true;
        }
        let probes = exchange.propose_probes(problem);
        if probes {
            self.register(Turn::Probes, problem, previous);
        }
        probes
    }

    /// An engine that says it has covered the space does not know of what was forgotten.
    fn withdraw_proofs(&mut self) {
        if !self.has_gaps {
            return;
        }
        let Running { lanes, exchange } = &mut self.running;
        let common = exchange.as_mut().map(|exchange| &mut exchange.common);
        for slice in lanes.iter_mut().map(|lane| &mut lane.slice).chain(common) {
            if slice.ledger.stop == Some(StopReason::Covered) {
                slice.ledger.stop = Some(StopReason::Exhausted);
            }
        }
    }

    /// Notes a batch that is proposed; one whose solutions are all in the archive is settled at once.
    fn register(&mut self, turn: Turn, problem: &AnyProblem<'_, S, T>, previous: &Archive<T>) {
        let Some(slice) = self.running.slice_at(turn) else {
            return;
        };
        if let Stage::Settle(from) = slice.stage {
            slice.stage = Stage::Asked(from);
        }
        let live = slice.candidates.live().len();
        if live == 0 {
            self.is_free(turn);
            self.running.settle(turn, problem, previous, &mut ());
        } else {
            slice.ledger.goes_out();
            let out = Out {
                turn,
                tickets: Vec::new(),
                answers: vec![Answer::Awaited; live],
            };
            self.out.insert(self.proposed, out);
            self.free.push_back(self.proposed);
            self.proposed += 1;
        }
    }

    /// Notes that a lane, if it was one, has no batch out any more.
    fn is_free(&mut self, turn: Turn) {
        if let Turn::Lane(lane) = turn {
            self.idle.insert(lane);
        }
    }

    /// Proposes a batch again that was out when the slice was saved; `false` if there is none.
    pub(super) fn propose_again(
        &mut self,
        out: Out<S>,
        problem: &AnyProblem<'_, S, T>,
        previous: &Archive<T>,
    ) -> bool {
        let Some(slice) = self.running.slice_at(out.turn) else {
            return false;
        };
        if !matches!(slice.stage, Stage::Repeat(_)) {
            return false;
        }
        let proposed = match (out.turn, &mut self.running.exchange) {
            (Turn::Lane(lane), _) => self.running.lanes[lane].propose(problem, previous, None),
            (Turn::Probes, Some(exchange)) => exchange.propose_probes(problem),
            (Turn::Probes, None) | (Turn::Over, _) => false,
        };
        let batch = self.proposed;
        if proposed {
            if let Turn::Lane(lane) = out.turn {
                self.idle.remove(&lane);
            }
            self.register(out.turn, problem, previous);
        }
        let Some(registered) = self.out.get_mut(&batch) else {
            return false;
        };
        let fits = registered.answers.len() == out.answers.len()
            && out.tickets.len() <= out.answers.len()
            && out.tickets.is_sorted_by(|a, b| a < b)
            && out.answers[out.tickets.len()..]
                .iter()
                .all(|answer| *answer == Answer::Awaited)
            && out.open().all(|ticket| !self.open.contains_key(&ticket));
        if fits {
            self.open.extend(out.open().map(|ticket| (ticket, batch)));
            *registered = out;
        }
        fits
    }

    /// The batch of an open ticket, and its place there.
    fn find(&self, number: u64) -> Option<(u64, usize)> {
        let batch = *self.open.get(&number)?;
        let place = self.out.get(&batch)?.tickets.binary_search(&number);
        Some((batch, place.ok()?))
    }

    /// Takes a value, or forgets a ticket; `None` if it is not open.
    pub(super) fn tell(
        &mut self,
        number: u64,
        value: Option<S>,
        problem: &AnyProblem<'_, S, T>,
        previous: &Archive<T>,
    ) -> Option<Told> {
        let (batch, place) = self.find(number)?;
        self.open.remove(&number);
        self.has_gaps |= value.is_none();
        let out = self.out.get_mut(&batch)?;
        out.answers[place] = value.map_or(Answer::Forgotten, Answer::Value);
        if out.is_answered()
            && let Some(out) = self.out.remove(&batch)
        {
            self.settle(&out, problem, previous);
        }
        Some(Told::Taken)
    }

    fn settle(&mut self, out: &Out<S>, problem: &AnyProblem<'_, S, T>, previous: &Archive<T>) {
        let computed = out.computed();
        let values = computed.iter().flatten().count();
        let before = self.fitness_values(out.turn);
        if let Some(slice) = self.running.slice_at(out.turn) {
            slice.candidates.resume(&computed);
            slice.ledger.evaluated_elsewhere(values);
        }
        self.is_free(out.turn);
        self.running.settle(out.turn, problem, previous, &mut ());
        self.unused += (before + values as u64).saturating_sub(self.fitness_values(out.turn));
        self.withdraw_proofs();
        self.enter_informed(problem, previous);
    }

    /// How many values of the fitness have been entered there.
    fn fitness_values(&mut self, turn: Turn) -> u64 {
        let slice = self.running.slice_at(turn);
        slice.map_or(0, |slice| slice.ledger.counts.fitness_calls)
    }

    /// Takes a value from elsewhere. It waits while a batch is out that was prepared without it.
    pub(super) fn inform(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        previous: &Archive<T>,
        solution: &T,
        value: S,
        position: Vec<S>,
    ) {
        self.informed.push((solution.clone(), value, position));
        self.enter_informed(problem, previous);
    }

    /// Enters values from elsewhere in the first lane, or in the common archive once the lanes have ended, and tells every
    /// engine.
    fn enter_informed(&mut self, problem: &AnyProblem<'_, S, T>, previous: &Archive<T>) {
        let searching = self.running.exchange.as_ref().is_none_or(Exchange::is_searching);
        let turn = if searching { Turn::Lane(0) } else { Turn::Probes };
        if self.informed.is_empty() || self.out.values().any(|out| out.turn == turn) {
            return;
        }
        for (solution, value, position) in core::mem::take(&mut self.informed) {
            let Some(slice) = self.running.slice_at(turn) else {
                return;
            };
            let outcome = slice.ledger.inform(problem, &solution, value);
            if position.is_empty() {
                continue;
            }
            let batch = crate::batch::Batch::of_one(&position);
            for lane in &mut self.running.lanes {
                let view = lane.slice.view(problem, previous);
                lane.lane.engine.tell(&view, &batch, &[outcome], Origin::Start);
            }
        }
    }

    pub(super) fn open(&self) -> usize {
        self.open.len()
    }

    pub(super) fn pending(&self) -> Vec<u64> {
        self.open.keys().copied().collect()
    }

    /// The batches that are out, to be saved.
    pub(super) fn batches(&self) -> Vec<Out<S>> {
        self.out.values().cloned().collect()
    }

    pub(super) fn solution(&self, number: u64) -> Option<&T> {
        let (batch, place) = self.find(number)?;
        let slice = match (self.out.get(&batch)?.turn, &self.running.exchange) {
            (Turn::Lane(lane), _) => &self.running.lanes.get(lane)?.slice,
            (Turn::Probes, Some(exchange)) => &exchange.common,
            (Turn::Probes, None) | (Turn::Over, _) => return None,
        };
        slice.candidates.live().get(place)
    }

    /// Enters the answers of batches that are not complete, and ends the slice.
    pub(super) fn finish(mut self, problem: &AnyProblem<'_, S, T>, previous: &Archive<T>) -> Running<S, T> {
        for out in core::mem::take(&mut self.out).into_values() {
            self.settle(&out, problem, previous);
        }
        let Running { lanes, exchange } = &mut self.running;
        let over = lanes.iter_mut().all(|lane| lane.slice.ledger.is_over());
        match exchange {
            Some(exchange) if exchange.is_searching() && over => {
                // What the lanes have found since their last exchange.
                exchange.between_rounds(lanes, &mut ());
                exchange.end_if_late();
            }
            Some(exchange) if exchange.is_searching() => {
                lanes.iter_mut().for_each(|lane| lane.slice.ledger.give_up());
                let reason = lanes.first().and_then(|lane| lane.slice.ledger.stop);
                self.running.end(reason.unwrap_or(StopReason::Cancelled));
            }
            None if !over => lanes.iter_mut().for_each(|lane| lane.slice.ledger.give_up()),
            _ => {}
        }
        self.running
    }
}

//! A slice of all lanes: how it begins, proceeds and ends.

use super::lane::{Lane, RunningLane};
use super::lanes::Exchange;
use super::slice::Slice;
use super::stage::Stage;
use crate::archive::Archive;
use crate::budget::{Cancel, StopReason};
use crate::identity::Identity;
use crate::observer::Observer;
use crate::problem::AnyProblem;
use crate::scalar::Real;

/// All lanes of a slice that has begun, and the exchange between them if there are several.
pub(super) struct Running<S, T> {
    pub(super) lanes: Vec<RunningLane<S, T>>,
    pub(super) exchange: Option<Exchange<S, T>>,
}

/// The first lane, while a slice runs.
pub(super) fn first_lane<S, T>(running: &mut Option<Running<S, T>>) -> Option<&mut RunningLane<S, T>> {
    running.as_mut()?.lanes.first_mut()
}

/// What the next step of a slice needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) enum Turn {
    /// This lane has a batch out.
    Lane(usize),
    /// The probes at the end have a batch out.
    Probes,
    /// The slice is over.
    Over,
}

impl<S: Real, T: Identity + Clone + Send + Sync> Running<S, T> {
    /// The slice that is reported: the only lane's, or the common one.
    pub(super) fn reported(&self) -> &Slice<S, T> {
        match &self.exchange {
            Some(exchange) => &exchange.common,
            None => &self.lanes[0].slice,
        }
    }

    /// The reported slice, and what the lanes keep for the next slice.
    pub(super) fn into_parts(self) -> (Slice<S, T>, Vec<Lane<S>>) {
        let mut first = None;
        let lanes = self.lanes.into_iter().map(|RunningLane { lane, slice }| {
            first.get_or_insert(slice);
            lane
        });
        let lanes = lanes.collect();
        let reported = match (self.exchange, first) {
            (Some(exchange), _) => exchange.common,
            (None, Some(slice)) => slice,
            (None, None) => unreachable!("a search has at least one lane"),
        };
        (reported, lanes)
    }

    /// Proposes the next batch that has to be evaluated, lane by lane.
    pub(super) fn propose(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        previous: &Archive<T>,
        observer: &mut dyn Observer<T>,
    ) -> Turn {
        loop {
            let searching = self.exchange.as_ref().is_none_or(Exchange::is_searching);
            if searching {
                let next = self
                    .lanes
                    .iter_mut()
                    .position(|lane| lane.propose(problem, previous, None));
                if let Some(lane) = next {
                    return Turn::Lane(lane);
                }
            }
            let Some(exchange) = &mut self.exchange else {
                return Turn::Over;
            };
            if searching {
                exchange.between_rounds(&mut self.lanes, observer);
            } else if exchange.propose_probes(problem) {
                return Turn::Probes;
            } else {
                return Turn::Over;
            }
        }
    }

    /// The slice whose turn it is.
    pub(super) fn slice_at(&mut self, turn: Turn) -> Option<&mut Slice<S, T>> {
        match turn {
            Turn::Lane(lane) => self.lanes.get_mut(lane).map(|lane| &mut lane.slice),
            Turn::Probes => self.exchange.as_mut().map(|exchange| &mut exchange.common),
            Turn::Over => None,
        }
    }

    /// Settles the batch whose turn it is.
    pub(super) fn settle(
        &mut self,
        turn: Turn,
        problem: &AnyProblem<'_, S, T>,
        previous: &Archive<T>,
        observer: &mut dyn Observer<T>,
    ) {
        match (turn, &mut self.exchange) {
            (Turn::Lane(lane), None) => self.lanes[lane].settle(problem, previous, observer),
            // Observers are told at the exchange.
            (Turn::Lane(lane), Some(_)) => self.lanes[lane].settle(problem, previous, &mut ()),
            (Turn::Probes, Some(exchange)) => exchange.settle_probes(problem, observer),
            (Turn::Probes, None) | (Turn::Over, _) => {}
        }
    }

    /// Lets the lanes run to the next exchange.
    pub(super) fn pause_for_exchange(&mut self) {
        if let Some(exchange) = &self.exchange {
            for lane in &mut self.lanes {
                lane.slice.pause = exchange.progress.until();
            }
        }
    }

    /// Sets who may cancel the slice.
    pub(super) fn set_cancel(&mut self, cancel: Option<&Cancel>) {
        let common = self.exchange.as_mut().map(|exchange| &mut exchange.common);
        for slice in self.lanes.iter_mut().map(|lane| &mut lane.slice).chain(common) {
            slice.ledger.budget.cancel = cancel.cloned();
        }
    }

    /// Ends the slice for a reason from outside, with what the lanes have found; a batch that is out is dropped.
    pub(super) fn end(&mut self, reason: StopReason) {
        for lane in &mut self.lanes {
            lane.slice.stage = Stage::Propose;
            lane.slice.ledger.stop = Some(reason);
        }
        if let Some(exchange) = &mut self.exchange {
            if exchange.is_searching() {
                exchange.between_rounds(&mut self.lanes, &mut ());
            }
            exchange.common.ledger.stop = Some(reason);
        }
    }
}

//! Which lanes can do what: with tens of thousands of them, a walk over all for each ticket would take longer than an evaluation.

use std::collections::BTreeSet;

use crate::scalar::Real;

use super::lane::EagerLane;

/// What a lane can do next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Next {
    /// Its batch has points to give out.
    Point,
    /// It can be asked for its next batch.
    Ask,
    /// Its batch can be told without the answers that are awaited.
    Tell,
    /// Nothing, before answers come.
    Wait,
    /// It has nothing more to propose.
    End,
    /// Every point of the space has been given out.
    Covered,
}

/// The lanes by what they can do next.
#[derive(Debug, Default)]
pub(super) struct Agenda {
    of: Vec<Next>,
    lanes: [BTreeSet<usize>; 6],
}

impl Agenda {
    /// Of these lanes.
    pub(super) fn of<S: Real>(lanes: &[EagerLane<S>]) -> Self {
        let mut agenda = Self::default();
        for lane in 0..lanes.len() {
            agenda.note(lanes, lane);
        }
        agenda
    }

    /// Notes what this lane can do now: to be called whenever that may have changed, and for a new lane.
    pub(super) fn note<S: Real>(&mut self, lanes: &[EagerLane<S>], lane: usize) {
        let next = lanes[lane].next();
        match self.of.get_mut(lane) {
            Some(before) if *before == next => return,
            Some(before) => {
                self.lanes[*before as usize].remove(&lane);
                *before = next;
            }
            None => self.of.push(next),
        }
        self.lanes[next as usize].insert(lane);
    }

    /// The first lane that can do this.
    pub(super) fn first(&self, next: Next) -> Option<usize> {
        self.lanes[next as usize].first().copied()
    }

    /// Whether no lane will propose anything more.
    pub(super) fn has_ended(&self) -> bool {
        let ended = [Next::End, Next::Covered].map(|next| self.lanes[next as usize].len());
        ended.iter().sum::<usize>() == self.of.len()
    }
}

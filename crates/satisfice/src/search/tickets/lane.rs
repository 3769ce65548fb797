//! What the tickets of an eager slice know of a lane: an engine, its batch, and how far that is.

use crate::batch::{Batch, Outcome};
use crate::engine::{Answers, Ask};
use crate::scalar::Real;
use crate::search::lane::Lane;

use super::agenda::Next;

/// An open ticket.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(super) struct Open<S, T> {
    pub(super) solution: T,
    /// Empty where the problem does not encode it.
    pub(super) position: Vec<S>,
    pub(super) of: Of,
}

/// Whose a candidate is.
#[derive(Debug, Clone, Copy, serde::Serialize, serde::Deserialize)]
pub(super) enum Of {
    /// A lane's, at this place of this batch.
    Lane {
        lane: usize,
        batch: u64,
        place: usize,
    },
    Probe,
    /// A hit of the slice before.
    Verified,
    /// A point that the user has given.
    Start,
}

/// An engine and its batch.
pub(super) struct EagerLane<S> {
    pub(super) lane: Lane<S>,
    pub(super) batch: Batch<S>,
    pub(super) progress: BatchProgress<S>,
}

/// How far a batch is.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(super) struct BatchProgress<S> {
    /// Which one it is.
    pub(super) number: u64,
    pub(super) outcomes: Vec<Outcome<S>>,
    /// The next point to be given out.
    pub(super) next: usize,
    /// How many are out.
    pub(super) out: usize,
    /// Whether the engine was told.
    pub(super) told: bool,
    /// What the engine said last, and how often it had nothing to propose.
    pub(super) last: Ask,
    pub(super) idle: usize,
}

impl<S: Real> EagerLane<S> {
    pub(super) fn new(lane: Lane<S>, dimension: usize) -> Self {
        Self {
            lane,
            batch: Batch::new(dimension),
            progress: BatchProgress {
                number: 0,
                outcomes: Vec::new(),
                next: 0,
                out: 0,
                told: true,
                last: Ask::More,
                idle: 0,
            },
        }
    }

    pub(super) fn restored(lane: Lane<S>, batch: Batch<S>, progress: BatchProgress<S>) -> Option<Self> {
        let fits = progress.outcomes.len() == batch.len()
            && progress.next <= batch.len()
            && progress.out <= progress.next;
        fits.then_some(Self {
            lane,
            batch,
            progress,
        })
    }

    fn has_points(&self) -> bool {
        self.progress.next < self.batch.len()
    }

    /// What it can do next.
    pub(super) fn next(&self) -> Next {
        let progress = &self.progress;
        if self.has_points() {
            return Next::Point;
        }
        match progress.last {
            Ask::Covered => Next::Covered,
            Ask::Exhausted => Next::End,
            Ask::More if progress.told => Next::Ask,
            Ask::More if self.can_be_told() => Next::Tell,
            Ask::More => Next::Wait,
        }
    }

    /// Whether the engine can take the batch without the answers that are awaited.
    fn can_be_told(&self) -> bool {
        match self.lane.engine.answers() {
            Answers::ByBatch => 2 * self.progress.out <= self.batch.len(),
            Answers::Alone | Answers::AnyOrder => true,
        }
    }
}

impl<S: Real, T> Open<S, T> {
    /// Whether it fits these lanes, in a space of so many axes.
    pub(super) fn fits(&self, lanes: &[EagerLane<S>], dimension: usize) -> bool {
        let placed = match self.of {
            Of::Lane { lane, batch, place } => lanes.get(lane).is_some_and(|lane| {
                batch < lane.progress.number || (batch == lane.progress.number && place < lane.progress.next)
            }),
            Of::Probe | Of::Verified | Of::Start => true,
        };
        placed && (self.position.is_empty() || self.position.len() == dimension)
    }
}

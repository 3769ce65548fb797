//! The answers of a world: contacts, frames, and how complete they are.

use super::{BodyId, Skips};

/// Two features within the threshold. Ordered by bodies, then by features.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Contact {
    /// Body of the first feature. For pairs of equal features the one with the lower index.
    pub body_a: BodyId,
    /// Body of the second feature.
    pub body_b: BodyId,
    /// The first feature: a vertex, edge or triangle by its number in its mesh.
    pub a: u32,
    /// The second feature. Inside one body, for pairs of equal features, the higher number.
    pub b: u32,
}

impl Contact {
    /// The two bodies, the lower one first.
    #[must_use]
    pub fn bodies(&self) -> (BodyId, BodyId) {
        (self.body_a.min(self.body_b), self.body_a.max(self.body_b))
    }
}

/// How complete an answer is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Completeness {
    /// Every pair was decided or excluded by bounds: there are no others.
    Proved,
    /// The budget ended first.
    Unknown,
}

/// The result of an update of a world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Update {
    /// Whether all contacts are known.
    pub completeness: Completeness,
    /// Pairs of bodies, or bodies with themselves, whose contacts were recomputed.
    pub recomputed: usize,
    /// What was skipped, and why.
    pub skips: Skips,
}

/// The answer for one frame as a list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    /// The contacts, sorted.
    pub contacts: Vec<Contact>,
    /// Whether there can be others.
    pub completeness: Completeness,
    /// What was skipped, and why.
    pub skips: Skips,
}

//! The sources of candidates.

use crate::batch::Outcome;
use crate::report::SourceCount;
use crate::scalar::Real;

/// Where a candidate comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) enum Source {
    Uniform,
    Swarm,
    /// A hit moved by a step that is known.
    Step,
    /// A hit moved by the difference of two hits, on trial.
    Trial,
    /// Some coordinates of a hit, the others of another.
    Cross,
    /// A neighbour of a hit, named by the problem.
    Neighbour,
    /// A near miss of the slice before.
    NearMiss,
    /// A descent over neighbours.
    Descent,
    /// A whole engine.
    Guest,
}

/// The part a source plays for the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// It looks for hits in new places.
    Explores,
    /// It goes on from hits.
    Exploits,
    /// Neither: its hits say nothing about places.
    Apart,
}

impl Source {
    /// The role of a source that is not a [whole engine](Source::Guest).
    pub(super) fn role(self) -> Role {
        match self {
            Self::Uniform | Self::Swarm | Self::Descent => Role::Explores,
            Self::Step | Self::Trial | Self::Cross | Self::Neighbour => Role::Exploits,
            Self::NearMiss | Self::Guest => Role::Apart,
        }
    }
}

/// Number of all sources, whole engines included.
pub(super) const PLACES: usize = 14;

/// The names of all sources in the order of [`Source`], then those of the whole engines in the order of their kinds.
const NAMES: [&str; PLACES] = [
    "uniform",
    "swarms",
    "steps",
    "trial steps",
    "recombination",
    "neighbours",
    "near misses",
    "descents",
    "CMA-ES",
    "flood fill",
    "regions",
    "model",
    "quadratic descents",
    "niching",
];

/// Candidates and hits of each source since the slice began.
#[derive(Debug, Clone, Copy, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Tally([[u64; 2]; PLACES]);

impl Tally {
    /// Counts a candidate of the source at this index of [`NAMES`].
    pub(super) fn count<S: Real>(&mut self, place: usize, outcome: Outcome<S>) {
        let [proposed, hits] = &mut self.0[place];
        *proposed += u64::from(outcome != Outcome::NotEvaluated);
        *hits += u64::from(outcome.is_hit());
    }

    pub(super) fn counts(&self) -> Vec<SourceCount> {
        let counts = NAMES.iter().zip(&self.0);
        counts
            .map(|(&name, &[proposed, hits])| SourceCount { name, proposed, hits })
            .collect()
    }
}

/// A candidate's source, and the index of the swarm, descent, step, trial or engine within it.
pub(super) type Tag = (Source, usize);

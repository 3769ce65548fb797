//! The sources of candidates, and which of them are arms of the bandit.

/// Where a candidate comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) enum Source {
    Uniform,
    Swarm,
    Climber,
    /// A hit moved by a step that is known.
    Step,
    /// A hit moved by the difference of two hits, on trial.
    Trial,
    /// Some coordinates of a hit, the others of another.
    Cross,
    /// A member of a population that adapts its covariance.
    Member,
    /// A neighbour of a hit, named by the problem.
    Neighbour,
    /// A near miss of the slice before.
    NearMiss,
}

/// A candidate's source, and which swarm, climber, step or trial of it.
pub(super) type Tag = (Source, usize);

/// Number of sources with an arm, and some of these.
pub(super) const ARMS: usize = 6;
pub(super) const TRIAL: usize = 3;
pub(super) const CROSS: usize = 4;
pub(super) const MEMBER: usize = 5;

/// The arm of a source; steps, neighbours and near misses keep their own counts.
pub(super) fn arm_of(source: Source) -> Option<usize> {
    match source {
        Source::Uniform => Some(0),
        Source::Swarm => Some(1),
        Source::Climber => Some(2),
        Source::Trial => Some(TRIAL),
        Source::Cross => Some(CROSS),
        Source::Member => Some(MEMBER),
        Source::Step | Source::Neighbour | Source::NearMiss => None,
    }
}

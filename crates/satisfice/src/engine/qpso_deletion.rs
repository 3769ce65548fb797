//! QPSO attracted by the best, hits deleted: the paper's engine but for its attractor.

use super::Engine;
use super::quantum_swarm::{ALPHA, QuantumSwarm};
use super::schedule::Schedule;
use super::swarm::{self, Attractor};
use crate::catalogue::{Parameter, Params};
use crate::error::Error;
use crate::scalar::Real;

pub(super) const PARAMETERS: &[Parameter] = &[swarm::particles(30), ALPHA, swarm::BATCH];

/// QPSO whose hits are deleted from the space. All else is as in `latest-hit-qpso`, so that the two differ in the attractor
/// only: G is the best of the personal bests.
///
/// Sun, Feng, Xu 2004, doi 10.1109/CEC.2004.1330875. Differs from the paper in the deletion, and in that a hit becomes P_i
/// even if it is worse than the P_i that was deleted.
pub(super) fn build<S: Real>(values: &Params) -> Result<Box<dyn Engine<S>>, Error> {
    let alpha = Schedule::fixed(values.real("alpha"));
    Ok(Box::new(QuantumSwarm::new(values, alpha, Attractor::Best, true)))
}

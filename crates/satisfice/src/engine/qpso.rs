//! QPSO as published: attracted by the best, nothing deleted.

use super::Engine;
use super::quantum_swarm::{ALPHA, QuantumSwarm};
use super::schedule::Schedule;
use super::swarm::{self, Attractor};
use crate::catalogue::{Parameter, Params};
use crate::error::Error;
use crate::scalar::Real;

pub(super) const PARAMETERS: &[Parameter] = &[
    swarm::particles(30),
    ALPHA,
    Parameter::real(
        "alpha-end",
        "alpha at the end of the budget, reached in a straight line; 0: alpha is fixed",
        0.0,
        0.0,
        10.0,
    ),
    swarm::BATCH,
];

/// QPSO: G is the best of the personal bests; a point becomes P_i if it is better, hit or not; hits stay in the space.
///
/// alpha is 1 by default, as in the paper's engine, to compare attractors alone. Usual as a minimiser: 0.75, or from 1 to
/// 0.5 (`alpha-end`).
///
/// Sun, Feng, Xu 2004, doi 10.1109/CEC.2004.1330875; alpha after Sun et al. 2012, doi 10.1162/EVCO_a_00049. Differs from the
/// paper in the schedule, which follows the elapsed share of the budget and not a count of iterations.
pub(super) fn build<S: Real>(values: &Params) -> Result<Box<dyn Engine<S>>, Error> {
    let (alpha, end) = (values.real("alpha"), values.real("alpha-end"));
    let alpha = if is_scheduled(values) {
        Schedule::linear(alpha, end)
    } else {
        Schedule::fixed(alpha)
    };
    Ok(Box::new(QuantumSwarm::new(values, alpha, Attractor::Best, false)))
}

pub(super) fn is_scheduled(values: &Params) -> bool {
    values.real("alpha-end") > 0.0
}

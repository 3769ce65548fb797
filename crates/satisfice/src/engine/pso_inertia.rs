//! The particle swarm with an inertia weight that falls.

use super::Engine;
use super::schedule::Schedule;
use super::swarm::{self, Attractor};
use super::velocity_swarm::{Coefficients, VelocitySwarm, acceleration, v_max};
use crate::catalogue::{Parameter, Params};
use crate::error::Error;
use crate::scalar::Real;

pub(super) const PARAMETERS: &[Parameter] = &[
    swarm::particles(30),
    Parameter::real("w", "inertia weight at the start", 0.9, 0.0, 2.0),
    Parameter::real("w-end", "inertia weight at the end of the budget", 0.4, 0.0, 2.0),
    acceleration("c1", "acceleration towards the personal best"),
    acceleration("c2", "acceleration towards the best of all"),
    v_max(0.5),
    swarm::BATCH,
    swarm::DELETION,
];

/// PSO with inertia: V := w V + 2 r1 (P - X) + 2 r2 (G - X), w from 0.9 to 0.4.
///
/// Shi, Eberhart 1998, doi 10.1109/ICEC.1998.699146; the schedule and Vmax = Xmax, half an axis, after Shi, Eberhart 1999,
/// doi 10.1109/CEC.1999.785511. Differs from the paper in that w follows the elapsed share of the budget, not a count of
/// iterations.
pub(super) fn build<S: Real>(values: &Params) -> Result<Box<dyn Engine<S>>, Error> {
    let coefficients = Coefficients {
        inertia: Schedule::linear(values.real("w"), values.real("w-end")),
        cognitive: S::of(values.real("c1")),
        social: S::of(values.real("c2")),
        v_max: S::of(values.real("v-max")),
    };
    let deletes = values.text("deletion") == "yes";
    Ok(Box::new(VelocitySwarm::new(
        values,
        coefficients,
        Attractor::Best,
        deletes,
    )))
}

pub(super) fn is_scheduled(values: &Params) -> bool {
    values.real("w") != values.real("w-end")
}

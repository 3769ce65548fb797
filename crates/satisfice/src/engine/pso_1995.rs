//! The first particle swarm.

use super::Engine;
use super::schedule::Schedule;
use super::swarm::{self, Attractor};
use super::velocity_swarm::{Coefficients, VelocitySwarm, acceleration, v_max};
use crate::catalogue::{Parameter, Params};
use crate::error::Error;
use crate::scalar::Real;

pub(super) const PARAMETERS: &[Parameter] = &[
    swarm::particles(30),
    acceleration("c1", "acceleration towards the personal best"),
    acceleration("c2", "acceleration towards the best of all"),
    v_max(0.2),
    swarm::BATCH,
    swarm::DELETION,
];

/// PSO without inertia weight: V := V + 2 r1 (P - X) + 2 r2 (G - X), |V| <= Vmax.
///
/// Kennedy, Eberhart 1995, doi 10.1109/ICNN.1995.488968; Vmax of 10 to 20 % of an axis after Eberhart, Shi 2001,
/// doi 10.1109/CEC.2001.934374. Differs from the paper, which leaves the bounds open, in what happens there.
pub(super) fn build<S: Real>(values: &Params) -> Result<Box<dyn Engine<S>>, Error> {
    let coefficients = Coefficients {
        inertia: Schedule::fixed(1.0),
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

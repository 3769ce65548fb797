//! The particle swarm with constriction, attracted by the best.

use super::Engine;
use super::schedule::Schedule;
use super::swarm::{self, Attractor};
use super::velocity_swarm::{Coefficients, VelocitySwarm, v_max};
use crate::catalogue::{Parameter, Params};
use crate::error::Error;
use crate::scalar::Real;

/// The row for phi.
pub(super) const PHI: Parameter = Parameter::real(
    "phi",
    "total acceleration phi = c1 + c2; chi = 2 / |2 - phi - sqrt(phi^2 - 4 phi)|",
    4.1,
    4.0,
    10.0,
);

pub(super) const PARAMETERS: &[Parameter] = &[
    swarm::particles(30),
    PHI,
    v_max(0.5),
    swarm::BATCH,
    swarm::DELETION,
];

/// PSO with constriction: V := chi (V + phi/2 r1 (P - X) + phi/2 r2 (G - X)).
///
/// Clerc, Kennedy 2002, doi 10.1109/4235.985692: phi = 4.1, chi = 0.7298; Vmax = Xmax, half an axis, after Eberhart, Shi
/// 2000, doi 10.1109/CEC.2000.870279.
pub(super) fn build<S: Real>(values: &Params) -> Result<Box<dyn Engine<S>>, Error> {
    let deletes = values.text("deletion") == "yes";
    let coefficients = constriction(values);
    Ok(Box::new(VelocitySwarm::new(
        values,
        coefficients,
        Attractor::Best,
        deletes,
    )))
}

/// The coefficients of a constricted swarm by the rows [`PHI`] and [`v_max`].
pub(super) fn constriction<S: Real>(values: &Params) -> Coefficients<S> {
    let phi = values.real("phi");
    let chi = chi(phi);
    Coefficients {
        inertia: Schedule::fixed(chi),
        cognitive: S::of(chi * phi / 2.0),
        social: S::of(chi * phi / 2.0),
        v_max: S::of(values.real("v-max")),
    }
}

/// Clerc and Kennedy's constriction coefficient for phi >= 4.
fn chi(phi: f64) -> f64 {
    2.0 / (2.0 - phi - (phi * phi - 4.0 * phi).sqrt()).abs()
}

#[cfg(test)]
mod tests {
    #[test]
    fn chi_is_the_published_one() {
        approx::assert_abs_diff_eq!(super::chi(4.1), 0.729_843_788_1, epsilon = 1e-10);
        approx::assert_abs_diff_eq!(super::chi(4.1) * 2.05, 1.496_179_8, epsilon = 1e-7);
    }
}

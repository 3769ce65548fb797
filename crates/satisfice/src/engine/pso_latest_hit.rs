//! The particle swarm with constriction, attracted by the latest hit.

use super::Engine;
use super::pso::{PHI, constriction};
use super::swarm::{self, Attractor};
use super::velocity_swarm::{VelocitySwarm, v_max};
use crate::catalogue::{Parameter, Params};
use crate::error::Error;
use crate::scalar::Real;

pub(super) const PARAMETERS: &[Parameter] = &[swarm::particles(30), PHI, v_max(0.5), swarm::BATCH];

/// `pso` with the paper's rules: the latest hit attracts (the best while there is none), hits are deleted from the space and
/// become personal bests.
///
/// Clerc, Kennedy 2002, doi 10.1109/4235.985692, with the attractor of Chen et al. 2012, doi 10.3923/itj.2012.536.539.
pub(super) fn build<S: Real>(values: &Params) -> Result<Box<dyn Engine<S>>, Error> {
    let coefficients = constriction(values);
    Ok(Box::new(VelocitySwarm::new(
        values,
        coefficients,
        Attractor::LatestHit,
        true,
    )))
}

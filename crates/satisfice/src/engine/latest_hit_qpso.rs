//! The paper's engine: a quantum-behaved particle swarm attracted by the latest hit.

use super::Engine;
use super::quantum_swarm::{ALPHA, QuantumSwarm};
use super::schedule::Schedule;
use super::swarm::{self, Attractor};
use crate::catalogue::{Parameter, Params};
use crate::error::Error;
use crate::scalar::Real;

pub(super) const PARAMETERS: &[Parameter] = &[swarm::particles(30), ALPHA, swarm::BATCH];

/// Latest-hit QPSO, in the reading of the project's docs:
///
/// ```text
/// C_prev = {}
/// each slice:
///   X = N random members of C_prev if |C_prev| >= N, else all of C_prev and uniform points
///   P = X;  f_i = F(X_i) evaluated anew;  C = {};  G = none       (hits among the start points enter C)
///   until the slice ends:
///     mbest = mean(P)
///     for each particle i:
///       propose X_i by Eq. 2 with G, or with the best P while there is no hit; keep it inside
///       k = decode(X_i);  f = infinity if k is in C, else F(k)
///       if f < delta:    C += k;  G = X_i;  P_i = X_i;  f_i = f
///       else if f < f_i: P_i = X_i;  f_i = f
///   C_prev = C
/// ```
///
/// Eq. 2 is [`potential_well`](super::potential_well)'s. N = 30 and alpha = 1 as published.
///
/// Chen, Ye, An, Wang 2012, doi 10.3923/itj.2012.536.539. Differs from the paper in nothing that survives of it.
pub(super) fn build<S: Real>(values: &Params) -> Result<Box<dyn Engine<S>>, Error> {
    let alpha = Schedule::fixed(values.real("alpha"));
    Ok(Box::new(QuantumSwarm::new(
        values,
        alpha,
        Attractor::LatestHit,
        true,
    )))
}

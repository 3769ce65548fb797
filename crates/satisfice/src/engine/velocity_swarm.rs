//! The machinery of particle swarms with velocities.

use super::schedule::Schedule;
use super::swarm::{Attractor, Swarm};
use super::{Ask, Engine, Origin, WarmStart};
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::error::Error;
use crate::parameter::{Parameter, Values};
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::Boundary;

/// The row for Vmax.
pub(super) const fn v_max(default: f64) -> Parameter {
    Parameter::real(
        "v-max",
        "largest velocity Vmax, as a share of each axis",
        default,
        1e-9,
        1.0,
    )
}

/// The row for an acceleration coefficient.
pub(super) const fn acceleration(name: &'static str, summary: &'static str) -> Parameter {
    Parameter::real(name, summary, 2.0, 0.0, 10.0)
}

/// The coefficients of the velocity update.
#[derive(Debug)]
pub(super) struct Coefficients<S> {
    /// Inertia w.
    pub(super) inertia: Schedule<S>,
    /// c1, towards the personal best.
    pub(super) cognitive: S,
    /// c2, towards the attractor.
    pub(super) social: S,
    /// Vmax, as a share of each axis.
    pub(super) v_max: S,
}

/// A swarm whose particles have velocities. Each particle in turn moves by
///
/// ```text
/// V_i := w V_i + c1 r1 (P_i - X_i) + c2 r2 (G - X_i),   |V_i| <= Vmax,   r1, r2 ~ U(0, 1) per axis
/// X_i := X_i + V_i
/// ```
///
/// Velocities start uniform in ±Vmax. Where the boundary rule moves a particle, its velocity on that axis turns round under
/// reflection, becomes 0 under clamping, and stays where the space is periodic.
#[derive(Debug)]
pub(super) struct VelocitySwarm<S> {
    swarm: Swarm<S>,
    coefficients: Coefficients<S>,
    velocities: Vec<S>,
}

impl<S: Real> VelocitySwarm<S> {
    pub(super) fn new(
        values: &Values,
        coefficients: Coefficients<S>,
        attractor: Attractor,
        deletes: bool,
    ) -> Self {
        Self {
            swarm: Swarm::new(values, attractor, deletes),
            coefficients,
            velocities: Vec::new(),
        }
    }

    fn start(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) {
        self.swarm.propose_start(context, rng, out);
        for _ in 0..self.swarm.particles() {
            for axis in context.space().axes() {
                let limit = self.coefficients.v_max * axis.width();
                self.velocities.push(limit * S::of(2.0 * rng.uniform() - 1.0));
            }
        }
    }

    /// Mends the velocities of the particles that were due and that the boundary rule has moved.
    fn bounce(&mut self, context: &dyn Context<S>, batch: &Batch<S>) {
        let factor = match context.space().boundary() {
            Boundary::Reflect => -S::one(),
            Boundary::Clamp => S::zero(),
            Boundary::Wrap => return,
        };
        for (place, i) in self.swarm.due().enumerate() {
            let velocity = &mut self.velocities[self.swarm.row(i)];
            let moves = self.swarm.position(i).iter().zip(batch.point(place));
            for (v, (&from, &to)) in velocity.iter_mut().zip(moves) {
                if from + *v != to {
                    *v = *v * factor;
                }
            }
        }
    }

    fn check(&self) -> Result<(), Error> {
        self.swarm
            .fits_rows_drawn("the velocities", self.velocities.len())
    }
}

impl<S: Real> Engine<S> for VelocitySwarm<S> {
    fn begin(&mut self, context: &dyn Context<S>) {
        self.swarm.begin(context.space().dimension());
        self.velocities.clear();
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        if !self.swarm.has_started() {
            self.start(context, rng, out);
            return Ask::More;
        }
        let Coefficients {
            inertia,
            cognitive,
            social,
            v_max,
        } = &self.coefficients;
        let inertia = inertia.at(|| context.elapsed_share());
        let swarm = &self.swarm;
        let attractor = swarm.attractor();
        for (place, i) in swarm.due().enumerate() {
            let (best, row) = (swarm.best(i), swarm.row(i));
            out.push(swarm.position(i));
            let position = out.point_mut(place);
            for (j, axis) in context.space().axes().iter().enumerate() {
                let (x, v) = (&mut position[j], &mut self.velocities[row.start + j]);
                let to_best = *cognitive * S::of(rng.uniform()) * (best[j] - *x);
                let to_attractor = *social * S::of(rng.uniform()) * (attractor[j] - *x);
                let limit = *v_max * axis.width();
                // In this order a NaN of infinite terms ends at the limit.
                *v = (inertia * *v + to_best + to_attractor).min(limit).max(-limit);
                *x = *x + *v;
            }
        }
        Ask::More
    }

    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        if origin == Origin::Engine && self.swarm.has_started() {
            self.bounce(context, batch);
        }
        self.swarm.tell(batch, outcomes, origin);
    }

    fn deletes(&self) -> bool {
        self.swarm.deletes()
    }

    /// The paper's rule, for all swarms alike.
    fn warm_start(&self) -> WarmStart {
        WarmStart::Engine
    }

    crate::saved_fields!(swarm, velocities; check);
}

//! The machinery of particle swarms with velocities.

use super::particles::{Swarm, SwarmRules, set_room_aside};
use super::schedule::Schedule;
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::{Ask, Engine, Origin, Steps, WarmStart};
use crate::error::Error;
use crate::scalar::{Real, copy_row};
use crate::seed::SearchRng;
use crate::space::{Axis, Boundary};

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
    /// Vmax in units of each axis.
    limits: Vec<S>,
    /// What a velocity on each axis is multiplied by where the boundary rule moves its particle.
    turns: Vec<S>,
    /// Memory: where its velocity took the particle in turn.
    wanted: Vec<S>,
}

impl<S: Real> VelocitySwarm<S> {
    pub(super) fn new(rules: SwarmRules, coefficients: Coefficients<S>) -> Self {
        Self {
            swarm: Swarm::new(rules),
            coefficients,
            velocities: Vec::new(),
            limits: Vec::new(),
            turns: Vec::new(),
            wanted: Vec::new(),
        }
    }

    /// Takes the limits and the rule at the boundary from the space: at the beginning of a slice, and after a restoration, which knows no space.
    fn measure(&mut self, context: &dyn Context<S>) {
        let v_max = self.coefficients.v_max;
        self.limits.clear();
        self.limits
            .extend(context.space().axes().iter().map(|axis| v_max * axis.width()));
        self.wanted.clear();
        self.wanted.resize(self.limits.len(), S::zero());
        let space = context.space();
        self.turns.clear();
        self.turns
            .extend(space.axes().iter().map(|axis| turn(space.boundary(), axis)));
    }

    fn start(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) {
        self.swarm.propose_start(context, rng, out);
        for _ in 0..out.len() {
            let draws = self.limits.iter();
            self.velocities
                .extend(draws.map(|&limit| limit * S::of(2.0 * rng.uniform() - 1.0)));
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
        set_room_aside(
            &mut self.velocities,
            self.swarm.particles(),
            context.space().dimension(),
        );
        self.measure(context);
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        if self.limits.is_empty() {
            self.measure(context);
        }
        if !self.swarm.has_started() {
            self.start(context, rng, out);
            return Ask::More;
        }
        if self.swarm.begins_sweep() {
            drop_subnormals(&mut self.velocities);
        }
        let inertia = self.coefficients.inertia.at(|| context.elapsed_share());
        let swarm = &self.swarm;
        for i in swarm.due() {
            let row = out.push_row();
            row.copy_from_slice(swarm.position(i));
            let velocity = &mut self.velocities[swarm.row(i)];
            self.coefficients.displace(
                rng,
                inertia,
                row,
                velocity,
                (swarm.best(i), swarm.attractor(), &self.limits),
            );
        }
        Ask::More
    }

    fn advance(&mut self, rng: &mut SearchRng, steps: &mut dyn Steps<S>) -> bool {
        if !self.swarm.is_asynchronous() || self.limits.is_empty() {
            return false;
        }
        loop {
            if self.swarm.begins_sweep() {
                drop_subnormals(&mut self.velocities);
            }
            let inertia = self.coefficients.inertia.at(|| steps.elapsed_share());
            let (coefficients, limits, wanted) = (&self.coefficients, &self.limits, &mut self.wanted);
            let i = self.swarm.turn();
            let velocity = &mut self.velocities[self.swarm.row(i)];
            let more = self.swarm.step(steps, |x, best, attractor| {
                coefficients.displace(rng, inertia, x, velocity, (best, attractor, limits));
                copy_row(wanted, x);
            });
            bounce(&self.turns, velocity, self.swarm.position(i), |j, _| wanted[j]);
            if !more {
                return true;
            }
        }
    }

    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        if origin == Origin::Engine && self.swarm.has_started() {
            if self.turns.is_empty() {
                self.measure(context);
            }
            for (place, i) in self.swarm.due().enumerate() {
                let velocity = &mut self.velocities[self.swarm.row(i)];
                let from = self.swarm.position(i);
                bounce(&self.turns, velocity, batch.point(place), |j, v| from[j] + v);
            }
        }
        self.swarm.tell(batch, outcomes, origin);
    }

    fn deletes(&self) -> bool {
        self.swarm.deletes()
    }

    /// The paper's rule, for every swarm.
    fn warm_start(&self) -> WarmStart {
        WarmStart::Engine
    }

    crate::saved_fields!(swarm, velocities; check);
}

impl<S: Real> Coefficients<S> {
    /// Moves a particle on all axes, given its best, the attractor and the limits of its velocity. All rows are cut to one
    /// length, so that no coordinate's place is checked.
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a call per step would cost a tenth of the whole"
    )]
    fn displace(
        &self,
        rng: &mut SearchRng,
        inertia: S,
        x: &mut [S],
        v: &mut [S],
        (best, attractor, limits): (&[S], &[S], &[S]),
    ) {
        let d = x.len();
        let (v, best, attractor, limits) = (&mut v[..d], &best[..d], &attractor[..d], &limits[..d]);
        for j in 0..d {
            let to_best = self.cognitive * S::of(rng.uniform()) * (best[j] - x[j]);
            let to_attractor = self.social * S::of(rng.uniform()) * (attractor[j] - x[j]);
            // A NaN of infinite terms ends at the limit.
            v[j] = limited(inertia * v[j] + to_best + to_attractor, limits[j]);
            x[j] = x[j] + v[j];
        }
    }
}

/// Mends the velocity of a particle that is at `at`, where on axis `j` its velocity `v` took it to `wanted(j, v)`: the two
/// differ where the rule at the boundary has moved it.
#[inline]
fn bounce<S: Real>(turns: &[S], velocity: &mut [S], at: &[S], wanted: impl Fn(usize, S) -> S) {
    for (j, ((v, &at), &turn)) in velocity.iter_mut().zip(at).zip(turns).enumerate() {
        if turn != S::one() && wanted(j, *v) != at {
            *v = *v * turn;
        }
    }
}

/// What a velocity is multiplied by where the boundary rule has moved its particle on this axis.
pub(super) fn turn<S: Real>(boundary: Boundary, axis: &Axis<S>) -> S {
    match boundary {
        _ if axis.is_periodic() => S::one(),
        Boundary::Reflect => -S::one(),
        Boundary::Clamp => S::zero(),
        Boundary::Wrap => S::one(),
    }
}

/// Makes subnormal velocities 0, once a sweep. The velocities of a swarm that has converged shrink until they are; rounding
/// then keeps them above 0 for good, and the processor takes twice as long for a step that moves nothing.
pub(super) fn drop_subnormals<S: Real>(velocities: &mut [S]) {
    for v in velocities {
        *v = if v.abs() < S::min_positive_value() {
            S::zero()
        } else {
            *v
        };
    }
}

/// `v` within ±`limit`; NaN is `limit`. The library's minimum and maximum take twice as long.
#[inline]
fn limited<S: Real>(v: S, limit: S) -> S {
    let below = if v < limit { v } else { limit };
    if below > -limit { below } else { -limit }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocities_that_move_nothing_become_zero() {
        let least = f64::MIN_POSITIVE;
        let mut velocities = [least, -least, least / 2.0, -least / 2.0, 5e-324, 0.0, -3.0];
        drop_subnormals(&mut velocities);
        assert_eq!(velocities, [least, -least, 0.0, 0.0, 0.0, 0.0, -3.0]);
    }

    /// V := w V + c1 r1 (P - X) + c2 r2 (G - X), |V| <= Vmax; X := X + V.
    #[test]
    fn a_particle_moves_by_the_published_equation() {
        let coefficients = Coefficients {
            inertia: Schedule::fixed(0.7),
            cognitive: 1.5,
            social: 2.0,
            v_max: 0.5,
        };
        let (mut x, mut v) = ([1.0, 1.0, 1.0], [0.25, -0.5, 0.0]);
        let (best, attractor, limits) = ([2.0, 0.0, 1.0], [4.0, 1.0, 1000.0], [100.0, 100.0, 0.5]);
        let mut rng = SearchRng::new(5);
        coefficients.displace(&mut rng, 0.7, &mut x, &mut v, (&best, &attractor, &limits));

        let mut twin = SearchRng::new(5);
        let mut draws = || (twin.uniform(), twin.uniform());
        let (r1, r2) = draws();
        let first: f64 = 0.7 * 0.25 + 1.5 * r1 * (2.0 - 1.0) + 2.0 * r2 * (4.0 - 1.0);
        let (r1, _) = draws();
        let second: f64 = 0.7 * -0.5 + 1.5 * r1 * (0.0 - 1.0); // the attractor is where the particle is
        // The third axis is pulled far beyond its limit.
        for (value, expected) in v.iter().zip([first, second, 0.5]) {
            approx::assert_relative_eq!(*value, expected, max_relative = 1e-14);
        }
        for (value, expected) in x.iter().zip([1.0 + first, 1.0 + second, 1.5]) {
            approx::assert_relative_eq!(*value, expected, max_relative = 1e-14);
        }
    }

    #[test]
    fn a_velocity_turns_round_at_a_reflecting_bound_and_ends_at_a_clamping_one() {
        for (boundary, expected) in [
            (Boundary::Reflect, [-2.0, 3.0]),
            (Boundary::Clamp, [0.0, 3.0]),
            (Boundary::Wrap, [2.0, 3.0]),
        ] {
            let mut velocity = [2.0, 3.0];
            // On the first axis, the particle is not where its velocity took it.
            let axis = Axis::continuous(0.0, 10.0);
            bounce(&[turn(boundary, &axis); 2], &mut velocity, &[9.0, 4.0], |j, _| {
                [11.0, 4.0][j]
            });
            assert_eq!(velocity, expected, "{boundary:?}");
            assert_eq!(turn(boundary, &axis.periodic()), 1.0);
        }
    }
}

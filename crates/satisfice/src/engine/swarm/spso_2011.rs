//! Standard PSO 2011: rotation-invariant moves, a random topology that changes when it does not help.

use super::informants::Informants;
use super::particles::{Attractor, Swarm, SwarmRules, set_room_aside};
use super::velocity::drop_subnormals;
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::compiled::both_scalars;
use crate::engine::{Ask, Engine, EngineConfig, Origin, WarmStart};
use crate::engine_settings;
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::Boundary;

engine_settings! {
    /// SPSO-2011. Each particle in turn draws a point from a ball round a centre of gravity:
    ///
    /// ```text
    /// g  = (X + (X + c (P - X)) + (X + c (L - X))) / 3,   g = (X + (X + c (P - X))) / 2 if L = P
    /// x' = g + U(0, 1) |g - X| e,                         e a uniform direction
    /// V := w V + x' - X;   X := X + V;   where X leaves the box: on the bound, V := -V / 2
    /// ```
    ///
    /// with L the best personal best among the particle's informants. Each particle informs itself and K random ones, drawn again
    /// after every sweep that has not improved the best of all. Lengths are in units of the axes. A periodic space has no bound to put a
    /// particle on.
    ///
    /// Source: Clerc 2012, "Standard Particle Swarm Optimisation", hal-00764996; Zambrano-Bigiarini, Clerc, Rojas 2013,
    /// doi 10.1109/CEC.2013.6557848. Differs from the publication in the periodic case only.
    pub struct Spso2011 {
        /// Swarm size N.
        pub particles: usize = 40, 1..=1_000_000;
        /// Inertia weight w, 1 / (2 ln 2).
        pub w: f64 = 0.721_347_520_444_481_7, 0.0..=2.0;
        /// Acceleration c, 1/2 + ln 2.
        pub c: f64 = 1.193_147_180_559_945_3, 0.0..=10.0;
        /// Particles K that each particle informs, beside itself.
        pub informed: usize = 3, 0..=1000;
        /// Particles that move between two updates of the attractor: 1 is asynchronous, N once a sweep.
        pub batch: usize = 1, 1..=1_000_000;
        /// Delete hits from the space. The publication does not.
        pub deletion: bool = false;
    }
}

impl EngineConfig for Spso2011 {
    const NAME: &'static str = "spso-2011";
    const SUMMARY: &'static str = "Standard PSO 2011: rotation-invariant, random topology";
    const CITATION: &'static str = "Zambrano-Bigiarini, Clerc, Rojas 2013, doi 10.1109/CEC.2013.6557848";

    both_scalars!();
}

impl Spso2011 {
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        let rules = SwarmRules {
            particles: self.particles,
            batch: self.batch,
            attractor: Attractor::Best,
            deletes: self.deletion,
        };
        Box::new(Spso2011Swarm {
            swarm: Swarm::new(rules),
            inertia: S::of(self.w),
            acceleration: S::of(self.c),
            informants: Informants::new(self.particles, self.informed),
            velocities: Vec::new(),
            least_before: S::infinity(),
            direction: Vec::new(),
        })
    }
}

/// The swarm of [`Spso2011`].
#[derive(Debug)]
struct Spso2011Swarm<S> {
    swarm: Swarm<S>,
    inertia: S,
    acceleration: S,
    informants: Informants,
    velocities: Vec<S>,
    /// The least f_i when the sweep before began.
    least_before: S,
    /// Memory for a direction.
    direction: Vec<S>,
}

impl<S: Real> Spso2011Swarm<S> {
    fn start(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) {
        self.swarm.propose_start(context, rng, out);
        for position in out.points() {
            let axes = context.space().axes().iter().zip(position);
            self.velocities
                .extend(axes.map(|(axis, &x)| axis.at(rng.uniform()) - x));
        }
    }

    fn check(&self) -> Result<(), Error> {
        self.swarm
            .fits_rows_drawn("the velocities", self.velocities.len())?;
        self.swarm.fits("the direction", self.direction.len(), 1)
    }

    /// Writes a uniform direction of length one.
    fn draw_direction(direction: &mut [S], rng: &mut SearchRng) {
        let mut square = 0.0;
        for e in direction.iter_mut() {
            let normal = rng.normal();
            square += normal * normal;
            *e = S::of(normal);
        }
        let scale = S::of(1.0 / square.sqrt().max(f64::MIN_POSITIVE));
        for e in direction {
            *e = *e * scale;
        }
    }
}

/// g - X on one axis: the centre of gravity of X, of a point beyond `own` and, if another particle informs, of one beyond its
/// `local` best.
#[inline]
fn pull<S: Real>(c: S, x: S, own: S, local: Option<S>) -> S {
    match local {
        None => c * (own - x) / S::of(2.0),
        Some(local) => c * (own - x) / S::of(3.0) + c * (local - x) / S::of(3.0),
    }
}

/// Lengths are measured in these: the width of an axis, 1 where it has none.
#[inline]
fn unit<S: Real>(axis: &crate::space::Axis<S>) -> S {
    let width = axis.width();
    if width > S::zero() { width } else { S::one() }
}

impl<S: Real> Engine<S> for Spso2011Swarm<S> {
    fn begin(&mut self, context: &dyn Context<S>) {
        let dimension = context.space().dimension();
        self.swarm.begin(dimension);
        self.informants.clear();
        self.velocities.clear();
        set_room_aside(&mut self.velocities, self.swarm.particles(), dimension);
        self.least_before = S::infinity();
        self.direction.clear();
        self.direction.resize(dimension, S::zero());
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        if !self.swarm.has_started() {
            self.start(context, rng, out);
            return Ask::More;
        }
        let swarm = &self.swarm;
        if swarm.begins_sweep() {
            let least = swarm.least_fitness();
            if least >= self.least_before || self.informants.is_empty() {
                self.informants.draw(rng);
            }
            self.least_before = least;
            drop_subnormals(&mut self.velocities);
        }
        let axes = context.space().axes();
        let confined = context.space().boundary() != Boundary::Wrap;
        let c = self.acceleration;
        let two = S::of(2.0);
        for (place, i) in swarm.due().enumerate() {
            let informant = self.informants.of(i).fold(i, |best, j| {
                if swarm.fitness(j) < swarm.fitness(best) {
                    j
                } else {
                    best
                }
            });
            let (own, local, row) = (swarm.best(i), swarm.best(informant), swarm.row(i));
            Self::draw_direction(&mut self.direction, rng);
            let share = S::of(rng.uniform());
            out.push(swarm.position(i));
            let position = out.point_mut(place);
            // g - X, from which the radius follows.
            let pull = |j: usize, x: S| pull(c, x, own[j], (informant != i).then(|| local[j]));
            let mut square = S::zero();
            for (j, axis) in axes.iter().enumerate() {
                let length = pull(j, position[j]) / unit(axis);
                square = square + length * length;
            }
            let radius = share * square.sqrt();
            for (j, axis) in axes.iter().enumerate() {
                let (x, v) = (&mut position[j], &mut self.velocities[row.start + j]);
                let to_draw = pull(j, *x) + radius * self.direction[j] * axis.width();
                *v = self.inertia * *v + to_draw;
                *x = *x + *v;
                let outside = !(axis.start() <= *x && *x <= axis.end());
                if outside && confined && !axis.is_periodic() {
                    *x = x.max(axis.start()).min(axis.end());
                    *v = -*v / two;
                }
                // A sum that has overflown must not stay.
                if !v.is_finite() {
                    *v = S::zero();
                }
            }
        }
        Ask::More
    }

    fn tell(&mut self, _: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        self.swarm.tell(batch, outcomes, origin);
    }

    fn deletes(&self) -> bool {
        self.swarm.deletes()
    }

    /// The paper's rule, for every swarm.
    fn warm_start(&self) -> WarmStart {
        WarmStart::Engine
    }

    crate::saved_fields!(swarm, informants, velocities, least_before, direction; check);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// w = 1 / (2 ln 2) and c = 1/2 + ln 2.
    #[test]
    fn the_coefficients_are_the_published_ones() {
        let settings = Spso2011::default();
        let ln2 = core::f64::consts::LN_2;
        approx::assert_relative_eq!(settings.w, 1.0 / (2.0 * ln2), max_relative = 1e-15);
        approx::assert_relative_eq!(settings.c, 0.5 + ln2, max_relative = 1e-15);
        assert_eq!((settings.particles, settings.informed), (40, 3));
    }

    /// A direction is of length one, and in three dimensions each coordinate is uniform in [-1, 1] (Archimedes).
    #[test]
    fn directions_are_uniform_on_the_sphere() {
        let (mut rng, mut direction) = (SearchRng::new(11), [0.0_f64; 3]);
        let (mut below, mut sum) = (0, [0.0; 3]);
        for _ in 0..20_000 {
            Spso2011Swarm::draw_direction(&mut direction, &mut rng);
            let square: f64 = direction.iter().map(|e| e * e).sum();
            approx::assert_relative_eq!(square, 1.0, max_relative = 1e-12);
            below += u32::from(direction[0] < -0.5);
            for (sum, e) in sum.iter_mut().zip(direction) {
                *sum += e;
            }
        }
        // A quarter of the uniform interval, within five standard deviations; likewise the mean of 0.
        assert!((4694..=5306).contains(&below), "{below}");
        assert!(
            sum.iter()
                .all(|sum| sum.abs() < 5.0 * (20_000.0_f64 / 3.0).sqrt()),
            "{sum:?}"
        );
    }

    /// g - X is c (P - X) / 2 where the particle is its own informant, and c ((P - X) + (L - X)) / 3 where L is another's: the
    /// centres of gravity of the published equations, less X.
    #[test]
    fn the_centre_of_gravity_is_the_published_one() {
        let (x, own, local, c) = (2.0_f64, 5.0, -1.0, 1.25);
        let three = (x + (x + c * (own - x)) + (x + c * (local - x))) / 3.0;
        let two = (x + (x + c * (own - x))) / 2.0;
        approx::assert_relative_eq!(pull(c, x, own, Some(local)), three - x, epsilon = 1e-12);
        approx::assert_relative_eq!(pull(c, x, own, None), two - x, epsilon = 1e-12);
    }
}

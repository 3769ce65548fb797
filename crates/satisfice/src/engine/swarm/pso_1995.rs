//! The first particle swarm.

use super::particles::{Attractor, SwarmRules};
use super::schedule::Schedule;
use super::velocity::{Coefficients, VelocitySwarm};
use crate::engine::compiled::both_scalars;
use crate::engine::{Engine, EngineConfig};
use crate::engine_settings;
use crate::scalar::Real;

engine_settings! {
    /// PSO without inertia weight: V := V + c1 r1 (P - X) + c2 r2 (G - X), |V| <= Vmax, c1 = c2 = 2.
    ///
    /// Source: Kennedy, Eberhart 1995, doi 10.1109/ICNN.1995.488968; Vmax of 10 to 20 % of an axis after Eberhart, Shi 2001,
    /// doi 10.1109/CEC.2001.934374. The publication does not say what happens at the bounds; here the space's boundary rule decides.
    ///
    /// ```
    /// use satisfice::{Budget, Search, Space, engine::Pso1995, from_fn};
    /// let disc = from_fn(Space::lattice(2, 100)?, 10.0, |x: &[f64]| (x[0] - 50.0).hypot(x[1] - 20.0));
    /// let engine = Pso1995 { particles: 20, ..Default::default() };
    /// let report = Search::with(engine).run(&disc, &Budget::evaluations(3000))?;
    /// assert!(report.hit_count() > 10);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    pub struct Pso1995 {
        /// Swarm size N.
        pub particles: usize = 30, 1..=1_000_000;
        /// Acceleration c1 towards the personal best.
        pub c1: f64 = 2.0, 0.0..=10.0;
        /// Acceleration c2 towards the best of all.
        pub c2: f64 = 2.0, 0.0..=10.0;
        /// Largest velocity Vmax, as a share of each axis.
        pub v_max: f64 = 0.2, 1e-9..=1.0;
        /// Particles that move between two updates of the attractor: 1 is asynchronous, N once a sweep.
        pub batch: usize = 1, 1..=1_000_000;
        /// Delete hits from the space. The publication does not.
        pub deletion: bool = false;
    }
}

impl EngineConfig for Pso1995 {
    const NAME: &'static str = "pso-1995";
    const SUMMARY: &'static str = "the first particle swarm, without inertia weight";
    const CITATION: &'static str = "Kennedy, Eberhart 1995, doi 10.1109/ICNN.1995.488968";

    both_scalars!();
}

impl Pso1995 {
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        let rules = SwarmRules {
            particles: self.particles,
            batch: self.batch,
            attractor: Attractor::Best,
            deletes: self.deletion,
        };
        let coefficients = Coefficients {
            inertia: Schedule::fixed(1.0),
            cognitive: S::of(self.c1),
            social: S::of(self.c2),
            v_max: S::of(self.v_max),
        };
        Box::new(VelocitySwarm::new(rules, coefficients))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coefficients_are_the_published_ones() {
        let settings = Pso1995::default();
        assert_eq!((settings.c1, settings.c2, settings.v_max), (2.0, 2.0, 0.2));
        assert!(!settings.deletion && !settings.is_scheduled());
    }
}

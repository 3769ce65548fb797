//! The particle swarm with an inertia weight that falls.

use super::particles::{Attractor, SwarmRules};
use super::schedule::Schedule;
use super::velocity::{Coefficients, VelocitySwarm};
use crate::engine::compiled::both_scalars;
use crate::engine::{Engine, EngineConfig};
use crate::engine_settings;
use crate::scalar::Real;

engine_settings! {
    /// PSO with inertia: V := w V + c1 r1 (P - X) + c2 r2 (G - X), w from 0.9 to 0.4 over the budget.
    ///
    /// Source: Shi, Eberhart 1998, doi 10.1109/ICEC.1998.699146; the schedule and Vmax of half an axis after Shi, Eberhart 1999,
    /// doi 10.1109/CEC.1999.785511. Differs from the publication in that w follows the elapsed share of the budget instead of a count
    /// of iterations.
    ///
    /// ```
    /// use satisfice::{Budget, Search, Space, engine::PsoInertia, from_fn};
    /// let disc = from_fn(Space::lattice(2, 100)?, 10.0, |x: &[f64]| (x[0] - 50.0).hypot(x[1] - 20.0));
    /// let engine = PsoInertia { w_end: 0.5, ..Default::default() };
    /// let report = Search::with(engine).run(&disc, &Budget::evaluations(3000))?;
    /// assert!(report.hit_count() > 10);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    pub struct PsoInertia {
        /// Swarm size N.
        pub particles: usize = 30, 1..=1_000_000;
        /// Inertia weight w at the start.
        pub w: f64 = 0.9, 0.0..=2.0;
        /// Inertia weight at the end of the budget.
        pub w_end: f64 = 0.4, 0.0..=2.0;
        /// Acceleration c1 towards the personal best.
        pub c1: f64 = 2.0, 0.0..=10.0;
        /// Acceleration c2 towards the best of all.
        pub c2: f64 = 2.0, 0.0..=10.0;
        /// Largest velocity Vmax, as a share of each axis.
        pub v_max: f64 = 0.5, 1e-9..=1.0;
        /// Particles that move between two updates of the attractor: 1 is asynchronous, N once a sweep.
        pub batch: usize = 1, 1..=1_000_000;
        /// Delete hits from the space. The publication does not.
        pub deletion: bool = false;
    }
}

impl EngineConfig for PsoInertia {
    const NAME: &'static str = "pso-inertia";
    const SUMMARY: &'static str = "particle swarm with an inertia weight that falls";
    const CITATION: &'static str = "Shi, Eberhart 1998, doi 10.1109/ICEC.1998.699146";

    both_scalars!();

    fn is_scheduled(&self) -> bool {
        self.w != self.w_end
    }
}

impl PsoInertia {
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        let rules = SwarmRules {
            particles: self.particles,
            batch: self.batch,
            attractor: Attractor::Best,
            deletes: self.deletion,
        };
        let coefficients = Coefficients {
            inertia: Schedule::linear(self.w, self.w_end),
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

    /// w(t) = 0.9 - 0.5 t, t the share of the budget (Shi, Eberhart 1999).
    #[test]
    fn inertia_falls_from_0_9_to_0_4_in_a_straight_line() {
        let settings = PsoInertia::default();
        let inertia = Schedule::<f64>::linear(settings.w, settings.w_end);
        for share in [0.0, 0.2, 0.5, 1.0] {
            approx::assert_relative_eq!(inertia.at(|| share), 0.9 - 0.5 * share, max_relative = 1e-14);
        }
        assert!(settings.is_scheduled());
        let fixed = PsoInertia {
            w_end: 0.9,
            ..settings
        };
        assert!(!fixed.is_scheduled());
    }
}

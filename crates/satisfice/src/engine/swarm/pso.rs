//! The particle swarm with constriction, attracted by the best.

use super::particles::{Attractor, SwarmRules};
use super::schedule::Schedule;
use super::velocity::{Coefficients, VelocitySwarm};
use crate::engine::compiled::both_scalars;
use crate::engine::{Engine, EngineConfig};
use crate::engine_settings;
use crate::scalar::Real;

engine_settings! {
    /// PSO with constriction: V := chi (V + phi/2 r1 (P - X) + phi/2 r2 (G - X)).
    ///
    /// Source: Clerc, Kennedy 2002, doi 10.1109/4235.985692: phi = 4.1, hence chi = 0.7298; Vmax of half an axis after Eberhart, Shi
    /// 2000, doi 10.1109/CEC.2000.870279.
    ///
    /// ```
    /// use satisfice::{Budget, Search, Space, engine::Pso, from_fn};
    /// let disc = from_fn(Space::lattice(2, 100)?, 10.0, |x: &[f64]| (x[0] - 50.0).hypot(x[1] - 20.0));
    /// let engine = Pso { particles: 20, deletion: true, ..Default::default() };
    /// let report = Search::with(engine).run(&disc, &Budget::evaluations(3000))?;
    /// assert!(report.hit_count() > 10);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    pub struct Pso {
        /// Swarm size N.
        pub particles: usize = 30, 1..=1_000_000;
        /// Total acceleration phi = c1 + c2; chi = 2 / |2 - phi - sqrt(phi^2 - 4 phi)|.
        pub phi: f64 = 4.1, 4.0..=10.0;
        /// Largest velocity Vmax, as a share of each axis.
        pub v_max: f64 = 0.5, 1e-9..=1.0;
        /// Particles that move between two updates of the attractor: 1 is asynchronous, N once a sweep.
        pub batch: usize = 1, 1..=1_000_000;
        /// Delete hits from the space. The publication does not.
        pub deletion: bool = false;
    }
}

impl EngineConfig for Pso {
    const NAME: &'static str = "pso";
    const SUMMARY: &'static str = "particle swarm with constriction, attracted by the best";
    const CITATION: &'static str = "Clerc, Kennedy 2002, doi 10.1109/4235.985692";

    both_scalars!();
}

impl Pso {
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        let rules = SwarmRules {
            particles: self.particles,
            batch: self.batch,
            attractor: Attractor::Best,
            deletes: self.deletion,
        };
        Box::new(VelocitySwarm::new(rules, constriction(self.phi, self.v_max)))
    }
}

/// The coefficients of a constricted swarm.
pub(super) fn constriction<S: Real>(phi: f64, v_max: f64) -> Coefficients<S> {
    let chi = chi(phi);
    Coefficients {
        inertia: Schedule::fixed(chi),
        cognitive: S::of(chi * phi / 2.0),
        social: S::of(chi * phi / 2.0),
        v_max: S::of(v_max),
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

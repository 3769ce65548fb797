//! The paper's engine: a quantum-behaved particle swarm attracted by the latest hit.

use super::particles::{Attractor, SwarmRules};
use super::quantum::QuantumSwarm;
use super::schedule::Schedule;
use crate::engine::compiled::both_scalars;
use crate::engine::{Engine, EngineConfig};
use crate::engine_settings;
use crate::scalar::Real;

engine_settings! {
    /// Latest-hit QPSO, in the reading of the project's docs:
    ///
    /// ```text
    /// C_prev = {}
    /// each slice:
    ///   X = N random members of C_prev if |C_prev| >= N, else all of C_prev and uniform points
    ///   P = X;  f_i = F(X_i), evaluated again;  C = {};  G = none    (hits among the start points enter C)
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
    /// Eq. 2 is
    ///
    /// ```text
    /// X := phi P + (1 - phi) G ± alpha |mbest - X| ln(1/u),   phi ~ U(0, 1), u ~ U(0, 1], fair sign, on each axis
    /// ```
    ///
    /// N = 30 and alpha = 1 are the published values. Source: Chen, Ye, An, Wang 2012, doi 10.3923/itj.2012.536.539.
    ///
    /// ```
    /// use satisfice::{Budget, Search, Space, engine::LatestHitQpso, from_fn};
    /// let problem = from_fn(Space::lattice(2, 100)?, 2.5, |x: &[f64]| (x[0] - 50.0).hypot(x[1] - 20.0));
    /// let engine = LatestHitQpso { particles: 60, ..Default::default() };
    /// let report = Search::with(engine).run(&problem, &Budget::evaluations(5_000))?;
    /// assert!(report.hit_count() > 15);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    pub struct LatestHitQpso {
        /// Swarm size N.
        pub particles: usize = 30, 1..=1_000_000;
        /// Contraction-expansion coefficient alpha. A particle stays bounded below 1.781.
        pub alpha: f64 = 1.0, 0.0..=10.0;
        /// Particles that move between two updates of the attractor: 1 is asynchronous, N once a sweep.
        pub batch: usize = 1, 1..=1_000_000;
    }
}

impl EngineConfig for LatestHitQpso {
    const NAME: &'static str = "latest-hit-qpso";
    const SUMMARY: &'static str =
        "the paper's swarm: quantum-behaved, attracted by the latest hit, hits deleted";
    const CITATION: &'static str = "Chen, Ye, An, Wang 2012, doi 10.3923/itj.2012.536.539";

    both_scalars!();
}

impl LatestHitQpso {
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        let rules = SwarmRules {
            particles: self.particles,
            batch: self.batch,
            attractor: Attractor::LatestHit,
            deletes: true,
        };
        Box::new(QuantumSwarm::new(rules, Schedule::fixed(self.alpha)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// N = 30 particles and alpha = 1 (Chen et al. 2012).
    #[test]
    fn the_defaults_are_the_published_ones() {
        let settings = LatestHitQpso::default();
        assert_eq!((settings.particles, settings.alpha, settings.batch), (30, 1.0, 1));
    }
}

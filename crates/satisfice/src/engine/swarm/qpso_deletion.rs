//! QPSO attracted by the best, with hits deleted: the paper's engine except for its attractor.

use super::particles::{Attractor, SwarmRules};
use super::quantum::QuantumSwarm;
use super::schedule::Schedule;
use crate::engine::compiled::both_scalars;
use crate::engine::{Engine, EngineConfig};
use crate::engine_settings;
use crate::scalar::Real;

engine_settings! {
    /// QPSO whose hits are deleted from the space. It differs from [`LatestHitQpso`](super::LatestHitQpso) in the attractor only: G is
    /// the best of the personal bests.
    ///
    /// Source: Sun, Feng, Xu 2004, doi 10.1109/CEC.2004.1330875. Differs from the publication in the deletion, and in that a hit
    /// becomes P_i even if it is worse than the P_i that was deleted.
    ///
    /// ```
    /// use satisfice::{Budget, Search, Space, engine::QpsoDeletion, from_fn};
    /// let disc = from_fn(Space::lattice(2, 100)?, 10.0, |x: &[f64]| (x[0] - 50.0).hypot(x[1] - 20.0));
    /// let engine = QpsoDeletion { alpha: 0.9, ..Default::default() };
    /// let report = Search::with(engine).run(&disc, &Budget::evaluations(3000))?;
    /// assert!(report.hit_count() > 10);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    pub struct QpsoDeletion {
        /// Swarm size N.
        pub particles: usize = 30, 1..=1_000_000;
        /// Contraction-expansion coefficient alpha. A particle stays bounded below 1.781.
        pub alpha: f64 = 1.0, 0.0..=10.0;
        /// Particles that move between two updates of the attractor: 1 is asynchronous, N once a sweep.
        pub batch: usize = 1, 1..=1_000_000;
    }
}

impl EngineConfig for QpsoDeletion {
    const NAME: &'static str = "qpso-deletion";
    const SUMMARY: &'static str = "quantum-behaved swarm, attracted by the best, hits deleted";
    const CITATION: &'static str = "Sun, Feng, Xu 2004, doi 10.1109/CEC.2004.1330875";

    both_scalars!();
}

impl QpsoDeletion {
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        let rules = SwarmRules {
            particles: self.particles,
            batch: self.batch,
            attractor: Attractor::Best,
            deletes: true,
        };
        Box::new(QuantumSwarm::new(rules, Schedule::fixed(self.alpha)))
    }
}

//! The particle swarm with constriction, attracted by the latest hit.

use super::particles::{Attractor, SwarmRules};
use super::pso::constriction;
use super::velocity::VelocitySwarm;
use crate::engine::compiled::both_scalars;
use crate::engine::{Engine, EngineConfig};
use crate::engine_settings;
use crate::scalar::Real;

engine_settings! {
    /// [`Pso`](super::Pso) with the paper's rules: the latest hit attracts, or the best while there is none; hits are deleted from the
    /// space and become personal bests.
    ///
    /// Source: Clerc, Kennedy 2002, doi 10.1109/4235.985692, with the attractor of Chen et al. 2012, doi 10.3923/itj.2012.536.539.
    ///
    /// ```
    /// use satisfice::{Budget, Search, Space, engine::PsoLatestHit, from_fn};
    /// let disc = from_fn(Space::lattice(2, 100)?, 10.0, |x: &[f64]| (x[0] - 50.0).hypot(x[1] - 20.0));
    /// let engine = PsoLatestHit { particles: 20, ..Default::default() };
    /// let report = Search::with(engine).run(&disc, &Budget::evaluations(3000))?;
    /// assert!(report.hit_count() > 10);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    pub struct PsoLatestHit {
        /// Swarm size N.
        pub particles: usize = 30, 1..=1_000_000;
        /// Total acceleration phi = c1 + c2; chi = 2 / |2 - phi - sqrt(phi^2 - 4 phi)|.
        pub phi: f64 = 4.1, 4.0..=10.0;
        /// Largest velocity Vmax, as a share of each axis.
        pub v_max: f64 = 0.5, 1e-9..=1.0;
        /// Particles that move between two updates of the attractor: 1 is asynchronous, N once a sweep.
        pub batch: usize = 1, 1..=1_000_000;
    }
}

impl EngineConfig for PsoLatestHit {
    const NAME: &'static str = "pso-latest-hit";
    const SUMMARY: &'static str =
        "particle swarm with constriction, attracted by the latest hit, hits deleted";
    const CITATION: &'static str =
        "Clerc, Kennedy 2002, doi 10.1109/4235.985692; Chen et al. 2012, doi 10.3923/itj.2012.536.539";

    both_scalars!();
}

impl PsoLatestHit {
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        let rules = SwarmRules {
            particles: self.particles,
            batch: self.batch,
            attractor: Attractor::LatestHit,
            deletes: true,
        };
        Box::new(VelocitySwarm::new(rules, constriction(self.phi, self.v_max)))
    }
}

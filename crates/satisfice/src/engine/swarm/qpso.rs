//! QPSO as published: attracted by the best, nothing deleted.

use super::particles::{Attractor, SwarmRules};
use super::quantum::QuantumSwarm;
use super::schedule::Schedule;
use crate::engine::compiled::both_scalars;
use crate::engine::{Engine, EngineConfig};
use crate::engine_settings;
use crate::scalar::Real;

engine_settings! {
    /// QPSO: G is the best of the personal bests. A point becomes P_i if it is better, hit or not; hits stay in the space.
    ///
    /// The default of alpha is 1 as in the paper's engine, so that a comparison shows the attractor alone. Usual for minimisation: 0.75,
    /// or a line from 1 to 0.5 (`alpha_end`).
    ///
    /// Source: Sun, Feng, Xu 2004, doi 10.1109/CEC.2004.1330875; alpha after Sun et al. 2012, doi 10.1162/EVCO_a_00049. Differs from the
    /// publication in the schedule, which follows the elapsed share of the budget instead of a count of iterations.
    ///
    /// ```
    /// use satisfice::{Budget, Search, Space, engine::Qpso, from_fn};
    /// let disc = from_fn(Space::lattice(2, 100)?, 10.0, |x: &[f64]| (x[0] - 50.0).hypot(x[1] - 20.0));
    /// let engine = Qpso { alpha: 0.9, alpha_end: Some(0.5), ..Default::default() };
    /// let report = Search::with(engine).run(&disc, &Budget::evaluations(3000))?;
    /// assert!(report.hit_count() > 10);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    pub struct Qpso {
        /// Swarm size N.
        pub particles: usize = 30, 1..=1_000_000;
        /// Contraction-expansion coefficient alpha. A particle stays bounded below 1.781.
        pub alpha: f64 = 1.0, 0.0..=10.0;
        /// Alpha at the end of the budget, reached in a straight line; fixed at alpha by default.
        pub alpha_end: Option<f64> = None, 0.0..=10.0;
        /// Particles that move between two updates of the attractor: 1 is asynchronous, N once a sweep.
        pub batch: usize = 1, 1..=1_000_000;
    }
}

impl EngineConfig for Qpso {
    const NAME: &'static str = "qpso";
    const SUMMARY: &'static str = "quantum-behaved swarm, attracted by the best, nothing deleted";
    const CITATION: &'static str = "Sun, Feng, Xu 2004, doi 10.1109/CEC.2004.1330875";

    both_scalars!();

    fn is_scheduled(&self) -> bool {
        self.alpha_end.is_some_and(|end| end != self.alpha)
    }
}

impl Qpso {
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        let rules = SwarmRules {
            particles: self.particles,
            batch: self.batch,
            attractor: Attractor::Best,
            deletes: false,
        };
        let alpha = Schedule::linear(self.alpha, self.alpha_end.unwrap_or(self.alpha));
        Box::new(QuantumSwarm::new(rules, alpha))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sun et al. 2012: alpha from 1 to 0.5 in a straight line.
    #[test]
    fn alpha_follows_the_budget_only_where_an_end_is_given() {
        assert!(!Qpso::default().is_scheduled());
        let falling = Qpso {
            alpha_end: Some(0.5),
            ..Qpso::default()
        };
        assert!(falling.is_scheduled());
        let alpha = Schedule::<f64>::linear(falling.alpha, 0.5);
        approx::assert_relative_eq!(alpha.at(|| 0.25), 0.875, max_relative = 1e-15);
    }
}

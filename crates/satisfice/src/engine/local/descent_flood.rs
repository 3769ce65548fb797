//! Restarted descent, and a flood fill from every hit.

use super::descent::RestartedDescent;
use super::flood::{Flood, Order};
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::compiled::both_scalars;
use crate::engine::{Ask, Engine, EngineConfig, Origin};
use crate::engine_settings;
use crate::scalar::Real;
use crate::seed::SearchRng;

engine_settings! {
    /// [`Descent`](super::Descent), and before the next descent a flood fill: from every hit its neighbours, their neighbours if they
    /// are hits, and so on.
    ///
    /// A slice that begins with the verified hits of the one before floods from them first.
    ///
    /// After Guy, Debunne 2004 (INRIA RR-5136) and Kimmerle, Nesme, Faure 2004 (VMV).
    ///
    /// ```
    /// use satisfice::{Budget, Search, Space, engine::DescentFlood, from_fn};
    /// let disc = from_fn(Space::lattice(2, 100)?, 10.0, |x: &[f64]| (x[0] - 50.0).hypot(x[1] - 20.0));
    /// let engine = DescentFlood { step: 0.1, ..Default::default() };
    /// let report = Search::with(engine).run(&disc, &Budget::evaluations(3000))?;
    /// assert!(report.hit_count() > 10);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    pub struct DescentFlood {
        /// First step on continuous axes, as a share of each.
        pub step: f64 = 0.25, 1e-12..=1.0;
        /// Shortest step on continuous axes, as a share of each.
        pub shortest: f64 = 1e-6, 1e-15..=1.0;
        /// Shortest distance between a hit and the next point of the flood on continuous axes, as a share of each.
        pub flood_step: f64 = 1e-3, 1e-12..=1.0;
    }
}

impl EngineConfig for DescentFlood {
    const NAME: &'static str = "descent-flood";
    const SUMMARY: &'static str =
        "restarted descent, then a breadth-first flood fill of every hit's neighbourhood";
    const CITATION: &'static str =
        "after Guy, Debunne 2004, INRIA RR-5136, and Kimmerle, Nesme, Faure 2004, VMV";

    both_scalars!();
}

impl DescentFlood {
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        Box::new(FloodingDescent {
            descent: RestartedDescent::new(self.step, self.shortest),
            flood: Flood::new(self.flood_step, Order::First),
            flooding: false,
        })
    }
}

/// The engine of [`DescentFlood`].
#[derive(Debug)]
struct FloodingDescent<S> {
    descent: RestartedDescent<S>,
    flood: Flood<S>,
    /// Whether the last proposals were the flood's.
    flooding: bool,
}

impl<S: Real> Engine<S> for FloodingDescent<S> {
    fn begin(&mut self, _: &dyn Context<S>) {
        self.descent.begin();
        self.flood.clear();
        self.flooding = false;
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        self.flooding = self.flood.ask(context, out);
        if !self.flooding {
            self.descent.propose(context, rng, out);
        }
        Ask::More
    }

    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        self.flood.add_hits(context.space(), batch, outcomes);
        if origin == Origin::Engine && !self.flooding {
            self.descent.learn(batch.point(0), outcomes[0]);
        } else if origin == Origin::Start {
            self.descent.keep_starts(batch, outcomes);
        }
    }

    crate::saved_fields!(descent, flood, flooding);
}

//! An engine with a flood fill beside it.

use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::local::flood::{Flood, Order};
use crate::engine::{Answers, Ask, Engine, Origin, WarmStart};
use crate::error::Error;
use crate::report::SourceCount;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::state::{Part, Reader, Saved, State};

/// Where the search for the nearest point that is no known hit begins, as a share of each continuous axis.
const FIRST_STEP: f64 = 1e-3;

/// An engine and a flood fill that take turns.
pub(in crate::engine) struct FloodFill<S> {
    inner: Box<dyn Engine<S>>,
    flood: Flood<S>,
    /// Whether the last proposals were the flood's.
    flooding: bool,
    /// Points that the engine has proposed, and the flood.
    proposed: [u64; 2],
    /// The engine's last word, once it has nothing more to propose.
    rest: Option<Ask>,
}

impl<S: Real> FloodFill<S> {
    pub(in crate::engine) fn around(engine: Box<dyn Engine<S>>) -> Self {
        Self {
            inner: engine,
            flood: Flood::new(FIRST_STEP, Order::First),
            flooding: false,
            proposed: [0, 0],
            rest: None,
        }
    }
}

impl<S: Real> Engine<S> for FloodFill<S> {
    fn begin(&mut self, context: &dyn Context<S>) {
        self.flood.clear();
        self.flooding = false;
        self.proposed = [0, 0];
        self.rest = None;
        self.inner.begin(context);
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        let [own, flooded] = self.proposed;
        self.flooding = (flooded <= own || self.rest.is_some()) && self.flood.ask(context, out);
        if self.flooding {
            self.proposed[1] += out.len() as u64;
            return Ask::More;
        }
        if let Some(rest) = self.rest {
            return rest;
        }
        let ask = self.inner.ask(context, rng, out);
        self.proposed[0] += out.len() as u64;
        if ask == Ask::Exhausted {
            // There may be hits left to flood from, among these proposals, too.
            self.rest = Some(ask);
            return Ask::More;
        }
        ask
    }

    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        self.flood.add_hits(context.space(), batch, outcomes);
        let origin = if origin == Origin::Engine && self.flooding {
            Origin::Exhaustion
        } else {
            origin
        };
        self.inner.tell(context, batch, outcomes, origin);
    }

    fn deletes(&self) -> bool {
        self.inner.deletes()
    }
    fn warm_start(&self) -> WarmStart {
        self.inner.warm_start()
    }
    fn answers(&self) -> Answers {
        self.inner.answers().in_batches()
    }
    fn probes(&self) -> f64 {
        self.inner.probes()
    }
    fn sources(&self) -> Vec<SourceCount> {
        self.inner.sources()
    }

    fn save(&self, state: &mut State) {
        Part::save(&self.flood, state);
        Saved::save(&self.flooding, state);
        Saved::save(&self.proposed, state);
        Saved::save(&self.rest.is_some(), state);
        self.inner.save(state);
    }

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.flood.restore(from)?;
        self.flooding = from.read()?;
        self.proposed = from.read()?;
        self.rest = from.read::<bool>()?.then_some(Ask::Exhausted);
        self.inner.restore(from)
    }
}

#[cfg(test)]
mod tests {
    use crate::engine::{ConfiguredEngine, find};
    use crate::testing::engine::check;
    use crate::{Budget, Search, Space, from_fn};

    #[test]
    fn engines_of_every_kind_keep_to_the_laws() {
        // Two that delete nothing, one that is exact, one with neighbourhoods of its own.
        for name in [
            "random",
            "qpso",
            "pso",
            "latest-hit-qpso",
            "branch-and-bound",
            "portfolio",
        ] {
            let found = check::<f64>(&ConfiguredEngine::named(name).unwrap().flood_fill());
            assert_eq!(found.unwrap(), [], "{name}");
        }
    }

    #[test]
    fn a_cluster_that_is_touched_is_found_whole() {
        // 1,245 lattice points of a disc in a million: uniform sampling alone sees some of them.
        let problem = from_fn(Space::lattice(2, 1000).unwrap(), 20.0, |x: &[f64]| {
            (x[0] - 700.0).hypot(x[1] - 300.0)
        })
        .boxed();
        let budget = Budget::evaluations(20_000);
        let hits = |exhaust| {
            let engine = find("random").unwrap().configure([("exhaust", exhaust)]).unwrap();
            let report = Search::with(engine).seed(1).run(&problem, &budget).unwrap();
            report.hit_count()
        };
        let all = (0..1_000_000)
            .filter(|i| (f64::from(i % 1000) - 700.0).hypot(f64::from(i / 1000) - 300.0) < 20.0)
            .count();
        assert_eq!(hits("yes"), all);
        assert!(hits("no") < all / 10);
    }

    #[test]
    fn discovery_keeps_every_other_evaluation() {
        // Everything is a hit: the neighbourhoods never end.
        let problem = from_fn(Space::lattice(2, 1000).unwrap(), 2.0, |_: &[f64]| 1.0).boxed();
        let engine = ConfiguredEngine::named("random").unwrap().flood_fill();
        let report = Search::with(engine)
            .seed(1)
            .run(&problem, &Budget::evaluations(4000))
            .unwrap();
        // Uniform points are far from all hits before them, neighbours are next to one.
        let mut before: Vec<(f64, f64)> = Vec::new();
        let mut far = 0;
        for hit in report.hits() {
            let at = (hit.solution.coordinates[0], hit.solution.coordinates[1]);
            let next_to = |other: &(f64, f64)| (other.0 - at.0).abs() + (other.1 - at.1).abs() <= 1.0;
            far += u32::from(!before.iter().any(next_to));
            before.push(at);
        }
        assert!((1900..=2100).contains(&far), "{far} of 4000 are discoveries");
    }
}

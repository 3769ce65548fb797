//! Uniform random sampling: the baseline.

use crate::batch::{Batch, Outcome};
use crate::context::{Context, points_between_looks};
use crate::engine::compiled::both_scalars;
use crate::engine::{Answers, Ask, Engine, EngineConfig, Origin};
use crate::engine_settings;
use crate::scalar::Real;
use crate::seed::SearchRng;

engine_settings! {
    /// Every point independent and uniform in the space, with replacement.
    ///
    /// ```
    /// use satisfice::{Budget, Search, Space, engine::Random, from_fn};
    /// let disc = from_fn(Space::lattice(2, 100)?, 10.0, |x: &[f64]| (x[0] - 50.0).hypot(x[1] - 20.0));
    /// let engine = Random { batch: 16, ..Default::default() };
    /// let report = Search::with(engine).run(&disc, &Budget::evaluations(3000))?;
    /// assert!(report.hit_count() > 10);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    pub struct Random {
        /// Points proposed at once; does not change the hits.
        pub batch: usize = 64, 1..=1 << 20;
    }
}

impl EngineConfig for Random {
    const NAME: &'static str = "random";
    const SUMMARY: &'static str = "uniform random sampling, the baseline";
    const CITATION: &'static str = "none needed";

    both_scalars!();
}

impl Random {
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        Box::new(UniformSampler { batch: self.batch })
    }
}

/// The engine of [`Random`].
#[derive(Debug)]
struct UniformSampler {
    batch: usize,
}

impl<S: Real> Engine<S> for UniformSampler {
    fn begin(&mut self, _context: &dyn Context<S>) {}

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        let space = context.space();
        for _ in 0..self.batch.min(points_between_looks(space.dimension())) {
            out.push_with(|position| rng.position(space, position));
        }
        Ask::More
    }

    fn tell(&mut self, _: &dyn Context<S>, _: &Batch<S>, _: &[Outcome<S>], _: Origin) {}

    fn answers(&self) -> Answers {
        Answers::AnyOrder
    }

    crate::saved_fields!();
}

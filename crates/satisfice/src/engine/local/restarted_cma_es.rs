//! Restarted (1+1)-CMA-ES with recombination of hits: for the many optima of a function of continuous coordinates.

use super::luby::luby;
use super::one_plus_one::Mutation;
use super::pairs_of_hits::PairsOfHits;
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::compiled::both_scalars;
use crate::engine::low_discrepancy::EvenPoints;
use crate::engine::{Ask, Engine, EngineConfig, Origin};
use crate::engine_settings;
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::Space;
use crate::state::{Part, Reader, State};

engine_settings! {
    /// Two sources of candidates, drawn by their yield:
    ///
    /// - local searches by (1+1)-CMA-ES (Igel, Suttorp, Hansen 2006) from starts that cover the space evenly, with a first step drawn
    ///   log-uniformly. They end at a hit, at a known hit, or when they stall; how long a stall may last follows the universal restart sequence (Luby,
    ///   Sinclair, Zuckerman 1993);
    /// - recombinations of all pairs of hits; the next searches start at those that just miss.
    ///
    /// Steps on integer axes are rounded, so this engine suits continuous axes. Hits are deleted.
    ///
    /// ```
    /// use satisfice::{Budget, Search, Space, engine::RestartedCmaEs, from_fn};
    /// let disc = from_fn(Space::lattice(2, 100)?, 10.0, |x: &[f64]| (x[0] - 50.0).hypot(x[1] - 20.0));
    /// let engine = RestartedCmaEs { searches: 4, ..Default::default() };
    /// let report = Search::with(engine).run(&disc, &Budget::evaluations(3000))?;
    /// assert!(report.hit_count() > 10);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    pub struct RestartedCmaEs {
        /// Searches at a time, and candidates of a batch: many feed more threads.
        pub searches: usize = 8, 1..=65_536;
        /// Largest first step, as a share of the axes.
        pub step: f64 = 0.1, 1e-12..=1.0;
        /// Smallest first step, as a share of the axes; first steps are drawn log-uniformly.
        pub smallest_step: f64 = 0.001, 1e-12..=1.0;
        /// Evaluations without improvement, for each axis, after which the shortest run of the restart sequence ends.
        pub patience: u64 = 20, 1..=1_000_000_000;
    }
}

impl EngineConfig for RestartedCmaEs {
    const NAME: &'static str = "restarted-cma-es";
    const SUMMARY: &'static str = "restarted (1+1)-CMA-ES for continuous axes, and recombination of hits";
    const CITATION: &'static str = "this project; parts after Igel, Suttorp, Hansen 2006, doi 10.1145/1143997.1144082, and Luby, Sinclair, Zuckerman 1993, doi 10.1016/0020-0190(93)90029-9";

    both_scalars!();
}

impl RestartedCmaEs {
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        let steps = (self.smallest_step, self.step);
        Box::new(Searches::new(steps, self.patience, self.searches))
    }
}

/// Steps below this share of the axes are too short to tell.
const CONVERGED: f64 = 1e-9;
/// The first step from a near miss.
const REFINING_STEP: f64 = 0.003;

/// One local search: keeps its best point, accepts what is no worse.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
struct Climb<S> {
    position: Vec<S>,
    fitness: S,
    running: bool,
    /// Evaluations since the last improvement, and how many end the search.
    stalled: u64,
    patience: u64,
    mutation: Mutation,
}

/// The engine of [`RestartedCmaEs`].
#[derive(Debug)]
struct Searches<S> {
    step: (f64, f64),
    patience: u64,
    climbs: Vec<Climb<S>>,
    restarts: u64,
    /// Where searches start.
    even: EvenPoints,
    recombined: PairsOfHits<S>,
    /// Whether the candidates of this batch are steps of searches.
    stepped: bool,
}

impl<S: Real> Searches<S> {
    /// First steps between these shares of the axes.
    fn new(step: (f64, f64), patience: u64, searches: usize) -> Self {
        let climb = Climb {
            position: Vec::new(),
            fitness: S::infinity(),
            running: false,
            stalled: 0,
            patience: 0,
            mutation: Mutation::default(),
        };
        Self {
            step,
            patience,
            climbs: vec![climb; searches],
            restarts: 0,
            even: EvenPoints::default(),
            recombined: PairsOfHits::new(0),
            stepped: false,
        }
    }

    /// Starts search `index` again: from the best near miss every other time, else anywhere.
    fn start(&mut self, index: usize, space: &Space<S>, rng: &mut SearchRng) {
        self.restarts += 1;
        let climb = &mut self.climbs[index];
        let dimension = space.dimension();
        climb.running = true;
        climb.stalled = 0;
        climb.patience = luby(self.restarts)
            .saturating_mul(self.patience)
            .saturating_mul(dimension as u64);
        climb.position.resize(dimension, S::zero());
        if self.restarts.is_multiple_of(2)
            && self.recombined.take_best_miss(|position, fitness| {
                climb.position.copy_from_slice(position);
                climb.fitness = fitness;
            })
        {
            climb.mutation.reset(dimension, REFINING_STEP);
            return;
        }
        self.even.draw(space, rng, &mut climb.position);
        climb.fitness = S::infinity();
        let (smallest, largest) = self.step;
        climb
            .mutation
            .reset(dimension, largest * (smallest / largest).powf(rng.uniform()));
    }
}

impl<S: Real> Climb<S> {
    /// Takes what became of a step.
    fn learn(&mut self, position: &[S], outcome: Outcome<S>, converged: f64) {
        // The basin's hit is found, or was found before.
        if outcome.is_hit() || outcome == Outcome::Deleted {
            self.running = false;
            return;
        }
        let fitness = outcome.fitness();
        if fitness == S::infinity() && self.fitness == S::infinity() {
            // The start failed, and there is nowhere to go from there.
            self.running = false;
            return;
        }
        self.stalled = if fitness < self.fitness {
            0
        } else {
            self.stalled + 1
        };
        let no_worse = fitness <= self.fitness;
        if self.fitness < S::infinity() {
            self.mutation.adapt(no_worse);
        }
        // Steps to equal fitness cross plateaus.
        if no_worse {
            self.position.copy_from_slice(position);
            self.fitness = fitness;
        }
        self.running = self.mutation.sigma >= converged && self.stalled <= self.patience;
    }
}

/// The shortest step that can make a difference, as a share of the axes: half a cell where all axes are integer.
fn converged<S: Real>(space: &Space<S>) -> f64 {
    let widest = space.axes().iter().map(|axis| {
        if axis.is_integer() {
            axis.width().f64()
        } else {
            f64::INFINITY
        }
    });
    (0.5 / widest.fold(0.0, f64::max)).clamp(CONVERGED, 0.5)
}

impl<S: Real> Engine<S> for Searches<S> {
    fn begin(&mut self, context: &dyn Context<S>) {
        self.recombined = PairsOfHits::new(context.space().dimension());
        self.even = EvenPoints::default();
        for climb in &mut self.climbs {
            climb.running = false;
        }
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        if self.recombined.are_next(rng) {
            self.recombined.propose(self.climbs.len(), context, rng, out);
        }
        self.stepped = out.is_empty();
        if !self.stepped {
            return Ask::More;
        }
        let space = context.space();
        for index in 0..self.climbs.len() {
            if !self.climbs[index].running {
                self.start(index, space, rng);
            }
            let climb = &mut self.climbs[index];
            out.push_with(|position| {
                position.copy_from_slice(&climb.position);
                // The first evaluation is that of the start.
                if climb.fitness < S::infinity() {
                    let widths = space.axes().iter().map(crate::Axis::width);
                    climb.mutation.apply(rng, widths, position);
                }
            });
        }
        Ask::More
    }

    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        let space = context.space();
        self.recombined.take_hits(space, batch, outcomes);
        let is_own = origin == Origin::Engine;
        if origin == Origin::Start || is_own && !self.stepped {
            self.recombined.keep_misses(batch, outcomes);
        }
        if is_own && self.stepped {
            self.recombined.count_searches(outcomes);
            let converged = converged(space);
            let told = batch.points().zip(outcomes);
            for (climb, (position, &outcome)) in self.climbs.iter_mut().zip(told) {
                climb.learn(position, outcome, converged);
            }
        } else if is_own {
            self.recombined.count_recombinations(outcomes);
        }
    }

    fn save(&self, state: &mut State) {
        Part::save(self, state);
    }

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        let searches = self.climbs.len();
        Part::restore(self, from)?;
        let dimension = self.recombined.dimension();
        let of_space = |climb: &Climb<S>| {
            !climb.running || climb.position.len() == dimension && climb.mutation.fits(dimension)
        };
        let fits = self.climbs.len() == searches
            && self.recombined.fit(dimension)
            && self.climbs.iter().all(of_space);
        fits.then_some(())
            .ok_or_else(|| Error::State("its parts do not fit each other".to_owned()))
    }
}

impl<S: Real> Part for Searches<S> {
    crate::saved_fields!(climbs, restarts, even, recombined, stepped);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Budget, Located, SatisficingProblem, Search};

    /// Maxima of a product of narrow and wide waves, 25 of them; the narrow ones have widths of a 25th of the wide ones.
    struct Waves(Space<f64>);

    impl SatisficingProblem for Waves {
        type Scalar = f64;
        type Solution = Located<f64>;
        fn space(&self) -> &Space<f64> {
            &self.0
        }
        fn threshold(&self) -> f64 {
            1e-6
        }
        fn decode(&self, values: &[f64]) -> Located<f64> {
            Located::new(values, 1e-2)
        }
        fn fitness(&self, solution: &Located<f64>) -> f64 {
            // Five waves an axis, each 2.25 times as wide as the one before.
            let turns = |x: &f64| x.ln() / 2.25_f64.ln();
            solution
                .coordinates
                .iter()
                .map(|x| 1.0 - (2.0 * core::f64::consts::PI * turns(x)).cos())
                .sum()
        }
    }

    fn waves() -> Waves {
        let axis = || Axis::continuous(2.25_f64.powf(-0.5), 2.25_f64.powf(4.5));
        Waves(Space::new(vec![axis(), axis()]).unwrap())
    }

    #[test]
    fn all_maxima_of_narrow_and_wide_waves_are_found_with_a_few_evaluations() {
        let problem = waves();
        for seed in 0..10 {
            let mut search = Search::with(RestartedCmaEs::default()).seed(seed);
            let report = search
                .run(&problem, &Budget::evaluations(40_000).and_hits(25))
                .unwrap();
            assert_eq!(report.hits().len(), 25, "seed {seed}");
            for hit in report.hits() {
                for x in &hit.solution.coordinates {
                    let turns = x.ln() / 2.25_f64.ln();
                    assert!((turns - turns.round()).abs() < 1e-3, "{x}");
                }
            }
        }
    }
}

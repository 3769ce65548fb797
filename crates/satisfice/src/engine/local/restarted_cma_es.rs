//! Restarted (1+1)-CMA-ES with recombination of hits: for the many optima of a function of continuous coordinates.

use super::bandit::Arm;
use super::luby::luby;
use super::one_plus_one::Mutation;
use super::recombination::Pairs;
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::compiled::both_scalars;
use crate::engine::hit_list::HitList;
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
/// Near misses that are kept to be searched from.
const MISSES: usize = 16;
/// Recombinations that are examined for one that is not a known hit, for each candidate of a batch.
const LOOKS: usize = 8;

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

/// A recombination that was no hit.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
struct Miss<S> {
    position: Vec<S>,
    fitness: S,
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
    hits: HitList<S>,
    pairs: Pairs,
    /// Near misses, the first `kept` of them; what stands behind is memory.
    misses: Vec<Miss<S>>,
    kept: usize,
    /// What searches and recombinations have yielded.
    arms: [Arm; 2],
    /// How many candidates of this batch are steps of searches, of the first of them on; all or none.
    stepped: usize,
    position: Vec<S>,
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
            hits: HitList::default(),
            pairs: Pairs::default(),
            misses: Vec::new(),
            kept: 0,
            arms: [Arm::default(); 2],
            stepped: 0,
            position: Vec::new(),
        }
    }

    /// Appends the next recombinations that are no known hits.
    fn recombine(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) {
        let count = self.climbs.len();
        for _ in 0..LOOKS * count {
            if out.len() == count {
                return;
            }
            let Some(is_new) = self.pairs.next(&self.hits, rng, &mut self.position) else {
                return;
            };
            if is_new && !context.is_deleted(&self.position) {
                out.push(&self.position);
            } else {
                // Paid like a miss: looking costs time, and a source that has run dry is not to be asked for ever.
                self.arms[1].count(false);
            }
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
        if self.restarts.is_multiple_of(2) && self.kept > 0 {
            self.kept -= 1;
            let miss = &mut self.misses[self.kept];
            core::mem::swap(&mut climb.position, &mut miss.position);
            climb.fitness = miss.fitness;
            climb.mutation.reset(dimension, REFINING_STEP);
            return;
        }
        climb.position.resize(dimension, S::zero());
        self.even.draw(space, rng, &mut climb.position);
        climb.fitness = S::infinity();
        let (smallest, largest) = self.step;
        climb
            .mutation
            .reset(dimension, largest * (smallest / largest).powf(rng.uniform()));
    }

    /// Keeps a near miss, if it is among the best; the best one comes last.
    fn keep(&mut self, position: &[S], fitness: S) {
        if !fitness.is_finite() {
            return;
        }
        let place = self.misses[..self.kept].partition_point(|miss| miss.fitness > fitness);
        let place = if self.kept < MISSES {
            if self.kept == self.misses.len() {
                self.misses.push(Miss {
                    position: Vec::new(),
                    fitness,
                });
            }
            self.kept += 1;
            self.misses[place..self.kept].rotate_right(1);
            place
        } else if place > 0 {
            self.misses[..place].rotate_left(1); // the worst one makes room
            place - 1
        } else {
            return;
        };
        let miss = &mut self.misses[place];
        miss.fitness = fitness;
        miss.position.clear();
        miss.position.extend_from_slice(position);
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
        self.hits.clear();
        self.pairs = Pairs::default();
        self.kept = 0;
        self.even = EvenPoints::default();
        self.arms = [Arm::default(); 2];
        self.position = vec![S::zero(); context.space().dimension()];
        for climb in &mut self.climbs {
            climb.running = false;
        }
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        self.stepped = 0;
        if self.position.len() > 1
            && self.pairs.is_left(self.hits.rows())
            && self.arms[1].draw(rng) > self.arms[0].draw(rng)
        {
            self.recombine(context, rng, out);
        }
        if !out.is_empty() {
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
        self.stepped = out.len();
        Ask::More
    }

    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        let space = context.space();
        let converged = converged(space);
        for (position, outcome) in batch.points().zip(outcomes) {
            if outcome.is_hit() {
                self.hits.push(space, position);
            }
        }
        if origin == Origin::Start {
            for (position, outcome) in batch.points().zip(outcomes) {
                if let Outcome::Miss(fitness) = *outcome {
                    self.keep(position, fitness);
                }
            }
        }
        if origin != Origin::Engine {
            return;
        }
        for (i, (position, &outcome)) in batch.points().zip(outcomes).enumerate() {
            if i < self.stepped {
                self.arms[0].count(outcome.is_hit());
                self.climbs[i].learn(position, outcome, converged);
            } else {
                self.arms[1].count(outcome.is_hit());
                if let Outcome::Miss(fitness) = outcome {
                    self.keep(position, fitness);
                }
            }
        }
        Arm::fade(&mut self.arms, outcomes.len());
    }

    fn save(&self, state: &mut State) {
        Part::save(self, state);
    }

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        let searches = self.climbs.len();
        Part::restore(self, from)?;
        let dimension = self.position.len();
        let fits = self.climbs.len() == searches
            && self.stepped <= searches
            && self.kept <= self.misses.len()
            && self.hits.fit(dimension)
            && self.pairs.fit(self.hits.rows(), dimension)
            && self
                .climbs
                .iter()
                .all(|climb| !climb.running || climb.position.len() == dimension)
            && self.misses[..self.kept]
                .iter()
                .all(|miss| miss.position.len() == dimension);
        fits.then_some(())
            .ok_or_else(|| Error::State("its parts do not fit each other".to_owned()))
    }
}

impl<S: Real> Part for Searches<S> {
    crate::saved_fields!(
        climbs, restarts, even, hits, pairs, misses, kept, arms, stepped, position
    );
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

    #[test]
    fn near_misses_are_kept_best_last() {
        let mut engine = Searches::<f64>::new((0.001, 0.1), 8, 1);
        let mut rng = SearchRng::new(5);
        let mut all = Vec::new();
        for _ in 0..200 {
            let fitness = rng.uniform();
            all.push(fitness);
            engine.keep(&[fitness], fitness);
            engine.keep(&[0.0], f64::INFINITY);
        }
        all.sort_by(|a, b| b.total_cmp(a));
        assert_eq!(engine.misses.len(), engine.kept);
        let kept: Vec<f64> = engine.misses.iter().map(|miss| miss.fitness).collect();
        assert_eq!(kept, all[all.len() - MISSES..]);
        assert!(engine.misses.iter().all(|miss| miss.position == [miss.fitness]));
    }
}

//! Local searches by generations that end where they come near a known end, and go on from good ends: for optima that are hard to
//! reach.

mod starts;

use self::starts::Start;
use super::ends::Ends;
use super::pairs_of_hits::PairsOfHits;
use super::repelled::Repelled;
use super::strategy::{Strategy, usual_size};
use crate::batch::{Batch, Outcome};
use crate::context::{Context, points_between_looks};
use crate::engine::compiled::both_scalars;
use crate::engine::low_discrepancy::EvenPoints;
use crate::engine::{Ask, Engine, EngineConfig, Origin};
use crate::engine_settings;
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::{Axis, Space};
use crate::state::{Part, Reader, State};

engine_settings! {
    /// Local searches by an evolution strategy (Beyer, Sendhoff 2008) of four kinds, and recombinations of all pairs of hits:
    ///
    /// - from points that cover the space evenly, far from known hits. Samples near those are refused (Ahrari and others 2022): within a
    ///   radius that belongs to the hit, in units of the search's own spread. It grows with every search that the hit attracts;
    /// - from uniform points with a small first step, once all searches of the first kind come to known ends;
    /// - from near misses of recombinations;
    /// - from beside the ends of searches that were no hits. A length is drawn log-uniformly, then one of the ends that have no better
    ///   one within it: good ends more often. A search that will not come below its origin ends early.
    ///
    /// A search ends at a hit, when it hardly comes nearer to delta any more, or when a known end is near in terms of the spread of its
    /// samples and no hill lies between (Ursem 1999), so that it costs little to be on the way to a known optimum. An end that was no
    /// hit may be beside one all the same: the better it is among those, the more often a search passes it.
    ///
    /// Steps on integer axes are rounded, so this engine suits continuous axes. Hits are deleted.
    ///
    /// ```
    /// use satisfice::{Budget, Search, Space, engine::Niching, from_fn};
    /// let disc = from_fn(Space::lattice(2, 100)?, 10.0, |x: &[f64]| (x[0] - 50.0).hypot(x[1] - 20.0));
    /// let engine = Niching { hops: 0.2, ..Default::default() };
    /// let report = Search::with(engine).run(&disc, &Budget::evaluations(3000))?;
    /// assert!(report.hit_count() > 10);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    pub struct Niching {
        /// First step from a point far from known hits, as a share of the axes.
        pub step: f64 = 0.3, 1e-12..=1.0;
        /// Share of the searches that start beside known ends; near misses aside.
        pub hops: f64 = 0.5, 0.0..=1.0;
    }
}

impl EngineConfig for Niching {
    const NAME: &'static str = "niching";
    const SUMMARY: &'static str = "evolution strategies that turn away from known optima and go on from good ends, and recombination of hits";
    const CITATION: &'static str = "this project; parts after Beyer, Sendhoff 2008, doi 10.1007/978-3-540-87700-4_13, Ahrari and others 2022, doi 10.1109/TEVC.2021.3117116, and Ursem 1999, doi 10.1109/CEC.1999.785498";

    both_scalars!();
}

impl Niching {
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        Box::new(NichingSearch::new(self.clone()))
    }
}

/// Samples at once: the rest of a larger generation is left out if one of these hits.
const AT_ONCE: usize = 64;
/// Spreads within which a known end has to be to be looked at: a hit, and another end. Around those, F is often rugged.
const SCOPE: (f64, f64) = (1.0, 0.2);
/// A search whose spread has shrunk to this share of the first one looks for hits up to so many spreads away: samples near them are refused,
/// so its mean comes no nearer than that.
const SETTLED: (f64, f64) = (0.2, 3.0);
/// Points between a search and a known end that tell whether there is a hill.
const PROBES: usize = 3;
/// A search is judged after so many generations and, divided by their size, so many evaluations an axis; it goes on if the distance
/// to delta has become smaller by this share.
const WINDOW: (f64, f64) = (20.0, 30.0);
const PROGRESS: f64 = 0.2;

/// What the points of a batch are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
enum BatchKind {
    #[default]
    Samples,
    /// Points between the search and a known end.
    Probes,
    Recombinations,
}

/// What is known of the search that runs.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
struct StrategyRun {
    running: bool,
    from: Start,
    /// F of the known end beside which it started.
    origin: f64,
    /// The spread of the first generation.
    first_spread: f64,
    /// Samples of a generation.
    size: usize,
    generations: u64,
    /// Samples of this generation that were known hits.
    deleted: usize,
    best: Vec<f64>,
    fitness: f64,
    /// The best fitness when it was judged last.
    before: f64,
    /// The spread at the last look for a hill.
    looked: f64,
}

/// The engine of [`Niching`]. Places are shares of the axes' widths.
#[derive(Debug)]
struct NichingSearch<S> {
    settings: Niching,
    ends: Ends,
    recombined: PairsOfHits<S>,
    restarts: u64,
    /// Where searches start that do not start beside a known end.
    even: EvenPoints,
    /// Searches that started beside known ends, and anywhere.
    started: [u64; 2],
    /// How many searches from far points, one after the other, have come to known ends.
    streak: u64,
    /// Evaluations of searches from near misses, and of all.
    spent: [u64; 2],
    start: Vec<f64>,
    run: StrategyRun,
    distribution: Strategy,
    asked: BatchKind,
    /// The known end at which the probes look.
    approaching: Option<usize>,
    position: Vec<S>,
    /// Memory of one batch.
    repelled: Repelled,
    /// Memory of one place.
    place: Vec<f64>,
}

fn to_place<S: Real>(space: &Space<S>, position: &[S], place: &mut [f64]) {
    for ((x, axis), p) in position.iter().zip(space.axes()).zip(place) {
        let width = axis.width().f64();
        *p = if width > 0.0 {
            (x.f64() - axis.start().f64()) / width
        } else {
            0.5
        };
    }
}

fn to_position<S: Real>(space: &Space<S>, place: impl Iterator<Item = f64>, position: &mut [S]) {
    for ((x, axis), p) in position.iter_mut().zip(space.axes()).zip(place) {
        *x = S::of(axis.start().f64() + p * axis.width().f64());
    }
}

/// The share of an axis, no farther than its ends; a periodic one has none.
fn confined<S: Real>(axis: &Axis<S>, share: f64) -> f64 {
    if axis.is_periodic() {
        share
    } else {
        share.clamp(0.0, 1.0)
    }
}

impl<S: Real> NichingSearch<S> {
    fn new(settings: Niching) -> Self {
        Self {
            settings,
            ends: Ends::default(),
            recombined: PairsOfHits::new(0),
            restarts: 0,
            even: EvenPoints::default(),
            started: [0; 2],
            streak: 0,
            spent: [0; 2],
            start: Vec::new(),
            run: StrategyRun::default(),
            distribution: Strategy::default(),
            asked: BatchKind::default(),
            approaching: None,
            position: Vec::new(),
            repelled: Repelled::default(),
            place: Vec::new(),
        }
    }

    /// A known end that the search seems to be on its way to, if it is time to look and the search is not to pass it.
    fn approached(&mut self, rng: &mut SearchRng) -> Option<usize> {
        let spread = self.distribution.spread();
        if spread > 0.5 * self.run.looked || !self.run.fitness.is_finite() {
            return None;
        }
        let (index, distance) = self.ends.nearest(&self.distribution.mean)?;
        let scope = match self.ends.is_hit(index) {
            false => SCOPE.1,
            true if spread < SETTLED.0 * self.run.first_spread => SETTLED.1,
            true => SCOPE.0,
        };
        if distance >= scope * spread || self.ends.fitness(index) >= self.run.fitness {
            return None;
        }
        self.run.looked = spread;
        let passes = !self.ends.is_hit(index) && rng.uniform() < 1.0 / (1.0 + self.ends.better(index) as f64);
        (!passes).then_some(index)
    }

    /// Takes what became of samples.
    fn learn(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>]) {
        let space = context.space();
        let run = &mut self.run;
        let count = outcomes.len() as u64;
        self.spent[0] += u64::from(run.from == Start::NearMiss) * count;
        self.spent[1] += count;
        for (position, outcome) in batch.points().zip(outcomes) {
            run.deleted += usize::from(*outcome == Outcome::Deleted);
            let fitness = outcome.fitness().f64();
            self.distribution.tell(fitness);
            if fitness < run.fitness {
                run.fitness = fitness;
                to_place(space, position, &mut run.best);
            }
        }
        if outcomes.iter().any(|outcome| outcome.is_hit()) {
            run.running = false;
            self.streak = 0;
            return;
        }
        if self.distribution.told() < run.size {
            return;
        }
        if 2 * run.deleted >= run.size {
            run.running = false;
            let nearest = self.ends.nearest(&self.distribution.mean).map(|(index, _)| index);
            self.attracted(nearest);
            return;
        }
        run.deleted = 0;
        self.distribution.adapt();
        for (j, axis) in space.axes().iter().enumerate() {
            let m = self.distribution.mean[j];
            if axis.is_periodic() && !(0.0..1.0).contains(&m) {
                self.distribution.shift(j, -m.floor());
            }
        }
        run.generations += 1;
        let an_axis = WINDOW.1 * space.dimension() as f64 / run.size as f64;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive and small"
        )]
        let window = (WINDOW.0 + an_axis) as u64;
        if run.generations.is_multiple_of(window) {
            self.judge(context.threshold().f64());
        }
    }

    /// A search has been attracted by a known end, or ends with no hit.
    fn attracted(&mut self, index: Option<usize>) {
        if self.run.from == Start::Far {
            self.streak = index.map_or(0, |_| self.streak.saturating_add(1));
        }
        if !self.run.from.keeps_away() {
            return;
        }
        let rate = 1.0 / (self.start.len() as f64).sqrt();
        self.ends
            .adapt_radii(index.filter(|&index| self.ends.is_hit(index)), rate);
    }

    /// Ends the search if it does not come forward.
    fn judge(&mut self, threshold: f64) {
        let run = &mut self.run;
        let moved = run.before - run.fitness;
        run.before = run.fitness;
        if run.fitness - moved > run.origin || !run.fitness.is_finite() {
            run.running = false;
        } else if moved < PROGRESS * (run.fitness - threshold) {
            run.running = false;
            self.ends.add(&run.best, run.fitness, false);
            self.attracted(None);
        }
    }
}

impl<S: Real> Engine<S> for NichingSearch<S> {
    fn begin(&mut self, context: &dyn Context<S>) {
        let dimension = context.space().dimension();
        *self = Self {
            start: vec![0.5; dimension],
            run: StrategyRun {
                best: vec![0.5; dimension],
                ..StrategyRun::default()
            },
            recombined: PairsOfHits::new(dimension),
            position: vec![S::zero(); dimension],
            ..Self::new(self.settings.clone())
        };
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        let space = context.space();
        let dimension = self.position.len();
        if !self.run.running || self.distribution.sampled() == 0 {
            if self.recombined.are_next(rng) {
                let count = usual_size(dimension).min(points_between_looks(dimension));
                self.recombined.propose(count, context, rng, out);
                if !out.is_empty() {
                    self.asked = BatchKind::Recombinations;
                    return Ask::More;
                }
            }
            if !self.run.running {
                self.begin_run(space, rng);
            } else if let Some(index) = self.approached(rng) {
                self.approaching = Some(index);
                for probe in 1..=PROBES.min(points_between_looks(dimension)) {
                    let share = probe as f64 / (PROBES as f64 + 1.0);
                    let ends = self.run.best.iter().zip(self.ends.place(index, dimension));
                    let between = ends.map(|(a, b)| a + share * (b - a));
                    out.push_with(|position| to_position(space, between, position));
                }
                self.asked = BatchKind::Probes;
                return Ask::More;
            }
        }
        self.asked = BatchKind::Samples;
        let left = self.run.size - self.distribution.sampled();
        let run = &self.run;
        let axes = space.axes();
        let confine = |j: usize, x| confined(&axes[j], x);
        self.repelled.find(&self.ends, &self.distribution, |fitness| {
            run.from.keeps_away() && fitness < run.fitness
        });
        for _ in 0..left.min(AT_ONCE).min(points_between_looks(dimension)) {
            let sample = self.distribution.sample(rng, &mut self.repelled, confine);
            out.push_with(|position| to_position(space, sample.iter().copied(), position));
        }
        Ask::More
    }

    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        let space = context.space();
        self.recombined.take_hits(space, batch, outcomes);
        for (position, outcome) in batch.points().zip(outcomes) {
            if outcome.is_hit() {
                self.place.resize(position.len(), 0.0);
                to_place(space, position, &mut self.place);
                self.ends.add(&self.place, outcome.fitness().f64(), true);
            }
        }
        let is_recombined = origin == Origin::Engine && self.asked == BatchKind::Recombinations;
        if is_recombined || origin == Origin::Start {
            self.recombined.keep_misses(batch, outcomes);
        }
        if origin != Origin::Engine {
            return;
        }
        match self.asked {
            BatchKind::Samples => self.learn(context, batch, outcomes),
            BatchKind::Probes => {
                let is_low = |outcome: &Outcome<S>| {
                    *outcome == Outcome::Deleted || outcome.fitness().f64() <= self.run.fitness
                };
                self.run.running = !outcomes.iter().all(is_low);
                if !self.run.running {
                    self.attracted(self.approaching);
                }
            }
            BatchKind::Recombinations => {}
        }
        if is_recombined {
            self.recombined.count_recombinations(outcomes);
        } else {
            self.recombined.count_searches(outcomes);
        }
    }

    fn save(&self, state: &mut State) {
        Part::save(self, state);
    }

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        Part::restore(self, from)?;
        let dimension = self.position.len();
        let fits = self.start.len() == dimension
            && self.run.best.len() == dimension
            && (!self.run.running || self.distribution.fit(dimension, self.run.size))
            && self.ends.fit(dimension)
            && self.approaching.is_none_or(|index| index < self.ends.len())
            && self.recombined.fit(dimension);
        fits.then_some(())
            .ok_or_else(|| Error::State("its parts do not fit each other".to_owned()))
    }
}

impl<S: Real> Part for NichingSearch<S> {
    crate::saved_fields!(
        ends,
        recombined,
        restarts,
        even,
        started,
        streak,
        spent,
        start,
        run,
        distribution,
        asked,
        approaching,
        position
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Budget, Search, from_fn};

    /// A wide basin that catches nearly all searches, and narrow ones.
    #[test]
    fn narrow_basins_beside_a_wide_one_are_found() {
        let narrow = [[0.1, 0.1, 0.9], [0.9, 0.2, 0.1], [0.15, 0.9, 0.2]];
        let space = Space::new((0..3).map(|_| Axis::continuous(0.0, 1.0))).unwrap();
        let fitness = move |x: &[f64]| {
            let square = |y: &[f64; 3]| y.iter().zip(x).map(|(y, x)| (y - x) * (y - x)).sum::<f64>();
            let wide = square(&[0.6, 0.6, 0.6]);
            narrow.iter().map(|y| 16.0 * square(y)).fold(wide, f64::min)
        };
        for seed in 0..10 {
            let problem = from_fn(space.clone(), 1e-6, fitness).separation(0.01);
            let mut search = Search::with(Niching::default()).seed(seed);
            let report = search
                .run(&problem, &Budget::evaluations(40_000).and_hits(4))
                .unwrap();
            assert_eq!(report.hit_count(), 4, "seed {seed}");
        }
    }
}

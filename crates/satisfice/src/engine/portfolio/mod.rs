//! The default engine: sources of candidates that compete for evaluations by their yield.

pub(super) mod bandit;
mod climbers;
mod moves;
mod near_misses;
mod neighbourhoods;
mod populations;
mod swarms;
mod translations;
mod visited;

use bandit::{Arm, draw};
use climbers::Climbers;
use near_misses::NearMisses;
use neighbourhoods::Neighbourhoods;
use populations::Populations;
use swarms::Swarms;
use translations::Translations;
use visited::Visited;

use super::local::recombination::recombine;
use super::{Ask, Engine, EngineConfig, Origin};
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::state::{Reader, Saved, State};
use crate::{engine_choice, engine_settings};

engine_choice! {
    /// When the neighbours that a problem names become candidates of [`Portfolio`].
    pub enum NeighbourTiming {
        /// At once: most hits for each evaluation.
        AtOnce = "at-once",
        /// When it is their turn: a fraction of the time, for a fitness of less than a few microseconds with dozens of
        /// neighbours.
        Late = "late",
    }
}

engine_choice! {
    /// A source of candidates that [`Portfolio`] leaves out, for ablation.
    pub enum Omitted {
        /// None: all sources compete.
        Nothing = "none",
        /// Small quantum-behaved swarms.
        Swarms = "swarms",
        /// Restarted local searches.
        Climbers = "climbers",
        /// Populations that adapt their covariance.
        Populations = "populations",
        /// Known steps from hit to hit.
        Steps = "steps",
        /// New steps, learned from differences of hits.
        Learning = "learning",
        /// Recombinations of two hits.
        Recombination = "recombination",
        /// The neighbours that the problem names.
        Neighbours = "neighbours",
        /// The near misses of the slice before.
        NearMisses = "near-misses",
    }
}

engine_settings! {
    /// A portfolio of sources of candidates, which compete by their yield:
    ///
    /// - uniform points, on a lattice without repetition, so that a small one is covered and the result proved complete;
    /// - small swarms, each attracted by its own latest hit, after Chen et al. 2012;
    /// - restarted local searches by adaptive moves: along integer axes, to the problem's own neighbours, by a covariance-adapting
    ///   (1+1) strategy along continuous axes; a search that returns to a known hit ends at once;
    /// - steps that have led from hit to hit, applied to every hit: the short ones fill neighbourhoods, those learned from
    ///   differences of hits follow repetitions and manifolds of hits;
    /// - recombinations of two hits, which find the rest of a product of sets of coordinates; local searches start at those that
    ///   just miss;
    /// - populations that adapt their covariance, on continuous axes;
    /// - the neighbours that the problem names, best first by predicted fitness, from hits and across near misses;
    /// - in a slice that follows another: the near misses of that slice, best first, because a problem that moves turns them into
    ///   hits.
    ///
    /// The next source is drawn by Thompson sampling on fading counts of hits. No parameter depends on the problem.
    pub struct Portfolio {
        /// Candidates proposed at once, at most: few learn sooner, many feed more threads.
        pub batch: usize = 32, 1..=65_536;
        /// Number of swarms K.
        pub swarms: usize = 6, 1..=1000;
        /// Particles N of each swarm.
        pub particles: usize = 5, 1..=1000;
        /// Contraction-expansion coefficient alpha of the swarms, which stay bounded below 1.781.
        pub alpha: f64 = 0.75, 0.0..=10.0;
        /// Evaluations without a hit after which a swarm starts anew.
        pub restart: usize = 1000, 1..=1_000_000_000;
        /// When the neighbours that the problem names become candidates: at once for most hits an evaluation, late to save time
        /// on a cheap fitness with dozens of neighbours.
        pub neighbours: NeighbourTiming = NeighbourTiming::AtOnce;
        /// A source to leave out, for ablation.
        pub without: Omitted = Omitted::Nothing;
    }
}

impl EngineConfig for Portfolio {
    const NAME: &'static str = "portfolio";
    const SUMMARY: &'static str = "swarms, local searches, recombined hits, learned steps and uniform points that compete for evaluations by their yield";
    const CITATION: &'static str = "this project; parts after Chen et al. 2012, Igel et al. 2006, Beyer, Sendhoff 2017, Luby et al. 1993, Agrawal, Goyal 2012";

    fn build<S: Real>(&self) -> Box<dyn Engine<S>> {
        let block = self.batch.div_ceil(4);
        Box::new(Sources {
            batch: self.batch,
            block,
            without: self.without,
            arms: [Arm::default(); ARMS],
            hits: Vec::new(),
            visited: None,
            scan: 0,
            swarms: Swarms::new(self.swarms, self.particles, self.alpha, self.restart),
            climbers: Climbers::new(block),
            populations: Populations::new(),
            steps: None,
            neighbourhoods: Neighbourhoods::new(self.neighbours == NeighbourTiming::Late),
            near_misses: NearMisses::new(),
            tags: Vec::new(),
            trials: Vec::new(),
            position: Vec::new(),
        })
    }
}

/// Choices of source without a candidate after which a batch is given up.
const VAIN: usize = 100;

/// Where a candidate comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
enum Source {
    Uniform,
    Swarm,
    Climber,
    /// A hit moved by a step that is known.
    Step,
    /// A hit moved by the difference of two hits, on trial.
    Trial,
    /// Some coordinates of a hit, the others of another.
    Cross,
    /// A member of a population that adapts its covariance.
    Member,
    /// A neighbour of a hit, by the problem's own word.
    Neighbour,
    /// What just missed in the slice before.
    NearMiss,
}

/// A candidate's source, and which swarm, climber, step or trial of it.
type Tag = (Source, usize);

/// Number of sources with an arm, and some of these.
const ARMS: usize = 6;
const TRIAL: usize = 3;
const CROSS: usize = 4;
const MEMBER: usize = 5;

/// The arm of a source; steps, neighbours and near misses keep their own books.
fn arm_of(source: Source) -> Option<usize> {
    match source {
        Source::Uniform => Some(0),
        Source::Swarm => Some(1),
        Source::Climber => Some(2),
        Source::Trial => Some(TRIAL),
        Source::Cross => Some(CROSS),
        Source::Member => Some(MEMBER),
        Source::Step | Source::Neighbour | Source::NearMiss => None,
    }
}

/// The engine of [`Portfolio`].
#[derive(Debug)]
struct Sources<S> {
    batch: usize,
    /// Candidates that come from one choice of source.
    block: usize,
    without: Omitted,
    arms: [Arm; ARMS],
    hits: Vec<S>,
    visited: Option<Visited>,
    /// The next point of the lattice, once so many are visited that uniform draws mostly repeat.
    scan: u64,
    swarms: Swarms<S>,
    climbers: Climbers<S>,
    populations: Populations<S>,
    steps: Option<Translations<S>>,
    neighbourhoods: Neighbourhoods<S>,
    near_misses: NearMisses<S>,
    tags: Vec<Tag>,
    trials: Vec<S>,
    position: Vec<S>,
}

impl<S: Real> Sources<S> {
    fn hit_count(&self) -> usize {
        self.hits.len() / self.position.len().max(1)
    }

    /// Draws a source, and which step of [`Source::Step`].
    fn choose(&self, rng: &mut SearchRng) -> Tag {
        let uses = |source: Omitted| self.without != source;
        let mut best = (self.arms[0].draw(rng), (Source::Uniform, 0));
        let mut offer = |yields: f64, tag: Tag| {
            if yields > best.0 {
                best = (yields, tag);
            }
        };
        if uses(Omitted::Swarms) {
            offer(self.arms[1].draw(rng), (Source::Swarm, 0));
        }
        if uses(Omitted::Climbers) {
            offer(self.arms[2].draw(rng), (Source::Climber, 0));
        }
        if uses(Omitted::Populations) && self.populations.are_usable() {
            offer(self.arms[MEMBER].draw(rng), (Source::Member, 0));
        }
        let hits = self.hit_count();
        if uses(Omitted::Learning) && hits >= 3 {
            offer(self.arms[TRIAL].draw(rng), (Source::Trial, 0));
        }
        if uses(Omitted::Recombination) && hits >= 2 && self.position.len() > 1 {
            offer(self.arms[CROSS].draw(rng), (Source::Cross, 0));
        }
        if uses(Omitted::Steps)
            && let Some((index, good, all)) = self.steps.as_ref().and_then(|steps| steps.best(hits, 0.02))
        {
            offer(draw(rng, good, all), (Source::Step, index));
        }
        if let Some((good, all)) = self.neighbourhoods.posterior() {
            offer(draw(rng, good, all), (Source::Neighbour, 0));
        }
        if uses(Omitted::NearMisses)
            && let Some((good, all)) = self.near_misses.posterior()
        {
            offer(draw(rng, good, all), (Source::NearMiss, 0));
        }
        best.1
    }

    /// Whether a position is inside and worth an evaluation: not proposed before, or not a known hit.
    fn is_fresh(&mut self, context: &dyn Context<S>) -> bool {
        let space = context.space();
        let inside = space.axes().iter().zip(&self.position).all(|(axis, &x)| {
            axis.lower() <= x
                && if axis.is_integer() {
                    x < axis.end()
                } else {
                    x <= axis.end()
                }
        });
        inside
            && match &mut self.visited {
                Some(visited) => visited.insert(space, &self.position),
                None => !context.is_deleted(&self.position),
            }
    }

    /// Proposes one candidate; `false` where the source has none left for this batch.
    fn propose(
        &mut self,
        tag: Tag,
        context: &dyn Context<S>,
        rng: &mut SearchRng,
        out: &mut Batch<S>,
    ) -> bool {
        let (source, index) = tag;
        let proposed = match source {
            Source::Swarm => self
                .swarms
                .propose(context.space(), self.visited.as_ref(), rng, out),
            Source::Climber => self.climbers.propose(context, self.visited.as_ref(), rng, out),
            Source::Member => self.populations.propose(context, rng, out),
            Source::Uniform => {
                if self.visited.as_ref().is_some_and(Visited::is_dense) {
                    if !self.scan_on(context) {
                        return false;
                    }
                } else {
                    rng.position(context.space(), &mut self.position);
                    if !self.is_fresh(context) {
                        return true; // that draw was in vain, the next may not be
                    }
                }
                out.push(&self.position);
                Some(0)
            }
            Source::Step => {
                let Some(steps) = &mut self.steps else {
                    return false;
                };
                if !steps.apply(index, &self.hits, &mut self.position) {
                    return false;
                }
                if !self.is_fresh(context) {
                    return true;
                }
                out.push(&self.position);
                Some(index)
            }
            Source::Trial => {
                if !self.draw_trial(rng) || !self.is_fresh(context) {
                    // Paid like a miss: else a source that has run dry would be asked for ever.
                    self.arms[TRIAL].book(false);
                    return true;
                }
                out.push(&self.position);
                self.trials
                    .truncate((self.trials.len() / self.position.len()) * self.position.len());
                Some(self.trials.len() / self.position.len() - 1)
            }
            Source::Cross => {
                if !recombine(&self.hits, rng, &mut self.position) || !self.is_fresh(context) {
                    self.arms[CROSS].book(false);
                    return true;
                }
                out.push(&self.position);
                Some(0)
            }
            Source::Neighbour | Source::NearMiss => {
                let position = &mut self.position;
                let is_there = match source {
                    Source::Neighbour => self.neighbourhoods.propose(context, position),
                    _ => self.near_misses.propose(position),
                };
                if !is_there {
                    return false;
                }
                if !self.is_fresh(context) {
                    return true;
                }
                out.push(&self.position);
                Some(0)
            }
        };
        match proposed {
            Some(index) => self.tags.push((source, index)),
            None => return false,
        }
        true
    }

    /// Goes on through the lattice to the next point that is not visited; `false` at its end.
    fn scan_on(&mut self, context: &dyn Context<S>) -> bool {
        let Some(count) = context.space().cardinality() else {
            return false;
        };
        while (self.scan as f64) < count {
            Visited::point(context.space(), self.scan, &mut self.position);
            self.scan += 1;
            if self.is_fresh(context) {
                return true;
            }
        }
        false
    }

    /// Writes a hit moved by the difference of two others, and appends that difference to `trials`; `false` where it is zero.
    /// Half of the pairs are neighbours in the order found, which are near to each other in space.
    fn draw_trial(&mut self, rng: &mut SearchRng) -> bool {
        let dimension = self.position.len();
        let count = self.hit_count();
        let (a, b) = (rng.below(count), rng.below(count));
        let (reach, far) = rng.uniform_and_sign();
        let c = if far {
            rng.below(count)
        } else {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 7")]
            let apart = 1 + (8.0 * reach) as usize;
            if b >= apart {
                b - apart
            } else {
                (b + apart).min(count - 1)
            }
        };
        let row = |hit: usize| &self.hits[hit * dimension..(hit + 1) * dimension];
        let mut moves = false;
        let start = self.trials.len();
        for j in 0..dimension {
            let difference = row(b)[j] - row(c)[j];
            moves |= difference != S::zero();
            self.trials.push(difference);
            self.position[j] = row(a)[j] + difference;
        }
        if !moves {
            self.trials.truncate(start);
        }
        moves
    }
}

impl<S: Real> Engine<S> for Sources<S> {
    /// One evaluation in fifty says how complete the result is.
    fn probes(&self) -> f64 {
        0.02
    }

    fn begin(&mut self, context: &dyn Context<S>) {
        let space = context.space();
        let dimension = space.dimension();
        // A slice that begins cold sees no hits of the one before; a space of another dimension is another problem.
        let follows = context.previous_hits() > 0 && self.position.len() == dimension;
        self.near_misses.begin(dimension, follows);
        self.position = vec![S::zero(); dimension];
        self.hits.clear();
        let lattice = space.axes().iter().all(crate::Axis::is_integer);
        self.visited = lattice.then(|| Visited::new(space));
        self.scan = 0;
        self.swarms.begin(dimension);
        self.climbers.begin(context);
        self.populations.begin(context);
        // Steps that were good in the slice before are likely to be good in this one.
        match &mut self.steps {
            Some(steps) => steps.begin(),
            None => self.steps = Some(Translations::new(space)),
        }
        self.neighbourhoods.begin();
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        self.tags.clear();
        self.trials.clear();
        self.swarms.begin_batch();
        self.climbers.begin_batch();
        let mut in_vain = 0;
        while out.len() < self.batch && in_vain < VAIN {
            let tag = self.choose(rng);
            let before = out.len();
            for _ in 0..self.block.min(self.batch - before) {
                if !self.propose(tag, context, rng, out) {
                    break;
                }
            }
            // A source that has given all it has for this batch ends the batch, rather than leave it to worse ones.
            if out.len() == before {
                if !out.is_empty() {
                    break;
                }
                in_vain += 1;
            }
        }
        if out.is_empty() {
            if self.visited.as_ref().is_some_and(Visited::is_all) {
                return Ask::Covered;
            }
            // Everything drawn was known: whatever the next uniform point is, it goes to the ledger.
            out.push_with(|position| rng.position(context.space(), position));
            self.tags.push((Source::Uniform, 0));
        }
        Ask::More
    }

    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        let space = context.space();
        for (position, outcome) in batch.points().zip(outcomes) {
            if outcome.is_hit() {
                // Steps between whole cells are whole: hits are kept at the centres of their cells.
                let centre = space
                    .axes()
                    .iter()
                    .zip(position)
                    .map(|(axis, &x)| axis.position(axis.value(x)));
                self.hits.extend(centre);
            } else if let Outcome::Miss(fitness) = *outcome {
                self.near_misses.keep(position, fitness);
            }
            if let Some(visited) = &mut self.visited {
                visited.insert(space, position);
            }
        }
        self.expand(context, batch, outcomes, origin);
        if origin != Origin::Engine {
            return;
        }
        for (i, &(source, index)) in self.tags.iter().enumerate() {
            let (position, outcome) = (batch.point(i), outcomes[i]);
            match source {
                Source::Swarm => self.swarms.tell(index, position, outcome),
                Source::Climber => self.climbers.tell(index, position, outcome),
                Source::Member => self.populations.tell(index, context, outcome),
                Source::Step => {
                    if let Some(steps) = &mut self.steps {
                        steps.book(index, outcome.is_hit());
                    }
                }
                Source::Neighbour => self.neighbourhoods.book(outcome.fitness(), outcome.is_hit()),
                Source::NearMiss => self.near_misses.book(outcome.is_hit()),
                // Hits are inexact on continuous axes: what was put together from two of them may just miss a third one.
                Source::Cross => {
                    if let (None, Outcome::Miss(fitness)) = (&self.visited, outcome) {
                        self.climbers.offer(position, fitness);
                    }
                }
                Source::Uniform | Source::Trial => {}
            }
        }
        for (&(source, index), outcome) in self.tags.iter().zip(outcomes) {
            let hit = outcome.is_hit();
            if let Some(arm) = arm_of(source) {
                self.arms[arm].book(hit);
            }
            // After all bookings, because a step that is learned may take the place of another.
            if let (Source::Trial, true, Some(steps)) = (source, hit, &mut self.steps) {
                let dimension = space.dimension();
                steps.learn(&self.trials[index * dimension..(index + 1) * dimension], space);
            }
        }
        Arm::fade(&mut self.arms, outcomes.len());
    }

    fn save(&self, state: &mut State) {
        (self.arms, self.hits.clone()).save(state);
        self.visited.save(state);
        self.scan.save(state);
        self.swarms.save(state);
        self.climbers.save(state);
        self.populations.save(state);
        self.steps.save(state);
        self.neighbourhoods.save(state);
        self.near_misses.save(state);
        (self.tags.clone(), self.trials.clone()).save(state);
        self.position.save(state);
    }

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        (self.arms, self.hits) = from.read()?;
        self.visited = from.read()?;
        self.scan = from.read()?;
        self.swarms.restore(from)?;
        self.climbers.restore(from)?;
        self.populations.restore(from)?;
        self.steps = from.read()?;
        self.neighbourhoods.restore(from)?;
        self.near_misses = from.read()?;
        (self.tags, self.trials) = from.read()?;
        self.position = from.read()?;
        if !self.near_misses.fit(self.position.len()) {
            return Err(Error::State("its near misses are of another space".to_owned()));
        }
        if !self.neighbourhoods.fit(self.position.len()) {
            return Err(Error::State("its neighbourhoods are of another space".to_owned()));
        }
        Ok(())
    }
}

impl<S: Real> Sources<S> {
    /// Enters the neighbours of new hits, of candidates that were neighbours themselves, and of last slice's hits.
    fn expand(
        &mut self,
        context: &dyn Context<S>,
        batch: &Batch<S>,
        outcomes: &[Outcome<S>],
        origin: Origin,
    ) {
        if self.without == Omitted::Neighbours || !context.offers_neighbours() {
            return;
        }
        for (i, (position, outcome)) in batch.points().zip(outcomes).enumerate() {
            let is_near = match origin {
                Origin::Engine => matches!(self.tags[i].0, Source::Neighbour | Source::NearMiss),
                Origin::WarmStart | Origin::Exhaustion => true,
            };
            match *outcome {
                Outcome::Hit(fitness) => self.neighbourhoods.expand(context, position, fitness, true),
                Outcome::Miss(fitness) if is_near => {
                    self.neighbourhoods.expand(context, position, fitness, false);
                }
                _ => {}
            }
        }
    }
}

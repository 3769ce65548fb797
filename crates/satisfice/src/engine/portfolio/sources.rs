//! The engine of the portfolio: which source is asked, and what its outcomes teach.

use super::bandit::{Arm, draw};
use super::climbers::Climbers;
use super::near_misses::NearMisses;
use super::neighbourhoods::Neighbourhoods;
use super::populations::Populations;
use super::scan::Scan;
use super::source::{ARMS, CROSS, MEMBER, Source, TRIAL, Tag, Tally, arm_of};
use super::swarms::Swarms;
use super::translations::Translations;
use super::visited::Visited;
use super::{NeighbourTiming, Omitted, Portfolio};
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::local::recombination::recombine;
use crate::engine::{Ask, Engine, Origin};
use crate::error::Error;
use crate::report::SourceCount;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::state::{Reader, Saved, State};

/// A batch is given up after so many choices of a source that gave no candidate.
const REJECTED: usize = 100;
/// Points of an enumeration that are proposed at once.
const SCANNED: usize = 256;
/// Share of the evaluations that estimates how complete the result is.
const PROBES: f64 = 0.02;

/// The engine of [`Portfolio`].
#[derive(Debug)]
pub(super) struct Sources<S> {
    batch: usize,
    /// Candidates that come from one choice of source.
    block: usize,
    without: Omitted,
    arms: [Arm; ARMS],
    hits: Vec<S>,
    visited: Option<Visited>,
    /// The lattice point by point, once so many are visited that uniform draws mostly repeat, or if the budget has room for all.
    scan: Scan,
    swarms: Swarms<S>,
    climbers: Climbers<S>,
    populations: Populations<S>,
    steps: Option<Translations<S>>,
    neighbourhoods: Neighbourhoods<S>,
    near_misses: NearMisses<S>,
    tags: Vec<Tag>,
    tally: Tally,
    trials: Vec<S>,
    position: Vec<S>,
}

impl<S: Real> Sources<S> {
    pub(super) fn new(settings: &Portfolio) -> Self {
        let block = settings.batch.div_ceil(4);
        Self {
            batch: settings.batch,
            block,
            without: settings.without,
            arms: [Arm::default(); ARMS],
            hits: Vec::new(),
            visited: None,
            scan: Scan::default(),
            swarms: Swarms::new(
                settings.swarms,
                settings.particles,
                settings.alpha,
                settings.restart,
            ),
            climbers: Climbers::new(block),
            populations: Populations::new(),
            steps: None,
            neighbourhoods: Neighbourhoods::new(settings.neighbours == NeighbourTiming::Late),
            near_misses: NearMisses::new(),
            tags: Vec::new(),
            tally: Tally::default(),
            trials: Vec::new(),
            position: Vec::new(),
        }
    }

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
            axis.start() <= x
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
                    if !self.scan_on(context, rng) {
                        return false;
                    }
                } else {
                    rng.position(context.space(), &mut self.position);
                    if !self.is_fresh(context) {
                        return true; // this draw was rejected, the next may be accepted
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
                    // Counted like a miss, or an exhausted source would be asked forever.
                    self.arms[TRIAL].count(false);
                    return true;
                }
                out.push(&self.position);
                self.trials
                    .truncate((self.trials.len() / self.position.len()) * self.position.len());
                Some(self.trials.len() / self.position.len() - 1)
            }
            Source::Cross => {
                if !recombine(&self.hits, rng, &mut self.position) || !self.is_fresh(context) {
                    self.arms[CROSS].count(false);
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
        let Some(index) = proposed else {
            return false;
        };
        if matches!(source, Source::Swarm | Source::Climber)
            && self.is_repeated(context, (source, index), out)
        {
            return true;
        }
        self.tags.push((source, index));
        true
    }

    /// Takes back the last proposal of a swarm or a climber if that point was visited before, and tells it that nothing came of
    /// it, which counts like a miss.
    fn is_repeated(&mut self, context: &dyn Context<S>, (source, index): Tag, out: &mut Batch<S>) -> bool {
        let space = context.space();
        let last = out.len() - 1;
        let Some(visited) = &mut self.visited else {
            return false;
        };
        space.keep_inside(out.point_mut(last));
        if visited.insert(space, out.point(last)) {
            return false;
        }
        match source {
            Source::Swarm => self.swarms.tell(index, out.point(last), Outcome::NonFinite),
            _ => self.climbers.tell(index, out.point(last), Outcome::NonFinite),
        }
        if let Some(arm) = arm_of(source) {
            self.arms[arm].count(false);
        }
        out.truncate(last);
        true
    }

    /// Goes on through the lattice to the next point that is not visited; `false` at its end.
    fn scan_on(&mut self, context: &dyn Context<S>, rng: &mut SearchRng) -> bool {
        let Some(visited) = &mut self.visited else {
            return false;
        };
        let space = context.space();
        let found = self.scan.next(space, visited, rng, &mut self.position);
        if found {
            visited.insert(space, &self.position);
        }
        found
    }

    /// Enumerates the rest of the lattice, a block at a time.
    fn enumerate(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        while out.len() < SCANNED && self.scan_on(context, rng) {
            out.push(&self.position);
        }
        self.tags.resize(out.len(), (Source::Uniform, 0));
        if self.scan.is_over() || self.visited.as_ref().is_some_and(Visited::is_all) {
            Ask::Covered
        } else {
            Ask::More
        }
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
    fn probes(&self) -> f64 {
        PROBES
    }

    fn sources(&self) -> Vec<SourceCount> {
        self.tally.counts()
    }

    fn begin(&mut self, context: &dyn Context<S>) {
        let space = context.space();
        let dimension = space.dimension();
        // A slice that begins cold sees no hits of the one before; a space of another dimension is another problem.
        let follows = context.previous_hits() > 0 && self.position.len() == dimension;
        self.near_misses.begin(dimension, follows);
        self.position = vec![S::zero(); dimension];
        self.hits.clear();
        self.tally = Tally::default();
        let lattice = space.axes().iter().all(crate::Axis::is_integer);
        self.visited = lattice.then(|| Visited::new(space));
        self.scan = Scan::new(space);
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
        if let Some(visited) = &self.visited
            && self.scan.goes_alone(context, visited, PROBES, self.batch)
        {
            return self.enumerate(context, rng, out);
        }
        let mut rejected = 0;
        while out.len() < self.batch && rejected < REJECTED {
            let tag = self.choose(rng);
            let before = out.len();
            for _ in 0..self.block.min(self.batch - before) {
                if !self.propose(tag, context, rng, out) {
                    break;
                }
            }
            // A source with nothing left for this batch ends the batch, so that worse ones do not fill it.
            if out.len() == before {
                if !out.is_empty() {
                    break;
                }
                rejected += 1;
            }
        }
        if out.is_empty() {
            if self.visited.as_ref().is_some_and(Visited::is_all) {
                return Ask::Covered;
            }
            // Everything drawn was known: propose the next uniform point, whatever it is.
            out.push_with(|position| rng.position(context.space(), position));
            self.tags.push((Source::Uniform, 0));
        }
        Ask::More
    }

    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        let space = context.space();
        for (position, outcome) in batch.points().zip(outcomes) {
            if outcome.is_hit() {
                // Hits are kept at the centres of their cells, so that steps between cells are whole.
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
        if self.without != Omitted::Neighbours && context.offers_neighbours() {
            let tags = &self.tags;
            self.neighbourhoods
                .expand_all(context, batch, outcomes, |i| match origin {
                    Origin::Engine => matches!(tags[i].0, Source::Neighbour | Source::NearMiss),
                    Origin::WarmStart | Origin::Start | Origin::Exhaustion => true,
                });
        }
        if origin == Origin::Start {
            for (position, outcome) in batch.points().zip(outcomes) {
                if let Outcome::Miss(fitness) = *outcome {
                    self.climbers.offer(position, fitness);
                }
            }
        }
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
                        steps.count(index, outcome.is_hit());
                    }
                }
                Source::Neighbour => self.neighbourhoods.count(outcome.fitness(), outcome.is_hit()),
                Source::NearMiss => self.near_misses.count(outcome.is_hit()),
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
            self.tally.count(source, *outcome);
            if let Some(arm) = arm_of(source) {
                self.arms[arm].count(hit);
            }
            // After all counts, because a step that is learned may replace another.
            if let (Source::Trial, true, Some(steps)) = (source, hit, &mut self.steps) {
                let dimension = space.dimension();
                steps.learn(&self.trials[index * dimension..(index + 1) * dimension], space);
            }
        }
        Arm::fade(&mut self.arms, outcomes.len());
    }

    fn save(&self, state: &mut State) {
        (self.tally, self.arms, self.hits.clone()).save(state);
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
        (self.tally, self.arms, self.hits) = from.read()?;
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

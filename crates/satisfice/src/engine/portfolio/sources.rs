//! The engine of the portfolio: it chooses a source, and learns from the outcomes.

mod awaited;
mod choice;
mod dry;
mod filling;
mod proposals;

use awaited::PointsAwaited;
use dry::Dry;

use super::credit::{Credits, Patches};
use super::drought::Drought;
use super::guests::Guests;
use super::inner_grid::InnerGrid;
use super::levels::Levels;
use super::near_misses::NearMisses;
use super::neighbourhoods::Neighbourhoods;
use super::pace::Pace;
use super::scan::Scan;
use super::source::{PLACES, Source, Tag, Tally};
use super::swarms::Swarms;
use super::translations::Translations;
use super::visited::Visited;
use super::{Omitted, Portfolio};
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::hit_list::HitList;
use crate::engine::local::descent::RestartedDescent;
use crate::engine::low_discrepancy::EvenPoints;
use crate::engine::{Answers, Ask, Engine, Origin};
use crate::error::Error;
use crate::report::SourceCount;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::state::{Part, Reader, State};

/// Share of the evaluations that serve to estimate how complete the result is.
const PROBES: f64 = 0.02;

/// The engine of [`Portfolio`].
#[derive(Debug)]
pub(super) struct Sources<S> {
    /// Candidates proposed at once: as set by the user, and in this batch.
    asked_for: Option<usize>,
    batch: usize,
    /// Candidates of a batch that come from one choice of source.
    block: usize,
    /// After how many choices in vain a batch ends.
    patience: usize,
    /// Whether F takes less time than a choice of source.
    is_quick: bool,
    /// Whether the problem names neighbours.
    has_neighbours: bool,
    /// The source chosen last, and how many more candidates are to come from it.
    chosen: Option<(Tag, u64)>,
    /// Which sources had nothing new for this batch.
    dry: Dry,
    without: Omitted,
    credits: Credits,
    /// What each costs in time, and how many points were worked out since the turn began that are known already.
    pace: Pace<PLACES>,
    rejections: u64,
    descents: Vec<RestartedDescent<S>>,
    /// Which of them have a candidate that is not told yet.
    waiting: Vec<bool>,
    next_descent: usize,
    descended: usize,
    patches: Patches,
    drought: Drought,
    /// Uniform points, and where swarms start.
    even: EvenPoints,
    /// Instead of uniform points, where F is a step function.
    grid: InnerGrid,
    /// Values of F, where an axis is continuous.
    levels: Levels,
    /// Evaluations that were planned when the slice began, if that was known.
    planned: Option<u64>,
    guests: Guests<S>,
    hits: HitList<S>,
    visited: Option<Visited>,
    /// The lattice point by point, once uniform draws would mostly repeat points, or if the budget has room for all.
    scan: Scan,
    swarms: Swarms<S>,
    steps: Option<Translations<S>>,
    neighbourhoods: Neighbourhoods<S>,
    near_misses: NearMisses<S>,
    tags: Vec<Tag>,
    awaited: PointsAwaited<S>,
    tally: Tally,
    trials: Vec<S>,
    position: Vec<S>,
}

impl<S: Real> Sources<S> {
    pub(super) fn new(settings: &Portfolio) -> Self {
        Self {
            asked_for: settings.batch,
            batch: 1,
            block: 1,
            patience: filling::REJECTED,
            is_quick: false,
            has_neighbours: false,
            chosen: None,
            dry: Dry::default(),
            without: settings.without,
            credits: Credits::default(),
            pace: Pace::new(false),
            rejections: 0,
            descents: Vec::new(),
            waiting: Vec::new(),
            next_descent: 0,
            descended: 0,
            patches: Patches::default(),
            drought: Drought::default(),
            even: EvenPoints::default(),
            grid: InnerGrid::default(),
            levels: Levels::default(),
            planned: None,
            guests: Guests::new(settings.without),
            hits: HitList::default(),
            visited: None,
            scan: Scan::default(),
            swarms: Swarms::new(
                settings.swarms,
                settings.particles,
                settings.alpha,
                settings.restart,
            ),
            steps: None,
            neighbourhoods: Neighbourhoods::new(settings.neighbours),
            near_misses: NearMisses::new(),
            tags: Vec::new(),
            awaited: PointsAwaited::default(),
            tally: Tally::default(),
            trials: Vec::new(),
            position: Vec::new(),
        }
    }

    /// Has at least this many descents.
    fn grow_descents(&mut self, count: usize) {
        while self.descents.len() < count {
            self.descents.push(RestartedDescent::new(0.25, 1e-6));
            self.waiting.push(false);
        }
    }

    fn hit_count(&self) -> usize {
        self.hits.rows()
    }
}

impl<S: Real> Engine<S> for Sources<S> {
    fn probes(&self) -> f64 {
        PROBES
    }

    fn answers(&self) -> Answers {
        Answers::AnyOrder
    }

    fn sources(&self) -> Vec<SourceCount> {
        self.tally.counts()
    }

    fn begin(&mut self, context: &dyn Context<S>) {
        let space = context.space();
        let dimension = space.dimension();
        // A space of another dimension is another problem.
        let follows = self.position.len() == dimension;
        self.near_misses.begin(dimension, follows);
        self.position = vec![S::zero(); dimension];
        self.hits.clear();
        self.tally = Tally::default();
        self.visited = space.is_discrete().then(|| Visited::new(space));
        self.scan = Scan::new(space);
        self.swarms.begin(dimension);
        self.descents.clear();
        self.waiting.clear();
        self.next_descent = 0;
        self.credits = Credits::default();
        self.pace = Pace::new(context.is_timed());
        self.patches = Patches::default();
        self.drought = Drought::default();
        self.even = EvenPoints::default();
        self.grid = InnerGrid::default();
        self.levels = Levels::default();
        self.chosen = None;
        self.patience = filling::REJECTED;
        // The tags of the last batch name sources of the slice before.
        self.tags.clear();
        self.trials.clear();
        self.awaited = PointsAwaited::default();
        self.planned = context.evaluations_planned();
        self.guests.begin(context);
        // Steps that were good in the slice before are likely to be good in this one.
        match &mut self.steps {
            Some(steps) if follows && steps.fit(space) => steps.begin(),
            _ => self.steps = Some(Translations::new(space)),
        }
        self.neighbourhoods.begin();
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        self.tags.clear();
        self.trials.clear();
        let answer = self.fill(context, rng, out);
        if context.is_in_any_order() {
            self.awaited
                .add(&mut self.tags, &self.trials, self.position.len());
        }
        answer
    }

    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        let space = context.space();
        let is_own = match origin {
            Origin::Engine => true,
            Origin::Single { ask, place } => {
                let Some(tag) = self.awaited.take((ask, place), &mut self.trials) else {
                    return;
                };
                self.tags = vec![tag];
                true
            }
            Origin::WarmStart | Origin::Start | Origin::Exhaustion => false,
        };
        for (position, outcome) in batch.points().zip(outcomes) {
            if outcome.is_hit() {
                self.hits.push(space, position);
            } else if let Outcome::Miss(fitness) = *outcome {
                self.near_misses.keep(position, fitness);
            }
        }
        if let Some(visited) = &mut self.visited {
            // Its own candidates are in it since they were proposed, but for those of whole engines, and of descents where a look-up takes
            // longer than F. Hits always are.
            let own = |i: usize| {
                let tag = self.tags.get(i).filter(|_| is_own);
                tag.is_some_and(|tag| tag.0 != Source::Guest)
            };
            for (i, position) in batch.points().enumerate() {
                if !own(i) || outcomes[i].is_hit() {
                    visited.insert(space, position);
                }
            }
        }
        if self.without != Omitted::Neighbours && context.offers_neighbours() {
            let tags = &self.tags;
            let visited = self.visited.as_ref();
            self.neighbourhoods
                .expand_all(context, visited, (batch, outcomes), |i| {
                    !is_own || matches!(tags[i].0, Source::Neighbour | Source::NearMiss)
                });
        }
        if origin == Origin::Start {
            self.grow_descents(1);
            self.descents[0].keep_starts(batch, outcomes);
        }
        if is_own {
            if let Some((Source::Uniform, 1)) = self.tags.first() {
                self.scan.learn(outcomes);
            }
            self.pace.receives(batch.len());
        }
        self.guests.tell(
            context,
            batch,
            outcomes,
            (origin, self.tags.first().copied()),
            &mut self.pace,
        );
        if !is_own {
            return;
        }
        for (i, &(source, index)) in self.tags.iter().enumerate() {
            let (position, outcome) = (batch.point(i), outcomes[i]);
            match source {
                Source::Swarm => self.swarms.tell(index, position, outcome),
                Source::Step => {
                    if let Some(steps) = &mut self.steps {
                        steps.count(index, outcome.is_hit());
                    }
                }
                Source::Neighbour => self.neighbourhoods.count(outcome.fitness()),
                Source::NearMiss => self.near_misses.count(outcome.is_hit()),
                Source::Descent => {
                    self.waiting[index] = false;
                    self.descents[index].learn(position, outcome);
                }
                Source::Uniform | Source::Trial | Source::Cross | Source::Guest => {}
            }
        }
        if self.visited.is_none() {
            outcomes.iter().for_each(|outcome| self.levels.count(*outcome));
        }
        for (&(source, index), outcome) in self.tags.iter().zip(outcomes) {
            if *outcome == Outcome::NotEvaluated {
                continue;
            }
            let hit = outcome.is_hit();
            let place = self.place((source, index));
            let cost = self.pace.cost(place);
            self.tally.count(place, *outcome);
            self.credits.count(place, hit, cost);
            self.drought.count(hit);
            self.patches.count(self.role((source, index)), hit, cost);
            // Last, because a learned step may replace another.
            if let (Source::Trial, true, Some(steps)) = (source, hit, &mut self.steps) {
                let dimension = space.dimension();
                steps.learn(&self.trials[index * dimension..(index + 1) * dimension], space);
            }
        }
    }

    fn save(&self, state: &mut State) {
        (self.tally, self.credits).save(state);
        self.hits.save(state);
        if self.pace.is_timed() {
            self.visited.as_ref().map(Visited::shortened).save(state);
        } else {
            self.visited.save(state);
        }
        self.scan.save(state);
        self.swarms.save(state);
        self.steps.save(state);
        self.neighbourhoods.save(state, self.position.len());
        self.near_misses.save(state);
        (self.tags.clone(), self.trials.clone()).save(state);
        self.awaited.save(state);
        self.position.save(state);
        (self.patches, self.levels.clone()).save(state);
        self.drought.save(state);
        (self.even.clone(), self.grid.clone()).save(state);
        (self.chosen, self.planned, self.pace.is_timed()).save(state);
        (self.batch, self.block, self.patience, self.next_descent).save(state);
        self.waiting.save(state);
        self.descents.len().save(state);
        for descent in &self.descents {
            Part::save(descent, state);
        }
        self.guests.save(state);
    }

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        (self.tally, self.credits) = from.read()?;
        self.hits.restore(from)?;
        self.visited = from.read()?;
        self.scan = from.read()?;
        self.swarms.restore(from)?;
        self.steps = from.read()?;
        self.neighbourhoods.restore(from)?;
        self.near_misses.restore(from)?;
        (self.tags, self.trials) = from.read()?;
        self.awaited = from.read()?;
        self.position = from.read()?;
        (self.patches, self.levels) = from.read()?;
        self.drought = from.read()?;
        (self.even, self.grid) = from.read()?;
        let timed;
        (self.chosen, self.planned, timed) = from.read()?;
        self.pace = Pace::new(timed);
        (self.batch, self.block, self.patience, self.next_descent) = from.read()?;
        self.waiting = from.read()?;
        let descents: usize = from.read()?;
        self.descents.clear();
        for _ in 0..descents {
            let mut descent = RestartedDescent::new(0.25, 1e-6);
            Part::restore(&mut descent, from)?;
            self.descents.push(descent);
        }
        self.guests.restore(self.position.len(), from)?;
        let dimension = self.position.len();
        let own_fit = |(source, index): Tag| match source {
            Source::Descent => index < descents,
            Source::Swarm => index < self.swarms.len(),
            Source::Step => self.steps.as_ref().is_none_or(|steps| index < steps.len()),
            _ => true,
        };
        let trials = self.trials.len() / dimension.max(1);
        let trial_fits = |&(source, index): &Tag| source != Source::Trial || index < trials;
        let steps_fit = self.steps.as_ref().is_none_or(|steps| steps.is_whole(dimension));
        let chosen = self.chosen.map(|(tag, _)| tag);
        let out = || self.tags.iter().copied().chain(self.awaited.tags());
        let trials_fit = self.awaited.fit(self.position.len());
        if !trials_fit
            || self.waiting.len() != descents
            || !out().chain(chosen).all(own_fit)
            || !self.tags.iter().all(trial_fits)
            || !steps_fit
            || !self.guests.fit(self.tags.len(), out(), chosen)
        {
            return Err(Error::State("its batches do not fit its sources".to_owned()));
        }
        if !self.hits.fit(self.position.len()) {
            return Err(Error::State("its hits are of another space".to_owned()));
        }
        if !self.near_misses.fit(self.position.len()) {
            return Err(Error::State("its near misses are of another space".to_owned()));
        }
        if !self.neighbourhoods.fit(self.position.len()) {
            return Err(Error::State("its neighbourhoods are of another space".to_owned()));
        }
        Ok(())
    }
}

//! Whole engines as sources: each proposes a part of a batch, and learns the hits of all others.

use core::ops::Range;

use super::credit::{Credit, Trial};
use super::source::{Role, Source, Tag};
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::exact::BranchAndBound;
use crate::engine::local::RestartedCmaEs;
use crate::engine::local::flood::{Flood, Order};
use crate::engine::model::{ModelledSearch, QuadraticDescent, Surrogate};
use crate::engine::{Ask, Engine, EngineConfig, Origin};
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::state::{Part, Reader, State};

/// A model of F is used where at most so many evaluations are planned, or where one takes so many seconds, and has found so many
/// points or less; on spaces of at most so many axes.
const MODELLED: u64 = 500;
const EXPENSIVE: f64 = 5e-3;
const MODEL_AXES: usize = 20;
/// Descents by quadratic models are used where evaluations are limited, or where one takes so many seconds: they think for half of that.
const QUADRATIC: f64 = 2e-5;
/// Weight of the model until it is known to predict too little. From then on it is bounded like all that finds nothing, even where nothing
/// else has found anything: its proposals cost a hundred times the time of others.
const MODEL_WEIGHT: f64 = 40.0;
/// Candidates that compete for a proposal of the model: as many as take the time of the least number at so many points.
const CANDIDATES: (usize, usize) = (256, 1024);
const POINTS_OF_LEAST: u64 = 300;
/// Axes for which a matrix takes at most a few steps' worth of memory and time.
const CMA_AXES: usize = 200;
/// Searches of (1+1)-CMA-ES, at most: one for each four evaluations that go on at once.
const MOST_SEARCHES: usize = 64;
/// Regions that are split at once: one for so many evaluations planned, and so many at most.
const EVALUATIONS_OF_A_REGION: u64 = 64;
const MOST_REGIONS: usize = 8;
/// Shortest distance between a hit and the next point of the flood fill, as a share of each continuous axis.
const FLOOD_STEP: f64 = 1e-3;

/// Which engine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
enum Kind {
    /// (1+1)-CMA-ES with recombination of hits.
    Cma,
    /// Flood fill on continuous axes.
    Flood,
    /// Best-first regions by the problem's bounds.
    Regions,
    /// A Gaussian process.
    Model,
    /// Restarted descents by quadratic models.
    Quadratic,
}

/// The model, or another engine.
enum Member<S> {
    Model(Box<ModelledSearch<S>>),
    Other(Box<dyn Engine<S>>),
}

impl<S: Real> core::ops::Deref for Member<S> {
    type Target = dyn Engine<S>;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Model(model) => &**model,
            Self::Other(engine) => &**engine,
        }
    }
}

impl<S: Real> core::ops::DerefMut for Member<S> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Self::Model(model) => &mut **model,
            Self::Other(engine) => &mut **engine,
        }
    }
}

/// An engine and how it has fared.
struct Guest<S> {
    kind: Kind,
    engine: Member<S>,
    arm: Credit,
    /// Whether it may still have something to propose.
    open: bool,
    /// Its part of the batch that is out.
    own: Range<usize>,
}

/// What depends on the budget.
#[derive(Debug, Clone, Copy, serde::Serialize, serde::Deserialize)]
struct Sizes {
    /// Searches of (1+1)-CMA-ES side by side.
    searches: usize,
    /// Candidates of the model.
    candidates: usize,
    /// Regions that are split at once.
    regions: usize,
}

impl Sizes {
    /// For so many evaluations at once, and so many in all, if that is known.
    fn new(parallel: usize, planned: Option<u64>) -> Self {
        let (least, most) = CANDIDATES;
        let candidates = planned.map_or(least, |planned| {
            let more = (POINTS_OF_LEAST / planned.clamp(1, POINTS_OF_LEAST)).pow(2);
            least
                .saturating_mul(usize::try_from(more).unwrap_or(most))
                .min(most)
        });
        Self {
            searches: parallel.div_ceil(4).clamp(1, MOST_SEARCHES),
            candidates,
            regions: planned.map_or(MOST_REGIONS, |planned| {
                usize::try_from(planned / EVALUATIONS_OF_A_REGION)
                    .unwrap_or(MOST_REGIONS)
                    .clamp(1, MOST_REGIONS)
            }),
        }
    }

    fn are_possible(&self) -> bool {
        (1..=MOST_SEARCHES).contains(&self.searches)
            && (CANDIDATES.0..=CANDIDATES.1).contains(&self.candidates)
            && (1..=MOST_REGIONS).contains(&self.regions)
    }
}

/// The engines.
pub(super) struct Guests<S> {
    guests: Vec<Guest<S>>,
    sizes: Sizes,
    /// What one of them is told or has proposed.
    part: Batch<S>,
    outcomes: Vec<Outcome<S>>,
}

impl<S> core::fmt::Debug for Guests<S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Guests").finish_non_exhaustive()
    }
}

/// What came of asking one of them.
pub(super) enum Answer {
    /// Candidates, or work on bounds.
    Worked,
    /// The whole space is covered, with these candidates.
    Covered,
    /// Nothing at the moment.
    Nothing,
}

impl<S: Real> Guest<S> {
    fn new(kind: Kind, sizes: Sizes) -> Self {
        let engine = match kind {
            Kind::Cma => Member::Other(
                RestartedCmaEs {
                    searches: sizes.searches,
                    ..RestartedCmaEs::default()
                }
                .build(),
            ),
            Kind::Flood => Member::Other(Box::new(FloodAlone(Flood::new(FLOOD_STEP, Order::Best)))),
            Kind::Regions => Member::Other(
                BranchAndBound {
                    batch: sizes.regions,
                    ..BranchAndBound::default()
                }
                .build(),
            ),
            Kind::Quadratic => Member::Other(
                QuadraticDescent {
                    searches: sizes.searches,
                    ..QuadraticDescent::default()
                }
                .build(),
            ),
            Kind::Model => Member::Model(Box::new(ModelledSearch::new(Surrogate {
                candidates: sizes.candidates,
                ..Surrogate::default()
            }))),
        };
        Self {
            kind,
            engine,
            arm: Credit::default(),
            open: true,
            own: 0..0,
        }
    }
}

impl<S: Real> Guests<S> {
    pub(super) fn new() -> Self {
        Self {
            guests: Vec::new(),
            sizes: Sizes::new(1, None),
            part: Batch::new(1),
            outcomes: Vec::new(),
        }
    }

    /// A slice begins; without those that recombine hits, if that is wanted.
    pub(super) fn begin(&mut self, context: &dyn Context<S>, without_recombination: bool) {
        let space = context.space();
        let continuous = space.axes().iter().any(|axis| !axis.is_integer());
        self.part = Batch::new(space.dimension());
        self.sizes = Sizes::new(context.parallel(), context.evaluations_planned());
        self.guests.clear();
        for kind in [
            Kind::Cma,
            Kind::Flood,
            Kind::Regions,
            Kind::Model,
            Kind::Quadratic,
        ] {
            let is_of_use = match kind {
                Kind::Cma => continuous && !without_recombination && space.dimension() <= CMA_AXES,
                Kind::Flood => continuous,
                Kind::Quadratic => continuous && context.evaluations_planned().is_some(),
                Kind::Regions => context.lower_bound(&space.region()).is_some(),
                Kind::Model => context
                    .evaluations_planned()
                    .is_some_and(|planned| planned <= MODELLED && space.dimension() <= MODEL_AXES),
            };
            if is_of_use {
                self.open(kind, context);
            }
        }
    }

    fn open(&mut self, kind: Kind, context: &dyn Context<S>) {
        let mut guest = Guest::new(kind, self.sizes);
        guest.engine.begin(context);
        self.guests.push(guest);
    }

    /// Opens the model, and descents by quadratic models, where F turns out to be expensive.
    pub(super) fn look_at_price(&mut self, context: &dyn Context<S>) {
        let Some(seconds) = context.seconds_an_evaluation() else {
            return;
        };
        let axes = context.space().axes();
        let is_there = |kind: Kind| self.guests.iter().any(|guest| guest.kind == kind);
        let opens_model = seconds > EXPENSIVE
            && context.evaluations() <= MODELLED
            && axes.len() <= MODEL_AXES
            && !is_there(Kind::Model);
        let opens_quadratic =
            seconds > QUADRATIC && axes.iter().any(|axis| !axis.is_integer()) && !is_there(Kind::Quadratic);
        if opens_model {
            self.open(Kind::Model, context);
        }
        if opens_quadratic {
            self.open(Kind::Quadratic, context);
        }
    }

    /// A new batch begins, of which none has a part.
    pub(super) fn begin_batch(&mut self) {
        for guest in &mut self.guests {
            guest.own = 0..0;
        }
    }

    /// Whether it has a part of the batch.
    pub(super) fn has_part(&self, index: usize) -> bool {
        !self.guests[index].own.is_empty()
    }

    pub(super) fn role(&self, index: usize) -> Role {
        match self.guests[index].kind {
            Kind::Cma | Kind::Quadratic => Role::Explores,
            Kind::Flood => Role::Exploits,
            Kind::Regions | Kind::Model => Role::Apart,
        }
    }

    /// Its place among the names of all sources.
    pub(super) fn place(&self, index: usize) -> usize {
        Source::Guest as usize + self.guests[index].kind as usize
    }

    pub(super) fn credits(&self) -> impl Iterator<Item = &Credit> {
        self.guests.iter().map(|guest| &guest.arm)
    }

    /// Offers the credit of each that is worth trying and has no part of the batch yet, with its weight.
    pub(super) fn arms<'a>(
        &'a self,
        all: &'a Credit,
        trial: Trial,
    ) -> impl Iterator<Item = (usize, &'a Credit, f64)> {
        let ready = self.guests.iter().enumerate();
        ready.filter_map(move |(index, guest)| {
            if !guest.open || !guest.own.is_empty() {
                return None;
            }
            let is_worth_trying = guest.arm.is_worth_trying(all, trial);
            let weight = match (guest.kind, &guest.engine) {
                (Kind::Cma, _) => is_worth_trying.then_some(2.0),
                (Kind::Quadratic, _) => is_worth_trying.then_some(4.0),
                (Kind::Flood, _) => is_worth_trying.then_some(1.0),
                (Kind::Regions, _) => is_worth_trying.then_some(0.3),
                (Kind::Model, Member::Model(model)) => match model.is_useful() {
                    None | Some(true) => Some(MODEL_WEIGHT),
                    Some(false) => guest.arm.is_within(all, trial).then_some(1.0),
                },
                (Kind::Model, Member::Other(_)) => None,
            };
            weight.map(|weight| (index, &guest.arm, weight))
        })
    }

    /// Asks one of them for its part of the batch.
    pub(super) fn ask(
        &mut self,
        index: usize,
        context: &dyn Context<S>,
        rng: &mut SearchRng,
        out: &mut Batch<S>,
    ) -> Answer {
        let guest = &mut self.guests[index];
        let before = context.evaluations_left();
        self.part.clear();
        let answer = guest.engine.ask(context, rng, &mut self.part);
        let calls = before - context.evaluations_left();
        for _ in 0..calls {
            guest.arm.count(false);
        }
        guest.own = out.len()..out.len() + self.part.len();
        for position in self.part.points() {
            out.push(position);
        }
        match answer {
            Ask::Covered => return Answer::Covered,
            Ask::Exhausted => guest.open = false,
            Ask::More => {}
        }
        if guest.own.is_empty() && calls == 0 {
            guest.arm.count(false);
            return Answer::Nothing;
        }
        Answer::Worked
    }

    /// Tells each what became of its part, where the batch is the engine's, and of what else concerns it.
    pub(super) fn tell(
        &mut self,
        context: &dyn Context<S>,
        batch: &Batch<S>,
        outcomes: &[Outcome<S>],
        origin: Origin,
    ) {
        let Self {
            guests,
            part,
            outcomes: told,
            ..
        } = self;
        for guest in guests {
            let own = match origin {
                Origin::Engine => core::mem::take(&mut guest.own),
                _ => 0..0,
            };
            for outcome in &outcomes[own.clone()] {
                if *outcome != Outcome::NotEvaluated {
                    guest.arm.count(outcome.is_hit());
                }
            }
            if !guest.open {
                continue;
            }
            let mut tell = |is_told: &dyn Fn(usize) -> bool, origin| {
                part.clear();
                told.clear();
                for (i, position) in batch.points().enumerate().filter(|&(i, _)| is_told(i)) {
                    part.push(position);
                    told.push(outcomes[i]);
                }
                if !told.is_empty() {
                    guest.engine.tell(context, part, told, origin);
                }
            };
            tell(&|i| own.contains(&i), Origin::Engine);
            // Start points count for what they are; for the rest, the hits of others are as good as found by exhaustion.
            let origin = match origin {
                Origin::Start => Origin::Start,
                _ => Origin::Exhaustion,
            };
            let learns_from_all = guest.kind == Kind::Model || origin == Origin::Start;
            tell(
                &|i| !own.contains(&i) && (learns_from_all || outcomes[i].is_hit()),
                origin,
            );
        }
    }

    pub(super) fn save(&self, state: &mut State) {
        (self.sizes, self.guests.len()).save(state);
        for guest in &self.guests {
            (guest.kind, guest.arm, guest.open).save(state);
            (guest.own.start, guest.own.end).save(state);
            guest.engine.save(state);
        }
    }

    pub(super) fn restore(&mut self, dimension: usize, from: &mut Reader<'_>) -> Result<(), Error> {
        self.part = Batch::new(dimension);
        let (sizes, count): (Sizes, usize) = from.read()?;
        if !sizes.are_possible() {
            return Err(Error::State(
                "its engines are of a size that there is not".to_owned(),
            ));
        }
        self.sizes = sizes;
        self.guests.clear();
        for _ in 0..count {
            let (kind, arm, open) = from.read()?;
            let (start, end) = from.read()?;
            let mut guest = Guest::new(kind, sizes);
            guest.engine.restore(from)?;
            self.guests.push(Guest {
                arm,
                open,
                own: start..end,
                ..guest
            });
        }
        Ok(())
    }

    /// Whether restored parts of a batch are inside it, and it and the source chosen last name engines that there are.
    pub(super) fn fit(&self, tags: &[Tag], chosen: Option<Tag>) -> bool {
        let inside = |own: &Range<usize>| own.start <= own.end && own.end <= tags.len();
        self.guests.iter().all(|guest| inside(&guest.own))
            && tags
                .iter()
                .chain(&chosen)
                .all(|&(source, index)| source != Source::Guest || index < self.guests.len())
    }
}

/// The flood fill of the hits of others.
#[derive(Debug)]
struct FloodAlone<S>(Flood<S>);

impl<S: Real> Engine<S> for FloodAlone<S> {
    fn begin(&mut self, _: &dyn Context<S>) {
        self.0.clear();
    }

    fn ask(&mut self, context: &dyn Context<S>, _: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        self.0.ask(context, out);
        Ask::More
    }

    fn tell(&mut self, _: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], _: Origin) {
        self.0.add_hits(batch, outcomes);
    }

    fn save(&self, state: &mut State) {
        self.0.save(state);
    }

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.0.restore(from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The model takes four times the candidates at half the evaluations, regions are split one by one in a short search, and searches go
    /// on side by side where evaluations do.
    #[test]
    fn short_searches_think_more_and_ask_for_less_at_once() {
        let sizes = |parallel, planned| {
            let sizes = Sizes::new(parallel, planned);
            assert!(sizes.are_possible(), "{sizes:?}");
            [sizes.searches, sizes.candidates, sizes.regions]
        };
        assert_eq!(sizes(1, None), [1, 256, 8]);
        assert_eq!(sizes(1, Some(10_000)), [1, 256, 8]);
        assert_eq!(sizes(1, Some(300)), [1, 256, 4]);
        assert_eq!(sizes(1, Some(150)), [1, 1024, 2]);
        assert_eq!(sizes(1, Some(50)), [1, 1024, 1]);
        assert_eq!(sizes(1, Some(0)), [1, 1024, 1]);
        assert_eq!(sizes(32, Some(u64::MAX)), [8, 256, 8]);
        assert_eq!(sizes(usize::MAX, None), [64, 256, 8]);
    }
}

//! Whole engines as sources: each proposes part of a batch, and is told the hits of all the others.

mod first_hit;
mod flood_alone;
mod lessons;
mod member;
mod share;
mod side_by_side;
mod sizes;
mod waking;
mod weights;

use core::ops::Range;

use first_hit::Ground;
pub(super) use first_hit::{Expectation, Seekers};
use flood_alone::FloodAlone;
use member::Member;
use share::Share;
use side_by_side::Seen;
use sizes::{MOST_PROPOSALS, Sizes};
use weights::Situation;

use super::Omitted;
use super::credit::{Credit, Credits, Trial};
use super::source::{Role, Source, Tag};
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::exact::BranchAndBound;
use crate::engine::local::{Niching, RestartedCmaEs};
use crate::engine::model::{ModelledSearch, QuadraticDescent, Surrogate, Yardstick};
use crate::engine::{Ask, EngineConfig};
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::{Axis, AxisKind};
use crate::state::{Part, Reader, State};

/// A model of F is at work on spaces of at most `MODEL_AXES` axes where time leaves room for it: under a limit of time alone it [wakes](waking)
/// if F is expensive. It leads while fewer than `MODELLED` evaluations have been made; from then on it competes by its yield.
const MODELLED: u64 = MOST_PROPOSALS;
const MODEL_AXES: usize = 200;
/// With fewer evaluations left none are spent on bounds: a split asks for several before there is anything to evaluate.
const LAST_BOUNDS: u64 = 8;
/// With at most this many axes, a matrix takes no more memory and time than a few steps.
const CMA_AXES: usize = 200;
/// Shortest distance between a hit and the next point of the flood fill, as a share of each continuous axis.
const FLOOD_STEP: f64 = 1e-3;

/// Which engine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
enum GuestKind {
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
    /// Evolution strategies that turn away from known optima.
    Niching,
}

impl GuestKind {
    /// Whether a user wants to do without it.
    fn is_left_out(self, without: Omitted) -> bool {
        match self {
            Self::Cma => matches!(without, Omitted::CmaEs | Omitted::Recombination),
            Self::Flood => without == Omitted::FloodFill,
            Self::Regions => without == Omitted::Regions,
            Self::Model => without == Omitted::Model,
            Self::Quadratic => without == Omitted::QuadraticDescents,
            Self::Niching => matches!(without, Omitted::Niching | Omitted::Recombination),
        }
    }
}

/// Whether an engine takes part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
enum Readiness {
    /// It is told what comes before it is known whether F is expensive enough for it.
    Asleep,
    /// It may propose something.
    Open,
    /// It has nothing more to propose.
    Closed,
}

/// An engine.
struct Guest<S> {
    kind: GuestKind,
    engine: Member<S>,
    readiness: Readiness,
    /// Its share of the batch under evaluation; where answers come in any order, of the batch in which it has proposed.
    own: Range<usize>,
    share: Share<S>,
}

/// The engines.
pub(super) struct Guests<S> {
    guests: Vec<Guest<S>>,
    /// Which one to do without.
    without: Omitted,
    sizes: Sizes,
    /// Whether all axes are continuous, and F may be smooth along them.
    continuous: bool,
    /// What the search for a first hit goes by, if anything leads down.
    ground: Option<Ground>,
    /// Whether the problem tells the components of F, of which the model knows more than descents do.
    components: bool,
    /// Whether answers come one by one, in any order: then engines of a kind work side by side.
    in_any_order: bool,
    /// A buffer: what an engine has proposed, or is to be told.
    part: Batch<S>,
    outcomes: Vec<Outcome<S>>,
}

impl<S> core::fmt::Debug for Guests<S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Guests").finish_non_exhaustive()
    }
}

/// The result of asking an engine.
pub(super) enum GuestAnswer {
    /// It proposed candidates, or worked on bounds: so many evaluations.
    Worked(u64),
    /// These candidates complete the cover of the space.
    Covered,
    /// It has nothing to propose at the moment.
    Nothing,
}

impl<S: Real> Guest<S> {
    fn new(kind: GuestKind, sizes: Sizes, dimension: usize) -> Self {
        let engine = match kind {
            GuestKind::Cma => Member::Other(
                RestartedCmaEs {
                    searches: sizes.searches,
                    ..RestartedCmaEs::default()
                }
                .build(),
            ),
            GuestKind::Flood => Member::Other(Box::new(FloodAlone::new(FLOOD_STEP))),
            GuestKind::Regions => Member::Regions(Box::new(BranchAndBound::default().search())),
            GuestKind::Quadratic => Member::Other(
                QuadraticDescent {
                    searches: sizes.searches,
                    ..QuadraticDescent::default()
                }
                .build(),
            ),
            GuestKind::Niching => Member::Other(Niching::default().build()),
            GuestKind::Model => Member::Model(Box::new(ModelledSearch::new(Surrogate {
                batch: sizes.proposals_at_once,
                candidates: sizes.candidates,
                ..Surrogate::default()
            }))),
        };
        Self {
            kind,
            engine,
            readiness: Readiness::Open,
            own: 0..0,
            share: Share::new(dimension),
        }
    }
}

impl<S> Guest<S> {
    fn is_ready(&self) -> bool {
        self.readiness == Readiness::Open && self.own.is_empty()
    }

    /// Its index among the names of all sources.
    fn place(&self) -> usize {
        Source::Guest as usize + self.kind as usize
    }
}

impl<S: Real> Guests<S> {
    /// All but the one to do without.
    pub(super) fn new(without: Omitted) -> Self {
        Self {
            guests: Vec::new(),
            without,
            sizes: Sizes::default(),
            continuous: false,
            ground: None,
            components: false,
            in_any_order: false,
            part: Batch::new(1),
            outcomes: Vec::new(),
        }
    }

    /// Begins a slice.
    pub(super) fn begin(&mut self, context: &dyn Context<S>) {
        let space = context.space();
        // Continuous coordinates, or keys of permutations.
        let has_keys = space.axes().iter().any(|axis| !axis.is_integer());
        let continuous = |axis: &Axis<S>| axis.kind() == AxisKind::Continuous;
        self.continuous = space.axes().iter().all(continuous) && is_smooth(context);
        self.components = context.component_count() > 0;
        let is_permutation = space.axes().iter().all(|axis| axis.kind() == AxisKind::Place);
        self.ground = if self.continuous {
            Some(Ground::Smooth)
        } else if is_permutation || context.offers_neighbours() {
            Some(Ground::Neighbours)
        } else {
            None
        };
        self.in_any_order = context.is_in_any_order();
        self.part = Batch::new(space.dimension());
        self.sizes = Sizes::new(context);
        self.guests.clear();
        let has_room = context.evaluations_left() > LAST_BOUNDS;
        for kind in [
            GuestKind::Cma,
            GuestKind::Flood,
            GuestKind::Regions,
            GuestKind::Model,
            GuestKind::Quadratic,
            GuestKind::Niching,
        ] {
            if kind.is_left_out(self.without) {
                continue;
            }
            let is_of_use = match kind {
                GuestKind::Cma => has_keys && space.dimension() <= CMA_AXES,
                GuestKind::Niching => self.continuous && space.dimension() <= CMA_AXES,
                GuestKind::Flood => has_keys,
                GuestKind::Quadratic => is_smooth(context),
                GuestKind::Regions => has_room && context.lower_bound(&space.region()).is_some(),
                GuestKind::Model => self.sizes.proposals > 0 && space.dimension() <= MODEL_AXES,
            };
            let readiness = match kind {
                GuestKind::Model if context.is_timed() => Readiness::Asleep,
                GuestKind::Quadratic if context.is_timed() && !self.components => Readiness::Asleep,
                _ => Readiness::Open,
            };
            if is_of_use {
                self.add(kind, readiness, context);
            }
        }
    }

    /// Adds an engine of a kind.
    fn add(&mut self, kind: GuestKind, readiness: Readiness, context: &dyn Context<S>) {
        let mut guest = Guest::new(kind, self.sizes, context.space().dimension());
        guest.readiness = readiness;
        guest.engine.begin(context);
        self.guests.push(guest);
    }

    /// One engine of each kind that takes part.
    fn kinds(&self) -> impl Iterator<Item = &Guest<S>> {
        let mut seen = Seen::default();
        let guests = self.guests.iter();
        guests.filter(move |guest| guest.readiness != Readiness::Asleep && seen.is_first(guest.kind))
    }

    /// Begins a batch, in which no engine has a part yet.
    pub(super) fn begin_batch(&mut self) {
        for guest in &mut self.guests {
            guest.own = 0..0;
        }
    }

    /// Whether the engine may still propose something, and has no share of the batch.
    pub(super) fn is_ready(&self, index: usize) -> bool {
        self.guests[index].is_ready()
    }

    pub(super) fn role(&self, index: usize) -> Role {
        match self.guests[index].kind {
            GuestKind::Cma | GuestKind::Niching | GuestKind::Quadratic => Role::Explores,
            GuestKind::Flood => Role::Exploits,
            GuestKind::Regions | GuestKind::Model => Role::Apart,
        }
    }

    /// Its index among the names of all sources.
    pub(super) fn place(&self, index: usize) -> usize {
        self.guests[index].place()
    }

    /// What the model has to predict better than.
    fn yardstick(&self) -> Yardstick {
        if self.ground.is_some() {
            Yardstick::Latest
        } else {
            Yardstick::First
        }
    }

    /// Whether a model of F is open and may be of use.
    pub(super) fn has_model(&self) -> bool {
        self.guests.iter().any(|guest| match &guest.engine {
            Member::Model(model) => {
                guest.readiness == Readiness::Open && model.is_useful(self.yardstick()) != Some(false)
            }
            Member::Regions(_) | Member::Other(_) => false,
        })
    }

    /// Whether a model of F decides who proposes: while the search as a whole, `all`, is young.
    pub(super) fn model_leads(&self, all: &Credit) -> bool {
        all.evaluations() < MODELLED && self.has_model()
    }

    /// Whether a model of F is or was at work.
    pub(super) fn modelled(&self) -> bool {
        self.kinds().any(|guest| guest.kind == GuestKind::Model)
    }

    /// The engine for optima that are hard to reach, which searches when the others find nothing; if it has no part of the batch yet.
    pub(super) fn niching(&self) -> Option<usize> {
        let mut guests = self.guests.iter();
        guests.position(|guest| guest.kind == GuestKind::Niching && guest.is_ready())
    }

    /// The engines that are drawn by their yield, by their indices among the names of all sources.
    pub(super) fn drawn(&self) -> impl Iterator<Item = usize> {
        let drawn = self.kinds().filter(|guest| guest.kind != GuestKind::Niching);
        drawn.map(Guest::place)
    }

    /// The indices and weights of the engines that are worth trying and have no part of the batch yet. `modelled`: whether a model of F is
    /// at work. `steps`: whether F is a step function.
    pub(super) fn weights<'a>(
        &'a self,
        credits: &'a Credits,
        trial: Trial,
        modelled: bool,
        steps: bool,
    ) -> impl Iterator<Item = (usize, f64)> {
        let leads = self.components && !self.promises_little();
        let situation = Situation {
            descends_first: modelled && self.continuous && !leads && !steps,
            components: self.components,
            steps,
            yardstick: self.yardstick(),
        };
        let ready = self.guests.iter().enumerate();
        let mut offered = Seen::default();
        ready.filter_map(move |(index, guest)| {
            if !guest.is_ready() || !offered.is_first(guest.kind) {
                return None;
            }
            let trial = match guest.kind {
                GuestKind::Quadratic if modelled && self.components => {
                    Trial::beside_components(credits.whole.missed())
                }
                _ => trial,
            };
            let weight = guest.weight(credits, trial, situation);
            weight.map(|weight| (index, weight))
        })
    }

    /// Asks an engine for its share of a batch of which so many points are wanted. What it works out but does not propose counts as misses.
    pub(super) fn ask(
        &mut self,
        index: usize,
        context: &dyn Context<S>,
        rng: &mut SearchRng,
        out: &mut Batch<S>,
        (wanted, room, idle_cost): (usize, usize, f64),
        credit: &mut Credit,
    ) -> GuestAnswer {
        let guest = &mut self.guests[index];
        match &mut guest.engine {
            Member::Model(model) => {
                // With one point more than wanted, a worker would do two while the others wait.
                let wanted = wanted.saturating_sub(out.len());
                model.set_batch(wanted.min(self.sizes.proposals_at_once));
            }
            Member::Regions(regions) => regions.set_batch(self.sizes.regions.max(room)),
            Member::Other(_) => {}
        }
        let before = context.evaluations_left();
        if guest.kind == GuestKind::Regions && before < LAST_BOUNDS {
            return GuestAnswer::Nothing;
        }
        self.part.clear();
        let answer = guest.engine.ask(context, rng, &mut self.part);
        let calls = before - context.evaluations_left();
        for _ in 0..calls {
            credit.count(false, idle_cost);
        }
        guest.own = out.len()..out.len() + self.part.len();
        for position in self.part.points() {
            out.push(position);
        }
        let proposed = guest.own.len();
        if self.in_any_order && guest.kind == GuestKind::Model {
            guest.own = 0..0; // it takes each answer as it comes
        } else {
            guest.share.begin(self.part.points());
        }
        match answer {
            Ask::Covered => return GuestAnswer::Covered,
            Ask::Exhausted => guest.readiness = Readiness::Closed,
            Ask::More => {}
        }
        if guest.kind == GuestKind::Model && credit.evaluations() >= self.sizes.proposals {
            guest.readiness = Readiness::Closed;
        }
        if proposed == 0 && calls == 0 {
            credit.count(false, idle_cost);
            return GuestAnswer::Nothing;
        }
        GuestAnswer::Worked(calls + proposed as u64)
    }

    pub(super) fn save(&self, state: &mut State) {
        (self.sizes, self.continuous, self.components, self.guests.len()).save(state);
        (self.in_any_order, self.ground).save(state);
        for guest in &self.guests {
            (guest.kind, guest.readiness).save(state);
            (guest.own.start, guest.own.end).save(state);
            guest.share.save(state);
            guest.engine.save(state);
        }
    }

    pub(super) fn restore(&mut self, dimension: usize, from: &mut Reader<'_>) -> Result<(), Error> {
        self.part = Batch::new(dimension);
        let (sizes, continuous, components, count): (Sizes, bool, bool, usize) = from.read()?;
        if !sizes.are_possible() {
            return Err(Error::State(
                "its engines are of a size that there is not".to_owned(),
            ));
        }
        self.sizes = sizes;
        (self.continuous, self.components) = (continuous, components);
        (self.in_any_order, self.ground) = from.read()?;
        self.guests.clear();
        for _ in 0..count {
            let (kind, readiness) = from.read()?;
            let (start, end) = from.read()?;
            let share = Share::restored(dimension, from)?;
            let mut guest = Guest::new(kind, sizes, dimension);
            guest.engine.restore(from)?;
            self.guests.push(Guest {
                readiness,
                own: start..end,
                share,
                ..guest
            });
        }
        Ok(())
    }

    /// Whether restored parts lie inside a batch of this size, and the tags name engines that exist.
    pub(super) fn fit(&self, batch: usize, tags: impl Iterator<Item = Tag>, chosen: Option<Tag>) -> bool {
        let fits = |guest: &Guest<S>| {
            let own = &guest.own;
            if self.in_any_order {
                own.is_empty() || own.start <= own.end && own.len() == guest.share.len()
            } else {
                own.start <= own.end && own.end <= batch
            }
        };
        self.guests.iter().all(fits)
            && tags
                .chain(chosen)
                .all(|(source, index)| source != Source::Guest || index < self.guests.len())
    }
}

/// Whether F may be smooth along some axes. Along the keys of a permutation it is not: F depends on their order alone. A problem that
/// names neighbours may use keys of its own.
fn is_smooth<S: Real>(context: &dyn Context<S>) -> bool {
    let has = |kind| context.space().axes().iter().any(|axis| axis.kind() == kind);
    has(AxisKind::Continuous) && !has(AxisKind::Place) && !context.offers_neighbours()
}

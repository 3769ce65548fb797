//! Whole engines as sources: each proposes a batch of its own, and learns the hits of all others.

use super::credit::Credit;
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::exact::BranchAndBound;
use crate::engine::local::RestartedCmaEs;
use crate::engine::local::flood::Flood;
use crate::engine::model::Surrogate;
use crate::engine::{Ask, Engine, EngineConfig, Origin};
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::state::{Part, Reader, State};

/// A model of F is used where at most so many evaluations are planned, or where one takes so many seconds, and has found so many
/// points or less; on spaces of at most so many axes.
const MODELLED: u64 = 500;
const EXPENSIVE: f64 = 5e-3;
const AXES: usize = 20;
/// Shortest distance between a hit and the next point of the flood fill, as a share of each continuous axis.
const FLOOD_STEP: f64 = 1e-3;

/// The engines, in the order of their places.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// (1+1)-CMA-ES with recombination of hits.
    Cma,
    /// Flood fill on continuous axes.
    Flood,
    /// Best-first regions by the problem's bounds.
    Regions,
    /// A Gaussian process.
    Model,
}

const KINDS: [Kind; 4] = [Kind::Cma, Kind::Flood, Kind::Regions, Kind::Model];

/// An engine and how it has fared.
struct Guest<S> {
    kind: Kind,
    engine: Box<dyn Engine<S>>,
    arm: Credit,
    /// Whether it may still have something to propose.
    open: bool,
}

/// The engines.
pub(super) struct Guests<S> {
    guests: Vec<Guest<S>>,
    /// Told to the others: hits of one of them.
    hits: Batch<S>,
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

impl<S: Real> Guests<S> {
    pub(super) fn new() -> Self {
        let build = |kind| -> Box<dyn Engine<S>> {
            match kind {
                Kind::Cma => RestartedCmaEs {
                    searches: 1,
                    ..RestartedCmaEs::default()
                }
                .build(),
                Kind::Flood => Box::new(FloodAlone(Flood::new(FLOOD_STEP))),
                Kind::Regions => BranchAndBound {
                    batch: 8,
                    ..BranchAndBound::default()
                }
                .build(),
                Kind::Model => Surrogate::default().build(),
            }
        };
        let guest = |kind| Guest {
            kind,
            engine: build(kind),
            arm: Credit::default(),
            open: false,
        };
        Self {
            guests: KINDS.into_iter().map(guest).collect(),
            hits: Batch::new(1),
        }
    }

    /// A slice begins; without those that recombine hits, if that is wanted.
    pub(super) fn begin(&mut self, context: &dyn Context<S>, without_recombination: bool) {
        let space = context.space();
        let continuous = space.axes().iter().any(|axis| !axis.is_integer());
        let small = space.dimension() <= AXES;
        self.hits = Batch::new(space.dimension());
        for guest in &mut self.guests {
            guest.arm = Credit::default();
            guest.open = match guest.kind {
                Kind::Cma => continuous && !without_recombination,
                Kind::Flood => continuous,
                Kind::Regions => context.lower_bound(&space.region()).is_some(),
                Kind::Model => context
                    .evaluations_planned()
                    .is_some_and(|planned| planned <= MODELLED && small),
            };
            guest.engine.begin(context);
        }
    }

    /// Opens the model where F turns out to be expensive.
    pub(super) fn look_at_price(&mut self, context: &dyn Context<S>) {
        let expensive = context
            .seconds_an_evaluation()
            .is_some_and(|seconds| seconds > EXPENSIVE);
        if expensive && context.evaluations() <= MODELLED && context.space().dimension() <= AXES {
            for guest in self.guests.iter_mut().filter(|guest| guest.kind == Kind::Model) {
                guest.open = true;
            }
        }
    }

    /// Offers the credit of each that is open and worth trying, with its weight.
    pub(super) fn arms<'a>(&'a self, all: &'a Credit) -> impl Iterator<Item = (usize, &'a Credit, f64)> {
        let open = self.guests.iter().enumerate().filter(move |(_, guest)| {
            let searches = matches!(guest.kind, Kind::Cma | Kind::Model);
            guest.open && (searches || guest.arm.is_worth_trying(all))
        });
        open.map(|(index, guest)| {
            let weight = match guest.kind {
                Kind::Cma => 2.0,
                Kind::Flood => 1.0,
                Kind::Regions => 0.3,
                Kind::Model => 40.0,
            };
            (index, &guest.arm, weight)
        })
    }

    /// Asks one of them.
    pub(super) fn ask(
        &mut self,
        index: usize,
        context: &dyn Context<S>,
        rng: &mut SearchRng,
        out: &mut Batch<S>,
    ) -> Answer {
        let guest = &mut self.guests[index];
        let before = context.evaluations_left();
        let answer = guest.engine.ask(context, rng, out);
        let calls = before - context.evaluations_left();
        for _ in 0..calls {
            guest.arm.count(false);
        }
        match answer {
            Ask::Covered => return Answer::Covered,
            Ask::Exhausted => guest.open = false,
            Ask::More => {}
        }
        if out.is_empty() && calls == 0 {
            guest.arm.count(false);
            return Answer::Nothing;
        }
        Answer::Worked
    }

    /// Tells all of them; `own` is the one whose batch it is.
    pub(super) fn tell(
        &mut self,
        own: Option<usize>,
        context: &dyn Context<S>,
        batch: &Batch<S>,
        outcomes: &[Outcome<S>],
    ) {
        self.hits.clear();
        let mut hits = Vec::new();
        for (position, outcome) in batch.points().zip(outcomes) {
            if outcome.is_hit() {
                self.hits.push(position);
                hits.push(*outcome);
            }
        }
        for (index, guest) in self.guests.iter_mut().enumerate().filter(|(_, guest)| guest.open) {
            if own == Some(index) {
                for outcome in outcomes {
                    guest.arm.count(outcome.is_hit());
                }
                guest.engine.tell(context, batch, outcomes, Origin::Engine);
            } else if guest.kind == Kind::Model {
                guest.engine.tell(context, batch, outcomes, Origin::Exhaustion);
            } else if !hits.is_empty() {
                guest.engine.tell(context, &self.hits, &hits, Origin::Exhaustion);
            }
        }
    }

    pub(super) fn save(&self, state: &mut State) {
        for guest in &self.guests {
            (guest.arm, guest.open).save(state);
            guest.engine.save(state);
        }
    }

    pub(super) fn restore(&mut self, dimension: usize, from: &mut Reader<'_>) -> Result<(), Error> {
        self.hits = Batch::new(dimension);
        for guest in &mut self.guests {
            (guest.arm, guest.open) = from.read()?;
            guest.engine.restore(from)?;
        }
        Ok(())
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

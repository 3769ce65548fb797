//! Engines: how the next candidates are chosen. Each has a file with its settings and its equations, and a line in the
//! registry, [`all`].

use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::error::Error;
use crate::report::SourceCount;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::state::{Reader, State};

mod compiled;
#[doc(hidden)]
pub mod config;
mod configured;
mod decorate;
mod exact;
mod hit_list;
mod local;
mod low_discrepancy;
mod model;
mod portfolio;
mod registry;
mod swarm;

pub use config::{EngineConfig, Setting, Settings};
pub use configured::{COMMON_PARAMETERS, ConfiguredEngine};
pub use exact::*;
pub use local::*;
pub use model::*;
pub use portfolio::*;
pub use registry::{EngineSpec, all, default, find};
pub use swarm::*;

/// What an engine says after proposing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Ask {
    /// There is more to come.
    More,
    /// Nothing more to propose, though the space may hold more hits.
    Exhausted,
    /// Every point of the space has been proposed or excluded by bounds: the result is complete.
    Covered,
}

/// In what order an engine takes the answers to its proposals, where they [come as they come](crate::Tickets::eager).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub enum Answers {
    /// A batch at a time. While most answers to a batch are awaited, another engine of the same kind works beside it.
    #[default]
    ByBatch,
    /// A batch at a time, and a second engine would do the same again. While answers are awaited, the batch is told without
    /// them; they are told later.
    Alone,
    /// Each by itself, while it is asked for more: [`Engine::tell`] is then given one point of any batch, as [`Origin::Single`], in any
    /// order.
    AnyOrder,
}

impl Answers {
    /// For an engine around one that takes answers so, and that keeps track of each batch.
    pub(crate) fn in_batches(self) -> Self {
        match self {
            Self::Alone => Self::Alone,
            Self::ByBatch | Self::AnyOrder => Self::ByBatch,
        }
    }
}

/// How a slice makes use of the hits of the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub enum WarmStart {
    /// Not at all: a new engine begins.
    Cold,
    /// The engine's own rule, from [`Context::previous_hit`].
    Engine,
    /// All of them are evaluated again, in order, before the engine is asked; it is told of them.
    #[default]
    Verify,
}

/// A search strategy that is asked for points and told their outcomes.
///
/// One virtual call per batch. An engine whose next point depends on the last outcome asks for batches of one, and may offer to
/// [`advance`](Engine::advance) by itself, which saves half of what the detour costs (`cargo bench --bench engine`).
///
/// Laws, checked for every registered engine by the conformance suite of [`crate::testing`]: numbers are drawn from `rng`
/// in `ask` and `advance` only; nothing depends on time, threads or addresses; NaN and infinite fitness do no harm; axes of width zero
/// and a single axis are fine; a restored engine continues as the saved one would have.
pub trait Engine<S: Real>: Send {
    /// A slice begins: the problem may have moved, C is empty, C_prev is available in `context`.
    fn begin(&mut self, context: &dyn Context<S>);

    /// Appends proposals to `out`, which is empty. [`Ask::More`] without a proposal is asked again, a thousand times at most.
    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask;

    /// Reports the outcome of each point of `batch`, which holds the proposals as the boundary rule left them. Also called
    /// with points that the engine has not proposed: see [`Origin`].
    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin);

    /// Takes steps of one point each until [`Steps::take`] says that it was the last, and returns `true`; or returns `false`
    /// without having done anything, and is asked.
    ///
    /// A short cut, never a necessity: points and random numbers are those of [`ask`](Engine::ask) and
    /// [`tell`](Engine::tell) in turn, which drive the engine where points are evaluated by hand or checkpoints are kept.
    fn advance(&mut self, _rng: &mut SearchRng, _steps: &mut dyn Steps<S>) -> bool {
        false
    }

    /// Whether found solutions are deleted from the space (F taken as infinite, not evaluated); if not, they are evaluated
    /// again and come back as [`Outcome::Known`].
    fn deletes(&self) -> bool {
        true
    }

    /// In what order it takes answers where points are evaluated [elsewhere](crate::Tickets).
    fn answers(&self) -> Answers {
        Answers::default()
    }

    /// How this engine wants to start a slice that has a predecessor.
    fn warm_start(&self) -> WarmStart {
        WarmStart::default()
    }

    /// The share of the evaluations that this engine wants spent on [uniform probes](crate::Search::probes), 0 to 0.5. None are made of a budget
    /// that leaves fewer than ten.
    fn probes(&self) -> f64 {
        0.0
    }

    /// What its sources of candidates have proposed and found since the slice began, always in the same order; empty, the default,
    /// for an engine that has no sources to tell apart.
    fn sources(&self) -> Vec<SourceCount> {
        Vec::new()
    }

    /// Appends all that changes while the engine runs.
    fn save(&self, state: &mut State);

    /// Restores what [`Engine::save`] wrote, into an engine built with the same parameters.
    ///
    /// # Errors
    /// [`Error::State`] if the state is not of such an engine.
    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error>;
}

/// The search, as an engine sees it that [advances](Engine::advance) by itself.
pub trait Steps<S> {
    /// Brings a position inside and evaluates it. Returns its outcome and whether there may be another step; after the last
    /// one, nothing is evaluated any more.
    ///
    /// # Panics
    /// If the position has not as many coordinates as the space has axes.
    fn take(&mut self, position: &mut [S]) -> (Outcome<S>, bool);

    /// As [`Context::elapsed_share`].
    fn elapsed_share(&self) -> f64;

    /// As [`Context::is_out_of_time`].
    fn is_out_of_time(&self) -> bool {
        false
    }
}

/// Who proposed a batch that an engine is told of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Origin {
    /// The engine itself: the points are those of its last `ask`, in order.
    Engine,
    /// The engine itself: one point, in [any order](Answers::AnyOrder).
    Single {
        /// Of which `ask` since the slice began, counted from 1.
        ask: u64,
        /// Which of its proposals it was, from 0.
        place: usize,
    },
    /// The search: hits of the slice before, evaluated again; also answers that came after their batch was told.
    WarmStart,
    /// The user: [start points](crate::Search::start_from) and [values from elsewhere](crate::Tickets::inform).
    Start,
    /// The search: neighbours of a hit.
    Exhaustion,
}

//! A flood fill as a whole engine.

use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::local::flood::{Flood, Order};
use crate::engine::{Ask, Engine, Origin};
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::state::{Part, Reader, State};

/// A flood fill from the hits of other sources.
#[derive(Debug)]
pub(super) struct FloodAlone<S>(Flood<S>);

impl<S: Real> FloodAlone<S> {
    /// Points at least so far from a hit, as a share of each axis.
    pub(super) fn new(step: f64) -> Self {
        Self(Flood::new(step, Order::Best))
    }
}

impl<S: Real> Engine<S> for FloodAlone<S> {
    fn begin(&mut self, _: &dyn Context<S>) {
        self.0.clear();
    }

    fn ask(&mut self, context: &dyn Context<S>, _: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        // One look at a time: where most neighbours are known, it would go over all hits, and others wait.
        self.0.look_on(context, out);
        Ask::More
    }

    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], _: Origin) {
        self.0.add_hits(context.space(), batch, outcomes);
    }

    fn save(&self, state: &mut State) {
        self.0.save(state);
    }

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.0.restore(from)
    }
}

//! Engines that are opened once it is known what F costs, or how rare hits are.

use super::{GuestKind, Guests, MODEL_AXES, MODELLED, is_smooth};
use crate::context::Context;
use crate::engine::portfolio::credit::Credit;
use crate::scalar::Real;

/// The model is opened where an evaluation takes more seconds than this and at most `MODELLED` have been made.
const EXPENSIVE: f64 = 2e-3;
/// Descents by quadratic models run under a limit of evaluations, or where an evaluation takes more seconds than this: a proposal takes
/// about half as long. Those by components always run.
const QUADRATIC: f64 = 2e-5;
/// Where nothing leads down and no model is at work because more evaluations are planned, it is opened after `UNMODELLED` evaluations, if a hit
/// takes more than `RARE` of them, unless more than `MOST_PLANNED` are planned: then it makes no difference.
const UNMODELLED: u64 = 250;
const RARE: f64 = 16.0;
const MOST_PLANNED: u64 = 10_000;

impl<S: Real> Guests<S> {
    /// Opens the model and the descents by quadratic models once F turns out to be expensive enough for them.
    pub(in crate::engine::portfolio) fn look_at_price(&mut self, context: &dyn Context<S>) {
        let Some(seconds) = context.seconds_an_evaluation() else {
            return;
        };
        let axes = context.space().axes();
        let is_there = |kind: GuestKind| self.guests.iter().any(|guest| guest.kind == kind);
        let opens_model = seconds > EXPENSIVE
            && context.evaluations() <= MODELLED
            && axes.len() <= MODEL_AXES
            && !is_there(GuestKind::Model);
        let opens_quadratic = seconds > QUADRATIC && is_smooth(context) && !is_there(GuestKind::Quadratic);
        if opens_model {
            self.open(GuestKind::Model, context);
        }
        if opens_quadratic {
            self.open(GuestKind::Quadratic, context);
        }
    }

    /// Opens the model where nothing leads down, once hits turn out to be rare.
    pub(in crate::engine::portfolio) fn look_at_yield(&mut self, context: &dyn Context<S>, all: &Credit) {
        let is_due = (UNMODELLED..MODELLED).contains(&all.evaluations()) && all.price() > RARE;
        if !is_due || self.ground.is_some() || self.modelled() {
            return;
        }
        let is_short = context
            .evaluations_planned()
            .is_some_and(|planned| planned <= MOST_PLANNED);
        if is_short && context.seconds_planned().is_none() && context.space().dimension() <= MODEL_AXES {
            self.sizes.proposals = MODELLED;
            self.open(GuestKind::Model, context);
        }
    }
}

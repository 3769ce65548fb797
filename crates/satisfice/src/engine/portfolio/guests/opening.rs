//! Engines that are opened once it is known what F costs.

use super::{GuestKind, Guests, MODEL_AXES, MODELLED, is_smooth};
use crate::context::Context;
use crate::scalar::Real;

/// The model is opened where an evaluation takes more seconds than this and at most `MODELLED` have been made.
const EXPENSIVE: f64 = 2e-3;
/// Descents by quadratic models run under a limit of evaluations, or where an evaluation takes more seconds than this: a proposal takes
/// about half as long. Those by components always run.
const QUADRATIC: f64 = 2e-5;

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
}

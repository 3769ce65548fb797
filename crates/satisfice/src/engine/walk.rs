//! A random walk from the latest hit: ten lines that every swarm has to beat.

use super::{Ask, Engine, Origin};
use crate::batch::{Batch, Outcome};
use crate::catalogue::{Parameter, Params};
use crate::context::Context;
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;

pub(super) const PARAMETERS: &[Parameter] = &[
    Parameter::real("uniform", "share of uniform points", 0.1, 0.0, 1.0),
    Parameter::real(
        "shortest",
        "shortest step on a continuous axis, as a share of it; a cell on an integer axis",
        1e-4,
        1e-12,
        1.0,
    ),
];

/// From the latest hit G, one point at a time, on every axis j of width w_j
///
/// ```text
/// X_j = G_j + s_j U(-1, 1),   s_j = w_j shortest_j^u,   u ~ U(0, 1) for all axes alike
/// ```
///
/// so that the lengths s are log-uniform between the shortest step (a cell on an integer axis) and the whole axis. One point
/// in ten, and every point while there is no hit, is uniform. Hits are deleted.
#[derive(Debug)]
pub(super) struct Walk<S> {
    uniform: f64,
    shortest: f64,
    latest_hit: Option<Vec<S>>,
}

pub(super) fn build<S: Real>(values: &Params) -> Result<Box<dyn Engine<S>>, Error> {
    Ok(Box::new(Walk {
        uniform: values.real("uniform"),
        shortest: values.real("shortest"),
        latest_hit: None,
    }))
}

impl<S: Real> Engine<S> for Walk<S> {
    fn begin(&mut self, _: &dyn Context<S>) {
        self.latest_hit = None;
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        let space = context.space();
        let from = self.latest_hit.as_ref().filter(|_| rng.uniform() >= self.uniform);
        let Some(from) = from else {
            out.push_with(|position| rng.position(space, position));
            return Ask::More;
        };
        out.push(from);
        let u = rng.uniform();
        for (axis, x) in space.axes().iter().zip(out.point_mut(0)) {
            let width = axis.width().f64();
            let step = if axis.is_integer() {
                width.powf(1.0 - u)
            } else {
                width * self.shortest.powf(u)
            };
            *x = *x + S::of(step * (2.0 * rng.uniform() - 1.0));
        }
        Ask::More
    }

    fn tell(&mut self, _: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], _: Origin) {
        let Some(i) = outcomes.iter().rposition(|outcome| outcome.is_hit()) else {
            return;
        };
        let latest = self.latest_hit.get_or_insert_default();
        latest.clear();
        latest.extend_from_slice(batch.point(i));
    }

    crate::saved_fields!(latest_hit);
}

//! Uniform random sampling: the baseline that every engine has to beat.

use super::{Ask, Engine, Origin};
use crate::batch::{Batch, Outcome};
use crate::catalogue::{Parameter, Params};
use crate::context::Context;
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;

pub(super) const PARAMETERS: &[Parameter] = &[Parameter::integer(
    "batch",
    "points proposed at once; changes no hit",
    64,
    1,
    1 << 20,
)];

/// Every point independent and uniform in the space, with replacement.
#[derive(Debug)]
pub(super) struct Random {
    batch: usize,
}

pub(super) fn build<S: Real>(values: &Params) -> Result<Box<dyn Engine<S>>, Error> {
    Ok(Box::new(Random {
        batch: values.count("batch"),
    }))
}

impl<S: Real> Engine<S> for Random {
    fn begin(&mut self, _context: &dyn Context<S>) {}

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        for _ in 0..self.batch {
            out.push_with(|position| rng.position(context.space(), position));
        }
        Ask::More
    }

    fn tell(&mut self, _: &dyn Context<S>, _: &Batch<S>, _: &[Outcome<S>], _: Origin) {}

    crate::saved_fields!();
}

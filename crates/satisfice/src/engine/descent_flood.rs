//! Restarted descent, and every hit's neighbourhood exhausted.

use super::descent::{Descent, SHORTEST, STEP};
use super::flood::Flood;
use super::{Ask, Engine, Origin};
use crate::batch::{Batch, Outcome};
use crate::catalogue::{Parameter, Params};
use crate::context::Context;
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;

pub(super) const PARAMETERS: &[Parameter] = &[
    STEP,
    SHORTEST,
    Parameter::real(
        "flood-step",
        "shortest distance between a hit and the next point flooded on continuous axes, as a share of each",
        1e-3,
        1e-12,
        1.0,
    ),
];

/// `descent`, and from every hit its neighbours, their neighbours if they are hits, and so on, before the next descent.
///
/// A slice that begins with the hits of the one before, verified, floods from them first.
///
/// After Guy, Debunne 2004 (INRIA RR-5136) and Kimmerle, Nesme, Faure 2004 (VMV).
#[derive(Debug)]
pub(super) struct DescentFlood<S> {
    descent: Descent<S>,
    flood: Flood<S>,
    /// Whether the last proposals were the flood's.
    flooding: bool,
}

pub(super) fn build<S: Real>(values: &Params) -> Result<Box<dyn Engine<S>>, Error> {
    Ok(Box::new(DescentFlood {
        descent: Descent::new(values),
        flood: Flood::new(values.real("flood-step")),
        flooding: false,
    }))
}

impl<S: Real> Engine<S> for DescentFlood<S> {
    fn begin(&mut self, _: &dyn Context<S>) {
        self.descent.restart();
        self.flood.clear();
        self.flooding = false;
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        self.flooding = self.flood.ask(context, out);
        if !self.flooding {
            self.descent.propose(context, rng, out);
        }
        Ask::More
    }

    fn tell(&mut self, _: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        self.flood.add_hits(batch, outcomes);
        if origin == Origin::Engine && !self.flooding {
            self.descent.learn(batch, outcomes);
        }
    }

    crate::saved_fields!(descent, flood, flooding);
}

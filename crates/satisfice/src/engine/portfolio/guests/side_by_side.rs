//! Engines of a kind that work side by side.

use super::{GuestKind, Guests, sizes};
use crate::context::Context;
use crate::scalar::Real;

/// The kinds that were met.
#[derive(Debug, Default)]
pub(super) struct Seen(u32);

impl Seen {
    /// Whether the kind is met for the first time.
    pub(super) fn is_first(&mut self, kind: GuestKind) -> bool {
        let bit = 1 << kind as u32;
        let is_first = self.0 & bit == 0;
        self.0 |= bit;
        is_first
    }
}

impl<S: Real> Guests<S> {
    /// Where answers come one by one, an engine whose points follow from one another has one point out at a time: so many engines of its kind as
    /// there are searches for the points that are out.
    pub(in crate::engine::portfolio) fn grow(&mut self, context: &dyn Context<S>) {
        if !self.in_any_order {
            return;
        }
        for kind in [GuestKind::Cma, GuestKind::Quadratic] {
            let same = || self.guests.iter().filter(|guest| guest.kind == kind);
            let Some(readiness) = same().next().map(|guest| guest.readiness) else {
                continue;
            };
            for _ in same().count()..sizes::searches(context.parallel()) {
                self.add(kind, readiness, context);
            }
        }
    }
}

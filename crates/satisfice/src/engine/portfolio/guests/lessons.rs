//! What engines are told.

use core::ops::Range;

use super::{GuestKind, Guests, Readiness};
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::Origin;
use crate::engine::portfolio::pace::Pace;
use crate::engine::portfolio::source::{PLACES, Source, Tag};
use crate::scalar::Real;

impl<S: Real> Guests<S> {
    /// Tells each engine the outcomes of its share of the batch, once all of them are known, and the other outcomes that concern it. `tag`:
    /// whose the point is, where answers come one by one.
    pub(in crate::engine::portfolio) fn tell(
        &mut self,
        context: &dyn Context<S>,
        batch: &Batch<S>,
        outcomes: &[Outcome<S>],
        (origin, tag): (Origin, Option<Tag>),
        pace: &mut Pace<PLACES>,
    ) {
        self.look_at_price(context);
        let hits = outcomes.iter().any(|outcome| outcome.is_hit());
        // An engine takes start points for what they are, and hits of others as if exhaustion had found them.
        let elsewhere = match origin {
            Origin::Start => Origin::Start,
            _ => Origin::Exhaustion,
        };
        for index in 0..self.guests.len() {
            let guest = &self.guests[index];
            let (own, place) = match (origin, tag) {
                (Origin::Engine, _) => (guest.own.clone(), 0),
                (Origin::Single { place, .. }, Some((Source::Guest, of))) if of == index => {
                    (0..1, place.saturating_sub(guest.own.start))
                }
                _ => (0..0, 0),
            };
            if !own.is_empty() {
                self.tell_own(index, context, (batch, outcomes), (own.clone(), place), pace);
            }
            let guest = &mut self.guests[index];
            let learns_from_all = guest.kind == GuestKind::Model || elsewhere == Origin::Start;
            let listens = match guest.readiness {
                Readiness::Asleep => context.seconds_an_evaluation().is_none(),
                Readiness::Open => true,
                Readiness::Closed => false,
            };
            if listens && (learns_from_all || hits) {
                self.part.clear();
                self.outcomes.clear();
                for (i, outcome) in outcomes.iter().enumerate() {
                    if !own.contains(&i) && (learns_from_all || outcome.is_hit()) {
                        self.part.push(batch.point(i));
                        self.outcomes.push(*outcome);
                    }
                }
                if !self.outcomes.is_empty() {
                    guest.engine.tell(context, &self.part, &self.outcomes, elsewhere);
                }
            }
        }
    }

    /// Tells an engine of points that are its own: those of this range of the batch, which begin at `place` in its share.
    fn tell_own(
        &mut self,
        index: usize,
        context: &dyn Context<S>,
        (batch, outcomes): (&Batch<S>, &[Outcome<S>]),
        (own, place): (Range<usize>, usize),
        pace: &mut Pace<PLACES>,
    ) {
        let guest = &mut self.guests[index];
        let at = guest.place();
        let takes_each = self.in_any_order && guest.kind == GuestKind::Model;
        let place = if takes_each { 0 } else { place };
        if takes_each {
            guest.share.begin(batch.points());
        }
        for (k, i) in own.enumerate() {
            guest.share.take(place + k, batch.point(i), outcomes[i]);
        }
        if !guest.share.is_told() {
            return;
        }
        guest.own = 0..0;
        if guest.readiness == Readiness::Open {
            let watch = pace.learns(at);
            let (points, outcomes) = guest.share.told();
            guest.engine.tell(context, points, outcomes, Origin::Engine);
            pace.learned(at, watch, outcomes.len());
        }
    }
}

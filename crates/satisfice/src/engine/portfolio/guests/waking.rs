//! Engines that wake once it is known what F costs.

use super::{GuestKind, Guests, MODELLED, Readiness};
use crate::context::Context;
use crate::scalar::Real;

/// Where time alone is limited, the model wakes if an evaluation takes more seconds than this and at most `MODELLED` have been made.
const EXPENSIVE: f64 = 2e-3;
/// Descents by quadratic models do if it takes more than this: a proposal takes about half as long. Those by components are always awake.
const QUADRATIC: f64 = 2e-5;

impl<S: Real> Guests<S> {
    /// Wakes the model and the descents by quadratic models if F turns out to be expensive enough for them.
    pub(in crate::engine::portfolio) fn look_at_price(&mut self, context: &dyn Context<S>) {
        let Some(seconds) = context.seconds_an_evaluation() else {
            return;
        };
        let is_young = context.evaluations() <= MODELLED;
        for guest in &mut self.guests {
            let wakes = match guest.kind {
                GuestKind::Model => is_young && seconds > EXPENSIVE,
                GuestKind::Quadratic => seconds > QUADRATIC,
                GuestKind::Cma | GuestKind::Flood | GuestKind::Regions | GuestKind::Niching => false,
            };
            if guest.readiness == Readiness::Asleep && wakes {
                guest.readiness = Readiness::Open;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use core::ops::Range;

    use super::*;
    use crate::batch::{Batch, Outcome};
    use crate::engine::Origin;
    use crate::engine::portfolio::Omitted;
    use crate::engine::portfolio::pace::Pace;
    use crate::seed::SearchRng;
    use crate::space::{Region, Space};
    use crate::testing::BareContext;

    /// Only time is limited.
    struct PricedContext {
        bare: BareContext<f64>,
        price: Option<f64>,
    }

    impl Context<f64> for PricedContext {
        fn space(&self) -> &Space<f64> {
            self.bare.space()
        }
        fn threshold(&self) -> f64 {
            self.bare.threshold()
        }
        fn elapsed_share(&self) -> f64 {
            0.0
        }
        fn evaluations(&self) -> u64 {
            0
        }
        fn hits(&self) -> usize {
            0
        }
        fn is_deleted(&self, _: &[f64]) -> bool {
            false
        }
        fn is_timed(&self) -> bool {
            true
        }
        fn seconds_an_evaluation(&self) -> Option<f64> {
            self.price
        }
        fn neighbour_count(&self, _: &[f64]) -> usize {
            0
        }
        fn neighbours(&self, _: &[f64], _: Range<usize>, _: &mut dyn FnMut(usize, &[f64])) {}
        fn offers_neighbours(&self) -> bool {
            false
        }
        fn lower_bound(&self, _: &Region<f64>) -> Option<f64> {
            None
        }
        fn previous_hits(&self) -> usize {
            0
        }
        fn previous_hit(&self, _: usize, _: &mut [f64]) -> bool {
            false
        }
    }

    /// Engines that were told of 16 start points at each of these prices, one after another.
    fn told_at(prices: &[Option<f64>]) -> (Guests<f64>, PricedContext) {
        let mut context = PricedContext {
            bare: BareContext::new(Space::cube(2, -1.0, 1.0).unwrap()),
            price: None,
        };
        let mut guests = Guests::new(Omitted::Nothing);
        guests.begin(&context);
        let mut rng = SearchRng::new(1);
        for &price in prices {
            context.price = price;
            let mut batch = Batch::new(2);
            let mut outcomes = Vec::new();
            for _ in 0..16 {
                let x = [0, 1].map(|_| 2.0 * rng.uniform() - 1.0);
                batch.push(&x);
                outcomes.push(Outcome::Miss(1.0 + x[0] * x[0] + x[1] * x[1]));
            }
            let origin = (Origin::Start, None);
            guests.tell(&context, &batch, &outcomes, origin, &mut Pace::new(true));
        }
        (guests, context)
    }

    fn awake(guests: &Guests<f64>, kind: GuestKind) -> bool {
        let mut guests = guests.guests.iter();
        guests.any(|guest| guest.kind == kind && guest.readiness == Readiness::Open)
    }

    #[test]
    fn engines_wake_where_an_evaluation_is_dear_enough() {
        for (price, expected) in [(1e-6, [false; 2]), (5e-5, [false, true]), (5e-3, [true; 2])] {
            let (guests, _) = told_at(&[None, Some(price)]);
            let kinds = [GuestKind::Model, GuestKind::Quadratic];
            assert_eq!(kinds.map(|kind| awake(&guests, kind)), expected, "{price}");
            assert_eq!(guests.has_model(), expected[0]);
        }
    }

    /// A model that knows as many points as its first ones are has something to say.
    #[test]
    fn the_model_knows_what_came_before_it_woke() {
        let mut rng = SearchRng::new(2);
        for prices in [&[None, Some(5e-3)][..], &[Some(5e-3)]] {
            let (mut guests, context) = told_at(prices);
            assert!(
                guests.expectation(None, &context, &mut rng).is_some(),
                "{prices:?}"
            );
        }
    }
}

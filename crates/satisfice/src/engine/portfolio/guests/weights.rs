//! What an engine weighs in the draw of the next source.

use super::{Guest, GuestKind, MODELLED, Member};
use crate::engine::model::Yardstick;
use crate::engine::portfolio::credit::{Credits, Trial};
use crate::scalar::Real;

/// Weight of the model until it turns out to predict too little. From then on it has the bound of a source without a hit, even before any
/// source has found one: its proposals take a hundred times as long as those of others.
const MODEL_WEIGHT: f64 = 40.0;
/// Weight of the model after the search for a first hit, in which descents take part: of isolated hits it knows only what descents tell it.
const MODEL_WEIGHT_AFTER_DESCENT: f64 = 1.0;
/// Weight of descents by quadratic models, and of those by components.
const QUADRATIC_WEIGHT: f64 = 4.0;
const COMPONENTS_WEIGHT: f64 = 16.0;
/// Until they have a hit, they are expected to need at least so many evaluations for each corner of a simplex: where most evaluations of the
/// others hit, a multiple of that yield would be more than one hit an evaluation.
const SIMPLICES: f64 = 2.0;

/// What weights depend on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Situation {
    /// Whether descents take part in the search for a first hit.
    pub(super) descends_first: bool,
    /// Whether the problem tells the components of F.
    pub(super) components: bool,
    /// Whether F is a step function.
    pub(super) steps: bool,
    /// What the model has to predict better than.
    pub(super) yardstick: Yardstick,
}

impl<S: Real> Guest<S> {
    /// Its weight, unless it is not worth trying.
    pub(super) fn weight(&self, credits: &Credits, trial: Trial, situation: Situation) -> Option<f64> {
        let Situation {
            descends_first,
            components,
            steps,
            yardstick,
        } = situation;
        let (all, own) = (&credits.whole, &credits[self.place()]);
        let is_worth_trying = own.is_worth_trying(all, trial);
        match (self.kind, &self.engine) {
            (GuestKind::Cma, _) => is_worth_trying.then_some(2.0),
            (GuestKind::Quadratic, _) => {
                let weight = if components {
                    COMPONENTS_WEIGHT
                } else {
                    QUADRATIC_WEIGHT
                };
                let most = all.price() / (SIMPLICES * (self.share.dimension() + 1) as f64);
                (is_worth_trying || descends_first).then_some(weight.min(most))
            }
            (GuestKind::Flood, _) => is_worth_trying.then_some(1.0),
            (GuestKind::Regions, _) => is_worth_trying.then_some(0.3),
            (GuestKind::Model, Member::Model(model)) => match model.is_useful(yardstick) {
                None | Some(true) if all.evaluations() >= MODELLED => is_worth_trying.then_some(1.0),
                None | Some(true) if descends_first => Some(MODEL_WEIGHT_AFTER_DESCENT),
                Some(true) => Some(MODEL_WEIGHT),
                None => Some(if steps { 1.0 } else { MODEL_WEIGHT }),
                Some(false) => own.is_within(all, trial).then_some(1.0),
            },
            // Niching is not drawn by its yield.
            (GuestKind::Niching, _) | (GuestKind::Model, Member::Regions(_) | Member::Other(_)) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Sizes;
    use super::*;

    #[test]
    fn descents_without_a_hit_are_not_expected_to_hit_more_often_than_they_can() {
        let guest = Guest::<f64>::new(GuestKind::Quadratic, Sizes::default(), 3);
        let expected = |credits: &Credits, components| {
            let situation = Situation {
                descends_first: true,
                components,
                steps: false,
                yardstick: Yardstick::Latest,
            };
            let weight = guest.weight(credits, Trial::alone(), situation);
            weight.unwrap() / credits.whole.price()
        };
        let (rare, mut frequent) = (Credits::default(), Credits::default());
        assert_eq!(expected(&rare, false), QUADRATIC_WEIGHT / rare.whole.price());
        for _ in 0..50 {
            frequent.whole.count(true, 1.0);
        }
        // Two evaluations for each of the four corners of a simplex.
        for components in [false, true] {
            let yields = expected(&frequent, components);
            assert!((yields - 0.125).abs() < 1e-12, "{yields}");
        }
    }
}

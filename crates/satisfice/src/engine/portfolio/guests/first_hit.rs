//! Who looks for the first hit beside a model of F.

use super::{GuestKind, Guests, MODELLED, Member};
use crate::context::Context;
use crate::engine::portfolio::credit::Credit;
use crate::engine::portfolio::progress::{Ground, Seeker};
use crate::engine::portfolio::source::{Source, Tag};
use crate::scalar::Real;
use crate::seed::SearchRng;

/// Share of the planned evaluations in which the model and descents look for the first hit, unless F is known to be no more than smooth:
/// then they go on until there is one.
const FIRST_SHARE: f64 = 0.5;
/// Evaluations of a smooth F that are the model's before descents take part in the search for the first hit: so many, or this share of the
/// planned ones if that is more.
const MODEL_FIRST: u64 = 50;
const MODEL_FIRST_SHARE: f64 = 0.25;
/// The model comes before descents if it takes a hit to be more probable than this, as far as its word can be trusted.
const CREDIBLE: f64 = 0.5;

/// What a model expects of its next proposal.
#[derive(Debug, Clone, Copy)]
pub(in crate::engine::portfolio) struct Expectation {
    /// The model's index.
    pub(in crate::engine::portfolio) index: usize,
    /// How probable a hit is, as far as its word can be trusted.
    pub(in crate::engine::portfolio) hit: f64,
}

/// Who looks for the first hit.
#[derive(Debug, Clone, Copy)]
pub(in crate::engine::portfolio) struct Seekers {
    pub(in crate::engine::portfolio) ground: Ground,
    /// Evaluations that are the model's, where F is smooth.
    alone: u64,
    pub(in crate::engine::portfolio) model: usize,
    /// Descents by quadratic models; the model, where there are none.
    pub(in crate::engine::portfolio) quadratic: usize,
}

impl<S: Real> Guests<S> {
    /// Whether a model of the components of F expects no hit of its latest proposals.
    pub(super) fn promises_little(&self) -> bool {
        self.guests.iter().any(|guest| match &guest.engine {
            Member::Model(model) => model.promises_little(),
            Member::Other(_) => false,
        })
    }

    /// Who takes part in the search for the first hit while a model is at work. `None` where nothing leads down, after the first hit, and
    /// after its share of the evaluations.
    pub(in crate::engine::portfolio) fn seekers(
        &self,
        all: &Credit,
        planned: Option<u64>,
    ) -> Option<Seekers> {
        let ground = match self.ground? {
            Ground::Components if self.promises_little() => Ground::Unpromising,
            ground => ground,
        };
        let share = if ground == Ground::Smooth {
            1.0
        } else {
            FIRST_SHARE
        };
        let most = share * planned.map_or(MODELLED, |planned| planned.min(MODELLED)) as f64;
        if !all.is_barren() || all.evaluations() as f64 >= most {
            return None;
        }
        let find = |kind| {
            let mut guests = self.guests.iter();
            guests.position(|guest| guest.kind == kind && guest.is_ready())
        };
        let model = find(GuestKind::Model)?;
        let quadratic = find(GuestKind::Quadratic);
        // Without descents by quadratic models, or while all of them await answers, the model proposes.
        let takes_over = self.in_any_order
            || ground == Ground::Neighbours
            || GuestKind::Quadratic.is_left_out(self.without);
        Some(Seekers {
            ground,
            alone: alone(most),
            model,
            quadratic: quadratic.or(takes_over.then_some(model))?,
        })
    }

    /// What the model expects of its next proposal, where that decides whether it is next: in the search for the first hit, and after it
    /// on a smooth F or where nothing leads down.
    pub(in crate::engine::portfolio) fn expectation(
        &mut self,
        seekers: Option<Seekers>,
        context: &dyn Context<S>,
        rng: &mut SearchRng,
    ) -> Option<Expectation> {
        if seekers.is_none() && !matches!(self.ground, Some(Ground::Smooth) | None) {
            return None;
        }
        let mut guests = self.guests.iter();
        let index = guests.position(|guest| guest.kind == GuestKind::Model && guest.is_ready())?;
        let Member::Model(model) = &mut self.guests[index].engine else {
            return None;
        };
        if seekers.is_some() && model.believed(1.0) <= CREDIBLE {
            return None;
        }
        let hit = model.expectation(context, rng)?;
        Some(Expectation { index, hit })
    }

    /// What a source is among those that look for the first hit.
    pub(in crate::engine::portfolio) fn seeker(&self, (source, index): Tag) -> Option<Seeker> {
        match source {
            Source::Descent => Some(Seeker::Direct),
            Source::Guest => match self.guests[index].kind {
                GuestKind::Model => Some(Seeker::Model),
                GuestKind::Quadratic => Some(Seeker::Quadratic),
                GuestKind::Cma | GuestKind::Niching | GuestKind::Flood | GuestKind::Regions => None,
            },
            _ => None,
        }
    }
}

impl Seekers {
    /// The one whose turn it is for a reason of its own, after so many evaluations.
    pub(in crate::engine::portfolio) fn first(
        self,
        evaluations: u64,
        expectation: Option<Expectation>,
    ) -> Option<Seeker> {
        let is_early = self.ground == Ground::Smooth && evaluations < self.alone;
        let is_sure = expectation.is_some_and(|expectation| expectation.hit > CREDIBLE);
        (is_early || is_sure).then_some(Seeker::Model)
    }
}

/// Evaluations that are the model's of so many in which a first hit is looked for.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a thousand at most"
)]
fn alone(most: f64) -> u64 {
    MODEL_FIRST.max((MODEL_FIRST_SHARE * most) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_model_comes_first_where_it_expects_a_hit_and_early_on_a_smooth_function() {
        let first = |ground, evaluations, hit: Option<f64>| {
            let seekers = Seekers {
                ground,
                alone: 50,
                model: 3,
                quadratic: 4,
            };
            seekers.first(evaluations, hit.map(|hit| Expectation { index: 3, hit }))
        };
        assert_eq!(first(Ground::Smooth, 49, None), Some(Seeker::Model));
        assert_eq!(first(Ground::Smooth, 50, None), None);
        assert_eq!(first(Ground::Neighbours, 10, Some(0.5)), None);
        for ground in [
            Ground::Smooth,
            Ground::Components,
            Ground::Unpromising,
            Ground::Neighbours,
        ] {
            assert_eq!(first(ground, 60, Some(0.51)), Some(Seeker::Model));
            assert_eq!(first(ground, 60, Some(0.1)), None);
        }
    }

    #[test]
    fn the_model_has_fifty_evaluations_or_a_quarter_alone() {
        assert_eq!([20.0, 200.0, 400.0, 1000.0].map(alone), [50, 50, 100, 250]);
    }
}

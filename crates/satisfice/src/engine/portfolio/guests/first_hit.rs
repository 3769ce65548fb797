//! Who looks for the first hit beside a model of F.

use super::{GuestKind, Guests, MODELLED, Member};
use crate::context::Context;
use crate::engine::portfolio::Omitted;
use crate::engine::portfolio::credit::Credit;
use crate::scalar::Real;
use crate::seed::SearchRng;

/// Evaluations of a smooth F that are the model's before descents take part in the search for the first hit: so many, or this share of the
/// planned ones if that is more.
const MODEL_FIRST: u64 = 50;
const MODEL_FIRST_SHARE: f64 = 0.25;
/// The model comes before descents if it takes a hit to be more probable than this, as far as its word can be trusted.
const CREDIBLE: f64 = 0.5;
/// Share of the choices of the one that leads the search, up to so many evaluations; the others have equal shares of the rest. Later, all
/// have equal shares: what has not led to a hit by then is not the way for sure.
const LEAD: f64 = 0.9;
const LED: u64 = 250;

/// What leads down to a first hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) enum Ground {
    /// F, which may be smooth along continuous axes.
    Smooth,
    /// Neighbours that the problem names, or exchanges in a permutation: descents go along them.
    Neighbours,
}

/// A source that looks for the first hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::engine::portfolio) enum Seeker {
    /// The model of F.
    Model,
    /// Descents by quadratic models.
    Quadratic,
    /// Descents without a model.
    Direct,
}

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
    leader: Seeker,
    /// Evaluations that are the model's, if it leads: none where the problem tells the components of F.
    alone: u64,
    model: usize,
    /// Descents by quadratic models; none where there are none, or all of them await answers.
    quadratic: Option<usize>,
    /// Whether there are descents without a model.
    direct: bool,
}

impl<S: Real> Guests<S> {
    /// Whether a model of the components of F expects no hit of its latest proposals.
    pub(super) fn promises_little(&self) -> bool {
        self.guests.iter().any(|guest| match &guest.engine {
            Member::Model(model) => model.promises_little(),
            Member::Regions(_) | Member::Other(_) => false,
        })
    }

    /// Who takes part in the search for the first hit while a model is at work. `None` where nothing leads down, after the first hit, and
    /// once the model leads no more.
    pub(in crate::engine::portfolio) fn seekers(
        &self,
        all: &Credit,
        planned: Option<u64>,
    ) -> Option<Seekers> {
        let ground = self.ground?;
        let leader = match ground {
            Ground::Smooth if self.components && self.promises_little() => Seeker::Quadratic,
            Ground::Smooth => Seeker::Model,
            Ground::Neighbours => Seeker::Direct,
        };
        let most = planned.map_or(MODELLED, |planned| planned.min(MODELLED));
        if !all.is_barren() || all.evaluations() >= most {
            return None;
        }
        let find = |kind| {
            let mut guests = self.guests.iter();
            guests.position(|guest| guest.kind == kind && guest.is_ready())
        };
        let (model, quadratic) = (find(GuestKind::Model)?, find(GuestKind::Quadratic));
        let direct = self.without != Omitted::Descents;
        Some(Seekers {
            leader,
            alone: if self.components { 0 } else { alone(most) },
            model,
            quadratic,
            direct,
        })
    }

    /// What the model expects of its next proposal, where that decides whether it is next: in the search for the first hit, and after it
    /// on a smooth F without components or where nothing leads down.
    pub(in crate::engine::portfolio) fn expectation(
        &mut self,
        seekers: Option<Seekers>,
        context: &dyn Context<S>,
        rng: &mut SearchRng,
    ) -> Option<Expectation> {
        let decides = match self.ground {
            Some(Ground::Smooth) => !self.components,
            Some(Ground::Neighbours) => false,
            None => true,
        };
        if seekers.is_none() && !decides {
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
}

impl Seekers {
    /// The index of the engine that looks; none for descents without a model.
    pub(in crate::engine::portfolio) fn guest(self, seeker: Seeker) -> Option<usize> {
        match seeker {
            Seeker::Model => Some(self.model),
            Seeker::Quadratic => self.quadratic,
            Seeker::Direct => None,
        }
    }

    fn has(self, seeker: Seeker) -> bool {
        match seeker {
            Seeker::Model => true,
            Seeker::Quadratic => self.quadratic.is_some(),
            Seeker::Direct => self.direct,
        }
    }

    /// Whose turn it is after so many evaluations.
    pub(in crate::engine::portfolio) fn draw(
        self,
        evaluations: u64,
        expectation: Option<Expectation>,
        rng: &mut SearchRng,
    ) -> Seeker {
        let is_early = self.leader == Seeker::Model && evaluations < self.alone;
        if is_early || expectation.is_some_and(|expectation| expectation.hit > CREDIBLE) {
            return Seeker::Model;
        }
        let leader = if self.has(self.leader) {
            self.leader
        } else {
            Seeker::Model
        };
        let leads = evaluations < LED;
        if leads && rng.uniform() < LEAD {
            return leader;
        }
        let others = || {
            let all = [Seeker::Model, Seeker::Quadratic, Seeker::Direct].into_iter();
            all.filter(|&seeker| self.has(seeker) && !(leads && seeker == leader))
        };
        others().nth(rng.below(others().count().max(1))).unwrap_or(leader)
    }
}

/// Evaluations that are the model's of so many in which a first hit is looked for.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a thousand at most"
)]
fn alone(most: u64) -> u64 {
    MODEL_FIRST.max((MODEL_FIRST_SHARE * most as f64) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How often each is drawn, of 3,000 times.
    fn drawn(leader: Seeker, evaluations: u64, hit: Option<f64>) -> [u32; 3] {
        drawn_of(leader, Some(4), evaluations, hit)
    }

    fn drawn_of(leader: Seeker, quadratic: Option<usize>, evaluations: u64, hit: Option<f64>) -> [u32; 3] {
        let seekers = Seekers {
            leader,
            alone: 50,
            model: 3,
            quadratic,
            direct: true,
        };
        let expectation = hit.map(|hit| Expectation { index: 3, hit });
        let (mut rng, mut counts) = (SearchRng::new(3), [0; 3]);
        for _ in 0..3000 {
            counts[seekers.draw(evaluations, expectation, &mut rng) as usize] += 1;
        }
        counts
    }

    #[test]
    fn the_model_comes_first_where_it_expects_a_hit_and_early_where_it_leads() {
        assert_eq!(drawn(Seeker::Model, 49, None), [3000, 0, 0]);
        for leader in [Seeker::Model, Seeker::Quadratic, Seeker::Direct] {
            assert_eq!(drawn(leader, 60, Some(0.51)), [3000, 0, 0]);
        }
    }

    #[test]
    fn the_leader_has_most_choices_and_the_others_share_the_rest() {
        for (leader, evaluations) in [(Seeker::Model, 50), (Seeker::Quadratic, 0), (Seeker::Direct, 0)] {
            let counts = drawn(leader, evaluations, Some(0.5));
            for (seeker, count) in counts.into_iter().enumerate() {
                let expected = if seeker == leader as usize { 2700 } else { 150 };
                assert!(count.abs_diff(expected) < 60, "{leader:?} {counts:?}");
            }
        }
    }

    #[test]
    fn later_all_have_equal_shares() {
        for leader in [Seeker::Model, Seeker::Quadratic, Seeker::Direct] {
            let counts = drawn(leader, LED, None);
            assert!(
                counts.iter().all(|count| count.abs_diff(1000) < 100),
                "{counts:?}"
            );
        }
        let [model, quadratic, direct] = drawn_of(Seeker::Direct, None, LED - 1, None);
        assert!(quadratic == 0 && direct.abs_diff(2700) < 60, "{model} {direct}");
        let [model, quadratic, direct] = drawn_of(Seeker::Direct, None, LED, None);
        assert!(quadratic == 0 && direct.abs_diff(1500) < 100, "{model} {direct}");
    }

    #[test]
    fn the_model_has_fifty_evaluations_or_a_quarter_alone() {
        assert_eq!([20, 200, 400, 1000].map(alone), [50, 50, 100, 250]);
    }
}

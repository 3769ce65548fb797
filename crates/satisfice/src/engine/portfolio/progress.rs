//! Which source looks for the first hit beside a model of F: the one that brings the search closer to it.

use super::credit::draw;
use super::levels::Levels;
use crate::batch::Outcome;
use crate::scalar::Real;
use crate::seed::SearchRng;

/// What a problem tells of F, for the search for a first hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) enum Ground {
    /// F may be smooth along continuous axes.
    Smooth,
    /// The same, and the model knows its components.
    Components,
    /// Components, of which the model expects no hit of its latest proposals.
    Unpromising,
    /// Neighbours, which descents go along.
    Neighbours,
}

impl Ground {
    /// What each source is expected to gain before it was tried, in so many evaluations; 0 for one that does not take part.
    fn expected(self) -> ([f64; 3], f64) {
        match self {
            Self::Smooth => ([16.0, 8.0, 2.0], 40.0),
            Self::Unpromising => ([2.0, 8.0, 2.0], 40.0),
            Self::Components => ([4.0, 1.0, 0.5], 20.0),
            Self::Neighbours => ([2.0, 0.0, 8.0], 20.0),
        }
    }
}

/// The most that one evaluation gains.
const MOST: f64 = 2.0;

/// A source that looks for the first hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Seeker {
    /// The model of F.
    Model,
    /// Descents by quadratic models.
    Quadratic,
    /// Descents without a model.
    Direct,
}

/// How much each source has lowered the least `F - delta` of the search, as the logarithm of the ratio.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(super) struct Progress {
    /// Values of F, where an axis is continuous.
    pub(super) levels: Levels,
    least: f64,
    gains: [f64; 3],
    evaluations: [f64; 3],
}

impl Default for Progress {
    fn default() -> Self {
        Self {
            levels: Levels::default(),
            least: f64::INFINITY,
            gains: [0.0; 3],
            evaluations: [0.0; 3],
        }
    }
}

impl Progress {
    /// Counts a candidate of a source, or of one that is none of these.
    pub(super) fn count<S: Real>(&mut self, seeker: Option<Seeker>, outcome: Outcome<S>, threshold: S) {
        let excess = match outcome {
            Outcome::Miss(fitness) => fitness.f64() - threshold.f64(),
            _ => f64::INFINITY,
        };
        if let Some(seeker) = seeker {
            self.evaluations[seeker as usize] += 1.0;
            if excess < self.least && self.least.is_finite() {
                self.gains[seeker as usize] += (self.least / excess).ln().min(MOST);
            }
        }
        self.least = self.least.min(excess);
    }

    /// Draws the next source, by Thompson sampling on what an evaluation of each gains.
    pub(super) fn choose(&self, ground: Ground, rng: &mut SearchRng) -> Seeker {
        let (expected, evaluations) = ground.expected();
        let mut best = (f64::NEG_INFINITY, Seeker::Model);
        for seeker in [Seeker::Model, Seeker::Quadratic, Seeker::Direct] {
            let i = seeker as usize;
            if expected[i] == 0.0 {
                continue;
            }
            // What a model has gained that expects nothing, it has gained by chance: F is steep, or few points were known.
            let is_chance = ground == Ground::Unpromising && seeker == Seeker::Model;
            let gains = if is_chance { 0.0 } else { self.gains[i] };
            let drawn = draw(rng, gains + expected[i], self.evaluations[i] + evaluations);
            if drawn > best.0 {
                best = (drawn, seeker);
            }
        }
        best.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shares(progress: &Progress, ground: Ground) -> [u32; 3] {
        let mut rng = SearchRng::new(3);
        let mut counts = [0; 3];
        for _ in 0..3000 {
            counts[progress.choose(ground, &mut rng) as usize] += 1;
        }
        counts
    }

    #[test]
    fn what_a_model_gained_that_expects_nothing_is_chance() {
        let mut progress = Progress::default();
        for i in 0..20 {
            progress.count(Some(Seeker::Model), Outcome::Miss(1.0 + 0.1_f64.powi(i)), 1.0);
        }
        let [model, quadratic, _] = shares(&progress, Ground::Components);
        assert!(model > 10 * quadratic, "{model} {quadratic}");
        let [model, quadratic, _] = shares(&progress, Ground::Unpromising);
        assert!(quadratic > 4 * model && model > 0, "{model} {quadratic}");
    }

    #[test]
    fn a_source_that_gains_comes_before_one_that_stalls() {
        let mut progress = Progress::default();
        let [model, quadratic, direct] = shares(&progress, Ground::Smooth);
        assert!(
            model > 3 * quadratic && quadratic > direct,
            "{model} {quadratic} {direct}"
        );
        for _ in 0..60 {
            progress.count(Some(Seeker::Model), Outcome::Miss(1e6), 1.0);
        }
        let [model, quadratic, direct] = shares(&progress, Ground::Smooth);
        assert!(
            quadratic > model && model > 0 && quadratic > 3 * direct,
            "{model} {quadratic} {direct}"
        );
        // 60 evaluations of quadratic descents gain nothing, 20 of the model halve the excess each.
        for _ in 0..60 {
            progress.count(Some(Seeker::Quadratic), Outcome::Miss(1e6), 1.0);
        }
        for i in 0..20 {
            progress.count(Some(Seeker::Model), Outcome::Miss(1.0 + 0.5_f64.powi(i)), 1.0);
        }
        let [model, quadratic, direct] = shares(&progress, Ground::Smooth);
        assert!(
            model > 10 * quadratic && model > 10 * direct,
            "{model} {quadratic} {direct}"
        );
    }

    #[test]
    fn descents_over_neighbours_come_before_the_model() {
        let [model, quadratic, direct] = shares(&Progress::default(), Ground::Neighbours);
        assert!(
            direct > 3 * model && model > 0 && quadratic == 0,
            "{model} {quadratic} {direct}"
        );
        let [model, quadratic, direct] = shares(&Progress::default(), Ground::Components);
        assert!(model > 2 * (quadratic + direct), "{model} {quadratic} {direct}");
    }

    #[test]
    fn a_gain_is_bounded_and_no_outcome_breaks_the_sum() {
        let mut progress = Progress::default();
        let outcomes = [
            Outcome::Miss(f64::MAX),
            Outcome::NonFinite,
            Outcome::Miss(5.0),
            Outcome::Deleted,
            Outcome::Miss(1.0),
            Outcome::Miss(1.0),
        ];
        for outcome in outcomes {
            progress.count(Some(Seeker::Direct), outcome, 1.0);
        }
        // The first point gains nothing, the next two as much as may be: F = delta is a miss.
        assert_eq!(progress.gains, [0.0, 0.0, 2.0 * MOST]);
        assert_eq!(progress.evaluations, [0.0, 0.0, 6.0]);
        progress.count(None, Outcome::Miss(1.0), 1.0);
        assert_eq!(progress.evaluations, [0.0, 0.0, 6.0]);
    }
}

//! Which source of candidates is next: Thompson sampling on what each has yielded lately.

use rand_distr::{Distribution, Gamma};

use crate::seed::SearchRng;

/// Evaluations after which a past hit counts for 1/e: yields change as a search goes on.
const MEMORY: f64 = 1000.0;
/// Hits that have to be remembered, of all arms together, before the past fades: where hits are rare, nothing else tells the
/// sources apart.
const EVIDENCE: f64 = 3.0;
/// Prior of an arm, in hits and evaluations: hopeful, so that every arm is tried.
const PRIOR_HITS: f64 = 0.25;
const PRIOR_EVALUATIONS: f64 = 20.0;

/// What one source has yielded lately, and in all.
#[derive(Debug, Clone, Copy, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Arm {
    hits: f64,
    evaluations: f64,
    pub(super) total_hits: u64,
    pub(super) total_evaluations: u64,
}

impl Arm {
    /// Counts one candidate.
    #[inline]
    pub(super) fn count(&mut self, hit: bool) {
        self.evaluations += 1.0;
        self.hits += f64::from(u8::from(hit));
        self.total_evaluations += 1;
        self.total_hits += u64::from(hit);
    }

    /// Lets the past of all arms fade by `evaluations` of all of them together.
    pub(super) fn fade(arms: &mut [Self], evaluations: usize) {
        if arms.iter().map(|arm| arm.hits).sum::<f64>() < EVIDENCE {
            return;
        }
        let factor = (-(evaluations as f64) / MEMORY).exp();
        for arm in arms {
            arm.hits *= factor;
            arm.evaluations *= factor;
        }
    }

    /// A draw from the posterior of this arm's yield.
    pub(super) fn draw(&self, rng: &mut SearchRng) -> f64 {
        draw(rng, self.hits + PRIOR_HITS, self.evaluations + PRIOR_EVALUATIONS)
    }
}

/// A draw from the posterior of a rate after `hits` in `evaluations`, priors included: Gamma(hits, 1/evaluations), the
/// conjugate of rare hits. Always choosing the arm with the largest draw has logarithmic regret (Agrawal, Goyal 2012,
/// arXiv 1111.1797); fading for rates that drift is Raj, Kalyani 2017 (arXiv 1707.09727).
pub(in crate::engine) fn draw(rng: &mut SearchRng, hits: f64, evaluations: f64) -> f64 {
    Gamma::new(hits, 1.0 / evaluations).map_or(0.0, |gamma| gamma.sample(rng))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_better_arm_is_drawn_more_and_the_worse_one_not_forgotten() {
        let mut rng = SearchRng::new(1);
        let (mut good, mut bad) = (Arm::default(), Arm::default());
        let mut pulls = [0; 2];
        for _ in 0..20_000 {
            let choose_good = good.draw(&mut rng) > bad.draw(&mut rng);
            let (arm, rate) = if choose_good {
                (&mut good, 0.05)
            } else {
                (&mut bad, 0.005)
            };
            arm.count(rng.uniform() < rate);
            let mut arms = [good, bad];
            Arm::fade(&mut arms, 1);
            [good, bad] = arms;
            pulls[usize::from(choose_good)] += 1;
        }
        assert!(pulls[1] > 4 * pulls[0] && pulls[0] > 100, "{pulls:?}");
    }

    /// The posterior of hits h and evaluations n with a prior of (1/4, 20) is Gamma(h + 1/4, n + 20): mean (h + 1/4) / (n + 20),
    /// variance (h + 1/4) / (n + 20)^2.
    #[test]
    fn an_arm_is_drawn_from_its_posterior() {
        let mut arm = Arm::default();
        for i in 0..80 {
            arm.count(i % 10 == 0);
        }
        let mut rng = SearchRng::new(2);
        let draws: Vec<f64> = (0..40_000).map(|_| arm.draw(&mut rng)).collect();
        let mean = draws.iter().sum::<f64>() / 40_000.0;
        let variance = draws.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 40_000.0;
        approx::assert_relative_eq!(mean, 8.25 / 100.0, max_relative = 0.01);
        approx::assert_relative_eq!(variance, 8.25 / 10_000.0, max_relative = 0.05);
    }

    #[test]
    fn the_past_fades_by_1_over_e_in_the_memory_of_a_thousand() {
        let mut arms = [Arm::default()];
        for _ in 0..10 {
            arms[0].count(true);
        }
        Arm::fade(&mut arms, 1000);
        approx::assert_relative_eq!(arms[0].hits, 10.0 / core::f64::consts::E, max_relative = 1e-14);
        assert_eq!(arms[0].total_hits, 10);
    }
}

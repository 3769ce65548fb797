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
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Arm {
    hits: f64,
    evaluations: f64,
    pub(super) total_hits: u64,
    pub(super) total_evaluations: u64,
}

crate::saved_struct!(Arm {
    hits,
    evaluations,
    total_hits,
    total_evaluations
});

impl Arm {
    /// Books one candidate.
    #[inline]
    pub(super) fn book(&mut self, hit: bool) {
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
pub(super) fn draw(rng: &mut SearchRng, hits: f64, evaluations: f64) -> f64 {
    Gamma::new(hits, 1.0 / evaluations).map_or(0.0, |gamma| gamma.sample(rng))
}

/// The `i`-th term, from 1, of the universal restart sequence 1, 1, 2, 1, 1, 2, 4, …: within a logarithm of the best fixed
/// limit, whatever that is (Luby, Sinclair, Zuckerman 1993, doi 10.1016/0020-0190(93)90029-9).
pub(super) fn luby(i: u64) -> u64 {
    let mut i = i.max(1);
    loop {
        let bits = u64::BITS - i.leading_zeros();
        if i == (1 << bits) - 1 {
            return 1 << (bits - 1);
        }
        i -= (1 << (bits - 1)) - 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_restart_sequence() {
        let terms: Vec<_> = (1..=15).map(luby).collect();
        assert_eq!(terms, [1, 1, 2, 1, 1, 2, 4, 1, 1, 2, 1, 1, 2, 4, 8]);
    }

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
            arm.book(rng.uniform() < rate);
            let mut arms = [good, bad];
            Arm::fade(&mut arms, 1);
            [good, bad] = arms;
            pulls[usize::from(choose_good)] += 1;
        }
        assert!(pulls[1] > 4 * pulls[0] && pulls[0] > 100, "{pulls:?}");
    }
}

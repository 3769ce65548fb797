//! Medians with bootstrap intervals, and comparisons seed by seed.

use satisfice::SearchRng;
use serde::{Deserialize, Serialize};
use statrs::distribution::{Binomial, DiscreteCDF};

/// Resamples of a bootstrap.
const RESAMPLES: usize = 1000;
/// The seed of all bootstraps: the same rows give the same report.
const SEED: u64 = 0x5eed;

/// A median and the 95 % percentile-bootstrap interval of it; infinite if more than half of the runs never got there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The median.
    pub median: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Estimate {
    /// Of some numbers, infinite ones for runs that never got there; `None` without numbers.
    ///
    /// Percentile bootstrap of the median: Efron, Tibshirani 1993, An Introduction to the Bootstrap, chapter 13. With
    /// fewer than six numbers the interval is about the range and covers less than 95 %.
    #[must_use]
    pub fn of(numbers: &[f64]) -> Option<Self> {
        let mut sorted = numbers.to_vec();
        sorted.sort_by(f64::total_cmp);
        let middle = median(&sorted)?;
        if sorted.first() == sorted.last() {
            return Some(Self {
                median: middle,
                low: middle,
                high: middle,
            });
        }
        let mut rng = SearchRng::new(SEED);
        let mut resample = vec![0.0; sorted.len()];
        let mut medians: Vec<f64> = (0..RESAMPLES)
            .filter_map(|_| {
                resample
                    .iter_mut()
                    .for_each(|x| *x = sorted[rng.below(sorted.len())]);
                resample.sort_by(f64::total_cmp);
                median(&resample)
            })
            .collect();
        medians.sort_by(f64::total_cmp);
        Some(Self {
            median: middle,
            low: medians[RESAMPLES * 25 / 1000],
            high: medians[RESAMPLES * 975 / 1000 - 1],
        })
    }
}

/// The median of sorted numbers.
#[must_use]
pub fn median(sorted: &[f64]) -> Option<f64> {
    let (low, high) = (
        sorted.get(sorted.len().checked_sub(1)? / 2)?,
        sorted.get(sorted.len() / 2)?,
    );
    // Half of infinity minus infinity is not a number.
    Some(if low == high {
        *low
    } else {
        low + (high - low) / 2.0
    })
}

/// Two engines on the same seeds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Paired {
    /// Seeds on which the first found more.
    pub wins: u64,
    /// Seeds on which the second found more.
    pub losses: u64,
    /// Seeds on which they found as much.
    pub ties: u64,
    /// Two-sided p value of the exact sign test, ties left out; 1 without a difference.
    pub p: f64,
    /// The same after Holm's correction for the comparisons of one table.
    pub p_holm: f64,
}

impl Paired {
    /// Sign test on pairs `(first, second)`: under the null hypothesis wins are binomial with p = 1/2.
    ///
    /// Conover 1999, Practical Nonparametric Statistics, section 3.4.
    #[must_use]
    pub fn of(pairs: &[(f64, f64)]) -> Self {
        let count = |is: fn(&(f64, f64)) -> bool| pairs.iter().filter(|pair| is(pair)).count() as u64;
        let (wins, losses) = (count(|(a, b)| a > b), count(|(a, b)| a < b));
        let p = match Binomial::new(0.5, wins + losses) {
            Ok(binomial) if wins + losses > 0 => (2.0 * binomial.cdf(wins.min(losses))).min(1.0),
            _ => 1.0,
        };
        Self {
            wins,
            losses,
            ties: pairs.len() as u64 - wins - losses,
            p,
            p_holm: p,
        }
    }

    /// Holm 1979: the k-th smallest of m p values times m - k + 1, made monotone.
    pub fn correct(all: &mut [&mut Self]) {
        all.sort_by(|a, b| a.p.total_cmp(&b.p));
        let (mut least, mut left) = (0.0_f64, all.len() as f64);
        for paired in all {
            least = least.max((paired.p * left).min(1.0));
            paired.p_holm = least;
            left -= 1.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[1.0]), Some(1.0));
        assert_eq!(median(&[1.0, 2.0]), Some(1.5));
        assert_eq!(median(&[1.0, f64::INFINITY]), Some(f64::INFINITY));
        assert_eq!(median(&[f64::INFINITY; 4]), Some(f64::INFINITY));
    }

    #[test]
    fn an_interval_surrounds_its_median_and_covers_the_truth() {
        // 200 samples of 16 uniform numbers with median 0.5: binomially many intervals cover it; 170 is five standard
        // deviations below 190.
        let mut rng = SearchRng::new(9);
        let covered = (0..200)
            .filter(|_| {
                let sample: Vec<f64> = (0..16).map(|_| rng.uniform()).collect();
                let Estimate { median, low, high } = Estimate::of(&sample).unwrap();
                assert!(low <= median && median <= high);
                (low..=high).contains(&0.5)
            })
            .count();
        assert!(covered >= 170, "{covered}");
        assert_eq!(
            Estimate::of(&[3.0; 5]).unwrap(),
            Estimate {
                median: 3.0,
                low: 3.0,
                high: 3.0
            }
        );
    }

    #[test]
    fn the_sign_test_is_the_table_s() {
        let test = |wins: usize, losses: usize| {
            let pairs: Vec<_> = std::iter::repeat_n((1.0, 0.0), wins)
                .chain(std::iter::repeat_n((0.0, 1.0), losses))
                .chain([(2.0, 2.0)])
                .collect();
            Paired::of(&pairs)
        };
        // 2 (1 + 8) / 2^8 and 2 / 2^16, by hand.
        approx::assert_abs_diff_eq!(test(7, 1).p, 18.0 / 256.0, epsilon = 1e-12);
        approx::assert_abs_diff_eq!(test(0, 16).p, 2.0 / 65536.0, epsilon = 1e-12);
        assert_eq!((test(4, 4).p, test(0, 0).p, test(3, 2).ties), (1.0, 1.0, 1));
        let mut all = [test(0, 16), test(7, 1), test(4, 4)];
        let [a, b, c] = &mut all;
        Paired::correct(&mut [a, b, c]);
        approx::assert_abs_diff_eq!(all[0].p_holm, 6.0 / 65536.0, epsilon = 1e-12);
        approx::assert_abs_diff_eq!(all[1].p_holm, 36.0 / 256.0, epsilon = 1e-12);
    }
}

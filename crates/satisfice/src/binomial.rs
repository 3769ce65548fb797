//! Exact limits of a binomial share: Clopper and Pearson's interval.
//!
//! Written here because the kept crates fail where a search gets to: statrs 0.19.1 never returns for 1 of 10^9 and its beta
//! distribution is off by 57 % at parameters of 10^7.

/// The two-sided exact interval of a share p after `hits` successes in `trials` independent trials, each end missing p with
/// probability at most (1 - `confidence`) / 2:
///
/// ```text
/// lower: P(X >= hits | p) = (1 - confidence) / 2      upper: P(X <= hits | p) = (1 - confidence) / 2
/// ```
///
/// `(0, 1)` without a trial. Cost: about 60 sums of O(sqrt(trials)) terms.
///
/// Clopper, Pearson 1934, doi 10.1093/biomet/26.4.404.
pub(crate) fn clopper_pearson(hits: u64, trials: u64, confidence: f64) -> (f64, f64) {
    let miss = (1.0 - confidence) / 2.0;
    let hits = hits.min(trials);
    (lower_limit(hits, trials, miss), upper_limit(hits, trials, miss))
}

/// The p with P(X >= k | p) = `miss`.
fn lower_limit(k: u64, n: u64, miss: f64) -> f64 {
    if k == 0 {
        return 0.0;
    }
    if k == n {
        return (miss.ln() / n as f64).exp();
    }
    // At p = k / n the tail is at least 1/2; from there down it falls.
    let (mut low, mut high) = (0.0, k as f64 / n as f64);
    while high - low > 1e-14 * high {
        let middle = 0.5 * (low + high);
        if upper_tail(k, n, middle) > miss {
            high = middle;
        } else {
            low = middle;
        }
    }
    low
}

/// The p with P(X <= k | p) = `miss`.
fn upper_limit(k: u64, n: u64, miss: f64) -> f64 {
    if k == n {
        return 1.0;
    }
    if k == 0 {
        return -f64::exp_m1(miss.ln() / n as f64);
    }
    let (mut low, mut high) = (k as f64 / n as f64, 1.0);
    while high - low > 1e-14 * high {
        let middle = 0.5 * (low + high);
        if lower_tail(k, n, middle) > miss {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// P(X >= k), p at most k / n, summed from its largest term up.
fn upper_tail(k: u64, n: u64, p: f64) -> f64 {
    let odds = p / (1.0 - p);
    let (mut term, mut sum, mut j, n_real) = (1.0, 1.0, k as f64, n as f64);
    while term > 1e-17 * sum && j < n_real {
        term *= (n_real - j) / (j + 1.0) * odds;
        sum += term;
        j += 1.0;
    }
    sum * ln_mass(k, n, p).exp()
}

/// P(X <= k), p at least k / n, summed from its largest term down.
fn lower_tail(k: u64, n: u64, p: f64) -> f64 {
    let odds = (1.0 - p) / p;
    let (mut term, mut sum, mut j, n_real) = (1.0, 1.0, k as f64, n as f64);
    while term > 1e-17 * sum && j > 0.0 {
        term *= j / (n_real - j + 1.0) * odds;
        sum += term;
        j -= 1.0;
    }
    sum * ln_mass(k, n, p).exp()
}

/// ln P(X = k) by the saddle point, without loss at large n. 0 < k < n, 0 < p < 1.
///
/// Loader 2000, "Fast and accurate computation of binomial probabilities", the method of R's `dbinom`.
fn ln_mass(k: u64, n: u64, p: f64) -> f64 {
    let (x, y, m) = (k as f64, (n - k) as f64, n as f64);
    stirling_error(n)
        - stirling_error(k)
        - stirling_error(n - k)
        - deviance(x, m * p)
        - deviance(y, m * (1.0 - p))
        + 0.5 * (m / (core::f64::consts::TAU * x * y)).ln()
}

/// ln n! - ln(sqrt(2 pi n) (n / e)^n), n >= 1.
fn stirling_error(n: u64) -> f64 {
    let x = n as f64;
    if n <= 15 {
        let factorial: u64 = (1..=n).product();
        return (factorial as f64).ln() - 0.5 * (core::f64::consts::TAU * x).ln() - x * x.ln() + x;
    }
    let square = x * x;
    (1.0 / 12.0
        - (1.0 / 360.0 - (1.0 / 1260.0 - (1.0 / 1680.0 - 1.0 / (1188.0 * square)) / square) / square)
            / square)
        / x
}

/// x ln(x / mean) + mean - x, without cancellation where x is near the mean.
fn deviance(x: f64, mean: f64) -> f64 {
    let difference = x - mean;
    if difference.abs() >= 0.1 * (x + mean) {
        return x * (x / mean).ln() + mean - x;
    }
    // ln((1 + v) / (1 - v)) = 2 (v + v^3 / 3 + v^5 / 5 + ...)
    let v = difference / (x + mean);
    let mut sum = difference * v;
    let mut power = 2.0 * x * v;
    for j in 1..1000 {
        power *= v * v;
        let next = sum + power / f64::from(2 * j + 1);
        if next == sum {
            break;
        }
        sum = next;
    }
    sum
}

#[cfg(test)]
mod tests {
    use num_bigint::BigUint;

    use super::*;

    /// P(X <= k) as an exact fraction of 2^(64 n) for p = `bits` / 2^64, compared with 1/20: the referee.
    fn tail_exceeds(k: u64, n: u64, bits: u64) -> bool {
        let one = BigUint::from(1_u8);
        let p = BigUint::from(bits);
        let q = (&one << 64_u32) - &p;
        let mut choose = one.clone();
        let mut sum = BigUint::ZERO;
        for j in 0..=k {
            let exponent = |e: u64| u32::try_from(e).unwrap();
            sum += &choose * p.pow(exponent(j)) * q.pow(exponent(n - j));
            choose = choose * (n - j) / (j + 1);
        }
        sum * 20_u32 > one << (64 * n)
    }

    #[test]
    fn limits_agree_with_exact_integers() {
        for n in [1, 2, 3, 7, 30, 97] {
            for k in (0..n).step_by(1 + n as usize / 12) {
                let limit = clopper_pearson(k, n, 0.9).1;
                let at = |p: f64| (p * 2.0_f64.powi(64)) as u64;
                assert!(
                    tail_exceeds(k, n, at(limit * (1.0 - 1e-12))),
                    "{k} of {n}: {limit}"
                );
                assert!(
                    !tail_exceeds(k, n, at(limit * (1.0 + 1e-12))),
                    "{k} of {n}: {limit}"
                );
                let mirrored = clopper_pearson(n - k, n, 0.9).0;
                approx::assert_relative_eq!(mirrored + limit, 1.0, max_relative = 1e-13);
            }
        }
    }

    /// From mpmath 1.3.0 with 40 digits: the roots of betainc(k, n - k + 1, 0, p, regularized = True) = 0.05 and of
    /// betainc(k + 1, n - k, ...) = 0.95; where its series is too slow, of the sum of the tail's terms.
    #[test]
    fn limits_of_many_trials_agree_with_mpmath() {
        for (k, n, lower, upper) in [
            (1, 3000, 1.709_761_862_99e-5, 1.580_301_827_459e-3),
            (5, 100_000, 1.970_169_564_005e-5, 1.051_274_511_724e-4),
            (5000, 100_000, 4.887_101_837_266e-2, 5.114_832_194_701e-2),
            (500_000, 1_000_000, 0.499_177_073_949_5, 0.500_822_926_050_5),
            (3_000_000, 10_000_000, 0.299_761_630_835_6, 0.300_238_454_668_2),
            (1, 1_000_000_000, 5.129_329_438_624e-11, 4.743_864_509_51e-9),
            (100, 1_000_000_000, 8.413_927_784_35e-8, 1.180_792_717_147e-7),
        ] {
            let (low, high) = clopper_pearson(k, n, 0.9);
            approx::assert_relative_eq!(low, lower, max_relative = 1e-10);
            approx::assert_relative_eq!(high, upper, max_relative = 1e-10);
        }
    }

    #[test]
    fn the_ends_are_closed_forms() {
        assert_eq!(clopper_pearson(0, 0, 0.9), (0.0, 1.0));
        let (low, high) = clopper_pearson(0, 3000, 0.9);
        assert_eq!(low, 0.0);
        approx::assert_relative_eq!(high, 1.0 - 0.05_f64.powf(1.0 / 3000.0), max_relative = 1e-12);
        assert_eq!(clopper_pearson(9, 3, 0.9).1, 1.0);
        // P(X >= 3) = p^3
        approx::assert_relative_eq!(
            clopper_pearson(3, 3, 0.9).0,
            0.05_f64.cbrt(),
            max_relative = 1e-14
        );
    }
}

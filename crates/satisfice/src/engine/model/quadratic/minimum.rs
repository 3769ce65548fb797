//! The minimum of a quadratic in a ball.

/// Writes the minimum of `slopes * z + bends * z^2 / 2` in the unit ball; returns by how much it is below 0, and whether it is inside.
pub(super) fn minimum(slopes: &[f64], bends: &[f64], z: &mut [f64]) -> (f64, bool) {
    let largest = bends.iter().fold(0.0_f64, |most, bend| most.max(bend.abs()));
    let least = bends.iter().copied().fold(f64::INFINITY, f64::min);
    let floor = (1e-12 * largest).max(f64::MIN_POSITIVE);
    let at = |damping: f64| {
        let axes = slopes.iter().zip(bends);
        axes.map(move |(slope, bend)| -slope / (bend + damping).max(floor))
    };
    let is_long = |damping: f64| at(damping).map(|z| z * z).sum::<f64>() > 1.0;
    let is_inside = least > 1e-9 * largest && !is_long(0.0);
    let mut damping = 0.0;
    if !is_inside {
        // Bisection for the damping that makes it as long as the radius (Moré, Sorensen 1983).
        let mut low = (-least).max(0.0);
        damping = low + dot(slopes, slopes).sqrt() + 1e-9 * largest + f64::MIN_POSITIVE;
        for _ in 0..40 {
            let middle = f64::midpoint(low, damping);
            if is_long(middle) {
                low = middle;
            } else {
                damping = middle;
            }
        }
    }
    for (z, minimum) in z.iter_mut().zip(at(damping)) {
        *z = minimum;
    }
    let axes = slopes.iter().zip(bends).zip(z.iter());
    let falls = axes.map(|((slope, bend), z)| -z * (slope + 0.5 * bend * z)).sum();
    (falls, is_inside)
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SearchRng;

    /// No random point of the ball is lower.
    #[test]
    fn the_minimum_in_the_ball_is_the_lowest() {
        let mut rng = SearchRng::new(2);
        for case in 0..200 {
            let n = 1 + case % 5;
            let slopes: Vec<f64> = (0..n).map(|_| rng.normal()).collect();
            let bends: Vec<f64> = (0..n)
                .map(|_| 3.0 * rng.normal() + f64::from(case as u32 % 4))
                .collect();
            let mut z = vec![0.0; n];
            let (falls, is_inside) = minimum(&slopes, &bends, &mut z);
            let value = |z: &[f64]| -> f64 {
                (0..n)
                    .map(|i| slopes[i] * z[i] + 0.5 * bends[i] * z[i] * z[i])
                    .sum()
            };
            approx::assert_abs_diff_eq!(value(&z), -falls, epsilon = 1e-9);
            assert!(dot(&z, &z) <= 1.0 + 1e-9);
            assert_eq!(is_inside, dot(&z, &z) < 1.0 - 1e-6, "{slopes:?} {bends:?}");
            for _ in 0..100 {
                let mut other: Vec<f64> = (0..n).map(|_| rng.normal()).collect();
                let length = dot(&other, &other).sqrt() / rng.uniform();
                other.iter_mut().for_each(|x| *x /= length);
                assert!(value(&other) >= -falls - 1e-9, "{slopes:?} {bends:?}");
            }
        }
    }
}

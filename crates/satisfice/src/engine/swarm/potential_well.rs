//! The move of quantum-behaved particle swarms, Eq. 2 of the paper: a draw from a delta potential well.

use crate::scalar::Real;
use crate::seed::SearchRng;

/// Largest alpha at which a particle stays bounded: e^gamma, gamma Euler's constant (Sun et al. 2012,
/// doi 10.1162/EVCO_a_00049).
pub const ALPHA_BOUNDED: f64 = 1.781_072_417_990_198;

/// The next coordinate of a particle on one axis,
///
/// ```text
/// p  = phi P + (1 - phi) G,           phi ~ U(0, 1)
/// X := p ± alpha |m - X| ln(1/u),     u ~ U(0, 1], fair sign
/// ```
///
/// with P the particle's `best`, G the `attractor` and m the `mean_best` of the swarm. ln(1/u) is drawn as Exp(1), which is
/// never infinite, so a collapsed swarm (m = X) gives no NaN. Two draws of 64 bits.
///
/// Sun, Feng, Xu 2004, doi 10.1109/CEC.2004.1330875.
#[inline(always)]
#[expect(
    clippy::inline_always,
    reason = "a call per axis would cost a tenth of the whole"
)]
pub(crate) fn draw<S: Real>(rng: &mut SearchRng, alpha: S, x: S, best: S, attractor: S, mean_best: S) -> S {
    let (phi, negative) = rng.uniform_and_sign();
    let centre = attractor + S::of(phi) * (best - attractor);
    let spread = alpha * (mean_best - x).abs() * S::of(rng.exponential());
    if negative {
        centre - spread
    } else {
        centre + spread
    }
}

/// Coordinates summed between two questions whether to stop: some microseconds.
const SUMMED_AT_ONCE: usize = 1 << 14;

/// Writes the mean of all rows of `bests`, each of the length of `mean`. Of many coordinates that takes milliseconds, so that it is asked
/// on the way whether to stop. Returns whether it came to the end.
pub(crate) fn mean_best<S: Real>(bests: &[S], mean: &mut [S], stops: impl Fn() -> bool) -> bool {
    let dimension = mean.len();
    // Multiplied before it is summed: a sum of bests near the largest number would overflow.
    let weight = S::of(dimension as f64) / S::of(bests.len() as f64);
    mean.fill(S::zero());
    let rows = (SUMMED_AT_ONCE / dimension).max(1);
    for (place, some) in bests.chunks(rows * dimension).enumerate() {
        if place > 0 && stops() {
            return false;
        }
        for best in some.chunks_exact(dimension) {
            for (m, &p) in mean.iter_mut().zip(best) {
                *m = *m + p * weight;
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean of ln |X'/X| of a particle whose best, attractor and mean best are all 0: in theory ln alpha - gamma, with a
    /// standard deviation of pi / sqrt(6) a step.
    fn mean_log_drift(alpha: f64) -> f64 {
        let mut rng = SearchRng::new(42);
        let steps = 1_000_000;
        let mut sum = 0.0;
        for _ in 0..steps {
            // Put back to 1 after each step: the recurrence is linear in X, and unbounded it leaves the floats.
            sum += draw(&mut rng, alpha, 1.0_f64, 0.0, 0.0, 0.0).abs().ln();
        }
        sum / f64::from(steps)
    }

    #[test]
    fn a_particle_stays_bounded_below_e_to_the_gamma() {
        const GAMMA: f64 = 0.577_215_664_901_532_9;
        approx::assert_relative_eq!(GAMMA.exp(), ALPHA_BOUNDED, max_relative = 1e-15);
        for (alpha, known) in [(1.0, -0.578), (1.75, -0.018), (1.80, 0.011)] {
            let drift = mean_log_drift(alpha);
            assert_eq!(drift > 0.0, alpha > ALPHA_BOUNDED, "{drift} at {alpha}");
            // Five standard deviations of the mean.
            approx::assert_abs_diff_eq!(drift, alpha.ln() - GAMMA, epsilon = 0.0064);
            approx::assert_abs_diff_eq!(drift, known, epsilon = 0.0064);
        }
    }

    #[test]
    fn a_collapsed_swarm_gives_no_nan() {
        let mut rng = SearchRng::new(1);
        let mut x = 0.5_f32;
        for _ in 0..80_000 {
            x = draw(&mut rng, 1e9, x, 0.5, 0.5, 0.5);
            approx::assert_relative_eq!(x, 0.5);
        }
    }

    #[test]
    fn the_mean_of_bests_near_the_largest_number_does_not_overflow() {
        let mut mean = [0.0];
        assert!(mean_best(&[f64::MAX; 30], &mut mean, || false));
        approx::assert_relative_eq!(mean[0], f64::MAX, max_relative = 1e-14);
        let mut mean = [0.0, 0.0];
        assert!(mean_best(&[1.0, 10.0, 2.0, 20.0, 6.0, 60.0], &mut mean, || true));
        approx::assert_relative_eq!(mean[..], [3.0, 30.0][..], max_relative = 1e-15);
    }

    #[test]
    fn the_mean_of_many_coordinates_ends_when_it_is_told_to() {
        let asked = core::cell::Cell::new(0);
        let stops = || asked.replace(asked.get() + 1) == 2;
        let (bests, mut mean) = (vec![1.0; 100 * SUMMED_AT_ONCE], vec![0.0; SUMMED_AT_ONCE]);
        assert!(!mean_best(&bests, &mut mean, stops));
        assert_eq!(asked.get(), 3);
        approx::assert_relative_eq!(mean[0], 0.03, max_relative = 1e-14); // three rows of a hundred
    }

    /// Eq. 2 with the same draws: phi P + (1 - phi) G ± alpha |m - X| ln(1/u).
    #[test]
    fn a_draw_is_the_published_equation() {
        let (x, best, attractor, mean, alpha) = (0.3, 2.0, -1.0, 1.7, 0.75);
        let (mut rng, mut twin) = (SearchRng::new(7), SearchRng::new(7));
        let mut signs = [0; 2];
        for _ in 0..200 {
            let drawn = draw(&mut rng, alpha, x, best, attractor, mean);
            let (phi, negative) = twin.uniform_and_sign();
            let logarithm: f64 = twin.exponential(); // ln(1/u) for u ~ U(0, 1]
            let sign = if negative { -1.0 } else { 1.0 };
            let expected = phi * best + (1.0 - phi) * attractor + sign * alpha * 1.4 * logarithm;
            approx::assert_relative_eq!(drawn, expected, max_relative = 1e-12, epsilon = 1e-12);
            signs[usize::from(negative)] += 1;
        }
        assert!(signs[0] > 60 && signs[1] > 60, "{signs:?}");
    }
}

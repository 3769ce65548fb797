//! The move of quantum-behaved particle swarms, Eq. 2 of the paper: a draw from a delta potential well.

use crate::scalar::Real;
use crate::seed::SearchRng;

/// Largest alpha at which a particle stays bounded: e^gamma, gamma Euler's constant (Sun et al. 2012,
/// doi 10.1162/EVCO_a_00049).
pub const ALPHA_BOUNDED: f64 = 1.781_072_417_990_198;

/// Writes the next position of a particle, per axis j
///
/// ```text
/// p_j  = phi P_j + (1 - phi) G_j,           phi ~ U(0, 1)
/// X_j := p_j ± alpha |m_j - X_j| ln(1/u),   u ~ U(0, 1], fair sign
/// ```
///
/// with P the particle's `best`, G the `attractor` and m the `mean_best` of the swarm. ln(1/u) is drawn as Exp(1), which is
/// never infinite, so a collapsed swarm (m = X) gives no NaN. Two draws of 64 bits an axis.
///
/// Sun, Feng, Xu 2004, doi 10.1109/CEC.2004.1330875.
#[inline]
pub(crate) fn step<S: Real>(
    rng: &mut SearchRng,
    alpha: S,
    position: &mut [S],
    best: &[S],
    attractor: &[S],
    mean_best: &[S],
) {
    for (((x, &p), &g), &m) in position.iter_mut().zip(best).zip(attractor).zip(mean_best) {
        let (phi, negative) = rng.uniform_and_sign();
        let centre = g + S::of(phi) * (p - g);
        let spread = alpha * (m - *x).abs() * S::of(rng.exponential());
        *x = if negative {
            centre - spread
        } else {
            centre + spread
        };
    }
}

/// Writes the mean of all rows of `bests`, each of the length of `mean`.
pub(crate) fn mean_best<S: Real>(bests: &[S], mean: &mut [S]) {
    let dimension = mean.len();
    // Multiplied before it is summed: a sum of bests near the largest number would overflow.
    let weight = S::of(dimension as f64) / S::of(bests.len() as f64);
    mean.fill(S::zero());
    for best in bests.chunks_exact(dimension) {
        for (m, &p) in mean.iter_mut().zip(best) {
            *m = *m + p * weight;
        }
    }
}

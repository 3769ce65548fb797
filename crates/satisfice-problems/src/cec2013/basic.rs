//! The functions that compositions are made of, all with their minimum 0 at the origin, and F1 to F8 of the suite.

use core::f64::consts::{LN_2, PI, TAU};

/// Terms of Weierstrass's function, k = 0..=20, with a = 0.5, b = 3.
const WEIERSTRASS: usize = 21;

/// Weierstrass's function, sum over the coordinates of sum_k a^k (cos(2 pi b^k (x + 1/2)) - cos(pi b^k)).
///
/// b = 3 triples the angle from term to term, so that one sine and one cosine give all terms:
/// sin 3t = (3 - 4 sin^2 t) sin t and cos 3t = (1 - 4 sin^2 t) cos t. An error in the angle triples from
/// term to term, as it does when each term is computed on its own, while the terms halve. A call of the cosine per term would take
/// most of a composition's time.
#[derive(Debug, Clone)]
pub(super) struct Weierstrass {
    /// a^k.
    amplitudes: [f64; WEIERSTRASS],
    /// sum_k a^k cos(pi b^k).
    at_zero: f64,
}

impl Weierstrass {
    pub(super) fn new() -> Self {
        let mut amplitudes = [0.0; WEIERSTRASS];
        for (k, amplitude) in (0..).zip(&mut amplitudes) {
            *amplitude = 0.5_f64.powi(k);
        }
        let at_zero = -amplitudes.iter().sum::<f64>();
        Self { amplitudes, at_zero }
    }

    fn wave(&self, x: f64) -> f64 {
        // Half a turn changes the sign, without rounding x + 1/2; whole turns are subtracted exactly.
        let (sine, cosine) = (TAU * (x - x.round())).sin_cos();
        let (mut sine, mut cosine) = (-sine, -cosine);
        let mut sum = 0.0;
        for amplitude in self.amplitudes {
            sum += amplitude * cosine;
            let square = 4.0 * sine * sine;
            sine *= 3.0 - square;
            cosine *= 1.0 - square;
        }
        sum
    }

    pub(super) fn value(&self, x: &[f64]) -> f64 {
        x.iter().map(|&x| self.wave(x) - self.at_zero).sum()
    }
}

pub(super) fn sphere(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum()
}

pub(super) fn griewank(x: &[f64]) -> f64 {
    let product: f64 = (1..)
        .zip(x)
        .map(|(i, x)| (x / f64::from(i).sqrt()).cos())
        .product();
    1.0 + sphere(x) / 4000.0 - product
}

pub(super) fn rastrigin(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x - 10.0 * (TAU * x).cos() + 10.0).sum()
}

/// Expanded Griewank's function of Rosenbrock's, F8F2, over neighbouring coordinates in a ring.
pub(super) fn expanded_griewank_rosenbrock(x: &[f64]) -> f64 {
    let next = x.iter().cycle().skip(1);
    x.iter()
        .zip(next)
        .map(|(x, y)| {
            let (x, y) = (x + 1.0, y + 1.0);
            let rosenbrock = 100.0 * (x * x - y).powi(2) + (1.0 - x).powi(2);
            1.0 + rosenbrock * rosenbrock / 4000.0 - rosenbrock.cos()
        })
        .sum()
}

/// F1, to be maximised as all below.
pub(super) fn five_uneven_peak_trap(x: f64) -> f64 {
    match x {
        x if x < 2.5 => 80.0 * (2.5 - x),
        x if x < 5.0 => 64.0 * (x - 2.5),
        x if x < 7.5 => 64.0 * (7.5 - x),
        x if x < 12.5 => 28.0 * (x - 7.5),
        x if x < 17.5 => 28.0 * (17.5 - x),
        x if x < 22.5 => 32.0 * (x - 17.5),
        x if x < 27.5 => 32.0 * (27.5 - x),
        x => 80.0 * (x - 27.5),
    }
}

/// F2.
pub(super) fn equal_maxima(x: f64) -> f64 {
    (5.0 * PI * x).sin().powi(6)
}

/// F3.
pub(super) fn uneven_decreasing_maxima(x: f64) -> f64 {
    let distance = (x - 0.08) / 0.854;
    (-2.0 * LN_2 * distance * distance).exp() * (5.0 * PI * (x.powf(0.75) - 0.05)).sin().powi(6)
}

/// F4.
pub(super) fn himmelblau(x: f64, y: f64) -> f64 {
    200.0 - (x * x + y - 11.0).powi(2) - (x + y * y - 7.0).powi(2)
}

/// F5.
pub(super) fn six_hump_camel_back(x: f64, y: f64) -> f64 {
    let (xx, yy) = (x * x, y * y);
    -((4.0 - 2.1 * xx + xx * xx / 3.0) * xx + x * y + (4.0 * yy - 4.0) * yy)
}

/// One factor of F6.
pub(super) fn shubert_factor(x: f64) -> f64 {
    (1..=5)
        .map(f64::from)
        .map(|j| j * ((j + 1.0) * x + j).cos())
        .sum()
}

/// F6.
pub(super) fn shubert(x: &[f64]) -> f64 {
    -x.iter().map(|&x| shubert_factor(x)).product::<f64>()
}

/// F7.
pub(super) fn vincent(x: &[f64]) -> f64 {
    x.iter().map(|x| (10.0 * x.ln()).sin()).sum::<f64>() / x.len() as f64
}

/// Frequencies of F8.
pub(super) const FREQUENCIES: [f64; 2] = [3.0, 4.0];

/// F8.
pub(super) fn modified_rastrigin(x: &[f64]) -> f64 {
    -FREQUENCIES
        .iter()
        .zip(x)
        .map(|(k, x)| 10.0 + 9.0 * (TAU * k * x).cos())
        .sum::<f64>()
}

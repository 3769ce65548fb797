//! The positions of the global optima of F1 to F8, for scoring by place.

use core::f64::consts::PI;

use super::basic::{FREQUENCIES, shubert_factor};

/// All combinations of one entry of each list.
fn product(lists: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let start = vec![Vec::new()];
    lists.iter().fold(start, |points, list| {
        let extend = |point: &Vec<f64>, &x: &f64| point.iter().copied().chain([x]).collect();
        points
            .iter()
            .flat_map(|point| list.iter().map(move |x| extend(point, x)))
            .collect()
    })
}

/// F1: both ends.
pub(super) fn trap() -> Vec<Vec<f64>> {
    vec![vec![0.0], vec![30.0]]
}

/// F2: the crests of sin(5 pi x).
pub(super) fn equal_maxima() -> Vec<Vec<f64>> {
    (0..5).map(|k| vec![0.1 + 0.2 * f64::from(k)]).collect()
}

/// F3: the crest of 5 pi (x^0.75 - 0.05) at pi / 2, moved a little by the slope of the exponential.
pub(super) fn uneven_decreasing_maxima() -> Vec<Vec<f64>> {
    let best = maximum(&super::basic::uneven_decreasing_maxima, 0.07, 0.09);
    vec![vec![best]]
}

/// F4: the roots of Himmelblau's equations by Newton's method from points near them.
pub(super) fn himmelblau() -> Vec<Vec<f64>> {
    let near = [(3.0, 2.0), (-2.8, 3.1), (-3.8, -3.3), (3.6, -1.8)];
    let polish = |(mut x, mut y): (f64, f64)| {
        for _ in 0..20 {
            let (a, b) = (x * x + y - 11.0, x + y * y - 7.0);
            let determinant = 4.0 * x * y - 1.0;
            (x, y) = (
                x - (2.0 * y * a - b) / determinant,
                y - (2.0 * x * b - a) / determinant,
            );
        }
        vec![x, y]
    };
    near.map(polish).to_vec()
}

/// F5: the two lowest humps, each the mirror image of the other, by Newton's method.
pub(super) fn six_hump_camel_back() -> Vec<Vec<f64>> {
    let (mut x, mut y) = (0.09_f64, -0.71_f64);
    for _ in 0..20 {
        // Gradient and Hessian of (4 - 2.1 x^2 + x^4 / 3) x^2 + x y + 4 y^4 - 4 y^2.
        let gradient = [
            8.0 * x - 8.4 * x.powi(3) + 2.0 * x.powi(5) + y,
            x + 16.0 * y.powi(3) - 8.0 * y,
        ];
        let (xx, yy) = (8.0 - 25.2 * x * x + 10.0 * x.powi(4), 48.0 * y * y - 8.0);
        let determinant = xx * yy - 1.0;
        x -= (yy * gradient[0] - gradient[1]) / determinant;
        y -= (xx * gradient[1] - gradient[0]) / determinant;
    }
    vec![vec![x, y], vec![-x, -y]]
}

/// F6: products of an odd number of lowest and else highest points of the factor, where that gives the highest -product.
pub(super) fn shubert(dimension: usize) -> Vec<Vec<f64>> {
    let high = crests(&shubert_factor);
    let low = crests(&|x| -shubert_factor(x));
    let value = |points: &[f64]| points.first().map_or(0.0, |&x| shubert_factor(x));
    let (top, bottom) = (value(&high), value(&low));
    let mut best = (f64::NEG_INFINITY, Vec::new());
    for pattern in 0..1_u32 << dimension {
        let is_low = |axis: usize| pattern >> axis & 1 == 1;
        let height = -(0..dimension)
            .map(|axis| if is_low(axis) { bottom } else { top })
            .product::<f64>();
        let lists: Vec<_> = (0..dimension)
            .map(|axis| if is_low(axis) { low.clone() } else { high.clone() })
            .collect();
        if height > best.0 * (1.0 + 1e-9) || best.1.is_empty() {
            best = (height, product(&lists));
        } else if height > best.0 * (1.0 - 1e-9) {
            best.1.extend(product(&lists));
        }
    }
    best.1
}

/// The highest local maxima of a function on [-10, 10] that has period 2 pi.
fn crests(function: &dyn Fn(f64) -> f64) -> Vec<f64> {
    const STEPS: i32 = 20_000;
    let at = |k: i32| -10.0 + 20.0 * f64::from(k) / f64::from(STEPS);
    let is_crest = |&k: &i32| function(at(k)) >= function(at(k - 1)) && function(at(k)) > function(at(k + 1));
    let tops: Vec<f64> = (1..STEPS)
        .filter(is_crest)
        .map(|k| maximum(function, at(k - 1), at(k + 1)))
        .collect();
    let highest = tops
        .iter()
        .map(|&x| function(x))
        .fold(f64::NEG_INFINITY, f64::max);
    tops.into_iter()
        .filter(|&x| function(x) > highest - 1e-6)
        .collect()
}

/// The maximum of a function with one maximum between two points, by golden sections.
fn maximum(function: &dyn Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    let ratio = (5_f64.sqrt() - 1.0) / 2.0;
    for _ in 0..100 {
        let (c, d) = (b - ratio * (b - a), a + ratio * (b - a));
        if function(c) > function(d) {
            b = d;
        } else {
            a = c;
        }
    }
    f64::midpoint(a, b)
}

/// F7: 10 ln x = pi / 2 + 2 pi k inside [0.25, 10].
pub(super) fn vincent(dimension: usize) -> Vec<Vec<f64>> {
    let crests: Vec<f64> = (-5..5)
        .map(|k| ((0.5 + 2.0 * f64::from(k)) * PI / 10.0).exp())
        .filter(|x| (0.25..=10.0).contains(x))
        .collect();
    product(&vec![crests; dimension])
}

/// F8: cos(2 pi k x) = -1.
pub(super) fn modified_rastrigin() -> Vec<Vec<f64>> {
    let crests = |k: f64| (0..k as u32).map(|j| (f64::from(j) + 0.5) / k).collect();
    product(&FREQUENCIES.map(crests))
}

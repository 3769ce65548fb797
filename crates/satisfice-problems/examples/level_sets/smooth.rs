//! Smooth functions.

use core::f64::consts::{E, PI};

use satisfice::{Axis, SearchRng, Space, from_fn};

use super::Named;

/// A problem on a cube: the separation is that of two answers on every axis.
pub(super) fn cube(
    name: &'static str,
    (axes, lower, upper): (usize, f64, f64),
    (level, separation): (f64, f64),
    function: impl Fn(&[f64]) -> f64 + Send + Sync + 'static,
) -> Result<Named, satisfice::Error> {
    let space = Space::cube(axes, lower, upper)?;
    let problem = from_fn(space, level, function).boxed();
    Ok((name, problem.separation(separation)))
}

/// The functions.
#[rustfmt::skip]
pub(super) fn problems() -> Result<Vec<Named>, satisfice::Error> {
    Ok(vec![
        // Ackley 1987, turned.
        cube("ackley, turned", (8, -5.0, 5.0), (2.5, 0.5), |x| {
            let y = turned(x, 0.7, 5);
            let (square, wave) = (mean(&y, |y| y * y), mean(&y, |y| (2.0 * PI * y).cos()));
            20.0 + E - 20.0 * (-0.2 * square.sqrt()).exp() - wave.exp()
        })?,
        cube("ridge, turned", (10, -1.0, 1.0), (0.05, 0.1), |x| {
            let y = turned(x, 0.0, 9);
            y[0].abs() + 0.1 * sum(&y[1..], |y| (y - 0.1).abs())
        })?,
        // Styblinski, Tang 1990.
        cube("styblinski-tang", (6, -5.0, 5.0), (-200.0, 0.5), |x| sum(x, |x| 0.5 * (x.powi(4) - 16.0 * x * x + 5.0 * x)))?,
        // Griewank 1981.
        cube("griewank", (5, -50.0, 50.0), (0.3, 3.0), |x| {
            let wave: f64 = (1..).zip(x).map(|(i, x)| (x / f64::from(i).sqrt()).cos()).product();
            1.0 + sum(x, |x| x * x / 4000.0) - wave
        })?,
        // Levy, Montalvo 1985.
        cube("levy", (8, -10.0, 10.0), (2.0, 0.5), |x| {
            let w: Vec<f64> = x.iter().map(|x| 1.0 + (x - 1.0) / 4.0).collect();
            let middle = sum(&w[..7], |w| (w - 1.0).powi(2) * (1.0 + 10.0 * (PI * w + 1.0).sin().powi(2)));
            (PI * w[0]).sin().powi(2) + middle + (w[7] - 1.0).powi(2)
        })?,
        // Dixon, Price 1989.
        cube("dixon-price", (10, -5.0, 5.0), (60.0, 0.4), |x| {
            let rest = (2..).zip(x.windows(2)).map(|(i, x)| f64::from(i) * (2.0 * x[1] * x[1] - x[0]).powi(2));
            (x[0] - 1.0).powi(2) + rest.sum::<f64>()
        })?,
        // Michalewicz 1992.
        cube("michalewicz", (5, 0.0, PI), (-3.2, 0.05), |x| {
            -(1..).zip(x).map(|(i, x)| x.sin() * (f64::from(i) * x * x / PI).sin().powi(20)).sum::<f64>()
        })?,
        // Schwefel 1981.
        cube("schwefel", (3, -500.0, 500.0), (200.0, 10.0), |x| sum(x, |x| 418.9829 - x * x.abs().sqrt().sin()))?,
        // Powell 1962, twice.
        cube("powell", (8, -4.0, 5.0), (20.0, 0.3), |x| {
            let four = |x: &[f64]| (x[0] + 10.0 * x[1]).powi(2) + 5.0 * (x[2] - x[3]).powi(2)
                + (x[1] - 2.0 * x[2]).powi(4) + 10.0 * (x[0] - x[3]).powi(4);
            four(&x[..4]) + four(&x[4..])
        })?,
        // Zakharov 1975, moved.
        cube("zakharov", (6, -5.0, 10.0), (5.0, 0.3), |x| {
            let s: f64 = (1..).zip(x).map(|(i, x)| 0.5 * f64::from(i) * (x - 1.0)).sum();
            sum(x, |x| (x - 1.0).powi(2)) + s * s + s.powi(4)
        })?,
        cube("long sphere, turned", (12, -1.0, 1.0), (0.3, 0.1), |x| {
            let y = turned(x, 0.05, 19);
            (1..).zip(&y).map(|(i, y)| f64::from(i) * y * y).sum()
        })?,
        // Twelve bumps at random places.
        cube("bumps", (4, 0.0, 1.0), (-0.7, 0.03), {
            let bumps = centres(12, 4, 88);
            move |x| -bumps.iter().map(|c| (-distance(x, c).powi(2) / 0.02).exp()).sum::<f64>()
        })?,
        cube("coupled logistic map", (6, 0.0, 1.0), (0.02, 0.02), |x| {
            (0..6).map(|i| (x[(i + 1) % 6] - 3.9 * x[i] * (1.0 - x[i])).abs()).fold(0.0, f64::max)
        })?,
        // Welded beam, Ragsdell, Phillips 1976: violations, and a cost of at most 2.6.
        welded_beam()?,
        // Rates of predators and prey from a simulation of ten moments (Lotka 1925).
        cube("lotka-volterra", (4, 0.1, 2.0), (0.25, 0.05), {
            let measured = populations([1.1, 0.8, 0.9, 0.6]);
            move |x| root_mean_square(&populations([x[0], x[1], x[2], x[3]]), &measured)
        })?,
        pid()?,
    ])
}

fn welded_beam() -> Result<Named, satisfice::Error> {
    let axes = [(0.1, 2.0), (0.1, 10.0), (0.1, 10.0), (0.1, 2.0)];
    let space = Space::new(axes.map(|(lower, upper)| Axis::continuous(lower, upper)))?;
    let violation = |x: &[f64]| {
        let (weld, length, height, width) = (x[0], x[1], x[2], x[3]);
        let (load, arm, stiffness, shear) = (6000.0, 14.0, 30e6, 12e6);
        let reach = (length * length / 4.0 + ((weld + height) / 2.0).powi(2)).sqrt();
        let polar = 2.0 * 2.0_f64.sqrt() * weld * length * (reach * reach - length * length / 6.0);
        let direct = load / (2.0_f64.sqrt() * weld * length);
        let bent = load * (arm + length / 2.0) * reach / polar;
        let stress = (direct * direct + direct * bent * length / reach + bent * bent).sqrt();
        let buckling = 4.013 * stiffness * (height * height * width.powi(6) / 36.0).sqrt() / (arm * arm)
            * (1.0 - height / (2.0 * arm) * (stiffness / (4.0 * shear)).sqrt());
        let cost = 1.10471 * weld * weld * length + 0.04811 * height * width * (arm + length);
        let limits = [
            stress / 13_600.0,
            6.0 * load * arm / (width * height * height) / 30_000.0,
            weld / width,
            4.0 * load * arm.powi(3) / (stiffness * height.powi(3) * width) / 0.25,
            load / buckling,
            cost / 2.6,
        ];
        sum(&limits, |used| (used - 1.0).max(0.0))
    };
    let problem = from_fn(space, 1e-9, violation).boxed();
    Ok(("welded beam", problem.separation(0.05)))
}

/// Predators and prey at ten moments each.
fn populations(rates: [f64; 4]) -> Vec<f64> {
    let (mut prey, mut predators, mut all) = (1.0_f64, 0.5_f64, Vec::new());
    for step in 1..=200 {
        let births = prey * (rates[0] - rates[1] * predators);
        let growth = predators * (rates[3] * prey - rates[2]);
        prey = (prey + 0.05 * births).clamp(0.0, 1e3);
        predators = (predators + 0.05 * growth).clamp(0.0, 1e3);
        if step % 20 == 0 {
            all.extend([prey, predators]);
        }
    }
    all
}

/// Gains of a controller on logarithmic axes: the time-weighted error of a step, and thrice its overshoot.
fn pid() -> Result<Named, satisfice::Error> {
    let axes = [(0.01, 100.0), (0.01, 100.0), (0.001, 10.0)];
    let space = Space::new(axes.map(|(lower, upper)| Axis::continuous(lower, upper).logarithmic()))?;
    let cost = |gains: &[f64]| {
        let (mut at, mut speed, mut integral, mut last) = (0.0_f64, 0.0_f64, 0.0, 1.0);
        let (mut cost, mut overshoot) = (0.0, 0.0_f64);
        for step in 0..400 {
            let error = 1.0 - at;
            integral += error * 0.02;
            let force = gains[0] * error + gains[1] * integral + gains[2] * (error - last) / 0.02;
            last = error;
            speed += 0.02 * (force.clamp(-20.0, 20.0) - 0.8 * speed - 2.0 * at);
            at += 0.02 * speed;
            cost += 0.02 * f64::from(step) * 0.02 * error.abs();
            overshoot = overshoot.max(at - 1.0);
        }
        cost + 3.0 * overshoot
    };
    let problem = from_fn(space, 0.55, cost).boxed();
    Ok(("controller", problem.separation(0.05)))
}

pub(super) fn sum(x: &[f64], f: impl Fn(f64) -> f64) -> f64 {
    x.iter().map(|&x| f(x)).sum()
}

pub(super) fn mean(x: &[f64], f: impl Fn(f64) -> f64) -> f64 {
    sum(x, f) / x.len() as f64
}

pub(super) fn distance(x: &[f64], centre: &[f64]) -> f64 {
    x.iter()
        .zip(centre)
        .map(|(x, c)| (x - c).powi(2))
        .sum::<f64>()
        .sqrt()
}

fn root_mean_square(a: &[f64], b: &[f64]) -> f64 {
    distance(a, b) / (a.len() as f64).sqrt()
}

pub(super) fn centres(count: usize, axes: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut rng = SearchRng::new(seed);
    let mut point = || (0..axes).map(|_| rng.uniform()).collect();
    (0..count).map(|_| point()).collect()
}

/// A point about `centre`, turned in every plane of two axes by an angle of the seed.
pub(super) fn turned(x: &[f64], centre: f64, seed: u64) -> Vec<f64> {
    let mut rng = SearchRng::new(seed);
    let mut y: Vec<f64> = x.iter().map(|x| x - centre).collect();
    for i in 0..y.len() {
        for j in i + 1..y.len() {
            let (sin, cos) = (2.0 * PI * rng.uniform()).sin_cos();
            (y[i], y[j]) = (cos * y[i] - sin * y[j], sin * y[i] + cos * y[j]);
        }
    }
    y
}

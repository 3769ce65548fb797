//! Functions of many local optima, most of which are no answers.

use core::f64::consts::{E, PI};

use super::Named;
use super::smooth::{centres, cube, distance, mean, sum, turned};

/// The functions.
#[rustfmt::skip]
pub(super) fn problems() -> Result<Vec<Named>, satisfice::Error> {
    Ok(vec![
        // Schwefel 1981.
        cube("schwefel in 4", (4, -500.0, 500.0), (200.0, 10.0), schwefel)?,
        cube("schwefel in 8", (8, -500.0, 500.0), (600.0, 10.0), schwefel)?,
        // Rastrigin 1974, moved.
        cube("rastrigin in 4", (4, -5.0, 5.0), (3.0, 0.05), rastrigin)?,
        cube("rastrigin in 8", (8, -5.0, 5.0), (12.0, 0.1), rastrigin)?,
        cube("rastrigin, turned", (5, -5.0, 5.0), (7.0, 0.05), |x| rastrigin(&turned(x, 0.0, 21)))?,
        // Michalewicz 1992.
        cube("michalewicz in 5", (5, 0.0, PI), (-4.2, 0.03), michalewicz)?,
        cube("michalewicz in 8", (8, 0.0, PI), (-6.3, 0.03), michalewicz)?,
        // Ackley 1987, turned, on a wide cube.
        cube("ackley, wide", (6, -30.0, 30.0), (4.5, 0.6), |x| {
            let y = turned(x, 3.0, 23);
            let (square, wave) = (mean(&y, |y| y * y), mean(&y, |y| (2.0 * PI * y).cos()));
            20.0 + E - 20.0 * (-0.2 * square.sqrt()).exp() - wave.exp()
        })?,
        // Griewank 1981, moved.
        cube("griewank, moved", (6, -60.0, 60.0), (0.25, 2.4), |x| {
            let wave: f64 = (1..).zip(x).map(|(i, x)| ((x - 7.0) / f64::from(i).sqrt()).cos()).product();
            1.0 + sum(x, |x| (x - 7.0).powi(2) / 4000.0) - wave
        })?,
        // The sum of three eggholders, Whitley et al. 1996.
        cube("eggholder", (4, -512.0, 512.0), (-2350.0, 10.0), |x| {
            x.windows(2).map(|x| {
                let (a, b) = (x[0], x[1] + 47.0);
                -b * (b + a / 2.0).abs().sqrt().sin() - a * (a - b).abs().sqrt().sin()
            }).sum()
        })?,
        // After Shekel's foxholes, 1971.
        cube("foxholes", (5, 0.0, 10.0), (-0.9, 0.1), {
            let holes = centres(30, 5, 9);
            move |x| {
                let x: Vec<f64> = x.iter().map(|x| x / 10.0).collect();
                -holes.iter().map(|c| 1.0 / (100.0 * distance(&x, c).powi(2) + 0.5)).sum::<f64>()
            }
        })?,
        // Salomon 1996, moved: spherical shells about one point.
        cube("salomon", (5, -50.0, 50.0), (0.45, 0.5), |x| {
            let radius = sum(x, |x| (x + 11.0).powi(2)).sqrt();
            1.0 - (2.0 * PI * radius).cos() + 0.1 * radius
        })?,
        // Weierstrass 1872, twelve terms, turned.
        cube("weierstrass, turned", (4, -0.5, 0.5), (1.2, 0.01), |x| {
            let term = |x: f64, k: i32| 0.5_f64.powi(k) * (2.0 * PI * 3.0_f64.powi(k) * (x + 0.5)).cos();
            let wave = |x: f64| (0..12).map(|k| term(x, k)).sum::<f64>();
            sum(&turned(x, 0.13, 25), |y| wave(y) - wave(0.0))
        })?,
        // Alpine 2, Clerc 1999.
        cube("alpine", (7, 0.0, 10.0), (-600.0, 0.1), |x| -x.iter().map(|x| x.sqrt() * x.sin()).product::<f64>())?,
    ])
}

fn schwefel(x: &[f64]) -> f64 {
    sum(x, |x| 418.9829 - x * x.abs().sqrt().sin())
}

fn rastrigin(x: &[f64]) -> f64 {
    let terms = (0..).zip(x).map(|(i, x)| {
        let y = x - 0.7 - 0.3 * f64::from(i);
        y * y - 10.0 * (2.0 * PI * y).cos() + 10.0
    });
    terms.sum()
}

fn michalewicz(x: &[f64]) -> f64 {
    let terms = (1..).zip(x);
    -terms
        .map(|(i, x)| x.sin() * (f64::from(i) * x * x / PI).sin().powi(20))
        .sum::<f64>()
}

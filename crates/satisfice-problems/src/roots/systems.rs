//! The systems of the problem `system`: equations, boxes and numbers of roots.

use core::f64::consts::{E, PI, TAU};

use super::equations::{Functions, functions};
use crate::number::Number;

/// A system with its box and the number of its roots inside, proved by `System::certify` in a test.
pub(super) struct Entry {
    pub(super) name: &'static str,
    pub(super) functions: Functions,
    pub(super) bounds: &'static [(f64, f64)],
    pub(super) roots: u64,
}

const fn entry(name: &'static str, functions: Functions, bounds: &'static [(f64, f64)], roots: u64) -> Entry {
    Entry {
        name,
        functions,
        bounds,
        roots,
    }
}

/// The words of the parameter `name`, in the order of `SYSTEMS`.
pub(super) const NAMES: &[&str] = &[
    "merlet",
    "sine-line",
    "cosine-circle",
    "floudas",
    "tsai-morgan",
    "effati-grosan",
    "boggs",
    "himmelblau-stationary",
    "camel-stationary",
    "crossed-sines",
    "waves",
    "rastrigin-stationary",
    "sphere-waves",
    "noonburg",
    "kuramoto",
    "katsura",
    "wright",
];

const UNIT: (f64, f64) = (-1.0, 1.0);

pub(super) const SYSTEMS: [Entry; 17] = [
    entry("merlet", functions!(merlet), &[(0.0, TAU); 2], 13),
    entry("sine-line", functions!(sine_line), &[UNIT; 2], 11),
    entry("cosine-circle", functions!(cosine_circle), &[UNIT; 2], 15),
    entry("floudas", functions!(floudas), &[(0.25, 1.0), (1.5, TAU)], 2),
    entry("tsai-morgan", functions!(tsai_morgan), &[UNIT; 8], 16),
    entry(
        "effati-grosan",
        functions!(effati_grosan),
        &[(-10.0, 10.0); 2],
        13,
    ),
    entry("boggs", functions!(boggs), &[(-2.0, 2.0), (-1.0, 3.0)], 3),
    entry(
        "himmelblau-stationary",
        functions!(himmelblau_stationary),
        &[(-6.0, 6.0); 2],
        9,
    ),
    entry(
        "camel-stationary",
        functions!(camel_stationary),
        &[(-3.0, 3.0), (-2.0, 2.0)],
        15,
    ),
    entry("crossed-sines", functions!(crossed_sines), &[UNIT; 2], 27),
    entry("waves", functions!(super::waves::waves), &[(0.0, 2.0); 2], 144),
    entry(
        "rastrigin-stationary",
        functions!(rastrigin_stationary),
        &[(-2.25, 2.25); 2],
        81,
    ),
    entry("sphere-waves", functions!(sphere_waves), &[UNIT; 3], 18),
    entry("noonburg", functions!(noonburg), &[(-5.0, 5.0); 3], 7),
    entry("kuramoto", functions!(kuramoto), &[(-PI, PI); 3], 8),
    entry("katsura", functions!(katsura), &[UNIT; 4], 6),
    entry("wright", functions!(wright), &[(-6.0, 6.0); 5], 32),
];

/// Merlet, from the COPRIN collection of benchmarks.
fn merlet<N: Number>(x: &[N], e: &mut [N]) {
    let (s0, c0, s1, c1) = (x[0].sin(), x[0].cos(), x[1].sin(), x[1].cos());
    e[0] = -(s0 * c1) - (c0 * s1).times(2.0);
    e[1] = -(c0 * s1) - (s0 * c1).times(2.0);
}

/// x = sin 5 pi y, x = y (Song et al. 2015, doi 10.1109/TEVC.2014.2336865).
fn sine_line<N: Number>(x: &[N], e: &mut [N]) {
    e[0] = x[0] - x[1].times(5.0 * PI).sin();
    e[1] = x[0] - x[1];
}

/// x = cos 4 pi y, x^2 + y^2 = 1 (Song et al. 2015).
fn cosine_circle<N: Number>(x: &[N], e: &mut [N]) {
    e[0] = x[0] - x[1].times(4.0 * PI).cos();
    e[1] = x[0].square() + x[1].square().plus(-1.0);
}

/// Floudas 2000, Handbook of test problems, 14.1.4, after Ferraris and Tronconi.
fn floudas<N: Number>(x: &[N], e: &mut [N]) {
    e[0] = (x[0] * x[1]).sin().times(0.5) - x[1].times(0.25 / PI) - x[0].times(0.5);
    e[1] = x[0].times(2.0).exp().plus(-E).times(1.0 - 0.25 / PI) + x[1].times(E / PI) - x[0].times(2.0 * E);
}

/// Postures of a robot with six joints: Tsai, Morgan 1985, doi 10.1115/1.3258708; Floudas 2000, 14.1.8.
fn tsai_morgan<N: Number>(x: &[N], e: &mut [N]) {
    let (x02, x12) = (x[0] * x[2], x[1] * x[2]);
    e[0] = x02.times(4.731e-3) - x12.times(0.3578) - x[0].times(0.1238) + x[6]
        - x[1].times(1.637e-3)
        - x[3].times(0.9338).plus(0.3571);
    e[1] = x02.times(0.2238) + x12.times(0.7623) + x[0].times(0.2638)
        - x[6]
        - x[1].times(0.07745)
        - x[3].times(0.6734).plus(0.6022);
    e[2] = x[5] * x[7] + x[0].times(0.3578) + x[1].times(4.731e-3);
    e[3] = x[1].times(0.2238) - x[0].times(0.7623).plus(-0.3461);
    for k in 0..4 {
        e[4 + k] = x[2 * k].square() + x[2 * k + 1].square().plus(-1.0);
    }
}

/// Effati, Nazemi 2005; Grosan, Abraham 2008, doi 10.1109/TSMCA.2008.918599.
fn effati_grosan<N: Number>(x: &[N], e: &mut [N]) {
    let (a, b) = (x[0].times(2.0), x[1].times(2.0));
    e[0] = a.cos() - b.cos().plus(0.4);
    e[1] = b - a + b.sin() - a.sin().plus(1.2);
}

/// Boggs 1971, The solution of nonlinear systems by A-stable integration techniques.
fn boggs<N: Number>(x: &[N], e: &mut [N]) {
    e[0] = x[0].square() - x[1].plus(-1.0);
    e[1] = x[0] - x[1].times(PI / 2.0).cos();
}

/// Stationary points of Himmelblau's function: 4 minima, 4 saddles, 1 maximum.
fn himmelblau_stationary<N: Number>(x: &[N], e: &mut [N]) {
    let (a, b) = (x[0].square() + x[1].plus(-11.0), x[0] + x[1].square().plus(-7.0));
    e[0] = (x[0] * a).times(2.0) + b;
    e[1] = a + (x[1] * b).times(2.0);
}

/// Stationary points of the six-hump camel-back function (Dixon, Szegö 1978).
fn camel_stationary<N: Number>(x: &[N], e: &mut [N]) {
    let square = x[0].square();
    e[0] = x[0] * (square.times(2.0).plus(-8.4) * square).plus(8.0) + x[1];
    e[1] = x[0] + x[1] * x[1].square().times(16.0).plus(-8.0);
}

/// x = sin 2.5 pi y, y = sin 2.5 pi x: Lissajous-like, roots on and off the diagonal.
fn crossed_sines<N: Number>(x: &[N], e: &mut [N]) {
    e[0] = x[0] - x[1].times(2.5 * PI).sin();
    e[1] = x[1] - x[0].times(2.5 * PI).sin();
}

/// Stationary points of Rastrigin's function in two dimensions: on each axis, x = -10 pi sin 2 pi x.
fn rastrigin_stationary<N: Number>(x: &[N], e: &mut [N]) {
    for (e, x) in e.iter_mut().zip(x) {
        *e = x.times(0.1) + x.times(TAU).sin().times(PI);
    }
}

/// Three waves on a sphere: x^2 + y^2 + z^2 = 0.8, sin 2 pi x = 0.3 y, sin 2 pi y = 0.3 z.
fn sphere_waves<N: Number>(x: &[N], e: &mut [N]) {
    e[0] = x[0].square() + x[1].square() + x[2].square().plus(-0.8);
    e[1] = x[0].times(TAU).sin() - x[1].times(0.3);
    e[2] = x[1].times(TAU).sin() - x[2].times(0.3);
}

/// A neural network of Lotka-Volterra type (Noonburg 1989).
fn noonburg<N: Number>(x: &[N], e: &mut [N]) {
    for k in 0..3 {
        let others = x[(k + 1) % 3].square() + x[(k + 2) % 3].square();
        e[k] = (x[k] * others).plus(1.0) - x[k].times(1.1);
    }
}

/// Synchronous states of four coupled oscillators, the fourth at phase 0 (Kuramoto 1975).
fn kuramoto<N: Number>(x: &[N], e: &mut [N]) {
    let frequencies = [0.1, -0.2, 0.3];
    for k in 0..3 {
        let mut pull = -x[k].sin();
        for other in (0..3).filter(|other| *other != k) {
            pull = pull + (x[other] - x[k]).sin();
        }
        e[k] = pull.plus(frequencies[k]);
    }
}

/// Magnetism, n = 3 (Katsura 1990).
fn katsura<N: Number>(x: &[N], e: &mut [N]) {
    e[0] = x[0] + (x[1] + x[2] + x[3]).times(2.0).plus(-1.0);
    e[1] = x[0].square() + (x[1].square() + x[2].square() + x[3].square()).times(2.0) - x[0];
    e[2] = (x[0] * x[1] + x[1] * x[2] + x[2] * x[3]).times(2.0) - x[1];
    e[3] = x[1].square() + (x[0] * x[2] + x[1] * x[3]).times(2.0) - x[2];
}

/// x_k^2 - x_k + sum of the others = 10, in five unknowns (Wright 1985).
fn wright<N: Number>(x: &[N], e: &mut [N]) {
    let sum = x[0] + x[1] + x[2] + x[3] + x[4];
    for (e, x) in e.iter_mut().zip(x) {
        *e = x.square() - x.times(2.0) + sum.plus(-10.0);
    }
}

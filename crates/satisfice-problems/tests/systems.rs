//! The systems of the literature: counts proved by interval branch and bound, and by other methods where there are any.
#![allow(clippy::unwrap_used, missing_docs)]

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::LazyLock;

use approx::assert_relative_eq;
use satisfice::catalogue::Catalogued;
use satisfice::{Region, SatisficingProblem, SearchRng, testing};
use satisfice_problems::System;

/// Has a singular root at (1, 0), of which branch and bound proves nothing.
const SINGULAR: &str = "cosine-circle";

fn system(name: &str) -> System {
    System::new(name, 1e-5, 0.01).unwrap()
}

/// The roots of every system but the singular one, proved once for all tests.
static PROVED: LazyLock<BTreeMap<&str, Vec<Vec<f64>>>> = LazyLock::new(|| {
    let names = System::names().iter().filter(|name| **name != SINGULAR);
    let roots = |name: &&'static str| (*name, system(name).certify(100_000).unwrap());
    names.map(roots).collect()
});

fn proved(name: &str) -> &'static [Vec<f64>] {
    &PROVED[name]
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn counts_are_proved() {
    let mut rng = SearchRng::new(1);
    for name in System::names().iter().filter(|name| **name != SINGULAR) {
        let system = system(name);
        let roots = proved(name);
        assert_eq!(Some(roots.len() as u64), system.reference_hits(), "{name}");
        for (k, root) in roots.iter().enumerate() {
            assert!(system.fitness(&system.decode(root)) < 1e-20, "{name} {root:?}");
            assert!(
                roots[..k].iter().all(|other| distance(root, other) > 0.01),
                "{name} {root:?}"
            );
            // What is near it is polished to it.
            for _ in 0..50 {
                let mut near: Vec<f64> = root.iter().map(|x| x + 1e-3 * rng.normal()).collect();
                system.space().keep_inside(&mut near);
                let hit = system.decode(&near);
                if system.fitness(&hit) < system.threshold() {
                    let polished = system.canonical(&hit).unwrap_or(hit);
                    assert!(
                        distance(&polished.coordinates, root) < 1e-8,
                        "{name} {root:?} {polished:?}"
                    );
                }
            }
        }
    }
}

/// Below the threshold there is nothing that is not close to a root.
#[test]
fn hits_are_near_roots() {
    for name in System::names() {
        let system = system(name);
        let space = system.space();
        if space.dimension() > 2 {
            continue;
        }
        let roots = if *name == SINGULAR {
            &singular_roots()
        } else {
            proved(name)
        };
        let mut stack = vec![space.region()];
        while let Some(region) = stack.pop() {
            let widths: Vec<f64> = region
                .upper
                .iter()
                .zip(&region.lower)
                .map(|(u, l)| u - l)
                .collect();
            let widest = (0..2).max_by(|&a, &b| widths[a].total_cmp(&widths[b])).unwrap();
            let middle: Vec<f64> = region
                .upper
                .iter()
                .zip(&region.lower)
                .map(|(u, l)| f64::midpoint(*u, *l))
                .collect();
            let nearest = roots
                .iter()
                .map(|root| distance(root, &middle))
                .fold(f64::INFINITY, f64::min);
            if nearest + widths[widest] < 0.05
                || system.bounds().unwrap().lower_bound(&region).unwrap() >= system.threshold()
            {
                continue;
            }
            assert!(
                widths[widest] > 1e-4,
                "{name}: {middle:?} is {nearest} from the nearest root"
            );
            let half = |lower: bool| {
                let mut half: Region<f64> = region.clone();
                (if lower { &mut half.upper } else { &mut half.lower })[widest] = middle[widest];
                half
            };
            stack.extend([half(true), half(false)]);
        }
    }
}

/// y^2 = sin^2 4 pi y: the zeros of y - sin 4 pi y and of y + sin 4 pi y, of which 0 is one of both.
fn singular_roots() -> Vec<Vec<f64>> {
    let mut roots = vec![vec![1.0, 0.0]];
    for sign in [1.0, -1.0] {
        let f = |y: f64| y - sign * (4.0 * PI * y).sin();
        for k in 0..4000 {
            // Odd multiples of half a step, so that no end is a zero.
            let (mut a, mut b) = (
                -1.0 + (f64::from(k) - 0.5) / 2000.0,
                -1.0 + (f64::from(k) + 0.5) / 2000.0,
            );
            if f(a) * f(b) > 0.0 || (a < 0.0 && b > 0.0) {
                continue;
            }
            for _ in 0..100 {
                let c = f64::midpoint(a, b);
                if f(a) * f(c) <= 0.0 { b = c } else { a = c }
            }
            roots.push(vec![(4.0 * PI * a).cos(), a]);
        }
    }
    roots
}

#[test]
fn a_circle_and_a_cosine() {
    let system = system(SINGULAR);
    let roots = singular_roots();
    assert_eq!((roots.len(), system.reference_hits()), (15, Some(15)));
    for root in &roots {
        assert!(system.fitness(&system.decode(root)) < 1e-20);
    }
    // Newton's method is slow there, but near enough.
    let polished = system.canonical(&system.decode(&[0.9995, 0.004])).unwrap();
    assert!(distance(&polished.coordinates, &[1.0, 0.0]) < 0.01);
    assert_eq!(system.certify(5_000), None);
}

/// Zeros of x - sin 5 pi x by changes of sign.
#[test]
fn a_line_and_a_sine() {
    let f = |k: i32| {
        let x = (f64::from(k) + 0.5) / 10_000.0;
        x - (5.0 * PI * x).sin()
    };
    let changes = (-10_000..10_000).filter(|&k| f(k) * f(k - 1) < 0.0).count();
    assert_eq!((changes, system("sine-line").reference_hits()), (11, Some(11)));
}

/// Zeros of x - sin(a sin(a x)), a = 2.5 pi, by changes of sign, on an interval a little longer than the box.
#[test]
fn sines_that_cross() {
    let f = |k: i32| {
        let x = (f64::from(k) + 0.5) / 100_000.0;
        x - (2.5 * PI * (2.5 * PI * x).sin()).sin()
    };
    let changes = (-100_100..100_100).filter(|&k| f(k) * f(k - 1) < 0.0).count();
    assert_eq!(
        (changes, system("crossed-sines").reference_hits()),
        (27, Some(27))
    );
}

#[test]
fn merlets_roots() {
    let system = system("merlet");
    let mut known = Vec::new();
    for (i, j) in [
        (0, 0),
        (0, 2),
        (0, 4),
        (2, 0),
        (2, 2),
        (2, 4),
        (4, 0),
        (4, 2),
        (4, 4),
        (1, 1),
        (1, 3),
        (3, 1),
        (3, 3),
    ] {
        known.push([f64::from(i) * PI / 2.0, f64::from(j) * PI / 2.0]);
    }
    for root in &known {
        assert!(system.fitness(&system.decode(root)) < 1e-25);
    }
    for found in system.certify(10_000).unwrap() {
        assert!(known.iter().any(|root| distance(root, &found) < 1e-12));
    }
}

/// The robot's 16 postures by elimination: a line and a circle twice, then two signs.
#[test]
fn tsai_and_morgans_robot() {
    /// The points of the unit circle with a x + b y = c.
    fn circle(a: f64, b: f64, c: f64) -> Vec<[f64; 2]> {
        let (length, angle) = (a.hypot(b), b.atan2(a));
        let half = (c / length).acos();
        if half.is_nan() {
            return Vec::new();
        }
        [angle + half, angle - half].map(|t| [t.cos(), t.sin()]).to_vec()
    }
    let system = system("tsai-morgan");
    let mut count = 0;
    for [x1, x2] in circle(-0.7623, 0.2238, -0.3461) {
        let (p, q) = (4.731e-3 * x1 - 0.3578 * x2, 0.2238 * x1 + 0.7623 * x2);
        let (r, s) = (
            0.1238 * x1 + 1.637e-3 * x2 + 0.3571,
            0.2638 * x1 - 0.07745 * x2 - 0.6022,
        );
        for [x3, x4] in circle(p + q, -0.9338 - 0.6734, r - s) {
            let x7 = -(p * x3 - 0.9338 * x4 - r);
            for x8 in [(1.0 - x7 * x7).sqrt(), -(1.0 - x7 * x7).sqrt()] {
                let x6 = -(0.3578 * x1 + 4.731e-3 * x2) / x8;
                for x5 in [(1.0 - x6 * x6).sqrt(), -(1.0 - x6 * x6).sqrt()] {
                    let root = [x1, x2, x3, x4, x5, x6, x7, x8];
                    assert!(system.fitness(&system.decode(&root)) < 1e-24, "{root:?}");
                    count += 1;
                }
            }
        }
    }
    assert_eq!((count, system.reference_hits()), (16, Some(16)));
}

#[test]
fn equations_are_those_of_the_textbook() {
    let at = |name: &str, x: &[f64]| {
        let system = system(name);
        system.fitness(&system.decode(x))
    };
    let (x, y) = (0.37_f64, 0.81_f64);
    let sum = |e: &[f64]| e.iter().map(|e| e * e).sum::<f64>();
    let cases = [
        ("floudas", vec![x, y], {
            let e = std::f64::consts::E;
            vec![
                0.5 * (x * y).sin() - 0.25 * y / PI - 0.5 * x,
                (1.0 - 0.25 / PI) * ((2.0 * x).exp() - e) + e * y / PI - 2.0 * e * x,
            ]
        }),
        (
            "effati-grosan",
            vec![x, y],
            vec![
                (2.0 * x).cos() - (2.0 * y).cos() - 0.4,
                2.0 * (y - x) + (2.0 * y).sin() - (2.0 * x).sin() - 1.2,
            ],
        ),
        (
            "boggs",
            vec![x, y],
            vec![x * x - y + 1.0, x - (PI * y / 2.0).cos()],
        ),
        (
            "noonburg",
            vec![x, y, 0.5],
            vec![
                x * y * y + x * 0.25 - 1.1 * x + 1.0,
                y * x * x + y * 0.25 - 1.1 * y + 1.0,
                0.5 * x * x + 0.5 * y * y - 1.1 * 0.5 + 1.0,
            ],
        ),
        ("katsura", vec![x, y, 0.5, -0.2], {
            // u_m = sum over all l of u_l u_(m - l), u even, u_l = 0 for |l| > 3.
            let u = |l: i32| {
                [x, y, 0.5, -0.2, 0.0, 0.0, 0.0]
                    .get(l.unsigned_abs() as usize)
                    .copied()
                    .unwrap_or(0.0)
            };
            let row = |m: i32| (-3..=3).map(|l| u(l) * u(m - l)).sum::<f64>() - u(m);
            vec![(-3..=3).map(u).sum::<f64>() - 1.0, row(0), row(1), row(2)]
        }),
        ("wright", vec![x, y, 0.5, -0.2, 1.0], {
            let v = [x, y, 0.5, -0.2, 1.0];
            v.iter()
                .map(|z| z * z - z + v.iter().sum::<f64>() - z - 10.0)
                .collect()
        }),
    ];
    for (name, point, equations) in cases {
        assert_relative_eq!(at(name, &point), sum(&equations), max_relative = 1e-12);
    }
    // Stationary points: the gradient by difference quotients.
    type Function = fn(f64, f64) -> f64;
    let functions: [(&str, Function, f64); 3] = [
        (
            "himmelblau-stationary",
            |x, y| (x * x + y - 11.0).powi(2) + (x + y * y - 7.0).powi(2),
            2.0,
        ),
        (
            "camel-stationary",
            |x, y| (4.0 - 2.1 * x * x + x.powi(4) / 3.0) * x * x + x * y + (4.0 * y * y - 4.0) * y * y,
            1.0,
        ),
        (
            "rastrigin-stationary",
            |x, y| x * x + y * y - 10.0 * (2.0 * PI * x).cos() - 10.0 * (2.0 * PI * y).cos(),
            20.0,
        ),
    ];
    for (name, f, factor) in functions {
        let h = 1e-5;
        let gradient = [
            (f(x + h, y) - f(x - h, y)) / (2.0 * h),
            (f(x, y + h) - f(x, y - h)) / (2.0 * h),
        ];
        assert_relative_eq!(
            at(name, &[x, y]),
            sum(&gradient.map(|g| g / factor)),
            max_relative = 1e-7
        );
    }
}

#[test]
fn laws() {
    for name in System::names() {
        assert_eq!(testing::problem::check(&system(name), 1), [], "{name}");
    }
    assert!(
        System::new("merle", 1e-5, 0.01)
            .unwrap_err()
            .to_string()
            .contains("did you mean `merlet`?")
    );
    assert!(System::new("merlet", 0.0, 0.01).is_err() && System::new("merlet", 1e-5, f64::NAN).is_err());
    assert_eq!(System::new("merlet", 1e-2, 0.01).unwrap().reference_hits(), None);
}

//! Reference counts against counts made another way, and fitness against the formula of the textbook.
#![allow(clippy::unwrap_used, clippy::approx_constant, missing_docs)]

use std::f64::consts::PI;

use approx::assert_relative_eq;
use satisfice::catalogue::{Catalogued, Params};
use satisfice::{Region, SatisficingProblem, SearchRng};
use satisfice_problems::{
    Arm, ENUMERABLE, Falsification, Islands, Needles, Queens, Rastrigin, SallenKey, Shell, count_hits,
};

fn problem<P: Catalogued>(settings: &[(&str, &str)]) -> P {
    P::from_params(&Params::with(P::PARAMETERS, P::NAME, settings.iter().copied()).unwrap()).unwrap()
}

/// `formula` gets the cell indices; cell `k` of `m` has the centre `(k + 0.5) / m` of its axis.
fn fitness_is<P: Catalogued<Scalar = f64, Solution = Vec<u32>>>(
    problem: &P,
    formula: impl Fn(&[f64]) -> f64,
) {
    let mut rng = SearchRng::new(11);
    let axes = problem.space().axes();
    for _ in 0..5_000 {
        let cells: Vec<f64> = axes
            .iter()
            .map(|axis| axis.value(axis.at(rng.uniform())))
            .collect();
        let solution = problem.decode(&cells);
        assert_relative_eq!(
            problem.fitness(&solution),
            formula(&cells),
            epsilon = 1e-12,
            max_relative = 1e-12
        );
        let mut back = vec![0.0; cells.len()];
        assert!(problem.encoding().unwrap().encode(&solution, &mut back));
        assert_eq!(back, cells);
    }
    // What comes from outside does no harm.
    assert!(problem.fitness(&Vec::new()).is_nan());
    assert!(problem.fitness(&vec![u32::MAX; axes.len()]).is_nan());
    assert!(
        !problem
            .encoding()
            .unwrap()
            .encode(&vec![u32::MAX; axes.len()], &mut vec![0.0; axes.len()])
    );
}

/// Bounds of random regions are below the fitness at random points inside, and equal it where the region is one point.
fn bounds_are_sound<P: Catalogued<Scalar = f64, Solution = Vec<u32>>>(problem: &P) {
    let mut rng = SearchRng::new(13);
    let axes = problem.space().axes();
    for trial in 0..2_000 {
        let mut draw = |from: f64, to: f64| (from + rng.uniform() * (to + 1.0 - from)).floor().min(to);
        let (mut lower, mut upper) = (Vec::new(), Vec::new());
        for axis in axes {
            let (a, b) = (draw(axis.lower(), axis.upper()), draw(axis.lower(), axis.upper()));
            lower.push(a.min(b));
            upper.push(if trial % 4 == 0 { a.min(b) } else { a.max(b) });
        }
        let region = Region { lower, upper };
        let bound = problem.bounds().unwrap().lower_bound(&region).unwrap();
        for _ in 0..20 {
            let values: Vec<f64> = (region.lower.iter().zip(&region.upper))
                .map(|(&a, &b)| draw(a, b))
                .collect();
            let fitness = problem.fitness(&problem.decode(&values));
            assert!(
                bound <= fitness,
                "{bound} > {fitness} at {values:?} in {region:?}"
            );
            if trial % 4 == 0 {
                assert_eq!(bound, fitness);
            }
        }
    }
}

#[test]
fn rastrigin() {
    let formula = |m: f64| {
        move |cells: &[f64]| -> f64 {
            let x = cells.iter().map(|k| -2.56 + 5.12 * (k + 0.5) / m);
            x.map(|x| x.powi(2) + 10.0 - 10.0 * (2.0 * PI * x).cos()).sum()
        }
    };
    fitness_is(&problem::<Rastrigin>(&[]), formula(24.0));
    for (dimension, m, threshold, hits) in [
        ("2", 1000, 4.0, 15_136),
        ("3", 100, 6.0, 3_184),
        ("4", 40, 8.0, 1_664),
        ("5", 24, 14.0, 6_624),
        ("6", 14, 20.0, 4_992),
    ] {
        let rastrigin = problem::<Rastrigin>(&[("dimension", dimension)]);
        bounds_are_sound(&rastrigin);
        assert_eq!(
            (rastrigin.threshold(), rastrigin.reference_hits()),
            (threshold, Some(hits))
        );
        // Terms are not negative: partial sums that reach the level are cut, which visits few of the m^D points.
        let one = formula(f64::from(m));
        let terms: Vec<f64> = (0..m).map(|k| one(&[f64::from(k)])).collect();
        assert_eq!(cut_count(&terms, dimension.parse().unwrap(), threshold), hits);
    }
    let small = problem::<Rastrigin>(&[("dimension", "2"), ("cells", "50")]);
    assert_eq!(small.reference_hits(), count_hits(&small, ENUMERABLE));
    assert_eq!(
        problem::<Rastrigin>(&[("dimension", "7"), ("cells", "50"), ("threshold", "1")]).reference_hits(),
        None
    );
}

fn cut_count(terms: &[f64], dimension: u32, rest: f64) -> u64 {
    if dimension == 0 {
        return u64::from(rest > 0.0);
    }
    let left = terms.iter().map(|term| rest - term).filter(|left| *left > 0.0);
    left.map(|left| cut_count(terms, dimension - 1, left)).sum()
}

#[test]
fn shell() {
    fitness_is(&problem::<Shell>(&[]), |cells| {
        let square: f64 = cells
            .iter()
            .map(|k| (-1.0 + 2.0 * (k + 0.5) / 40.0).powi(2))
            .sum();
        (square.sqrt() - 0.7).abs()
    });
    for (dimension, m, threshold, hits) in [
        (2, 1000, 0.003, 6_636),
        (4, 40, 0.02, 47_360),
        (6, 14, 0.03, 36_224),
    ] {
        let shell = problem::<Shell>(&[("dimension", &dimension.to_string())]);
        bounds_are_sound(&shell);
        assert_eq!(
            (shell.threshold(), shell.reference_hits()),
            (threshold, Some(hits))
        );
        // In whole numbers: the centre is (2 k + 1 - m) / m, so the square of its length is a whole number over m^2. How
        // many points have each of them is a convolution.
        let mut squares = vec![1_u64];
        for _ in 0..dimension {
            let mut next = vec![0; squares.len() + m * m];
            for k in 0..m {
                let odd = (2 * k + 1).abs_diff(m);
                for (square, count) in squares.iter().enumerate() {
                    next[square + odd * odd] += count;
                }
            }
            squares = next;
        }
        let inside = |square: usize| ((square as f64).sqrt() / m as f64 - 0.7).abs() < threshold;
        let count: u64 = (0..squares.len())
            .filter(|s| inside(*s))
            .map(|s| squares[s])
            .sum();
        assert_eq!(count, hits);
    }
}

#[test]
fn islands() {
    let islands = problem::<Islands>(&[]);
    let corners: Vec<Vec<f64>> = (0_u32..16)
        .filter(|corner| corner.count_ones() % 2 == 0)
        .map(|corner| {
            (0..4)
                .map(|j| if corner >> j & 1 == 1 { 0.75 } else { 0.25 })
                .collect()
        })
        .collect();
    fitness_is(&islands, |cells| {
        let distance = |corner: &Vec<f64>| {
            let square: f64 = cells
                .iter()
                .zip(corner)
                .map(|(k, c)| ((k + 0.5) / 40.0 - c).powi(2))
                .sum();
            square.sqrt()
        };
        corners.iter().map(distance).fold(f64::INFINITY, f64::min)
    });
    bounds_are_sound(&islands);
    // Centres are corners of cells: a ball holds the quadruples of odd numbers whose squares sum to less than 8^2.
    let odd = || (-7_i32..8).step_by(2);
    let mut ball = 0;
    for a in odd() {
        for b in odd() {
            for c in odd() {
                ball += odd().filter(|d| a * a + b * b + c * c + d * d < 64).count() as u64;
            }
        }
    }
    assert_eq!((ball, islands.reference_hits()), (1_312, Some(8 * 1_312)));
}

#[test]
fn needles() {
    let needles = problem::<Needles>(&[]);
    // 2,000 are expected with a deviation of 45.
    assert_eq!(needles.reference_hits(), Some(2_026));
    let other = problem::<Needles>(&[("hash-seed", "1"), ("cells", "100"), ("threshold", "0.5")]);
    let count = other.reference_hits().unwrap();
    assert!(count.abs_diff(5_000) < 5 * 50, "{count}");
}

#[test]
fn arm() {
    for (links, m, hits) in [(3_i32, 100.0, 128), (4, 50.0, 2_724), (5, 24.0, 11_667)] {
        let arm = problem::<Arm>(&[("links", &links.to_string())]);
        assert_eq!(arm.reference_hits(), Some(hits));
        let formula = |cells: &[f64]| {
            let (mut angle, mut x, mut y) = (0.0, -0.45, -0.2);
            for k in cells {
                angle += -PI + 2.0 * PI * (k + 0.5) / m;
                x += f64::cos(angle) / f64::from(links);
                y += f64::sin(angle) / f64::from(links);
            }
            f64::hypot(x, y)
        };
        fitness_is(&arm, formula);
        if links < 5 {
            assert_eq!(count_hits(&arm, ENUMERABLE), Some(hits));
        }
    }
    let arm = problem::<Arm>(&[]);
    let joints = arm.joints(&[3, 60, 7]);
    let [x, y] = joints[3];
    assert_relative_eq!(arm.fitness(&vec![3, 60, 7]), (x - 0.45).hypot(y - 0.2));
    assert!(arm.joints(&[100, 0, 0]).is_empty());
}

#[test]
fn sallen_key() {
    let filter = problem::<SallenKey>(&[]);
    // The E series are rounded geometric ones but for some historical values.
    let solution = vec![0, 23, 0, 11];
    let parts = filter.parts(&solution).unwrap();
    assert_eq!(parts.resistances, [1e3, 9.1e3]);
    assert_relative_eq!(parts.capacitances[1], 8.2e-9);
    let series = |k: f64, n: f64, unit: f64| unit * 10_f64.powf(k / n);
    let mut rng = SearchRng::new(5);
    for _ in 0..2_000 {
        let cells = vec![
            rng.below(72) as u32,
            rng.below(72) as u32,
            rng.below(36) as u32,
            rng.below(36) as u32,
        ];
        let parts = filter.parts(&cells).unwrap();
        for i in 0..2 {
            assert_relative_eq!(
                parts.resistances[i],
                series(f64::from(cells[i]), 24.0, 1e3),
                max_relative = 0.05
            );
            assert_relative_eq!(
                parts.capacitances[i],
                series(f64::from(cells[2 + i]), 12.0, 1e-9),
                max_relative = 0.06
            );
        }
        // The textbook's time constants.
        let ([r1, r2], [c1, c2]) = (parts.resistances, parts.capacitances);
        let omega = 1.0 / ((r1 * c1).sqrt() * (r2 * c2).sqrt());
        let quality = 1.0 / (omega * c2 * (r1 + r2));
        let f = ((omega / (2.0 * PI)).ln() - 1000_f64.ln()).abs() / 0.01;
        let q = (quality.ln() - 0.7071_f64.ln()).abs() / 0.02;
        assert_relative_eq!(
            filter.fitness(&cells),
            f.max(q),
            max_relative = 1e-9,
            epsilon = 1e-9
        );
    }
    assert_eq!(filter.reference_hits(), Some(138));
    // Q depends on R1 and R2 alike: hits come in pairs but for those with R1 = R2. One half of the lattice, in logarithms.
    let log = |cells: u32, of: fn(&SallenKey, u32) -> f64| {
        (0..cells).map(|k| of(&filter, k).ln()).collect::<Vec<_>>()
    };
    let r = log(72, |f, k| f.parts(&[k, 0, 0, 0]).unwrap().resistances[0]);
    let c = log(36, |f, k| f.parts(&[0, 0, k, 0]).unwrap().capacitances[0]);
    let mut count = 0;
    for (i, r1) in r.iter().enumerate() {
        for (j, r2) in r.iter().enumerate().skip(i) {
            let sum = (r1.exp() + r2.exp()).ln();
            for c1 in &c {
                for c2 in &c {
                    let root = 0.5 * (r1 + r2 + c1 + c2);
                    let frequency = (-root - (2.0 * PI * 1000.0).ln()).abs();
                    let quality = (root - c2 - sum - 0.7071_f64.ln()).abs();
                    if frequency < 0.01 && quality < 0.02 {
                        count += if i == j { 1 } else { 2 };
                    }
                }
            }
        }
    }
    assert_eq!(count, 138);
}

#[test]
fn falsification() {
    let falsification = problem::<Falsification>(&[]);
    let input = |k: f64| -1.0 + (2.0 * k + 1.0) / 20.0;
    fitness_is(&falsification, |cells| {
        let (mut x, mut v) = (0.0_f64, 0.0_f64);
        let mut greatest = 0.0_f64;
        for step in 0..100 {
            let acceleration = -x - 0.3 * v + input(cells[step / 20]);
            v += 0.08 * acceleration;
            x += 0.08 * v;
            greatest = greatest.max(x.abs());
        }
        2.25 - greatest
    });
    assert_eq!(falsification.trajectory(&[0, 1, 2, 3, 4]).len(), 100);
    assert_eq!(falsification.reference_hits(), Some(8_662));
    // The same tree of inputs, simulated once per prefix.
    assert_eq!(falsified(0, 0.0, 0.0, &input), 8_662);
    let coarse = problem::<Falsification>(&[("levels", "6"), ("limit", "2")]);
    assert_eq!(coarse.reference_hits(), count_hits(&coarse, ENUMERABLE));
}

fn falsified(depth: u32, x: f64, v: f64, input: &dyn Fn(f64) -> f64) -> u64 {
    let mut count = 0;
    for level in 0..20_u32 {
        let u = input(f64::from(level));
        let (mut x, mut v, mut out) = (x, v, false);
        for _ in 0..20 {
            v += 0.08 * (-x - 0.3 * v + u);
            x += 0.08 * v;
            out |= x.abs() > 2.25;
        }
        count += match (out, depth) {
            (true, _) => 20_u64.pow(4 - depth),
            (false, 4) => 0,
            (false, _) => falsified(depth + 1, x, v, input),
        };
    }
    count
}

#[test]
fn queens() {
    for (n, hits) in [
        (1, 1),
        (2, 0),
        (3, 0),
        (4, 2),
        (5, 10),
        (6, 4),
        (7, 40),
        (8, 92),
        (9, 352),
        (10, 724),
    ] {
        assert_eq!(Queens::new(n).unwrap().reference_hits(), Some(hits));
    }
    for n in [4, 5, 6, 7] {
        let queens = Queens::new(n).unwrap();
        assert_eq!(count_hits(&queens, ENUMERABLE), queens.reference_hits());
    }
    fitness_is(&problem::<Queens>(&[]), |rows| {
        let attacked = |i: usize, j: usize| {
            let (across, up) = (j as f64 - i as f64, rows[j] - rows[i]);
            up == 0.0 || up == across || up == -across
        };
        (0..8)
            .map(|i| (i + 1..8).filter(|&j| attacked(i, j)).count())
            .sum::<usize>() as f64
    });
    let queens = problem::<Queens>(&[]);
    let neighbourhood = queens.neighbourhood().unwrap();
    let mut neighbours: Vec<_> = (0..neighbourhood.count(&vec![0; 8]))
        .map(|index| neighbourhood.neighbour(&vec![0; 8], index).unwrap())
        .collect();
    neighbours.sort_unstable();
    neighbours.dedup();
    assert_eq!(neighbours.len(), 8 * 7);
    assert!(Queens::new(0).is_err());
}

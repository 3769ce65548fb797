//! The CEC2013 suite: optima against the published numbers, compositions with shifts and rotations of our own, scoring.
//! With `SATISFICE_DATA` naming a folder that has `cec2013/`, the suite's own data is used too.
#![allow(clippy::unwrap_used, missing_docs)]

use approx::{assert_abs_diff_eq, assert_relative_eq};
use satisfice::catalogue::Catalogued;
use satisfice::{SatisficingProblem, SearchRng, testing};
use satisfice_problems::{Cec2013, SuiteData, peak_ratio};

const OPTIMA: [usize; 20] = [2, 5, 1, 4, 2, 18, 36, 81, 216, 12, 6, 8, 6, 6, 8, 6, 8, 6, 8, 8];
const DIMENSIONS: [usize; 10] = [2, 2, 2, 3, 3, 5, 5, 10, 10, 20];
const PARTS: [usize; 10] = [6, 8, 6, 6, 8, 6, 8, 6, 8, 8];

/// Random shifts inside the box, and rotations by Gram-Schmidt.
fn own_data(problem: usize, seed: u64) -> SuiteData {
    let (parts, dimension) = (PARTS[problem - 11], DIMENSIONS[problem - 11]);
    let mut rng = SearchRng::new(seed);
    let shifts = (0..parts)
        .map(|_| (0..dimension).map(|_| 9.0 * rng.uniform() - 4.5).collect())
        .collect();
    let mut rotation = || {
        let mut rows: Vec<Vec<f64>> = Vec::new();
        while rows.len() < dimension {
            let mut row: Vec<f64> = (0..dimension).map(|_| rng.normal()).collect();
            for other in &rows {
                let dot: f64 = row.iter().zip(other).map(|(a, b)| a * b).sum();
                row.iter_mut().zip(other).for_each(|(a, b)| *a -= dot * b);
            }
            let length = row.iter().map(|a| a * a).sum::<f64>().sqrt();
            row.iter_mut().for_each(|a| *a /= length);
            rows.push(row);
        }
        rows
    };
    let rotations = if problem < 13 {
        Vec::new()
    } else {
        (0..parts).map(|_| rotation()).collect()
    };
    SuiteData { shifts, rotations }
}

fn all() -> Vec<Cec2013> {
    let simple = (1..=10).map(|k| Cec2013::new(k, 1e-4, "").unwrap());
    let composed = (11..=20).map(|k| Cec2013::with_data(k, 1e-4, own_data(k, k as u64)).unwrap());
    simple.chain(composed).collect()
}

/// Every known optimum has the height of the peak, is inside, is farther than the niche radius from the others, and is a
/// local maximum.
fn optima_are_optima(problem: &Cec2013, number: usize) {
    let optima = problem.optima();
    assert_eq!(optima.len(), OPTIMA[number - 1], "problem {number}");
    assert_eq!(problem.reference_hits(), Some(optima.len() as u64));
    let mut rng = SearchRng::new(1);
    for (k, place) in optima.iter().enumerate() {
        assert!(problem.space().contains(place));
        // The peak of F3 was published as 1; Shubert's peaks have 16 digits.
        let tolerance = if number == 3 { 2e-7 } else { 1e-9 };
        assert_abs_diff_eq!(problem.height(place), problem.peak(), epsilon = tolerance);
        for other in &optima[..k] {
            let square: f64 = place.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum();
            assert!(
                square.sqrt() > problem.radius(),
                "problem {number}: {place:?} {other:?}"
            );
        }
        for _ in 0..20 {
            let mut near: Vec<f64> = place.iter().map(|x| x + 1e-4 * rng.normal()).collect();
            problem.space().keep_inside(&mut near);
            assert!(
                problem.height(&near) <= problem.height(place) + 1e-9,
                "problem {number} at {near:?}"
            );
        }
    }
}

#[test]
fn known_optima() {
    let mut sum = 0;
    for (number, problem) in (1..).zip(all()) {
        optima_are_optima(&problem, number);
        sum += problem.optima().len();
        assert_eq!(testing::problem::check(&problem, 1), [], "problem {number}");
    }
    assert_eq!(sum, 447);
}

/// No point of a fine grid is above the peak, and the points near it are near known optima.
#[test]
fn there_is_nothing_above_the_peaks() {
    for number in [1, 2, 3, 4, 5, 6, 7, 10] {
        let problem = Cec2013::new(number, 1e-4, "").unwrap();
        let optima = problem.optima();
        let axes = problem.space().axes();
        let steps = if axes.len() == 1 { 20_000 } else { 700 };
        let at = |axis: usize, k: usize| axes[axis].lower() + axes[axis].width() * k as f64 / steps as f64;
        for k in 0..=steps {
            for l in 0..=if axes.len() == 1 { 0 } else { steps } {
                let x: Vec<f64> = [(0, k), (1, l)]
                    .iter()
                    .take(axes.len())
                    .map(|&(axis, k)| at(axis, k))
                    .collect();
                let height = problem.height(&x);
                assert!(
                    height <= problem.peak() + 1e-9,
                    "problem {number}: {height} at {x:?}"
                );
                // High points belong to a known optimum.
                if height > problem.peak() - 1e-3 * problem.peak().abs() {
                    let distance = |place: &Vec<f64>| {
                        place
                            .iter()
                            .zip(&x)
                            .map(|(a, b)| (a - b).powi(2))
                            .sum::<f64>()
                            .sqrt()
                    };
                    let nearest = optima.iter().map(distance).fold(f64::INFINITY, f64::min);
                    assert!(
                        nearest < 0.2,
                        "problem {number}: {height} at {x:?}, {nearest} away"
                    );
                }
            }
        }
    }
}

/// The composition written plainly from its definition, without tables and shortcuts.
fn plain(number: usize, data: &SuiteData, x: &[f64]) -> f64 {
    use std::f64::consts::PI;
    let sphere = |z: &[f64]| z.iter().map(|z| z * z).sum::<f64>();
    let griewank = |z: &[f64]| {
        let mut product = 1.0;
        for (i, z) in z.iter().enumerate() {
            product *= (z / ((i + 1) as f64).sqrt()).cos();
        }
        z.iter().map(|z| z * z / 4000.0).sum::<f64>() - product + 1.0
    };
    let rastrigin = |z: &[f64]| {
        z.iter()
            .map(|z| z * z - 10.0 * (2.0 * PI * z).cos() + 10.0)
            .sum::<f64>()
    };
    let weierstrass = |z: &[f64]| {
        let mut sum = 0.0;
        for z in z {
            for k in 0..=20 {
                let (a, b) = (0.5_f64.powi(k), 3.0_f64.powi(k));
                sum += a * (2.0 * PI * b * (z + 0.5)).cos() - a * (2.0 * PI * b * 0.5).cos();
            }
        }
        sum
    };
    let ef8f2 = |z: &[f64]| {
        let mut sum = 0.0;
        for i in 0..z.len() {
            let (x, y) = (z[i] + 1.0, z[(i + 1) % z.len()] + 1.0);
            let f2 = 100.0 * (x * x - y) * (x * x - y) + (1.0 - x) * (1.0 - x);
            sum += f2 * f2 / 4000.0 - f2.cos() + 1.0;
        }
        sum
    };
    type Basic<'a> = &'a dyn Fn(&[f64]) -> f64;
    let (s, g, r, w, e): (Basic<'_>, Basic<'_>, Basic<'_>, Basic<'_>, Basic<'_>) =
        (&sphere, &griewank, &rastrigin, &weierstrass, &ef8f2);
    let (functions, sigma, lambda) = match number {
        11 => (
            vec![g, g, w, w, s, s],
            vec![1.0; 6],
            vec![1.0, 1.0, 8.0, 8.0, 0.2, 0.2],
        ),
        12 => (
            vec![r, r, w, w, g, g, s, s],
            vec![1.0; 8],
            vec![1.0, 1.0, 10.0, 10.0, 0.1, 0.1, 1.0 / 7.0, 1.0 / 7.0],
        ),
        13 | 14 | 16 | 18 => (
            vec![e, e, w, w, g, g],
            vec![1.0, 1.0, 2.0, 2.0, 2.0, 2.0],
            vec![0.25, 0.1, 2.0, 1.0, 2.0, 5.0],
        ),
        _ => (
            vec![r, r, e, e, w, w, g, g],
            vec![1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0],
            vec![4.0, 1.0, 4.0, 1.0, 0.1, 0.2, 0.1, 0.025],
        ),
    };
    let n = functions.len();
    let d = x.len();
    let z = |i: usize, y: &[f64]| -> Vec<f64> {
        let y: Vec<f64> = y.iter().map(|y| y / lambda[i]).collect();
        match data.rotations.get(i) {
            None => y,
            Some(m) => (0..d)
                .map(|column| (0..d).map(|row| y[row] * m[row][column]).sum())
                .collect(),
        }
    };
    let mut weights: Vec<f64> = (0..n)
        .map(|i| {
            let square: f64 = (0..d).map(|j| (x[j] - data.shifts[i][j]).powi(2)).sum();
            (-square / (2.0 * d as f64 * sigma[i] * sigma[i])).exp()
        })
        .collect();
    let largest = weights.iter().copied().fold(0.0, f64::max);
    for weight in &mut weights {
        if *weight != largest {
            *weight *= 1.0 - largest.powi(10);
        }
    }
    let sum: f64 = weights.iter().sum();
    (0..n)
        .map(|i| {
            let weight = if sum == 0.0 {
                1.0 / n as f64
            } else {
                weights[i] / sum
            };
            let moved: Vec<f64> = (0..d).map(|j| x[j] - data.shifts[i][j]).collect();
            let most = functions[i](&z(i, &vec![5.0; d])).abs();
            -weight * 2000.0 * functions[i](&z(i, &moved)) / most
        })
        .sum()
}

fn folder() -> Option<String> {
    let folder = std::path::PathBuf::from(std::env::var_os("SATISFICE_DATA")?).join("cec2013");
    folder.is_dir().then(|| folder.to_str().unwrap().to_owned())
}

#[test]
fn compositions_follow_their_definition() {
    let mut rng = SearchRng::new(9);
    for number in 11..=20 {
        let data = own_data(number, 77);
        let problem = Cec2013::with_data(number, 1e-4, data.clone()).unwrap();
        for _ in 0..30 {
            let mut x: Vec<f64> = problem
                .space()
                .axes()
                .iter()
                .map(|a| a.at(rng.uniform()))
                .collect();
            assert_relative_eq!(
                problem.height(&x),
                plain(number, &data, &x),
                max_relative = 1e-9,
                epsilon = 1e-9
            );
            // Near an optimum, where one weight is close to 1.
            x.clone_from(&data.shifts[rng.below(data.shifts.len())]);
            x[0] += 1e-3 * rng.normal();
            assert_relative_eq!(
                problem.height(&x),
                plain(number, &data, &x),
                max_relative = 1e-9,
                epsilon = 1e-9
            );
        }
    }
}

#[test]
fn the_suites_own_data() {
    let Some(folder) = folder() else {
        println!("SATISFICE_DATA names no folder with `cec2013`: the suite's own data is not tested");
        return;
    };
    for number in 11..=20 {
        let problem = Cec2013::new(number, 1e-4, &folder).unwrap();
        optima_are_optima(&problem, number);
    }
    // The optima of F1 to F8 as the suite lists them.
    for (number, file) in [
        (1, "F1"),
        (2, "F2"),
        (3, "F3"),
        (4, "F4"),
        (5, "F5"),
        (6, "F6_2D"),
        (7, "F7_2D"),
        (8, "F6_3D"),
        (9, "F7_3D"),
        (10, "F8_2D"),
    ] {
        let text = std::fs::read_to_string(format!("{folder}/{file}_opt.dat")).unwrap();
        let listed: Vec<Vec<f64>> = text
            .lines()
            .map(|line| line.split_whitespace().map(|w| w.parse().unwrap()).collect())
            .collect();
        let problem = Cec2013::new(number, 1e-4, "").unwrap();
        for place in &listed {
            assert!(
                problem.height(place) > problem.peak() - 1e-4,
                "problem {number} at {place:?}"
            );
        }
        assert_eq!(
            problem.score(&listed, 1e-4).by_place,
            OPTIMA[number - 1],
            "problem {number}"
        );
    }
}

#[test]
fn scoring_closes_the_hole() {
    // 50 points round one optimum of Himmelblau's function, within 0.1 of its height.
    let himmelblau = Cec2013::new(4, 1e-1, "").unwrap();
    let crowd: Vec<Vec<f64>> = (0..50)
        .map(|k| {
            let angle = f64::from(k) * std::f64::consts::TAU / 49.0;
            let away = if k == 49 { 0.0 } else { 0.03 };
            vec![3.0 + away * angle.cos(), 2.0 + away * angle.sin()]
        })
        .collect();
    let score = himmelblau.score(&crowd, 1e-1);
    assert_eq!(
        (score.by_height, score.by_place, score.known, score.submitted),
        (4, 1, 4, 50)
    );
    assert_eq!(himmelblau.reference_hits(), None);
    let all = himmelblau.score(&himmelblau.optima(), 1e-5);
    assert_eq!((all.by_height, all.by_place), (4, 4));
    assert_eq!(peak_ratio(&[score, all]), 5.0 / 8.0);
    // Malformed points do no harm.
    let odd = himmelblau.score(&[vec![], vec![f64::NAN, 0.0], vec![1.0, 2.0, 3.0]], 1e-5);
    assert_eq!((odd.by_height, odd.by_place, odd.submitted), (0, 0, 3));
}

#[test]
fn missing_and_malformed_data() {
    let error = |problem: usize, data: &str| Cec2013::new(problem, 1e-4, data).unwrap_err().to_string();
    assert_eq!(
        error(12, ""),
        "data is missing: problem 12 needs the folder `data` of https://github.com/mikeagn/CEC2013; set data=DIR"
    );
    let unread = error(11, "no/such/folder");
    assert!(
        unread.starts_with("cannot read no/such/folder/optima.dat: ") && unread.contains("https://"),
        "{unread}"
    );
    assert!(error(0, "").contains("from 1 to 20") && error(21, "").contains("from 1 to 20"));
    assert!(Cec2013::new(1, 0.0, "").is_err() && Cec2013::new(1, f64::NAN, "").is_err());
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    std::fs::write(folder.join("optima.dat"), "1 2\n3 x\n").unwrap();
    assert!(error(11, folder.to_str().unwrap()).contains("numbers, not `x`"));
    std::fs::write(folder.join("optima.dat"), "1 2\n3 4\n").unwrap();
    assert!(error(11, folder.to_str().unwrap()).contains("at least 6 rows and 2 columns"));
    let mut data = own_data(13, 1);
    data.rotations.pop();
    assert!(Cec2013::with_data(13, 1e-4, data).is_err());
}

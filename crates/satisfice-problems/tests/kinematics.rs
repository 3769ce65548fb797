//! Arms: forward kinematics against products of matrices, postures against random restarts, counts against enumeration.
#![allow(clippy::unwrap_used, missing_docs)]

use approx::assert_relative_eq;
use satisfice::catalogue::Catalogued;
use satisfice::{Located, SatisficingProblem, SearchRng};
use satisfice_problems::{ENUMERABLE, Puma, SevenJoints, count_hits};

type Matrix = [[f64; 4]; 4];

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
}

fn rotation(axis: usize, angle: f64) -> Matrix {
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut m: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    (m[i][i], m[i][j], m[j][i], m[j][j]) = (angle.cos(), -angle.sin(), angle.sin(), angle.cos());
    m
}

fn translation(x: f64, y: f64, z: f64) -> Matrix {
    [
        [1.0, 0.0, 0.0, x],
        [0.0, 1.0, 0.0, y],
        [0.0, 0.0, 1.0, z],
        [0.0, 0.0, 0.0, 1.0],
    ]
}

fn chain(parts: &[Matrix]) -> Matrix {
    parts
        .iter()
        .fold(translation(0.0, 0.0, 0.0), |product_so_far, part| {
            product(&product_so_far, part)
        })
}

#[test]
fn seven_joints_by_matrices() {
    let arm = SevenJoints::new(10, 0.03).unwrap();
    let mut rng = SearchRng::new(4);
    for _ in 0..1000 {
        let cells: Vec<u32> = (0..7).map(|_| rng.below(10) as u32).collect();
        let q = arm.angles(&cells);
        let tool = chain(&[
            rotation(2, q[0]),
            translation(0.0, 0.0, 0.34),
            rotation(1, q[1]),
            rotation(2, q[2]),
            translation(0.0, 0.0, 0.4),
            rotation(1, -q[3]),
            rotation(2, q[4]),
            translation(0.0, 0.0, 0.4),
            rotation(1, q[5]),
            rotation(2, q[6]),
            translation(0.1, 0.0, 0.126),
        ]);
        let square = (tool[0][3] - 0.45).powi(2) + (tool[1][3] - 0.2).powi(2) + (tool[2][3] - 0.5).powi(2);
        assert_relative_eq!(
            arm.fitness(&cells),
            square.sqrt(),
            max_relative = 1e-9,
            epsilon = 1e-12
        );
        let degrees = q[3].to_degrees();
        assert!(degrees.abs() < 120.0 && (degrees / 12.0 - (degrees / 12.0).round()).abs() < 1e-9);
    }
    assert!(arm.fitness(&vec![10; 7]).is_nan() && arm.joints(&[]).is_empty());
    let coarse = SevenJoints::new(5, 0.1).unwrap();
    assert_eq!(coarse.reference_hits(), count_hits(&coarse, ENUMERABLE));
}

/// The pose by Denavit-Hartenberg matrices written as products of elementary motions.
fn puma_pose(q: &[f64]) -> Matrix {
    let half = std::f64::consts::FRAC_PI_2;
    let link = |q: f64, d: f64, a: f64, twist: f64| {
        chain(&[
            rotation(2, q),
            translation(0.0, 0.0, d),
            translation(a, 0.0, 0.0),
            rotation(0, twist),
        ])
    };
    chain(&[
        link(q[0], 0.0, 0.0, half),
        link(q[1], 0.0, 0.4318, 0.0),
        link(q[2], 0.15005, 0.0203, -half),
        link(q[3], 0.4318, 0.0, half),
        link(q[4], 0.0, 0.0, -half),
        link(q[5], 0.0, 0.0, 0.0),
    ])
}

/// A long flat valley by a singular posture: steps of Gauss and Newton lead nowhere there, damped ones to a posture.
#[test]
fn puma_is_polished_from_a_flat_valley() {
    let puma = Puma::new(0.02, 0.1).unwrap();
    let start = [
        0.3455667895502276,
        1.17862266004019,
        -1.523819513514828,
        -2.470561846239462,
        -1.0949328789059567,
        2.9480088150525643,
    ];
    assert!(puma.fitness(&puma.decode(&start)) < puma.threshold());
    let start = puma.decode(&start);
    let end = puma.canonical(&start).unwrap_or(start);
    assert!(puma.fitness(&end) < 1e-18, "{} at {end:?}", puma.fitness(&end));
}

#[test]
fn puma_has_eight_postures() {
    let puma = Puma::new(0.02, 0.1).unwrap();
    let wanted = puma_pose(&[0.4, 0.6, -0.5, 0.9, 0.8, -0.6]);
    let mut rng = SearchRng::new(8);
    let mut postures: Vec<Vec<f64>> = Vec::new();
    for _ in 0..2000 {
        let start: Vec<f64> = puma
            .space()
            .axes()
            .iter()
            .map(|axis| axis.at(rng.uniform()))
            .collect();
        let here = puma_pose(&start);
        let square: f64 = (0..3)
            .flat_map(|i| (0..4).map(move |j| (i, j)))
            .map(|(i, j)| (here[i][j] - wanted[i][j]).powi(2))
            .sum();
        assert_relative_eq!(puma.fitness(&puma.decode(&start)), square, max_relative = 1e-9);
        // From anywhere, the damped steps end at a posture or at a local minimum far above the threshold.
        let start = puma.decode(&start);
        let end = puma.canonical(&start).unwrap_or(start);
        let fitness = puma.fitness(&end);
        assert!(!(1e-18..0.02).contains(&fitness), "{fitness} at {end:?}");
        let apart = |other: &Vec<f64>| {
            // Around the turn, too.
            let along = |(a, b): (&f64, &f64)| {
                let d = (a - b).abs();
                d.min(std::f64::consts::TAU - d)
            };
            other.iter().zip(&end.coordinates).map(along).fold(0.0, f64::max) > 1e-6
        };
        if fitness < 1e-18 && postures.iter().all(apart) {
            postures.push(end.coordinates);
        }
    }
    assert_eq!(Some(postures.len() as u64), puma.reference_hits());
    // None is at the end of the axes, where one posture could count twice; and all are well separated.
    for (k, posture) in postures.iter().enumerate() {
        assert!(posture.iter().all(|angle| angle.abs() < 3.1), "{posture:?}");
        let distance = |other: &Vec<f64>| {
            other
                .iter()
                .zip(posture)
                .map(|(a, b)| (a - b).powi(2))
                .sum::<f64>()
                .sqrt()
        };
        assert!(postures[..k].iter().all(|other| distance(other) > 0.5));
    }
    assert!(puma.fitness(&Located::new(&[0.0], 0.1)).is_nan());
    assert_eq!(Puma::new(1.0, 0.1).unwrap().reference_hits(), None);
}

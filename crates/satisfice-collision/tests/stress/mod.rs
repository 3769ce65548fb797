//! Shared by the distance tests and the printed study: the referee, the families of hard cases, the moves that must not
//! change an answer.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used)]

pub mod families;
pub mod fuzzing;
pub mod referee;

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::Rng;
use satisfice_collision::Shape;
use satisfice_collision::distance::{self, Decision, PairKind, Proximity, Threshold};

pub type Point = [f64; 3];

/// How many points of each triangle a kind of pair takes.
pub fn sizes(kind: PairKind) -> (usize, usize) {
    let (a, b) = kind.features();
    (a.corners(), b.corners())
}

fn shapes(kind: PairKind, a: &[Point], b: &[Point]) -> (Shape, Shape) {
    let (kind_a, kind_b) = kind.features();
    (Shape::new(kind_a, |k| a[k]), Shape::new(kind_b, |k| b[k]))
}

/// The decision of the crate.
pub fn decide(kind: PairKind, a: &[Point], b: &[Point], delta: f64) -> Decision {
    let (a, b) = shapes(kind, a, b);
    distance::decide(&a, &b, Threshold::new(delta).unwrap())
}

/// The proximity of the crate.
pub fn proximity(kind: PairKind, a: &[Point], b: &[Point]) -> Proximity {
    let (a, b) = shapes(kind, a, b);
    distance::proximity(&a, &b)
}

/// Uniform on 0..n.
pub fn below(rng: &mut Xoshiro256PlusPlus, n: u64) -> u64 {
    ((u128::from(rng.next_u64()) * u128::from(n)) >> 64) as u64
}

/// Uniform on [-1, 1), multiples of 2^-52.
pub fn unit(rng: &mut Xoshiro256PlusPlus) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// All orders of up to three points.
pub fn orders(points: &[Point]) -> Vec<Vec<Point>> {
    match *points {
        [p, q] => vec![vec![p, q], vec![q, p]],
        [p, q, r] => vec![
            vec![p, q, r],
            vec![q, r, p],
            vec![r, p, q],
            vec![p, r, q],
            vec![r, q, p],
            vec![q, p, r],
        ],
        _ => vec![points.to_vec()],
    }
}

/// A motion without rounding: axes permuted, signs flipped.
#[derive(Debug, Clone, Copy)]
pub struct Motion {
    axes: [usize; 3],
    signs: [f64; 3],
}

impl Motion {
    /// One of the 48.
    pub fn random(rng: &mut Xoshiro256PlusPlus) -> Self {
        let axes = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]][below(rng, 6) as usize];
        let bits = rng.next_u64();
        Self {
            axes,
            signs: [0, 1, 2].map(|k| if bits >> k & 1 == 0 { 1.0 } else { -1.0 }),
        }
    }

    pub fn apply(&self, points: &[Point]) -> Vec<Point> {
        points
            .iter()
            .map(|p| [0, 1, 2].map(|k| p[self.axes[k]] * self.signs[k]))
            .collect()
    }
}

/// The points times `2^exponent`, if that rounds nothing.
pub fn scaled(points: &[Point], exponent: i32) -> Option<Vec<Point>> {
    let (up, down) = (2f64.powi(exponent), 2f64.powi(-exponent));
    let all: Vec<Point> = points.iter().map(|p| p.map(|x| x * up)).collect();
    let same = all
        .iter()
        .flatten()
        .zip(points.iter().flatten())
        .all(|(y, x)| y.is_finite() && y * down == *x);
    same.then_some(all)
}

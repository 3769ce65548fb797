//! Motions whose answer is known by construction, at any scale.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use satisfice_collision::continuous::{Decided, Impact, Moving, Separation, decide, impact};

/// The exponents of the powers of two by which motions are scaled.
pub(crate) const SCALES: [i32; 25] = [
    -498, -400, -300, -200, -100, -60, -40, -30, -20, -10, -5, -1, 0, 1, 5, 10, 20, 30, 40, 60, 100, 200,
    300, 400, 498,
];

type Point = [f64; 3];

/// A vertex and a triangle, or two edges, at both ends of a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Query {
    pub(crate) is_edges: bool,
    pub(crate) from: [Point; 4],
    pub(crate) to: [Point; 4],
}

impl Query {
    pub(crate) fn decide(&self) -> Decided {
        let ([a, b, c, d], [p, q, r, s]) = (self.from, self.to);
        if self.is_edges {
            decide(
                &Moving::new([a, b], [p, q]),
                &Moving::new([c, d], [r, s]),
                Separation::TOUCHING,
            )
        } else {
            decide(
                &Moving::new(a, p),
                &Moving::new([b, c, d], [q, r, s]),
                Separation::TOUCHING,
            )
        }
    }

    pub(crate) fn impact(&self) -> Option<Impact> {
        let ([a, b, c, d], [p, q, r, s]) = (self.from, self.to);
        let found = if self.is_edges {
            impact(
                &Moving::new([a, b], [p, q]),
                &Moving::new([c, d], [r, s]),
                Separation::TOUCHING,
                1e-6,
            )
        } else {
            impact(
                &Moving::new(a, p),
                &Moving::new([b, c, d], [q, r, s]),
                Separation::TOUCHING,
                1e-6,
            )
        };
        found.expect("a tolerance")
    }

    fn map(&self, f: impl Fn(Point) -> Point) -> Self {
        Self {
            from: self.from.map(&f),
            to: self.to.map(&f),
            ..*self
        }
    }
}

pub(crate) struct Source {
    rng: Xoshiro256PlusPlus,
}

impl Source {
    pub(crate) fn new(seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
        }
    }

    fn below(&mut self, n: u64) -> u64 {
        self.rng.next_u64() % n
    }

    /// A multiple of 2^-10 from -8 to 8.
    fn number(&mut self) -> f64 {
        self.below(16 * 1024 + 1) as f64 / 1024.0 - 8.0
    }

    fn point(&mut self, dimensions: usize) -> Point {
        std::array::from_fn(|k| if k < dimensions { self.number() } else { 0.0 })
    }

    /// Weights `k / 8` that sum to 1, often on a corner or an edge.
    fn weights<const N: usize>(&mut self) -> [f64; N] {
        let mut weights = [0.0; N];
        for _ in 0..8 {
            let most = if self.below(2) == 0 { N } else { 1 };
            weights[self.below(most as u64) as usize] += 0.125;
        }
        weights
    }

    /// Axes exchanged and mirrored, and everything times a power of two: the answer is the same, and nothing is rounded.
    fn disguised(&mut self, query: &Query, exponent: i32) -> Query {
        let (turn, signs, scale) = (self.below(6), self.below(8), 2.0_f64.powi(exponent));
        let axes = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]][turn as usize];
        let side = |k: usize| if signs >> k & 1 == 0 { scale } else { -scale };
        query.map(|p| std::array::from_fn(|k| side(k) * p[axes[k]]))
    }

    /// Features with a common point at a time k / 8, every vertex with a velocity of its own; one in six within a plane.
    pub(crate) fn touch(&mut self, exponent: i32) -> Query {
        let is_edges = self.below(2) == 0;
        let dimensions = if self.below(6) == 0 { 2 } else { 3 };
        let time = self.below(9) as f64 / 8.0;
        let velocities: [Point; 4] = std::array::from_fn(|_| self.point(dimensions));
        let mut points: [Point; 4] = std::array::from_fn(|_| self.point(dimensions));
        let first = if is_edges { 2 } else { 1 };
        let weights: Vec<f64> = if is_edges {
            [self.weights::<2>(), self.weights::<2>()].concat()
        } else {
            [&[1.0][..], &self.weights::<3>()].concat()
        };
        let mean = |range: std::ops::Range<usize>| -> Point {
            std::array::from_fn(|k| range.clone().map(|i| weights[i] * points[i][k]).sum())
        };
        let (a, b) = (mean(0..first), mean(first..4));
        for point in &mut points[..first] {
            *point = std::array::from_fn(|k| point[k] + (b[k] - a[k]));
        }
        let at = |by: f64| -> [Point; 4] {
            std::array::from_fn(|i| std::array::from_fn(|k| points[i][k] + by * velocities[i][k]))
        };
        let query = Query {
            is_edges,
            from: at(-time),
            to: at(1.0 - time),
        };
        self.disguised(&query, exponent)
    }

    /// A vertex through the plane of a triangle, or an edge through that of another one, straight along z: they touch if what they are seen
    /// along z does. A side of the one is seen exactly on a corner or an edge of the other, or one step of a double beside it.
    pub(crate) fn near_miss(&mut self, exponent: i32) -> (Query, bool) {
        let (beside, misses) = match self.below(3) {
            0 => (f64::next_up as fn(f64) -> f64, true),
            1 => (f64::next_down as fn(f64) -> f64, false),
            _ => ((|x| x) as fn(f64) -> f64, false),
        };
        let [x, y] = [self.number(), self.number()];
        let [mut a, b] = [self.below(512), self.below(512)].map(|n| (n + 1) as f64 / 64.0);
        if x + a == 0.0 {
            // one step beside 0 is 0 at a small scale
            a += 1.0 / 64.0;
        }
        let mut height = || self.number() / 16.0;
        let side = beside(x + a);
        let query = if height() < 0.0 {
            // the corner (x + a, y), the outermost one along x
            let still = [[x, y, height()], [x + a, y, height()], [x, y + b, height()]];
            let vertex = |z: f64| [side, y, z];
            Query {
                is_edges: false,
                from: [vertex(-8.0), still[0], still[1], still[2]],
                to: [vertex(8.0), still[0], still[1], still[2]],
            }
        } else {
            // the end of an edge, and an edge across it
            let still = [[x, y, height()], [x + a, y + b, height()]];
            let (one, two) = (height(), height());
            let across = |z: f64| [[side, y - 1.0, z + one], [side, y + b + 1.0, z + two]];
            let (from, to) = (across(-8.0), across(8.0));
            Query {
                is_edges: true,
                from: [from[0], from[1], still[0], still[1]],
                to: [to[0], to[1], still[0], still[1]],
            }
        };
        (self.disguised(&query, exponent), !misses)
    }
}

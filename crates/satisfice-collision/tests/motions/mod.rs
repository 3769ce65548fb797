//! Motions with known answers, and a referee for those without.
#![allow(dead_code, unreachable_pub)]

pub mod fuzzing;

use rand_xoshiro::Xoshiro256PlusPlus;
use satisfice_collision::continuous::{Decided, Impact, Moving, Separation, decide, impact, is_hit, touches};
use satisfice_collision::distance::Threshold;

use crate::stress::referee::squared_distance;
use crate::stress::{Motion as Turn, Point, below, orders};

/// The kinds of pairs by their numbers of vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    VertexVertex,
    VertexEdge,
    VertexTriangle,
    EdgeEdge,
}

impl Kind {
    pub const ALL: [Self; 4] = [
        Self::VertexVertex,
        Self::VertexEdge,
        Self::VertexTriangle,
        Self::EdgeEdge,
    ];

    pub fn sizes(self) -> (usize, usize) {
        match self {
            Self::VertexVertex => (1, 1),
            Self::VertexEdge => (1, 2),
            Self::VertexTriangle => (1, 3),
            Self::EdgeEdge => (2, 2),
        }
    }
}

/// A pair in motion: vertices of the first feature, then of the second, at both times.
#[derive(Debug, Clone)]
pub struct Query {
    pub kind: Kind,
    pub from: Vec<Point>,
    pub to: Vec<Point>,
    /// The first time at which the features touch, where it is known.
    pub first_touch: Option<f64>,
}

fn moving<const N: usize>(from: &[Point], to: &[Point]) -> Moving<[Point; N]> {
    Moving::new(from.try_into().unwrap(), to.try_into().unwrap())
}

fn vertex(from: &[Point], to: &[Point]) -> Moving<Point> {
    Moving::new(from[0], to[0])
}

macro_rules! ask {
    ($query:expr, |$a:ident, $b:ident| $body:expr) => {{
        let query = $query;
        let split = query.kind.sizes().0;
        let ((p, r), (q, s)) = (query.from.split_at(split), query.to.split_at(split));
        match query.kind {
            Kind::VertexVertex => {
                let ($a, $b) = (vertex(p, q), vertex(r, s));
                $body
            }
            Kind::VertexEdge => {
                let ($a, $b) = (vertex(p, q), moving::<2>(r, s));
                $body
            }
            Kind::VertexTriangle => {
                let ($a, $b) = (vertex(p, q), moving::<3>(r, s));
                $body
            }
            Kind::EdgeEdge => {
                let ($a, $b) = (moving::<2>(p, q), moving::<2>(r, s));
                $body
            }
        }
    }};
}

impl Query {
    pub fn touches(&self) -> bool {
        ask!(self, |a, b| touches(&a, &b))
    }

    /// Whether the features touch, and who decided it.
    pub fn decide(&self) -> Decided {
        ask!(self, |a, b| decide(&a, &b, Separation::TOUCHING))
    }

    pub fn is_hit(&self, delta: f64) -> bool {
        let threshold = Threshold::new(delta).unwrap();
        ask!(self, |a, b| is_hit(&a, &b, threshold))
    }

    pub fn impact(&self, delta: f64, tolerance: f64) -> Option<Impact> {
        let separation = Separation::new(delta).unwrap();
        ask!(self, |a, b| impact(&a, &b, separation, tolerance).unwrap())
    }

    /// Integers from -n to n.
    pub fn small_integers(kind: Kind, rng: &mut Xoshiro256PlusPlus, n: i64) -> Self {
        let count = kind.sizes().0 + kind.sizes().1;
        let mut points = || -> Vec<Point> {
            (0..count)
                .map(|_| std::array::from_fn(|_| (below(rng, 2 * n as u64 + 1) as i64 - n) as f64))
                .collect()
        };
        Self {
            kind,
            from: points(),
            to: points(),
            first_touch: None,
        }
    }

    /// Times a power of two.
    pub fn scaled(&self, exponent: i32) -> Self {
        let factor = 2f64.powi(exponent);
        let scale = |points: &[Point]| points.iter().map(|p| p.map(|x| x * factor)).collect();
        Self {
            from: scale(&self.from),
            to: scale(&self.to),
            ..self.clone()
        }
    }

    pub fn turned(&self, turn: &Turn) -> Self {
        Self {
            from: turn.apply(&self.from),
            to: turn.apply(&self.to),
            ..self.clone()
        }
    }

    /// The same question asked in other ways: time reversed, vertices in other orders, edges exchanged.
    pub fn variants(&self) -> Vec<Self> {
        let split = self.kind.sizes().0;
        let parts = |points: &[Point]| {
            let (a, b) = points.split_at(split);
            let mut all: Vec<Vec<Point>> = Vec::new();
            for (p, q) in orders(a).iter().zip(orders(b).iter().cycle()) {
                all.push([p.as_slice(), q].concat());
            }
            for q in orders(b) {
                all.push([a, q.as_slice()].concat());
            }
            if a.len() == b.len() {
                all.push([b, a].concat());
            }
            all
        };
        let mut all = Vec::new();
        for (from, to) in parts(&self.from).into_iter().zip(parts(&self.to)) {
            for (from, to) in [(from.clone(), to.clone()), (to, from)] {
                all.push(Self {
                    from,
                    to,
                    first_touch: None,
                    kind: self.kind,
                });
            }
        }
        all
    }

    fn at(&self, time: f64) -> (Vec<Point>, Vec<Point>) {
        let split = self.kind.sizes().0;
        let points: Vec<Point> = self
            .from
            .iter()
            .zip(&self.to)
            .map(|(p, q)| std::array::from_fn(|k| p[k] + time * (q[k] - p[k])))
            .collect();
        (points[..split].to_vec(), points[split..].to_vec())
    }

    /// The distance at a time, exact for small integers and short binary fractions, then rounded down.
    pub fn distance_at(&self, time: f64) -> f64 {
        let (a, b) = self.at(time);
        squared_distance(&a, &b).approximate()
    }

    /// Whether the distance of small integers is below delta at some time; `None` if that is too close to call.
    pub fn referee(&self, delta: f64) -> Option<bool> {
        let speed = |points: std::ops::Range<usize>| {
            points
                .map(|i| {
                    (0..3)
                        .map(|k| (self.to[i][k] - self.from[i][k]).powi(2))
                        .sum::<f64>()
                        .sqrt()
                })
                .fold(0.0, f64::max)
        };
        let split = self.kind.sizes().0;
        let closing = 1.000_001 * (speed(0..split) + speed(split..self.from.len()));
        self.search(delta, closing, 0.5, 0.5, 16)
    }

    fn search(&self, delta: f64, closing: f64, middle: f64, half: f64, levels: u32) -> Option<bool> {
        let (a, b) = self.at(middle);
        let squared = squared_distance(&a, &b);
        if squared.is_below(delta) {
            return Some(true);
        }
        if !squared.is_below(delta + closing * half) {
            return Some(false);
        }
        if levels == 0 {
            return None;
        }
        let quarter = half / 2.0;
        let first = self.search(delta, closing, middle - quarter, quarter, levels - 1);
        if first == Some(true) {
            return first;
        }
        let second = self.search(delta, closing, middle + quarter, quarter, levels - 1);
        if second == Some(true) {
            second
        } else {
            first.and(second)
        }
    }
}

/// Families of motions whose answer is known by construction.
#[derive(Debug, Clone, Copy)]
pub enum Case {
    /// The features touch at a time k / 8, in a point of the given kind, while every vertex moves.
    Touch,
    /// The same in a plane: all motion within it.
    PlanarTouch,
    /// A vertex or an edge passes a corner at the least distance that the numbers allow.
    NearMiss,
    /// The distance has a double root: the features come to touch and part again on the same side.
    Tangent,
    /// In touch at the start.
    AtStart,
    /// Both at rest, in touch or not.
    AtRest,
    /// Parallel edges in one plane; triangles without area; edges without length.
    Degenerate,
}

/// Multiples of `1 / unit` from -8 to 8.
fn lattice(rng: &mut Xoshiro256PlusPlus, unit: u64) -> Point {
    std::array::from_fn(|_| below(rng, 16 * unit + 1) as f64 / unit as f64 - 8.0)
}

fn add(p: Point, q: Point, factor: f64) -> Point {
    std::array::from_fn(|k| p[k] + factor * q[k])
}

/// Weights `k / 8` that sum to 1; zeros are frequent.
fn weights(rng: &mut Xoshiro256PlusPlus, count: usize) -> Vec<f64> {
    let mut weights = vec![0.0; count];
    for _ in 0..8 {
        let most = if below(rng, 2) == 0 { count } else { 1 };
        weights[below(rng, most as u64) as usize] += 0.125;
    }
    weights
}

impl Case {
    pub const ALL: [Self; 7] = [
        Self::Touch,
        Self::PlanarTouch,
        Self::NearMiss,
        Self::Tangent,
        Self::AtStart,
        Self::AtRest,
        Self::Degenerate,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Touch => "touching at one time",
            Self::PlanarTouch => "touching within a plane",
            Self::NearMiss => "one step of a double beside a corner",
            Self::Tangent => "double roots",
            Self::AtStart => "touching at the start",
            Self::AtRest => "at rest",
            Self::Degenerate => "degenerate",
        }
    }

    /// A motion and whether it touches.
    pub fn sample(self, rng: &mut Xoshiro256PlusPlus) -> (Query, bool) {
        let turn = Turn::random(rng);
        let (query, touches) = match self {
            Self::Touch => (touch(rng, 3, None), true),
            Self::PlanarTouch => (touch(rng, 2, None), true),
            Self::NearMiss => near_miss(rng),
            Self::Tangent => tangent(rng),
            Self::AtStart => (touch(rng, 3, Some(0.0)), true),
            Self::AtRest => at_rest(rng),
            Self::Degenerate => degenerate(rng),
        };
        (query.turned(&turn), touches)
    }
}

/// Features with a common point at a time; every vertex has a velocity of its own, and the first `dimensions` coordinates vary.
fn touch(rng: &mut Xoshiro256PlusPlus, dimensions: usize, time: Option<f64>) -> Query {
    let kind = Kind::ALL[below(rng, 4) as usize];
    let time = time.unwrap_or_else(|| below(rng, 9) as f64 / 8.0);
    let (m, n) = kind.sizes();
    let mut place = || {
        let mut p = lattice(rng, 1 << 10);
        p[dimensions..].fill(0.0);
        p
    };
    let velocities: Vec<Point> = (0..m + n).map(|_| place()).collect();
    let (mut a, b): (Vec<Point>, Vec<Point>) = (
        (0..m).map(|_| place()).collect(),
        (0..n).map(|_| place()).collect(),
    );
    let mean = |points: &[Point], weights: &[f64]| {
        points
            .iter()
            .zip(weights)
            .fold([0.0; 3], |sum, (&p, &weight)| add(sum, p, weight))
    };
    let shift = add(mean(&b, &weights(rng, n)), mean(&a, &weights(rng, m)), -1.0);
    for p in &mut a {
        *p = add(*p, shift, 1.0);
    }
    let points = [a, b].concat();
    let moved = |by: f64| {
        points
            .iter()
            .zip(&velocities)
            .map(|(&p, &v)| add(p, v, by))
            .collect()
    };
    Query {
        kind,
        from: moved(-time),
        to: moved(1.0 - time),
        first_touch: (time == 0.0).then_some(0.0),
    }
}

/// The least step beside or above the touching position, away or inwards.
fn near_miss(rng: &mut Xoshiro256PlusPlus) -> (Query, bool) {
    let step = [0.0, f64::EPSILON, -f64::EPSILON / 2.0][below(rng, 3) as usize];
    let x = 1.0 + step;
    let y = below(rng, 9) as f64 / 8.0;
    let triangle = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let misses = step > 0.0;
    match below(rng, 3) {
        // Through the corner, upwards and obliquely.
        0 => {
            let path = [below(rng, 3) as f64 - 1.0, below(rng, 3) as f64 - 1.0, 1.0];
            if path[0] != 0.0 {
                // Binary fractions of the sum with the step would be rounded.
                return near_miss(rng);
            }
            let from = [&[add([x, 0.0, 0.0], path, -1.0)][..], &triangle].concat();
            let to = [&[add([x, 0.0, 0.0], path, 1.0)][..], &triangle].concat();
            let query = Query {
                kind: Kind::VertexTriangle,
                from,
                to,
                first_touch: (!misses).then_some(0.5),
            };
            (query, !misses)
        }
        // Above the plane, sliding.
        1 => {
            let height = step.max(0.0);
            let from = [&[[-1.0, y / 2.0, height]][..], &triangle].concat();
            let to = [&[[1.0, y / 2.0, height]][..], &triangle].concat();
            let query = Query {
                kind: Kind::VertexTriangle,
                from,
                to,
                first_touch: (!misses).then_some(0.5),
            };
            (query, !misses)
        }
        // An edge past the end of an edge.
        _ => {
            let still = [[0.0, y, 0.0], [1.0, y, 0.0]];
            let from = [[[x, -1.0, -1.0], [x, 2.0, -1.0]], still].concat();
            let to = [[[x, -1.0, 1.0], [x, 2.0, 1.0]], still].concat();
            let query = Query {
                kind: Kind::EdgeEdge,
                from,
                to,
                first_touch: (!misses).then_some(0.5),
            };
            (query, !misses)
        }
    }
}

/// A rotating pair whose volume has a double root at the middle of the step.
fn tangent(rng: &mut Xoshiro256PlusPlus) -> (Query, bool) {
    let clearance = [0.0, 2f64.powi(-52), 2f64.powi(-30)][below(rng, 3) as usize];
    let s = below(rng, 7) as f64 - 3.0;
    // The vertex moves along the plane's line x while the plane turns about y with it: height (t - 1/2)^2 and a clearance.
    // Triangle (0, 0, 0), (4, 0, z), (0, 4, 0) with z = 4 (2t - 1); vertex at x = 2t - 1 + s' below or on it.
    let triangle = |z: f64| [[-4.0, -4.0, -z], [4.0, -4.0, z], [0.0, 4.0, 0.0]];
    let vertex = |x: f64| [x, s / 4.0, -clearance];
    // Height of the plane at the vertex: z x / 4, at least 0 as both have the sign of 2t - 1.
    let query = Query {
        kind: Kind::VertexTriangle,
        from: [&[vertex(-1.0)][..], &triangle(-4.0)].concat(),
        to: [&[vertex(1.0)][..], &triangle(4.0)].concat(),
        first_touch: (clearance == 0.0).then_some(0.5),
    };
    (query, clearance == 0.0)
}

fn at_rest(rng: &mut Xoshiro256PlusPlus) -> (Query, bool) {
    let mut query = touch(rng, 3, Some(0.0));
    query.to = query.from.clone();
    if below(rng, 2) == 0 {
        return (query, true);
    }
    // Lattice points differ by less than 64 and are apart by it.
    for p in &mut query.from[..query.kind.sizes().0] {
        p[0] += 64.0;
    }
    query.to = query.from.clone();
    query.first_touch = None;
    (query, false)
}

fn degenerate(rng: &mut Xoshiro256PlusPlus) -> (Query, bool) {
    let kind = Kind::ALL[below(rng, 4) as usize];
    let (m, n) = kind.sizes();
    // All vertices on one line that moves: positions along it decide.
    let position = |rng: &mut Xoshiro256PlusPlus| below(rng, 9) as f64 - 4.0;
    let (direction, start, velocity) = (lattice(rng, 4), lattice(rng, 4), lattice(rng, 4));
    let (a, mut b): (Vec<f64>, Vec<f64>) = (
        (0..m).map(|_| position(rng)).collect(),
        (0..n).map(|_| position(rng)).collect(),
    );
    if below(rng, 3) == 0 {
        let only = b[0];
        b.fill(only);
    }
    let span = |x: &[f64]| {
        let low = x.iter().copied().fold(f64::INFINITY, f64::min);
        (low, x.iter().copied().fold(f64::NEG_INFINITY, f64::max))
    };
    let ((a0, a1), (b0, b1)) = (span(&a), span(&b));
    let points: Vec<Point> = a.iter().chain(&b).map(|&s| add(start, direction, s)).collect();
    let query = Query {
        kind,
        to: points.iter().map(|&p| add(p, velocity, 1.0)).collect(),
        from: points,
        first_touch: None,
    };
    let is_point = direction == [0.0; 3];
    (query, is_point || (a0 <= b1 && b0 <= a1))
}

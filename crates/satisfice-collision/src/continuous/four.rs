//! One step of the advance for four pairs at a time, on the vector unit.
//!
//! The proofs are those of `swept`, with the same operations in the same order; what they do not prove is left to the single query.

use std::marker::PhantomData;

use super::hull::{Hull, ParallelogramHull, PointHull, SegmentHull, TriangleHull};
use super::swept::{RANGE, TINY, U, inverse_power_of_two};
use crate::distance::Point;
use crate::simd::{self, Floats};

/// Pairs at a time.
pub(super) const PAIRS: usize = 4;

/// A number for each of four pairs.
type Four = [f64; PAIRS];

/// Four pairs of features in motion, whose differences span a hull each.
pub(super) struct FourPairs<'s, H, const M: usize, const N: usize, const K: usize> {
    /// All vertices at both ends of the step.
    pub(super) points: [&'s [Point]; 2],
    /// The vertices of the features.
    pub(super) a: [[u32; M]; PAIRS],
    pub(super) b: [[u32; N]; PAIRS],
    /// How near they have to come.
    pub(super) delta: f64,
    /// The times up to which the pairs are known to be free.
    pub(super) free: Four,
    pub(super) hull: PhantomData<H>,
}

/// A hull of which the direction from the origin is guessed for four at a time.
pub(super) trait FourHulls<const K: usize>: Hull<K> {
    /// As the direction of [`nearest`](Hull::nearest).
    fn directions<F: Real>(f: F, corners: &[[F::Number; 3]; K]) -> [F::Number; 3];
}

/// Four `f64`.
pub(super) trait Real: Floats<Scalar = f64, Array = Four> {}

impl<F: Floats<Scalar = f64, Array = Four>> Real for F {}

impl<H: FourHulls<K>, const M: usize, const N: usize, const K: usize> FourPairs<'_, H, M, N, K> {
    /// Times up to which a step proves the pairs free, for those that it does so for, a bit each.
    #[inline]
    pub(super) fn free_until(self) -> (Four, u32) {
        simd::dispatch(self)
    }
}

impl<H: FourHulls<K>, const M: usize, const N: usize, const K: usize> simd::Work
    for FourPairs<'_, H, M, N, K>
{
    type Output = (Four, u32);

    #[inline(always)]
    fn run<L: simd::Lanes>(self, lanes: L) -> (Four, u32) {
        let f = lanes.double();
        let zero = f.splat(0.0);
        let mut ends = [[[zero; 3]; K]; 2];
        let mut size = zero;
        for (end, points) in ends.iter_mut().zip(self.points) {
            let a = in_lanes(f, points, &self.a);
            let b = in_lanes(f, points, &self.b);
            for i in 0..M {
                for j in 0..N {
                    for k in 0..3 {
                        let x = f.sub(a[i][k], b[j][k]);
                        end[i * N + j][k] = x;
                        size = f.max(f.abs(x), size);
                    }
                }
            }
        }
        let in_range = f.both(f.less(size, f.splat(RANGE)), f.less(f.splat(1.0 / RANGE), size));
        let size = f.store(size);
        let mut scale = [0.0; PAIRS];
        for lane in 0..PAIRS {
            scale[lane] = inverse_power_of_two(size[lane]);
        }
        let scale = f.load(&scale);
        for corner in ends.as_flattened_mut() {
            *corner = times(f, *corner, scale);
        }
        let above = f.mul(f.mul(f.splat(self.delta), scale), f.splat(1.0 + 4.0 * U));
        let above = f.add(above, f.splat(TINY));
        let time = f.load(&self.free);
        let [from, to] = &ends;
        let mut now = *from;
        for k in 0..K {
            now[k] = along(f, from[k], sub(f, to[k], from[k]), time);
        }
        let direction = H::directions(f, &now);
        let length = largest(f, direction);
        let is_long = f.less(f.splat(1e-100), length);
        let n = times(f, direction, f.div(f.splat(1.0), length));
        // the square root of a sum between 1 and 3 as in plain arithmetic
        let square = dot(f, n, n);
        let is_number = f.less(f.splat(0.5), square);
        let squares = f.store(square);
        let mut root = [0.0; PAIRS];
        for lane in 0..PAIRS {
            root[lane] = squares[lane].sqrt();
        }
        let threshold = f.mul(above, f.mul(f.load(&root), f.splat(1.0 + 8.0 * U)));
        let (mut first, mut last, mut worst) = (zero, f.splat(1.0), zero);
        for k in 0..K {
            let from = f.sub(lower_bound(f, n, from[k]), threshold);
            let to = f.sub(lower_bound(f, n, to[k]), threshold);
            let quotient = f.div(from, f.sub(from, to));
            let up = f.mul(quotient, f.splat(1.0 + 8.0 * U));
            let down = f.mul(quotient, f.splat(1.0 - 8.0 * U));
            first = f.max(f.select(f.less(from, zero), up, zero), first);
            last = f.min(f.select(f.less(to, zero), down, f.splat(1.0)), last);
            worst = f.min(f.max(from, to), worst);
        }
        let is_apart = f.both(f.at_most(first, time), f.less(time, last));
        let is_apart = f.both(is_apart, f.at_most(zero, worst));
        let proved = f.both(f.both(in_range, is_long), f.both(is_number, is_apart));
        (f.store(last), f.bits(proved))
    }
}

/// The vertices of four features at one end of the step, which this turns into lanes.
#[inline(always)]
fn in_lanes<F: Real, const N: usize>(
    f: F,
    points: &[Point],
    features: &[[u32; N]; PAIRS],
) -> [[F::Number; 3]; N] {
    let mut corners = [[f.splat(0.0); 3]; N];
    for i in 0..N {
        let [p, q, r, s] = [
            &points[features[0][i] as usize],
            &points[features[1][i] as usize],
            &points[features[2][i] as usize],
            &points[features[3][i] as usize],
        ];
        for k in 0..3 {
            corners[i][k] = f.load(&[p[k], q[k], r[k], s[k]]);
        }
    }
    corners
}

impl FourHulls<1> for PointHull {
    #[inline(always)]
    fn directions<F: Real>(_: F, corners: &[[F::Number; 3]; 1]) -> [F::Number; 3] {
        corners[0]
    }
}

impl FourHulls<2> for SegmentHull {
    #[inline(always)]
    fn directions<F: Real>(f: F, corners: &[[F::Number; 3]; 2]) -> [F::Number; 3] {
        segment(f, corners[0], corners[1]).1
    }
}

impl FourHulls<3> for TriangleHull {
    #[inline(always)]
    fn directions<F: Real>(f: F, w: &[[F::Number; 3]; 3]) -> [F::Number; 3] {
        let zero = f.splat(0.0);
        let normal = cross(f, sub(f, w[1], w[0]), sub(f, w[2], w[0]));
        let edges = [[1, 2], [2, 0], [0, 1]];
        let mut inside = [f.less(zero, zero); 3];
        for (side, [i, j]) in edges.into_iter().enumerate() {
            inside[side] = f.less(zero, dot(f, cross(f, w[i], w[j]), normal));
        }
        nearest_edge(f, w, edges, inside, normal)
    }
}

impl FourHulls<4> for ParallelogramHull {
    #[inline(always)]
    fn directions<F: Real>(f: F, w: &[[F::Number; 3]; 4]) -> [F::Number; 3] {
        let (zero, one) = (f.splat(0.0), f.splat(1.0));
        let (x, y) = (sub(f, w[2], w[0]), sub(f, w[1], w[0]));
        let normal = cross(f, x, y);
        let squared = dot(f, normal, normal);
        let u = f.div(dot(f, cross(f, y, w[0]), normal), squared);
        let v = f.div(dot(f, cross(f, w[0], x), normal), squared);
        let inside = [f.less(zero, u), f.less(u, one), f.less(zero, v), f.less(v, one)];
        nearest_edge(f, w, [[0, 1], [2, 3], [0, 2], [1, 3]], inside, normal)
    }
}

/// The direction of the nearest among the edges of which the origin lies outside; across the face, towards it, if there is none.
#[inline(always)]
fn nearest_edge<F: Real, const K: usize, const E: usize>(
    f: F,
    w: &[[F::Number; 3]; K],
    edges: [[usize; 2]; E],
    inside: [F::Mask; E],
    normal: [F::Number; 3],
) -> [F::Number; 3] {
    let zero = f.splat(0.0);
    let side = dot(f, normal, w[0]);
    let flip = f.select(f.less(side, zero), f.splat(-1.0), f.splat(1.0));
    let mut best = times(f, normal, flip);
    let mut least = f.splat(f64::INFINITY);
    for (inside, [i, j]) in inside.into_iter().zip(edges) {
        let (point, direction) = segment(f, w[i], w[j]);
        let squared = f.select(inside, f.splat(f64::INFINITY), dot(f, point, point));
        let is_nearer = f.less(squared, least);
        least = f.min(squared, least);
        for k in 0..3 {
            best[k] = f.select(is_nearer, direction[k], best[k]);
        }
    }
    best
}

/// The point of a segment nearest to the origin, and the direction to it.
#[inline(always)]
fn segment<F: Real>(f: F, p: [F::Number; 3], q: [F::Number; 3]) -> ([F::Number; 3], [F::Number; 3]) {
    let (zero, one) = (f.splat(0.0), f.splat(1.0));
    let x = sub(f, q, p);
    let xx = dot(f, x, x);
    let s = f.div(f.sub(zero, dot(f, p, x)), xx);
    let is_between = f.both(f.less(zero, s), f.less(s, one));
    let between = along(f, p, x, s);
    let across = along(f, between, x, f.div(f.sub(zero, dot(f, between, x)), xx));
    let is_behind = f.at_most(one, s);
    let (mut point, mut direction) = (p, p);
    for k in 0..3 {
        let end = f.select(is_behind, q[k], p[k]);
        point[k] = f.select(is_between, between[k], end);
        direction[k] = f.select(is_between, across[k], end);
    }
    (point, direction)
}

/// At most `n.w`.
#[inline(always)]
fn lower_bound<F: Real>(f: F, n: [F::Number; 3], w: [F::Number; 3]) -> F::Number {
    let (x, y, z) = (f.mul(n[0], w[0]), f.mul(n[1], w[1]), f.mul(n[2], w[2]));
    let sizes = f.add(f.add(f.abs(x), f.abs(y)), f.abs(z));
    let error = f.add(f.mul(f.splat(8.0 * U), sizes), f.splat(TINY));
    f.sub(f.add(f.add(x, y), z), error)
}

#[inline(always)]
fn sub<F: Real>(f: F, p: [F::Number; 3], q: [F::Number; 3]) -> [F::Number; 3] {
    [f.sub(p[0], q[0]), f.sub(p[1], q[1]), f.sub(p[2], q[2])]
}

#[inline(always)]
fn times<F: Real>(f: F, p: [F::Number; 3], s: F::Number) -> [F::Number; 3] {
    [f.mul(p[0], s), f.mul(p[1], s), f.mul(p[2], s)]
}

#[inline(always)]
fn along<F: Real>(f: F, p: [F::Number; 3], d: [F::Number; 3], s: F::Number) -> [F::Number; 3] {
    let d = times(f, d, s);
    [f.add(p[0], d[0]), f.add(p[1], d[1]), f.add(p[2], d[2])]
}

#[inline(always)]
fn dot<F: Real>(f: F, p: [F::Number; 3], q: [F::Number; 3]) -> F::Number {
    f.add(f.add(f.mul(p[0], q[0]), f.mul(p[1], q[1])), f.mul(p[2], q[2]))
}

#[inline(always)]
fn cross<F: Real>(f: F, p: [F::Number; 3], q: [F::Number; 3]) -> [F::Number; 3] {
    [
        f.sub(f.mul(p[1], q[2]), f.mul(p[2], q[1])),
        f.sub(f.mul(p[2], q[0]), f.mul(p[0], q[2])),
        f.sub(f.mul(p[0], q[1]), f.mul(p[1], q[0])),
    ]
}

/// NaN in any component, or a number that is not greater than the others, is passed over.
#[inline(always)]
fn largest<F: Real>(f: F, p: [F::Number; 3]) -> F::Number {
    f.max(f.abs(p[2]), f.max(f.abs(p[1]), f.max(f.abs(p[0]), f.splat(0.0))))
}

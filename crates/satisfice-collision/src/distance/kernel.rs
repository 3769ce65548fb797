//! The filter for several pairs of features, one per lane, in the precision of the unit.
//!
//! Of two edges, or a vertex and a triangle, a formula proposes the difference v of the closest points, and v is the direction of a certificate. Of two triangles each
//! lane runs the method of Frank and Wolfe (1956, doi:10.1002/nav.3800030109) for the point closest to 0 in the hull of the
//! differences `a_i - b_j`: a step goes to the best point between v and the difference w that is lowest in direction v, which
//! needs no branch. The certificates of `frame` stop it; pairs still open after [`STEPS`] steps are decided one by one.
//!
//! Pairs that the steps and the normals of both planes leave open are mostly within: then the vertices above the faces and the
//! nine pairs of edges propose one v each.
//!
//! **Error of v**, in units of `u rho` a component: 12.2 at the start (two centroids: data 2, products and sums
//! `2 * 3.01`, weights 1/3 rounded 2.02, difference 2.01); a step `v + t (w - v)` adds at most 2.1 to the greater of the
//! error so far and of 12.2 (w: 4.01; w - v and its product by t: `2 * 4.1`). Eight steps: 29, in norm 51, below the 64 of `SPAN_ERROR`.
//! A point of an edge, `p + s (p1 - p)` with s from 0 to 1: data 1, the difference and its product by s 2.01 each, the sum 1.01; two
//! of them and their difference, `2 * 6.1 + 2.02`: 15. A foot `x f + y g + z h` with x, y, z >= 0 and x = fl(fl(1 - y) - z), a sum
//! of weights within 2u of 1: data 1, products and sums 3.03, the weights 2.01; with the vertex and the difference, 10.

use super::precision::{ErrorBounds, Precision};
use crate::simd::Floats;

/// Steps of the method; the error bound allows 8.
const STEPS: usize = 8;

/// Both certificates for the pairs in the lanes of a unit, in its precision.
pub(super) struct Kernel<U> {
    pub(super) unit: U,
}

/// Points of as many pairs as a unit has lanes, in registers.
pub(super) type LaneVector<U> = [<U as Floats>::Number; 3];

/// Delta in the unit of the coordinates, in the precision of a unit.
#[derive(Debug, Clone, Copy)]
pub(super) struct KernelLimits {
    /// At most delta.
    pub(super) below: f64,
    /// At least delta squared.
    pub(super) squared_above: f64,
}

/// Lanes, as bits.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Verdicts {
    /// Proved within.
    pub(super) within: u32,
    /// Proved apart.
    pub(super) apart: u32,
    /// Lanes to which the proofs apply: neither NaN nor too large or too small.
    pub(super) in_range: u32,
}

impl<U: Floats<Scalar: Precision>> Kernel<U> {
    const BOUNDS: ErrorBounds = <U::Scalar as Precision>::BOUNDS;

    #[inline(always)]
    fn splat(&self, x: f64) -> U::Number {
        self.unit.splat(U::Scalar::round(x))
    }

    #[inline(always)]
    pub(super) fn sub(&self, p: LaneVector<U>, q: LaneVector<U>) -> LaneVector<U> {
        let u = self.unit;
        [u.sub(p[0], q[0]), u.sub(p[1], q[1]), u.sub(p[2], q[2])]
    }

    /// Lanes with `x < y`, as bits.
    #[inline(always)]
    fn below(&self, x: U::Number, y: U::Number) -> u32 {
        self.unit.bits(self.unit.less(x, y))
    }

    /// Lanes with `x <= y`, as bits.
    #[inline(always)]
    fn at_most(&self, x: U::Number, y: U::Number) -> u32 {
        self.unit.bits(self.unit.at_most(x, y))
    }

    #[inline(always)]
    fn dot(&self, p: LaneVector<U>, q: LaneVector<U>) -> U::Number {
        let u = self.unit;
        u.add(u.add(u.mul(p[0], q[0]), u.mul(p[1], q[1])), u.mul(p[2], q[2]))
    }

    #[inline(always)]
    fn third(&self, p: LaneVector<U>, q: LaneVector<U>, r: LaneVector<U>) -> LaneVector<U> {
        let third = self.splat(1.0 / 3.0);
        self.mean([p, q, r], [third; 3])
    }

    /// The greatest component, in absolute value, of a point and `rho`.
    #[inline(always)]
    fn extent(&self, rho: U::Number, p: LaneVector<U>) -> U::Number {
        let u = self.unit;
        u.max(u.max(u.abs(p[0]), u.abs(p[1])), u.max(u.abs(p[2]), rho))
    }

    /// The first of three points whose height is `height`.
    #[inline(always)]
    fn at(&self, height: U::Number, heights: [U::Number; 2], points: [LaneVector<U>; 3]) -> LaneVector<U> {
        let u = self.unit;
        let pick = |k: usize| {
            let rest = u.if_equal(heights[1], height, points[1][k], points[2][k]);
            u.if_equal(heights[0], height, points[0][k], rest)
        };
        [pick(0), pick(1), pick(2)]
    }

    /// Two edges. Local coordinates: the first point of `a` is 0.
    #[inline(always)]
    pub(super) fn two_edges(
        &self,
        a: [LaneVector<U>; 2],
        b: [LaneVector<U>; 2],
        limits: KernelLimits,
    ) -> Verdicts {
        let u = self.unit;
        let v = self.edges(a, b);
        let gap = u.sub(
            u.min(self.dot(v, a[0]), self.dot(v, a[1])),
            u.max(self.dot(v, b[0]), self.dot(v, b[1])),
        );
        self.judge(v, gap, &[a[1], b[0], b[1]], limits)
    }

    /// A vertex, which is 0, and a triangle.
    #[inline(always)]
    pub(super) fn vertex_and_triangle(&self, b: [LaneVector<U>; 3], limits: KernelLimits) -> Verdicts {
        let u = self.unit;
        let v = self.nearest_to_zero(b);
        let gap = u.min(u.min(self.dot(v, b[0]), self.dot(v, b[1])), self.dot(v, b[2]));
        self.judge(v, gap, &b, limits)
    }

    /// The point of a triangle that is nearest to 0. Where rounding misleads it is some point of the triangle.
    #[inline(always)]
    fn nearest_to_zero(&self, [p, q, r]: [LaneVector<U>; 3]) -> LaneVector<U> {
        let u = self.unit;
        let zero = self.splat(0.0);
        let v = self.nearest_on_edge(p, q);
        let best = (v, self.dot(v, v));
        let v = self.nearest_on_edge(q, r);
        let best = self.nearer(best, (v, self.dot(v, v)));
        let v = self.nearest_on_edge(r, p);
        let best = self.nearer(best, (v, self.dot(v, v)));
        // the foot of 0 on the plane, by the areas that it makes with the edges
        let n = self.cross(self.sub(q, p), self.sub(r, p));
        let inverse = u.div(self.splat(1.0), self.dot(n, n));
        let y = u.mul(self.dot(self.cross(r, p), n), inverse);
        let z = u.mul(self.dot(self.cross(p, q), n), inverse);
        let x = u.sub(u.sub(self.splat(1.0), y), z);
        let v = self.mean([p, q, r], [x, y, z]);
        // outside, or of no area: as far as can be
        let least = u.min(u.min(x, y), z);
        let far = self.splat(f64::INFINITY);
        let square = u.if_equal(u.max(least, zero), least, self.dot(v, v), far);
        self.nearer(best, (v, square)).0
    }

    /// The point of an edge that is nearest to 0.
    #[inline(always)]
    fn nearest_on_edge(&self, from: LaneVector<U>, to: LaneVector<U>) -> LaneVector<U> {
        let e = self.sub(to, from);
        let t = self.share(self.unit.sub(self.splat(0.0), self.dot(from, e)), self.dot(e, e));
        self.along(from, e, t)
    }

    /// That of two points whose square is less.
    #[inline(always)]
    fn nearer(
        &self,
        (v, of_v): (LaneVector<U>, U::Number),
        (w, of_w): (LaneVector<U>, U::Number),
    ) -> (LaneVector<U>, U::Number) {
        let u = self.unit;
        let least = u.min(of_v, of_w);
        let nearer = [
            u.if_equal(of_v, least, v[0], w[0]),
            u.if_equal(of_v, least, v[1], w[1]),
            u.if_equal(of_v, least, v[2], w[2]),
        ];
        (nearer, least)
    }

    /// `from + share * by`.
    #[inline(always)]
    fn along(&self, from: LaneVector<U>, by: LaneVector<U>, share: U::Number) -> LaneVector<U> {
        let u = self.unit;
        [
            u.add(from[0], u.mul(share, by[0])),
            u.add(from[1], u.mul(share, by[1])),
            u.add(from[2], u.mul(share, by[2])),
        ]
    }

    /// `x p + y q + z r`.
    #[inline(always)]
    fn mean(&self, [p, q, r]: [LaneVector<U>; 3], [x, y, z]: LaneVector<U>) -> LaneVector<U> {
        let u = self.unit;
        [
            u.add(u.add(u.mul(x, p[0]), u.mul(y, q[0])), u.mul(z, r[0])),
            u.add(u.add(u.mul(x, p[1]), u.mul(y, q[1])), u.mul(z, r[1])),
            u.add(u.add(u.mul(x, p[2]), u.mul(y, q[2])), u.mul(z, r[2])),
        ]
    }

    /// What a difference `v` of two points proves, and the gap in its direction. `others` are all points but the one at 0.
    #[inline(always)]
    fn judge(
        &self,
        v: LaneVector<U>,
        gap: U::Number,
        others: &[LaneVector<U>; 3],
        limits: KernelLimits,
    ) -> Verdicts {
        let u = self.unit;
        let zero = self.splat(0.0);
        let [p, q, r] = *others;
        let rho = self.extent(self.extent(self.extent(zero, p), q), r);
        let sum = [
            u.add(u.add(p[0], q[0]), r[0]),
            u.add(u.add(p[1], q[1]), r[1]),
            u.add(u.add(p[2], q[2]), r[2]),
        ];
        let in_range = self.in_range(rho, u.add(u.add(sum[0], sum[1]), sum[2]));
        let reach = self.reach(rho, limits);
        let gap_error = u.mul(rho, self.splat(Self::BOUNDS.gap_error));
        let squared = self.dot(v, v);
        let within = in_range & self.below(u.mul(squared, self.splat(Self::BOUNDS.above_one)), reach);
        let apart = self.apart(v, squared, gap, gap_error, self.splat(limits.squared_above));
        Verdicts {
            within,
            apart: apart & in_range & !within,
            in_range,
        }
    }

    /// Lanes to which the proofs apply. `any` is NaN if a coordinate is.
    #[inline(always)]
    fn in_range(&self, rho: U::Number, any: U::Number) -> u32 {
        self.at_most(self.splat(Self::BOUNDS.least_rho), rho)
            & self.at_most(rho, self.splat(Self::BOUNDS.greatest_rho))
            & self.at_most(any, any)
    }

    /// A square of a computed distance below this proves that the distance is below delta.
    #[inline(always)]
    fn reach(&self, rho: U::Number, limits: KernelLimits) -> U::Number {
        let u = self.unit;
        let margin = u.sub(
            self.splat(limits.below),
            u.mul(rho, self.splat(Self::BOUNDS.span_error)),
        );
        // Where the margin is not above 0 its square is replaced by 0, which no square is below.
        let margin = u.max(margin, self.splat(0.0));
        u.mul(margin, margin)
    }

    /// Two triangles. Local coordinates: the first point of `a` is 0.
    #[inline(always)]
    pub(super) fn two_triangles(
        &self,
        [a0, a1, a2]: [LaneVector<U>; 3],
        [b0, b1, b2]: [LaneVector<U>; 3],
        limits: KernelLimits,
    ) -> Verdicts {
        let u = self.unit;
        let zero = self.splat(0.0);
        let of_a = self.extent(self.extent(zero, a1), a2);
        let of_b = self.extent(self.extent(self.extent(zero, b0), b1), b2);
        let rho = u.max(of_a, of_b);
        let mut v = self.sub(self.third(a0, a1, a2), self.third(b0, b1, b2));
        let squared = self.dot(v, v);
        let in_range = self.in_range(rho, squared);
        let reach = self.reach(rho, limits);
        let gap_error = u.mul(rho, self.splat(Self::BOUNDS.gap_error));
        let limit = self.splat(limits.squared_above);

        let (mut within, mut apart) = (0, 0);
        for _ in 0..STEPS {
            let squared = self.dot(v, v);
            within |= self.below(u.mul(squared, self.splat(Self::BOUNDS.above_one)), reach);
            let heights_a = [self.dot(v, a0), self.dot(v, a1), self.dot(v, a2)];
            let heights_b = [self.dot(v, b0), self.dot(v, b1), self.dot(v, b2)];
            let height_a = u.min(u.min(heights_a[0], heights_a[1]), heights_a[2]);
            let height_b = u.max(u.max(heights_b[0], heights_b[1]), heights_b[2]);
            let gap = u.sub(height_a, height_b);
            apart |= self.apart(v, squared, gap, gap_error, limit);
            if (within | apart) & in_range == in_range {
                break;
            }
            let w = self.sub(
                self.at(height_a, [heights_a[0], heights_a[1]], [a0, a1, a2]),
                self.at(height_b, [heights_b[0], heights_b[1]], [b0, b1, b2]),
            );
            let e = self.sub(w, v);
            let t = u.div(u.sub(zero, self.dot(v, e)), self.dot(e, e));
            // In this order a NaN (0 / 0: v is w) becomes 0.
            let t = u.min(u.max(t, zero), self.splat(1.0));
            v = [
                u.add(v[0], u.mul(t, e[0])),
                u.add(v[1], u.mul(t, e[1])),
                u.add(v[2], u.mul(t, e[2])),
            ];
        }
        // Most open pairs face the plane of one of the triangles: try the planes' normals, in both directions.
        let of_a = self.cross(a1, a2);
        let of_b = self.cross(self.sub(b1, b0), self.sub(b2, b0));
        for n in [of_a, of_b] {
            if (within | apart) & in_range == in_range {
                break;
            }
            let squared = self.dot(n, n);
            let heights_a = [self.dot(n, a0), self.dot(n, a1), self.dot(n, a2)];
            let heights_b = [self.dot(n, b0), self.dot(n, b1), self.dot(n, b2)];
            let least_a = u.min(u.min(heights_a[0], heights_a[1]), heights_a[2]);
            let greatest_a = u.max(u.max(heights_a[0], heights_a[1]), heights_a[2]);
            let least_b = u.min(u.min(heights_b[0], heights_b[1]), heights_b[2]);
            let greatest_b = u.max(u.max(heights_b[0], heights_b[1]), heights_b[2]);
            let gap = u.max(u.sub(least_a, greatest_b), u.sub(least_b, greatest_a));
            apart |= self.apart(n, squared, gap, gap_error, limit);
        }
        // Most of the rest are within. Of triangles that do not meet, two edges are closest, or a vertex and a face.
        let (a, b) = ([a0, a1, a2], [b0, b1, b2]);
        if (within | apart) & in_range != in_range {
            within |= self.faces(a, b, of_a, zero, reach) | self.faces(b, a, of_b, zero, reach);
        }
        for i in 0..3 {
            if (within | apart) & in_range == in_range {
                break;
            }
            for j in 0..3 {
                let v = self.edges([a[i], a[(i + 1) % 3]], [b[j], b[(j + 1) % 3]]);
                within |= self.below(u.mul(self.dot(v, v), self.splat(Self::BOUNDS.above_one)), reach);
            }
        }
        Verdicts {
            within: within & in_range,
            apart: apart & in_range & !within,
            in_range,
        }
    }

    /// The difference of the closest points of two edges. Where rounding misleads, as for parallel edges, it is the difference
    /// of some two points of them.
    #[inline(always)]
    fn edges(&self, [p, p1]: [LaneVector<U>; 2], [q, q1]: [LaneVector<U>; 2]) -> LaneVector<U> {
        let u = self.unit;
        let (d, e, r) = (self.sub(p1, p), self.sub(q1, q), self.sub(p, q));
        let (dd, ee, de) = (self.dot(d, d), self.dot(e, e), self.dot(d, e));
        let (dr, er) = (self.dot(d, r), self.dot(e, r));
        let s = self.share(
            u.sub(u.mul(de, er), u.mul(dr, ee)),
            u.sub(u.mul(dd, ee), u.mul(de, de)),
        );
        let t = self.share(u.add(u.mul(de, s), er), ee);
        let s = self.share(u.sub(u.mul(de, t), dr), dd);
        self.sub(self.along(p, d, s), self.along(q, e, t))
    }

    /// A quotient clamped to 0..=1; NaN becomes 0.
    #[inline(always)]
    fn share(&self, x: U::Number, y: U::Number) -> U::Number {
        let u = self.unit;
        u.min(u.max(u.div(x, y), self.splat(0.0)), self.splat(1.0))
    }

    /// Lanes that a vertex of `points` and its foot on `face`, whose normal is `n`, prove within.
    #[inline(always)]
    fn faces(
        &self,
        face: [LaneVector<U>; 3],
        points: [LaneVector<U>; 3],
        n: LaneVector<U>,
        zero: U::Number,
        reach: U::Number,
    ) -> u32 {
        let u = self.unit;
        let (d, e) = (self.sub(face[1], face[0]), self.sub(face[2], face[0]));
        let inverse = u.div(self.splat(1.0), self.dot(n, n));
        let mut within = 0;
        for p in points {
            let r = self.sub(p, face[0]);
            let y = u.mul(self.dot(self.cross(r, e), n), inverse);
            let z = u.mul(self.dot(self.cross(d, r), n), inverse);
            let x = u.sub(u.sub(self.splat(1.0), y), z);
            let inside = self.at_most(zero, x) & self.at_most(zero, y) & self.at_most(zero, z);
            let v = self.sub(self.mean(face, [x, y, z]), p);
            within |= inside & self.below(u.mul(self.dot(v, v), self.splat(Self::BOUNDS.above_one)), reach);
        }
        within
    }

    /// Lanes that a gap in direction `v` proves apart.
    #[inline(always)]
    fn apart(
        &self,
        v: LaneVector<U>,
        squared: U::Number,
        gap: U::Number,
        gap_error: U::Number,
        limit: U::Number,
    ) -> u32 {
        let u = self.unit;
        let taxicab = u.add(u.add(u.abs(v[0]), u.abs(v[1])), u.abs(v[2]));
        let g = u.sub(gap, u.mul(gap_error, taxicab));
        let needed = u.mul(u.mul(limit, squared), self.splat(Self::BOUNDS.above_one));
        self.below(self.splat(Self::BOUNDS.least_gap), g) & self.at_most(needed, u.mul(g, g))
    }

    #[inline(always)]
    fn cross(&self, p: LaneVector<U>, q: LaneVector<U>) -> LaneVector<U> {
        let u = self.unit;
        [
            u.sub(u.mul(p[1], q[2]), u.mul(p[2], q[1])),
            u.sub(u.mul(p[2], q[0]), u.mul(p[0], q[2])),
            u.sub(u.mul(p[0], q[1]), u.mul(p[1], q[0])),
        ]
    }
}

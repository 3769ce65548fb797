//! Vertex against triangle.

use super::frame::{Frame, Limits, Verdict};
use super::resolve::{self, Hulls};
use super::vector::{dot, sub};
use super::{Decision, FeaturePair, PairKind, Point, Proximity, Threshold, Triangle, measure};

/// A point and a triangle.
#[derive(Debug, Clone, Copy)]
pub struct VertexTriangle;

/// Barycentric weights of the point of triangle `t` nearest to `p`, approximately, by the Voronoi regions of the
/// triangle's vertices, edges and face (Ericson, *Real-Time Collision Detection*, 2005, section 5.1.5).
#[inline(always)]
pub(super) fn weights(p: Point, t: &Triangle) -> [f64; 3] {
    let (ab, ac) = (sub(t[1], t[0]), sub(t[2], t[0]));
    let ap = sub(p, t[0]);
    let (d1, d2) = (dot(ab, ap), dot(ac, ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = sub(p, t[1]);
    let (d3, d4) = (dot(ab, bp), dot(ac, bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let s = ratio(d1, d1 - d3);
        return [1.0 - s, s, 0.0];
    }
    let cp = sub(p, t[2]);
    let (d5, d6) = (dot(ab, cp), dot(ac, cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let s = ratio(d2, d2 - d6);
        return [1.0 - s, 0.0, s];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let s = ratio(d4 - d3, (d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - s, s];
    }
    let sum = va + vb + vc;
    if va >= 0.0 && vb >= 0.0 && vc >= 0.0 && sum > 0.0 {
        [va / sum, vb / sum, vc / sum]
    } else {
        // Rounding left every region (a sliver): any point of the triangle is a valid, if poor, proposal.
        [1.0, 0.0, 0.0]
    }
}

/// `part / whole` in `[0, 1]`; 0 for 0 / 0.
#[inline(always)]
fn ratio(part: f64, whole: f64) -> f64 {
    let s = part / whole;
    if s > 0.0 {
        if s < 1.0 { s } else { 1.0 }
    } else {
        0.0
    }
}

impl Hulls<1, 3> for VertexTriangle {
    #[inline(always)]
    fn filter(frame: &Frame<1, 3>, limits: &Limits) -> Verdict {
        frame.judge(frame.difference(&[1.0], &weights(frame.a[0], &frame.b)), limits)
    }
}

/// Whether the distance is below delta, and how that is known. Cost: about 15 ns.
#[inline]
pub fn decide(a: &Point, b: &Triangle, threshold: Threshold) -> Decision {
    resolve::decide::<VertexTriangle, 1, 3>(&[*a], b, threshold)
}

/// Whether the distance is below delta.
#[inline]
pub fn within(a: &Point, b: &Triangle, threshold: Threshold) -> bool {
    decide(a, b, threshold).within
}

/// Distance and closest points.
pub fn proximity(a: &Point, b: &Triangle) -> Proximity {
    resolve::proximity::<1, 3>(&[*a], b)
}

impl FeaturePair for VertexTriangle {
    type A = Point;
    type B = Triangle;
    const KIND: PairKind = PairKind::VertexTriangle;

    #[inline]
    fn decide(a: &Point, b: &Triangle, threshold: Threshold) -> Decision {
        decide(a, b, threshold)
    }

    fn proximity(a: &Point, b: &Triangle) -> Proximity {
        proximity(a, b)
    }

    fn measure(a: &Point, b: &Triangle) -> f64 {
        measure::hulls(&[*a], b)
    }
}

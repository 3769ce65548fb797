//! Where the closest points of points, segments and triangles lie, in floating point.
//!
//! These formulas only propose points. The certificates of [`frame`](super::frame) and
//! [`extended`](super::extended) decide, so an inaccurate proposal costs time but never changes an answer.

use super::vector::{add, cross, dot, scale, sub};
use super::{Point, Segment, Triangle};

/// The parameter in `[0, 1]` of the point of the segment `q + t e` closest to `p`: `t = (p - q).e / e.e`, clamped.
#[inline(always)]
pub(super) fn on_segment(p: Point, q: Point, e: Point) -> f64 {
    unit(dot(sub(p, q), e) / dot(e, e))
}

/// The parameters `(s, t)` in `[0, 1]` of the closest points `p + s d` and `q + t e` of two segments: the minimum of the
/// two lines, clamped to one segment, projected to the other and back (Lumelsky 1985, doi:10.1016/0020-0190(85)90032-8).
/// Lines that are parallel within rounding start from `s = 0`.
#[inline(always)]
pub(super) fn of_segments(a: &Segment, b: &Segment) -> (f64, f64) {
    let (d, e, r) = (sub(a[1], a[0]), sub(b[1], b[0]), sub(a[0], b[0]));
    let (dd, ee, de) = (dot(d, d), dot(e, e), dot(d, e));
    let (dr, er) = (dot(d, r), dot(e, r));
    let s = unit((de * er - dr * ee) / (dd * ee - de * de));
    let t = unit((de * s + er) / ee);
    (unit((de * t - dr) / dd), t)
}

/// The barycentric weights of the point of triangle `t` closest to `p`, by the Voronoi regions of the triangle's
/// vertices, edges and face (Ericson, *Real-Time Collision Detection*, 2005, section 5.1.5).
#[inline(always)]
pub(super) fn on_triangle(p: Point, t: &Triangle) -> [f64; 3] {
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
        let s = unit(d1 / (d1 - d3));
        return [1.0 - s, s, 0.0];
    }
    let cp = sub(p, t[2]);
    let (d5, d6) = (dot(ab, cp), dot(ac, cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let s = unit(d2 / (d2 - d6));
        return [1.0 - s, 0.0, s];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let s = unit((d4 - d3) / ((d4 - d3) + (d5 - d6)));
        return [0.0, 1.0 - s, s];
    }
    let sum = va + vb + vc;
    if va >= 0.0 && vb >= 0.0 && vc >= 0.0 && sum > 0.0 {
        [va / sum, vb / sum, vc / sum]
    } else {
        // Rounding excluded every region of a sliver. Any point of the triangle is a valid proposal, if a poor one.
        [1.0, 0.0, 0.0]
    }
}

/// The difference `p - foot` and the foot's weights, if `p` projects into the interior of the triangle `q r s`.
pub(super) fn inside_triangle(p: Point, [q, r, s]: &Triangle) -> Option<(Point, [f64; 3])> {
    let (x, y, w) = (sub(*r, *q), sub(*s, *q), sub(p, *q));
    let n = cross(x, y);
    let nn = dot(n, n);
    let (t, u) = (dot(n, cross(w, y)) / nn, dot(n, cross(x, w)) / nn);
    (t > 0.0 && u > 0.0 && t + u < 1.0).then(|| (scale(n, dot(n, w) / nn), [1.0 - t - u, t, u]))
}

/// The difference and the parameters of the closest points of two segments, if both lie in the segments' interiors.
pub(super) fn inside_segments([p, q]: &Segment, [r, s]: &Segment) -> Option<(Point, f64, f64)> {
    let (d, e, w) = (sub(*q, *p), sub(*s, *r), sub(*p, *r));
    let n = cross(d, e);
    let nn = dot(n, n);
    let (x, y) = (dot(n, cross(e, w)) / nn, dot(n, cross(d, w)) / nn);
    (x > 0.0 && x < 1.0 && y > 0.0 && y < 1.0).then(|| {
        let v = sub(add(w, scale(d, x)), scale(e, y));
        (v, x, y)
    })
}

/// Clamps to `[0, 1]`. NaN, the result of a segment without length, becomes 0.
#[inline(always)]
fn unit(x: f64) -> f64 {
    if x > 0.0 {
        if x < 1.0 { x } else { 1.0 }
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const TRIANGLE: Triangle = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    #[test]
    fn a_point_over_each_region_of_a_triangle() {
        for (p, weights) in [
            ([-1.0, -1.0, 2.0], [1.0, 0.0, 0.0]),
            ([6.0, -1.0, 2.0], [0.0, 1.0, 0.0]),
            ([-1.0, 6.0, 2.0], [0.0, 0.0, 1.0]),
            ([2.0, -1.0, 2.0], [0.5, 0.5, 0.0]),
            ([-1.0, 2.0, 2.0], [0.5, 0.0, 0.5]),
            ([3.0, 3.0, 2.0], [0.0, 0.5, 0.5]),
            ([1.0, 1.0, 2.0], [0.5, 0.25, 0.25]),
        ] {
            assert_eq!(on_triangle(p, &TRIANGLE), weights, "{p:?}");
            let inside = inside_triangle(p, &TRIANGLE);
            assert_eq!(inside.is_some(), weights.iter().all(|&w| w > 0.0), "{p:?}");
        }
        assert_eq!(
            inside_triangle([1.0, 1.0, 2.0], &TRIANGLE).unwrap(),
            ([0.0, 0.0, 2.0], [0.5, 0.25, 0.25])
        );
    }

    #[test]
    fn crossing_parallel_and_degenerate_segments() {
        let along_x = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
        let along_y = [[1.5, -1.0, 1.0], [1.5, 3.0, 1.0]];
        assert_eq!(of_segments(&along_x, &along_y), (0.75, 0.25));
        assert_eq!(
            inside_segments(&along_x, &along_y),
            Some(([0.0, 0.0, -1.0], 0.75, 0.25))
        );
        let parallel = along_x.map(|[x, y, z]| [x + 1.0, y, z + 1.0]);
        let (s, t) = of_segments(&along_x, &parallel);
        assert_eq!(2.0 * s, 1.0 + 2.0 * t, "closest points face each other");
        assert_eq!(inside_segments(&along_x, &parallel), None);
        let point = [[5.0, 1.0, 0.0]; 2];
        assert_eq!(of_segments(&point, &along_x), (0.0, 1.0));
        assert_eq!(on_segment([7.0, 0.0, 0.0], point[0], [0.0; 3]), 0.0);
    }
}

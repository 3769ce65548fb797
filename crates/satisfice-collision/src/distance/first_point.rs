//! Where a segment first meets a triangle, decided exactly.
//!
//! A filter in `f64` answers where the signs of five volumes are certain. With u = 2^-53, a volume of three computed differences
//! is wrong by less than 16 u times its permanent (Shewchuk 1997, doi:10.1007/PL00009321, has 7 u). Integers answer the rest:
//! crossings at an edge or a vertex, segments in the plane of the triangle, triangles without area.

use std::cmp::Ordering;

use dashu_int::IBig;

use super::exact::{Vector, common_unit, cross, dot, integers, ratio, sub};
use super::vector::{self, ldexp};
use super::{Point, Segment, Triangle};

/// The first point of a segment that lies on a triangle, as a part of the way from the start to the end.
#[derive(Debug, Clone)]
pub(crate) struct FirstPoint {
    /// The part lies between these.
    low: f64,
    high: f64,
    exact: Option<Fraction>,
}

/// `numerator / denominator` in `0..=1`; the denominator is above 0.
#[derive(Debug, Clone)]
struct Fraction {
    numerator: IBig,
    denominator: IBig,
}

impl Fraction {
    fn new(numerator: IBig, denominator: IBig) -> Option<Self> {
        let (numerator, denominator) = if denominator < IBig::ZERO {
            (-numerator, -denominator)
        } else {
            (numerator, denominator)
        };
        (numerator >= IBig::ZERO && numerator <= denominator).then_some(Self {
            numerator,
            denominator,
        })
    }

    fn start() -> Self {
        Self {
            numerator: IBig::ZERO,
            denominator: IBig::ONE,
        }
    }

    fn cmp(&self, other: &Self) -> Ordering {
        (&self.numerator * &other.denominator).cmp(&(&other.numerator * &self.denominator))
    }

    /// Rounded.
    fn value(&self) -> f64 {
        if self.numerator.is_zero() {
            0.0
        } else {
            ratio(&self.numerator, &self.denominator)
        }
    }
}

impl FirstPoint {
    /// `None` if they do not meet. All coordinates are finite. A triangle without area counts as the segment or the point that it
    /// is, and so does a segment without length.
    pub(crate) fn find(segment: &Segment, triangle: &Triangle) -> Option<Self> {
        match filter(segment, triangle) {
            Meeting::Apart => None,
            Meeting::Between(low, high) => Some(Self {
                low,
                high,
                exact: None,
            }),
            Meeting::Unknown => {
                let part = exactly(segment, triangle)?;
                let value = part.value();
                Some(Self {
                    low: value.next_down(),
                    high: value.next_up(),
                    exact: Some(part),
                })
            }
        }
    }

    /// No more than this part of the way.
    pub(crate) fn at_most(&self) -> f64 {
        self.high
    }

    /// Whether the first point on one triangle comes before that on another, for the same segment.
    pub(crate) fn compare(
        segment: &Segment,
        (one, first): (&mut Self, &Triangle),
        (two, second): (&mut Self, &Triangle),
    ) -> Ordering {
        if one.high < two.low {
            return Ordering::Less;
        }
        if two.high < one.low {
            return Ordering::Greater;
        }
        one.part(segment, first).cmp(two.part(segment, second))
    }

    /// The part of the way, rounded.
    pub(crate) fn value(&mut self, segment: &Segment, triangle: &Triangle) -> f64 {
        self.part(segment, triangle).value()
    }

    fn part(&mut self, segment: &Segment, triangle: &Triangle) -> &Fraction {
        self.exact
            .get_or_insert_with(|| exactly(segment, triangle).unwrap_or_else(Fraction::start))
    }
}

enum Meeting {
    Apart,
    /// They meet, at a part of the way between these.
    Between(f64, f64),
    Unknown,
}

/// A number with a bound of its error.
#[derive(Clone, Copy)]
pub(super) struct Volume {
    value: f64,
    error: f64,
}

impl Volume {
    /// `a . (b x c)`
    pub(super) fn new(a: Point, b: Point, c: Point) -> Self {
        let permanent: f64 = (0..3)
            .map(|k| {
                let (l, m) = ((k + 1) % 3, (k + 2) % 3);
                a[k].abs() * ((b[l] * c[m]).abs() + (b[m] * c[l]).abs())
            })
            .sum();
        Self {
            value: vector::dot(a, vector::cross(b, c)),
            // products of denormal numbers prove nothing
            error: if permanent > 1e-200 {
                16.0 * f64::EPSILON / 2.0 * permanent
            } else {
                f64::INFINITY
            },
        }
    }

    /// 1, -1, or 0 if it is not certain; infinite and NaN are not.
    pub(super) fn sign(self) -> i32 {
        let certain = self.value.abs() > self.error && self.value.is_finite();
        if certain { self.value.signum() as i32 } else { 0 }
    }
}

fn filter([from, to]: &Segment, triangle: &Triangle) -> Meeting {
    let [a, b, c] = triangle.map(|p| vector::sub(p, *from));
    let way = vector::sub(*to, *from);
    let around = [
        Volume::new(way, a, b),
        Volume::new(way, b, c),
        Volume::new(way, c, a),
    ];
    let signs = around.map(Volume::sign);
    if signs.contains(&1) && signs.contains(&-1) {
        return Meeting::Apart;
    }
    let start = Volume::new(a, b, c);
    let [a, b, c] = triangle.map(|p| vector::sub(p, *to));
    let end = Volume::new(a, b, c);
    match start.sign() * end.sign() {
        1 => Meeting::Apart,
        -1 if signs == [1; 3] || signs == [-1; 3] => {
            let [(least, most), (least_end, most_end)] = [start, end].map(|volume| {
                (
                    volume.value.abs() - volume.error,
                    volume.value.abs() + volume.error,
                )
            });
            let low = least / (least + most_end) * (1.0 - 4.0 * f64::EPSILON);
            let high = most / (most + least_end) * (1.0 + 4.0 * f64::EPSILON);
            Meeting::Between(low, high)
        }
        _ => Meeting::Unknown,
    }
}

#[cold]
fn exactly(segment: &Segment, triangle: &Triangle) -> Option<Fraction> {
    let unit = common_unit(segment.iter().chain(triangle).flatten().copied());
    let (ends, corners) = (integers(segment, unit), integers(triangle, unit));
    let way = sub(&ends[1], &ends[0]);
    let normal = cross(&sub(&corners[1], &corners[0]), &sub(&corners[2], &corners[0]));
    if normal.iter().all(IBig::is_zero) {
        let sides = [[0, 1], [1, 2], [2, 0]];
        let parts = sides
            .into_iter()
            .filter_map(|[i, j]| on_side(&ends[0], &way, &corners[i], &corners[j]));
        return parts.reduce(|one, two| if two.cmp(&one).is_lt() { two } else { one });
    }
    let height = dot(&normal, &sub(&corners[0], &ends[0]));
    let speed = dot(&normal, &way);
    if speed.is_zero() {
        return if height.is_zero() {
            in_plane(&ends, &corners, &normal)
        } else {
            None
        };
    }
    let part = Fraction::new(height, speed)?;
    let [a, b, c] = [0, 1, 2].map(|k| sub(&corners[k], &ends[0]));
    let around = [(&a, &b), (&b, &c), (&c, &a)].map(|(p, q)| dot(&way, &cross(p, q)));
    let inside = around.iter().all(|volume| *volume >= IBig::ZERO)
        || around.iter().all(|volume| *volume <= IBig::ZERO);
    inside.then_some(part)
}

/// Of a segment in the plane of a triangle (Cyrus and Beck 1978, doi:10.1016/0097-8493(78)90021-3).
fn in_plane(ends: &[Vector], corners: &[Vector], normal: &Vector) -> Option<Fraction> {
    let (mut enter, mut leave) = (Fraction::start(), Fraction::new(IBig::ONE, IBig::ONE)?);
    for [i, j] in [[0, 1], [1, 2], [2, 0]] {
        let inward = cross(normal, &sub(&corners[j], &corners[i]));
        let [start, end] = [0, 1].map(|k| dot(&inward, &sub(&ends[k], &corners[i])));
        match (start < IBig::ZERO, end < IBig::ZERO) {
            (true, true) => return None,
            (false, false) => {}
            (outside, _) => {
                let crossing = Fraction::new(start.clone(), start - end)?;
                if outside && crossing.cmp(&enter).is_gt() {
                    enter = crossing;
                } else if !outside && crossing.cmp(&leave).is_lt() {
                    leave = crossing;
                }
            }
        }
    }
    enter.cmp(&leave).is_le().then_some(enter)
}

/// Where `from + t way` first meets the segment from `p` to `q`.
fn on_side(from: &Vector, way: &Vector, p: &Vector, q: &Vector) -> Option<Fraction> {
    let (side, w) = (sub(q, p), sub(p, from));
    let across = cross(way, &side);
    let is_zero = |v: &Vector| v.iter().all(IBig::is_zero);
    if !is_zero(&across) {
        if !dot(&w, &across).is_zero() {
            return None;
        }
        let square = dot(&across, &across);
        Fraction::new(dot(&cross(&w, way), &across), square.clone())?;
        return Fraction::new(dot(&cross(&w, &side), &across), square);
    }
    if is_zero(way) {
        let (along, square) = (-dot(&w, &side), dot(&side, &side));
        let on = is_zero(&cross(&w, &side)) && along >= IBig::ZERO && along <= square;
        let is_here = if is_zero(&side) { is_zero(&w) } else { on };
        return is_here.then(Fraction::start);
    }
    if !is_zero(&cross(&w, way)) {
        return None;
    }
    let square = dot(way, way);
    let [one, two] = [dot(&w, way), dot(&w, way) + dot(&side, way)];
    let (first, last) = if one < two { (one, two) } else { (two, one) };
    if last < IBig::ZERO || first > square {
        return None;
    }
    Fraction::new(first.max(IBig::ZERO), square)
}

/// The point at a part of the way.
pub(crate) fn along([from, to]: &Segment, part: f64) -> Point {
    // quarters cannot overflow
    std::array::from_fn(|k| {
        let way = to[k] / 4.0 - from[k] / 4.0;
        if way.abs() < 1e-290 {
            from[k] + (to[k] - from[k]) * part
        } else {
            ldexp(from[k] / 4.0 + way * part, 2)
        }
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use num_bigint::BigInt;
    use rand::{RngExt as _, SeedableRng};

    use super::*;
    use crate::distance::{edge_triangle, triangle_triangle};

    const TRIANGLE: Triangle = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    fn part(from: Point, to: Point) -> Option<f64> {
        let segment = [from, to];
        FirstPoint::find(&segment, &TRIANGLE).map(|mut first| first.value(&segment, &TRIANGLE))
    }

    #[test]
    fn through_the_face_an_edge_a_corner_and_past_them() {
        for (x, y, meets) in [
            (1.0, 1.0, true),
            (2.0, 2.0, true),
            (2.0, 2.0_f64.next_up(), false),
            (4.0, 0.0, true),
            (4.0_f64.next_up(), 0.0, false),
            (0.0, 0.0, true),
            (-1e-300, 0.0, false),
            (0.0, -5e-324, false),
        ] {
            assert_eq!(part([x, y, 3.0], [x, y, -1.0]), meets.then_some(0.75), "{x} {y}");
            assert_eq!(part([x, y, -1.0], [x, y, 3.0]), meets.then_some(0.25), "{x} {y}");
            assert_eq!(part([x, y, 0.0], [x, y, 3.0]), meets.then_some(0.0), "{x} {y}");
            assert_eq!(part([x, y, 3.0], [x, y, 1.0]), None);
        }
    }

    #[test]
    fn within_the_plane_and_without_length() {
        assert_eq!(part([-4.0, 1.0, 0.0], [4.0, 1.0, 0.0]), Some(0.5));
        assert_eq!(part([1.0, 1.0, 0.0], [9.0, 1.0, 0.0]), Some(0.0));
        assert_eq!(part([8.0, 0.0, 0.0], [-8.0, 0.0, 0.0]), Some(0.25));
        assert_eq!(part([-4.0, 8.0, 0.0], [4.0, 0.0, 0.0]), Some(0.5));
        assert_eq!(part([-4.0, 1.0, -5e-324], [4.0, 1.0, 5e-324]), Some(0.5));
        assert_eq!(part([-4.0, 6.0, 0.0], [6.0, 4.0, 0.0]), None);
        assert_eq!(part([1.0, 1.0, 0.0], [1.0, 1.0, 0.0]), Some(0.0));
        assert_eq!(part([1.0, 1.0, 1.0], [1.0, 1.0, 1.0]), None);
    }

    #[test]
    fn triangles_without_area() {
        let segment = [[0.0, 0.0, -1.0], [0.0, 0.0, 3.0]];
        let find = |triangle: Triangle| {
            FirstPoint::find(&segment, &triangle).map(|mut first| first.value(&segment, &triangle))
        };
        assert_eq!(
            find([[-1.0, 0.0, 0.0], [5.0, 0.0, 0.0], [1.0, 0.0, 0.0]]),
            Some(0.25)
        );
        assert_eq!(find([[1.0, 0.0, 0.0], [5.0, 0.0, 0.0], [2.0, 0.0, 0.0]]), None);
        assert_eq!(find([[0.0, 0.0, 1.0]; 3]), Some(0.5));
        assert_eq!(find([[0.0, 0.0, 4.0]; 3]), None);
        assert_eq!(
            find([[0.0, 0.0, 2.0], [0.0, 0.0, 1.0], [0.0, 0.0, 9.0]]),
            Some(0.5)
        );
        assert_eq!(
            find([[0.0, 0.0, -2.0], [0.0, 0.0, 9.0], [0.0, 0.0, 1.0]]),
            Some(0.0)
        );
        assert_eq!(find([[0.0, 1.0, 2.0], [0.0, 1.0, 1.0], [0.0, 1.0, 9.0]]), None);
    }

    /// Whether they meet, against the distance; the order of two crossings, against fractions of another library. Coordinates are
    /// small integers in half of the cases, where most of what can coincide does.
    #[test]
    fn agrees_with_the_distance_and_with_fractions() {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(6);
        let (mut met, mut equal) = (0, 0);
        for case in 0..6000 {
            let mut point = || -> Point {
                std::array::from_fn(|_| match case % 4 {
                    0 => (rng.random::<f64>() * 3.0).floor(),
                    1 => (rng.random::<f64>() * 5.0).floor() * 1e-3,
                    2 => rng.random::<f64>(),
                    _ => 1e7 + rng.random::<f64>(),
                })
            };
            let segment = [point(), point()];
            let triangles: [Triangle; 2] = std::array::from_fn(|_| [point(), point(), point()]);
            let mut found = triangles.map(|triangle| {
                let first = FirstPoint::find(&segment, &triangle);
                let meets = edge_triangle::proximity(&segment, &triangle).distance == 0.0;
                assert_eq!(first.is_some(), meets, "{segment:?} {triangle:?}");
                first
            });
            met += usize::from(found[0].is_some());
            let [Some(one), Some(two)] = &mut found else {
                continue;
            };
            let fractions = triangles.map(|triangle| fraction(&segment, &triangle));
            let [Some((p, q)), Some((r, s))] = &fractions else {
                continue;
            };
            let expected = (p * s).cmp(&(r * q));
            equal += usize::from(expected.is_eq());
            let order = FirstPoint::compare(&segment, (one, &triangles[0]), (two, &triangles[1]));
            assert_eq!(order, expected, "{segment:?} {triangles:?}");
        }
        assert!(met > 500 && equal > 10, "{met} met, {equal} at once");
        // the point is on the triangle
        let segment = [[0.1, 0.2, 5.0], [0.3, 0.4, -3.0]];
        let first = part(segment[0], segment[1]).unwrap();
        let point = [along(&segment, first); 3];
        assert!(triangle_triangle::proximity(&point, &TRIANGLE).distance < 1e-15);
    }

    /// The crossing with the plane of a triangle, by Cramer's rule; `None` if the segment is parallel to it.
    fn fraction(segment: &Segment, triangle: &Triangle) -> Option<(BigInt, BigInt)> {
        // coordinates here are multiples of 2^-80 below 2^24
        let whole = |x: f64| {
            BigInt::from((x * 2.0_f64.powi(30)) as i64) * (BigInt::from(1) << 50)
                + BigInt::from(((x * 2.0_f64.powi(30)).fract() * 2.0_f64.powi(50)) as i64)
        };
        let point = |p: &Point| p.map(whole);
        let minus = |p: &[BigInt; 3], q: &[BigInt; 3]| [0, 1, 2].map(|k| &p[k] - &q[k]);
        let determinant = |a: &[BigInt; 3], b: &[BigInt; 3], c: &[BigInt; 3]| {
            (0..3)
                .map(|k| &a[k] * (&b[(k + 1) % 3] * &c[(k + 2) % 3] - &b[(k + 2) % 3] * &c[(k + 1) % 3]))
                .sum::<BigInt>()
        };
        let ([o, e], [a, b, c]) = (segment.each_ref().map(point), triangle.each_ref().map(point));
        let (x, y) = (minus(&b, &a), minus(&c, &a));
        let speed = determinant(&minus(&e, &o), &x, &y);
        let height = determinant(&minus(&a, &o), &x, &y);
        let zero = BigInt::from(0);
        match speed.cmp(&zero) {
            Ordering::Equal => None,
            Ordering::Greater => Some((height, speed)),
            Ordering::Less => Some((-height, -speed)),
        }
    }
}

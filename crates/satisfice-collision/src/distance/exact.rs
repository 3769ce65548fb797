//! Proximity without rounding: coordinates as integers in a common power of two, every critical pair of parts compared.
//!
//! The distance of two convex hulls is attained at relatively interior points of some part of each (vertex, edge, face)
//! that are nearest on the parts' affine hulls, with affinely independent directions. Over triangles these are: vertex and
//! vertex, vertex and edge, vertex and face, edge and edge; and, at distance 0, edge through face. Degenerate parts have
//! dependent directions (a Gram determinant of 0) and are left to their own parts, so a collinear triangle is a segment.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use dashu_int::ops::{BitTest, SquareRoot};
use dashu_int::{IBig, UBig};

use super::Point;
use super::candidates::edges;
use super::vector::{exponent, ldexp};

pub(super) type Vector = [IBig; 3];

/// The closest pair of points.
#[derive(Debug, Clone)]
pub(super) struct ClosestPoints {
    pub(super) distance: f64,
    pub(super) weights_a: [f64; 3],
    pub(super) weights_b: [f64; 3],
}

/// Vertex numbers of a part.
type Corners<'p> = &'p [usize];

/// A critical pair of parts: its squared distance `numerator / denominator`, and the weights `steps[k] / step_unit` of all but
/// the first vertex of each part.
struct Critical {
    numerator: IBig,
    denominator: IBig,
    steps: [IBig; 3],
    step_unit: IBig,
}

/// Whether the distance is below `delta`. Coordinates and `delta` are finite.
#[cold]
pub(super) fn is_within(a: &[Point], b: &[Point], delta: f64) -> bool {
    let unit = common_unit(a.iter().chain(b).flatten().copied().chain([delta]));
    let (a, b, delta) = (integers(a, unit), integers(b, unit), integer(delta, unit));
    let squared = &delta * &delta;
    visit(&a, &b, &mut |_, _, critical| {
        if critical.numerator < &squared * &critical.denominator {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    })
    .is_break()
}

/// The distance, rounded (within one unit in the last place), and the weights of nearest points. Coordinates are finite.
#[cold]
pub(super) fn nearest(a: &[Point], b: &[Point]) -> ClosestPoints {
    let unit = common_unit(a.iter().chain(b).flatten().copied());
    let (a, b) = (integers(a, unit), integers(b, unit));
    let mut least: Option<Critical> = None;
    let (mut weights_a, mut weights_b) = ([0.0; 3], [0.0; 3]);
    let _ = visit(&a, &b, &mut |part_a, part_b, critical| {
        let closer = least.as_ref().is_none_or(|least| {
            (&critical.numerator * &least.denominator).cmp(&(&least.numerator * &critical.denominator))
                == Ordering::Less
        });
        if closer {
            let (steps_a, steps_b) = critical.steps.split_at(part_a.len() - 1);
            weights_a = weights(part_a, steps_a, &critical.step_unit);
            weights_b = weights(part_b, steps_b, &critical.step_unit);
            let touches = critical.numerator.is_zero();
            least = Some(critical);
            if touches {
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(())
    });
    let distance = least.map_or(0.0, |least| {
        root_of_ratio(least.numerator, least.denominator, unit)
    });
    ClosestPoints {
        distance,
        weights_a,
        weights_b,
    }
}

type Visitor<'v> = &'v mut dyn FnMut(Corners<'_>, Corners<'_>, Critical) -> ControlFlow<()>;

/// Calls `visitor` for every critical pair of parts, lower dimensions first.
fn visit(a: &[Vector], b: &[Vector], visitor: Visitor<'_>) -> ControlFlow<()> {
    const FACE: [usize; 3] = [0, 1, 2];
    for i in 0..a.len() {
        for j in 0..b.len() {
            try_parts(a, b, &[i], &[j], visitor)?;
        }
        for edge in edges(b.len()) {
            try_parts(a, b, &[i], edge, visitor)?;
        }
    }
    for j in 0..b.len() {
        for edge in edges(a.len()) {
            try_parts(a, b, edge, &[j], visitor)?;
        }
    }
    for i in 0..a.len() {
        if b.len() == 3 {
            try_parts(a, b, &[i], &FACE, visitor)?;
        }
    }
    for j in 0..b.len() {
        if a.len() == 3 {
            try_parts(a, b, &FACE, &[j], visitor)?;
        }
    }
    for edge_a in edges(a.len()) {
        for edge_b in edges(b.len()) {
            try_parts(a, b, edge_a, edge_b, visitor)?;
        }
    }
    for edge in edges(a.len()) {
        if b.len() == 3 {
            try_parts(a, b, edge, &FACE, visitor)?;
        }
    }
    for edge in edges(b.len()) {
        if a.len() == 3 {
            try_parts(a, b, &FACE, edge, visitor)?;
        }
    }
    ControlFlow::Continue(())
}

/// The minimum of `|w + s x + t y + ...|` over the affine hulls, if it lies inside both parts.
fn try_parts(
    a: &[Vector],
    b: &[Vector],
    part_a: Corners<'_>,
    part_b: Corners<'_>,
    visitor: Visitor<'_>,
) -> ControlFlow<()> {
    let w = sub(&a[part_a[0]], &b[part_b[0]]);
    let moves: Vec<Vector> = part_a[1..]
        .iter()
        .map(|&i| sub(&a[i], &a[part_a[0]]))
        .chain(part_b[1..].iter().map(|&j| sub(&b[part_b[0]], &b[j])))
        .collect();
    let one = || IBig::from(1);
    let critical = match moves.as_slice() {
        [] => Critical {
            numerator: dot(&w, &w),
            denominator: one(),
            steps: Default::default(),
            step_unit: one(),
        },
        [x] => {
            let (xx, wx) = (dot(x, x), dot(&w, x));
            let s = -&wx;
            if !is_inside(std::slice::from_ref(&s), part_a.len() - 1, &xx) {
                return ControlFlow::Continue(());
            }
            Critical {
                numerator: dot(&w, &w) * &xx - &wx * &wx,
                denominator: xx.clone(),
                steps: [s, IBig::ZERO, IBig::ZERO],
                step_unit: xx,
            }
        }
        [x, y] => {
            let (xx, yy, xy, wx, wy) = (dot(x, x), dot(y, y), dot(x, y), dot(&w, x), dot(&w, y));
            // |x cross y|^2, by Lagrange's identity.
            let gram = &xx * &yy - &xy * &xy;
            let steps = [&xy * &wy - &yy * &wx, &xy * &wx - &xx * &wy];
            if !is_inside(&steps, part_a.len() - 1, &gram) {
                return ControlFlow::Continue(());
            }
            let height = dot(&w, &cross(x, y));
            let [s, t] = steps;
            Critical {
                numerator: &height * &height,
                denominator: gram.clone(),
                steps: [s, t, IBig::ZERO],
                step_unit: gram,
            }
        }
        [x, y, z] => {
            let yz = cross(y, z);
            let mut volume = dot(x, &yz);
            let wx = cross(&w, x);
            // Cramer's rule for s x + t y + r z = -w.
            let mut steps = [-dot(&w, &yz), dot(&wx, z), -dot(&wx, y)];
            if volume < IBig::ZERO {
                volume = -volume;
                steps = steps.map(|step| -step);
            }
            if !is_inside(&steps, part_a.len() - 1, &volume) {
                return ControlFlow::Continue(());
            }
            Critical {
                numerator: IBig::ZERO,
                denominator: one(),
                steps,
                step_unit: volume,
            }
        }
        _ => return ControlFlow::Continue(()),
    };
    visitor(part_a, part_b, critical)
}

/// Whether all steps are above 0 and those of each part (the first `split`, the others) sum to below `unit`.
/// False for a `unit` of 0, which means dependent directions.
fn is_inside(steps: &[IBig], split: usize, unit: &IBig) -> bool {
    let (of_a, of_b) = steps.split_at(split);
    steps.iter().all(|step| *step > IBig::ZERO)
        && [of_a, of_b]
            .into_iter()
            .all(|part| part.iter().fold(IBig::ZERO, |sum, step| sum + step) < *unit)
}

pub(super) fn sub(p: &Vector, q: &Vector) -> Vector {
    [&p[0] - &q[0], &p[1] - &q[1], &p[2] - &q[2]]
}

pub(super) fn dot(p: &Vector, q: &Vector) -> IBig {
    &p[0] * &q[0] + &p[1] * &q[1] + &p[2] * &q[2]
}

pub(super) fn cross(p: &Vector, q: &Vector) -> Vector {
    [
        &p[1] * &q[2] - &p[2] * &q[1],
        &p[2] * &q[0] - &p[0] * &q[2],
        &p[0] * &q[1] - &p[1] * &q[0],
    ]
}

/// The exponent of the lowest bit set in any of the numbers; 0 if all are 0.
pub(super) fn common_unit(numbers: impl Iterator<Item = f64>) -> i32 {
    numbers
        .filter(|&x| x != 0.0)
        .map(|x| mantissa(x).1)
        .min()
        .unwrap_or(0)
}

/// `x = m * 2^e` with odd `m`, for finite `x` other than 0.
pub(crate) fn mantissa(x: f64) -> (i64, i32) {
    let exponent = exponent(x).max(-1022) - 52;
    let bits = x.to_bits() & ((1 << 52) - 1);
    let magnitude = if x.abs() < f64::MIN_POSITIVE {
        bits
    } else {
        bits | 1 << 52
    } as i64;
    let zeros = magnitude.trailing_zeros();
    let odd = magnitude >> zeros;
    (if x < 0.0 { -odd } else { odd }, exponent + zeros as i32)
}

/// `x / 2^unit`, a whole number.
pub(crate) fn integer(x: f64, unit: i32) -> IBig {
    if x == 0.0 {
        return IBig::ZERO;
    }
    let (mantissa, exponent) = mantissa(x);
    IBig::from(mantissa) << (exponent - unit) as usize
}

pub(super) fn integers(points: &[Point], unit: i32) -> Vec<Vector> {
    points.iter().map(|p| p.map(|x| integer(x, unit))).collect()
}

/// Weights of a part's vertices, rounded.
fn weights(part: Corners<'_>, steps: &[IBig], unit: &IBig) -> [f64; 3] {
    let mut weights = [0.0; 3];
    let mut rest = unit.clone();
    for (&k, step) in part[1..].iter().zip(steps) {
        weights[k] = ratio(step, unit);
        rest -= step;
    }
    weights[part[0]] = ratio(&rest, unit);
    weights
}

/// `numerator / denominator` in double precision, both positive, the quotient at most 1.
pub(super) fn ratio(numerator: &IBig, denominator: &IBig) -> f64 {
    let (_, numerator) = numerator.clone().into_parts();
    let (_, denominator) = denominator.clone().into_parts();
    let (quotient, shift) = long_quotient(numerator, &denominator, 1);
    ldexp(quotient.to_f64().value(), -shift)
}

/// `sqrt(numerator / denominator) * 2^unit`, rounded once in the normal range, twice among denormals.
fn root_of_ratio(numerator: IBig, denominator: IBig, unit: i32) -> f64 {
    if numerator.is_zero() {
        return 0.0;
    }
    let (_, numerator) = numerator.into_parts();
    let (_, denominator) = denominator.into_parts();
    let (quotient, shift) = long_quotient(numerator, &denominator, 2);
    let root = quotient.sqrt();
    // The root has 64 bits or more; a low bit set in place of the rest that was cut keeps the rounding right.
    let root = if &root * &root == quotient && !quotient.bit(0) {
        root
    } else {
        root | UBig::ONE
    };
    ldexp(root.to_f64().value(), unit - shift / 2)
}

/// `floor(numerator * 2^shift / denominator)` with 128 bits or more, its last bit set if the division left a rest;
/// `shift` is a multiple of `step`.
fn long_quotient(numerator: UBig, denominator: &UBig, step: i32) -> (UBig, i32) {
    let mut shift = 130 + denominator.bit_len() as i32 - numerator.bit_len() as i32;
    shift -= shift.rem_euclid(step);
    let (numerator, denominator) = if shift >= 0 {
        (numerator << shift as usize, denominator.clone())
    } else {
        (numerator, denominator << (-shift) as usize)
    };
    let quotient = &numerator / &denominator;
    let sticky = if &quotient * &denominator == numerator {
        UBig::ZERO
    } else {
        UBig::ONE
    };
    (quotient | sticky, shift)
}

//! How far from a hit the next distinct hit may be.

use super::units::{Shape, Unit, Units};
use crate::context::Context;
use crate::scalar::Real;

/// Bisections along each axis.
const BISECTIONS: usize = 20;

/// For each axis, the distance from a hit at `hit` along that axis beyond which positions are no longer the same hit: the
/// separation radius as the problem defines it, found by asking. A cell on an integer axis.
///
/// Cost: 20 look-ups an axis.
pub(super) fn reach<S: Real>(
    context: &dyn Context<S>,
    units: &Units,
    hit: &[f64],
    position: &mut [S],
) -> Vec<f64> {
    let mut x = hit.to_vec();
    let mut along = |j: usize| {
        let unit = units.axes[j];
        if unit.shape == Shape::Category {
            // Every other category is distinct.
            return 0.5 / unit.cells;
        }
        if unit.cells > 0.0 {
            return 1.0 / unit.cells;
        }
        let sign = if hit[j] < 0.5 { 1.0 } else { -1.0 };
        let (_, distinct) = border((0.0, 0.5), |distance| {
            x[j] = hit[j] + sign * distance;
            units.to_position(context.space(), &x, position);
            context.is_deleted(position)
        });
        x[j] = hit[j];
        distinct
    };
    (0..units.len()).map(&mut along).collect()
}

/// The last place that is the same hit and the first one that is not, between one of either.
fn border((mut same, mut distinct): (f64, f64), mut is_same: impl FnMut(f64) -> bool) -> (f64, f64) {
    for _ in 0..BISECTIONS {
        let middle = f64::midpoint(same, distinct);
        if is_same(middle) {
            same = middle;
        } else {
            distinct = middle;
        }
    }
    (same, distinct)
}

/// The middle of what is the same hit as `hit` around it: halfway along each straight axis, one after the other, which leads to the centre
/// of a ball or a box. Along an axis on which that goes as far as the space does, or farther than half an axis, it stays where it is.
///
/// Cost: 40 look-ups an axis.
pub(super) fn middle<S: Real>(
    context: &dyn Context<S>,
    units: &Units,
    hit: &[f64],
    position: &mut [S],
) -> Vec<f64> {
    let mut x = hit.to_vec();
    let straight = |unit: &Unit| unit.cells == 0.0 && unit.shape == Shape::Line;
    for j in (0..units.len()).filter(|&j| straight(&units.axes[j])) {
        let from = x[j];
        let mut extent = |end: f64| {
            let mut is_same = |at: f64| {
                x[j] = at;
                units.to_position(context.space(), &x, position);
                context.is_deleted(position)
            };
            (!is_same(end)).then(|| border((from, end), is_same).0)
        };
        let lower = extent((from - 0.5).max(0.0));
        let upper = extent((from + 0.5).min(1.0));
        x[j] = lower.zip(upper).map_or(from, |(a, b)| f64::midpoint(a, b));
    }
    x
}

/// Squared distance of two points in reaches; equal points are 0 apart, others at least 1 where a reach is not known.
pub(super) fn square(units: &Units, a: &[f64], b: &[f64], reach: &[f64]) -> f64 {
    squares(units, a, b, reach).sum()
}

/// Whether two points are at most so many reaches apart.
pub(super) fn is_within(units: &Units, a: &[f64], b: &[f64], reach: &[f64], reaches: f64) -> bool {
    is_at_most(squares(units, a, b, reach), reaches * reaches)
}

/// Whether the sum of squares is at most this. Most points are too far apart along the first axis already.
#[inline]
pub(super) fn is_at_most(mut squares: impl Iterator<Item = f64>, most: f64) -> bool {
    let mut sum = 0.0;
    squares.all(|square| {
        sum += square;
        sum <= most
    })
}

/// The share of each axis in the squared distance.
#[inline]
fn squares(units: &Units, a: &[f64], b: &[f64], reach: &[f64]) -> impl Iterator<Item = f64> {
    let along = |(((a, b), reach), unit): (((&f64, &f64), &f64), &Unit)| {
        if *reach > 0.0 {
            (unit.difference(*a, *b) / reach).powi(2)
        } else {
            f64::from(u8::from(a != b))
        }
    };
    a.iter().zip(b).zip(reach).zip(&units.axes).map(along)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::{Axis, Space};

    #[test]
    fn within_so_many_reaches_is_by_the_sum_of_all_axes() {
        let periodic = Axis::continuous(0.0, 1.0).periodic();
        let space = Space::<f64>::new([Axis::continuous(0.0, 1.0), periodic, Axis::categorical(4)]).unwrap();
        let units = Units::of(&space);
        let (centre, reach) = ([0.5, 0.95, 0.125], [0.1, 0.2, 0.0]);
        let mut within = 0;
        for i in 0..1_000_u32 {
            let at = |step: f64| (f64::from(i) * step).fract();
            let x = [
                at(0.754_877),
                at(0.569_840),
                (at(0.381) * 4.0).floor() / 4.0 + 0.125,
            ];
            let by_the_sum = square(&units, &centre, &x, &reach) <= 4.0;
            assert_eq!(is_within(&units, &centre, &x, &reach, 2.0), by_the_sum, "{x:?}");
            within += usize::from(by_the_sum);
        }
        // An ellipse with half axes of 0.2 and 0.4 in a quarter of the space, and one of three quarters of its area in the rest: 0.204.
        assert!((190..220).contains(&within), "{within}");
    }
}

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
        let (mut same, mut distinct) = (0.0, 0.5);
        for _ in 0..BISECTIONS {
            let middle = (same + distinct) / 2.0;
            x[j] = hit[j] + sign * middle;
            units.to_position(context.space(), &x, position);
            if context.is_deleted(position) {
                same = middle;
            } else {
                distinct = middle;
            }
        }
        x[j] = hit[j];
        distinct
    };
    (0..units.len()).map(&mut along).collect()
}

/// Squared distance of two points in reaches; equal points are 0 apart, others at least 1 where a reach is not known.
pub(super) fn square(units: &Units, a: &[f64], b: &[f64], reach: &[f64]) -> f64 {
    let along = |(((a, b), reach), unit): (((&f64, &f64), &f64), &Unit)| {
        if *reach > 0.0 {
            (unit.difference(*a, *b) / reach).powi(2)
        } else {
            f64::from(u8::from(a != b))
        }
    };
    a.iter().zip(b).zip(reach).zip(&units.axes).map(along).sum()
}

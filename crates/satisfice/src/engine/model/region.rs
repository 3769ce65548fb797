//! Which points the model knows.

use super::failures::tells;
use super::record::Record;
use super::scales::Scales;
use super::units::{Shape, Units};
use crate::seed::SearchRng;

/// Share of the local models whose centre is a hit, where there is one.
const AROUND_HITS: f64 = 0.7;
/// Points of a local model.
const LOCAL: usize = 128;

/// The points of a model and the box in which it proposes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TrustRegion {
    /// Indices of points, in ascending order up to the first that was added.
    pub(super) known: Vec<usize>,
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
}

impl TrustRegion {
    /// All points and the whole space.
    pub(super) fn whole(record: &Record, units: &Units) -> Self {
        Self {
            known: known(record, units).collect(),
            lower: vec![0.0; record.axes()],
            upper: vec![1.0; record.axes()],
        }
    }

    /// The points next to a random one, usually a hit, and the box around them.
    pub(super) fn local(
        record: &Record,
        units: &Units,
        scales: &Scales,
        most: usize,
        rng: &mut SearchRng,
    ) -> Self {
        let all: Vec<usize> = known(record, units).collect();
        let centre = if !record.hits.is_empty() && rng.uniform() < AROUND_HITS {
            record.hits[rng.below(record.hits.len())]
        } else {
            all[rng.below(all.len())]
        };
        let centre = record.point(centre);
        let inverses: Vec<f64> = (0..scales.axes()).map(|j| 1.0 / scales.length(j)).collect();
        let distance = |i: usize| -> f64 {
            let pairs = record.point(i).iter().zip(centre).zip(&inverses).zip(&units.axes);
            pairs
                .map(|(((a, b), s), unit)| (unit.difference(*a, *b) * s).powi(2))
                .sum()
        };
        let mut order: Vec<(f64, usize)> = all.into_iter().map(|i| (distance(i), i)).collect();
        let count = LOCAL.min(most).min(order.len()).max(1);
        order.select_nth_unstable_by(count - 1, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut known: Vec<usize> = order[..count].iter().map(|&(_, i)| i).collect();
        known.sort_unstable();
        let mut region = Self {
            known,
            lower: vec![1.0; scales.axes()],
            upper: vec![0.0; scales.axes()],
        };
        for &i in &region.known {
            for ((lower, upper), &x) in region
                .lower
                .iter_mut()
                .zip(&mut region.upper)
                .zip(record.point(i))
            {
                *lower = lower.min(x);
                *upper = upper.max(x);
            }
        }
        // A circle has no ends, and categories no order.
        let ends = region.lower.iter_mut().zip(&mut region.upper);
        for ((lower, upper), unit) in ends.zip(&units.axes) {
            if matches!(unit.shape, Shape::Circle | Shape::Category) {
                (*lower, *upper) = (0.0, 1.0);
            }
        }
        region
    }
}

/// The points that a model learns from.
fn known(record: &Record, units: &Units) -> impl Iterator<Item = usize> {
    (0..record.len()).filter(|&i| tells(record, units, i))
}

//! Regions that are split in two, for branch and bound and for the exclusion of regions without hits.

use core::cmp::Ordering;

use crate::scalar::Real;
use crate::space::{Axis, AxisKind, Region, Space};

/// Whether an axis has values that can be counted: integers, categories or the ranks of a permutation.
fn is_discrete<S: Real>(axis: &Axis<S>) -> bool {
    axis.kind() != AxisKind::Continuous
}

/// A waiting region with its bound.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(in crate::engine) struct Node<S> {
    pub(in crate::engine) bound: S,
    /// F at a point inside, infinite if unknown.
    pub(in crate::engine) guide: S,
    pub(in crate::engine) index: u64,
    pub(in crate::engine) region: Region<S>,
}

impl<S: Real> Node<S> {
    /// The number of points if finite, as a real; of permutations, no less than the number of orders inside.
    pub(in crate::engine) fn cardinality(&self, space: &Space<S>) -> Option<f64> {
        let sides = self.region.lower.iter().zip(&self.region.upper);
        space
            .axes()
            .iter()
            .zip(sides)
            .try_fold(1.0, |points, (axis, (&lower, &upper))| {
                if is_discrete(axis) {
                    Some(points * ((upper - lower).f64() + 1.0))
                } else {
                    (lower == upper).then_some(points)
                }
            })
    }

    /// Values inside: on continuous axes in the middle half of the positions, at a place that depends on the index and the attempt
    /// only.
    ///
    /// Midpoints fail: hits on a regular grid leave points that are a separation away from several hits, and no region
    /// around such a point is covered by a single hit.
    pub(in crate::engine) fn inner_point(&self, space: &Space<S>, attempt: u64) -> Vec<S> {
        let inside = |(axis, kind): (usize, &Axis<S>)| {
            let (lower, upper) = (self.region.lower[axis], self.region.upper[axis]);
            if is_discrete(kind) {
                return self.region.middle(space, axis);
            }
            let share = S::of(0.25 + 0.5 * scatter(self.index, attempt, axis));
            kind.value_between(lower, upper, share)
        };
        let mut values: Vec<S> = space.axes().iter().enumerate().map(inside).collect();
        // Regions without an order are not entered.
        space.order_inside(&self.region, &mut values);
        values
    }

    /// Values inside a region of countable points: the places of permutations are exchanged, as far as they stay inside, so that regions inside
    /// one another do not give one point.
    pub(in crate::engine) fn exchanged_point(&self, space: &Space<S>) -> Vec<S> {
        let mut values = self.inner_point(space, 0);
        let mut draws = 0;
        space.shuffle_inside(&self.region, &mut values, &mut |places| {
            draws += 1;
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                clippy::cast_precision_loss,
                reason = "below the number of places"
            )]
            let place = (scatter(self.index, 0, draws) * places.len() as f64) as usize;
            places.start + place
        });
        values
    }

    /// Visits the positions of all points of a finite region, the last axis fastest.
    pub(in crate::engine) fn each_point(&self, space: &Space<S>, mut visit: impl FnMut(&[S])) {
        let Region { lower, upper } = &self.region;
        let mut values = lower.clone();
        let mut position = values.clone();
        loop {
            if space.first_repeated(&values).is_none() {
                position.copy_from_slice(&values);
                space.positions(&mut position);
                visit(&position);
            }
            let Some(axis) = (0..values.len()).rev().find(|&j| values[j] < upper[j]) else {
                return;
            };
            values[axis] = values[axis] + S::one();
            values[axis + 1..].copy_from_slice(&lower[axis + 1..]);
        }
    }
}

/// A number in `[0, 1)`, by the finaliser of `SplitMix64` (Steele, Lea, Flood 2014, doi 10.1145/2660193.2660195).
#[expect(clippy::cast_precision_loss, reason = "53 bits are exact")]
fn scatter(index: u64, attempt: u64, axis: usize) -> f64 {
    let mut z = (index << 24 ^ attempt << 16 ^ (axis as u64 + 1)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ z >> 31) >> 11) as f64 / (1_u64 << 53) as f64
}

/// The greatest comes first: least bound, then least guide, then the latest.
impl<S: Real> Ord for Node<S> {
    fn cmp(&self, other: &Self) -> Ordering {
        let (own, others) = (
            (self.bound.f64(), self.guide.f64()),
            (other.bound.f64(), other.guide.f64()),
        );
        others
            .0
            .total_cmp(&own.0)
            .then(others.1.total_cmp(&own.1))
            .then(self.index.cmp(&other.index))
    }
}
impl<S: Real> PartialOrd for Node<S> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl<S: Real> PartialEq for Node<S> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl<S: Real> Eq for Node<S> {}

/// The result of a split.
pub(in crate::engine) enum Split<S> {
    /// Both halves; continuous ones share their face.
    Halves(Region<S>, Region<S>),
    /// No axis can be split any more.
    TooSmall,
}

/// The rule that chooses the axis to split.
#[derive(Debug, Clone, Copy)]
pub(in crate::engine) struct Splitter<S> {
    /// The first axis that is not fixed instead of the longest.
    pub(in crate::engine) first: bool,
    /// Share of a continuous axis, of the logarithms of a logarithmic one, below which it is not split.
    pub(in crate::engine) resolution: S,
}

impl<S: Real> Splitter<S> {
    /// Splits in the [middle](Region::middle).
    pub(in crate::engine) fn split(&self, space: &Space<S>, region: &Region<S>) -> Split<S> {
        let mut chosen: Option<(usize, S)> = None;
        for (j, axis) in space.axes().iter().enumerate() {
            let (lower, upper) = (region.lower[j], region.upper[j]);
            let share = axis.share_between(lower, upper);
            let splits = lower < upper && (is_discrete(axis) || share > self.resolution);
            if splits && chosen.is_none_or(|(_, longest)| !self.first && share > longest) {
                chosen = Some((j, share));
            }
        }
        let Some((j, _)) = chosen else {
            return Split::TooSmall;
        };
        let (mut lower, mut upper) = (region.clone(), region.clone());
        let middle = region.middle(space, j);
        if is_discrete(&space.axes()[j]) {
            lower.upper[j] = middle;
            upper.lower[j] = middle + S::one();
        } else if region.lower[j] < middle && middle < region.upper[j] {
            lower.upper[j] = middle;
            upper.lower[j] = middle;
        } else {
            // No number lies between the ends: each of them is a half.
            lower.upper[j] = region.lower[j];
            upper.lower[j] = region.upper[j];
        }
        Split::Halves(lower, upper)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first outputs of `SplitMix64` from state 0, by the authors' code.
    #[test]
    fn places_are_numbers_of_splitmix64() {
        for (axis, word) in [(0, 0xe220_a839_7b1d_cdaf_u64), (1, 0x6e78_9e6a_a1b9_65f4)] {
            assert_eq!(scatter(0, 0, axis), (word >> 11) as f64 / 2_f64.powi(53));
        }
    }
}

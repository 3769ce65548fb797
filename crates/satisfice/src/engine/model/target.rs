//! What the model learns in place of F, or of its components.

use super::limits::{ComponentLimits, Norm};
use super::record::Record;

/// Share of the misses whose excess over delta is not clipped.
const UNCLIPPED: f64 = 0.8;

/// Share of the magnitudes of a component that are below the unit in which it is learned.
const IN_UNIT: f64 = 0.8;
/// Largest value that is learned of a component.
const FARTHEST: f64 = 4.0;

/// Fewest values that tell whether F is a step function.
const ENOUGH: usize = 16;
/// Values that differ by less than this share of their range are one level: sums in another order.
const SAME_LEVEL: f64 = 1e-9;

/// `F - delta`, clipped on both sides at a quantile of the misses: how bad a bad point is does not matter, and a few huge
/// values would flatten the rest. Where F is a step function, delta is between the levels of hits and of misses.
///
/// Where the components of F are known, their inverse hyperbolic sines in units of a quantile of their magnitudes: these keep the sign
/// and the slope at 0, and huge values become bearable.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Target {
    pub(super) delta: f64,
    pub(super) clip: f64,
    /// The units of the components; none where F itself is learned.
    pub(super) units: Vec<f64>,
    /// Which of them are those of a hit.
    pub(super) norm: Norm,
}

impl Target {
    /// The clip for these values, NaN if one is missing.
    pub(super) fn new(delta: f64, values: &[f64]) -> Self {
        let delta = between_levels(delta, values);
        let excess = values.iter().map(|value| value - delta);
        let mut misses: Vec<f64> = excess.filter(|&e| e >= 0.0 && e.is_finite()).collect();
        let clip = at_share(&mut misses, UNCLIPPED).filter(|&clip| clip > 0.0);
        let last = misses.last().copied();
        Self {
            delta,
            clip: clip.or(last.filter(|&last| last > 0.0)).unwrap_or(1.0),
            units: Vec::new(),
            norm: Norm::Greatest,
        }
    }

    /// The same with units for the components at these points, if the record has them. No unit is below a component's limit. `threshold`: F is
    /// below it at hits.
    pub(super) fn with_components(mut self, record: &Record, known: &[usize], threshold: f64) -> Self {
        let unit = |k: usize| {
            let magnitudes = known.iter().map(|&i| record.components(i)[k].abs());
            let mut all: Vec<f64> = magnitudes.filter(|x| x.is_finite()).collect();
            at_share(&mut all, IN_UNIT).map_or(1.0, |unit| unit.max(1.0))
        };
        self.units = (0..record.component_count()).map(unit).collect();
        self.norm = Norm::of(record, known, threshold);
        self
    }

    /// The values to learn of point `i`.
    pub(super) fn of_point(&self, record: &Record, i: usize) -> Vec<f64> {
        if self.units.is_empty() {
            return vec![self.of(record.values[i])];
        }
        let of = |(x, unit): (&f64, &f64)| {
            if x.is_nan() {
                FARTHEST
            } else {
                (x / unit).asinh().clamp(-FARTHEST, FARTHEST)
            }
        };
        record.components(i).iter().zip(&self.units).map(of).collect()
    }

    /// The limits of the components' values at a hit.
    pub(super) fn limits(&self) -> ComponentLimits {
        let values = self.units.iter().map(|unit| (1.0 / unit).asinh());
        ComponentLimits::new(self.norm, values.collect())
    }

    /// The value to learn, from -1 to 1: negative for a hit. A missing value counts as bad.
    pub(super) fn of(&self, value: f64) -> f64 {
        if value.is_nan() {
            return 1.0;
        }
        ((value - self.delta) / self.clip).clamp(-1.0, 1.0)
    }
}

/// Where most values repeat others: halfway between the greatest of a hit and the least of a miss, as far as these are known or follow
/// from the least difference of two values. Otherwise a miss whose value is `delta` itself, such as a single violated constraint where
/// hits are below 1, would look as good as a hit. Everywhere else `delta`.
fn between_levels(delta: f64, values: &[f64]) -> f64 {
    let mut levels: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    levels.sort_unstable_by(f64::total_cmp);
    let count = levels.len();
    let (Some(&least), Some(&greatest)) = (levels.first(), levels.last()) else {
        return delta;
    };
    let same = SAME_LEVEL * (greatest - least);
    levels.dedup_by(|next, last| *next - *last <= same);
    if count < ENOUGH || 2 * levels.len() > count {
        return delta;
    }
    let hits = levels.partition_point(|&level| level < delta);
    let gaps = levels.windows(2).map(|pair| pair[1] - pair[0]);
    let gap = gaps.fold(f64::INFINITY, f64::min);
    let Some(&miss) = levels.get(hits) else {
        return delta;
    };
    // Levels that are a gap apart, from the least miss down to the first below delta.
    let below = miss - gap * (((miss - delta) / gap).floor() + 1.0);
    let hit = hits.checked_sub(1).map_or(below, |last| levels[last].max(below));
    let between = hit + gap / 2.0;
    if between.is_finite() {
        between.min(delta)
    } else {
        delta
    }
}

/// Sorts values and returns the one that this share of them is below; `None` if there are none.
fn at_share(values: &mut [f64], share: f64) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "an index"
    )]
    let index = (values.len() as f64 * share) as usize;
    values.get(index).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::model::record::PointKind;

    #[test]
    fn high_values_are_clipped_and_missing_ones_count_as_high() {
        let values = [0.0, 2.0, 3.0, 4.0, 5.0, 1e9, f64::NAN];
        let target = Target::new(1.0, &values);
        assert_eq!(target.clip, 1e9 - 1.0);
        let target = Target::new(1.0, &[0.0, 2.0, 3.0, 4.0, 5.0, 6.0, 1e9, f64::NAN]);
        assert_eq!(target.clip, 5.0);
        assert_eq!(target.of(f64::NAN), 1.0);
        assert_eq!(target.of(1e9), 1.0);
        assert_eq!(target.of(0.0), -0.2);
    }

    #[test]
    fn the_threshold_of_a_step_function_is_between_its_levels() {
        let learned = |delta: f64, levels: &[f64]| between_levels(delta, &levels.repeat(16));
        // A count of what is violated, with and without a hit so far.
        assert_eq!(learned(1.0, &[1.0, 2.0, 3.0]), 0.5);
        assert_eq!(learned(1.0, &[0.0, 1.0, 3.0]), 0.5);
        assert_eq!(learned(0.5, &[2.0, 3.0, 7.0]), 0.5);
        // What is known of hits counts; never is it above delta.
        assert_eq!(learned(1.0, &[0.75, 1.0, 2.0]), 0.875);
        assert_eq!(learned(0.6, &[1.0, 2.0]), 0.5);
        assert_eq!(learned(0.1, &[1.0, 2.0]), 0.1);
        // Sums whose order differs are one level.
        assert_eq!(learned(1.0, &[1.0, 1.0 + 1e-15, 2.0, 3.0]), 0.5);
        // One level alone says nothing, nor do hits alone, values without a limit, or a few.
        assert_eq!(learned(1.0, &[1.0]), 1.0);
        assert_eq!(learned(1.0, &[0.0, 0.5]), 1.0);
        assert_eq!(learned(1.0, &[-f64::MAX, f64::MAX, f64::NAN, f64::INFINITY]), 1.0);
        assert_eq!(learned(1.0, &[]), 1.0);
        assert_eq!(between_levels(1.0, &[1.0, 2.0, 2.0]), 1.0);
        // Nor where values do not repeat.
        let slope: Vec<f64> = (0..40).map(|i| f64::from(i) / 8.0).collect();
        assert_eq!(between_levels(1.0, &slope), 1.0);
    }

    #[test]
    fn components_are_learned_with_their_signs_in_units_of_their_own() {
        let mut record = Record::default();
        record.clear(1);
        for i in 0..10_u32 {
            let x = f64::from(i);
            record.add(&[x / 10.0], x, PointKind::Miss);
            record.add_components(&[100.0 * (x - 5.0), x / 100.0]);
        }
        record.add(&[0.95], f64::NAN, PointKind::Miss);
        record.add_components(&[f64::NAN, f64::NEG_INFINITY]);
        let target =
            Target::new(1.0, &record.values).with_components(&record, &(0..11).collect::<Vec<_>>(), 1.0);
        // The ninth of ten magnitudes; and never less than the limit.
        assert_eq!(target.units, [400.0, 1.0]);
        assert_eq!(target.of_point(&record, 5), [0.0, 0.05_f64.asinh()]);
        assert_eq!(target.of_point(&record, 0), [-(1.25_f64.asinh()), 0.0]);
        assert_eq!(target.of_point(&record, 10), [FARTHEST, -FARTHEST]);
        let squares = [0, 1].map(|k| target.limits().square(k) / core::f64::consts::FRAC_2_PI);
        let limits = squares.map(f64::sqrt);
        approx::assert_relative_eq!(limits[0], 0.0025_f64.asinh(), max_relative = 1e-12);
        approx::assert_relative_eq!(limits[1], 1.0_f64.asinh(), max_relative = 1e-12);
    }

    #[test]
    fn there_is_a_clip_without_misses() {
        assert_eq!(Target::new(1.0, &[0.0, 0.5]).clip, 1.0);
        assert_eq!(Target::new(1.0, &[1.0, 1.0]).clip, 1.0);
        assert_eq!(Target::new(1.0, &[]).clip, 1.0);
    }
}

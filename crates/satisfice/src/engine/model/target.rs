//! What the model learns in place of F.

/// Share of the misses whose excess over delta is not clipped.
const UNCLIPPED: f64 = 0.8;

/// `F - delta`, clipped on both sides at a quantile of the misses: how bad a bad point is does not matter, and a few huge
/// values would flatten the rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Target {
    pub(super) delta: f64,
    pub(super) clip: f64,
}

impl Target {
    /// The clip for these values, NaN if one is missing.
    pub(super) fn new(delta: f64, values: &[f64]) -> Self {
        let excess = values.iter().map(|value| value - delta);
        let mut misses: Vec<f64> = excess.filter(|&e| e >= 0.0 && e.is_finite()).collect();
        misses.sort_unstable_by(f64::total_cmp);
        #[expect(
            clippy::cast_precision_loss,
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "an index"
        )]
        let index = (misses.len() as f64 * UNCLIPPED) as usize;
        let last = misses.last().copied();
        let clip = misses.get(index).copied().filter(|&clip| clip > 0.0);
        Self {
            delta,
            clip: clip.or(last.filter(|&last| last > 0.0)).unwrap_or(1.0),
        }
    }

    /// The value to learn, from -1 to 1: negative for a hit. A missing value counts as bad.
    pub(super) fn of(&self, value: f64) -> f64 {
        if value.is_nan() {
            return 1.0;
        }
        ((value - self.delta) / self.clip).clamp(-1.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn there_is_a_clip_without_misses() {
        assert_eq!(Target::new(1.0, &[0.0, 0.5]).clip, 1.0);
        assert_eq!(Target::new(1.0, &[1.0, 1.0]).clip, 1.0);
        assert_eq!(Target::new(1.0, &[]).clip, 1.0);
    }
}

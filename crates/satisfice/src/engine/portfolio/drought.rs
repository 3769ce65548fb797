//! How long no source has found a hit.

/// So many evaluations without a hit, for each axis and five more, are a drought: several local searches. Where hits are many, so many
/// for each: there is more to go on from.
const LONG: u64 = 400;
const LONG_FOR_A_HIT: u64 = 200;

/// Evaluations since the last hit.
#[derive(Debug, Clone, Copy, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Drought {
    evaluations: u64,
}

impl Drought {
    /// Counts one candidate.
    pub(super) fn count(&mut self, hit: bool) {
        self.evaluations = if hit { 0 } else { self.evaluations + 1 };
    }

    /// Whether it is time for what is made for hits that are hard to reach.
    pub(super) fn is_long(&self, dimension: usize, hits: usize) -> bool {
        let by_axes = LONG.saturating_mul(dimension as u64 + 5);
        self.evaluations >= by_axes.max(LONG_FOR_A_HIT.saturating_mul(hits as u64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hit_ends_a_drought() {
        let mut drought = Drought::default();
        for _ in 0..2800 {
            assert!(!drought.is_long(2, 14));
            drought.count(false);
        }
        assert!(drought.is_long(2, 14) && !drought.is_long(3, 14) && !drought.is_long(2, 15));
        drought.count(true);
        assert!(!drought.is_long(2, 0));
    }
}

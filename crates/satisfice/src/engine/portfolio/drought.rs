//! How long no source has found a hit.

/// So many evaluations, for each axis and five more, without a hit are a drought: several local searches.
const LONG: u64 = 400;

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
    pub(super) fn is_long(&self, dimension: usize) -> bool {
        self.evaluations >= LONG.saturating_mul(dimension as u64 + 5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hit_ends_a_drought() {
        let mut drought = Drought::default();
        for _ in 0..2800 {
            assert!(!drought.is_long(2));
            drought.count(false);
        }
        assert!(drought.is_long(2) && !drought.is_long(3));
        drought.count(true);
        assert!(!drought.is_long(2));
    }
}

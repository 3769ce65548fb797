//! What a model expects of its own proposals.

/// Proposals after which a past one counts for 1/e.
const MEMORY: f64 = 16.0;
/// So many proposals tell.
const ENOUGH: u64 = 24;
/// Hits for each proposal, below which the model knows of none within reach.
const LITTLE: f64 = 0.003;

/// The mean of the probabilities to hit of the latest proposals, by the model of the components of F.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Promise {
    proposals: u64,
    mean: f64,
}

impl Promise {
    /// Counts a proposal that is this probable to hit.
    pub(super) fn count(&mut self, probability: f64) {
        self.proposals += 1;
        let weight = (1.0 / self.proposals as f64).max(1.0 / MEMORY);
        self.mean += weight * (probability - self.mean);
    }

    /// Whether its latest proposals are all improbable.
    pub(super) fn is_little(&self) -> bool {
        self.proposals >= ENOUGH && self.mean < LITTLE
    }

    pub(super) fn saved(&self) -> (u64, f64) {
        (self.proposals, self.mean)
    }

    pub(super) fn restored((proposals, mean): (u64, f64)) -> Self {
        Self { proposals, mean }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_that_expects_nothing_is_told_from_one_between_two_roots() {
        let (mut hopeless, mut promise) = (Promise::default(), Promise::default());
        for i in 1..=100 {
            hopeless.count(1e-6);
            assert_eq!(hopeless.is_little(), i >= ENOUGH, "{i}");
            promise.count(if i % 16 == 0 { 0.5 } else { 0.0 });
            assert!(!promise.is_little() || i < 32, "{i}");
        }
        hopeless.count(0.5);
        assert!(!hopeless.is_little());
        assert_eq!(Promise::restored(hopeless.saved()), hopeless);
    }
}

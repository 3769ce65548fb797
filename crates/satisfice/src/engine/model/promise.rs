//! What a model expects of its own proposals.

/// Proposals after which a past one counts for 1/e.
const MEMORY: f64 = 16.0;
/// So many proposals tell.
const ENOUGH: u64 = 24;
/// Hits for each proposal, below which the model knows of none within reach.
const LITTLE: f64 = 0.003;

/// The probabilities to hit of a model's proposals.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Promise {
    proposals: u64,
    /// Mean of the latest ones.
    mean: f64,
    /// Hits that it has promised in all, and those that came.
    promised: f64,
    kept: u64,
}

impl Promise {
    /// Counts a proposal that is this probable to hit.
    pub(super) fn count(&mut self, probability: f64) {
        self.proposals += 1;
        self.promised += probability;
        let weight = (1.0 / self.proposals as f64).max(1.0 / MEMORY);
        self.mean += weight * (probability - self.mean);
    }

    /// Whether its latest proposals are all improbable.
    pub(super) fn is_little(&self) -> bool {
        self.proposals >= ENOUGH && self.mean < LITTLE
    }

    /// Counts a proposal that has hit.
    pub(super) fn keep(&mut self) {
        self.kept += 1;
    }

    /// What is left of this probability for somebody who compares the hits that came with those that were promised.
    pub(super) fn believed(&self, probability: f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a count of evaluations")]
        let kept = self.kept as f64;
        probability * (1.0 + kept) / (1.0 + self.promised)
    }

    pub(super) fn saved(&self) -> (u64, f64, f64, u64) {
        (self.proposals, self.mean, self.promised, self.kept)
    }

    pub(super) fn restored((proposals, mean, promised, kept): (u64, f64, f64, u64)) -> Self {
        Self {
            proposals,
            mean,
            promised,
            kept,
        }
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

    #[test]
    fn it_is_believed_by_the_hits_that_came() {
        let mut promise = Promise::default();
        assert_eq!(promise.believed(0.5), 0.5);
        promise.count(0.5);
        promise.count(0.5);
        assert_eq!(promise.believed(0.5), 0.25);
        promise.keep();
        assert_eq!(promise.believed(0.5), 0.5);
        promise.keep();
        assert_eq!(promise.believed(0.5), 0.75);
        assert_eq!(Promise::restored(promise.saved()), promise);
    }
}

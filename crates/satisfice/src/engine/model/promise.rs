//! What a model expects of its own proposals.

/// Proposals after which a past one counts for 1/e.
const MEMORY: f64 = 16.0;
/// So many proposals tell.
const ENOUGH: u64 = 24;
/// Hits for each proposal, below which the model knows of none within reach.
const LITTLE: f64 = 0.003;

/// A proposal counts as a hit to come if it is more probable than this.
const CREDIBLE: f64 = 0.5;

/// The probabilities to hit of a model's proposals.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Promise {
    proposals: u64,
    /// Mean of the latest ones.
    mean: f64,
    /// Hits that it has promised in all.
    promised: f64,
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

    /// Whether a hit of this probability is to be expected by somebody who has seen no hit of all that were promised: the probability is
    /// divided by one more than those.
    pub(super) fn is_credible(&self, probability: f64) -> bool {
        probability > CREDIBLE * (1.0 + self.promised)
    }

    /// Whether no probability is credible any more.
    pub(super) fn is_broken(&self) -> bool {
        !self.is_credible(1.0)
    }

    pub(super) fn saved(&self) -> (u64, f64, f64) {
        (self.proposals, self.mean, self.promised)
    }

    pub(super) fn restored((proposals, mean, promised): (u64, f64, f64)) -> Self {
        Self {
            proposals,
            mean,
            promised,
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
    fn who_promised_a_hit_and_had_none_is_believed_half_as_much() {
        let mut promise = Promise::default();
        assert!(promise.is_credible(0.51) && !promise.is_credible(0.49));
        promise.count(0.6);
        assert!(promise.is_credible(0.81) && !promise.is_credible(0.79) && !promise.is_broken());
        promise.count(0.5);
        assert!(promise.is_broken() && !promise.is_credible(1.0));
        assert_eq!(Promise::restored(promise.saved()), promise);
    }
}

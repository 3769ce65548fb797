//! How large the engines are, by the budget.

use crate::context::Context;
use crate::scalar::Real;

/// Candidates that compete for a proposal of the model, at least and at most. While fewer points than this are known there are more of them, so
/// that a proposal takes as long as with the least number at so many points.
const CANDIDATES: (usize, usize) = (256, 1024);
const POINTS_OF_LEAST: f64 = 300.0;
/// Proposals of the model, at most; none where more than `MOST_PLANNED` evaluations are planned, unless the problem tells the components of F.
pub(super) const MOST_PROPOSALS: u64 = 1_000;
const MOST_PLANNED: u64 = 10_000;
/// Proposals of the model in one batch: as many as evaluations go on at once, and so many at most.
const MOST_PROPOSALS_AT_ONCE: usize = 32;
/// Seconds of a proposal of the model.
const PROPOSAL: f64 = 5e-4;
/// Searches of (1+1)-CMA-ES, at most: one for each four evaluations that go on at once.
const MOST_SEARCHES: usize = 64;
/// Regions that are split at once: one for so many evaluations planned, and so many at most, or as many as the batch has points.
const EVALUATIONS_OF_A_REGION: u64 = 64;
const MOST_REGIONS: usize = 8;

/// What depends on the budget.
#[derive(Debug, Clone, Copy, serde::Serialize, serde::Deserialize)]
pub(super) struct Sizes {
    /// Searches of (1+1)-CMA-ES side by side.
    pub(super) searches: usize,
    /// Candidates of the model.
    pub(super) candidates: usize,
    /// Proposals of the model, at most, and in one batch.
    pub(super) proposals: u64,
    pub(super) proposals_at_once: usize,
    /// Regions that are split at once, at least.
    pub(super) regions: usize,
}

impl Default for Sizes {
    fn default() -> Self {
        Self::of(1, None)
    }
}

impl Sizes {
    pub(super) fn new<S: Real>(context: &dyn Context<S>) -> Self {
        let (planned, components) = (context.evaluations_planned(), context.component_count());
        let sizes = Self::of(context.parallel(), planned);
        let proposals = planned.map_or(MOST_PROPOSALS, |planned| {
            proposals(
                (planned, context.islands()),
                components,
                context.seconds_planned(),
            )
        });
        if context.is_in_any_order() {
            // Each search is an [engine of its own](super::side_by_side).
            return Self {
                proposals,
                searches: 1,
                proposals_at_once: 1,
                ..sizes
            };
        }
        Self { proposals, ..sizes }
    }

    /// For so many evaluations at once, and so many in all, if that is known.
    fn of(parallel: usize, planned: Option<u64>) -> Self {
        let (least, most) = CANDIDATES;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive, and a conversion from float saturates"
        )]
        let candidates = planned.map_or(least, |planned| {
            let more = (POINTS_OF_LEAST / planned.max(1) as f64).powi(2);
            ((least as f64 * more) as usize).clamp(least, most)
        });
        Self {
            searches: searches(parallel),
            candidates,
            proposals: MOST_PROPOSALS,
            proposals_at_once: parallel.clamp(1, MOST_PROPOSALS_AT_ONCE),
            regions: planned.map_or(MOST_REGIONS, |planned| {
                usize::try_from(planned / EVALUATIONS_OF_A_REGION)
                    .unwrap_or(MOST_REGIONS)
                    .clamp(1, MOST_REGIONS)
            }),
        }
    }

    pub(super) fn are_possible(&self) -> bool {
        (1..=MOST_SEARCHES).contains(&self.searches)
            && (CANDIDATES.0..=CANDIDATES.1).contains(&self.candidates)
            && self.proposals <= MOST_PROPOSALS
            && (1..=MOST_PROPOSALS_AT_ONCE).contains(&self.proposals_at_once)
            && (1..=MOST_REGIONS).contains(&self.regions)
    }
}

/// Searches side by side where so many evaluations go on at once.
pub(super) fn searches(parallel: usize) -> usize {
    parallel.div_ceil(4).clamp(1, MOST_SEARCHES)
}

/// How many proposals the model may make where so many evaluations are planned, by each of so many islands, in so many seconds, if time is
/// limited, too: none if they would take longer.
fn proposals((planned, islands): (u64, usize), components: usize, seconds: Option<f64>) -> u64 {
    let takes = MOST_PROPOSALS.min(planned) as f64 * PROPOSAL;
    let is_long = planned.saturating_mul(islands as u64) > MOST_PLANNED && components == 0;
    if is_long || seconds.is_some_and(|seconds| takes > seconds) {
        0
    } else {
        MOST_PROPOSALS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The model takes four times the candidates at half the evaluations, regions are split one by one in a short search, and searches go
    /// on side by side where evaluations do.
    #[test]
    fn short_searches_think_more_and_ask_for_less_at_once() {
        let sizes = |parallel, planned| {
            let sizes = Sizes::of(parallel, planned);
            assert!(sizes.are_possible(), "{sizes:?}");
            [sizes.searches, sizes.candidates, sizes.regions]
        };
        assert_eq!(sizes(1, None), [1, 256, 8]);
        assert_eq!(sizes(1, Some(10_000)), [1, 256, 8]);
        assert_eq!(sizes(1, Some(300)), [1, 256, 4]);
        assert_eq!(sizes(1, Some(200)), [1, 576, 3]);
        assert_eq!(sizes(1, Some(150)), [1, 1024, 2]);
        assert_eq!(sizes(1, Some(50)), [1, 1024, 1]);
        assert_eq!(sizes(1, Some(0)), [1, 1024, 1]);
        assert_eq!(sizes(32, Some(u64::MAX)), [8, 256, 8]);
        assert_eq!(sizes(usize::MAX, None), [64, 256, 8]);
    }

    #[test]
    fn the_model_keeps_out_of_long_searches() {
        let plain = |planned| proposals((planned, 1), 0, None);
        assert_eq!([0, 1, 10_000].map(plain), [1_000; 3]);
        assert_eq!([10_001, u64::MAX].map(plain), [0; 2]);
        // All islands together are one search.
        assert_eq!(
            [1, 2].map(|islands| proposals((10_000, islands), 0, None)),
            [1_000, 0]
        );
        // Of components it knows too much to be left out.
        assert_eq!(proposals((30_000, 1), 3, None), 1_000);
    }

    #[test]
    fn the_model_keeps_out_where_time_is_short() {
        let within = |planned, components, seconds| proposals((planned, 1), components, Some(seconds));
        assert_eq!(within(1_000, 0, 0.51), 1_000);
        assert_eq!(within(50, 0, 0.03), 1_000);
        assert_eq!([within(1_000, 0, 0.49), within(50, 3, 0.02)], [0; 2]);
    }
}

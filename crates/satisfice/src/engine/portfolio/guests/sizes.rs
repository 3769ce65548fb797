//! How large the engines are, by the budget.

/// Candidates that compete for a proposal of the model: as many as take the time of the least number at so many points.
const CANDIDATES: (usize, usize) = (256, 1024);
const POINTS_OF_LEAST: u64 = 300;
/// Proposals of the model, at most; fewer where more than `PLANNED` evaluations are planned, so that thinking stays short beside them, and none
/// where there would be less than `FEWEST_PROPOSALS`.
pub(super) const MOST_PROPOSALS: u64 = 1_000;
const PLANNED: u64 = 2_000;
const FEWEST_PROPOSALS: u64 = 100;
/// Searches of (1+1)-CMA-ES, at most: one for each four evaluations that go on at once.
const MOST_SEARCHES: usize = 64;
/// Regions that are split at once: one for so many evaluations planned, and so many at most.
const EVALUATIONS_OF_A_REGION: u64 = 64;
const MOST_REGIONS: usize = 8;

/// What depends on the budget.
#[derive(Debug, Clone, Copy, serde::Serialize, serde::Deserialize)]
pub(super) struct Sizes {
    /// Searches of (1+1)-CMA-ES side by side.
    pub(super) searches: usize,
    /// Candidates of the model.
    pub(super) candidates: usize,
    /// Proposals of the model, at most.
    pub(super) proposals: u64,
    /// Regions that are split at once.
    pub(super) regions: usize,
}

impl Sizes {
    /// For so many evaluations at once, and so many in all, if that is known.
    pub(super) fn new(parallel: usize, planned: Option<u64>) -> Self {
        let (least, most) = CANDIDATES;
        let candidates = planned.map_or(least, |planned| {
            let more = (POINTS_OF_LEAST / planned.clamp(1, POINTS_OF_LEAST)).pow(2);
            least
                .saturating_mul(usize::try_from(more).unwrap_or(most))
                .min(most)
        });
        Self {
            searches: parallel.div_ceil(4).clamp(1, MOST_SEARCHES),
            candidates,
            proposals: planned.map_or(MOST_PROPOSALS, proposals),
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
            && (1..=MOST_REGIONS).contains(&self.regions)
    }
}

/// How many proposals the model may make where so many evaluations are planned: in inverse proportion to their square, beyond `PLANNED`.
fn proposals(planned: u64) -> u64 {
    let planned = planned.max(PLANNED);
    let most = MOST_PROPOSALS * PLANNED / planned * PLANNED / planned;
    if most < FEWEST_PROPOSALS { 0 } else { most }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The model takes four times the candidates at half the evaluations, regions are split one by one in a short search, and searches go
    /// on side by side where evaluations do.
    #[test]
    fn short_searches_think_more_and_ask_for_less_at_once() {
        let sizes = |parallel, planned| {
            let sizes = Sizes::new(parallel, planned);
            assert!(sizes.are_possible(), "{sizes:?}");
            [sizes.searches, sizes.candidates, sizes.regions]
        };
        assert_eq!(sizes(1, None), [1, 256, 8]);
        assert_eq!(sizes(1, Some(10_000)), [1, 256, 8]);
        assert_eq!(sizes(1, Some(300)), [1, 256, 4]);
        assert_eq!(sizes(1, Some(150)), [1, 1024, 2]);
        assert_eq!(sizes(1, Some(50)), [1, 1024, 1]);
        assert_eq!(sizes(1, Some(0)), [1, 1024, 1]);
        assert_eq!(sizes(32, Some(u64::MAX)), [8, 256, 8]);
        assert_eq!(sizes(usize::MAX, None), [64, 256, 8]);
    }

    #[test]
    fn the_model_proposes_less_in_long_searches() {
        let proposals = |planned| Sizes::new(1, planned).proposals;
        assert_eq!(proposals(None), 1_000);
        assert_eq!([0, 1, 2_000].map(|planned| proposals(Some(planned))), [1_000; 3]);
        assert_eq!(
            [4_000, 6_000, 7_000, u64::MAX].map(|planned| proposals(Some(planned))),
            [250, 111, 0, 0]
        );
    }
}

//! Which source of candidates is next: Thompson sampling on what each has yielded lately.

use super::source::{PLACES, Role};
pub(super) use crate::engine::local::bandit::draw;
use crate::seed::SearchRng;

/// After this many further hits at the arm's rate, a past hit counts for 1/e: yields change as a search goes on.
const MEMORY: f64 = 12.0;
/// At least so many evaluations are remembered, which are eight of the longest turns: where most points hit, twelve hits fit into a single turn,
/// and the choice would be chance. More of a quick F, whose turns are longer.
const LEAST_MEMORY: f64 = 64.0;
const LEAST_MEMORY_WHERE_QUICK: f64 = 256.0;

/// Prior of an arm, in hits. Its prior evaluations are what the whole search has lately needed for as many hits: an untried arm
/// is expected to be as good as the others.
const PRIOR_HITS: f64 = 0.15;
/// Largest share of all evaluations for one source without a hit.
const BARREN_SHARE: f64 = 0.04;
/// The share of all evaluations that swarms have on continuous axes until their first hit: they hit when they have converged, which takes
/// a thousand evaluations or more.
const SHARE_OF_SWARMS: f64 = 0.2;
/// Largest share of the evaluations that do not hit for all of them together while a model of F is at work: the model learns less from
/// their evaluations than from its own.
const SHARE_BESIDE_MODEL: f64 = 0.06;
/// Share of the evaluations that do not hit for descents by components, after so many evaluations.
const SHARE_BESIDE_COMPONENTS: f64 = 0.2;
const FIRST_OF_COMPONENTS: f64 = 100.0;
/// A source without a hit may begin with so many evaluations.
const BARREN_START: f64 = 8.0;
/// Share of the hits found from a place that is credited to the source which found the place.
const PLACE_SHARE: f64 = 0.2;

/// The recent and the total yield of one source.
#[derive(Debug, Clone, Copy, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Credit {
    hits: f64,
    evaluations: f64,
    total_hits: u64,
    total_evaluations: u64,
    total_cost: f64,
    /// Whether F takes less time than a choice of source.
    quick: bool,
}

/// How many evaluations a source without a hit may take.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trial {
    start: f64,
    share: f64,
    /// Whether the bound holds even before any source has found a hit.
    always: bool,
}

impl Trial {
    /// For a search without a model of F.
    pub(super) fn alone() -> Self {
        Self {
            start: BARREN_START,
            share: BARREN_SHARE,
            always: false,
        }
    }

    /// Without a bound, where all sources have reached theirs.
    pub(super) fn free() -> Self {
        Self {
            start: f64::INFINITY,
            ..Self::alone()
        }
    }

    /// For a source with a share of its own beside a model of the components of F. It begins after the model's first evaluations, and may use
    /// a part of the evaluations that miss, whose share is `missed`: no source can gain more than those.
    pub(super) fn beside_components(missed: f64) -> Self {
        let share = missed * SHARE_BESIDE_COMPONENTS;
        Self {
            start: -share * FIRST_OF_COMPONENTS,
            share,
            always: true,
        }
    }

    /// For a search with a model of F and `barren` sources without a hit: a source waits until its share amounts to an evaluation. The share
    /// is in proportion to what the others could gain at most: `missed` of the evaluations.
    pub(super) fn beside_model(barren: usize, missed: f64) -> Self {
        Self {
            start: -1.0,
            share: missed * SHARE_BESIDE_MODEL / barren.max(1) as f64,
            always: true,
        }
    }
}

impl Credit {
    /// Counts one candidate at its cost: an evaluation, or more where time is scarce and thinking takes some. The past fades in proportion to
    /// the hits expected of it. Where hits are rare, little else tells the sources apart, so misses are not forgotten.
    #[inline]
    pub(super) fn count(&mut self, hit: bool, cost: f64) {
        if self.hits > 0.0 {
            let least = if self.quick {
                LEAST_MEMORY_WHERE_QUICK
            } else {
                LEAST_MEMORY
            };
            let fade = (cost * self.hits / self.evaluations / MEMORY).min(cost / least);
            let keep = 1.0 - fade.min(0.5);
            self.hits *= keep;
            self.evaluations *= keep;
        }
        self.evaluations += cost;
        self.hits += f64::from(u8::from(hit));
        self.total_cost += cost;
        self.total_evaluations += 1;
        self.total_hits += u64::from(hit);
    }

    /// Whether to try the source: it has a hit, or is within its share, or no source has a hit yet and the bound allows for that.
    pub(super) fn is_worth_trying(&self, all: &Self, trial: Trial) -> bool {
        (all.total_hits == 0 && !trial.always) || self.is_within(all, trial)
    }

    /// Whether the source has a hit, or has cost no more than its share of the whole search.
    pub(super) fn is_within(&self, all: &Self, trial: Trial) -> bool {
        let most = trial.start + trial.share * all.total_cost;
        self.total_hits > 0 || self.total_cost <= most
    }

    /// Whether this source, the swarms, has no hit and has cost less than swarms may until they converge.
    pub(super) fn is_converging(&self, all: &Self) -> bool {
        self.total_hits == 0 && self.total_cost < SHARE_OF_SWARMS * all.total_cost
    }

    /// The share of recent evaluations that were no hits.
    pub(super) fn missed(&self) -> f64 {
        1.0 - self.hits / self.evaluations.max(1.0)
    }

    /// Whether the source has no hit.
    pub(super) fn is_barren(&self) -> bool {
        self.total_hits == 0
    }

    /// Recent evaluations for each hit; of the whole search, where this is its credit.
    pub(super) fn price(&self) -> f64 {
        (self.evaluations + 10.0) / (self.hits + PRIOR_HITS)
    }

    /// What all candidates have cost.
    pub(super) fn cost(&self) -> f64 {
        self.total_cost
    }

    /// What a candidate has cost on average.
    pub(super) fn mean_cost(&self) -> f64 {
        self.total_cost.max(1.0) / self.total_evaluations.max(1) as f64
    }

    /// All evaluations of this source.
    pub(super) fn evaluations(&self) -> u64 {
        self.total_evaluations
    }

    /// A draw from the posterior of this arm's yield. `price` is the number of evaluations for each hit of the whole search; `weight`
    /// multiplies the yield expected before the arm is tried.
    pub(super) fn draw(&self, price: f64, weight: f64, rng: &mut SearchRng) -> f64 {
        draw(
            rng,
            self.hits + PRIOR_HITS * weight,
            self.evaluations + PRIOR_HITS * price,
        )
    }
}

/// The credit of every source by its place among the names of all, and of all together. Engines of a kind share theirs.
#[derive(Debug, Clone, Copy, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Credits {
    pub(super) whole: Credit,
    of: [Credit; PLACES],
}

impl Credits {
    /// Changes how much is remembered. `quick`: whether F takes less time than a choice of source.
    pub(super) fn remember(&mut self, quick: bool) {
        self.whole.quick = quick;
        self.of.iter_mut().for_each(|credit| credit.quick = quick);
    }

    /// Counts one candidate of the source at `place` that was evaluated.
    pub(super) fn count(&mut self, place: usize, hit: bool, cost: f64) {
        self.whole.count(hit, cost);
        self.of[place].count(hit, cost);
    }
}

impl core::ops::Index<usize> for Credits {
    type Output = Credit;

    fn index(&self, place: usize) -> &Credit {
        &self.of[place]
    }
}

impl core::ops::IndexMut<usize> for Credits {
    fn index_mut(&mut self, place: usize) -> &mut Credit {
        &mut self.of[place]
    }
}

/// The worth of a hit in a new place: the hits that other sources found from there, and the evaluations they needed.
#[derive(Debug, Clone, Copy, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Patches {
    /// Hits of the sources that look for new places.
    places: f64,
    /// Hits and evaluations of the sources that go on from hits.
    hits: f64,
    evaluations: f64,
}

impl Patches {
    pub(super) fn count(&mut self, role: Role, hit: bool, cost: f64) {
        match role {
            Role::Explores => self.places += f64::from(u8::from(hit)),
            Role::Exploits => {
                self.hits += f64::from(u8::from(hit));
                self.evaluations += cost;
            }
            Role::Apart => {}
        }
    }

    /// The worth of a source with this rate of hits. A source that explores is also credited with a share of the hits found from its
    /// places; only a share, because those that others find now from earlier hits are certain.
    pub(super) fn worth(&self, role: Role, rate: f64) -> f64 {
        if role != Role::Explores || self.places == 0.0 {
            return rate;
        }
        let (hits, evaluations) = (self.hits / self.places, self.evaluations / self.places);
        rate.max(PLACE_SHARE * rate * (1.0 + hits) / (1.0 + rate * evaluations))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_better_arm_is_drawn_more_and_the_worse_one_not_forgotten() {
        let mut rng = SearchRng::new(1);
        let (mut good, mut bad, mut all) = (Credit::default(), Credit::default(), Credit::default());
        for _ in 0..20_000 {
            let price = all.price();
            let choose_good = good.draw(price, 1.0, &mut rng) > bad.draw(price, 1.0, &mut rng);
            let (arm, rate) = if choose_good {
                (&mut good, 0.05)
            } else {
                (&mut bad, 0.005)
            };
            let hit = rng.uniform() < rate;
            arm.count(hit, 1.0);
            all.count(hit, 1.0);
        }
        let pulls = [good.evaluations(), bad.evaluations()];
        assert!(pulls[0] > 10 * pulls[1] && pulls[1] > 50, "{pulls:?}");
    }

    /// With h hits in n evaluations, a price of p and a prior of b hits, the posterior is Gamma(h + b, n + b p): mean
    /// (h + b) / (n + b p), variance (h + b) / (n + b p)^2.
    #[test]
    fn an_arm_is_drawn_from_its_posterior() {
        let arm = Credit {
            hits: 8.0,
            evaluations: 80.0,
            ..Credit::default()
        };
        let mut rng = SearchRng::new(2);
        let draws: Vec<f64> = (0..40_000).map(|_| arm.draw(20.0, 1.0, &mut rng)).collect();
        let mean = draws.iter().sum::<f64>() / 40_000.0;
        let variance = draws.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 40_000.0;
        approx::assert_relative_eq!(mean, 8.15 / 83.0, max_relative = 0.01);
        approx::assert_relative_eq!(variance, 8.15 / 83.0 / 83.0, max_relative = 0.05);
    }

    /// A steady yield is estimated without bias; once it ends, the estimate falls to a tenth within a few hundred evaluations.
    #[test]
    fn the_estimate_follows_a_yield_that_ends() {
        let (mut arm, mut mean) = (Credit::default(), 0.0);
        for i in 0..4000 {
            arm.count(i % 5 == 0, 1.0);
            if i >= 3000 {
                mean += arm.hits / arm.evaluations / 1000.0;
            }
        }
        approx::assert_relative_eq!(mean, 0.2, max_relative = 0.1);
        for _ in 0..400 {
            arm.count(false, 1.0);
        }
        assert!(arm.hits / arm.evaluations < 0.02, "{arm:?}");
    }

    /// Where every third point hits, twelve hits are 36 evaluations: 64 are remembered, of a quick F 256.
    #[test]
    fn many_hits_are_not_forgotten_within_a_turn() {
        let remembered = |mut arm: Credit| {
            (0..5000).for_each(|i| arm.count(i % 3 == 0, 1.0));
            arm.evaluations
        };
        let mut arm = Credit::default();
        assert!((60.0..70.0).contains(&remembered(arm)));
        arm.quick = true;
        assert!((250.0..262.0).contains(&remembered(arm)));
    }

    /// Ten hits and a hundred evaluations follow each hit in a new place.
    #[test]
    fn a_new_place_is_worth_what_follows() {
        let mut patches = Patches::default();
        let worth = |patches: &Patches, rate| patches.worth(Role::Explores, rate);
        approx::assert_relative_eq!(worth(&patches, 0.01), 0.01);
        patches.count(Role::Explores, true, 1.0);
        for i in 0..100 {
            patches.count(Role::Exploits, i % 10 == 0, 1.0);
        }
        approx::assert_relative_eq!(patches.worth(Role::Exploits, 0.01), 0.01);
        // 11 hits in 1 / 0.01 + 100 evaluations.
        approx::assert_relative_eq!(worth(&patches, 0.01), 0.2 * 11.0 / 200.0, max_relative = 1e-12);
        // What finds hits sooner than others go on from them needs no share.
        approx::assert_relative_eq!(worth(&patches, 0.5), 0.5);
    }

    #[test]
    fn what_finds_nothing_takes_a_bounded_share() {
        let (mut barren, mut all) = (Credit::default(), Credit::default());
        let alone = Trial::alone();
        assert!(barren.is_worth_trying(&all, alone));
        for i in 0..10_000 {
            all.count(i == 0, 1.0);
            if barren.is_worth_trying(&all, alone) {
                barren.count(false, 1.0);
            }
        }
        let share = barren.evaluations() as f64;
        assert!(!barren.is_worth_trying(&all, alone));
        assert!((400.0..412.0).contains(&share), "{share}");
        let evaluations = |most: u64| Credit {
            total_cost: most as f64,
            ..Credit::default()
        };
        assert!(evaluations(8).is_within(&evaluations(10), alone));
        assert!(!evaluations(9).is_within(&evaluations(10), alone));
        assert!(evaluations(9).is_within(&evaluations(10), Trial::free()));
        // One of six beside a model: the first evaluation after a hundred, even where nothing hits.
        let beside = Trial::beside_model(6, 1.0);
        assert!(!evaluations(0).is_worth_trying(&evaluations(99), beside));
        assert!(evaluations(0).is_worth_trying(&evaluations(101), beside));
        assert!(!evaluations(1).is_worth_trying(&evaluations(101), beside));
        // Where nine of ten hit, after a thousand.
        let beside = Trial::beside_model(6, 0.1);
        assert!(!evaluations(0).is_worth_trying(&evaluations(999), beside));
        assert!(evaluations(0).is_worth_trying(&evaluations(1001), beside));
    }

    #[test]
    fn swarms_have_a_fifth_until_they_hit() {
        let (mut swarms, mut all) = (Credit::default(), Credit::default());
        for _ in 0..1000 {
            all.count(false, 1.0);
            if swarms.is_converging(&all) {
                swarms.count(false, 1.0);
            }
        }
        assert_eq!(swarms.evaluations(), 200);
        all.count(false, 1000.0);
        assert!(swarms.is_converging(&all));
        swarms.count(true, 1.0);
        assert!(!swarms.is_converging(&all));
    }
}

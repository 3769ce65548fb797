//! Candidates that are kept and rated.

use super::lanes::{LANES, Lanes};
use super::limits::ComponentLimits;
use super::process::{Block, Process};

/// Deviations below the mean at which a candidate is still taken for a possible hit.
const HOPE: f64 = 2.0;
/// Blocks of candidates around the best ones that are kept, beside those that are drawn anywhere: those of two proposals.
pub(super) const REFINED: usize = 24;

/// A candidate: its block and its lane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) block: usize,
    pub(super) lane: usize,
}

/// How good a candidate is, the greater the better.
///
/// `(0 - mean) / deviation`, which ranks as the probability of a hit does, as long as a candidate is within [`HOPE`]
/// deviations of one. Elsewhere hits are out of reach and that quotient would only ask for the greatest deviation: the lower
/// confidence bound ranks what is left. Both rules agree where they meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Score {
    pub(super) hopeful: bool,
    pub(super) value: f64,
}

impl Score {
    #[inline]
    fn new(mean: f64, variance: f64) -> Self {
        let deviation = variance.sqrt();
        let bound = mean - HOPE * deviation;
        let hopeful = bound <= 0.0;
        Self {
            hopeful,
            value: if hopeful { -mean / deviation } else { -bound },
        }
    }

    /// By the components.
    fn of_components(means: &[f64], variances: &[f64], limits: &ComponentLimits) -> Self {
        Self {
            hopeful: true,
            value: limits.score(means, variances),
        }
    }

    /// The score of a candidate whose variance is known to become smaller, down to the share `left`, when the points that are out are
    /// told: the less probable a hit is, the more it is worth to wait for them. `P (1 - (1 - left) (1 - P))`, as a logarithm.
    fn beside(mean: f64, variance: f64, left: f64) -> Self {
        let score = Self::new(mean, variance);
        if !score.hopeful {
            return Self {
                value: HOPE * (variance * left).sqrt() - mean,
                ..score
            };
        }
        let miss = normal_below(-score.value);
        Self {
            value: (-miss).ln_1p(),
            ..score
        }
        .less(left)
    }

    /// The same for a logarithm of a probability.
    fn less(self, left: f64) -> Self {
        let miss = -self.value.exp_m1();
        let waits = 1.0 - left;
        Self {
            value: self.value + (-waits * miss).ln_1p(),
            ..self
        }
    }

    /// The score of this share of the probability. Without hope it is the last.
    pub(super) fn believed(self, share: f64, is_logarithm: bool) -> Self {
        if is_logarithm {
            let value = self.value + share.ln();
            return Self { value, ..self };
        }
        let value = normal_quantile(share * normal_below(self.value));
        if value >= -HOPE {
            return Self { value, ..self };
        }
        Self {
            hopeful: false,
            value: f64::MIN,
        }
    }

    /// How probable a hit is; 0 beyond [`HOPE`]. `is_logarithm`: whether the score is one of components, or beside points that are out.
    pub(super) fn probability(&self, is_logarithm: bool) -> f64 {
        match (self.hopeful, is_logarithm) {
            (false, _) => 0.0,
            (true, true) => self.value.exp(),
            (true, false) => normal_below(self.value),
        }
    }

    /// Whether a hit of F itself is more probable than a miss; `beside`: whether the score is one beside points that are out.
    pub(super) fn is_probable(&self, beside: bool) -> bool {
        self.hopeful && self.value > if beside { -core::f64::consts::LN_2 } else { 0.0 }
    }

    pub(super) fn order(&self, other: &Self) -> core::cmp::Ordering {
        (self.hopeful.cmp(&other.hopeful)).then(self.value.total_cmp(&other.value))
    }
}

/// The logarithm of the odds that a standard normal number is below `z` is `CUBE z³ + LINE z`, within 2e-4 of the probability (Page 1977,
/// doi 10.2307/2346872).
const CUBE: f64 = 0.07056;
const LINE: f64 = 1.5976;

fn normal_below(z: f64) -> f64 {
    1.0 / (1.0 + (-(CUBE * z * z * z + LINE * z)).exp())
}

/// The `z` that a standard normal number is below with this probability, by the same formula: a cubic equation with one root.
fn normal_quantile(probability: f64) -> f64 {
    let odds = (probability / (1.0 - probability)).ln();
    let root = (LINE / 3.0 / CUBE).sqrt();
    let turn = (odds / 2.0 / CUBE / (root * root * root)).asinh();
    2.0 * root * (turn / 3.0).sinh()
}

/// Candidates in blocks, of which the oldest are replaced: the last ones, up to [`REFINED`], by candidates around the best, the others by
/// candidates from anywhere. In one ring, those around the best would take the place of all others within five proposals.
#[derive(Debug, Clone, Default)]
pub(super) struct Pool {
    blocks: Vec<Block>,
    /// Candidates that are known points or the same as a hit.
    excluded: Vec<[bool; LANES]>,
    /// The block of either part to be replaced next, counted from the first of that part.
    next: [usize; 2],
    /// Limits of the components; none where F itself is modelled.
    pub(super) limits: ComponentLimits,
}

impl Pool {
    pub(super) fn len(&self) -> usize {
        self.blocks.len()
    }

    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    pub(super) fn push(&mut self, units: Vec<Lanes>) {
        self.blocks.push(Block::new(units));
        self.excluded.push([false; LANES]);
    }

    /// How many blocks are from anywhere.
    fn drawn(&self) -> usize {
        self.len() - REFINED.min(self.len() / 2)
    }

    /// Replaces the oldest block of candidates from anywhere.
    pub(super) fn replace(&mut self, units: Vec<Lanes>) {
        let block = self.next[0] % self.drawn();
        self.next[0] = (block + 1) % self.drawn();
        self.put(block, units);
    }

    /// Replaces the oldest block of candidates around the best, and returns its number.
    pub(super) fn refine(&mut self, units: Vec<Lanes>) -> usize {
        let (drawn, count) = (self.drawn(), self.len() - self.drawn());
        let place = self.next[1] % count;
        self.next[1] = (place + 1) % count;
        self.put(drawn + place, units);
        drawn + place
    }

    fn put(&mut self, block: usize, units: Vec<Lanes>) {
        self.blocks[block] = Block::new(units);
        self.excluded[block] = [false; LANES];
    }

    /// Forgets what is predicted, not the candidates.
    pub(super) fn reset(&mut self) {
        self.blocks.iter_mut().for_each(Block::reset);
    }

    /// Forgets what points after the first `len` say.
    pub(super) fn truncate(&mut self, process: &Process, len: usize) {
        for block in &mut self.blocks {
            process.rewind(block, len);
        }
    }

    /// Appends the coordinates of a candidate to `out`.
    pub(super) fn coordinates(&self, place: Place, out: &mut Vec<f64>) {
        out.clear();
        let axes = &self.blocks[place.block].units;
        out.extend(axes.iter().map(|lanes| lanes[place.lane]));
    }

    pub(super) fn exclude(&mut self, place: Place) {
        self.excluded[place.block][place.lane] = true;
    }

    /// All candidates that are not excluded, the best one last.
    pub(super) fn ranking(&mut self, process: &Process) -> Vec<(Score, Place)> {
        let mut all = Vec::with_capacity(self.len() * LANES);
        for block in 0..self.len() {
            all.extend(self.rate(process, block));
        }
        all.sort_unstable_by(|(a, at), (b, bt)| {
            let places = (bt.block, bt.lane).cmp(&(at.block, at.lane));
            a.order(b).then(places)
        });
        all
    }

    /// The candidates of one block that are not excluded.
    pub(super) fn rate(&mut self, process: &Process, block: usize) -> impl Iterator<Item = (Score, Place)> {
        process.update(&mut self.blocks[block]);
        let scores = self.scores(process, block);
        let excluded = self.excluded[block];
        (0..LANES)
            .filter(move |&lane| !excluded[lane])
            .map(move |lane| (scores[lane], Place { block, lane }))
    }

    fn scores(&self, process: &Process, block: usize) -> [Score; LANES] {
        let block = &self.blocks[block];
        let left = process.left(block);
        if self.limits.is_empty() {
            let (means, variances) = process.predictions(block, 0);
            return core::array::from_fn(|lane| match left {
                Some(left) => Score::beside(means[lane], variances[lane], left[lane]),
                None => Score::new(means[lane], variances[lane]),
            });
        }
        let all: Vec<_> = (0..process.outputs())
            .map(|k| process.predictions(block, k))
            .collect();
        core::array::from_fn(|lane| {
            let means: Vec<f64> = all.iter().map(|(means, _)| means[lane]).collect();
            let variances: Vec<f64> = all.iter().map(|(_, variances)| variances[lane]).collect();
            let score = Score::of_components(&means, &variances, &self.limits);
            match left {
                Some(left) => score.less(left[lane]),
                None => score,
            }
        })
    }

    /// Candidates, exclusions and the next blocks, for [`Pool::restored`].
    pub(super) fn saved(&self) -> (Vec<f64>, Vec<bool>, [usize; 2]) {
        let units = self.blocks.iter().flat_map(|block| &block.units).flatten();
        let excluded = self.excluded.iter().flatten();
        (units.copied().collect(), excluded.copied().collect(), self.next)
    }

    /// `None` if the lists do not fit each other.
    pub(super) fn restored(axes: usize, units: &[f64], excluded: &[bool], next: [usize; 2]) -> Option<Self> {
        let (lanes, []) = units.as_chunks::<LANES>() else {
            return None;
        };
        let (marks, []) = excluded.as_chunks::<LANES>() else {
            return None;
        };
        let fit = marks.len() >= 2 && lanes.len() == marks.len() * axes;
        if axes == 0 || !fit || next.iter().any(|&next| next > marks.len()) {
            return None;
        }
        Some(Self {
            blocks: lanes
                .chunks_exact(axes)
                .map(|lanes| Block::new(lanes.to_vec()))
                .collect(),
            excluded: marks.to_vec(),
            next,
            limits: ComponentLimits::default(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::model::limits::Norm;

    /// By a table of the normal distribution: P(z < 1) = 0.8413, P(z < -1) = 0.1587.
    #[test]
    fn the_improbable_wait_for_points_that_tell_of_them() {
        let worth = |mean: f64, left: f64| Score::beside(mean, 1.0, left).value.exp();
        for (mean, left, expected) in [
            (-1.0, 1.0, 0.8413),
            (1.0, 1.0, 0.1587),
            (1.0, 0.0, 0.1587 * 0.1587),
            (1.0, 0.5, 0.1587 * (1.0 - 0.5 * 0.8413)),
        ] {
            approx::assert_abs_diff_eq!(worth(mean, left), expected, epsilon = 3e-4);
        }
        for (mean, left) in [(-0.1, 1.0), (0.1, 1.0), (-0.1, 0.5), (9.0, 1.0)] {
            let probable = mean < 0.0 && left == 1.0;
            assert_eq!(
                Score::beside(mean, 1.0, left).is_probable(true),
                probable,
                "{mean} {left}"
            );
            assert_eq!(Score::new(mean, 1.0).is_probable(false), mean < 0.0);
        }
        for (mean, expected) in [(-1.0, 0.8413), (1.0, 0.1587), (2.1, 0.0)] {
            let alone = Score::new(mean, 1.0).probability(false);
            approx::assert_abs_diff_eq!(alone, expected, epsilon = 3e-4);
            let beside = Score::beside(mean, 1.0, 1.0).probability(true);
            approx::assert_abs_diff_eq!(beside, expected, epsilon = 3e-4);
        }
        // A certain hit need not wait, nor do ranks depend on it where nothing is out.
        assert!(worth(-6.0, 0.0) > 0.999);
        let means = [-30.0, -9.0, -1.0, 0.0, 1.9, 2.1, 5.0];
        let scores = means.map(|mean| Score::beside(mean, 1.0, 1.0));
        assert!(scores.is_sorted_by(|a, b| a.order(b).is_gt()));
        let of_components =
            Score::of_components(&[0.1], &[0.3], &ComponentLimits::new(Norm::Greatest, vec![0.2]));
        approx::assert_relative_eq!(
            of_components.less(0.0).value.exp(),
            of_components.value.exp().powi(2)
        );
    }

    /// By a table of the normal distribution: half of P(z < 1) is P(z < -0.2), and a fiftieth of a certain hit is beyond hope.
    #[test]
    fn a_share_of_a_probability_ranks_where_it_belongs() {
        for z in [-3.0, -0.5, 0.0, 0.1, 2.0, 5.0] {
            approx::assert_relative_eq!(
                normal_quantile(normal_below(z)),
                z,
                epsilon = 1e-9,
                max_relative = 1e-6
            );
        }
        let half = Score::new(-1.0, 1.0).believed(0.5, false);
        assert!(half.hopeful && (half.value + 0.2).abs() < 0.005, "{half:?}");
        let certain = Score::new(-60.0, 1.0);
        assert!((certain.believed(0.5, false).value).abs() < 1e-9);
        let hopeless = certain.believed(0.02, false);
        assert!(Score::new(10.0, 1.0).order(&hopeless).is_gt());
        let component =
            Score::of_components(&[0.1], &[0.3], &ComponentLimits::new(Norm::Greatest, vec![0.2]));
        approx::assert_relative_eq!(
            component.believed(0.3, true).probability(true),
            0.3 * component.probability(true)
        );
    }

    #[test]
    fn the_probable_come_first_and_the_bound_ranks_the_rest() {
        let scores = [
            Score::new(10.0, 1.0),
            Score::new(9.0, 1.0),
            Score::new(2.1, 1.0),
            Score::new(2.0, 1.0),
            Score::new(1.0, 4.0),
            Score::new(-1.0, 1.0),
        ];
        assert!(scores.is_sorted_by(|a, b| a.order(b).is_lt()));
    }
}

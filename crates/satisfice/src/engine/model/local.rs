//! The model of F, its candidates, and which of them is proposed.

use super::candidates::{CandidateSource, least};
use super::duplicates::{is_duplicate, radius};
use super::failures::tells;
use super::lanes::LANES;
use super::likelihood::likeliest;
use super::one_answer::OneAnswer;
use super::pool::{Place, Pool, REFINED, Score};
use super::process::Process;
use super::reach::{is_within, reach, square};
use super::record::Record;
use super::region::TrustRegion;
use super::roots::steps;
use super::scales::Scales;
use super::skill::Skill;
use super::target::Target;
use super::units::Units;
use crate::context::Context;
use crate::scalar::Real;
use crate::seed::SearchRng;

/// Points from which length scales are learned, at most.
const LEARNED_FROM: usize = 160;
/// Steps of the likelihood's ascent at the first fit, and at later ones, which start where the last one ended.
const STEPS: (usize, usize) = (40, 8);
/// Blocks of candidates that are drawn again for each proposal, half of them uniform.
const REPLACED: usize = 4;
/// Rounds in which candidates are drawn around the best one, and by how much closer each time.
const ROUNDS: usize = 12;
const CLOSER: f64 = 1.5;
/// The same on a lattice, where F may jump from neighbour to neighbour, while a hit is improbable.
const COARSE: (usize, f64) = (3, 3.0);
/// Points beyond which half as many candidates are drawn for each proposal.
const AT_FULL_EFFORT: usize = 128;
/// New points at which the next fit is due, at most.
const MOST_NEW: usize = 40;
/// Deviations of the penalty around hits: so many reaches, and at least this share of a length scale.
const REACHES: f64 = 2.0;
const SCALES: f64 = 0.5;
/// Steps towards a root of the modelled components, from the best candidate and so many of the next ones, drawn among so many.
const NEWTON: usize = 5;
const STARTS: usize = 2;
const AMONG: usize = 64;
/// A point that is proposed and not told yet keeps others out of its separation radius if a hit is at least as probable there. With a miss
/// there, it would keep them from the way to a hit.
const LIKELY: f64 = 0.5;
/// Points that are told before there is a model, at most; on more than `MANY` axes, whose candidates would take too much memory and time,
/// there is none for long.
const LARGEST_DESIGN: usize = 12;
const MANY: usize = 1_000;
/// Candidates that are examined for one proposal.
const EXAMINED: usize = 4096;

/// A Gaussian process of the points so far, and candidates.
#[derive(Debug)]
pub(super) struct Model {
    pub(super) process: Process,
    pub(super) target: Target,
    pub(super) region: TrustRegion,
    /// How many of the known points the scales, mean and variance come from.
    pub(super) prefix: usize,
    /// Points of the record at the last fit, and those that are known or left out by now.
    pub(super) fitted: usize,
    pub(super) taken: usize,
    /// How far from a hit the next one may be.
    pub(super) reach: Vec<f64>,
    /// The same where only an evaluation shows it.
    pub(super) radius: f64,
    pub(super) pool: Pool,
}

/// What a model is given.
pub(super) struct Given<'a, S> {
    pub(super) context: &'a dyn Context<S>,
    pub(super) units: &'a Units,
    pub(super) record: &'a Record,
    pub(super) one_answer: &'a OneAnswer,
    pub(super) position: &'a mut [S],
}

/// A point that is proposed and not told yet.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct PendingPoint {
    pub(super) x: Vec<f64>,
    /// How probable the model takes a hit to be; 0 where it has not said.
    pub(super) probability: f64,
    /// Whether it will not be told.
    pub(super) is_lost: bool,
}

/// What is proposed.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct ModelProposal {
    pub(super) x: Vec<f64>,
    /// How probable a hit is by the model, beside a region as far as its word was true there.
    pub(super) probability: f64,
    /// Whether it is beside a region that is one answer.
    pub(super) beside: bool,
}

impl<S: Real> Given<'_, S> {
    /// Whether a candidate is a known point or the same as a hit.
    fn is_known(&mut self, x: &[f64], radius: f64, rounded: &mut Vec<f64>) -> bool {
        let space = self.context.space();
        self.units.to_position(space, x, self.position);
        self.units.of_position(space, self.position, rounded);
        self.record.has(rounded)
            || self.context.is_deleted(self.position)
            || is_duplicate(self.record, self.units, radius, rounded)
    }
}

impl Model {
    /// Fits a model to all points, or to those next to each other if there are more than `most`.
    pub(super) fn fit<S: Real>(
        given: &mut Given<'_, S>,
        old: Option<Self>,
        (most, candidates): (usize, usize),
        rng: &mut SearchRng,
    ) -> Self {
        let (record, axes) = (given.record, given.units.len());
        let points = record.len();
        let (scales, mut pool, steps) = match old {
            Some(old) => (old.process.scales, old.pool, STEPS.1),
            None => (Scales::new(given.units.shapes()), Pool::default(), STEPS.0),
        };
        let region = if points <= most {
            TrustRegion::whole(record, given.units)
        } else {
            pool.clear();
            TrustRegion::local(record, given.units, &scales, most, rng)
        };
        pool.reset();
        let raw: Vec<f64> = region.known.iter().map(|&i| record.values[i]).collect();
        let threshold = given.context.threshold().f64();
        let target = Target::new(threshold, &raw).with_components(record, &region.known, threshold);
        let values = outputs(record, &target, &region.known);
        pool.limits = target.limits();
        let inputs: Vec<&[f64]> = region.known.iter().map(|&i| record.point(i)).collect();
        let chosen: Vec<usize> = learned_from(inputs.len()).collect();
        let some: Vec<&[f64]> = chosen.iter().map(|&i| inputs[i]).collect();
        let some_values: Vec<Vec<f64>> = values
            .iter()
            .map(|values| chosen.iter().map(|&i| values[i]).collect())
            .collect();
        let scales = likeliest(&scales, &some, &some_values, steps, &|| {
            given.context.is_out_of_time()
        });
        let reach = match record.hits.last() {
            Some(&hit) => reach(given.context, given.units, record.point(hit), given.position),
            None => vec![0.0; axes],
        };
        let mut model = Self {
            process: Process::new(scales, &inputs, &values),
            target,
            prefix: region.known.len(),
            region,
            fitted: points,
            taken: points,
            reach,
            radius: radius(record, given.units),
            pool: Pool::default(),
        };
        let least = least(record, &model.region.known);
        let lengths = model.lengths();
        let blocks = (candidates / LANES).max(2) + REFINED;
        while pool.len() < blocks && !(pool.len() >= 2 && given.context.is_out_of_time()) {
            let radius = model.radius;
            let source = model.source(given.units, record, &lengths);
            let mut rounded = Vec::new();
            let is_known = &mut |x: &[f64]| given.is_known(x, radius, &mut rounded);
            pool.push(source.either(pool.len(), &least, is_known, rng));
        }
        model.pool = pool;
        model
    }

    /// Whether new points are worth a fit: an eighth more than at the last one.
    pub(super) fn is_due(&self, record: &Record) -> bool {
        record.len() >= self.fitted + (self.fitted / 8).clamp(2, MOST_NEW)
    }

    /// Adds the points that were told since, each of which is first predicted.
    pub(super) fn follow(&mut self, record: &Record, units: &Units, skill: &mut Skill) {
        let first = self.first_mean(record);
        for i in self.taken..record.len() {
            if tells(record, units, i) {
                self.region.known.push(i);
                let values = self.target.of_point(record, i);
                let errors = self.process.push(record.point(i), &values);
                if self.target.units.is_empty() {
                    skill.count(values[0], errors[0], first);
                } else {
                    skill.count_share(self.process.share_of_variance(&errors));
                }
            }
        }
        self.taken = record.len();
    }

    /// The mean of what is learned of the first points, which no model has chosen; 0 where components are learned.
    fn first_mean(&self, record: &Record) -> f64 {
        if !self.target.units.is_empty() {
            return 0.0;
        }
        let first = &record.values[..design_size(record.axes()).min(record.len())];
        first.iter().map(|&value| self.target.of(value)).sum::<f64>() / first.len().max(1) as f64
    }

    fn lengths(&self) -> Vec<f64> {
        (0..self.process.scales.axes())
            .map(|j| self.process.scales.length(j))
            .collect()
    }

    fn source<'a>(&'a self, units: &'a Units, record: &'a Record, lengths: &'a [f64]) -> CandidateSource<'a> {
        CandidateSource {
            units,
            record,
            known: &self.region.known[..self.prefix],
            lengths,
            reach: &self.reach,
            bounds: (&self.region.lower, &self.region.upper),
        }
    }

    /// Half of an effort, once so many points are known that a new candidate costs most of the time.
    fn effort(&self, most: usize) -> usize {
        if self.process.len() > AT_FULL_EFFORT {
            most.div_ceil(2)
        } else {
            most
        }
    }

    /// Draws some candidates again.
    pub(super) fn refresh<S: Real>(&mut self, given: &mut Given<'_, S>, rng: &mut SearchRng) {
        let least = least(given.record, &self.region.known);
        let (lengths, radius) = (self.lengths(), self.radius);
        let mut rounded = Vec::new();
        for k in 0..self.effort(REPLACED) {
            let source = self.source(given.units, given.record, &lengths);
            let is_known = &mut |x: &[f64]| given.is_known(x, radius, &mut rounded);
            let block = source.either(k, &least, is_known, rng);
            self.pool.replace(block);
        }
    }

    /// The best candidate that is neither known nor within reach of a pending point. `None` if there is none.
    pub(super) fn choose<S: Real>(
        &mut self,
        given: &mut Given<'_, S>,
        pending: &[PendingPoint],
        rng: &mut SearchRng,
    ) -> Option<ModelProposal> {
        let ranking = self.pool.ranking(&self.process);
        let starts = self.starts(&ranking, rng);
        let mut best = self.first_allowed(given, ranking.into_iter().rev(), pending, None)?;
        let lengths = self.lengths();
        let mut longest = 0.5;
        let jumps = given.context.space().is_discrete() && self.pool.limits.is_empty();
        let (rounds, closer) = if jumps && !best.0.is_probable(!pending.is_empty()) {
            COARSE
        } else {
            (ROUNDS, CLOSER)
        };
        for _ in 0..self.effort(rounds) {
            let radius = self.radius;
            let mut rounded = Vec::new();
            let source = self.source(given.units, given.record, &lengths);
            let is_known = &mut |x: &[f64]| given.is_known(x, radius, &mut rounded);
            let around = source.around(&best.1, longest, is_known, rng);
            longest /= closer;
            let block = self.pool.refine(around);
            let mut rated: Vec<(Score, Place)> = self.pool.rate(&self.process, block).collect();
            rated.sort_by(|(a, _), (b, _)| b.order(a));
            if let Some(better) = self.first_allowed(given, rated.into_iter(), pending, Some(best.0)) {
                best = better;
            }
        }
        for start in starts {
            self.descend(given, pending, start, &mut best);
        }
        if !self.pool.limits.is_empty() {
            let start = best.clone();
            self.descend(given, pending, start, &mut best);
        }
        let (score, x) = best;
        Some(ModelProposal {
            beside: given.one_answer.is_beside(given.units, &x),
            probability: score.probability(self.has_logarithms(pending)),
            x,
        })
    }

    /// Whether scores are logarithms of probabilities.
    fn has_logarithms(&self, pending: &[PendingPoint]) -> bool {
        !self.pool.limits.is_empty() || !pending.is_empty()
    }

    /// Some of the best candidates, from which steps towards roots start, where components are modelled.
    fn starts(&self, ranking: &[(Score, Place)], rng: &mut SearchRng) -> Vec<(Score, Vec<f64>)> {
        if self.pool.limits.is_empty() || ranking.is_empty() {
            return Vec::new();
        }
        let start = |_| {
            let mut x = Vec::new();
            let (score, place) = ranking[ranking.len() - 1 - rng.below(ranking.len().min(AMONG))];
            self.pool.coordinates(place, &mut x);
            (score, x)
        };
        (0..self.effort(STARTS)).map(start).collect()
    }

    /// Steps from a point towards a root of the modelled components, as long as they lead to better candidates; the best allowed one is
    /// kept.
    fn descend<S: Real>(
        &mut self,
        given: &mut Given<'_, S>,
        pending: &[PendingPoint],
        (mut last, mut at): (Score, Vec<f64>),
        best: &mut (Score, Vec<f64>),
    ) {
        for _ in 0..self.effort(NEWTON) {
            // With hundreds of axes a step takes a tenth of a second.
            if given.context.is_out_of_time() {
                return;
            }
            let block = self
                .pool
                .refine(steps(&self.process, given.units, &self.pool.limits, &at));
            let mut rated: Vec<(Score, Place)> = self.pool.rate(&self.process, block).collect();
            rated.sort_by(|(a, _), (b, _)| b.order(a));
            let Some(&(score, place)) = rated.first() else {
                return;
            };
            if score.order(&last).is_le() {
                return;
            }
            last = score;
            self.pool.coordinates(place, &mut at);
            if let Some(better) = self.first_allowed(given, rated.into_iter(), pending, Some(best.0)) {
                *best = better;
            }
        }
    }

    /// The best allowed candidate of a list that starts with the best, if it is better than `than`.
    fn first_allowed<S: Real>(
        &mut self,
        given: &mut Given<'_, S>,
        ranking: impl Iterator<Item = (Score, Place)>,
        pending: &[PendingPoint],
        than: Option<Score>,
    ) -> Option<(Score, Vec<f64>)> {
        let (mut x, mut rounded) = (Vec::new(), Vec::new());
        let mut best: Option<(Score, Vec<f64>)> = None;
        let (belief, slope) = (given.one_answer.belief(), self.slope());
        for (score, place) in ranking.take(EXAMINED) {
            let bar = best.as_ref().map(|(score, _)| *score).or(than);
            if bar.is_some_and(|bar| score.order(&bar).is_le()) {
                break;
            }
            self.pool.coordinates(place, &mut x);
            if given.is_known(&x, self.radius, &mut rounded) {
                self.pool.exclude(place);
                continue;
            }
            let is_out = |pending: &PendingPoint| {
                pending.x == rounded
                    || pending.probability >= LIKELY
                        && is_within(given.units, &pending.x, &x, &self.reach, 1.0)
            };
            if pending.iter().any(is_out) {
                continue;
            }
            let mut score = spread(score, bar, &x, &slope, given);
            if belief < 1.0 && score.hopeful && given.one_answer.is_beside(given.units, &x) {
                score = score.believed(belief, self.has_logarithms(pending));
            }
            if bar.is_none_or(|bar| score.order(&bar).is_gt()) {
                best = Some((score, x.clone()));
            }
        }
        best
    }

    /// For each axis, how far the slope next to a hit goes.
    fn slope(&self) -> Vec<f64> {
        let deviations = |(&reach, length): (&f64, f64)| (REACHES * reach).max(SCALES * length.min(0.5));
        self.reach.iter().zip(self.lengths()).map(deviations).collect()
    }
}

/// Where no candidate is hopeful, what is left next to a hit is its slope, the lowest there is: candidates lose by being close to one.
/// A candidate that is not better than `bar` for that is not looked at any longer.
fn spread<S>(score: Score, bar: Option<Score>, x: &[f64], slope: &[f64], given: &Given<'_, S>) -> Score {
    if score.hopeful {
        return score;
    }
    let record = given.record;
    let (mut nearest, mut spread) = (f64::INFINITY, score);
    // The latest hits are more often near.
    for &hit in record.hits.iter().rev() {
        let distance = square(given.units, record.point(hit), x, slope);
        if distance < nearest {
            nearest = distance;
            spread.value = score.value - (-nearest / 2.0).exp();
            if bar.is_some_and(|bar| spread.order(&bar).is_le()) {
                break;
            }
        }
    }
    spread
}

/// How many points are told before there is a model: the values of fewer say too little about its scales. On many axes it does not know these for
/// long, but where F is low.
pub(super) fn design_size(axes: usize) -> usize {
    if axes > MANY {
        return axes + 2;
    }
    (axes + 2).min(LARGEST_DESIGN)
}

/// What the model learns of points: the values of each output.
pub(super) fn outputs(record: &Record, target: &Target, points: &[usize]) -> Vec<Vec<f64>> {
    let rows: Vec<Vec<f64>> = points.iter().map(|&i| target.of_point(record, i)).collect();
    let count = rows.first().map_or(0, Vec::len);
    (0..count)
        .map(|k| rows.iter().map(|row| row[k]).collect())
        .collect()
}

/// Which of `points` scales are learned from: the latest half and every so many of the others.
fn learned_from(points: usize) -> impl Iterator<Item = usize> {
    let half = LEARNED_FROM / 2;
    let older = points - half.min(points);
    let all = points <= LEARNED_FROM;
    let spread = if all { older } else { half };
    (0..spread)
        .map(move |k| if all { k } else { k * older / half })
        .chain(older..points)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_learned_from_all_points_or_from_a_bounded_number() {
        for points in [1, 5, 80, 81, 160] {
            assert!(learned_from(points).eq(0..points), "{points}");
        }
        let some: Vec<usize> = learned_from(500).collect();
        assert_eq!(some.len(), LEARNED_FROM);
        assert!(some.is_sorted_by(|a, b| a < b) && some.ends_with(&[498, 499]));
    }
}

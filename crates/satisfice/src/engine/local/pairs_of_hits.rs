//! Recombinations of all pairs of hits beside searches: a source of two in an engine.

use super::bandit::Arm;
use super::misses::MissList;
use super::recombination::Pairs;
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::hit_list::HitList;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::Space;
use crate::state::Part;

/// Recombinations that are examined for one that is not a known hit, for each candidate of a batch.
const LOOKS: usize = 8;

/// The hits, the recombinations of their pairs that are left, and those that just missed.
#[derive(Debug)]
pub(super) struct PairsOfHits<S> {
    hits: HitList<S>,
    pairs: Pairs,
    misses: MissList<S>,
    /// What searches and recombinations have yielded.
    arms: [Arm; 2],
    /// Memory of one recombination.
    position: Vec<S>,
}

impl<S: Real> PairsOfHits<S> {
    /// Those of a space of so many axes, before the first hit.
    pub(super) fn new(dimension: usize) -> Self {
        Self {
            hits: HitList::default(),
            pairs: Pairs::default(),
            misses: MissList::default(),
            arms: [Arm::default(); 2],
            position: vec![S::zero(); dimension],
        }
    }

    pub(super) fn dimension(&self) -> usize {
        self.position.len()
    }

    /// The coordinates of all hits, one after the other.
    pub(super) fn hits(&self) -> &[S] {
        &self.hits
    }

    /// Draws whether recombinations are next, by the yield of both.
    pub(super) fn are_next(&self, rng: &mut SearchRng) -> bool {
        self.position.len() > 1
            && self.pairs.is_left(self.hits.rows())
            && self.arms[1].draw(rng) > self.arms[0].draw(rng)
    }

    /// Appends the next `count` recombinations that are no known hits; fewer where too many are.
    pub(super) fn propose(
        &mut self,
        count: usize,
        context: &dyn Context<S>,
        rng: &mut SearchRng,
        out: &mut Batch<S>,
    ) {
        for _ in 0..LOOKS * count {
            if out.len() == count {
                return;
            }
            let Some(is_new) = self.pairs.next(&self.hits, rng, &mut self.position) else {
                return;
            };
            if is_new && !context.is_deleted(&self.position) {
                out.push(&self.position);
            } else {
                // Paid like a miss: looking costs time, and a source that has run dry is not to be asked for ever.
                self.arms[1].count(false);
            }
        }
    }

    /// Takes the hits of any batch.
    pub(super) fn take_hits(&mut self, space: &Space<S>, batch: &Batch<S>, outcomes: &[Outcome<S>]) {
        for (position, outcome) in batch.points().zip(outcomes) {
            if outcome.is_hit() {
                self.hits.push(space, position);
            }
        }
    }

    /// Keeps the best near misses of recombinations, or of start points.
    pub(super) fn keep_misses(&mut self, batch: &Batch<S>, outcomes: &[Outcome<S>]) {
        for (position, outcome) in batch.points().zip(outcomes) {
            if let Outcome::Miss(fitness) = *outcome {
                self.misses.keep(position, fitness);
            }
        }
    }

    /// Takes the best near miss out and hands its position and fitness to `read`.
    pub(super) fn take_best_miss(&mut self, read: impl FnOnce(&[S], S)) -> bool {
        self.misses.take_best(read)
    }

    /// Counts what became of a batch of the searches.
    pub(super) fn count_searches(&mut self, outcomes: &[Outcome<S>]) {
        self.count(0, outcomes);
    }

    /// Counts what became of a batch of recombinations.
    pub(super) fn count_recombinations(&mut self, outcomes: &[Outcome<S>]) {
        self.count(1, outcomes);
    }

    fn count(&mut self, arm: usize, outcomes: &[Outcome<S>]) {
        for outcome in outcomes {
            self.arms[arm].count(outcome.is_hit());
        }
        Arm::fade(&mut self.arms, outcomes.len());
    }

    /// Whether all of it is of a space of so many axes.
    pub(super) fn fit(&self, dimension: usize) -> bool {
        self.position.len() == dimension
            && self.hits.fit(dimension)
            && self.pairs.fit(self.hits.rows(), dimension)
            && self.misses.fit(dimension)
    }
}

impl<S: Real> Part for PairsOfHits<S> {
    crate::saved_fields!(hits, pairs, misses, arms, position);
}

//! What all particle swarms share: positions, personal bests, the attractor, and how a slice starts.

use core::ops::Range;
use std::collections::BTreeSet;

use crate::batch::{Batch, Outcome};
use crate::context::{Context, points_between_looks};
use crate::engine::{Origin, Steps};
use crate::error::Error;
use crate::scalar::{Real, copy_row};
use crate::seed::SearchRng;
use crate::state::Part;

/// The point that attracts a swarm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Attractor {
    /// The best of the personal bests.
    Best,
    /// The latest hit; the best of the personal bests while there is none.
    LatestHit,
}

/// How a swarm deals with its particles and hits.
#[derive(Debug, Clone, Copy)]
pub(super) struct SwarmRules {
    /// N.
    pub(super) particles: usize,
    /// Particles that move between two updates of the attractor; fewer where a point has thousands of coordinates, so that the clock
    /// is read in between.
    pub(super) batch: usize,
    pub(super) attractor: Attractor,
    /// Whether hits are deleted from the space.
    pub(super) deletes: bool,
}

/// N particles with position X_i and personal best P_i of value f_i.
///
/// A point better than f_i becomes P_i. Where hits are deleted, a hit becomes P_i even if it is worse: the earlier one is no
/// longer in the space.
#[derive(Debug)]
pub(super) struct Swarm<S> {
    particles: usize,
    batch: usize,
    attractor: Attractor,
    deletes: bool,
    dimension: usize,
    positions: Vec<S>,
    bests: Vec<S>,
    fitness: Vec<S>,
    /// The particle with the least f_i.
    leader: usize,
    /// Empty while there is none.
    latest_hit: Vec<S>,
    /// The particle that moves next.
    turn: usize,
    started: bool,
}

impl<S: Real> Swarm<S> {
    /// A swarm before its start.
    pub(super) fn new(rules: SwarmRules) -> Self {
        let SwarmRules {
            particles,
            batch,
            attractor,
            deletes,
        } = rules;
        Self {
            particles,
            batch,
            attractor,
            deletes,
            dimension: 0,
            positions: Vec::new(),
            bests: Vec::new(),
            fitness: Vec::new(),
            leader: 0,
            latest_hit: Vec::new(),
            turn: 0,
            started: false,
        }
    }

    /// Forgets everything; the next particles are those of [`Swarm::propose_start`]. Sets room aside for all of them.
    pub(super) fn begin(&mut self, dimension: usize) {
        self.dimension = dimension;
        for list in [
            &mut self.positions,
            &mut self.bests,
            &mut self.fitness,
            &mut self.latest_hit,
        ] {
            list.clear();
        }
        self.leader = 0;
        self.turn = 0;
        self.started = false;
        set_room_aside(&mut self.positions, self.particles, dimension);
        set_room_aside(&mut self.bests, self.particles, dimension);
    }

    /// Whether the start points have been told.
    #[inline]
    pub(super) fn has_started(&self) -> bool {
        self.started
    }

    pub(super) fn particles(&self) -> usize {
        self.particles
    }

    pub(super) fn deletes(&self) -> bool {
        self.deletes
    }

    /// The next start points, as many as are proposed at a time: random members of C_prev, none of them twice, or all of them and
    /// then uniform points.
    pub(super) fn propose_start(&self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) {
        let (particles, hits) = (self.particles, context.previous_hits());
        let first = self.fitness.len();
        let last = particles.min(first + points_between_looks(self.dimension));
        let all_fit = hits <= particles;
        for i in first..last {
            out.push_with(|position| {
                let encoded = all_fit && i < hits && context.previous_hit(i, position);
                if !encoded {
                    rng.position(context.space(), position);
                }
            });
        }
        if !all_fit {
            // Each part of the swarm draws from its own share of the hits, which has more members than the part.
            let share = share(hits, first, particles)..share(hits, last, particles);
            // Drawing again on a repetition costs N ln N draws at worst.
            let mut drawn = BTreeSet::new();
            while drawn.len() < last - first {
                let index = share.start + rng.below(share.len());
                if drawn.insert(index) {
                    // Where the problem does not encode, the uniform point stays.
                    let _ = context.previous_hit(index, out.point_mut(drawn.len() - 1));
                }
            }
        }
    }

    /// Whether a sweep over the particles begins now.
    #[inline]
    pub(super) fn begins_sweep(&self) -> bool {
        self.turn == 0
    }

    /// The particle that moves next.
    #[inline]
    pub(super) fn turn(&self) -> usize {
        self.turn
    }

    /// The particles that move now.
    #[inline]
    pub(super) fn due(&self) -> Range<usize> {
        let most = self.batch.min(points_between_looks(self.dimension));
        self.turn..self.particles.min(self.turn + most)
    }

    /// Where coordinates of particle `i` stand in a flat list.
    #[inline]
    pub(super) fn row(&self, i: usize) -> Range<usize> {
        i * self.dimension..(i + 1) * self.dimension
    }

    /// X_i.
    #[inline]
    pub(super) fn position(&self, i: usize) -> &[S] {
        &self.positions[self.row(i)]
    }

    /// P_i.
    #[inline]
    pub(super) fn best(&self, i: usize) -> &[S] {
        &self.bests[self.row(i)]
    }

    /// f_i.
    #[inline]
    pub(super) fn fitness(&self, i: usize) -> S {
        self.fitness[i]
    }

    /// Forgets P_i: whatever is found next is better.
    pub(super) fn forget(&mut self, i: usize) {
        self.fitness[i] = S::infinity();
        if i == self.leader {
            self.find_leader();
        }
    }

    /// All P_i, flat.
    pub(super) fn bests(&self) -> &[S] {
        &self.bests
    }

    /// The least of the f_i.
    pub(super) fn least_fitness(&self) -> S {
        self.fitness[self.leader]
    }

    /// G.
    #[inline]
    pub(super) fn attractor(&self) -> &[S] {
        if self.latest_hit.is_empty() {
            self.best(self.leader)
        } else {
            &self.latest_hit
        }
    }

    /// Records the outcomes of the start points, of the particles that were due, or of hits found elsewhere.
    #[inline]
    pub(super) fn tell(&mut self, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        if origin == Origin::Engine && self.started {
            for (position, &outcome) in batch.points().zip(outcomes) {
                let row = self.row(self.turn);
                copy_row(&mut self.positions[row], position);
                self.settle(outcome);
            }
        } else {
            self.tell_of_others(batch, outcomes, origin);
        }
    }

    /// Records the start points, or hits found elsewhere.
    #[cold]
    fn tell_of_others(&mut self, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        if origin != Origin::Engine {
            if let Some(i) = outcomes.iter().rposition(|outcome| outcome.is_hit()) {
                self.remember(batch.point(i));
            }
        } else {
            self.positions.extend_from_slice(batch.positions());
            self.bests.extend_from_slice(batch.positions());
            self.fitness
                .extend(outcomes.iter().map(|outcome| outcome.fitness()));
            self.started = self.fitness.len() >= self.particles;
            self.find_leader();
        }
    }

    /// Whether particles move one at a time, from now on until the slice ends.
    #[inline]
    pub(super) fn is_asynchronous(&self) -> bool {
        self.started && self.batch == 1
    }

    /// Moves the particle whose turn it is: `displace` changes X in view of P and G. Returns whether there may be another.
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a call per step would cost a tenth of the whole"
    )]
    pub(super) fn step(
        &mut self,
        steps: &mut dyn Steps<S>,
        displace: impl FnOnce(&mut [S], &[S], &[S]),
    ) -> bool {
        let row = self.row(self.turn);
        let attractor = if self.latest_hit.is_empty() {
            &self.bests[self.row(self.leader)]
        } else {
            &self.latest_hit
        };
        let position = &mut self.positions[row.clone()];
        displace(position, &self.bests[row], attractor);
        let (outcome, more) = steps.take(position);
        self.settle(outcome);
        more
    }

    /// Records the outcome of the particle whose turn it was, at its new position.
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a call per step would cost a tenth of the whole"
    )]
    fn settle(&mut self, outcome: Outcome<S>) {
        let i = self.turn;
        let row = self.row(i);
        let fitness = outcome.fitness();
        let hit = outcome.is_hit();
        if fitness < self.fitness[i] || (hit && self.deletes) {
            copy_row(&mut self.bests[row.clone()], &self.positions[row]);
            let worse = fitness > self.fitness[i];
            self.fitness[i] = fitness;
            if fitness < self.fitness[self.leader] {
                self.leader = i;
            } else if worse && i == self.leader {
                self.find_leader();
            }
        }
        if hit && self.attractor == Attractor::LatestHit {
            self.latest_hit.clear();
            self.latest_hit.extend_from_slice(&self.positions[self.row(i)]);
        }
        self.turn = if i + 1 < self.particles { i + 1 } else { 0 };
    }

    fn remember(&mut self, hit: &[S]) {
        if self.attractor == Attractor::LatestHit {
            self.latest_hit.clear();
            self.latest_hit.extend_from_slice(hit);
        }
    }

    fn find_leader(&mut self) {
        let f = &self.fitness;
        let less = |&a: &usize, &b: &usize| f[a].f64().total_cmp(&f[b].f64());
        self.leader = (0..f.len()).min_by(less).unwrap_or(0);
    }

    /// Says whether a restored list of `rows` rows of coordinates has the length that it ought to have.
    ///
    /// # Errors
    /// [`Error::State`] if it has not.
    pub(super) fn fits(&self, what: &str, length: usize, rows: usize) -> Result<(), Error> {
        if Some(length) == rows.checked_mul(self.dimension) {
            Ok(())
        } else {
            Err(Error::State(format!("{what} has {length} numbers")))
        }
    }

    /// The same for rows that are drawn with the start points: those of a batch are there before it is told.
    ///
    /// # Errors
    /// [`Error::State`] if the list has another length.
    pub(super) fn fits_rows_drawn(&self, what: &str, length: usize) -> Result<(), Error> {
        let rows = length / self.dimension.max(1);
        self.fits(what, length, rows.clamp(self.fitness.len(), self.particles))
    }

    /// Says whether a restored list of one row of coordinates a particle that has been told has its length.
    ///
    /// # Errors
    /// [`Error::State`] if it has not.
    pub(super) fn fits_rows(&self, what: &str, length: usize) -> Result<(), Error> {
        self.fits(what, length, self.fitness.len())
    }

    fn check(&self) -> Result<(), Error> {
        self.fits_rows("the positions", self.positions.len())?;
        self.fits_rows("the personal bests", self.bests.len())?;
        self.fits(
            "the latest hit",
            self.latest_hit.len(),
            usize::from(!self.latest_hit.is_empty()),
        )?;
        let told = self.fitness.len();
        let all = told == self.particles;
        if told <= self.particles
            && self.started == all
            && self.leader < self.particles
            && self.turn < self.particles
        {
            Ok(())
        } else {
            Err(Error::State(format!(
                "it is not of a swarm of {}",
                self.particles
            )))
        }
    }
}

/// Sets room aside for so many rows, which start particles fill one after the other: a list of many coordinates that grows is copied
/// for milliseconds. Memory is taken up when it is written. If there is not so much, the list grows after all.
pub(super) fn set_room_aside<S>(list: &mut Vec<S>, rows: usize, dimension: usize) {
    let _ = list.try_reserve_exact(rows.saturating_mul(dimension));
}

/// Where the share of particle `i` of some hits begins.
fn share(hits: usize, i: usize, particles: usize) -> usize {
    (hits as u128 * i as u128 / particles.max(1) as u128) as usize
}

impl<S: Real> Part for Swarm<S> {
    crate::saved_fields!(dimension, positions, bests, fitness, leader, latest_hit, turn, started; check);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A list that grows is copied: that took milliseconds after a deadline.
    #[test]
    fn start_points_are_told_without_moving_those_before() {
        let mut swarm: Swarm<f64> = Swarm::new(SwarmRules {
            particles: 30,
            batch: 1,
            attractor: Attractor::Best,
            deletes: false,
        });
        let dimension = 1000;
        swarm.begin(dimension);
        let places = [swarm.positions.as_ptr(), swarm.bests.as_ptr()];
        for fitness in 0..30 {
            let mut batch = Batch::new(dimension);
            batch.push(&vec![0.5; dimension]);
            swarm.tell(&batch, &[Outcome::Miss(f64::from(fitness))], Origin::Engine);
        }
        assert!(swarm.has_started());
        assert_eq!(places, [swarm.positions.as_ptr(), swarm.bests.as_ptr()]);
    }

    #[test]
    fn room_that_there_is_not_is_no_error() {
        let mut list: Vec<f64> = Vec::new();
        set_room_aside(&mut list, usize::MAX, 2);
        assert_eq!(list.capacity(), 0);
    }
}

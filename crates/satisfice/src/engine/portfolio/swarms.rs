//! Small swarms, each attracted by its own latest hit.

use super::visited::Visited;
use crate::batch::{Batch, Outcome};
use crate::engine::low_discrepancy::EvenPoints;
use crate::engine::swarm::potential_well::{draw, mean_best};
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::Space;
use crate::state::Saved;

/// A move to a point that was evaluated before cannot be a new hit. It is drawn again at most this many times.
const DRAWS: usize = 4;

/// One swarm of a few particles.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
struct SubSwarm<S> {
    positions: Vec<S>,
    bests: Vec<S>,
    best_fitness: Vec<S>,
    mean: Vec<S>,
    latest_hit: Vec<S>,
    has_hit: bool,
    /// The particle whose turn it is.
    turn: usize,
    /// Particles that are still to be evaluated for the first time.
    unborn: usize,
    /// Evaluations since its last hit.
    stalled: usize,
    /// Whether its last candidate is not told yet.
    waits: bool,
}

/// K swarms of N particles that take turns. Each works in a region of its own until it stalls and starts anew; a shared latest
/// hit would draw all of them to one region.
///
/// Unlike the paper: several swarms, alpha below 1, restarts, and one particle of each swarm per batch.
#[derive(Debug, Clone)]
pub(super) struct Swarms<S> {
    particles: usize,
    alpha: S,
    restart: usize,
    swarms: Vec<SubSwarm<S>>,
    /// The swarm whose turn it is.
    next: usize,
    /// Candidates proposed in this batch: a swarm proposes once a batch.
    proposed: usize,
}

impl<S: Real> Swarms<S> {
    /// K swarms of N particles each, which start anew after `restart` evaluations without a hit.
    pub(super) fn new(count: usize, particles: usize, alpha: f64, restart: usize) -> Self {
        let swarm = SubSwarm {
            positions: Vec::new(),
            bests: Vec::new(),
            best_fitness: Vec::new(),
            mean: Vec::new(),
            latest_hit: Vec::new(),
            has_hit: false,
            turn: 0,
            unborn: 0,
            stalled: 0,
            waits: false,
        };
        Self {
            particles,
            alpha: S::of(alpha),
            restart,
            swarms: vec![swarm; count],
            next: 0,
            proposed: 0,
        }
    }

    pub(super) fn begin(&mut self, dimension: usize) {
        for swarm in &mut self.swarms {
            swarm.mean = vec![S::zero(); dimension];
            swarm.latest_hit = vec![S::zero(); dimension];
            swarm.start_anew();
            swarm.waits = false;
        }
        self.next = 0;
    }

    pub(super) fn save(&self, state: &mut crate::state::State) {
        self.swarms.save(state);
        self.next.save(state);
    }

    pub(super) fn restore(&mut self, from: &mut crate::state::Reader<'_>) -> Result<(), crate::Error> {
        self.swarms = from.read()?;
        self.next = from.read()?;
        Ok(())
    }

    /// Begins a batch.
    pub(super) fn begin_batch(&mut self) {
        self.proposed = 0;
    }

    /// Proposes a candidate of the next swarm that awaits no answer and returns its index; `None` if every swarm has proposed in this batch,
    /// or waits.
    pub(super) fn propose(
        &mut self,
        space: &Space<S>,
        visited: Option<&Visited>,
        even: &mut EvenPoints,
        rng: &mut SearchRng,
        out: &mut Batch<S>,
    ) -> Option<usize> {
        if self.proposed == self.swarms.len() {
            return None;
        }
        self.proposed += 1;
        let count = self.swarms.len();
        let mut turns = (0..count).map(|k| (self.next + k) % count);
        let index = turns.find(|&index| !self.swarms[index].waits)?;
        self.next = (index + 1) % count;
        let swarm = &mut self.swarms[index];
        swarm.populate(self.particles, space, even, rng);
        swarm.waits = true;
        swarm.propose(self.particles, self.alpha, space, visited, rng, out);
        Some(index)
    }

    /// Tells swarm `index` the outcome of its particle.
    /// The number of swarms.
    pub(super) fn len(&self) -> usize {
        self.swarms.len()
    }

    pub(super) fn tell(&mut self, index: usize, position: &[S], outcome: Outcome<S>) {
        let swarm = &mut self.swarms[index];
        swarm.waits = false;
        swarm.tell(self.particles, position, outcome);
        if swarm.stalled > self.restart {
            swarm.start_anew();
        }
    }
}

impl<S: Real> SubSwarm<S> {
    fn start_anew(&mut self) {
        self.positions.clear();
        self.has_hit = false;
        self.turn = 0;
        self.stalled = 0;
    }

    /// Draws as many particles, if it has none.
    fn populate(&mut self, particles: usize, space: &Space<S>, even: &mut EvenPoints, rng: &mut SearchRng) {
        if !self.positions.is_empty() {
            return;
        }
        let dimension = self.mean.len();
        self.positions.resize(particles * dimension, S::zero());
        for position in self.positions.chunks_exact_mut(dimension) {
            even.draw_inwards(space, rng, position);
        }
        self.bests.clear();
        self.bests.extend_from_slice(&self.positions);
        self.best_fitness.clear();
        self.best_fitness.resize(particles, S::infinity());
        self.unborn = particles;
    }

    fn propose(
        &mut self,
        particles: usize,
        alpha: S,
        space: &Space<S>,
        visited: Option<&Visited>,
        rng: &mut SearchRng,
        out: &mut Batch<S>,
    ) {
        let dimension = self.mean.len();
        let row = self.turn * dimension..(self.turn + 1) * dimension;
        if self.unborn == 0 {
            if self.turn == 0 {
                mean_best(&self.bests, &mut self.mean, || false);
            }
            let by_fitness =
                |&a: &usize, &b: &usize| self.best_fitness[a].f64().total_cmp(&self.best_fitness[b].f64());
            let attractor = if self.has_hit {
                &self.latest_hit[..]
            } else {
                &self.bests[(0..particles).min_by(by_fitness).unwrap_or(0) * dimension..][..dimension]
            };
            let position = &mut self.positions[row.clone()];
            for _ in 0..DRAWS {
                let towards = attractor.iter().zip(&self.mean);
                let from = self.bests[row.clone()].iter().zip(towards);
                for (x, (&p, (&g, &m))) in position.iter_mut().zip(from) {
                    *x = draw(rng, alpha, *x, p, g, m);
                }
                space.keep_inside(position);
                if visited.is_none_or(|visited| !visited.contains(space, position)) {
                    break;
                }
            }
        }
        out.push(&self.positions[row]);
    }

    fn tell(&mut self, particles: usize, position: &[S], outcome: Outcome<S>) {
        let dimension = self.mean.len();
        let row = self.turn * dimension..(self.turn + 1) * dimension;
        let fitness = outcome.fitness();
        self.positions[row.clone()].copy_from_slice(position);
        if outcome.is_hit() || fitness < self.best_fitness[self.turn] {
            self.bests[row].copy_from_slice(position);
            self.best_fitness[self.turn] = fitness;
        }
        if outcome.is_hit() {
            self.latest_hit.copy_from_slice(position);
            self.has_hit = true;
            self.stalled = 0;
        } else {
            self.stalled += 1;
        }
        self.unborn = self.unborn.saturating_sub(1);
        self.turn = (self.turn + 1) % particles;
    }
}

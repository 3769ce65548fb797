//! Several local searches side by side. Each restarts when it stalls, hits, or returns to a known hit.

use super::moves::{Move, Moves};
use super::visited::Visited;
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::local::luby::luby;
use crate::engine::local::one_plus_one::Mutation;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::state::Saved;

/// The shortest run of the restart sequence ends after this many evaluations per axis without improvement.
const PATIENCE: u64 = 8;
/// A run lasts at least this many times the number of neighbours without improvement.
const NEIGHBOUR_PATIENCE: u64 = 2;
/// A continuous search whose steps fall below this share of the axes has converged.
const CONVERGED: f64 = 1e-9;
/// The first step of a continuous search is drawn log-uniformly between these shares of the axes: large ones leave narrow
/// basins for wide ones, small ones are slow in wide ones.
const FIRST_STEP: (f64, f64) = (0.01, 0.1);
/// The first step from a near miss.
const REFINING_STEP: f64 = 0.003;
/// One search in `REFINED` starts at a near miss, if there is one.
const REFINED: u64 = 2;

/// A move to a point that was evaluated before cannot be a new hit. It is drawn again at most this many times.
const DRAWS: usize = 4;

/// One local search. It keeps its best point and accepts a point that is no worse.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
struct Climber<S> {
    position: Vec<S>,
    fitness: S,
    running: bool,
    stalled: u64,
    patience: u64,
    mutation: Mutation,
    /// The neighbours not tried yet; `None` before they are counted.
    neighbours: Option<Untried>,
    /// The last move; `None` at a start.
    last: Option<Move>,
    /// Whether its last candidate is not told yet.
    waits: bool,
}

/// Each index once, in a random order and without a list: by steps of a random length that has no divisor in common with the
/// number of indices.
#[derive(Debug, Clone, Copy, serde::Serialize, serde::Deserialize)]
struct Untried {
    count: usize,
    at: usize,
    stride: usize,
    left: usize,
}

impl Untried {
    fn all(count: usize, rng: &mut SearchRng) -> Self {
        let mut untried = Self {
            count,
            at: 0,
            stride: 1,
            left: count,
        };
        if count > 2 {
            untried.at = rng.below(count);
            untried.stride = 1 + rng.below(count - 1);
            while common_divisor(untried.stride, count) > 1 {
                untried.stride = 1 + untried.stride % (count - 1);
            }
        }
        untried
    }

    /// The next index. A damaged state may give any index below the count.
    fn next(&mut self) -> Option<usize> {
        self.left = self.left.checked_sub(1)?;
        self.at = (self.at % self.count.max(1)).wrapping_add(self.stride) % self.count.max(1);
        Some(self.at)
    }
}

/// The greatest common divisor (Euclid).
fn common_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

/// Restarted local search by adaptive [`Moves`]: along integer axes, to neighbours that the problem names, and by a
/// [`Mutation`] that adapts its covariance along continuous axes.
#[derive(Debug, Clone)]
pub(super) struct Climbers<S> {
    climbers: Vec<Climber<S>>,
    moves: Moves,
    integer_axes: Vec<usize>,
    restarts: u64,
    next: usize,
    proposed: usize,
    active: usize,
    /// The best near miss offered since the last start at one, and its fitness; infinite where there is none.
    offered: Vec<S>,
    offered_fitness: S,
}

impl<S: Real> Climbers<S> {
    pub(super) fn new() -> Self {
        Self {
            climbers: Vec::new(),
            moves: Moves::default(),
            integer_axes: Vec::new(),
            restarts: 0,
            next: 0,
            proposed: 0,
            active: 1,
            offered: Vec::new(),
            offered_fitness: S::infinity(),
        }
    }

    pub(super) fn begin(&mut self, context: &dyn Context<S>) {
        let axes = context.space().axes();
        self.integer_axes = (0..axes.len()).filter(|&j| axes[j].is_integer()).collect();
        self.climbers.clear();
        self.next = 0;
        self.offered_fitness = S::infinity();
    }

    /// Offers a near miss as the start of a search; the best one offered since the last such start is taken.
    pub(super) fn offer(&mut self, position: &[S], fitness: S) {
        if fitness < self.offered_fitness {
            self.offered.clear();
            self.offered.extend_from_slice(position);
            self.offered_fitness = fitness;
        }
    }

    pub(super) fn save(&self, state: &mut crate::state::State) {
        self.climbers.save(state);
        self.moves.save(state);
        self.integer_axes.save(state);
        self.restarts.save(state);
        self.next.save(state);
        (self.offered.clone(), self.offered_fitness).save(state);
    }

    pub(super) fn restore(&mut self, from: &mut crate::state::Reader<'_>) -> Result<(), crate::Error> {
        self.climbers = from.read()?;
        self.moves = from.read()?;
        self.integer_axes = from.read()?;
        self.restarts = from.read()?;
        self.next = from.read()?;
        (self.offered, self.offered_fitness) = from.read()?;
        Ok(())
    }

    /// Begins a batch, for which this many climbers propose.
    pub(super) fn begin_batch(&mut self, active: usize) {
        self.proposed = 0;
        self.active = active.max(1);
        while self.climbers.len() < self.active {
            self.climbers.push(Climber {
                position: Vec::new(),
                fitness: S::infinity(),
                running: false,
                stalled: 0,
                patience: 0,
                mutation: Mutation::default(),
                neighbours: None,
                last: None,
                waits: false,
            });
        }
    }

    /// Proposes a candidate of the next climber that awaits no answer and returns its index; `None` if every climber has proposed in this
    /// batch, or waits.
    pub(super) fn propose(
        &mut self,
        context: &dyn Context<S>,
        visited: Option<&Visited>,
        rng: &mut SearchRng,
        out: &mut Batch<S>,
    ) -> Option<usize> {
        if self.proposed == self.active {
            return None;
        }
        self.proposed += 1;
        let mut turns = (0..self.active).map(|k| (self.next + k) % self.active);
        let index = turns.find(|&index| !self.climbers[index].waits)?;
        self.next = (index + 1) % self.active;
        let climber = &mut self.climbers[index];
        climber.waits = true;
        if !climber.running {
            self.restarts += 1;
            climber.start(luby(self.restarts), context, rng);
            if !self.restarts.is_multiple_of(REFINED) || self.offered_fitness == S::infinity() {
                out.push(&climber.position);
                return Some(index);
            }
            climber.position.copy_from_slice(&self.offered);
            climber.fitness = self.offered_fitness;
            climber.mutation.reset(climber.position.len(), REFINING_STEP);
            self.offered_fitness = S::infinity();
        }
        let space = context.space();
        out.push_with(|position| {
            for _ in 0..DRAWS {
                climber.step(&self.moves, &self.integer_axes, context, rng, position);
                if visited.is_none_or(|visited| !visited.contains(space, position)) {
                    break;
                }
            }
        });
        Some(index)
    }

    /// Tells climber `index` the outcome of its candidate.
    pub(super) fn tell(&mut self, index: usize, position: &[S], outcome: Outcome<S>) {
        let climber = &mut self.climbers[index];
        climber.waits = false;
        let fitness = outcome.fitness();
        let improved = fitness < climber.fitness;
        if let Some(kind) = climber.last {
            self.moves.count(kind, improved);
        }
        // The hit of this basin is found, now or before.
        if outcome.is_hit() || outcome == Outcome::Deleted {
            climber.running = false;
            return;
        }
        let mutated = climber.last == Some(Move::Mutation);
        if mutated {
            climber.mutation.adapt(fitness <= climber.fitness);
        }
        climber.stalled = if improved { 0 } else { climber.stalled + 1 };
        // Moves to equal fitness lead across plateaus.
        if fitness <= climber.fitness {
            climber.position.copy_from_slice(position);
            climber.fitness = fitness;
            climber.neighbours = None;
        }
        if (mutated && climber.mutation.sigma < CONVERGED) || climber.stalled > climber.patience {
            climber.running = false;
        }
    }
}

impl<S: Real> Climber<S> {
    fn start(&mut self, length: u64, context: &dyn Context<S>, rng: &mut SearchRng) {
        let space = context.space();
        let dimension = space.dimension();
        self.position.resize(dimension, S::zero());
        rng.position(space, &mut self.position);
        self.fitness = S::infinity();
        self.running = true;
        self.stalled = 0;
        self.patience = length * PATIENCE * dimension as u64;
        self.neighbours = None;
        self.last = None;
        let (smallest, largest) = FIRST_STEP;
        let continuous = space.axes().iter().any(|axis| !axis.is_integer());
        let share = if continuous { rng.uniform() } else { 0.0 };
        self.mutation
            .reset(dimension, largest * (smallest / largest).powf(share));
    }

    /// Moves `position` from the current point to a neighbour not tried yet; a point without one stays where it is, which is no
    /// improvement.
    fn step_to_neighbour(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, position: &mut [S]) {
        let untried = self.neighbours.get_or_insert_with(|| {
            let count = context.neighbour_count(&self.position);
            self.patience = self.patience.max(NEIGHBOUR_PATIENCE * count as u64);
            Untried::all(count, rng)
        });
        let mut found = false;
        while !found && let Some(index) = untried.next() {
            context.neighbours(&self.position, index..index + 1, &mut |_, neighbour| {
                position.copy_from_slice(neighbour);
                found = true;
            });
        }
    }

    fn step(
        &mut self,
        moves: &Moves,
        integer_axes: &[usize],
        context: &dyn Context<S>,
        rng: &mut SearchRng,
        position: &mut [S],
    ) {
        let space = context.space();
        let dimension = position.len();
        let offered = context.offers_neighbours() && self.neighbours.is_none_or(|untried| untried.left > 0);
        let continuous = integer_axes.len() < dimension;
        let chosen = moves.choose([!integer_axes.is_empty(), offered, continuous], rng);
        self.last = Some(chosen);
        position.copy_from_slice(&self.position);
        match chosen {
            Move::Neighbour => self.step_to_neighbour(context, rng, position),
            Move::Lattice(way) => Moves::along(way, space, integer_axes, rng, position),
            Move::Mutation => {
                let width = |axis: &crate::Axis<S>| {
                    if axis.is_integer() {
                        S::zero()
                    } else {
                        axis.width()
                    }
                };
                self.mutation.apply(rng, space.axes().iter().map(width), position);
            }
        }
        space.keep_inside(position);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_index_comes_once() {
        let mut rng = SearchRng::new(1);
        for count in (0..60).chain([1000, 1024, 30_030]) {
            let mut untried = Untried::all(count, &mut rng);
            let mut all: Vec<usize> = core::iter::from_fn(|| untried.next()).collect();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..count), "{count}");
        }
    }
}

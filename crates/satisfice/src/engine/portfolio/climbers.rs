//! Local searches, several at a time, restarted when they stall, hit, or come back to a known hit.

use super::bandit::luby;
use super::moves::Moves;
use super::one_plus_one::Mutation;
use super::visited::Visited;
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::Space;
use crate::state::Saved;

/// How many search at a time: as many candidates of a batch come from different climbers.
const CLIMBERS: usize = 16;
/// Barren evaluations an axis after which the shortest of the restart sequence's runs ends.
const PATIENCE: u64 = 8;
/// A continuous search whose steps fall below this share of the axes has converged.
const CONVERGED: f64 = 1e-9;
/// First step of a continuous search, as a share of the axes.
const FIRST_STEP: f64 = 0.1;

/// A move to a point that was evaluated before, and so cannot be a new hit, is drawn again at most this often.
const DRAWS: usize = 4;

/// What the last move of a climber was.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Move {
    Start,
    /// On integer axes, of this kind.
    Lattice(usize),
    Continuous,
    /// To a neighbour named by the problem.
    Neighbour,
}

/// One local search: keeps its best point, accepts what is no worse.
#[derive(Debug, Clone)]
struct Climber<S> {
    position: Vec<S>,
    fitness: S,
    running: bool,
    barren: u64,
    patience: u64,
    mutation: Mutation,
    /// Neighbours not tried yet, in random order.
    neighbours: Vec<S>,
    last: Move,
}

impl Saved for Move {
    fn save(&self, state: &mut crate::state::State) {
        let word: u64 = match *self {
            Self::Start => 0,
            Self::Continuous => 1,
            Self::Neighbour => 2,
            Self::Lattice(kind) => 3 + kind as u64,
        };
        word.save(state);
    }
    fn restore(from: &mut crate::state::Reader<'_>) -> Result<Self, crate::Error> {
        Ok(match from.read::<u64>()? {
            0 => Self::Start,
            1 => Self::Continuous,
            2 => Self::Neighbour,
            word => Self::Lattice(usize::try_from(word - 3).unwrap_or(0)),
        })
    }
}

crate::saved_struct!(Climber<S: Real> {
    position, fitness, running, barren, patience, mutation, neighbours, last
});

/// Restarted local search. Where the problem names neighbours: first-improvement descent over them in random order. Else, on
/// integer axes, adaptive [`Moves`]; on continuous axes, a [`Mutation`] that adapts its covariance.
#[derive(Debug, Clone)]
pub(super) struct Climbers<S> {
    climbers: Vec<Climber<S>>,
    moves: Moves,
    integer_axes: Vec<usize>,
    restarts: u64,
    next: usize,
    proposed: usize,
}

impl<S: Real> Climbers<S> {
    pub(super) fn new() -> Self {
        let climber = Climber {
            position: Vec::new(),
            fitness: S::infinity(),
            running: false,
            barren: 0,
            patience: 0,
            mutation: Mutation::default(),
            neighbours: Vec::new(),
            last: Move::Start,
        };
        Self {
            climbers: vec![climber; CLIMBERS],
            moves: Moves::default(),
            integer_axes: Vec::new(),
            restarts: 0,
            next: 0,
            proposed: 0,
        }
    }

    pub(super) fn begin(&mut self, context: &dyn Context<S>) {
        let axes = context.space().axes();
        self.integer_axes = (0..axes.len()).filter(|&j| axes[j].is_integer()).collect();
        for climber in &mut self.climbers {
            climber.running = false;
        }
    }

    pub(super) fn save(&self, state: &mut crate::state::State) {
        self.climbers.save(state);
        self.moves.save(state);
        self.integer_axes.save(state);
        self.restarts.save(state);
        self.next.save(state);
    }

    pub(super) fn restore(&mut self, from: &mut crate::state::Reader<'_>) -> Result<(), crate::Error> {
        self.climbers = from.read()?;
        self.moves = from.read()?;
        self.integer_axes = from.read()?;
        self.restarts = from.read()?;
        self.next = from.read()?;
        Ok(())
    }

    /// A new batch begins.
    pub(super) fn begin_batch(&mut self) {
        self.proposed = 0;
    }

    /// Proposes for the next climber and names it, unless every one has proposed in this batch.
    pub(super) fn propose(
        &mut self,
        context: &dyn Context<S>,
        visited: Option<&Visited>,
        rng: &mut SearchRng,
        out: &mut Batch<S>,
    ) -> Option<usize> {
        if self.proposed == self.climbers.len() {
            return None;
        }
        self.proposed += 1;
        let index = self.next;
        self.next = (index + 1) % self.climbers.len();
        let climber = &mut self.climbers[index];
        if climber.running
            && climber.last != Move::Start
            && context.offers_neighbours()
            && climber.neighbours.is_empty()
        {
            climber.running = false; // every neighbour was tried: a local minimum
        }
        if !climber.running {
            self.restarts += 1;
            climber.start(luby(self.restarts), context, rng);
            out.push(&climber.position);
            return Some(index);
        }
        if climber.last == Move::Start && context.offers_neighbours() {
            climber.meet_neighbours(context, rng);
        }
        let space = context.space();
        out.push_with(|position| {
            for _ in 0..DRAWS {
                climber.step(&self.moves, &self.integer_axes, space, rng, position);
                if visited.is_none_or(|visited| !visited.contains(space, position)) {
                    break;
                }
            }
        });
        Some(index)
    }

    /// Tells climber `index` what became of its candidate.
    pub(super) fn tell(&mut self, index: usize, position: &[S], outcome: Outcome<S>) {
        let climber = &mut self.climbers[index];
        let fitness = outcome.fitness();
        let improved = fitness < climber.fitness;
        if let Move::Lattice(kind) = climber.last {
            self.moves.book(kind, improved);
        }
        // A hit is found; a known hit shows that this basin is.
        if outcome.is_hit() || outcome == Outcome::Deleted {
            climber.running = false;
            return;
        }
        if climber.last == Move::Continuous {
            climber.mutation.adapt(fitness <= climber.fitness);
        }
        climber.barren = if improved { 0 } else { climber.barren + 1 };
        // Moves to equal fitness cross plateaus, but among named neighbours they would go in circles.
        if improved
            || (fitness == climber.fitness && climber.last != Move::Neighbour)
            || climber.last == Move::Start
        {
            climber.position.copy_from_slice(position);
            climber.fitness = fitness;
            climber.neighbours.clear();
            climber.last = if climber.last == Move::Neighbour {
                Move::Start
            } else {
                climber.last
            };
        }
        let converged = climber.last == Move::Continuous && climber.mutation.sigma < CONVERGED;
        if converged || climber.barren > climber.patience {
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
        self.barren = 0;
        self.patience = length * PATIENCE * dimension as u64;
        self.neighbours.clear();
        self.last = Move::Start;
        self.mutation.reset(dimension, FIRST_STEP);
    }

    /// Lists the neighbours of the current point in random order.
    fn meet_neighbours(&mut self, context: &dyn Context<S>, rng: &mut SearchRng) {
        let dimension = self.position.len();
        self.neighbours.clear();
        context.neighbours(&self.position, &mut |neighbour| {
            self.neighbours.extend_from_slice(neighbour);
        });
        let count = self.neighbours.len() / dimension;
        for i in (1..count).rev() {
            let other = rng.below(i + 1);
            for j in 0..dimension {
                self.neighbours.swap(i * dimension + j, other * dimension + j);
            }
        }
        // A local minimum of F among neighbours ends the run, patience or not.
        self.patience = self.patience.max(count as u64);
    }

    fn step(
        &mut self,
        moves: &Moves,
        integer_axes: &[usize],
        space: &Space<S>,
        rng: &mut SearchRng,
        position: &mut [S],
    ) {
        let dimension = position.len();
        if self.neighbours.len() >= dimension {
            let start = self.neighbours.len() - dimension;
            position.copy_from_slice(&self.neighbours[start..]);
            self.neighbours.truncate(start);
            self.last = Move::Neighbour;
            return;
        }
        position.copy_from_slice(&self.position);
        // On mixed axes either part moves in its turn, as often as it has axes.
        if rng.below(dimension) < integer_axes.len() {
            self.last = Move::Lattice(moves.apply(space, integer_axes, rng, position));
        } else {
            let widths = space.axes().iter().map(|axis| {
                if axis.is_integer() {
                    S::zero()
                } else {
                    axis.width()
                }
            });
            self.mutation.apply(rng, widths, position);
            self.last = Move::Continuous;
        }
        space.keep_inside(position);
    }
}

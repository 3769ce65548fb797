//! Bounding volumes first, then small swarms in what they leave. A reconstruction.

use std::collections::VecDeque;

use super::pso::constriction;
use super::velocity::Coefficients;
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::compiled::both_scalars;
use crate::engine::exact::region_tree::{Split, Splitter};
use crate::engine::{Ask, Engine, EngineConfig, Origin};
use crate::engine_settings;
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::{Region, Space};

engine_settings! {
    /// Bounding volumes, then swarms, after Li et al. 2010 as the paper mentions it. **A reconstruction** from one sentence: bounding
    /// volumes remove what cannot touch, and a swarm searches the rest. The parameters marked as guessed are ours;
    /// `docs/results/paper.md` sweeps them.
    ///
    /// 1. The space is halved, longest axis first, until a part has at most `leaf` values on every integer axis and `share` of every
    ///    continuous one. A part whose bound ([`Context::lower_bound`]) is at least delta is dropped. For pairs of vertices this is a
    ///    dual traversal of two trees of boxes. With no part left, the space is proved to have no hits; without bounds, the whole space
    ///    is one leaf.
    /// 2. Each leaf in turn, again and again, has a new swarm of `particles` (PSO with constriction, the best attracts, updated once a
    ///    sweep), for `sweeps` times its size over the mean size of the leaves. A particle that leaves the leaf is put on its edge. Hits
    ///    are deleted.
    ///
    /// ```
    /// use satisfice::{Budget, Search, Space, engine::BoundedSwarms, from_fn};
    /// let disc = from_fn(Space::lattice(2, 100)?, 10.0, |x: &[f64]| (x[0] - 50.0).hypot(x[1] - 20.0));
    /// let engine = BoundedSwarms { particles: 8, ..Default::default() };
    /// let report = Search::with(engine).run(&disc, &Budget::evaluations(3000))?;
    /// assert!(report.hit_count() > 10);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    pub struct BoundedSwarms {
        /// Guessed: values of an integer axis that a leaf has at most.
        pub leaf: usize = 64, 1..=1 << 20;
        /// Guessed: share of a continuous axis that a leaf has at most.
        pub share: f64 = 1.0 / 64.0, 1e-12..=1.0;
        /// Regions kept at most; the rest is not split further.
        pub regions: usize = 1 << 14, 1..=1 << 22;
        /// Guessed: swarm size N of a leaf.
        pub particles: usize = 5, 1..=10_000;
        /// Guessed: sweeps over a leaf of mean size before the next leaf.
        pub sweeps: usize = 20, 1..=1_000_000;
        /// Total acceleration phi = c1 + c2; chi = 2 / |2 - phi - sqrt(phi^2 - 4 phi)|.
        pub phi: f64 = 4.1, 4.0..=10.0;
        /// Largest velocity Vmax, as a share of each axis.
        pub v_max: f64 = 0.5, 1e-9..=1.0;
    }
}

impl EngineConfig for BoundedSwarms {
    const NAME: &'static str = "bounded-swarms";
    const ALIASES: &'static [&'static str] = &["li"];
    const SUMMARY: &'static str =
        "reconstructed: bounding volumes exclude regions, then small swarms in the leaves that are left";
    const CITATION: &'static str =
        "after Li et al. 2010, as mentioned by Chen et al. 2012, doi 10.3923/itj.2012.536.539";

    both_scalars!();
}

impl BoundedSwarms {
    #[expect(clippy::cast_precision_loss, reason = "at most 2^20")]
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        Box::new(LeafSwarms {
            leaf: S::of(self.leaf as f64),
            splitter: Splitter {
                first: false,
                resolution: S::of(self.share),
            },
            regions: self.regions,
            particles: self.particles,
            sweeps: self.sweeps as f64,
            coefficients: constriction(self.phi, self.v_max),
            open: VecDeque::new(),
            leaves: Vec::new(),
            started: false,
            unanswered: 0,
            answered: false,
            turn: 0,
            left: 0,
            mean_size: 1.0,
            positions: Vec::new(),
            velocities: Vec::new(),
            bests: Vec::new(),
            fitness: Vec::new(),
        })
    }
}

/// After this many unanswered calls and none answered, the problem has no bounds.
const SILENCE: u32 = 64;
/// Regions bounded in one `ask` at most, so that the clock is read in between.
const WORK: usize = 256;

/// The tree and the swarm of [`BoundedSwarms`].
#[derive(Debug)]
struct LeafSwarms<S> {
    leaf: S,
    splitter: Splitter<S>,
    regions: usize,
    particles: usize,
    sweeps: f64,
    coefficients: Coefficients<S>,
    open: VecDeque<Region<S>>,
    leaves: Vec<Region<S>>,
    started: bool,
    unanswered: u32,
    answered: bool,
    /// The leaf whose turn it is.
    turn: usize,
    /// Sweeps that it still has.
    left: u64,
    mean_size: f64,
    positions: Vec<S>,
    velocities: Vec<S>,
    bests: Vec<S>,
    fitness: Vec<S>,
}

impl<S: Real> LeafSwarms<S> {
    fn is_leaf(&self, space: &Space<S>, region: &Region<S>) -> bool {
        let sides = region.lower.iter().zip(&region.upper);
        space.axes().iter().zip(sides).all(|(axis, (&lower, &upper))| {
            if axis.is_integer() {
                upper - lower < self.leaf
            } else {
                // An axis of one value has no share.
                lower == upper || axis.share_between(lower, upper) <= self.splitter.resolution
            }
        })
    }

    /// Whether a region may hold hits.
    fn survives(&mut self, context: &dyn Context<S>, region: &Region<S>) -> bool {
        match context.lower_bound(region) {
            Some(bound) => {
                self.answered = true;
                // NaN excludes nothing.
                bound < context.threshold() || bound.is_nan()
            }
            None => {
                self.unanswered = self.unanswered.saturating_add(1);
                true
            }
        }
    }

    /// Works on the tree of regions; whether that is over.
    fn exclude(&mut self, context: &dyn Context<S>) -> bool {
        let space = context.space();
        for _ in 0..WORK {
            if !self.answered && self.unanswered >= SILENCE {
                self.open.clear();
                self.leaves = vec![space.region()];
            }
            let Some(region) = self.open.pop_front() else {
                self.finish_tree(space);
                return true;
            };
            if context.evaluations_left() == 0 {
                self.open.push_front(region);
                return false;
            }
            if !self.survives(context, &region) {
                continue;
            }
            let full = self.open.len() + self.leaves.len() + 2 > self.regions;
            if full || self.is_leaf(space, &region) {
                self.leaves.push(region);
                continue;
            }
            match self.splitter.split(space, &region) {
                Split::Halves(lower, upper) => self.open.extend([lower, upper]),
                Split::TooSmall => self.leaves.push(region),
            }
        }
        false
    }

    fn finish_tree(&mut self, space: &Space<S>) {
        let total: f64 = self.leaves.iter().map(|leaf| size(space, leaf)).sum();
        #[expect(clippy::cast_precision_loss, reason = "a mean")]
        let mean = total / self.leaves.len().max(1) as f64;
        self.mean_size = if mean > 0.0 && mean.is_finite() { mean } else { 1.0 };
        self.started = true;
    }

    /// Draws the swarm of the leaf whose turn it is.
    fn draw(&mut self, space: &Space<S>, rng: &mut SearchRng, out: &mut Batch<S>) {
        let leaf = &self.leaves[self.turn];
        let share = size(space, leaf) / self.mean_size;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "saturates"
        )]
        let sweeps = (self.sweeps * share).round() as u64;
        self.left = sweeps.max(1);
        for list in [
            &mut self.positions,
            &mut self.velocities,
            &mut self.bests,
            &mut self.fitness,
        ] {
            list.clear();
        }
        for _ in 0..self.particles {
            out.push_with(|position| {
                for (j, axis) in space.axes().iter().enumerate() {
                    let (lower, upper) = axis.positions_between(leaf.lower[j], leaf.upper[j]);
                    position[j] = lower + S::of(rng.uniform()) * (upper - lower);
                    let limit = self.coefficients.v_max * (upper - lower);
                    self.velocities.push(limit * S::of(2.0 * rng.uniform() - 1.0));
                }
            });
        }
    }

    /// Moves the swarm.
    fn fly(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) {
        let axes = context.space().axes();
        let leaf = &self.leaves[self.turn];
        let dimension = axes.len();
        let best =
            (0..self.fitness.len()).min_by(|&a, &b| self.fitness[a].f64().total_cmp(&self.fitness[b].f64()));
        let best = best.unwrap_or(0) * dimension;
        let Coefficients {
            inertia,
            cognitive,
            social,
            v_max,
        } = &self.coefficients;
        let inertia = inertia.at(|| context.elapsed_share());
        for i in 0..self.particles {
            let row = i * dimension;
            out.push_with(|position| {
                for (j, axis) in axes.iter().enumerate() {
                    let x = self.positions[row + j];
                    let v = &mut self.velocities[row + j];
                    let (lower, upper) = axis.positions_between(leaf.lower[j], leaf.upper[j]);
                    let to_best = *cognitive * S::of(rng.uniform()) * (self.bests[row + j] - x);
                    let to_leader = *social * S::of(rng.uniform()) * (self.bests[best + j] - x);
                    let limit = *v_max * (upper - lower);
                    // In this order a NaN of infinite terms ends at the limit.
                    *v = (inertia * *v + to_best + to_leader).min(limit).max(-limit);
                    let moved = x + *v;
                    position[j] = moved.max(lower).min(upper);
                    if position[j] != moved {
                        *v = -*v;
                    }
                }
            });
        }
    }

    fn check(&self) -> Result<(), Error> {
        let rows = self.bests.len();
        let (drawn, told) = (self.velocities.len(), self.positions.len());
        let fits = self.leaves.is_empty() || self.turn < self.leaves.len();
        if fits
            && rows == told
            && (told == 0 || told == drawn)
            && (self.fitness.is_empty() == self.bests.is_empty())
        {
            Ok(())
        } else {
            Err(Error::State("its swarm and its leaves do not fit".to_owned()))
        }
    }
}

/// Number of values on integer axes times shares of continuous ones.
fn size<S: Real>(space: &Space<S>, region: &Region<S>) -> f64 {
    let sides = region.lower.iter().zip(&region.upper);
    space
        .axes()
        .iter()
        .zip(sides)
        .fold(1.0, |size, (axis, (&lower, &upper))| {
            size * if axis.is_integer() {
                (upper - lower).f64() + 1.0
            } else if axis.lower() < axis.upper() {
                axis.share_between(lower, upper).f64()
            } else {
                1.0
            }
        })
}

impl<S: Real> Engine<S> for LeafSwarms<S> {
    fn begin(&mut self, context: &dyn Context<S>) {
        self.open.clear();
        self.open.push_back(context.space().region());
        self.leaves.clear();
        self.started = false;
        (self.unanswered, self.answered) = (0, false);
        (self.turn, self.left) = (0, 0);
        for list in [
            &mut self.positions,
            &mut self.velocities,
            &mut self.bests,
            &mut self.fitness,
        ] {
            list.clear();
        }
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        if !self.started && !self.exclude(context) {
            return Ask::More;
        }
        if self.leaves.is_empty() {
            return Ask::Covered;
        }
        if self.left == 0 {
            self.draw(context.space(), rng, out);
        } else {
            self.fly(context, rng, out);
        }
        Ask::More
    }

    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        if origin != Origin::Engine {
            return;
        }
        let dimension = context.space().dimension();
        let first = self.bests.is_empty();
        self.positions.clear();
        self.positions.extend(batch.points().flatten());
        if first {
            self.bests.clone_from(&self.positions);
            self.fitness
                .extend(outcomes.iter().map(|outcome| outcome.fitness()));
        } else {
            for (i, outcome) in outcomes.iter().enumerate() {
                let fitness = outcome.fitness();
                if fitness < self.fitness[i] || outcome.is_hit() {
                    let row = i * dimension..(i + 1) * dimension;
                    self.bests[row.clone()].copy_from_slice(&self.positions[row]);
                    self.fitness[i] = fitness;
                }
            }
        }
        self.left = self.left.saturating_sub(1);
        if self.left == 0 {
            self.turn = (self.turn + 1) % self.leaves.len();
        }
    }

    crate::saved_fields!(
        open, leaves, started, unanswered, answered, turn, left, mean_size, positions, velocities, bests, fitness; check
    );
}

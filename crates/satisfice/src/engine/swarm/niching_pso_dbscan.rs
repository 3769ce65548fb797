//! The paper's rival: a particle swarm whose niches are found by clustering. A reconstruction.

use super::dbscan::{ClusterMemory, OUTLIER, dbscan};
use super::particles::{Attractor, Swarm, SwarmRules, set_room_aside};
use super::pso::constriction;
use super::velocity::{Coefficients, turn};
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::compiled::both_scalars;
use crate::engine::{Ask, Engine, EngineConfig, Origin, WarmStart};
use crate::engine_settings;
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::Axis;

engine_settings! {
    /// PSO with constriction and niches, after the rival that the paper names (Wang et al. 2006). **A reconstruction**: of the original
    /// we know only that a swarm searches pairs of indices and that clustering keeps several niches. The parameters marked as
    /// guessed are ours; `docs/results/paper.md` sweeps them.
    ///
    /// Every `period` sweeps, DBSCAN clusters the personal bests (axes scaled to 1, radius `eps`, `min_points`). A particle of a niche is
    /// attracted by the best of its niche,
    ///
    /// ```text
    /// V_i := chi (V_i + phi/2 r1 (P_i - X_i) + phi/2 r2 (G_niche - X_i)),   |V_i| <= Vmax
    /// ```
    ///
    /// an outlier by its own best alone, and it is drawn again when it is slower than `still` on every axis. A niche whose members have
    /// come together within a cell is scattered over the space. A hit is deleted: it becomes the personal best, and F is infinite there
    /// from then on.
    pub struct NichingPsoDbscan {
        /// Swarm size N.
        pub particles: usize = 30, 1..=1_000_000;
        /// Total acceleration phi = c1 + c2; chi = 2 / |2 - phi - sqrt(phi^2 - 4 phi)|.
        pub phi: f64 = 4.1, 4.0..=10.0;
        /// Largest velocity Vmax, as a share of each axis.
        pub v_max: f64 = 0.5, 1e-9..=1.0;
        /// Particles that move between two updates of the attractor: 1 is asynchronous, N once a sweep.
        pub batch: usize = 1, 1..=1_000_000;
        /// Guessed: sweeps between two clusterings.
        pub period: u64 = 10, 1..=1_000_000;
        /// Guessed: radius of DBSCAN, as a share of each axis.
        pub eps: f64 = 0.1, 0.0..=10.0;
        /// Guessed: points that make a core of DBSCAN.
        pub min_points: usize = 3, 1..=1_000_000;
        /// Guessed: an outlier slower than this is drawn again, in cells (1e-4 of a continuous axis).
        pub still: f64 = 0.5, 0.0..=1e9;
    }
}

impl EngineConfig for NichingPsoDbscan {
    const NAME: &'static str = "niching-pso-dbscan";
    const ALIASES: &'static [&'static str] = &["wang"];
    const SUMMARY: &'static str =
        "the paper's rival, reconstructed: a particle swarm with niches found by clustering, hits deleted";
    const CITATION: &'static str = "after Wang et al. 2006, the rival of Chen et al. 2012, doi 10.3923/itj.2012.536.539; DBSCAN: Ester et al. 1996, KDD-96";

    both_scalars!();
}

impl NichingPsoDbscan {
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        let rules = SwarmRules {
            particles: self.particles,
            batch: self.batch,
            attractor: Attractor::Best,
            deletes: true,
        };
        Box::new(NichingSwarm {
            swarm: Swarm::new(rules),
            coefficients: constriction(self.phi, self.v_max),
            period: self.period,
            eps: self.eps,
            min_points: self.min_points,
            still: self.still,
            velocities: Vec::new(),
            niches: Vec::new(),
            memory: ClusterMemory::default(),
            scattered: Vec::new(),
            sweeps: 0,
        })
    }
}

/// One cell of a continuous axis, as a share of it.
const CELL: f64 = 1e-4;

/// The swarm of [`NichingPsoDbscan`].
#[derive(Debug)]
struct NichingSwarm<S> {
    swarm: Swarm<S>,
    coefficients: Coefficients<S>,
    period: u64,
    eps: f64,
    min_points: usize,
    still: f64,
    velocities: Vec<S>,
    niches: Vec<u32>,
    memory: ClusterMemory,
    /// Whether a particle is to be drawn again in this sweep.
    scattered: Vec<bool>,
    sweeps: u64,
}

/// The length of a cell.
fn cell<S: Real>(axis: &Axis<S>) -> S {
    if axis.is_integer() {
        S::one()
    } else {
        S::of(CELL) * axis.width()
    }
}

/// A velocity uniform in ±Vmax, a share of each axis.
fn draw_velocity<S: Real>(v_max: S, context: &dyn Context<S>, rng: &mut SearchRng, velocity: &mut [S]) {
    for (axis, v) in context.space().axes().iter().zip(velocity) {
        *v = v_max * axis.width() * S::of(2.0 * rng.uniform() - 1.0);
    }
}

impl<S: Real> NichingSwarm<S> {
    fn start(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) {
        self.swarm.propose_start(context, rng, out);
        let dimension = context.space().dimension();
        let drawn = self.velocities.len();
        self.velocities.resize(drawn + out.len() * dimension, S::zero());
        for velocity in self.velocities[drawn..].chunks_mut(dimension) {
            draw_velocity(self.coefficients.v_max, context, rng, velocity);
        }
    }

    /// What happens between two sweeps.
    fn begin_sweep(&mut self, context: &dyn Context<S>) {
        let axes = context.space().axes();
        let particles = self.swarm.particles();
        if self.sweeps.is_multiple_of(self.period) {
            let swarm = &self.swarm;
            let distance = |i: usize, j: usize| {
                if context.is_out_of_time() {
                    return f64::INFINITY;
                }
                let pairs = swarm.best(i).iter().zip(swarm.best(j));
                let square = axes.iter().zip(pairs).fold(0.0, |sum, (axis, (&p, &q))| {
                    let width = axis.width().f64();
                    // An axis of one value separates no particles.
                    let share = if width > 0.0 { (p - q).f64() / width } else { 0.0 };
                    sum + share * share
                });
                square.sqrt()
            };
            dbscan(
                particles,
                self.eps,
                self.min_points,
                distance,
                &mut self.memory,
                &mut self.niches,
            );
        }
        self.sweeps += 1;
        self.scattered.clear();
        self.scattered.resize(particles, false);
        for niche in 1..=self.niches.iter().copied().max().unwrap_or(OUTLIER) {
            let members = || (0..particles).filter(|&i| self.niches[i] == niche);
            let together = axes.iter().enumerate().all(|(j, axis)| {
                let ends = members()
                    .map(|i| self.swarm.position(i)[j])
                    .fold((S::infinity(), S::neg_infinity()), |(least, greatest), x| {
                        (least.min(x), greatest.max(x))
                    });
                ends.1 - ends.0 <= cell(axis)
            });
            if together {
                let scattered = &mut self.scattered;
                members().for_each(|i| scattered[i] = true);
            }
        }
    }

    /// The best member of a particle's niche; an outlier is its own.
    fn leader(&self, i: usize) -> usize {
        let niche = self.niches[i];
        if niche == OUTLIER {
            return i;
        }
        let members = (0..self.swarm.particles()).filter(|&k| self.niches[k] == niche);
        members.fold(i, |best, k| {
            if self.swarm.fitness(k) < self.swarm.fitness(best) {
                k
            } else {
                best
            }
        })
    }

    fn stands_still(&self, context: &dyn Context<S>, i: usize) -> bool {
        let velocity = &self.velocities[self.swarm.row(i)];
        let slow =
            |(axis, v): (&Axis<S>, &S)| v.abs() < S::of(self.still) * cell(axis) || axis.width() <= S::zero();
        self.niches[i] == OUTLIER && context.space().axes().iter().zip(velocity).all(slow)
    }

    fn check(&self) -> Result<(), Error> {
        self.swarm
            .fits_rows_drawn("the velocities", self.velocities.len())?;
        let particles = self.swarm.particles();
        let fits = |length: usize| length == particles || (length == 0 && self.sweeps == 0);
        if fits(self.niches.len()) && fits(self.scattered.len()) {
            Ok(())
        } else {
            Err(Error::State(format!(
                "its niches are not of a swarm of {particles}"
            )))
        }
    }
}

impl<S: Real> Engine<S> for NichingSwarm<S> {
    fn begin(&mut self, context: &dyn Context<S>) {
        let dimension = context.space().dimension();
        self.swarm.begin(dimension);
        self.velocities.clear();
        set_room_aside(&mut self.velocities, self.swarm.particles(), dimension);
        self.niches.clear();
        self.scattered.clear();
        self.sweeps = 0;
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        if !self.swarm.has_started() {
            self.start(context, rng, out);
            return Ask::More;
        }
        if self.swarm.begins_sweep() {
            self.begin_sweep(context);
            if context.is_out_of_time() {
                return Ask::More; // niches may not have been found to the end
            }
        }
        for (place, i) in self.swarm.due().enumerate() {
            let row = self.swarm.row(i);
            if self.scattered[i] || self.stands_still(context, i) {
                self.niches[i] = OUTLIER;
                self.swarm.forget(i);
                out.push_with(|position| rng.position(context.space(), position));
                let velocity = &mut self.velocities[row];
                draw_velocity(self.coefficients.v_max, context, rng, velocity);
                continue;
            }
            let leader = self.leader(i);
            let Coefficients {
                inertia,
                cognitive,
                social,
                v_max,
            } = &self.coefficients;
            let inertia = inertia.at(|| context.elapsed_share());
            let (own, attractor) = (self.swarm.best(i), self.swarm.best(leader));
            out.push(self.swarm.position(i));
            let position = out.point_mut(place);
            for (j, axis) in context.space().axes().iter().enumerate() {
                let (x, v) = (&mut position[j], &mut self.velocities[row.start + j]);
                let to_best = *cognitive * S::of(rng.uniform()) * (own[j] - *x);
                let to_niche = *social * S::of(rng.uniform()) * (attractor[j] - *x);
                let limit = *v_max * axis.width();
                // In this order a NaN of infinite terms ends at the limit.
                *v = (inertia * *v + to_best + to_niche).min(limit).max(-limit);
                *x = *x + *v;
            }
        }
        Ask::More
    }

    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        if origin == Origin::Engine && self.swarm.has_started() {
            // A particle that the bound reflects flies back.
            let space = context.space();
            for (place, i) in self.swarm.due().enumerate() {
                let velocity = &mut self.velocities[self.swarm.row(i)];
                let moves = self.swarm.position(i).iter().zip(batch.point(place));
                for ((v, (&from, &to)), axis) in velocity.iter_mut().zip(moves).zip(space.axes()) {
                    if from + *v != to && !self.scattered.get(i).copied().unwrap_or(false) {
                        *v = *v * turn(space.boundary(), axis);
                    }
                }
            }
        }
        self.swarm.tell(batch, outcomes, origin);
    }

    fn deletes(&self) -> bool {
        true
    }

    /// The paper's rule, for every swarm.
    fn warm_start(&self) -> WarmStart {
        WarmStart::Engine
    }

    crate::saved_fields!(swarm, velocities, niches, scattered, sweeps; check);
}

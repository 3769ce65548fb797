//! The paper's engine: a quantum-behaved particle swarm attracted by the latest hit.

use super::potential_well::{mean_best, step};
use super::{Ask, Engine, Origin, WarmStart};
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::error::Error;
use crate::parameter::{Parameter, Values};
use crate::scalar::Real;
use crate::seed::SearchRng;

pub(super) const PARAMETERS: &[Parameter] = &[
    Parameter::integer("particles", "swarm size N", 30, 1, 1_000_000),
    Parameter::real(
        "alpha",
        "contraction-expansion coefficient; bounded below 1.781",
        1.0,
        0.0,
        10.0,
    ),
];

/// Latest-hit QPSO, literally as published, in the reading of the project's docs.
///
/// Each particle in turn (asynchronously: an attractor found is in force for the next particle of the same sweep) moves by
///
/// ```text
/// X_i := phi P_i + (1 - phi) G ± alpha |mbest - X_i| ln(1/u)
/// ```
///
/// where G is the latest hit, or the best of the P while there is none, and mbest the mean of the P at the start of the
/// sweep. A hit becomes G and P_i; another point becomes P_i if it is better. Hits are deleted from the space: found again
/// they count as infinitely bad. A slice starts from N random hits of the slice before, evaluated anew, filled up with
/// uniform points.
///
/// Chen, Ye, An, Wang 2012, doi 10.3923/itj.2012.536.539.
#[derive(Debug)]
pub(super) struct LatestHitQpso<S> {
    particles: usize,
    alpha: S,
    positions: Vec<S>,
    bests: Vec<S>,
    best_fitness: Vec<S>,
    mean: Vec<S>,
    /// G, once there is a hit.
    latest_hit: Option<Vec<S>>,
    /// The particle whose turn it is.
    turn: usize,
    started: bool,
}

impl<S: Real> LatestHitQpso<S> {
    pub(super) fn build(values: &Values) -> Result<Box<dyn Engine<S>>, Error> {
        Ok(Box::new(Self {
            particles: values.count("particles"),
            alpha: S::of(values.real("alpha")),
            positions: Vec::new(),
            bests: Vec::new(),
            best_fitness: Vec::new(),
            mean: Vec::new(),
            latest_hit: None,
            turn: 0,
            started: false,
        }))
    }

    /// N random members of C_prev without replacement, or all of them, then uniform points.
    fn propose_start(&self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) {
        let hits = context.previous_hits();
        for i in 0..self.particles {
            let chosen = if hits <= self.particles {
                (i < hits).then_some(i)
            } else {
                None
            };
            out.push_with(|position| {
                let encoded = chosen.is_some_and(|index| context.previous_hit(index, position));
                if !encoded {
                    rng.position(context.space(), position);
                }
            });
        }
        if hits > self.particles {
            // N different ones from more than N: drawing again on a repetition costs about N ln N draws at worst.
            let mut drawn = std::collections::BTreeSet::new();
            while drawn.len() < self.particles {
                let index = rng.below(hits);
                if drawn.insert(index) {
                    // Where the problem does not encode, the uniform point stays.
                    let _ = context.previous_hit(index, out.point_mut(drawn.len() - 1));
                }
            }
        }
    }

    fn best_particle(&self) -> usize {
        let by_fitness =
            |&a: &usize, &b: &usize| self.best_fitness[a].f64().total_cmp(&self.best_fitness[b].f64());
        (0..self.particles).min_by(by_fitness).unwrap_or(0)
    }
}

impl<S: Real> Engine<S> for LatestHitQpso<S> {
    fn begin(&mut self, context: &dyn Context<S>) {
        let dimension = context.space().dimension();
        self.positions = Vec::with_capacity(self.particles * dimension);
        self.mean = vec![S::zero(); dimension];
        self.latest_hit = None;
        self.turn = 0;
        self.started = false;
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        if !self.started {
            self.propose_start(context, rng, out);
            return Ask::More;
        }
        if self.turn == 0 {
            mean_best(&self.bests, &mut self.mean);
        }
        let dimension = self.mean.len();
        let row = self.turn * dimension..(self.turn + 1) * dimension;
        let attractor = match &self.latest_hit {
            Some(hit) => hit,
            None => &self.bests[self.best_particle() * dimension..][..dimension],
        };
        let position = &mut self.positions[row.clone()];
        step(rng, self.alpha, position, &self.bests[row], attractor, &self.mean);
        out.push(position);
        Ask::More
    }

    fn tell(&mut self, _: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        if origin != Origin::Engine {
            // A hit that somebody else found is the latest hit all the same.
            if let Some(i) = outcomes.iter().rposition(|outcome| outcome.is_hit()) {
                self.latest_hit = Some(batch.point(i).to_vec());
            }
            return;
        }
        if !self.started {
            self.started = true;
            self.positions = batch.points().flatten().copied().collect();
            self.bests = self.positions.clone();
            self.best_fitness = outcomes.iter().map(|outcome| outcome.fitness()).collect();
            return;
        }
        let dimension = self.mean.len();
        let i = self.turn;
        let row = i * dimension..(i + 1) * dimension;
        let position = batch.point(0);
        let fitness = outcomes[0].fitness();
        self.positions[row.clone()].copy_from_slice(position);
        let hit = outcomes[0].is_hit();
        if hit || fitness < self.best_fitness[i] {
            self.bests[row].copy_from_slice(position);
            self.best_fitness[i] = fitness;
        }
        if hit {
            match &mut self.latest_hit {
                Some(latest) => latest.copy_from_slice(position),
                None => self.latest_hit = Some(position.to_vec()),
            }
        }
        self.turn = (i + 1) % self.particles;
    }

    /// The paper's own rule.
    fn warm_start(&self) -> WarmStart {
        WarmStart::Engine
    }

    crate::saved_fields!(positions, bests, best_fitness, mean, latest_hit, turn, started);
}

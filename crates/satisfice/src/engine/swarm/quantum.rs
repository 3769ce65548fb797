//! The machinery of quantum-behaved swarms: Eq. 2 of the paper, particle after particle.

use super::particles::{Swarm, SwarmRules};
use super::potential_well::{draw, mean_best};
use super::schedule::Schedule;
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::{Ask, Engine, Origin, Steps, WarmStart};
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;

/// A swarm whose particles are drawn from delta potential wells.
///
/// Each particle in turn moves by
///
/// ```text
/// X_i := phi P_i + (1 - phi) G ± alpha |mbest - X_i| ln(1/u),   phi ~ U(0, 1), u ~ U(0, 1], fair sign, per axis
/// ```
///
/// where mbest is the mean of the P at the start of the sweep. With a batch of 1 (asynchronously), a new attractor acts on the
/// next particle of the same sweep.
#[derive(Debug)]
pub(super) struct QuantumSwarm<S> {
    swarm: Swarm<S>,
    alpha: Schedule<S>,
    mean: Vec<S>,
}

impl<S: Real> QuantumSwarm<S> {
    pub(super) fn new(rules: SwarmRules, alpha: Schedule<S>) -> Self {
        Self {
            swarm: Swarm::new(rules),
            alpha,
            mean: Vec::new(),
        }
    }

    fn check(&self) -> Result<(), Error> {
        self.swarm.fits("the mean", self.mean.len(), 1)
    }
}

impl<S: Real> Engine<S> for QuantumSwarm<S> {
    fn begin(&mut self, context: &dyn Context<S>) {
        let dimension = context.space().dimension();
        self.swarm.begin(dimension);
        self.mean.clear();
        self.mean.resize(dimension, S::zero());
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        let swarm = &self.swarm;
        if !swarm.has_started() {
            swarm.propose_start(context, rng, out);
            return Ask::More;
        }
        if swarm.begins_sweep() && !mean_best(swarm.bests(), &mut self.mean, || context.is_out_of_time()) {
            return Ask::More;
        }
        let alpha = self.alpha.at(|| context.elapsed_share());
        for i in swarm.due() {
            let row = out.push_row();
            row.copy_from_slice(swarm.position(i));
            displace(rng, alpha, row, swarm.best(i), swarm.attractor(), &self.mean);
        }
        Ask::More
    }

    fn advance(&mut self, rng: &mut SearchRng, steps: &mut dyn Steps<S>) -> bool {
        if !self.swarm.is_asynchronous() {
            return false;
        }
        loop {
            if self.swarm.begins_sweep()
                && !mean_best(self.swarm.bests(), &mut self.mean, || steps.is_out_of_time())
            {
                return true;
            }
            let alpha = self.alpha.at(|| steps.elapsed_share());
            let mean = &self.mean;
            let more = self.swarm.step(steps, |x, best, attractor| {
                displace(rng, alpha, x, best, attractor, mean);
            });
            if !more {
                return true;
            }
        }
    }

    fn tell(&mut self, _: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        self.swarm.tell(batch, outcomes, origin);
    }

    fn deletes(&self) -> bool {
        self.swarm.deletes()
    }

    /// The paper's own rule, for every swarm.
    fn warm_start(&self) -> WarmStart {
        WarmStart::Engine
    }

    crate::saved_fields!(swarm, mean; check);
}

/// Moves a particle on all axes. All rows are cut to one length, so that no coordinate's place is checked.
#[inline(always)]
#[expect(
    clippy::inline_always,
    reason = "a call per step would cost a tenth of the whole"
)]
fn displace<S: Real>(rng: &mut SearchRng, alpha: S, x: &mut [S], best: &[S], attractor: &[S], mean: &[S]) {
    let d = x.len();
    let (best, attractor, mean) = (&best[..d], &attractor[..d], &mean[..d]);
    for j in 0..d {
        x[j] = draw(rng, alpha, x[j], best[j], attractor[j], mean[j]);
    }
}

#[cfg(test)]
mod tests {
    use super::super::potential_well::draw;
    use super::*;

    /// X_i on each axis is a draw of its own, from the particle's row of each list.
    #[test]
    fn a_particle_moves_on_each_axis_by_its_own_draw() {
        let (best, attractor, mean) = ([1.0, -4.0], [2.0, 5.0], [0.5, 0.25]);
        let mut moved = [3.0, 7.0];
        displace(&mut SearchRng::new(3), 0.75, &mut moved, &best, &attractor, &mean);
        let mut twin = SearchRng::new(3);
        let expected = [
            draw(&mut twin, 0.75, 3.0, 1.0, 2.0, 0.5),
            draw(&mut twin, 0.75, 7.0, -4.0, 5.0, 0.25),
        ];
        assert_eq!(moved, expected);
    }
}

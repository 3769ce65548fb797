//! A random walk from the latest hit: a simple baseline for swarms.

use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::compiled::both_scalars;
use crate::engine::{Ask, Engine, EngineConfig, Origin};
use crate::engine_settings;
use crate::scalar::Real;
use crate::seed::SearchRng;

engine_settings! {
    /// From the latest hit G, one point at a time, on every axis j of width w_j
    ///
    /// ```text
    /// X_j = G_j + s_j U(-1, 1),   s_j = w_j shortest_j^u,   u ~ U(0, 1), the same for all axes
    /// ```
    ///
    /// so that the lengths s are log-uniform between the shortest step (a cell on an integer axis) and the whole axis. One point in
    /// ten, and every point while there is no hit, is uniform. Hits are deleted.
    pub struct Walk {
        /// Share of uniform points.
        pub uniform: f64 = 0.1, 0.0..=1.0;
        /// Shortest step on a continuous axis, as a share of it; on an integer axis it is a cell.
        pub shortest: f64 = 1e-4, 1e-12..=1.0;
    }
}

impl EngineConfig for Walk {
    const NAME: &'static str = "walk";
    const SUMMARY: &'static str =
        "random walk from the latest hit, steps of log-uniform length, a tenth uniform";
    const CITATION: &'static str = "none";

    both_scalars!();
}

impl Walk {
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        Box::new(LatestHitWalk {
            uniform: self.uniform,
            shortest: self.shortest,
            latest_hit: None,
        })
    }
}

/// The engine of [`Walk`].
#[derive(Debug)]
struct LatestHitWalk<S> {
    uniform: f64,
    shortest: f64,
    latest_hit: Option<Vec<S>>,
}

impl<S: Real> Engine<S> for LatestHitWalk<S> {
    fn begin(&mut self, _: &dyn Context<S>) {
        self.latest_hit = None;
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        let space = context.space();
        let from = self.latest_hit.as_ref().filter(|_| rng.uniform() >= self.uniform);
        let Some(from) = from else {
            out.push_with(|position| rng.position(space, position));
            return Ask::More;
        };
        out.push(from);
        let u = rng.uniform();
        for (axis, x) in space.axes().iter().zip(out.point_mut(0)) {
            let width = axis.width().f64();
            let step = if axis.is_integer() {
                width.powf(1.0 - u)
            } else {
                width * self.shortest.powf(u)
            };
            *x = *x + S::of(step * (2.0 * rng.uniform() - 1.0));
        }
        Ask::More
    }

    fn tell(&mut self, _: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], _: Origin) {
        let Some(i) = outcomes.iter().rposition(|outcome| outcome.is_hit()) else {
            return;
        };
        let latest = self.latest_hit.get_or_insert_default();
        latest.clear();
        latest.extend_from_slice(batch.point(i));
    }

    crate::saved_fields!(latest_hit);
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::Walk;
    use crate::{Budget, Search, Space, from_fn};

    /// A step is s U(-1, 1) with s = q^u, q = 1e-4 the shortest and u ~ U(0, 1), in units of the axis. It is shorter than t with
    /// probability 1 - ln(t) / ln(q) + (t - 1) / ln(q), integrated over u.
    #[test]
    fn lengths_of_steps_are_log_uniform() {
        let visited = Mutex::new(Vec::new());
        // Every point is a hit, so that each step starts at the point before.
        let problem = from_fn(Space::cube(1, -1.0, 1.0).unwrap(), 1.0, |x: &[f64]| {
            visited.lock().unwrap().push(x[0]);
            0.0
        })
        .boxed()
        .separation(0.0);
        let settings = Walk {
            uniform: 0.0,
            ..Walk::default()
        };
        let budget = Budget::evaluations(20_000);
        Search::with(settings).probes(0.0).run(&problem, &budget).unwrap();
        drop(problem);
        let visited = visited.into_inner().unwrap();
        let logarithm = 1e-4_f64.ln();
        for t in [1e-3_f64, 1e-2, 1e-1] {
            let shorter = visited
                .windows(2)
                .filter(|pair| (pair[1] - pair[0]).abs() / 2.0 < t)
                .count();
            let expected = 1.0 - t.ln() / logarithm + (t - 1.0) / logarithm;
            approx::assert_abs_diff_eq!(shorter as f64 / visited.len() as f64, expected, epsilon = 0.02);
        }
    }
}

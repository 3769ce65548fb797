//! What an engine may ask while it searches. It never sees the problem.

use crate::scalar::Real;
use crate::space::{Region, Space};

/// The engine's view of a run. All points are *positions*.
pub trait Context<S: Real> {
    /// The space.
    fn space(&self) -> &Space<S>;

    /// The threshold delta: a hit is F < delta.
    fn threshold(&self) -> S;

    /// Share of the budget (or of its [horizon](crate::Budget::with_horizon)) that is used, in `[0, 1]`: what schedules
    /// follow. 0 if nothing limits evaluations or time.
    fn elapsed_share(&self) -> f64;

    /// Number of candidates evaluated in this slice so far.
    fn evaluations(&self) -> u64;

    /// Number of hits in C so far.
    fn hits(&self) -> usize;

    /// Whether the solution at a position is in C. Cost: a hash look-up.
    fn is_deleted(&self, position: &[S]) -> bool;

    /// Visits positions next to `of`, in a fixed order: the problem's own neighbours; else the next lattice points along
    /// each integer axis. `false`, without a visit, where there are none of either kind.
    fn neighbours(&self, of: &[S], visit: &mut dyn FnMut(&[S])) -> bool;

    /// Whether the problem declares a neighbourhood, together with an encoding.
    fn offers_neighbours(&self) -> bool;

    /// The problem's lower bound of F in a region of values, if it offers one. Every answer is counted, and
    /// uses up the budget like an evaluation.
    fn lower_bound(&self, region: &Region<S>) -> Option<S>;

    /// Whether every point of a region of values is known to be the same answer as one hit in C, so that nothing new is
    /// there. `false` if not, or if the problem cannot tell.
    fn covers(&self, _region: &Region<S>) -> bool {
        false
    }

    /// How many evaluations and calls of bounds the budget still allows.
    fn evaluations_left(&self) -> u64 {
        u64::MAX
    }

    /// How many evaluations are planned from now on: what the budget, or its [horizon](crate::Budget::with_horizon), has left.
    /// `None` where neither limits evaluations. Calls of bounds count.
    fn evaluations_planned(&self) -> Option<u64> {
        None
    }

    /// Number of hits of the slice before this one, C_prev.
    fn previous_hits(&self) -> usize;

    /// Writes the position of hit `index` of the slice before; `false` if there is none or the problem does not encode.
    fn previous_hit(&self, index: usize, position: &mut [S]) -> bool;
}

//! What an engine may ask while it searches. It never sees the problem.

use core::ops::Range;

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

    /// The number of indices of neighbours of `of`: those of the problem's own neighbours, if it declares any and `of` can be
    /// encoded; else the next lattice points, other categories, swaps of near places; empty on continuous axes.
    fn neighbour_count(&self, of: &[S]) -> usize;

    /// Visits the neighbours at some indices below [`neighbour_count`](Self::neighbour_count), in order, with each one's
    /// index. Some indices may be empty. Cost: one decoding, and one encoding a neighbour; take few at a time where there
    /// are many.
    fn neighbours(&self, of: &[S], indices: Range<usize>, visit: &mut dyn FnMut(usize, &[S]));

    /// Number of [components](crate::Components) of F; 0 where the problem declares none.
    fn component_count(&self) -> usize {
        0
    }

    /// Computes the components of F at a position: one decoding, and about the cost of F.
    fn components(&self, _position: &[S], _components: &mut [S]) {}

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
    /// `None` if neither limits evaluations. Calls of bounds count.
    fn evaluations_planned(&self) -> Option<u64> {
        None
    }

    /// The share of the planned evaluations that are [probes](crate::Search::probes), not the engine's.
    fn probe_share(&self) -> f64 {
        0.0
    }

    /// How many [islands](crate::Search::islands) the search has, of which each has such a plan.
    fn islands(&self) -> usize {
        1
    }

    /// How many evaluations can go on at once: what the [budget says](crate::Budget::with_parallel); where tickets are answered in
    /// any order, at least as many as are out or asked for; the number of threads where only the clock limits the slice. 1 where nothing
    /// is known.
    fn parallel(&self) -> usize {
        1
    }

    /// Whether answers are told one by one, in any order, while the engine is asked for more: where [they come as they
    /// come](crate::Tickets::eager), and the engine [says so](crate::engine::Answers::AnyOrder).
    fn is_in_any_order(&self) -> bool {
        false
    }

    /// Seconds that a call of the fitness has taken lately; where it is computed elsewhere, the time that a batch was out by its points, or,
    /// where answers come in any order, the mean time of an evaluation, thinking included, as of the last look at the clock. `None` unless [only time is limited](Self::is_timed), so that no other search depends on the clock,
    /// and before the first ones.
    fn seconds_an_evaluation(&self) -> Option<f64> {
        None
    }

    /// Whether time is limited and evaluations are not: such a search may choose by the clock, any other gives the same hits again.
    fn is_timed(&self) -> bool {
        false
    }

    /// Seconds that the slice may take, if its budget limits them: what the user has set, not what the clock says.
    fn seconds_planned(&self) -> Option<f64> {
        None
    }

    /// Whether the time of the slice has run out: nothing proposed from now on is evaluated, so that an engine need not go on with
    /// costly work. `false` where no time limits the slice, which does then not depend on the clock.
    fn is_out_of_time(&self) -> bool {
        false
    }

    /// Number of hits of the slice before this one, C_prev.
    fn previous_hits(&self) -> usize;

    /// Writes the position of hit `index` of the slice before; `false` if there is none or the problem does not encode.
    fn previous_hit(&self, index: usize, position: &mut [S]) -> bool;
}

/// How many points an engine proposes at most before the search reads the clock: 2^18 coordinates, which take some milliseconds.
pub(crate) fn points_between_looks(dimension: usize) -> usize {
    const COORDINATES: usize = 1 << 18;
    (COORDINATES / dimension.max(1)).max(1)
}

/// How many points an engine works on at a time where it does more than to write them down: 256 in most spaces, fewer where
/// each has more than a thousand coordinates.
pub(crate) fn points_at_once(dimension: usize) -> usize {
    points_between_looks(dimension).min(256)
}

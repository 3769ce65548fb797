//! Watching a search, and stopping it.

use core::ops::ControlFlow;

use crate::archive::Hit;
use crate::report::TracePoint;

/// Watches a slice: it is told of hits and progress, and may end the slice, but cannot change the search.
///
/// A closure over [`Hit`] and count is an observer; for progress, implement the trait:
///
/// ```
/// use std::ops::ControlFlow;
/// use satisfice::{from_fn, Budget, Observer, RunOptions, Search, Space, StopReason, TracePoint};
///
/// struct Limit(u64);
/// impl<T> Observer<T> for Limit {
///     fn progress(&mut self, now: TracePoint, _share: f64) -> ControlFlow<()> {
///         if now.evaluations > self.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
///     }
/// }
///
/// let problem = from_fn(Space::cube(2, -1.0, 1.0)?, 0.01, |x: &[f64]| x[0].hypot(x[1]));
/// let budget = Budget::evaluations(1_000_000_000);
/// let report = Search::new().run_with(&problem, &budget, RunOptions::new().observer(&mut Limit(10_000)))?;
/// assert_eq!(report.stop_reason, StopReason::Observer);
/// # Ok::<(), satisfice::Error>(())
/// ```
pub trait Observer<T> {
    /// A new hit, the `count`-th. `Break` ends the slice; this hit is kept.
    fn hit(&mut self, _hit: Hit<'_, T>, _count: usize) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// The progress of the slice, at most about a hundred times a second. `share` is the used share of the budget, in
    /// `[0, 1]`. `Break` ends the slice.
    fn progress(&mut self, _now: TracePoint, _share: f64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Watches nothing.
impl<T> Observer<T> for () {}

/// A closure that is called with every hit and its number.
impl<T, F: FnMut(Hit<'_, T>, usize) -> ControlFlow<()>> Observer<T> for F {
    fn hit(&mut self, hit: Hit<'_, T>, count: usize) -> ControlFlow<()> {
        self(hit, count)
    }
}

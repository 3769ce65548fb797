//! Watching a search, and stopping it.

use core::ops::ControlFlow;

use crate::archive::Hit;
use crate::report::TracePoint;

/// Somebody who watches. Observers see and may stop; they never steer.
pub trait Observer<T> {
    /// A new hit, the `count`-th. `Break` ends the slice; this hit is kept.
    fn hit(&mut self, _hit: Hit<'_, T>, _count: usize) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// How far the slice is, about a hundred times a second at most. `share` is the used part of the budget, in `[0, 1]`.
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

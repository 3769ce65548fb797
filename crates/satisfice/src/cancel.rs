//! A flag that ends a slice.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that ends a slice from another thread, a signal handler or an observer. Clones share it.
///
/// ```
/// use satisfice::{Budget, Cancel, Search, Space, StopReason, from_fn};
/// let flag = Cancel::new();
/// let problem = from_fn(Space::cube(2, -1.0, 1.0)?, 0.1, |x: &[f64]| {
///     flag.cancel(); // here from the fitness; as well from another thread
///     x[0].hypot(x[1])
/// });
/// let report = Search::new().run(&problem, &Budget::evaluations(10_000).and_until(&flag))?;
/// assert_eq!(report.stop_reason, StopReason::Cancelled);
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Cancel(Arc<AtomicBool>);

impl Cancel {
    /// A flag that is not raised.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }
    /// Raises it. Nothing lowers it.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
    /// Whether it is raised.
    #[inline]
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

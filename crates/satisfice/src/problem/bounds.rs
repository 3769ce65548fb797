//! Lower bounds of a problem that is a closure, by a closure.

use std::sync::Arc;

use super::FnProblem;
use crate::capability::Bounds;
use crate::space::Region;

/// A lower bound of F in a region, if one is known.
type LowerBound<S> = dyn Fn(&Region<S>) -> Option<S> + Send + Sync;

/// The bounds of a [`FnProblem`].
#[derive(Clone)]
pub(super) struct FnBounds<S>(Arc<LowerBound<S>>);

impl<S> core::fmt::Debug for FnBounds<S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("bounds")
    }
}

impl<S> Bounds<S> for FnBounds<S> {
    fn lower_bound(&self, region: &Region<S>) -> Option<S> {
        (self.0)(region)
    }
}

impl<S, F> FnProblem<S, F> {
    /// The same problem with [lower bounds](Bounds) of F: `lower_bound` gets a region and returns a value that F equals or exceeds
    /// everywhere in it, or `None` if it knows none. By default engines then exclude regions, and can prove that no hit is missing.
    ///
    /// A problem of your own that passes its calls on to this one calls the method of the trait by its full name,
    /// `SatisficingProblem::bounds(&inner)`: this one has the same.
    ///
    /// ```
    /// use satisfice::{Budget, Completeness, Region, Search, Space, from_fn};
    /// let sums = from_fn(Space::lattice(3, 100_000)?, 4.0, |x: &[f64]| x[0] + x[1] + x[2])
    ///     .bounds(|region: &Region<f64>| Some(region.lower.iter().sum()));
    /// let report = Search::new().run(&sums, &Budget::evaluations(5_000))?;
    /// assert_eq!((report.hit_count(), report.completeness), (20, Completeness::Proved));
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    #[must_use]
    pub fn bounds(mut self, lower_bound: impl Fn(&Region<S>) -> Option<S> + Send + Sync + 'static) -> Self {
        self.bounds = Some(FnBounds(Arc::new(lower_bound)));
        self
    }
}

//! A context for engines that are asked by hand.

use core::ops::Range;

use crate::context::Context;
use crate::scalar::Real;
use crate::space::{Region, Space};

/// A run without hits, neighbours, bounds or a budget: what a test of an engine's equations needs.
///
/// ```
/// use satisfice::engine::{Ask, EngineConfig, Pso};
/// use satisfice::{Batch, SearchRng, Space, testing::BareContext};
/// let context = BareContext::new(Space::<f64>::cube(2, -1.0, 1.0)?);
/// let mut engine = Pso { particles: 9, ..Pso::default() }.build::<f64>();
/// engine.begin(&context);
/// let mut start = Batch::new(2);
/// assert_eq!(engine.ask(&context, &mut SearchRng::new(1), &mut start), Ask::More);
/// assert_eq!(start.len(), 9);
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct BareContext<S> {
    space: Space<S>,
}

impl<S: Real> BareContext<S> {
    /// The context of this space. The threshold is minus infinity.
    #[must_use]
    pub fn new(space: Space<S>) -> Self {
        Self { space }
    }
}

impl<S: Real> Context<S> for BareContext<S> {
    fn space(&self) -> &Space<S> {
        &self.space
    }
    fn threshold(&self) -> S {
        S::neg_infinity()
    }
    fn elapsed_share(&self) -> f64 {
        0.0
    }
    fn evaluations(&self) -> u64 {
        0
    }
    fn hits(&self) -> usize {
        0
    }
    fn is_deleted(&self, _: &[S]) -> bool {
        false
    }
    fn neighbour_count(&self, of: &[S]) -> usize {
        2 * of.len() // all of them empty
    }
    fn neighbours(&self, _: &[S], _: Range<usize>, _: &mut dyn FnMut(usize, &[S])) {}
    fn offers_neighbours(&self) -> bool {
        false
    }
    fn lower_bound(&self, _: &Region<S>) -> Option<S> {
        None
    }
    fn previous_hits(&self) -> usize {
        0
    }
    fn previous_hit(&self, _: usize, _: &mut [S]) -> bool {
        false
    }
}

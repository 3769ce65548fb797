//! The neighbours of a problem that is a closure, by a closure.

use std::sync::Arc;

use super::FnProblem;
use crate::capability::Neighbourhood;
use crate::identity::Located;
use crate::scalar::Real;

/// Turns a copy of the values of a solution into those of its neighbour at an index; `false` if there is none.
type MoveTo<S> = dyn Fn(&mut [S], usize) -> bool + Send + Sync;

/// The neighbours of a [`FnProblem`].
#[derive(Clone)]
pub(super) struct FnNeighbours<S> {
    count: usize,
    move_to: Arc<MoveTo<S>>,
}

impl<S> core::fmt::Debug for FnNeighbours<S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{} neighbours", self.count)
    }
}

impl<S: Real> Neighbourhood<Located<S>> for FnNeighbours<S> {
    fn count(&self, _: &Located<S>) -> usize {
        self.count
    }

    fn neighbour(&self, of: &Located<S>, index: usize) -> Option<Located<S>> {
        let mut neighbour = of.clone();
        self.moves(&mut neighbour.coordinates, index).then_some(neighbour)
    }

    fn neighbour_into(&self, of: &Located<S>, index: usize, neighbour: &mut Located<S>) -> bool {
        neighbour.set(&of.coordinates, &of.separation);
        self.moves(&mut neighbour.coordinates, index)
    }
}

impl<S> FnNeighbours<S> {
    fn moves(&self, values: &mut [S], index: usize) -> bool {
        index < self.count && (self.move_to)(values, index)
    }
}

impl<S: Real, F> FnProblem<S, F> {
    /// The same problem with its own [neighbours](Neighbourhood), at the indices `0..count`: `move_to` gets a copy of the values of a
    /// solution and an index, and turns the copy into that neighbour, or returns `false` if there is none. The values have to stay in the
    /// space. Engines then use these in place of steps along the axes.
    ///
    /// Worth naming where a step along one axis spoils a good solution. Here some of 30 items weigh at most 300 and are worth at least 330; a
    /// neighbour takes one item in or out, or swaps one inside for one outside, which changes the weight less:
    ///
    /// ```
    /// use satisfice::{Budget, Search, Space, from_fn};
    /// let knapsack = from_fn(Space::lattice(30, 2)?, 0.5, |x: &[f64]| {
    ///     let (mut weight, mut value) = (0.0, 0.0);
    ///     for (x, i) in x.iter().zip(0..) {
    ///         let item = f64::from(5 + 37 * i % 41);
    ///         weight += x * item;
    ///         value += x * (item * (0.6 + 0.8 * f64::from(53 * i % 97) / 97.0)).round();
    ///     }
    ///     (weight - 300.0).max(0.0) + (330.0 - value).max(0.0)
    /// })
    /// .neighbours(30 + 30 * 30, |x, index| {
    ///     if index < 30 {
    ///         x[index] = 1.0 - x[index];
    ///         return true;
    ///     }
    ///     let (i, j) = (index % 30, index / 30 - 1);
    ///     x.swap(i, j);
    ///     i < j && x[i] != x[j] // each pair once, and only if it differs
    /// });
    /// let report = Search::new().run(&knapsack, &Budget::evaluations(2000))?;
    /// assert!(report.hit_count() > 0);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    #[must_use]
    pub fn neighbours(
        mut self,
        count: usize,
        move_to: impl Fn(&mut [S], usize) -> bool + Send + Sync + 'static,
    ) -> Self {
        let move_to = Arc::new(move_to);
        self.neighbours = (count > 0).then_some(FnNeighbours { count, move_to });
        self
    }
}

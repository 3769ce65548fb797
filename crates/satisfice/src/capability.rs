//! Optional capabilities of a problem. Engines run without them, and better with them.
//!
//! A problem declares each capability by returning an object: often itself, or one of its fields.
//!
//! ```
//! use satisfice::{Bounds, Encoding, Neighbourhood, Region, SatisficingProblem, Space};
//!
//! /// Pairs of numbers below 100 whose sum is less than 5.
//! struct SmallSums(Space<f64>);
//!
//! impl SatisficingProblem for SmallSums {
//!     type Scalar = f64;
//!     type Solution = [u32; 2];
//!     fn space(&self) -> &Space<f64> { &self.0 }
//!     fn decode(&self, values: &[f64]) -> [u32; 2] { [values[0] as u32, values[1] as u32] }
//!     fn fitness(&self, &[a, b]: &[u32; 2]) -> f64 { f64::from(a + b) }
//!     fn threshold(&self) -> f64 { 5.0 }
//!     fn encoding(&self) -> Option<&dyn Encoding<f64, [u32; 2]>> { Some(self) }
//!     fn neighbourhood(&self) -> Option<&dyn Neighbourhood<[u32; 2]>> { Some(self) }
//!     fn bounds(&self) -> Option<&dyn Bounds<f64>> { Some(self) }
//! }
//!
//! impl Encoding<f64, [u32; 2]> for SmallSums {
//!     fn encode(&self, &[a, b]: &[u32; 2], values: &mut [f64]) -> bool {
//!         values.copy_from_slice(&[f64::from(a), f64::from(b)]);
//!         true
//!     }
//! }
//!
//! impl Neighbourhood<[u32; 2]> for SmallSums {
//!     fn count(&self, _: &[u32; 2]) -> usize { 2 }
//!     fn neighbour(&self, &[a, b]: &[u32; 2], index: usize) -> Option<[u32; 2]> {
//!         match index {
//!             0 if a > 0 && b < 99 => Some([a - 1, b + 1]),
//!             1 if a < 99 && b > 0 => Some([a + 1, b - 1]),
//!             _ => None,
//!         }
//!     }
//! }
//!
//! impl Bounds<f64> for SmallSums {
//!     fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
//!         Some(region.lower[0] + region.lower[1])
//!     }
//! }
//!
//! let problem = SmallSums(Space::lattice(2, 100)?);
//! let checked = satisfice::testing::problem::check(&problem, 1);
//! assert_eq!(checked, []); // no law is broken
//! assert!(checked.hits > 0); // and there were hits to see
//! let report = satisfice::Search::with(satisfice::engine::BranchAndBound::default())
//!     .run(&problem, &satisfice::Budget::evaluations(10_000))?;
//! assert_eq!((report.hit_count(), report.completeness), (15, satisfice::Completeness::Proved));
//! # Ok::<(), satisfice::Error>(())
//! ```

use crate::space::Region;

/// The inverse of [`decode`](crate::SatisficingProblem::decode): at which values a solution is.
///
/// Warm starts, neighbourhoods and estimates of unseen hits use it.
pub trait Encoding<S, T> {
    /// Writes values that decode to `solution`, one per axis; `false`, with any values, if there are none.
    fn encode(&self, solution: &T, values: &mut [S]) -> bool;

    /// Whether every point of `region` decodes to a solution that is the same as `hit`; `false`, the default, if not or if
    /// unknown. With it, and with [`Bounds`], a search of continuous axes can prove that no hit is missing. For solutions
    /// [`Located`](crate::Located) at the values themselves: [`Located::covers`](crate::Located::covers).
    fn covers(&self, _hit: &T, _region: &Region<S>) -> bool {
        false
    }
}

/// The solutions next to a solution, which engines look at once it is good. Needs an [`Encoding`].
///
/// For a problem without one, engines use the next lattice points on integer axes, the other categories, swaps of near places of a
/// permutation, and shrinking steps on continuous axes. Name neighbours where such a step spoils a good solution. For a closure:
/// [`FnProblem::neighbours`](crate::problem::FnProblem::neighbours).
///
/// Neighbours have indices, so that an engine can take a few of them, or one at random, however many there are. A solution
/// of a million neighbours costs no more than one of ten as long as they are not all examined.
pub trait Neighbourhood<T> {
    /// The number of indices; neighbours are at `0..count`. It may be more than there are neighbours: indices may be empty.
    fn count(&self, of: &T) -> usize;

    /// The neighbour at an index; `None` if there is none, which is common at the borders of a space, and for an index from
    /// `count` on. Always the same for the same solution and index.
    fn neighbour(&self, of: &T, index: usize) -> Option<T>;

    /// Writes the neighbour at an index over another solution; `false`, with any solution, if there is none. To be written for solutions
    /// that hold memory, which is then reused: an engine may look at dozens of neighbours for each evaluation.
    fn neighbour_into(&self, of: &T, index: usize, neighbour: &mut T) -> bool {
        self.neighbour(of, index).is_some_and(|found| {
            *neighbour = found;
            true
        })
    }
}

/// Lower bounds of the fitness, by which engines exclude regions and prove that no hit is missing.
///
/// ```
/// use satisfice::{Bounds, Budget, Located, Region, SatisficingProblem, Search, Space};
///
/// /// Where |x - 2| + |y - 1| is below 0.01.
/// struct Near(Space<f64>);
///
/// impl SatisficingProblem for Near {
///     type Scalar = f64;
///     type Solution = Located<f64>;
///     fn space(&self) -> &Space<f64> {
///         &self.0
///     }
///     fn decode(&self, values: &[f64]) -> Located<f64> {
///         Located::new(values, 0.02)
///     }
///     fn fitness(&self, at: &Located<f64>) -> f64 {
///         (at.coordinates[0] - 2.0).abs() + (at.coordinates[1] - 1.0).abs()
///     }
///     fn threshold(&self) -> f64 {
///         0.01
///     }
///     fn bounds(&self) -> Option<&dyn Bounds<f64>> {
///         Some(self)
///     }
/// }
///
/// impl Bounds<f64> for Near {
///     fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
///         // The distance of the region from the centre, axis by axis; halved, so that no rounding makes it too high.
///         let apart = |axis: usize, centre: f64| (region.lower[axis] - centre).max(centre - region.upper[axis]).max(0.0);
///         Some((apart(0, 2.0) + apart(1, 1.0)) / 2.0)
///     }
/// }
///
/// let report = Search::new().run(&Near(Space::cube(2, -5.0, 5.0)?), &Budget::evaluations(5_000))?;
/// assert!(report.hit_count() >= 1);
/// # Ok::<(), satisfice::Error>(())
/// ```
pub trait Bounds<S> {
    /// A value that F equals or exceeds at every point of `region`; `None` if no bound is known there. It must be sound: a
    /// bound that is too high loses hits. Every bound returned uses up the budget like an evaluation. Before a report says `Proved`, a few more
    /// are asked for, uncounted, at points that were evaluated: one above their F makes it `Unknown`.
    fn lower_bound(&self, region: &Region<S>) -> Option<S>;
}

/// The components of F: quantities all of which are near 0 at a hit, such as the residuals of equations, the errors of a design, or how far
/// a tool is from its goal along each axis. F, their norm or largest magnitude, has kinks and valleys; the components are
/// smooth. An engine that models each of them learns far more than from F alone: with isolated roots it needs a fraction
/// of the evaluations.
///
/// ```
/// use satisfice::{Budget, Components, Located, SatisficingProblem, Search, Space, engine::Surrogate};
///
/// /// Where a circle and a parabola cross.
/// struct Crossings(Space<f64>);
///
/// impl Crossings {
///     fn residuals(x: &[f64]) -> [f64; 2] {
///         [x[0] * x[0] + x[1] * x[1] - 1.0, x[0] * x[0] - x[1] - 0.5]
///     }
/// }
///
/// impl SatisficingProblem for Crossings {
///     type Scalar = f64;
///     type Solution = Located<f64>;
///     fn space(&self) -> &Space<f64> { &self.0 }
///     fn decode(&self, values: &[f64]) -> Located<f64> { Located::new(values, 0.05) }
///     fn fitness(&self, at: &Located<f64>) -> f64 {
///         let [a, b] = Self::residuals(&at.coordinates);
///         a.abs().max(b.abs())
///     }
///     fn threshold(&self) -> f64 { 1e-3 }
///     fn components(&self) -> Option<&dyn Components<f64, Located<f64>>> { Some(self) }
/// }
///
/// impl Components<f64, Located<f64>> for Crossings {
///     fn count(&self) -> usize { 2 }
///     fn write(&self, at: &Located<f64>, components: &mut [f64]) {
///         components.copy_from_slice(&Self::residuals(&at.coordinates).map(|residual| residual / 1e-3));
///     }
/// }
///
/// let crossings = Crossings(Space::cube(2, -2.0, 2.0)?);
/// assert_eq!(satisfice::testing::problem::check(&crossings, 1), []);
/// let report = Search::with(Surrogate::default()).run(&crossings, &Budget::evaluations(40))?;
/// assert_eq!(report.hit_count(), 2);
/// # Ok::<(), satisfice::Error>(())
/// ```
pub trait Components<S, T> {
    /// Number of components: at least 1, and the same for all solutions.
    fn count(&self) -> usize;

    /// Writes the components of a solution, each divided by its limit: at every hit all magnitudes are at most 1, NaN where there is no such
    /// number. If F is the largest magnitude or a norm, the limits are delta; if it is a sum of squares, its root.
    ///
    /// An engine that models components asks for those of every point it is told, once, beside the fitness. Where both need the same costly
    /// work, let the problem keep its last result.
    fn write(&self, solution: &T, components: &mut [S]);
}

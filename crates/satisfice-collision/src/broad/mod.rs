//! Broad phases: which features can be within a threshold at all, and the exact pairs of points.

mod boxes;
mod cells;
mod clip;
mod closest;
mod directions;
mod exact;
mod features;
mod frame;
mod gaps;
mod join;
mod occupancy;
mod overlap;
mod pair;
mod pair_query;
mod points;
mod ray;
mod relative;
mod robust;
mod separating_axis;
mod sorting;
mod traverse;
mod trees;
mod watch;

#[cfg(test)]
mod tests;

pub(crate) use boxes::{Box32, Dirty, fold, order_by_median};
pub(crate) use clip::{BlockBounds, greater, inflate, intersection, lesser};
pub use closest::closest_pairs;
pub(crate) use closest::{Closest, find_closest};
pub use features::{FeatureTree, Refit};
pub(crate) use frame::{exponent, power_of_two};
pub use pair::Pair;
pub use pair_query::Keep;
pub(crate) use pair_query::PairQuery;
pub use points::{PointGrid, PointWork};
pub(crate) use ray::{FirstHit, Slabs, near_segment};
pub(crate) use robust::Core;
pub use traverse::TreeWork;
pub(crate) use traverse::Visit;
pub use trees::TreeJoin;
pub(crate) use watch::{Stop, Watch};

/// How pairs are enumerated. No method changes an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// The cheapest by a measured cost model.
    #[default]
    Auto,
    /// Every pair is decided.
    BruteForce,
    /// A uniform grid, new each frame; vertices only, other features use the tree.
    Grid,
    /// A box tree, kept and refitted.
    Tree,
}

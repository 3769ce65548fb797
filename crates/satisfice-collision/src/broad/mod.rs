//! Broad phases: which features can be within a threshold at all, and the exact pairs of points.

mod boxes;
mod cells;
mod clip;
mod couple;
mod exact;
mod features;
mod frame;
mod groups;
mod join;
mod overlap;
mod pair;
mod points;
mod relative;
mod separate;
mod sieve;
mod sorting;
mod traverse;
mod trees;
mod watch;

#[cfg(test)]
mod tests;

pub(crate) use boxes::{Box32, Moved, order_by_median};
pub(crate) use clip::{Runs, inflate, intersection};
pub(crate) use couple::Couple;
pub use couple::Keep;
pub use features::{FeatureTree, Refit};
pub(crate) use frame::{exponent, power_of_two};
pub use pair::Pair;
pub use points::{PointGrid, PointWork};
pub(crate) use traverse::Visit;
pub use trees::{TreeJoin, TreeWork};
pub(crate) use watch::Watch;

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

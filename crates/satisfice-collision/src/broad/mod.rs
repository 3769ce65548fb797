//! Broad phases: which features can be within a threshold at all, and the exact pairs of points.

mod boxes;
mod cells;
mod clip;
mod exact;
mod features;
mod frame;
mod join;
mod lanes;
mod order;
mod overlap;
mod points;
mod relative;
mod sieve;
mod traverse;
mod trees;

#[cfg(test)]
mod tests;

pub use features::{FeatureKind, FeatureTree};
pub use order::Pair;
pub use points::{PointGrid, PointWork};
pub use trees::{Keep, TreeJoin, TreeWork};

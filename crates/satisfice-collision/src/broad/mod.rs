//! Broad phases: which features can be within a threshold at all, and the exact pairs of points.

mod cells;
mod clip;
mod exact;
mod frame;
mod join;
mod lanes;
mod order;
mod overlap;
mod points;
mod sieve;

#[cfg(test)]
mod tests;

pub use order::Pair;
pub use points::{PointGrid, PointWork};

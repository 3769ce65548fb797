//! Collision as a satisficing problem; the only part of this crate that knows the search framework.

mod feature_pairs;
mod feature_side;
mod metric;
mod pleats;
mod ranges;
mod side;
mod teapots;
mod vertex_pairs;

pub use feature_pairs::FeaturePairs;
pub use pleats::Pleats;
pub use teapots::Teapots;
pub use vertex_pairs::VertexPairs;

#[cfg(test)]
mod feature_tests;
#[cfg(test)]
mod tests;

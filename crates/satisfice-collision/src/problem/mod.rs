//! Collision as a satisficing problem. No other part of this crate depends on the search framework.

mod feature_pairs;
mod metric;
mod ordered_features;
mod pleats;
mod ranges;
mod recipe;
mod side;
mod teapots;
mod vertex_pairs;

pub use feature_pairs::FeaturePairs;
pub use ordered_features::OrderedFeatures;
pub use pleats::{PleatedCloth, Pleats};
pub use recipe::{Prepared, Recipe};
pub use teapots::{Teapots, TwoTeapots};
pub use vertex_pairs::VertexPairs;

#[cfg(test)]
mod feature_tests;
#[cfg(test)]
mod tests;

//! Collision as a satisficing problem; the only part of this crate that knows the search framework.

mod side;
mod teapots;
mod vertex_pairs;

pub use teapots::Teapots;
pub use vertex_pairs::VertexPairs;

#[cfg(test)]
mod tests;

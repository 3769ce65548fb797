#![doc = include_str!("../README.md")]

pub mod broad;
pub mod continuous;
pub mod distance;
mod error;
pub mod generate;
pub mod io;
pub mod mesh;
pub mod oracle;
pub mod order;
mod placement;
pub mod problem;
pub mod sampling;
pub mod scene;
mod simd;
pub mod solid;

pub use error::{Element, Error};
pub use mesh::{Aabb, Adjacency, FeatureKind, Mesh, Shape};
pub use order::VertexOrder;
pub(crate) use placement::CompactPlacement;
pub use placement::Placement;
pub use problem::{FeaturePairs, VertexPairs};

//! Exact proximity of feature pairs: vertices, edges and triangles as points, segments and triangles of `[f64; 3]`.
//!
//! There are two questions. Both treat each coordinate and delta as the rational number that it is:
//!
//! * **Decision** `distance < delta`: correct for every finite input. Three stages each answer only what they prove: a
//!   floating-point filter (`frame`), the same certificates in double-double arithmetic (`extended`), and integers of any
//!   size (`exact`). [`DecidedBy`] names the stage that answered.
//! * **Proximity**: the distance, the closest points and the features on which they lie. The distance is always within one
//!   unit in the last place of the true one. It is exactly 0 if and only if the features meet, or the true distance is below
//!   half the smallest denormal.
//!
//! [`within`], [`decide`], [`proximity`] and [`measure()`] take features of any kind as a [`Shape`](crate::Shape); a module per
//! kind of pair has the same functions for one kind. [`TriangleBatch`] decides many triangle pairs faster, with the same
//! answers.
//!
//! A triangle with collinear or coincident vertices counts as the segment or the point that it is geometrically; the same
//! holds for edges. There is no absolute epsilon.
//!
//! ```
//! use satisfice_collision::distance::{triangle_triangle, Threshold};
//! let floor = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
//! let above = floor.map(|[x, y, _]| [x, y, 0.25]);
//! assert!(!triangle_triangle::within(&floor, &above, Threshold::new(0.25)?));
//! assert!(triangle_triangle::within(&floor, &above, Threshold::new(0.25_f64.next_up())?));
//! assert_eq!(triangle_triangle::proximity(&floor, &above).distance, 0.25);
//! # Ok::<(), satisfice_collision::Error>(())
//! ```

mod batch;
mod candidates;
mod closest;
mod dispatch;
pub mod edge_edge;
pub mod edge_triangle;
pub(crate) mod exact;
mod extended;
pub(crate) mod first_point;
mod frame;
mod gjk;
mod kernel;
mod kind;
mod measure;
pub(crate) mod orientation;
mod precision;
mod resolve;
mod threshold;
pub mod triangle_triangle;
pub(crate) mod vector;
pub mod vertex_edge;
pub mod vertex_triangle;
pub mod vertex_vertex;

pub use batch::TriangleBatch;
pub(crate) use batch::{EdgeBatch, VertexBatch};
pub use dispatch::{decide, distance, measure, proximity, within};
pub use edge_edge::EdgeEdge;
pub use edge_triangle::EdgeTriangle;
pub use kind::{FeaturePair, PairKind};
pub use measure::ACCURACY;
pub use threshold::Threshold;
pub use triangle_triangle::TriangleTriangle;
pub use vertex_edge::VertexEdge;
pub use vertex_triangle::VertexTriangle;
pub use vertex_vertex::VertexVertex;

pub use crate::mesh::{Point, Segment, Triangle};

/// The stage that proved an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum DecidedBy {
    /// Double precision with a proved error bound.
    Filter,
    /// Double-double precision with a proved error bound.
    Extended,
    /// Integer arithmetic without rounding.
    Exact,
    /// A coordinate is NaN or infinite. The pair is then not within the threshold, and its distance is NaN.
    NotFinite,
}

/// Whether a pair is within the threshold, and the stage that proved it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Decision {
    /// `distance < delta`.
    pub within: bool,
    /// The stage that proved it.
    pub by: DecidedBy,
}

/// The part of a vertex, edge or triangle in whose relative interior a closest point lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Feature {
    /// The vertex with this number.
    Vertex(u8),
    /// The edge from the vertex with this number to the next one, cyclically.
    Edge(u8),
    /// The interior of the triangle.
    Face,
}

/// Distance and closest points of a feature pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proximity {
    /// The distance, within one unit in the last place; NaN if a coordinate is not finite; infinite if it exceeds
    /// `f64::MAX`.
    pub distance: f64,
    /// A closest point of the first feature, rounded; any one of them if there are several.
    pub point_a: Point,
    /// A closest point of the second feature, rounded.
    pub point_b: Point,
    /// Barycentric weights of `point_a`; entries beyond the feature's vertices are 0.
    pub weights_a: [f64; 3],
    /// Barycentric weights of `point_b`.
    pub weights_b: [f64; 3],
    /// The part of the first feature on which `point_a` lies.
    pub feature_a: Feature,
    /// The part of the second feature on which `point_b` lies.
    pub feature_b: Feature,
    /// The stage that proved `distance`.
    pub by: DecidedBy,
}

impl Proximity {
    /// The proximity of the pair in the other order.
    #[must_use]
    pub fn swapped(self) -> Self {
        Self {
            point_a: self.point_b,
            point_b: self.point_a,
            weights_a: self.weights_b,
            weights_b: self.weights_a,
            feature_a: self.feature_b,
            feature_b: self.feature_a,
            ..self
        }
    }
}

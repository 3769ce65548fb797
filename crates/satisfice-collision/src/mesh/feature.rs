//! Which features a body has: the kinds (vertex, edge, triangle), the corners of each, and its shape in space.
//!
//! Everything that depends on the kind alone stands here. A new kind is a variant of [`FeatureKind`], [`Shape`] and
//! [`Features`] in this file, its distances in `distance/`, and their line in `distance/dispatch.rs`.

use super::{Aabb, Mesh, Topology};

/// A point, in the unit of the mesh.
pub type Point = [f64; 3];
/// A segment by its two ends; equal ends make it a point.
pub type Segment = [Point; 2];
/// A triangle by its three corners, in any order.
pub type Triangle = [Point; 3];

/// A kind of feature of a body.
///
/// ```
/// use satisfice_collision::{FeatureKind, generate};
/// let ball = generate::icosphere(1.0, 0)?;
/// assert_eq!(FeatureKind::ALL.map(|kind| kind.count(&ball)), [12, 30, 20]);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum FeatureKind {
    /// Vertices, by their number.
    Vertex,
    /// Unique edges, in the order of [`Mesh::edges`].
    Edge,
    /// Triangles, in the order of [`Mesh::triangles`].
    Triangle,
}

impl FeatureKind {
    /// Every kind, from the fewest corners to the most.
    pub const ALL: [Self; 3] = [Self::Vertex, Self::Edge, Self::Triangle];

    /// The number of corners: 1, 2 or 3.
    #[must_use]
    pub const fn corners(self) -> usize {
        match self {
            Self::Vertex => 1,
            Self::Edge => 2,
            Self::Triangle => 3,
        }
    }

    /// The name of one feature: `vertex`, `edge` or `triangle`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Vertex => "vertex",
            Self::Edge => "edge",
            Self::Triangle => "triangle",
        }
    }

    /// The name of several features: `vertices`, `edges` or `triangles`.
    #[must_use]
    pub const fn plural(self) -> &'static str {
        match self {
            Self::Vertex => "vertices",
            Self::Edge => "edges",
            Self::Triangle => "triangles",
        }
    }

    /// The number of features of this kind in `mesh`.
    #[must_use]
    pub fn count(self, mesh: &Mesh) -> usize {
        mesh.features(self).len()
    }
}

impl std::fmt::Display for FeatureKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// A feature by the coordinates of its corners.
///
/// ```
/// use satisfice_collision::{FeatureKind, Shape};
/// let edge = Shape::Edge([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
/// assert_eq!(edge.kind(), FeatureKind::Edge);
/// assert_eq!(edge.middle(), [1.0, 0.0, 0.0]);
/// assert_eq!(edge.map(|[x, y, z]| [x, y, z + 1.0]).corners()[1], [2.0, 0.0, 1.0]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A vertex.
    Vertex(Point),
    /// An edge.
    Edge(Segment),
    /// A triangle.
    Triangle(Triangle),
}

impl Shape {
    /// The feature of this kind whose corner `k` is at `corner(k)`.
    #[inline(always)]
    pub fn new(kind: FeatureKind, corner: impl Fn(usize) -> Point) -> Self {
        match kind {
            FeatureKind::Vertex => Self::Vertex(corner(0)),
            FeatureKind::Edge => Self::Edge([corner(0), corner(1)]),
            FeatureKind::Triangle => Self::Triangle([corner(0), corner(1), corner(2)]),
        }
    }

    /// The kind of the feature.
    #[inline]
    #[must_use]
    pub const fn kind(&self) -> FeatureKind {
        match self {
            Self::Vertex(_) => FeatureKind::Vertex,
            Self::Edge(_) => FeatureKind::Edge,
            Self::Triangle(_) => FeatureKind::Triangle,
        }
    }

    /// The corners: 1, 2 or 3 points.
    #[inline]
    #[must_use]
    pub const fn corners(&self) -> &[Point] {
        match self {
            Self::Vertex(point) => std::slice::from_ref(point),
            Self::Edge(ends) => ends,
            Self::Triangle(corners) => corners,
        }
    }

    /// The feature with each corner moved by `f`.
    #[inline(always)]
    #[must_use]
    pub fn map(&self, f: impl Fn(Point) -> Point) -> Self {
        match *self {
            Self::Vertex(point) => Self::Vertex(f(point)),
            Self::Edge(ends) => Self::Edge(ends.map(f)),
            Self::Triangle(corners) => Self::Triangle(corners.map(f)),
        }
    }

    /// The mean of the corners, rounded.
    #[must_use]
    pub fn middle(&self) -> Point {
        let corners = self.corners();
        let count = corners.len() as f64;
        let first = corners[0].map(|c| c / count);
        corners[1..].iter().fold(first, |sum, corner| {
            std::array::from_fn(|k| sum[k] + corner[k] / count)
        })
    }

    /// The bounding box.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let corners = self.corners();
        let mut bounds = Aabb::point(corners[0]);
        for &corner in &corners[1..] {
            bounds.include(corner);
        }
        bounds
    }
}

/// The features of one kind of a body by the numbers of their corners; see [`Mesh::features`].
#[derive(Debug, Clone, Copy)]
pub enum Features<'a> {
    /// So many vertices.
    Vertices(usize),
    /// Unique edges.
    Edges(&'a [[u32; 2]]),
    /// Triangles.
    Triangles(&'a [[u32; 3]]),
}

impl<'a> Features<'a> {
    pub(super) fn new(topology: &'a Topology, kind: FeatureKind, vertices: usize) -> Self {
        match kind {
            FeatureKind::Vertex => Self::Vertices(vertices),
            FeatureKind::Edge => Self::Edges(topology.edges(vertices)),
            FeatureKind::Triangle => Self::Triangles(&topology.triangles),
        }
    }

    /// The kind of all of them.
    #[inline]
    #[must_use]
    pub const fn kind(self) -> FeatureKind {
        match self {
            Self::Vertices(_) => FeatureKind::Vertex,
            Self::Edges(_) => FeatureKind::Edge,
            Self::Triangles(_) => FeatureKind::Triangle,
        }
    }

    /// How many there are.
    #[inline]
    #[must_use]
    pub const fn len(self) -> usize {
        match self {
            Self::Vertices(count) => count,
            Self::Edges(edges) => edges.len(),
            Self::Triangles(triangles) => triangles.len(),
        }
    }

    /// Whether the body has no such feature.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// The vertex numbers of the corners, the last one repeated to make three.
    ///
    /// # Panics
    /// If there is no such edge or triangle.
    #[inline(always)]
    #[must_use]
    pub const fn corners(self, feature: u32) -> [u32; 3] {
        match self {
            Self::Vertices(_) => [feature; 3],
            Self::Edges(edges) => {
                let [a, b] = edges[feature as usize];
                [a, b, b]
            }
            Self::Triangles(triangles) => triangles[feature as usize],
        }
    }

    /// The feature with vertex `v` at `at(v)`.
    ///
    /// # Panics
    /// If there is no such edge or triangle.
    #[inline(always)]
    pub fn shape(self, feature: u32, at: impl Fn(u32) -> Point) -> Shape {
        match self {
            Self::Vertices(_) => Shape::Vertex(at(feature)),
            Self::Edges(edges) => Shape::Edge(edges[feature as usize].map(at)),
            Self::Triangles(triangles) => Shape::Triangle(triangles[feature as usize].map(at)),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::generate;

    #[test]
    fn corners_and_shapes_agree_for_every_feature_of_every_kind() {
        let mesh = generate::icosphere(1.0, 1).unwrap();
        for kind in FeatureKind::ALL {
            let features = mesh.features(kind);
            assert_eq!((features.kind(), features.len()), (kind, kind.count(&mesh)));
            for feature in 0..features.len() as u32 {
                let corners = features.corners(feature).map(|v| mesh.vertex(v));
                let shape = features.shape(feature, |v| mesh.vertex(v));
                assert_eq!(shape, Shape::new(kind, |k| corners[k]));
                assert_eq!((shape.kind(), shape.corners().len()), (kind, kind.corners()));
                assert_eq!(shape.corners(), &corners[..kind.corners()]);
                assert_eq!(Some(shape.bounds()), Aabb::of_points(corners));
                assert!(shape.bounds().contains(shape.middle()) || kind != FeatureKind::Vertex);
            }
        }
    }

    #[test]
    fn names_in_both_numbers() {
        assert_eq!(
            FeatureKind::ALL.map(FeatureKind::name),
            ["vertex", "edge", "triangle"]
        );
        assert_eq!(
            FeatureKind::ALL.map(FeatureKind::plural),
            ["vertices", "edges", "triangles"]
        );
    }
}

//! One body of a feature-pair problem: its features, and which of them stands at which position.

use super::ranges::Ranges;
use super::side::spacing;
use crate::broad::FeatureKind;
use crate::distance::measure::Shape;
use crate::error::Error;
use crate::mesh::{Aabb, Adjacency, Mesh};
use crate::order::VertexOrder;

/// The features of one kind of a body, in an order in which near features are near.
#[derive(Debug, Clone)]
pub(super) struct FeatureSide {
    pub(super) mesh: Mesh,
    pub(super) kind: FeatureKind,
    pub(super) order: VertexOrder,
    /// Position to feature.
    feature_at: Vec<u32>,
    /// Feature to position.
    position_of: Vec<u32>,
    /// Features that share a vertex; of vertices, those that share an edge.
    pub(super) neighbours: Adjacency,
    /// The nearest of them: triangles that share an edge, edges of one triangle, all of a vertex.
    pub(super) close: Adjacency,
    ranges: Ranges,
}

impl FeatureSide {
    pub(super) fn new(mesh: &Mesh, kind: FeatureKind, order: VertexOrder) -> Result<Self, Error> {
        let vertices = mesh.vertices().len();
        let neighbours = match kind {
            FeatureKind::Vertex => mesh.adjacency().clone(),
            FeatureKind::Edge => Adjacency::sharing(vertices, mesh.edges()),
            FeatureKind::Triangle => Adjacency::sharing(vertices, mesh.triangles()),
        };
        let close = match kind {
            FeatureKind::Vertex => neighbours.clone(),
            FeatureKind::Edge => neighbours.filtered(|e, f| {
                let [e, f] = [e, f].map(|edge| mesh.edges()[edge as usize]);
                e.iter().any(|&v| {
                    f.iter().any(|&w| {
                        mesh.adjacency().contains(v, w)
                            && ![v, w].iter().any(|u| e.contains(u) && f.contains(u))
                    })
                })
            }),
            FeatureKind::Triangle => neighbours.filtered(|t, s| {
                let [t, s] = [t, s].map(|triangle| mesh.triangles()[triangle as usize]);
                t.iter().filter(|v| s.contains(v)).count() > 1
            }),
        };
        let count = count(mesh, kind);
        if count == 0 {
            return Err(match kind {
                FeatureKind::Triangle => Error::parameter(
                    "number of triangles",
                    0,
                    "at least one in a body that is asked for triangles",
                ),
                _ => Error::parameter(
                    "number of edges",
                    0,
                    "at least one in a body that is asked for edges",
                ),
            });
        }
        let mut side = Self {
            mesh: mesh.clone(),
            kind,
            order,
            feature_at: (0..count as u32).collect(),
            position_of: (0..count as u32).collect(),
            neighbours,
            close,
            ranges: Ranges::new(1, |_| Aabb::point([0.0; 3])),
        };
        let middles: Vec<[f64; 3]> = (0..count as u32).map(|feature| side.middle(feature)).collect();
        side.feature_at = order.permutation(&middles);
        for (position, &feature) in (0..).zip(&side.feature_at) {
            side.position_of[feature as usize] = position;
        }
        side.measure();
        Ok(side)
    }

    /// The body has moved or changed its shape.
    pub(super) fn go_to(&mut self, mesh: &Mesh) -> Result<(), Error> {
        let alike = mesh.vertices().len() == self.mesh.vertices().len()
            && (mesh.same_body(&self.mesh)
                || (mesh.edges() == self.mesh.edges() && mesh.triangles() == self.mesh.triangles()));
        if !alike {
            return Err(Error::parameter(
                "mesh",
                format!(
                    "{} vertices, {} triangles",
                    mesh.vertices().len(),
                    mesh.triangles().len()
                ),
                "the same edges and triangles as in the frame before",
            ));
        }
        self.mesh = mesh.clone();
        self.measure();
        Ok(())
    }

    fn measure(&mut self) {
        self.ranges = Ranges::new(self.len(), |position| self.bounds(position));
    }

    /// How many features there are.
    pub(super) fn len(&self) -> usize {
        self.feature_at.len()
    }

    /// The vertices of a feature, the last repeated to make three; the feature exists.
    #[inline]
    pub(super) fn corners(&self, feature: u32) -> [u32; 3] {
        match self.kind {
            FeatureKind::Vertex => [feature; 3],
            FeatureKind::Edge => {
                let [a, b] = self.mesh.edges()[feature as usize];
                [a, b, b]
            }
            FeatureKind::Triangle => self.mesh.triangles()[feature as usize],
        }
    }

    /// Where a feature is; it exists.
    #[inline]
    pub(super) fn shape(&self, feature: u32) -> Shape {
        let at = |v: u32| self.mesh.vertices()[v as usize];
        match self.kind {
            FeatureKind::Vertex => Shape::Vertex(at(feature)),
            FeatureKind::Edge => Shape::Edge(self.mesh.edges()[feature as usize].map(at)),
            FeatureKind::Triangle => Shape::Triangle(self.mesh.triangles()[feature as usize].map(at)),
        }
    }

    fn middle(&self, feature: u32) -> [f64; 3] {
        let [a, b, c] = match self.kind {
            // An edge repeats its end, which would pull the middle.
            FeatureKind::Edge => {
                let [a, b] = self.mesh.edges()[feature as usize].map(|v| self.mesh.vertex(v));
                return std::array::from_fn(|k| a[k] / 2.0 + b[k] / 2.0);
            }
            _ => self.corners(feature).map(|v| self.mesh.vertex(v)),
        };
        std::array::from_fn(|k| a[k] / 3.0 + b[k] / 3.0 + c[k] / 3.0)
    }

    /// The box of the feature at a position.
    fn bounds(&self, position: usize) -> Aabb {
        let [a, b, c] = self
            .corners(self.feature_at[position])
            .map(|v| self.mesh.vertex(v));
        let mut bounds = Aabb::point(a);
        bounds.include(b);
        bounds.include(c);
        bounds
    }

    /// The box around the features at the positions from `first` to `last`, as they stand on an axis.
    pub(super) fn around(&self, first: f64, last: f64) -> Aabb {
        let end = self.len() - 1;
        let first = (first as usize).min(end);
        let last = (last as usize).clamp(first, end);
        self.ranges.around(first, last, |position| self.bounds(position))
    }

    #[inline]
    pub(super) fn feature(&self, value: f64) -> u32 {
        // A float beyond the range saturates; the last position takes what is too large.
        self.feature_at[(value as usize).min(self.len() - 1)]
    }

    pub(super) fn position(&self, feature: u32) -> Option<f64> {
        self.position_of
            .get(feature as usize)
            .map(|&position| f64::from(position))
    }

    #[inline]
    pub(super) fn has(&self, feature: u32) -> bool {
        (feature as usize) < self.len()
    }

    /// The median length of the edges; infinite where it overflows, 0 without edges.
    pub(super) fn spacing(&self) -> f64 {
        spacing(&self.mesh)
    }
}

/// How many features of a kind a mesh has.
pub(super) fn count(mesh: &Mesh, kind: FeatureKind) -> usize {
    match kind {
        FeatureKind::Vertex => mesh.vertices().len(),
        FeatureKind::Edge => mesh.edges().len(),
        FeatureKind::Triangle => mesh.triangles().len(),
    }
}

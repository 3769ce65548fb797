//! One body of a pair problem: its features and their positions on an axis.

use super::metric::square;
use super::ranges::Ranges;
use crate::error::Error;
use crate::mesh::{Aabb, Adjacency, FeatureKind, Mesh, Shape};
use crate::order::VertexOrder;

/// A feature that was not chosen has no position.
const ABSENT: u32 = u32::MAX;

/// The features of one kind of a body, or a choice of its vertices, in an order that keeps close features close.
#[derive(Debug, Clone)]
pub(super) struct Side {
    pub(super) mesh: Mesh,
    pub(super) kind: FeatureKind,
    pub(super) order: VertexOrder,
    /// Position to feature.
    feature_at: Vec<u32>,
    /// Feature to position, [`ABSENT`] for one that was not chosen.
    position_of: Vec<u32>,
    /// Features that share a vertex; for vertices those that share an edge, across the gaps of vertices that were not chosen.
    pub(super) neighbours: Adjacency,
    /// The closest of them, if these are not all: triangles that share an edge, edges of one triangle.
    close: Option<Adjacency>,
    ranges: Ranges,
}

impl Side {
    pub(super) fn new(mesh: &Mesh, kind: FeatureKind, order: VertexOrder) -> Result<Self, Error> {
        let vertices = mesh.vertices().len();
        let neighbours = match kind {
            FeatureKind::Vertex => mesh.adjacency().clone(),
            FeatureKind::Edge => Adjacency::sharing(vertices, mesh.edges()),
            FeatureKind::Triangle => Adjacency::sharing(vertices, mesh.triangles()),
        };
        let close = match kind {
            FeatureKind::Vertex => None,
            FeatureKind::Edge => Some(neighbours.filtered(|e, f| {
                let [e, f] = [e, f].map(|edge| mesh.edges()[edge as usize]);
                e.iter().any(|&v| {
                    f.iter().any(|&w| {
                        mesh.adjacency().contains(v, w)
                            && ![v, w].iter().any(|u| e.contains(u) && f.contains(u))
                    })
                })
            })),
            FeatureKind::Triangle => Some(neighbours.filtered(|t, s| {
                let [t, s] = [t, s].map(|triangle| mesh.triangles()[triangle as usize]);
                t.iter().filter(|v| s.contains(v)).count() > 1
            })),
        };
        let count = kind.count(mesh);
        if count == 0 {
            return Err(Error::parameter(kind.plural(), 0, "at least one in each body"));
        }
        let mut side = Self {
            mesh: mesh.clone(),
            kind,
            order,
            feature_at: Vec::new(),
            position_of: vec![ABSENT; count],
            neighbours,
            close,
            ranges: Ranges::new(1, |_| Aabb::point([0.0; 3])),
        };
        side.arrange(order, &(0..count as u32).collect::<Vec<_>>());
        Ok(side)
    }

    /// Puts the chosen features, sorted by number, into an order.
    fn arrange(&mut self, order: VertexOrder, chosen: &[u32]) {
        let middles: Vec<[f64; 3]> = chosen
            .iter()
            .map(|&feature| self.shape(feature).middle())
            .collect();
        let places = order.permutation(&middles);
        self.order = order;
        self.feature_at = places.into_iter().map(|k| chosen[k as usize]).collect();
        self.position_of.fill(ABSENT);
        for (position, &feature) in (0..).zip(&self.feature_at) {
            self.position_of[feature as usize] = position;
        }
        self.measure();
    }

    /// The same features in another order.
    pub(super) fn reorder(&mut self, order: VertexOrder) {
        self.arrange(order, &self.chosen());
    }

    /// The features with a position, sorted by number.
    pub(super) fn chosen(&self) -> Vec<u32> {
        let mut chosen = self.feature_at.clone();
        chosen.sort_unstable();
        chosen
    }

    /// Replaces the chosen vertices.
    pub(super) fn choose(&mut self, vertices: &[u32]) -> Result<(), Error> {
        let mut chosen = vertices.to_vec();
        chosen.sort_unstable();
        chosen.dedup();
        let refused = |value, allowed| Err(Error::parameter("chosen vertices", value, allowed));
        match chosen.last() {
            None => return refused(0, "at least one vertex of each body"),
            Some(&last) if last as usize >= self.position_of.len() => {
                return refused(last, "vertex numbers below the number of vertices");
            }
            Some(_) => {}
        }
        self.arrange(self.order, &chosen);
        let position_of = &self.position_of;
        let stands = |v: u32| position_of[v as usize] != ABSENT;
        self.neighbours = self.mesh.adjacency().bridged(stands);
        Ok(())
    }

    /// The closest neighbours.
    pub(super) fn close(&self) -> &Adjacency {
        self.close.as_ref().unwrap_or(&self.neighbours)
    }

    /// Replaces the body by its next frame.
    pub(super) fn go_to(&mut self, mesh: &Mesh) -> Result<(), Error> {
        if mesh.vertices().len() != self.mesh.vertices().len() {
            return Err(Error::parameter(
                "number of vertices",
                mesh.vertices().len(),
                "as many as in the frame before",
            ));
        }
        let alike = self.kind == FeatureKind::Vertex
            || (mesh.same_body(&self.mesh)
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

    /// The number of features with a position.
    pub(super) fn len(&self) -> usize {
        self.feature_at.len()
    }

    /// The vertices of an existing feature, the last one repeated to make three.
    #[inline]
    pub(super) fn corners(&self, feature: u32) -> [u32; 3] {
        self.mesh.features(self.kind).corners(feature)
    }

    /// The shape of an existing feature.
    #[inline]
    pub(super) fn shape(&self, feature: u32) -> Shape {
        let vertices = self.mesh.vertices();
        self.mesh
            .features(self.kind)
            .shape(feature, |v| vertices[v as usize])
    }

    /// The box of the feature at a position.
    fn bounds(&self, position: usize) -> Aabb {
        self.shape(self.feature_at[position]).bounds()
    }

    /// The box around the features at the positions `first` to `last` of an axis.
    pub(super) fn around(&self, first: f64, last: f64) -> Aabb {
        let end = self.len() - 1;
        let first = (first as usize).min(end);
        let last = (last as usize).clamp(first, end);
        self.ranges.around(first, last, |position| self.bounds(position))
    }

    #[inline]
    pub(super) fn feature(&self, value: f64) -> u32 {
        // The conversion saturates; values that are too large become the last position.
        self.feature_at[(value as usize).min(self.len() - 1)]
    }

    pub(super) fn position(&self, feature: u32) -> Option<f64> {
        let position = self.position_of.get(feature as usize)?;
        (*position != ABSENT).then(|| f64::from(*position))
    }

    /// Whether the feature exists, chosen or not.
    #[inline]
    pub(super) fn has(&self, feature: u32) -> bool {
        (feature as usize) < self.position_of.len()
    }

    /// The position of a vertex, if it exists.
    #[inline]
    pub(super) fn point(&self, vertex: u32) -> Option<&[f64; 3]> {
        self.mesh.vertices().get(vertex as usize)
    }

    /// The median length of the edges; infinite on overflow, 0 without edges.
    pub(super) fn spacing(&self) -> f64 {
        let mut squares: Vec<f64> = self
            .mesh
            .edges()
            .iter()
            .map(|&[i, j]| square(&self.mesh.vertex(i), &self.mesh.vertex(j)))
            .collect();
        if squares.is_empty() {
            return 0.0;
        }
        let middle = squares.len() / 2;
        squares.select_nth_unstable_by(middle, f64::total_cmp).1.sqrt()
    }
}

//! Indexed meshes: vertices, explicit edges and triangles, and the edges and adjacency derived from them.

mod aabb;
mod adjacency;
mod edges;
mod feature;
mod finite;
mod weld;

use std::sync::{Arc, OnceLock};

pub use aabb::Aabb;
pub use adjacency::Adjacency;
pub use feature::{FeatureKind, Features, Point, Segment, Shape, Triangle};
pub(crate) use finite::{AXES, all_finite, finite};
pub use weld::weld;

use crate::error::{Element, Error};

/// A body: vertices, explicit edges (the lines of an OBJ file) and triangles, all by vertex number.
///
/// A body of vertices alone, or of vertices and edges alone, is valid; degenerate triangles and edges are allowed.
/// Every `Mesh` has been checked: each coordinate is finite, each index in range, and there is at least one vertex.
/// Posed copies of one body share their elements, so moving a mesh copies coordinates only. Edges and adjacency are
/// built when they are first asked for, once for all copies.
///
/// ```
/// use satisfice_collision::Mesh;
/// let square = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(square, vec![], vec![[0, 1, 2], [0, 2, 3]])?;
/// assert_eq!(mesh.edges(), [[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]]);
/// assert_eq!(mesh.adjacency().neighbours(1), [0, 2]);
/// assert_eq!(mesh.size(), 1.0);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Mesh {
    vertices: Vec<[f64; 3]>,
    topology: Arc<Topology>,
}

#[derive(Debug)]
pub(crate) struct Topology {
    lines: Vec<[u32; 2]>,
    triangles: Vec<[u32; 3]>,
    edges: OnceLock<Vec<[u32; 2]>>,
    adjacency: OnceLock<Adjacency>,
}

impl Mesh {
    /// Checks a body. `lines` are explicit edges; the sides of the triangles need not be among them.
    ///
    /// # Errors
    /// [`Error::EmptyMesh`], [`Error::TooManyVertices`], [`Error::NonFiniteVertex`] or [`Error::IndexOutOfRange`],
    /// naming the first offender.
    ///
    /// Cost: O(V + L + T).
    pub fn new(
        vertices: Vec<[f64; 3]>,
        lines: Vec<[u32; 2]>,
        triangles: Vec<[u32; 3]>,
    ) -> Result<Self, Error> {
        check_vertices(&vertices)?;
        check_indices(Element::Edge, &lines, vertices.len())?;
        check_indices(Element::Triangle, &triangles, vertices.len())?;
        let topology = Arc::new(Topology {
            lines,
            triangles,
            edges: OnceLock::new(),
            adjacency: OnceLock::new(),
        });
        Ok(Self { vertices, topology })
    }

    /// The same body with its vertices elsewhere, e.g. the next frame of a deforming cloth.
    ///
    /// # Errors
    /// [`Error::NonFiniteVertex`], or [`Error::Parameter`] if the number of vertices differs.
    pub fn with_vertices(&self, vertices: Vec<[f64; 3]>) -> Result<Self, Error> {
        if vertices.len() != self.vertices.len() {
            return Err(Error::parameter(
                "number of vertices",
                vertices.len(),
                "a frame has as many vertices as its body",
            ));
        }
        check_vertices(&vertices)?;
        Ok(Self {
            vertices,
            topology: Arc::clone(&self.topology),
        })
    }

    /// Positions by vertex number; never empty, all finite.
    #[must_use]
    pub fn vertices(&self) -> &[[f64; 3]] {
        &self.vertices
    }

    /// Position of vertex `v`.
    ///
    /// # Panics
    /// If `v` is not a vertex of this mesh.
    #[must_use]
    pub fn vertex(&self, v: u32) -> [f64; 3] {
        self.vertices[v as usize]
    }

    /// The explicit edges as they were given.
    #[must_use]
    pub fn lines(&self) -> &[[u32; 2]] {
        &self.topology.lines
    }

    /// The triangles as they were given; degenerate ones included.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.topology.triangles
    }

    /// Every undirected edge once: explicit edges and sides of triangles, each as `[low, high]` with `low < high`,
    /// sorted. An edge from a vertex to itself is left out. Built at the first call: O(V + E log(degree)).
    #[must_use]
    pub fn edges(&self) -> &[[u32; 2]] {
        self.topology.edges(self.vertices.len())
    }

    /// The features of one kind, by the numbers of their corners.
    ///
    /// ```
    /// use satisfice_collision::{FeatureKind, generate};
    /// let ball = generate::icosphere(1.0, 0)?;
    /// let edges = ball.features(FeatureKind::Edge);
    /// let [a, b, _] = edges.corners(7);
    /// assert_eq!([a, b], ball.edges()[7]);
    /// # Ok::<(), satisfice_collision::Error>(())
    /// ```
    #[inline]
    #[must_use]
    pub fn features(&self, kind: FeatureKind) -> Features<'_> {
        self.topology.features(kind, self.vertices.len())
    }

    /// What the poses and frames of one body share.
    pub(crate) fn topology(&self) -> &Arc<Topology> {
        &self.topology
    }

    /// Which vertices are joined by an edge. Built at the first call: O(V + E) beyond [`Mesh::edges`].
    #[must_use]
    pub fn adjacency(&self) -> &Adjacency {
        self.topology
            .adjacency
            .get_or_init(|| Adjacency::from_edges(self.vertices.len(), self.edges()))
    }

    /// The corners of triangle `t`.
    ///
    /// # Panics
    /// If `t` is not a triangle of this mesh.
    #[must_use]
    pub fn triangle(&self, t: usize) -> [[f64; 3]; 3] {
        self.topology.triangles[t].map(|v| self.vertices[v as usize])
    }

    /// The bounding box.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let mut bounds = Aabb::point(self.vertices[0]);
        for &vertex in &self.vertices[1..] {
            bounds.include(vertex);
        }
        bounds
    }

    /// The longest extent of the bounding box.
    #[must_use]
    pub fn size(&self) -> f64 {
        self.bounds().size()
    }

    /// Whether both are poses or frames of one body and so share edges and triangles without comparing them.
    #[must_use]
    pub fn same_body(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.topology, &other.topology)
    }
}

impl Topology {
    /// The edges of a body with so many vertices.
    #[inline]
    fn edges(&self, vertices: usize) -> &[[u32; 2]] {
        self.edges
            .get_or_init(|| edges::unique(vertices, &self.lines, &self.triangles))
    }

    /// The features of one kind of a body with so many vertices.
    #[inline]
    pub(crate) fn features(&self, kind: FeatureKind, vertices: usize) -> Features<'_> {
        Features::new(self, kind, vertices)
    }
}

impl PartialEq for Mesh {
    fn eq(&self, other: &Self) -> bool {
        let same_elements = || self.lines() == other.lines() && self.triangles() == other.triangles();
        self.vertices == other.vertices && (self.same_body(other) || same_elements())
    }
}

fn check_vertices(vertices: &[[f64; 3]]) -> Result<(), Error> {
    if vertices.is_empty() {
        return Err(Error::EmptyMesh);
    }
    if u32::try_from(vertices.len()).is_err() {
        return Err(Error::TooManyVertices {
            vertices: vertices.len(),
        });
    }
    all_finite(vertices.iter().copied())
}

fn check_indices<const N: usize>(
    element: Element,
    elements: &[[u32; N]],
    vertices: usize,
) -> Result<(), Error> {
    for (index, corners) in elements.iter().enumerate() {
        if let Some(&v) = corners.iter().find(|&&v| v as usize >= vertices) {
            return Err(Error::IndexOutOfRange {
                element,
                index,
                vertex: i64::from(v),
                vertices,
                first: 0,
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;

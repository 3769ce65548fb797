//! The vertices, edges or triangles of a body in a box tree that can be kept and refitted.

use std::sync::{Arc, OnceLock};

use super::boxes::{Box32, BoxTree};
use super::clip::BlockBounds;
use super::directions::{self, Directions};
use super::frame::LocalFrame;
use super::separating_axis::Triangles;
use super::traverse::LaneCorners;
use crate::mesh::{Features, Point, Shape, Topology, Triangle};
use crate::simd::{Lanes, Work, dispatch};
use crate::{Error, FeatureKind, Mesh};

/// A box tree over the features of one kind of one body, in the body's own coordinates.
///
/// ```
/// use satisfice_collision::{FeatureKind, broad::FeatureTree, generate};
/// let tree = FeatureTree::new(&generate::icosphere(1.0, 2)?, FeatureKind::Triangle);
/// assert_eq!(tree.len(), 320);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[derive(Debug)]
pub struct FeatureTree {
    kind: FeatureKind,
    topology: Arc<Topology>,
    vertices: Vec<Point>,
    runs: BlockBounds,
    pub(crate) frame: LocalFrame,
    boxes: Vec<Box32>,
    placed: Vec<[f32; 3]>,
    /// For triangles only.
    directions: Vec<Directions>,
    /// Whether each vertex moved at the last refit.
    moved: Vec<bool>,
    pub(crate) tree: BoxTree,
    /// The sum of sides when the tree was built, in the unit of the coordinates.
    built_sum_of_sides: f64,
    /// The vertices of the features in the order of the tree, if anybody has asked.
    corners_in_order: OnceLock<Vec<[u32; 8]>>,
    threads: usize,
}

/// A tree is rebuilt once its boxes have grown by this factor since it was built.
const DEGRADED: f64 = 1.5;

/// The result of a refit.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Refit {
    /// Vertices whose coordinates changed.
    pub moved: usize,
    /// No vertex moved further than this.
    pub motion: f64,
}

/// Vertices being moved, and their squared motion.
struct Move<'a> {
    moved: &'a mut [bool],
    old: &'a mut [Point],
    new: &'a [Point],
}

impl Work for Move<'_> {
    type Output = Refit;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> Refit {
        let Self { moved, old, new } = self;
        // four at a time, so that no maximum waits for the one before
        let (mut count, mut most) = (0, [0.0; 4]);
        let mut step = |lane: usize, moved: &mut bool, old: &mut Point, new: &Point| {
            let way = [new[0] - old[0], new[1] - old[1], new[2] - old[2]];
            *moved = (way[0] != 0.0) | (way[1] != 0.0) | (way[2] != 0.0);
            *old = *new;
            count += usize::from(*moved);
            let square = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
            most[lane] = if square > most[lane] { square } else { most[lane] };
        };
        let ((fours, rest), (old_fours, old_rest), (new_fours, new_rest)) = (
            moved.as_chunks_mut::<4>(),
            old.as_chunks_mut::<4>(),
            new.as_chunks::<4>(),
        );
        for ((moved, old), new) in fours.iter_mut().zip(old_fours).zip(new_fours) {
            for lane in 0..4 {
                step(lane, &mut moved[lane], &mut old[lane], &new[lane]);
            }
        }
        for ((moved, old), new) in rest.iter_mut().zip(old_rest).zip(new_rest) {
            step(0, moved, old, new);
        }
        Refit {
            moved: count,
            motion: most
                .iter()
                .fold(0.0, |most, &square| if square > most { square } else { most }),
        }
    }
}

impl FeatureTree {
    /// Builds the tree on one thread, on which it is refitted too. Cost: O(n log n).
    #[must_use]
    pub fn new(mesh: &Mesh, kind: FeatureKind) -> Self {
        Self::on_threads(mesh, kind, 1)
    }

    /// Builds the tree on the current rayon pool, on which it is refitted too. The result is the same.
    #[must_use]
    pub fn parallel(mesh: &Mesh, kind: FeatureKind) -> Self {
        Self::on_threads(mesh, kind, rayon::current_num_threads())
    }

    fn on_threads(mesh: &Mesh, kind: FeatureKind, threads: usize) -> Self {
        let bounds = mesh.bounds();
        let mut tree = Self {
            kind,
            topology: Arc::clone(mesh.topology()),
            vertices: mesh.vertices().to_vec(),
            runs: BlockBounds::default(),
            frame: LocalFrame::unit(&bounds, mesh.vertices()),
            boxes: Vec::new(),
            placed: Vec::new(),
            directions: Vec::new(),
            moved: vec![true; mesh.vertices().len()],
            tree: BoxTree::default(),
            built_sum_of_sides: 0.0,
            corners_in_order: OnceLock::new(),
            threads,
        };
        tree.measure(mesh.vertices());
        let points: Vec<Box32>;
        let boxes = if kind == FeatureKind::Vertex {
            let at = |vertex| tree.frame.held(tree.frame.place(vertex));
            points = tree
                .vertices
                .iter()
                .map(at)
                .map(|q| Box32 { min: q, max: q })
                .collect();
            &points
        } else {
            &tree.boxes
        };
        tree.tree = BoxTree::order(boxes, kind == FeatureKind::Vertex, threads);
        tree.fit(mesh.vertices());
        tree.built_sum_of_sides = tree.tree.sum_of_sides() / tree.frame.scale;
        tree
    }

    /// Whether the body has deformed so far since the tree was built that neighbours in it are no longer near each other.
    pub(crate) fn is_degraded(&self) -> bool {
        self.tree.sum_of_sides() / self.frame.scale > DEGRADED * self.built_sum_of_sides
    }

    /// Moves the vertices and recomputes the boxes; the tree keeps its shape. Cost: O(n), no allocation.
    ///
    /// # Errors
    /// [`Error::NonFiniteVertex`], or [`Error::Parameter`] if the number of vertices differs; the tree is then as before.
    pub fn refit(&mut self, vertices: &[Point]) -> Result<Refit, Error> {
        if vertices.len() != self.vertices.len() {
            return Err(Error::parameter(
                "number of vertices",
                vertices.len(),
                "a frame has as many vertices as its body",
            ));
        }
        self.runs.measure(vertices, 1)?;
        if let Some(bounds) = self.runs.whole() {
            self.frame = LocalFrame::unit(&bounds, vertices);
        }
        // first what reads them in the order of the tree, while they are in the cache
        self.measure(vertices);
        self.fit(vertices);
        let mut refit = dispatch(Move {
            moved: &mut self.moved,
            old: &mut self.vertices,
            new: vertices,
        });
        // rounded up; squares that underflow belong to motions below 1e-153
        refit.motion = if refit.moved == 0 {
            0.0
        } else {
            refit.motion.sqrt() * (1.0 + 1e-12) + 1e-153
        };
        let moved = &self.moved;
        let features = self.topology.features(self.kind, moved.len());
        if refit.moved == 0 || refit.moved == moved.len() {
            self.tree.mark_all(refit.moved > 0);
        } else {
            self.tree
                .mark(|feature| features.corners(feature).iter().any(|&v| moved[v as usize]));
        }
        Ok(refit)
    }

    /// Puts the features into the tree.
    fn fit(&mut self, vertices: &[Point]) {
        if self.kind == FeatureKind::Vertex {
            self.tree.refit_points(vertices, &self.frame, self.threads);
        } else {
            self.tree.refit(&self.boxes, self.threads);
        }
    }

    /// The boxes of edges or triangles.
    fn measure(&mut self, vertices: &[Point]) {
        let Self {
            frame,
            placed,
            boxes,
            directions,
            kind,
            topology,
            ..
        } = self;
        let features = topology.features(*kind, vertices.len());
        if matches!(features, Features::Vertices(_)) {
            return;
        }
        placed.clear();
        placed.extend(vertices.iter().map(|vertex| frame.place(vertex)));
        if frame.has_far {
            for place in &mut *placed {
                *place = frame.held(*place);
            }
        }
        let at = |v: u32| placed[v as usize];
        boxes.clear();
        directions.clear();
        match features {
            Features::Vertices(_) => {}
            Features::Edges(edges) => boxes.extend(edges.iter().map(|edge| Box32::around(edge.map(at)))),
            Features::Triangles(triangles) => {
                boxes.extend(triangles.iter().map(|triangle| Box32::around(triangle.map(at))));
                directions.extend(
                    triangles
                        .iter()
                        .map(|triangle| directions::of_triangle(triangle.map(at))),
                );
            }
        }
    }

    /// A radius around the frame's origin that holds every vertex.
    pub(crate) fn radius(&self) -> f64 {
        1.7321 * self.frame.farthest
    }

    /// The number of features.
    #[must_use]
    pub fn len(&self) -> usize {
        self.tree.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The kind of the features.
    #[must_use]
    pub fn kind(&self) -> FeatureKind {
        self.kind
    }

    /// The vertices at the last refit.
    #[must_use]
    pub fn vertices(&self) -> &[Point] {
        &self.vertices
    }

    #[inline]
    pub(crate) fn point(&self, v: u32) -> Point {
        self.vertices[v as usize]
    }

    #[inline]
    pub(crate) fn features(&self) -> Features<'_> {
        self.topology.features(self.kind, self.vertices.len())
    }

    /// The shape of a feature in the coordinates of the body.
    #[inline]
    pub(crate) fn shape(&self, feature: u32) -> Shape {
        self.features().shape(feature, |v| self.point(v))
    }

    /// The corners of triangle `t`; of a tree that is not about triangles, a point.
    #[inline]
    pub(crate) fn triangle(&self, t: u32) -> Triangle {
        match self.features() {
            Features::Triangles(triangles) => triangles[t as usize].map(|v| self.point(v)),
            _ => [self.point(t); 3],
        }
    }

    /// The vertices of a feature, the last repeated to make three.
    #[inline]
    pub(crate) fn corners(&self, feature: u32) -> [u32; 3] {
        self.features().corners(feature)
    }

    /// The vertices of the features in the order of the tree.
    pub(crate) fn corners_in_order(&self) -> LaneCorners<'_> {
        let each = match self.kind {
            FeatureKind::Vertex => 1,
            FeatureKind::Edge => 2,
            FeatureKind::Triangle => 3,
        };
        let lanes = self.corners_in_order.get_or_init(|| {
            let mut lanes = vec![[u32::MAX; 8]; self.len().div_ceil(8) * each];
            for (group, features) in lanes.chunks_exact_mut(each).zip(self.tree.order.chunks(8)) {
                for (lane, &feature) in features.iter().enumerate() {
                    for (corners, vertex) in group.iter_mut().zip(self.corners(feature)) {
                        corners[lane] = vertex;
                    }
                }
            }
            lanes
        });
        LaneCorners { lanes, each }
    }

    /// The triangles of a tree over triangles.
    pub(crate) fn triangles(&self) -> Option<Triangles<'_>> {
        match self.features() {
            Features::Triangles(corners) => Some(Triangles {
                corners,
                placed: &self.placed,
                directions: &self.directions,
            }),
            _ => None,
        }
    }

    /// Whether a feature moved at the last refit.
    #[inline]
    pub(crate) fn has_moved(&self, feature: u32) -> bool {
        self.corners(feature).iter().any(|&v| self.moved[v as usize])
    }
}

//! The bodies of a scene at the start and at the end of a step.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::boxes::BoxFrame;
use super::near_bodies::BodyBoxes;
use super::step_tree::{ListInMotion, StepTree};
use super::tree::MovingTree;
use super::{Moving, Separation};
use crate::distance::{PairKind, Point, Segment, Triangle};
use crate::mesh::all_finite;
use crate::{Error, Mesh};

/// Meshes that move from one frame to the next, every vertex along a straight line at constant speed.
///
/// ```
/// use satisfice_collision::continuous::{Separation, Step};
/// use satisfice_collision::distance::PairKind;
/// use satisfice_collision::{Placement, generate};
/// let sheet = generate::cloth(2.0, 2.0, 9, 9)?;
/// let above = Placement::from_translation([0.0, 0.0, 1.0])?.place(&generate::icosphere(0.1, 1)?)?;
/// let below = Placement::from_translation([0.0, 0.0, -2.0])?.place(&above)?;
/// let mut step = Step::new();
/// step.add_rigid(&above, below.vertices())?;
/// step.add_deforming(&sheet, sheet.vertices())?;
/// let hits = step.hits(PairKind::EdgeEdge, Separation::TOUCHING)?;
/// assert!(!hits.pairs.is_empty() && hits.undecided == 0);
/// let first = step.earliest(Separation::TOUCHING, 1e-6)?;
/// assert!(first.is_proved && first.time[0] <= 0.45 && 0.45 <= first.time[1] + 1e-6);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[derive(Debug, Default)]
pub struct Step {
    bodies: Vec<FirstFeatures>,
    pub(super) from: Vec<Point>,
    pub(super) to: Vec<Point>,
    pub(super) edges: Vec<[u32; 2]>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Whether any vertex belongs to no triangle.
    has_loose_vertices: bool,
    frame: OnceLock<(BoxFrame, BodyBoxes)>,
    /// By list.
    trees: [Mutex<StepTree>; 3],
}

/// Where the features of a body begin in the common lists.
#[derive(Debug, Clone, Copy)]
struct FirstFeatures {
    first: [u32; 3],
    collides_with_itself: bool,
}

/// A vertex, an edge or a triangle of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FeatureOf {
    /// The body, in the order of adding.
    pub body: u32,
    /// The feature in the order of its mesh.
    pub index: u32,
}

/// Two features that are tested against each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MovingContact {
    /// The first feature; the vertex of a vertex-triangle pair.
    pub a: FeatureOf,
    /// The second feature.
    pub b: FeatureOf,
}

/// Which list a feature is in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FeatureList {
    Vertices,
    Edges,
    Triangles,
}

impl Step {
    /// A step without bodies.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a body that also collides with itself, features that share a vertex excepted. Returns its number.
    ///
    /// # Errors
    /// [`Error::Parameter`] if `to` has another number of vertices than the mesh, [`Error::NonFiniteVertex`],
    /// [`Error::TooManyVertices`] if there are more than 2^32 features in all.
    pub fn add_deforming(&mut self, mesh: &Mesh, to: &[Point]) -> Result<usize, Error> {
        self.add(mesh, to, true)
    }

    /// Adds a body that collides with other bodies only. Returns its number.
    ///
    /// # Errors
    /// As [`add_deforming`](Self::add_deforming).
    pub fn add_rigid(&mut self, mesh: &Mesh, to: &[Point]) -> Result<usize, Error> {
        self.add(mesh, to, false)
    }

    fn add(&mut self, mesh: &Mesh, to: &[Point], collides_with_itself: bool) -> Result<usize, Error> {
        check("vertices at the end of the step", to, mesh.vertices().len())?;
        let all = self.from.len() + to.len();
        if u32::try_from(
            all.max(self.edges.len() + mesh.edges().len())
                .max(self.triangles.len() + mesh.triangles().len()),
        )
        .is_err()
        {
            return Err(Error::TooManyVertices { vertices: all });
        }
        let first = [
            self.from.len() as u32,
            self.edges.len() as u32,
            self.triangles.len() as u32,
        ];
        let offset = first[0];
        self.bodies.push(FirstFeatures {
            first,
            collides_with_itself,
        });
        self.from.extend_from_slice(mesh.vertices());
        self.to.extend_from_slice(to);
        self.edges
            .extend(mesh.edges().iter().map(|e| e.map(|v| v + offset)));
        self.triangles
            .extend(mesh.triangles().iter().map(|t| t.map(|v| v + offset)));
        let mut is_covered = vec![false; to.len()];
        for &v in mesh.triangles().iter().flatten() {
            is_covered[v as usize] = true;
        }
        self.has_loose_vertices |= is_covered.contains(&false);
        self.frame = OnceLock::new();
        self.trees = Default::default();
        Ok(self.bodies.len() - 1)
    }

    /// Gives a body another motion: the next step of a simulation, or another attempt at this one.
    ///
    /// Answers are those of a step made anew. The trees keep their order and get new boxes when they are next asked for, which takes a
    /// fraction of the time of building them; an order that no longer fits the bodies is given up. Cost: O(n).
    ///
    /// ```
    /// use satisfice_collision::continuous::{Separation, Step};
    /// use satisfice_collision::{Placement, generate};
    /// let sheet = generate::cloth(2.0, 2.0, 9, 9)?;
    /// let frame = |z: f64| Placement::from_translation([0.0, 0.0, z])?.place(&generate::icosphere(0.1, 1)?);
    /// let mut step = Step::new();
    /// step.add_rigid(&frame(1.0)?, frame(0.5)?.vertices())?;
    /// step.add_deforming(&sheet, sheet.vertices())?;
    /// assert_eq!(step.free_step(Separation::TOUCHING)?, 1.0);
    /// step.set_motion(0, frame(0.5)?.vertices(), frame(0.0)?.vertices())?;
    /// assert!(step.free_step(Separation::TOUCHING)? < 0.9);
    /// # Ok::<(), satisfice_collision::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no such body, or if it has another number of vertices; [`Error::NonFiniteVertex`]. The step is
    /// then as before.
    pub fn set_motion(&mut self, body: usize, from: &[Point], to: &[Point]) -> Result<(), Error> {
        let Some(of) = self.bodies.get(body) else {
            return Err(Error::parameter(
                "body",
                body,
                "the number of a body of this step",
            ));
        };
        let first = of.first[FeatureList::Vertices as usize] as usize;
        let next = self.bodies.get(body + 1);
        let end = next.map_or(self.from.len(), |next| {
            next.first[FeatureList::Vertices as usize] as usize
        });
        check("vertices at the start of the step", from, end - first)?;
        check("vertices at the end of the step", to, end - first)?;
        self.from[first..end].copy_from_slice(from);
        self.to[first..end].copy_from_slice(to);
        self.frame = OnceLock::new();
        for tree in &mut self.trees {
            tree.get_mut().unwrap_or_else(PoisonError::into_inner).move_on();
        }
        Ok(())
    }

    /// The number of bodies.
    #[must_use]
    pub fn bodies(&self) -> usize {
        self.bodies.len()
    }

    /// A vertex in motion, by its number in the common list.
    #[inline]
    pub(super) fn vertex(&self, v: u32) -> Moving<Point> {
        Moving::new(self.from[v as usize], self.to[v as usize])
    }

    #[inline]
    pub(super) fn edge(&self, e: u32) -> Moving<Segment> {
        let corners = self.edges[e as usize];
        Moving::new(
            corners.map(|v| self.from[v as usize]),
            corners.map(|v| self.to[v as usize]),
        )
    }

    #[inline]
    pub(super) fn triangle(&self, t: u32) -> Moving<Triangle> {
        let corners = self.triangles[t as usize];
        Moving::new(
            corners.map(|v| self.from[v as usize]),
            corners.map(|v| self.to[v as usize]),
        )
    }

    /// The body and the number within it of a feature of a list.
    pub(super) fn feature(&self, list: FeatureList, number: u32) -> FeatureOf {
        let body = self
            .bodies
            .partition_point(|body| body.first[list as usize] <= number)
            - 1;
        FeatureOf {
            body: body as u32,
            index: number - self.bodies[body].first[list as usize],
        }
    }

    /// The numbers of two features in the common lists, or `None` if there are none such.
    pub(super) fn numbers(&self, lists: [FeatureList; 2], contact: &MovingContact) -> Option<[u32; 2]> {
        let number = |list: FeatureList, feature: FeatureOf| {
            let next = self.bodies.get(feature.body as usize + 1);
            let end = next.map_or_else(|| self.count(list), |next| next.first[list as usize]);
            let number =
                self.bodies.get(feature.body as usize)?.first[list as usize].checked_add(feature.index)?;
            (number < end).then_some(number)
        };
        Some([number(lists[0], contact.a)?, number(lists[1], contact.b)?])
    }

    /// The lists that the features of a kind of pairs come from.
    ///
    /// # Errors
    /// [`Error::Parameter`] for kinds whose motion is not decided: edge-triangle and triangle-triangle.
    pub(super) fn lists(kind: PairKind) -> Result<[FeatureList; 2], Error> {
        match kind {
            PairKind::VertexVertex => Ok([FeatureList::Vertices, FeatureList::Vertices]),
            PairKind::VertexEdge => Ok([FeatureList::Vertices, FeatureList::Edges]),
            PairKind::VertexTriangle => Ok([FeatureList::Vertices, FeatureList::Triangles]),
            PairKind::EdgeEdge => Ok([FeatureList::Edges, FeatureList::Edges]),
            PairKind::EdgeTriangle | PairKind::TriangleTriangle => Err(Error::parameter(
                "pairs",
                kind,
                "in motion vertex-vertex, vertex-edge, vertex-triangle or edge-edge; surfaces that meet do so in one of these",
            )),
        }
    }

    /// Builds the trees that pairs of a kind within delta are searched by, which is the part of a search that asks no `stop`: for callers with a
    /// deadline, who can leave it to a thread that they need not wait for. No answer depends on it. Cost: O(n log n), once.
    ///
    /// ```
    /// use satisfice_collision::continuous::{Separation, Step};
    /// use satisfice_collision::{distance::PairKind, generate};
    /// let ball = generate::icosphere(1.0, 2)?;
    /// let mut step = Step::new();
    /// step.add_rigid(&ball, ball.vertices())?;
    /// step.build_trees(PairKind::EdgeEdge, Separation::TOUCHING)?;
    /// # Ok::<(), satisfice_collision::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Parameter`] for kinds whose motion is not decided: edge-triangle and triangle-triangle.
    pub fn build_trees(&self, kind: PairKind, separation: Separation) -> Result<(), Error> {
        let margin = self.margin(separation.get());
        for list in Self::lists(kind)? {
            self.tree(list, margin);
        }
        Ok(())
    }

    pub(super) fn has_loose_vertices(&self) -> bool {
        self.has_loose_vertices
    }

    /// Whether any body collides with others only.
    pub(super) fn has_rigid_bodies(&self) -> bool {
        self.bodies.iter().any(|body| !body.collides_with_itself)
    }

    /// Whether two features, of different bodies or of one that collides with itself, can be a pair: they share no vertex,
    /// and two vertices are not joined by an edge.
    #[inline]
    pub(super) fn may_pair(&self, lists: [FeatureList; 2], a: u32, b: u32) -> bool {
        !self.share_a_vertex(lists, a, b) && self.bodies_collide(lists, a, b)
    }

    /// The same for two features that share no vertex.
    #[inline]
    pub(super) fn may_pair_apart(&self, lists: [FeatureList; 2], a: u32, b: u32) -> bool {
        let are_vertices = lists == [FeatureList::Vertices; 2];
        !(are_vertices && self.share_a_vertex(lists, a, b)) && self.bodies_collide(lists, a, b)
    }

    /// Whether two features are of different bodies or of one that collides with itself.
    #[inline]
    fn bodies_collide(&self, lists: [FeatureList; 2], a: u32, b: u32) -> bool {
        if self.is_one_deforming_body() {
            return true;
        }
        let (body_a, body_b) = (self.feature(lists[0], a).body, self.feature(lists[1], b).body);
        body_a != body_b || self.bodies[body_a as usize].collides_with_itself
    }

    #[inline(always)]
    fn share_a_vertex(&self, lists: [FeatureList; 2], a: u32, b: u32) -> bool {
        match lists {
            [FeatureList::Vertices, FeatureList::Triangles] => self.triangles[b as usize].contains(&a),
            [FeatureList::Vertices, FeatureList::Edges] => self.edges[b as usize].contains(&a),
            [FeatureList::Edges, FeatureList::Edges] => {
                let [p, q] = self.edges[a as usize];
                let [r, s] = self.edges[b as usize];
                p == r || p == s || q == r || q == s
            }
            _ => {
                let edge = [a.min(b), a.max(b)];
                a == b || self.edges.binary_search(&edge).is_ok()
            }
        }
    }

    /// Whether all features belong to one body that collides with itself.
    #[inline]
    fn is_one_deforming_body(&self) -> bool {
        matches!(self.bodies.as_slice(), [body] if body.collides_with_itself)
    }

    /// The frame of the boxes, and the boxes around whole bodies.
    fn frame(&self) -> &(BoxFrame, BodyBoxes) {
        self.frame.get_or_init(|| {
            let frame = BoxFrame::around(&self.from, &self.to);
            let first = self.bodies.iter().map(|body| body.first[0] as usize);
            let boxes = BodyBoxes::new(&frame, &first.collect::<Vec<_>>());
            (frame, boxes)
        })
    }

    /// The tree over the features of a list that can be in a pair within a margin; built or fitted when it is first asked for.
    pub(super) fn tree(&self, list: FeatureList, margin: f32) -> Arc<MovingTree> {
        match list {
            FeatureList::Vertices => self.tree_of(list, margin, |v| [v]),
            FeatureList::Edges => self.tree_of(list, margin, |e| self.edges[e as usize]),
            FeatureList::Triangles => self.tree_of(list, margin, |t| self.triangles[t as usize]),
        }
    }

    fn tree_of<const N: usize>(
        &self,
        list: FeatureList,
        margin: f32,
        corners: impl Fn(u32) -> [u32; N],
    ) -> Arc<MovingTree> {
        let (frame, boxes) = self.frame();
        let first = self.bodies.iter().map(|body| body.first[list as usize]);
        let in_motion = ListInMotion {
            frame,
            boxes,
            first: first.chain([self.count(list)]).collect(),
            collides_with_itself: self.bodies.iter().map(|body| body.collides_with_itself).collect(),
            corners,
        };
        let mut kept = self.trees[list as usize]
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        kept.get(&in_motion, margin)
    }

    /// The number of features of a list.
    fn count(&self, list: FeatureList) -> u32 {
        let count = match list {
            FeatureList::Vertices => self.from.len(),
            FeatureList::Edges => self.edges.len(),
            FeatureList::Triangles => self.triangles.len(),
        };
        count as u32
    }

    /// Delta in the unit of the trees, rounded up.
    pub(super) fn margin(&self, delta: f64) -> f32 {
        self.frame().0.margin(delta)
    }
}

/// The vertices of a frame must be so many, and finite.
fn check(what: &'static str, frame: &[Point], count: usize) -> Result<(), Error> {
    if frame.len() != count {
        return Err(Error::parameter(
            what,
            frame.len(),
            "as many as at the other end; both frames need the same topology",
        ));
    }
    all_finite(frame.iter().copied())
}

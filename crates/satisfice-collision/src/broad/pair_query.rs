//! Two posed bodies, or one with itself, and the question asked of every pair of their features.

use super::boxes::Dirty;
use super::features::FeatureTree;
use super::gaps::FarBoxes;
use super::pair::Pair;
use super::relative::{Composition, Relative};
use super::separating_axis::Triangles;
use super::traverse::{CandidateSink, Descend, Known, TreeWork, Trees, Visit};
use crate::distance::{self, Decision, EdgeBatch, Point, Threshold, TriangleBatch, VertexBatch};
use crate::mesh::{Features, all_finite};
use crate::simd::dispatch;
use crate::{Error, FeatureKind, Placement, Shape};

/// Decides which pairs of features count; `None` for all.
pub type Keep<'a> = Option<&'a (dyn Fn(u32, u32) -> bool + Sync)>;

/// Two posed bodies and the pairs of features to find.
#[derive(Clone, Copy)]
pub(crate) struct PairQuery<'a> {
    pub(crate) a: (&'a FeatureTree, &'a Placement),
    pub(crate) b: (&'a FeatureTree, &'a Placement),
    /// Whether `a` and `b` are one tree, and each pair of different features is wanted once.
    pub(crate) one_body: bool,
    pub(crate) threshold: Threshold,
    pub(crate) keep: Keep<'a>,
    /// Report only pairs in which at least one feature moved.
    pub(crate) moved: [Dirty; 2],
    /// Whether both are features of one mesh, of which those that share a vertex are no pair.
    pub(crate) shares_mesh: bool,
}

impl PairQuery<'_> {
    /// Checks that no pose takes a vertex out of the range of `f64`.
    pub(crate) fn check(&self) -> Result<(), Error> {
        for (tree, pose) in [self.a, self.b] {
            check_pose(tree, pose)?;
        }
        Ok(())
    }

    /// Whether the cheapest of all tests proves the bodies apart.
    pub(crate) fn apart(&self) -> bool {
        !self.one_body && apart(self.a, self.b, self.threshold.get())
    }

    /// Whether every feature is a point.
    pub(crate) fn points(&self) -> bool {
        self.a.0.kind() == FeatureKind::Vertex && self.b.0.kind() == FeatureKind::Vertex
    }

    pub(crate) fn keeps(&self, a: u32, b: u32) -> bool {
        self.keep.is_none_or(|keep| keep(a, b)) && !(self.shares_mesh && self.share_a_vertex(a, b))
    }

    fn share_a_vertex(&self, a: u32, b: u32) -> bool {
        let (a, b) = (self.a.0.corners(a), self.b.0.corners(b));
        a.iter().any(|vertex| b.contains(vertex))
    }

    /// Calls `then` with both trees in one frame, the coarser one of the two, and with whether the first tree is that of `b`.
    pub(crate) fn in_common_frame<R>(&self, then: impl FnOnce(Trees<'_>, bool) -> R) -> R {
        let (a, b) = (self.a.0, self.b.0);
        if self.one_body {
            let filter = &a.frame.filter(self.threshold.get());
            let relative = &Relative::same();
            return then(
                Trees {
                    a: &a.tree,
                    b: &a.tree,
                    relative,
                    filter,
                    far: FarBoxes::new(self, None).as_ref(),
                    one_body: true,
                    moved: self.moved,
                    neighbours: self.shares_mesh.then(|| [a.corners_in_order(); 2]),
                },
                false,
            );
        }
        let flip = b.frame.scale > a.frame.scale;
        let way = self.composition(flip);
        let [moved_a, moved_b] = self.moved;
        let ((a, moved_a), (b, moved_b)) = if flip {
            ((b, moved_b), (a, moved_a))
        } else {
            ((a, moved_a), (b, moved_b))
        };
        let (relative, filter) = &Relative::new(&way, self.threshold.get());
        let moved = [moved_a, moved_b];
        let neighbours = self
            .shares_mesh
            .then(|| [a.corners_in_order(), b.corners_in_order()]);
        then(
            Trees {
                a: &a.tree,
                b: &b.tree,
                relative,
                filter,
                far: FarBoxes::new(self, Some(&way)).as_ref(),
                one_body: false,
                moved,
                neighbours,
            },
            flip,
        )
    }

    /// The separating-axis test for a descent of these trees; `None` unless the features are triangles.
    pub(crate) fn separating_axes<'t>(&'t self, trees: &Trees<'t>, flip: bool) -> Option<SeparatingAxes<'t>> {
        let (first, second) = if flip {
            (self.b.0, self.a.0)
        } else {
            (self.a.0, self.b.0)
        };
        let Trees { relative, filter, .. } = *trees;
        Some(SeparatingAxes {
            first: first.triangles()?,
            second: second.triangles()?,
            relative,
            apart: filter.apart,
        })
    }

    /// Continues the descent in `stack`: at most `most` visits and about `enough` pairs, which are appended to `found` in no
    /// order. A descent starts with `start` and has ended when the stack is empty.
    pub(crate) fn step(
        &self,
        stack: &mut Vec<Visit>,
        most: usize,
        enough: usize,
        found: &mut Vec<Pair>,
    ) -> TreeWork {
        let enough = found.len().saturating_add(enough);
        if self.points() {
            self.step_as::<true>(stack, most, enough, found)
        } else {
            self.step_as::<false>(stack, most, enough, found)
        }
    }

    fn step_as<const POINTS: bool>(
        &self,
        stack: &mut Vec<Visit>,
        most: usize,
        enough: usize,
        found: &mut Vec<Pair>,
    ) -> TreeWork {
        self.in_common_frame(|trees, flip| {
            let mut visit = Visitor::<POINTS> {
                enough,
                ..Visitor::new(self, flip, found, self.separating_axes(&trees, flip))
            };
            visit.descend(trees, stack, most)
        })
    }

    /// Puts the start of a descent onto the stack.
    pub(crate) fn start(&self, stack: &mut Vec<Visit>) {
        stack.clear();
        if !self.apart() {
            self.in_common_frame(|trees, _| trees.start(stack));
        }
    }

    /// Whether feature `i` of `a` and feature `j` of `b` are closer than the threshold: the exact decision.
    pub(crate) fn within(&self, i: u32, j: u32) -> bool {
        let [a, b] = self.shapes(Pair { a: i, b: j });
        distance::within(&a, &b, self.threshold)
    }

    /// The features of a pair in the world.
    #[inline(always)]
    pub(crate) fn shapes(&self, Pair { a: i, b: j }: Pair) -> [Shape; 2] {
        let ((a, pose_a), (b, pose_b)) = (self.a, self.b);
        [
            a.shape(i).map(|p| pose_a.apply(p)),
            b.shape(j).map(|p| pose_b.apply(p)),
        ]
    }

    /// The pose of the first body in the frame of the second, or the other way round if `flip`.
    pub(crate) fn composition(&self, flip: bool) -> Composition {
        let ((a, pose_a), (b, pose_b)) = if flip { (self.b, self.a) } else { (self.a, self.b) };
        Composition::new(&a.frame, pose_a, &b.frame, pose_b)
    }
}

/// The features of a body and where it is.
#[derive(Clone, Copy)]
struct PlacedFeatures<'a> {
    features: Features<'a>,
    vertices: &'a [Point],
    /// `None` for one that leaves every point where it is.
    pose: Option<&'a Placement>,
}

impl<'a> PlacedFeatures<'a> {
    fn new((tree, pose): (&'a FeatureTree, &'a Placement)) -> Self {
        Self {
            features: tree.features(),
            vertices: tree.vertices(),
            pose: Some(pose).filter(|&pose| *pose != Placement::IDENTITY),
        }
    }

    /// These corners in the world.
    #[inline(always)]
    fn corners<const N: usize>(&self, of: [u32; N]) -> [Point; N] {
        let mut corners = of.map(|vertex| self.vertices[vertex as usize]);
        if let Some(pose) = self.pose {
            corners = corners.map(|point| pose.apply(point));
        }
        corners
    }
}

/// Both bodies' triangles, in the order of the descent, and how they lie.
#[derive(Clone, Copy)]
pub(crate) struct SeparatingAxes<'a> {
    first: Triangles<'a>,
    second: Triangles<'a>,
    relative: &'a Relative,
    apart: f32,
}

/// Decides the candidates of a descent.
pub(crate) struct Visitor<'a, const POINTS: bool> {
    query: &'a PairQuery<'a>,
    /// Whether the first tree of the descent is `b`.
    flip: bool,
    found: &'a mut Vec<Pair>,
    bodies: [PlacedFeatures<'a>; 2],
    /// The separating-axis test, for pairs of triangles.
    axes: Option<SeparatingAxes<'a>>,
    /// Pairs to be decided as a batch, by kind.
    triangles: TriangleBatch<Pair>,
    edges: EdgeBatch<Pair>,
    vertices: VertexBatch<Pair>,
    /// Pairs after which the descent pauses.
    enough: usize,
    work: TreeWork,
}

impl<'a, const POINTS: bool> Visitor<'a, POINTS> {
    /// Pairs are appended to `found`.
    pub(crate) fn new(
        query: &'a PairQuery<'a>,
        flip: bool,
        found: &'a mut Vec<Pair>,
        axes: Option<SeparatingAxes<'a>>,
    ) -> Self {
        Self {
            query,
            bodies: [PlacedFeatures::new(query.a), PlacedFeatures::new(query.b)],
            flip,
            found,
            axes,
            triangles: TriangleBatch::new(query.threshold),
            edges: EdgeBatch::new(query.threshold),
            vertices: VertexBatch::new(query.threshold),
            enough: usize::MAX,
            work: TreeWork::default(),
        }
    }

    /// Continues a descent: at most about `most` visits.
    pub(crate) fn descend(&mut self, trees: Trees<'_>, stack: &mut Vec<Visit>, most: usize) -> TreeWork {
        let visits = dispatch(Descend {
            trees,
            stack,
            most,
            visit: self,
        });
        let found = &mut *self.found;
        let mut answer = |pair, decision: Decision| found.extend(decision.within.then_some(pair));
        self.triangles.finish(&mut answer);
        self.edges.finish(&mut answer);
        self.vertices.finish(&mut answer);
        TreeWork { visits, ..self.work }
    }
}

impl<const POINTS: bool> CandidateSink for Visitor<'_, POINTS> {
    const POINTS: bool = POINTS;

    #[inline]
    fn enough(&self) -> bool {
        self.found.len() >= self.enough
    }

    #[inline(always)]
    fn neighbours(&mut self, count: u32) {
        self.work.candidates += u64::from(count);
        self.work.neighbours += u64::from(count);
    }

    #[inline(always)]
    fn candidate(&mut self, first: u32, second: u32, known: Known) {
        let swap = if self.query.one_body {
            first > second
        } else {
            self.flip
        };
        let (a, b) = if swap { (second, first) } else { (first, second) };
        self.work.candidates += 1;
        if self.query.keep.is_some_and(|keep| !keep(a, b)) {
            return;
        }
        if let Some(axes) = &self.axes
            && known != Known::Far
            && axes
                .first
                .apart(first, &axes.second, second, axes.relative, axes.apart)
        {
            return;
        }
        let (pair, found) = (Pair { a, b }, &mut *self.found);
        if known == Known::Within {
            found.push(pair);
            return;
        }
        self.work.decisions += 1;
        let answer = |pair, decision: Decision| found.extend(decision.within.then_some(pair));
        let [one, two] = &self.bodies;
        let (a, b) = (a as usize, b as usize);
        match (one.features, two.features) {
            (Features::Edges(p), Features::Edges(q)) => {
                self.edges
                    .push(&one.corners(p[a]), &two.corners(q[b]), pair, answer);
            }
            (Features::Vertices(_), Features::Triangles(q)) => {
                self.vertices
                    .push(&one.corners([pair.a]), &two.corners(q[b]), pair, answer);
            }
            (Features::Triangles(p), Features::Triangles(q)) => {
                self.triangles
                    .push(&one.corners(p[a]), &two.corners(q[b]), pair, answer);
            }
            _ => found.extend(self.query.within(pair.a, pair.b).then_some(pair)),
        }
    }
}

/// Whether the balls around the two posed bodies prove them apart: the cheapest of all tests.
fn apart(
    (a, pose_a): (&FeatureTree, &Placement),
    (b, pose_b): (&FeatureTree, &Placement),
    delta: f64,
) -> bool {
    let (centre_a, centre_b) = (pose_a.apply(a.frame.origin), pose_b.apply(b.frame.origin));
    let reach = (a.radius() + b.radius() + delta) * (1.0 + 1e-9);
    let size = |c: &[f64; 3]| c[0].abs() + c[1].abs() + c[2].abs();
    // posing rounds in proportion to the lengths involved; an overflow to infinity or NaN proves nothing
    let slack = 1e-14 * (size(&centre_a) + size(&centre_b) + size(&a.frame.origin) + size(&b.frame.origin));
    (0..3).any(|k| (centre_a[k] - centre_b[k]).abs() > reach + slack)
}

/// Checks that a pose takes no vertex out of the range of `f64`.
fn check_pose(tree: &FeatureTree, pose: &Placement) -> Result<(), Error> {
    let farthest = tree.frame.farthest + tree.frame.origin.iter().fold(0.0, |m, c| c.abs().max(m));
    let moved = pose.translation().iter().fold(0.0_f64, |m, c| c.abs().max(m));
    if (4.0 * farthest + moved).is_finite() {
        return Ok(());
    }
    all_finite(tree.vertices().iter().map(|&point| pose.apply(point)))
}

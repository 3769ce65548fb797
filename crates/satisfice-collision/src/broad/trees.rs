//! All pairs of features within a threshold by kept box trees, of bodies that may have been posed since.

use super::boxes::BoxTree;
use super::features::{FeatureKind, FeatureTree};
use super::lanes::dispatch;
use super::order::{Packing, Pair};
use super::relative::Relative;
use super::traverse::{Candidates, Descend, Trees, Visit};
use crate::distance::{
    Threshold, edge_edge, edge_triangle, triangle_triangle, vertex_edge, vertex_triangle, vertex_vertex,
};
use crate::{Error, Placement};

/// What a traversal had to do.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct TreeWork {
    /// Pairs of groups of eight boxes compared.
    pub visits: u64,
    /// Pairs of features whose boxes are within the threshold.
    pub candidates: u64,
    /// Pairs that the distance itself had to decide.
    pub decisions: u64,
}

/// Which pairs of features count at all; `None` for all of them.
pub type Keep<'a> = Option<&'a (dyn Fn(u32, u32) -> bool + Sync)>;

/// Finds pairs of features of kept trees. Keeps its memory from call to call.
#[derive(Debug, Default)]
pub struct TreeJoin {
    threads: usize,
    tasks: Vec<Task>,
    keys: [Vec<u64>; 2],
    pairs: Vec<Pair>,
    work: TreeWork,
}

#[derive(Debug, Default)]
struct Task {
    stack: Vec<Visit>,
    found: Vec<u64>,
    work: TreeWork,
}

impl TreeJoin {
    /// Works on one thread.
    #[must_use]
    pub fn new() -> Self {
        Self {
            threads: 1,
            ..Self::default()
        }
    }

    /// Works on the current rayon pool. The result is the same.
    #[must_use]
    pub fn parallel() -> Self {
        Self {
            threads: rayon::current_num_threads(),
            ..Self::default()
        }
    }

    /// What the last call did.
    #[must_use]
    pub fn work(&self) -> TreeWork {
        self.work
    }

    /// All pairs of a feature of `a`, posed, and one of `b`, posed, that are within the threshold and kept, by number.
    /// The distance is that of the posed coordinates as [`Placement::apply`] rounds them.
    ///
    /// # Errors
    /// [`Error::NonFiniteVertex`] if a pose takes a vertex out of range.
    pub fn between(
        &mut self,
        (a, pose_a): (&FeatureTree, &Placement),
        (b, pose_b): (&FeatureTree, &Placement),
        threshold: Threshold,
        keep: Keep<'_>,
    ) -> Result<&[Pair], Error> {
        for (tree, pose) in [(a, pose_a), (b, pose_b)] {
            check_pose(tree, pose)?;
        }
        if apart((a, pose_a), (b, pose_b), threshold.get()) {
            self.work = TreeWork::default();
            self.pairs.clear();
            return Ok(&self.pairs);
        }
        // the body with the coarser frame is at rest
        let flip = b.frame.scale > a.frame.scale;
        let ((moving, pose_m), (rest, pose_r)) = if flip {
            ((b, pose_b), (a, pose_a))
        } else {
            ((a, pose_a), (b, pose_b))
        };
        let (relative, filter) = Relative::new(&moving.frame, pose_m, &rest.frame, pose_r, threshold.get());
        let trees = Trees {
            a: &moving.tree,
            b: &rest.tree,
            relative: &relative,
            filter: &filter,
            one_body: false,
        };
        self.run(
            trees,
            &Judge {
                a,
                pose_a,
                b,
                pose_b,
                threshold,
                keep,
                flip,
                one_body: false,
            },
        );
        Ok(&self.pairs)
    }

    /// All pairs `i < j` of features of one body, where it was put last, that are within the threshold and kept.
    pub fn within(&mut self, body: &FeatureTree, threshold: Threshold, keep: Keep<'_>) -> &[Pair] {
        let filter = body.frame.filter(threshold.get());
        let trees = Trees {
            a: &body.tree,
            b: &body.tree,
            relative: &Relative::same(),
            filter: &filter,
            one_body: true,
        };
        let pose = &Placement::IDENTITY;
        let judge = Judge {
            a: body,
            pose_a: pose,
            b: body,
            pose_b: pose,
            threshold,
            keep,
            flip: false,
            one_body: true,
        };
        self.run(trees, &judge);
        &self.pairs
    }

    fn run(&mut self, trees: Trees<'_>, judge: &Judge<'_>) {
        let points = judge.a.kind() == FeatureKind::Vertex && judge.b.kind() == FeatureKind::Vertex;
        if points {
            self.descend::<true>(trees, judge);
        } else {
            self.descend::<false>(trees, judge);
        }
    }

    fn descend<const POINTS: bool>(&mut self, trees: Trees<'_>, judge: &Judge<'_>) {
        let packing = Packing::new(judge.a.len(), judge.b.len());
        let go = |task: &mut Task, most: usize| {
            let Task { stack, found, work } = task;
            let mut visit = Visitor::<POINTS> {
                judge,
                packing,
                found,
                work: *work,
            };
            let visits = dispatch(Descend {
                trees,
                stack,
                most,
                visit: &mut visit,
            });
            *work = visit.work;
            work.visits += visits;
        };
        if self.tasks.is_empty() {
            self.tasks.push(Task::default());
        }
        for task in &mut self.tasks {
            task.found.clear();
            task.stack.clear();
            task.work = TreeWork::default();
        }
        trees.start(&mut self.tasks[0].stack);
        let big = |tree: &BoxTree| tree.len() > 4096;
        if self.threads > 1 && (big(trees.a) || big(trees.b)) {
            // broad steps first, until there is enough to share out
            let tasks = self.threads * 16;
            let mut open = std::mem::take(&mut self.tasks[0].stack);
            let mut next = Vec::new();
            while !open.is_empty() && open.len() < tasks * 4 {
                for visit in open.drain(..) {
                    self.tasks[0].stack.push(visit);
                    go(&mut self.tasks[0], 1);
                    next.append(&mut self.tasks[0].stack);
                }
                std::mem::swap(&mut open, &mut next);
            }
            self.tasks.resize_with(tasks.max(self.tasks.len()), Task::default);
            let count = self.tasks.len();
            for (at, visit) in open.into_iter().enumerate() {
                self.tasks[at % count].stack.push(visit);
            }
            use rayon::prelude::*;
            self.tasks.par_iter_mut().for_each(|task| go(task, usize::MAX));
        } else {
            go(&mut self.tasks[0], usize::MAX);
        }
        self.work = TreeWork::default();
        for Task { work, .. } in &self.tasks {
            self.work.visits += work.visits;
            self.work.candidates += work.candidates;
            self.work.decisions += work.decisions;
        }
        let found = self.tasks.iter().map(|task| task.found.as_slice());
        packing.sort(found, &mut self.keys, &mut self.pairs, self.threads);
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

/// Refuses a pose that takes a vertex out of the range of `f64`.
fn check_pose(tree: &FeatureTree, pose: &Placement) -> Result<(), Error> {
    let farthest =
        tree.frame.half / tree.frame.scale + tree.frame.origin.iter().fold(0.0, |m, c| c.abs().max(m));
    let moved = pose.translation().iter().fold(0.0_f64, |m, c| c.abs().max(m));
    if (4.0 * farthest + moved).is_finite() {
        return Ok(());
    }
    for (vertex, &point) in tree.vertices().iter().enumerate() {
        let posed = pose.apply(point);
        if let Some(k) = posed.iter().position(|c| !c.is_finite()) {
            return Err(Error::NonFiniteVertex {
                vertex,
                axis: ['x', 'y', 'z'][k],
                value: posed[k],
            });
        }
    }
    Ok(())
}

/// The question asked of every candidate.
struct Judge<'a> {
    a: &'a FeatureTree,
    pose_a: &'a Placement,
    b: &'a FeatureTree,
    pose_b: &'a Placement,
    threshold: Threshold,
    keep: Keep<'a>,
    /// Whether the first tree of the traversal is `b`.
    flip: bool,
    one_body: bool,
}

impl Judge<'_> {
    fn within(&self, i: u32, j: u32) -> bool {
        let (a, b, threshold) = (self.a, self.b, self.threshold);
        let at_a = |p| self.pose_a.apply(p);
        let at_b = |p| self.pose_b.apply(p);
        match (a.kind(), b.kind()) {
            (FeatureKind::Vertex, FeatureKind::Vertex) => {
                vertex_vertex::within(&at_a(a.point(i)), &at_b(b.point(j)), threshold)
            }
            (FeatureKind::Vertex, FeatureKind::Edge) => {
                vertex_edge::within(&at_a(a.point(i)), &b.segment(j).map(at_b), threshold)
            }
            (FeatureKind::Edge, FeatureKind::Vertex) => {
                vertex_edge::within(&at_b(b.point(j)), &a.segment(i).map(at_a), threshold)
            }
            (FeatureKind::Vertex, FeatureKind::Triangle) => {
                vertex_triangle::within(&at_a(a.point(i)), &b.triangle(j).map(at_b), threshold)
            }
            (FeatureKind::Triangle, FeatureKind::Vertex) => {
                vertex_triangle::within(&at_b(b.point(j)), &a.triangle(i).map(at_a), threshold)
            }
            (FeatureKind::Edge, FeatureKind::Edge) => {
                edge_edge::within(&a.segment(i).map(at_a), &b.segment(j).map(at_b), threshold)
            }
            (FeatureKind::Edge, FeatureKind::Triangle) => {
                edge_triangle::within(&a.segment(i).map(at_a), &b.triangle(j).map(at_b), threshold)
            }
            (FeatureKind::Triangle, FeatureKind::Edge) => {
                edge_triangle::within(&b.segment(j).map(at_b), &a.triangle(i).map(at_a), threshold)
            }
            (FeatureKind::Triangle, FeatureKind::Triangle) => {
                triangle_triangle::within(&a.triangle(i).map(at_a), &b.triangle(j).map(at_b), threshold)
            }
        }
    }
}

struct Visitor<'a, const POINTS: bool> {
    judge: &'a Judge<'a>,
    packing: Packing,
    found: &'a mut Vec<u64>,
    work: TreeWork,
}

impl<const POINTS: bool> Candidates for Visitor<'_, POINTS> {
    const POINTS: bool = POINTS;

    #[inline]
    fn candidate(&mut self, first: u32, second: u32, sure: bool) {
        let swap = if self.judge.one_body {
            first > second
        } else {
            self.judge.flip
        };
        let (a, b) = if swap { (second, first) } else { (first, second) };
        self.work.candidates += 1;
        if self.judge.keep.is_some_and(|keep| !keep(a, b)) {
            return;
        }
        if !sure {
            self.work.decisions += 1;
            if !self.judge.within(a, b) {
                return;
            }
        }
        self.found.push(self.packing.pack(a, b));
    }
}

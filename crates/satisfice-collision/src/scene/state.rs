//! A body inside a scene: where it is, what of it moved, and the trees kept over it.

use super::body::{Body, Motion};
use super::forecast::Forecast;
use crate::broad::{FeatureTree, Moved, Runs};
use crate::mesh::Point;
use crate::{Aabb, Adjacency, Error, FeatureKind, Placement, Shape};

/// A body, its place at the last frame, and what is kept about it.
pub(super) struct State {
    pub(super) body: Body,
    /// Where each vertex of the mesh is, before the placement.
    pub(super) vertices: Vec<Point>,
    pub(super) placement: Placement,
    /// Whether the placement is the identity.
    rests: bool,
    next_vertices: Vec<Point>,
    has_next: bool,
    step: Step,
    /// The boxes of the present vertices, if they are known.
    runs: Runs,
    runs_are_current: bool,
    /// Those of the next vertices, and room to measure others that may be refused.
    next_runs: [Runs; 2],
    next_placement: Option<Placement>,
    pub(super) forecast: Forecast,
    /// What moved between the last two frames.
    pub(super) moved: Moved,
    /// Share of the vertices that moved.
    pub(super) share: f64,
    /// No vertex moved further than this.
    pub(super) motion: f64,
    /// Root of the mean square motion of the vertices less their mean motion. An estimate.
    pub(super) agitation: f64,
    /// The box of the posed vertices, roundings included.
    pub(super) bounds: Aabb,
    local: Aabb,
    posed: Vec<Point>,
    posed_is_current: bool,
    trees: [Option<Kept>; 3],
    /// Vertices within the excluded ring of each vertex.
    pub(super) rings: Option<Adjacency>,
}

/// How the vertices move to the next frame.
#[derive(Default)]
struct Step {
    /// How many of them do.
    count: usize,
    /// The square of the longest way.
    square: f64,
    sum: Point,
    squares: f64,
}

impl Step {
    fn between(old: &[Point], new: &[Point]) -> Self {
        let mut step = Self::default();
        for (old, new) in old.iter().zip(new) {
            let [x, y, z] = [new[0] - old[0], new[1] - old[1], new[2] - old[2]];
            let square = x * x + y * y + z * z;
            let [sum_x, sum_y, sum_z] = step.sum;
            step.sum = [sum_x + x, sum_y + y, sum_z + z];
            step.squares += square;
            step.count += usize::from((x != 0.0) | (y != 0.0) | (z != 0.0));
            step.square = if square > step.square { square } else { step.square };
        }
        step
    }
}

struct Kept {
    tree: FeatureTree,
    current: bool,
    /// Whether it was current in the frame before: then what a refit marks is what moved since that frame.
    was_current: bool,
    /// How many refits in a row ended in a new tree.
    rebuilt: u32,
}

impl State {
    pub(super) fn new(body: Body) -> Self {
        let vertices = body.mesh.vertices().to_vec();
        let local = body.mesh.bounds();
        let rings = body
            .ring
            .filter(|&width| width > 0)
            .map(|width| body.mesh.adjacency().rings(width));
        let placement = body.placement;
        let mut state = Self {
            body,
            vertices,
            placement,
            rests: placement == Placement::IDENTITY,
            next_vertices: Vec::new(),
            has_next: false,
            step: Step::default(),
            runs: Runs::default(),
            runs_are_current: false,
            next_runs: [Runs::default(), Runs::default()],
            next_placement: None,
            forecast: Forecast::new(placement),
            moved: Moved::All,
            share: 1.0,
            motion: f64::INFINITY,
            agitation: f64::INFINITY,
            bounds: local,
            local,
            posed: Vec::new(),
            posed_is_current: false,
            trees: [None, None, None],
            rings,
        };
        state.bounds = state.posed_bounds(&placement);
        state
    }

    /// Remembers where the vertices go at the next frame.
    pub(super) fn deform(&mut self, vertices: &[Point]) -> Result<(), Error> {
        if self.body.motion != Motion::Deforming {
            return Err(Error::parameter(
                "body",
                "not deforming",
                "only a deforming body has moving vertices",
            ));
        }
        if vertices.len() != self.vertices.len() {
            return Err(Error::parameter(
                "number of vertices",
                vertices.len(),
                "a frame has as many vertices as its body",
            ));
        }
        let [next, room] = &mut self.next_runs;
        room.measure(vertices, 1)?;
        std::mem::swap(next, room);
        self.next_vertices.clear();
        self.next_vertices.extend_from_slice(vertices);
        self.step = Step::between(&self.vertices, vertices);
        self.has_next = true;
        Ok(())
    }

    /// Remembers where the body goes at the next frame.
    pub(super) fn place(&mut self, placement: Placement) -> Result<(), Error> {
        if self.body.motion != Motion::Rigid {
            return Err(Error::parameter(
                "body",
                "not rigid",
                "only a rigid body has a moving placement",
            ));
        }
        let bounds = self.posed_bounds(&placement);
        if bounds.min.iter().chain(&bounds.max).any(|c| !c.is_finite()) {
            for (vertex, &point) in self.vertices.iter().enumerate() {
                let posed = placement.apply(point);
                if let Some(k) = posed.iter().position(|c| !c.is_finite()) {
                    return Err(Error::NonFiniteVertex {
                        vertex,
                        axis: ['x', 'y', 'z'][k],
                        value: posed[k],
                    });
                }
            }
        }
        self.next_placement = Some(placement);
        Ok(())
    }

    /// Whether a next frame has been given.
    pub(super) fn is_pending(&self) -> bool {
        self.has_next || self.next_placement.is_some()
    }

    /// Goes to the next frame.
    pub(super) fn settle(&mut self) {
        (self.moved, self.share, self.motion, self.agitation) = (Moved::None, 0.0, 0.0, 0.0);
        for kept in self.trees.iter_mut().flatten() {
            kept.was_current = kept.current;
        }
        let placement = self.next_placement.take().unwrap_or(self.placement);
        let (corners, local) = (self.corners(), self.local);
        self.forecast.settle(&self.placement, &placement, |one, two| {
            apart(&corners, &local, one, two)
        });
        if placement != self.placement {
            self.motion = apart(&corners, &local, &self.placement, &placement);
            (self.moved, self.share) = (Moved::All, 1.0);
            self.placement = placement;
            self.rests = placement == Placement::IDENTITY;
            self.posed_is_current = false;
            self.bounds = self.posed_bounds(&placement);
        }
        if std::mem::take(&mut self.has_next) {
            std::mem::swap(&mut self.runs, &mut self.next_runs[0]);
            self.runs_are_current = true;
            if self.step.count > 0 {
                std::mem::swap(&mut self.vertices, &mut self.next_vertices);
                self.moved = Moved::Marked;
                let n = self.vertices.len() as f64;
                self.share = self.step.count as f64 / n;
                // rounded up; squares that underflow belong to motions below 1e-153
                self.motion = self.step.square.sqrt() * (1.0 + 1e-12) + 1e-153;
                let mean: f64 = self.step.sum.iter().map(|c| (c / n) * (c / n)).sum();
                self.agitation = (self.step.squares / n - mean).max(0.0).sqrt();
                if let Some(bounds) = self.runs.whole() {
                    (self.local, self.bounds) = (bounds, bounds);
                }
                self.trees
                    .iter_mut()
                    .flatten()
                    .for_each(|kept| kept.current = false);
            }
        }
    }

    /// The tree over features of this kind, refitted if the vertices have moved since, and built anew if they have moved far.
    pub(super) fn ready(&mut self, kind: FeatureKind) -> Result<(), Error> {
        let slot = &mut self.trees[kind as usize];
        let mut rebuilt = 0;
        if let Some(kept) = slot {
            if kept.current {
                return Ok(());
            }
            kept.tree.refit(&self.vertices)?;
            kept.current = true;
            if !kept.tree.is_loose() {
                kept.rebuilt = 0;
                return Ok(());
            }
            rebuilt = kept.rebuilt + 1;
        }
        let mesh = if self.body.motion == Motion::Deforming {
            &self.body.mesh.with_vertices(self.vertices.clone())?
        } else {
            &self.body.mesh
        };
        *slot = Some(Kept {
            tree: FeatureTree::new(mesh, kind),
            current: true,
            was_current: false,
            rebuilt,
        });
        Ok(())
    }

    /// What counts as moved since the last frame in the tree over features of this kind.
    pub(super) fn marks(&self, kind: FeatureKind) -> Moved {
        match (self.moved, &self.trees[kind as usize]) {
            (Moved::Marked, Some(kept)) if kept.was_current => Moved::Marked,
            (Moved::Marked, _) => Moved::All,
            (moved, _) => moved,
        }
    }

    /// Whether the tree over the vertices had to be built anew in each of the last frames that it was refitted in. That is
    /// forgotten then.
    pub(super) fn was_shaken(&mut self) -> bool {
        let kept = self.trees[FeatureKind::Vertex as usize].as_mut();
        kept.is_some_and(|kept| {
            let shaken = kept.rebuilt > 2;
            kept.rebuilt = if shaken { 0 } else { kept.rebuilt };
            shaken
        })
    }

    /// The tree; `ready` has to come first.
    pub(super) fn tree(&self, kind: FeatureKind) -> Option<&FeatureTree> {
        self.trees[kind as usize].as_ref().map(|kept| &kept.tree)
    }

    /// Computes the posed vertices if they are out of date.
    pub(super) fn pose(&mut self) {
        if self.placement != Placement::IDENTITY && !self.posed_is_current {
            self.posed.clear();
            self.posed
                .extend(self.vertices.iter().map(|&p| self.placement.apply(p)));
            self.posed_is_current = true;
        }
    }

    /// The posed vertices; `pose` has to come first.
    pub(super) fn posed(&self) -> &[Point] {
        if self.placement == Placement::IDENTITY {
            &self.vertices
        } else {
            &self.posed
        }
    }

    /// The boxes of the posed vertices, where they are known.
    pub(super) fn runs(&self) -> Option<&Runs> {
        (self.runs_are_current && self.rests).then_some(&self.runs)
    }

    /// Where a vertex is in the world.
    #[inline]
    pub(super) fn vertex(&self, v: u32) -> Point {
        let vertex = self.vertices[v as usize];
        if self.rests {
            vertex
        } else {
            self.placement.apply(vertex)
        }
    }

    /// Where a feature is in the world.
    #[inline]
    pub(super) fn shape(&self, kind: FeatureKind, feature: u32) -> Shape {
        self.body.mesh.features(kind).shape(feature, |v| self.vertex(v))
    }

    /// The vertices of a feature, the last repeated to make three.
    #[inline]
    pub(super) fn corners_of(&self, kind: FeatureKind, feature: u32) -> [u32; 3] {
        self.body.mesh.features(kind).corners(feature)
    }

    /// The point of a feature with these weights, before the placement.
    pub(super) fn own_point(&self, kind: FeatureKind, feature: u32, weights: [f64; 3]) -> Point {
        let corners = self.corners_of(kind, feature).map(|v| self.vertices[v as usize]);
        if kind == FeatureKind::Vertex {
            return corners[0];
        }
        std::array::from_fn(|k| (0..3).map(|c| weights[c] * corners[c][k]).sum())
    }

    /// No coordinate of the body, before or after its placement, is larger.
    pub(super) fn extent(&self) -> f64 {
        let largest = |v: &[f64; 3]| v.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        largest(&self.local.min)
            + largest(&self.local.max)
            + largest(&self.bounds.min)
            + largest(&self.bounds.max)
            + largest(&self.placement.translation())
    }

    /// How many features of a kind there are.
    pub(super) fn count(&self, kind: FeatureKind) -> usize {
        kind.count(&self.body.mesh)
    }

    fn corners(&self) -> [Point; 8] {
        let sides = [self.local.min, self.local.max];
        std::array::from_fn(|c| [sides[c & 1][0], sides[c >> 1 & 1][1], sides[c >> 2][2]])
    }

    /// A rotated box is the hull of its rotated corners; posing rounds in proportion to the lengths involved.
    fn posed_bounds(&self, placement: &Placement) -> Aabb {
        if *placement == Placement::IDENTITY {
            return self.local;
        }
        let mut bounds = Aabb::point(placement.apply(self.corners()[0]));
        self.corners()
            .iter()
            .for_each(|&corner| bounds.include(placement.apply(corner)));
        let slack = rounding(&self.local, placement);
        Aabb {
            min: bounds.min.map(|c| c - slack),
            max: bounds.max.map(|c| c + slack),
        }
    }
}

fn rounding(local: &Aabb, placement: &Placement) -> f64 {
    let largest = |v: &[f64; 3]| v.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
    1e-14 * (largest(&local.min) + largest(&local.max) + largest(&placement.translation()))
}

/// How far no point of a box is from itself in two placements: the way is an affine function of the point, so that it is
/// longest at a corner.
fn apart(corners: &[Point; 8], local: &Aabb, one: &Placement, two: &Placement) -> f64 {
    let square = corners.iter().fold(0.0_f64, |most, &corner| {
        let (old, new) = (one.apply(corner), two.apply(corner));
        most.max((0..3).map(|k| (new[k] - old[k]) * (new[k] - old[k])).sum())
    });
    square.sqrt() * (1.0 + 1e-12) + 4.0 * (rounding(local, one) + rounding(local, two)) + 1e-153
}

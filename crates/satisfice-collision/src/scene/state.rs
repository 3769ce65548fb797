//! A body inside a world: where it is, and what moved.

use std::sync::Arc;

use super::SharedMesh;
use super::body::{Body, Motion};
use super::deforming::Deforming;
use super::extent::{is_small, largest};
use super::pairs::NONE;
use crate::broad::{BlockBounds, Box32, Dirty, FeatureTree};
use crate::mesh::Point;
use crate::{Aabb, CompactPlacement, Error, FeatureKind, Placement, Shape};

/// A body and its place at the last frame. What a frame reads of a rigid body that moves comes first, on two lines of memory.
#[repr(C, align(64))]
pub(super) struct State {
    pub(super) generation: u32,
    /// Its place in the list of what moves in the next frame, or [`NONE`].
    pub(super) pending: u32,
    pub(super) kind: Motion,
    /// Whether only a large translation takes a vertex out of the range of numbers.
    is_small: bool,
    /// Whether the placement rotates.
    is_turned: bool,
    /// Whether the placement is the identity.
    rests: bool,
    /// Where the centre of a rigid body may go so that its box in the tree still holds it, however it turns.
    pub(super) room: Box32,
    /// Whether the centre was there when the box was chosen.
    pub(super) fits: bool,
    /// The centre of the mesh, rotated.
    offset: Point,
    /// The frame in which it moved last.
    pub(super) moved_at: u64,
    pub(super) place: CompactPlacement,
    /// No vertex moved further than this then; infinite where nobody asks.
    pub(super) motion: f64,
    pub(super) mesh: SharedMesh,
    pub(super) groups: u32,
    pub(super) mask: u32,
    pub(super) deforming: Option<Box<Deforming>>,
    /// The vertices that count; `None` for all.
    pub(super) counted: Option<Arc<[bool]>>,
}

impl State {
    pub(super) fn new(body: Body, generation: u32) -> Result<Self, Error> {
        let bounds = body.mesh.extent().posed(&body.placement);
        check(&body.mesh, &body.placement, &bounds)?;
        let deforming =
            (body.motion == Motion::Deforming).then(|| Box::new(Deforming::new(body.mesh.mesh(), body.ring)));
        let mut state = Self {
            generation,
            pending: NONE,
            kind: body.motion,
            is_small: body.mesh.extent().is_small(),
            is_turned: false,
            rests: false,
            room: Box32::EMPTY,
            fits: false,
            offset: [0.0; 3],
            moved_at: 0,
            place: (&body.placement).into(),
            motion: f64::INFINITY,
            mesh: body.mesh,
            groups: body.groups,
            mask: body.mask,
            deforming,
            counted: body.counted,
        };
        state.note_rotation();
        state.note_rest();
        Ok(state)
    }

    /// Refuses a placement that takes a vertex out of the range of numbers.
    #[inline]
    pub(super) fn check_placement(&self, placement: &Placement) -> Result<(), Error> {
        match self.is_small && is_small(&placement.translation()) {
            true => Ok(()),
            false => check(&self.mesh, placement, &self.mesh.extent().posed(placement)),
        }
    }

    /// Goes to a placement. Returns whether that is another one.
    #[inline]
    pub(super) fn go_to(&mut self, to: &CompactPlacement) -> bool {
        let (turns, shifts) = (self.place.turns_to(to), self.place.shifts_to(to));
        self.place = *to;
        if turns {
            self.note_rotation();
        }
        self.note_rest();
        turns | shifts
    }

    fn note_rotation(&mut self) {
        self.is_turned = self.place.is_turned();
        let centre = self.mesh.extent().centre();
        self.offset = match self.is_turned {
            true => self.place.rotate(centre),
            false => centre,
        };
    }

    #[inline]
    fn note_rest(&mut self) {
        self.rests = !self.is_turned && self.place.translation() == [0.0; 3];
    }

    /// Its placement. Cost: that of a matrix.
    pub(super) fn placement(&self) -> Placement {
        match self.is_turned {
            true => self.place.into(),
            false => Placement::IDENTITY.at(self.place.translation()),
        }
    }

    /// Where the centre of the ball around a rigid body lies.
    #[inline]
    pub(super) fn centre(&self) -> Point {
        let translation = self.place.translation();
        std::array::from_fn(|k| self.offset[k] + translation[k])
    }

    /// The box of the posed vertices, roundings included. Cost: constant.
    pub(super) fn bounds(&self) -> Aabb {
        let deforming = self.deforming.as_ref();
        let moved = deforming
            .and_then(|deforming| deforming.blocks())
            .and_then(BlockBounds::whole);
        moved.unwrap_or_else(|| self.mesh.extent().posed(&self.placement()))
    }

    /// What moved in frame `frame`, of the features of a kind.
    pub(super) fn moved(&self, frame: u64, kind: FeatureKind) -> Dirty {
        match &self.deforming {
            _ if self.moved_at != frame => Dirty::None,
            Some(deforming) if deforming.has_marks(kind) => Dirty::Marked,
            _ => Dirty::All,
        }
    }

    /// Whether so many vertices move one by one that a new grid beats a tree.
    pub(super) fn moved_share(&self, frame: u64) -> f64 {
        match &self.deforming {
            Some(deforming) if self.moved_at == frame => deforming.share,
            _ => 0.0,
        }
    }

    /// Sees to the tree over features of this kind. Those of rigid bodies are built when they are used, unless threads may help.
    pub(super) fn ensure_tree(&mut self, kind: FeatureKind, parallel: bool) -> Result<(), Error> {
        match &mut self.deforming {
            Some(deforming) => return deforming.ensure_tree(self.mesh.mesh(), kind, parallel),
            None if parallel => self.mesh.build_on_threads(kind),
            None => {}
        }
        Ok(())
    }

    /// The tree; `None` for a deforming body whose tree does not fit its vertices.
    pub(super) fn tree(&self, kind: FeatureKind) -> Option<&FeatureTree> {
        match &self.deforming {
            Some(deforming) => deforming.tree(kind),
            None => Some(self.mesh.tree(kind)),
        }
    }

    /// Where each vertex is before the placement.
    pub(super) fn vertices(&self) -> &[Point] {
        match &self.deforming {
            Some(deforming) => &deforming.vertices,
            None => self.mesh.mesh().vertices(),
        }
    }

    /// Whether the vertices are in the world as they are in the body.
    pub(super) fn is_unplaced(&self) -> bool {
        self.rests
    }

    /// The boxes of the vertices, block by block, where they are known.
    pub(super) fn blocks(&self) -> Option<&BlockBounds> {
        self.deforming.as_ref()?.blocks()
    }

    /// Where a feature is in the world.
    #[inline]
    pub(super) fn shape(&self, kind: FeatureKind, feature: u32) -> Shape {
        let (vertices, features) = (self.vertices(), self.mesh.mesh().features(kind));
        if self.rests {
            return features.shape(feature, |v| vertices[v as usize]);
        }
        let placement = self.placement();
        features.shape(feature, |v| placement.apply(vertices[v as usize]))
    }

    /// The vertices of a feature, the last repeated to make three.
    #[inline]
    pub(super) fn corners_of(&self, kind: FeatureKind, feature: u32) -> [u32; 3] {
        self.mesh.mesh().features(kind).corners(feature)
    }

    /// Whether a feature counts: whether all of its vertices do.
    pub(super) fn counts(&self, kind: FeatureKind, feature: u32) -> bool {
        let counted = self.counted.as_ref();
        counted.is_none_or(|counted| {
            self.corners_of(kind, feature)
                .iter()
                .all(|&v| counted[v as usize])
        })
    }

    /// How far no vertex of a rigid body is from where it is in another placement.
    pub(super) fn away_from(&self, placement: &Placement) -> f64 {
        let now = self.placement();
        match *placement == now {
            true => 0.0,
            false => self.mesh.extent().motion(placement, &now),
        }
    }

    /// No coordinate of a rigid body, before or after its placement, is larger.
    pub(super) fn extent(&self) -> f64 {
        let bounds = self.bounds();
        let [min, max] = [&bounds.min, &bounds.max].map(largest);
        self.mesh.extent().size() + min + max + largest(&self.place.translation())
    }

    /// How many features of a kind there are.
    pub(super) fn count(&self, kind: FeatureKind) -> usize {
        kind.count(self.mesh.mesh())
    }
}

/// Refuses a placement that takes a vertex out of the range of numbers.
fn check(mesh: &SharedMesh, placement: &Placement, bounds: &Aabb) -> Result<(), Error> {
    if bounds.min.iter().chain(&bounds.max).all(|c| c.is_finite()) {
        return Ok(());
    }
    for (vertex, &point) in mesh.mesh().vertices().iter().enumerate() {
        let posed = placement.apply(point);
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

//! A body inside a world: where it is, and what moved.

use std::ops::Deref;
use std::sync::Arc;

use super::SharedMesh;
use super::body::{Body, Motion};
use super::body_tree::BodyTree;
use super::deforming::Deforming;
use super::extent::largest;
use super::whereabouts::{Movement, Room, Rotations, Whereabouts};
use crate::broad::{BlockBounds, Box32, Dirty, FeatureTree};
use crate::mesh::{Point, all_finite};
use crate::placement::{CompactPlacement, rotate};
use crate::{Aabb, Error, FeatureKind, Placement, Shape};

/// A body in its world, besides its whereabouts: on one line of memory.
#[repr(align(64))]
pub(super) struct State {
    pub(super) mesh: SharedMesh,
    pub(super) kind: Motion,
    /// Whether the ball around a rigid body was in its box in the tree when the box was chosen.
    pub(super) fits: bool,
    /// The rotations of its places.
    rotations: Rotations,
    /// No vertex moved further than this in the frame in which it moved last; infinite where nobody asks.
    pub(super) motion: f64,
    pub(super) groups: u32,
    pub(super) mask: u32,
    pub(super) deforming: Option<Box<Deforming>>,
    /// The vertices that count; `None` for all.
    pub(super) counted: Option<Arc<[bool]>>,
}

impl State {
    pub(super) fn new(body: Body, generation: u32) -> Result<(Self, Whereabouts), Error> {
        let bounds = body.mesh.extent().posed(&body.placement);
        check(&body.mesh, &body.placement, &bounds)?;
        let deforming =
            (body.motion == Motion::Deforming).then(|| Box::new(Deforming::new(body.mesh.mesh(), body.ring)));
        let is_rigid = body.motion == Motion::Rigid;
        let mut whereabouts = Whereabouts::new(generation, is_rigid, body.mesh.extent().is_small());
        let mut rotations = Rotations::NONE;
        whereabouts.begin(&mut rotations, &body.placement);
        let state = Self {
            rotations,
            fits: false,
            kind: body.motion,
            motion: f64::INFINITY,
            mesh: body.mesh,
            groups: body.groups,
            mask: body.mask,
            deforming,
            counted: body.counted,
        };
        Ok((state, whereabouts))
    }

    /// Refuses a place that takes a vertex out of the range of numbers.
    #[cold]
    pub(super) fn check_place(
        &self,
        whereabouts: &Whereabouts,
        rotation: Option<&[f64; 4]>,
        translation: &Point,
    ) -> Result<(), Error> {
        let last = || self.last_placement(whereabouts).quaternion();
        let rotation = rotation.map_or_else(last, |rotation| *rotation);
        let unmoved = Placement::from(CompactPlacement::new(rotation, [0.0; 3]));
        let placement = unmoved.moved(*translation)?;
        check(&self.mesh, &placement, &self.mesh.extent().posed(&placement))
    }

    /// Turns the body in the next frame, if that is another rotation than the one given last.
    pub(super) fn turn(
        &mut self,
        whereabouts: &mut Whereabouts,
        rotation: &[f64; 4],
        frame: u64,
    ) -> Movement {
        match whereabouts.turns_to(&self.rotations, rotation) {
            true => whereabouts.turn(&mut self.rotations, rotation, frame),
            false => Movement::Rests,
        }
    }

    /// Where the translation may be so that the box `bounds` in the tree holds the ball around a rigid body, and `half` around it.
    pub(super) fn room(&self, whereabouts: &Whereabouts, tree: &BodyTree, bounds: &Box32, half: f64) -> Room {
        tree.room(bounds, self.mesh.extent(), &self.offset(whereabouts), half)
    }

    /// Whether that box holds this ball after the translation given last.
    #[inline]
    pub(super) fn stays(
        &self,
        whereabouts: &Whereabouts,
        tree: &BodyTree,
        bounds: &Box32,
        half: f64,
    ) -> bool {
        let (at, offset) = (whereabouts.next(), self.offset(whereabouts));
        let centre = std::array::from_fn(|k| at[k] + offset[k]);
        tree.holds_ball(bounds, self.mesh.extent(), &centre, half)
    }

    /// The centre of a rigid body, turned as it was given last, before the translation.
    #[inline]
    fn offset(&self, whereabouts: &Whereabouts) -> Point {
        let centre = self.mesh.extent().centre();
        let rotation = whereabouts.rotation(&self.rotations);
        rotation.map_or(centre, |rotation| rotate(*rotation, centre))
    }

    /// Bytes held elsewhere by a body that does not deform.
    pub(super) fn bytes(&self) -> usize {
        self.rotations.bytes()
    }

    /// The placement given last.
    pub(super) fn last_placement(&self, whereabouts: &Whereabouts) -> Placement {
        whereabouts.placement(&self.rotations, whereabouts.last())
    }

    /// The placement before that.
    pub(super) fn placement_before(&self, whereabouts: &Whereabouts) -> Placement {
        whereabouts.placement(&self.rotations, 1 - whereabouts.last())
    }

    /// Where the centre of a rigid body was before the place given last, and about how far its vertices move from there.
    pub(super) fn came_from(&self, whereabouts: &Whereabouts) -> (Point, f64) {
        let (extent, last) = (self.mesh.extent(), whereabouts.last());
        if whereabouts.is_upright(last) && whereabouts.is_upright(1 - last) {
            let [from, to] = [1 - last, last].map(|place| whereabouts.translation(place));
            let square: f64 = (0..3).map(|k| (to[k] - from[k]) * (to[k] - from[k])).sum();
            let centre = extent.centre();
            return (std::array::from_fn(|k| centre[k] + from[k]), square.sqrt());
        }
        let from = self.placement_before(whereabouts);
        (
            from.apply(extent.centre()),
            extent.motion(&from, &self.last_placement(whereabouts)),
        )
    }

    /// The body where it is in this frame.
    #[inline]
    pub(super) fn at<'a>(&'a self, whereabouts: &'a Whereabouts, frame: u64) -> Present<'a> {
        Present {
            state: self,
            whereabouts,
            place: whereabouts.present(frame),
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

    /// The boxes of the vertices, block by block, where they are known.
    pub(super) fn blocks(&self) -> Option<&BlockBounds> {
        self.deforming.as_ref()?.blocks()
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

    /// How many features of a kind there are.
    pub(super) fn count(&self, kind: FeatureKind) -> usize {
        kind.count(self.mesh.mesh())
    }
}

/// A body as it is in the present frame.
#[derive(Clone, Copy)]
pub(super) struct Present<'a> {
    state: &'a State,
    whereabouts: &'a Whereabouts,
    /// The number of the present place.
    place: usize,
}

impl Deref for Present<'_> {
    type Target = State;

    #[inline]
    fn deref(&self) -> &State {
        self.state
    }
}

impl<'a> Present<'a> {
    /// The body in any frame.
    pub(super) fn state(self) -> &'a State {
        self.state
    }

    pub(super) fn generation(&self) -> u32 {
        self.whereabouts.generation
    }

    /// The frame in which it moved last, or that in which it will move.
    pub(super) fn moved_at(&self) -> u64 {
        self.whereabouts.moved_at()
    }

    /// What moved in frame `frame`, of the features of a kind.
    pub(super) fn moved(&self, frame: u64, kind: FeatureKind) -> Dirty {
        match &self.deforming {
            _ if self.moved_at() != frame => Dirty::None,
            Some(deforming) if deforming.has_marks(kind) => Dirty::Marked,
            _ => Dirty::All,
        }
    }

    /// Whether so many vertices move one by one that a new grid beats a tree.
    pub(super) fn moved_share(&self, frame: u64) -> f64 {
        match &self.deforming {
            Some(deforming) if self.moved_at() == frame => deforming.share,
            _ => 0.0,
        }
    }

    /// Its placement. Cost: that of a matrix, if it turns.
    pub(super) fn placement(&self) -> Placement {
        self.whereabouts.placement(&self.rotations, self.place)
    }

    fn translation(&self) -> Point {
        self.whereabouts.translation(self.place)
    }

    /// The box of the posed vertices, roundings included. Cost: constant.
    pub(super) fn bounds(&self) -> Aabb {
        let deforming = self.deforming.as_ref();
        let moved = deforming
            .and_then(|deforming| deforming.blocks())
            .and_then(BlockBounds::whole);
        moved.unwrap_or_else(|| match self.whereabouts.is_upright(self.place) {
            true => self.mesh.extent().moved(&self.translation()),
            false => self.mesh.extent().posed(&self.placement()),
        })
    }

    /// Whether the vertices are in the world as they are in the body.
    pub(super) fn is_unplaced(&self) -> bool {
        self.whereabouts.is_upright(self.place) && self.translation() == [0.0; 3]
    }

    /// Where a feature is in the world.
    #[inline]
    pub(super) fn shape(&self, kind: FeatureKind, feature: u32) -> Shape {
        let (vertices, features) = (self.vertices(), self.mesh.mesh().features(kind));
        if self.is_unplaced() {
            return features.shape(feature, |v| vertices[v as usize]);
        }
        let placement = self.placement();
        features.shape(feature, |v| placement.apply(vertices[v as usize]))
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
        self.mesh.extent().size() + min + max + largest(&self.translation())
    }
}

/// Refuses a placement that takes a vertex out of the range of numbers.
fn check(mesh: &SharedMesh, placement: &Placement, bounds: &Aabb) -> Result<(), Error> {
    if bounds.min.iter().chain(&bounds.max).all(|c| c.is_finite()) {
        return Ok(());
    }
    all_finite(mesh.mesh().vertices().iter().map(|&point| placement.apply(point)))
}

//! What a scene is made of: a mesh, how it may move, and with what it may collide.

use crate::{Mesh, Placement};

/// How a body may move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// Never.
    Fixed,
    /// By its placement; its self-pairs never change and are not looked at.
    Rigid,
    /// Vertex by vertex; only such a body collides with itself.
    Deforming,
}

/// A body before it enters a scene.
pub struct Body {
    pub(super) mesh: Mesh,
    pub(super) motion: Motion,
    pub(super) placement: Placement,
    pub(super) groups: u32,
    pub(super) mask: u32,
    pub(super) ring: Option<usize>,
    pub(super) kept: Option<Vec<bool>>,
}

impl Body {
    fn new(mesh: Mesh, motion: Motion) -> Self {
        let ring = (motion == Motion::Deforming).then_some(0);
        Self {
            mesh,
            motion,
            placement: Placement::IDENTITY,
            groups: 1,
            mask: u32::MAX,
            ring,
            kept: None,
        }
    }

    /// A body that stays where it is.
    #[must_use]
    pub fn fixed(mesh: Mesh) -> Self {
        Self::new(mesh, Motion::Fixed)
    }

    /// A body that moves as a whole.
    #[must_use]
    pub fn rigid(mesh: Mesh) -> Self {
        Self::new(mesh, Motion::Rigid)
    }

    /// A body whose vertices move one by one. It collides with itself, features that share a vertex excepted.
    #[must_use]
    pub fn deforming(mesh: Mesh) -> Self {
        Self::new(mesh, Motion::Deforming)
    }

    /// Where a fixed or rigid body is at first. Default: where its mesh is. The vertices of a deforming body say themselves
    /// where they are, so that it has no placement and this is without effect.
    #[must_use]
    pub fn at(mut self, placement: Placement) -> Self {
        if self.motion != Motion::Deforming {
            self.placement = placement;
        }
        self
    }

    /// Two bodies collide if each one's `mask` has a bit of the other's `groups`. Default: group 1, mask all ones.
    #[must_use]
    pub fn in_groups(mut self, groups: u32, mask: u32) -> Self {
        self.groups = groups;
        self.mask = mask;
        self
    }

    /// Self-pairs count only if no vertex of one feature lies within `width` edges of a vertex of the other; 0 excludes
    /// features that share a vertex.
    #[must_use]
    pub fn beyond_ring(mut self, width: usize) -> Self {
        if self.ring.is_some() {
            self.ring = Some(width);
        }
        self
    }

    /// No self-collision.
    #[must_use]
    pub fn without_self_collision(mut self) -> Self {
        self.ring = None;
        self
    }

    /// Only features all of whose vertices satisfy the predicate count.
    #[must_use]
    pub fn with_vertices(mut self, predicate: impl Fn(u32) -> bool) -> Self {
        self.kept = Some((0..self.mesh.vertices().len() as u32).map(predicate).collect());
        self
    }
}

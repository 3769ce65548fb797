//! What a world is made of: a mesh, how it may move, and with what it may collide.

use std::fmt;
use std::sync::Arc;

use super::SharedMesh;
use crate::Placement;

/// A handle of a body in its world. It stays valid until the body is removed, whatever else is added or removed; a handle of a
/// removed body is refused, even if its place has been given to another body.
///
/// It does not know its world: in another world it means the body of the same index there, and is not refused. Keep the handles of
/// each world apart.
///
/// Ordered by index, then by generation.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BodyId {
    pub(super) slot: u32,
    pub(super) generation: u32,
}

impl BodyId {
    /// The handle that the call number `index` of [`World::add`](super::World::add), counted from 0, returns in a world from
    /// which no body has been removed.
    #[must_use]
    pub const fn nth(index: u32) -> Self {
        Self {
            slot: index,
            generation: 0,
        }
    }

    /// The place of the body in its world: 0, 1, 2, … in the order of addition. The place of a removed body is given to
    /// another one.
    #[must_use]
    pub const fn index(self) -> usize {
        self.slot as usize
    }
}

impl fmt::Debug for BodyId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// The index; after a removal with the generation: `3`, `3.1`.
impl fmt::Display for BodyId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.generation {
            0 => write!(f, "{}", self.slot),
            generation => write!(f, "{}.{generation}", self.slot),
        }
    }
}

/// How a body may move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// Never.
    Fixed,
    /// As a whole, by its placement. It does not collide with itself.
    Rigid,
    /// Vertex by vertex. Only such a body collides with itself.
    Deforming,
}

/// A body before it enters a world.
///
/// ```
/// use satisfice_collision::scene::Body;
/// use satisfice_collision::{Placement, generate};
/// let ball = Body::rigid(generate::icosphere(0.5, 1)?)
///     .at(Placement::from_translation([0.0, 0.0, 2.0])?)
///     .in_groups(0b01, 0b10);
/// let cloth = Body::deforming(generate::cloth(1.0, 1.0, 10, 10)?).beyond_ring(1);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
///
/// Cloning is cheap: the copy shares the mesh.
#[derive(Clone)]
pub struct Body {
    pub(super) mesh: SharedMesh,
    pub(super) motion: Motion,
    pub(super) placement: Placement,
    pub(super) groups: u32,
    pub(super) mask: u32,
    pub(super) ring: Option<usize>,
    pub(super) counted: Option<Arc<[bool]>>,
}

impl Body {
    fn new(mesh: SharedMesh, motion: Motion) -> Self {
        let ring = (motion == Motion::Deforming).then_some(0);
        Self {
            mesh,
            motion,
            placement: Placement::IDENTITY,
            groups: 1,
            mask: u32::MAX,
            ring,
            counted: None,
        }
    }

    /// A body that never moves.
    #[must_use]
    pub fn fixed(mesh: impl Into<SharedMesh>) -> Self {
        Self::new(mesh.into(), Motion::Fixed)
    }

    /// A body that moves as a whole.
    #[must_use]
    pub fn rigid(mesh: impl Into<SharedMesh>) -> Self {
        Self::new(mesh.into(), Motion::Rigid)
    }

    /// A body whose vertices move one by one. It collides with itself, except for features that share a vertex.
    #[must_use]
    pub fn deforming(mesh: impl Into<SharedMesh>) -> Self {
        Self::new(mesh.into(), Motion::Deforming)
    }

    /// The first placement of a fixed or rigid body. Default: the identity. Deforming bodies have no placement and ignore it.
    #[must_use]
    pub fn at(mut self, placement: Placement) -> Self {
        if self.motion != Motion::Deforming {
            self.placement = placement;
        }
        self
    }

    /// Two bodies collide if the `mask` of each has a bit of the other's `groups`. Default: group 1, mask all ones.
    #[must_use]
    pub fn in_groups(mut self, groups: u32, mask: u32) -> Self {
        self.groups = groups;
        self.mask = mask;
        self
    }

    /// Self-pairs count only if no vertex of one feature lies within `width` edges of a vertex of the other. Default: 0, which
    /// excludes features that share a vertex.
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

    /// Only features all of whose vertices satisfy the predicate count. Default: all of them.
    #[must_use]
    pub fn with_vertices(mut self, predicate: impl Fn(u32) -> bool) -> Self {
        let vertices = self.mesh.mesh().vertices().len() as u32;
        self.counted = Some((0..vertices).map(predicate).collect());
        self
    }
}

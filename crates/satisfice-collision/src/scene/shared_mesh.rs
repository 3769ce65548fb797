//! A mesh, its box and its trees, shared by the bodies that are copies of it.

use std::sync::{Arc, OnceLock};

use super::extent::Extent;
use crate::broad::FeatureTree;
use crate::{FeatureKind, Mesh};

/// A mesh that any number of bodies can share: it and its trees are kept once, whatever the number of copies.
///
/// Cloning is cheap and gives the same mesh. A tree over a kind of feature is built when a query first needs it.
///
/// ```
/// use satisfice_collision::distance::{PairKind, Threshold};
/// use satisfice_collision::scene::{Body, SharedMesh, World};
/// use satisfice_collision::{Placement, generate};
/// let ball = SharedMesh::from(generate::icosphere(0.5, 1)?);
/// let mut world = World::new(PairKind::TriangleTriangle, Threshold::new(0.01)?);
/// for x in 0..100 {
///     let at = Placement::from_translation([f64::from(x), 0.0, 0.0])?;
///     world.add(Body::rigid(ball.clone()).at(at))?;
/// }
/// assert_eq!(world.len(), 100);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct SharedMesh(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    mesh: Mesh,
    extent: Extent,
    trees: [OnceLock<FeatureTree>; 3],
}

impl SharedMesh {
    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.0.mesh
    }

    /// Whether both are the same mesh and share their trees.
    #[must_use]
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// The box of the vertices.
    pub(super) fn extent(&self) -> &Extent {
        &self.0.extent
    }

    /// The tree over features of this kind, built at the first call.
    pub(super) fn tree(&self, kind: FeatureKind) -> &FeatureTree {
        self.0.trees[kind as usize].get_or_init(|| FeatureTree::new(&self.0.mesh, kind))
    }

    /// Builds the tree on the current rayon pool, unless there is one.
    pub(super) fn build_on_threads(&self, kind: FeatureKind) {
        let slot = &self.0.trees[kind as usize];
        if slot.get().is_none() {
            // no lock is held: a thread that waits for its share may take up work that needs the same tree
            let _ = slot.set(FeatureTree::parallel(&self.0.mesh, kind));
        }
    }

    /// Whether the tree exists or several bodies would share it, so that building it pays at once.
    pub(super) fn pays_for_tree(&self, kind: FeatureKind) -> bool {
        self.0.trees[kind as usize].get().is_some() || Arc::strong_count(&self.0) > 2
    }
}

impl From<Mesh> for SharedMesh {
    fn from(mesh: Mesh) -> Self {
        Self(Arc::new(Inner {
            extent: Extent::new(&mesh),
            mesh,
            trees: Default::default(),
        }))
    }
}

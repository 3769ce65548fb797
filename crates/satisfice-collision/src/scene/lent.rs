//! What is taken out of a world while a callback of the caller's may run, and goes back even if that panics.

use super::World;
use super::body_tree::BodyTree;
use super::narrow::Workspace;

/// A world without its tree of bodies, which goes back when this is dropped.
struct WithoutTree<'w> {
    world: &'w mut World,
    tree: BodyTree,
}

impl Drop for WithoutTree<'_> {
    fn drop(&mut self) {
        self.world.tree = std::mem::take(&mut self.tree);
    }
}

/// A world without the records to examine, which go back when this is dropped.
pub(super) struct WithoutDirty<'w> {
    pub(super) world: &'w mut World,
    /// Each once.
    pub(super) dirty: Vec<u32>,
    /// So many of them, the first ones, are current.
    pub(super) done: usize,
    /// Whether no callback panicked.
    pub(super) is_over: bool,
}

impl Drop for WithoutDirty<'_> {
    fn drop(&mut self) {
        self.world.dirty = std::mem::take(&mut self.dirty);
        if self.is_over {
            self.world.dirty.drain(..self.done);
            return;
        }
        // some may be current, others have contacts; and what was taken to work with is lost
        self.world.has_removed_dirty = true;
        self.world.has_known_dirty = true;
        self.world.workspaces = vec![Workspace::new(self.world.parallel)];
    }
}

impl World {
    /// Asks the tree something and changes the world meanwhile. The world has no tree then.
    pub(super) fn with_tree<R>(&mut self, ask: impl FnOnce(&BodyTree, &mut Self) -> R) -> R {
        let tree = std::mem::take(&mut self.tree);
        let lent = &mut WithoutTree { world: self, tree };
        ask(&lent.tree, lent.world)
    }

    /// Takes out the records to examine.
    pub(super) fn without_dirty(&mut self) -> WithoutDirty<'_> {
        WithoutDirty {
            dirty: self.take_dirty(),
            world: self,
            done: 0,
            is_over: false,
        }
    }
}

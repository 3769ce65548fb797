//! The vertices of a deforming body, which of them moved, and its own trees.

use crate::broad::{BlockBounds, FeatureTree};
use crate::distance::Point;
use crate::{Adjacency, Error, FeatureKind, Mesh};

/// How the vertices move to the next frame.
#[derive(Default, Clone, Copy)]
struct Displacement {
    /// The number of vertices that move.
    count: usize,
    /// The square of the longest motion.
    square: f64,
}

impl Displacement {
    fn between(old: &[Point], new: &[Point]) -> Self {
        let mut step = Self::default();
        for (old, new) in old.iter().zip(new) {
            let [x, y, z] = [new[0] - old[0], new[1] - old[1], new[2] - old[2]];
            let square = x * x + y * y + z * z;
            step.count += usize::from((x != 0.0) | (y != 0.0) | (z != 0.0));
            step.square = if square > step.square { square } else { step.square };
        }
        step
    }
}

/// A tree and the versions of the vertices that it was fitted to.
struct KeptTree {
    tree: FeatureTree,
    /// The versions of the last two fits. The tree marks the features that moved between them.
    version: u64,
    from: Option<u64>,
}

/// The part of a body that only deforming bodies have.
pub(super) struct Deforming {
    pub(super) vertices: Vec<Point>,
    /// Counts the frames in which a vertex moved.
    version: u64,
    next: Vec<Point>,
    step: Displacement,
    /// The boxes of the vertices, block by block, if they have been measured.
    blocks: Option<BlockBounds>,
    /// Those of the next vertices, and room to measure others that may be refused.
    next_blocks: [BlockBounds; 2],
    trees: [Option<KeptTree>; 3],
    /// Share of the vertices that moved last.
    pub(super) share: f64,
    /// The number of rebuilds of degraded trees in a row.
    pub(super) rebuilds: u32,
    /// Vertices within the excluded ring of each vertex.
    pub(super) rings: Option<Adjacency>,
    /// The excluded width; `None` for a body that does not collide with itself.
    pub(super) ring: Option<usize>,
}

impl Deforming {
    pub(super) fn new(mesh: &Mesh, ring: Option<usize>) -> Self {
        let rings = ring
            .filter(|&width| width > 0)
            .map(|width| mesh.adjacency().rings(width));
        Self {
            vertices: mesh.vertices().to_vec(),
            version: 0,
            next: Vec::new(),
            step: Displacement::default(),
            blocks: None,
            next_blocks: Default::default(),
            trees: [const { None }; 3],
            share: 1.0,
            rebuilds: 0,
            rings,
            ring,
        }
    }

    /// Whether the body collides with itself, if it is not excluded.
    pub(super) fn collides_with_itself(&self) -> bool {
        self.ring.is_some()
    }

    /// Stores the vertices of the next frame.
    pub(super) fn deform(&mut self, vertices: &[Point]) -> Result<(), Error> {
        if vertices.len() != self.vertices.len() {
            return Err(Error::parameter(
                "number of vertices",
                vertices.len(),
                "a frame has as many vertices as its body",
            ));
        }
        let [next, room] = &mut self.next_blocks;
        room.measure(vertices, 1)?;
        std::mem::swap(next, room);
        self.next.clear();
        self.next.extend_from_slice(vertices);
        self.step = Displacement::between(&self.vertices, vertices);
        Ok(())
    }

    /// Goes to the next frame. Returns a bound on the motion of all vertices, or `None` if none moves.
    pub(super) fn advance(&mut self) -> Option<f64> {
        let [next, _] = &mut self.next_blocks;
        std::mem::swap(self.blocks.get_or_insert_default(), next);
        if self.step.count == 0 {
            return None;
        }
        std::mem::swap(&mut self.vertices, &mut self.next);
        self.version += 1;
        self.share = self.step.count as f64 / self.vertices.len() as f64;
        // rounded up; squares that underflow belong to motions below 1e-153
        Some(self.step.square.sqrt() * (1.0 + 1e-12) + 1e-153)
    }

    /// The boxes of the vertices, if they are known.
    pub(super) fn blocks(&self) -> Option<&BlockBounds> {
        self.blocks.as_ref()
    }

    /// Builds the tree over features of this kind, or refits it if the vertices have moved since; rebuilds it if it has
    /// degraded.
    pub(super) fn ensure_tree(
        &mut self,
        mesh: &Mesh,
        kind: FeatureKind,
        parallel: bool,
    ) -> Result<(), Error> {
        let slot = &mut self.trees[kind as usize];
        if let Some(kept) = slot {
            if kept.version == self.version {
                return Ok(());
            }
            kept.tree.refit(&self.vertices)?;
            (kept.from, kept.version) = (Some(kept.version), self.version);
            if !kept.tree.is_degraded() {
                self.rebuilds = 0;
                return Ok(());
            }
            self.rebuilds += 1;
        }
        let mesh = mesh.with_vertices(self.vertices.clone())?;
        *slot = Some(KeptTree {
            tree: match parallel {
                true => FeatureTree::parallel(&mesh, kind),
                false => FeatureTree::new(&mesh, kind),
            },
            version: self.version,
            from: None,
        });
        Ok(())
    }

    /// The tree, if it fits the vertices.
    pub(super) fn tree(&self, kind: FeatureKind) -> Option<&FeatureTree> {
        let kept = self.trees[kind as usize].as_ref();
        kept.filter(|kept| kept.version == self.version)
            .map(|kept| &kept.tree)
    }

    /// Whether only a part moved in the last frame in which anything did, and the marks of the tree say which.
    pub(super) fn has_marks(&self, kind: FeatureKind) -> bool {
        let kept = self.trees[kind as usize].as_ref().filter(|_| self.share < 1.0);
        kept.is_some_and(|kept| {
            kept.version == self.version && kept.from.is_some_and(|from| from + 1 == self.version)
        })
    }
}

//! parry3d's `Bvh` over the boxes of the bodies.

use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};

/// By how much kept boxes are wider, as rapier3d has it for bodies of this size.
const MARGIN: f32 = 0.02;

/// The box of a body, inflated by half the threshold.
pub(crate) fn bounds(centre: [f64; 3], radius: f64) -> Aabb {
    let centre = centre.map(|c| c as f32);
    let (centre, by) = (
        Vector::new(centre[0], centre[1], centre[2]),
        Vector::splat(radius as f32 + 0.005),
    );
    Aabb::new(centre - by, centre + by)
}

/// A new tree and its pairs.
pub(crate) fn anew(boxes: &[Aabb]) -> usize {
    let tree = Bvh::from_iter(BvhBuildStrategy::Binned, boxes.iter().copied().enumerate());
    let mut pairs = 0;
    tree.traverse_bvtt_single_tree::<false>(&mut BvhWorkspace::default(), &mut |_, _| pairs += 1);
    pairs
}

/// A tree that follows the motion.
pub(crate) struct Kept {
    tree: Bvh,
    workspace: BvhWorkspace,
}

impl Kept {
    pub(crate) fn new(boxes: &[Aabb]) -> Self {
        let mut kept = Self {
            tree: Bvh::from_iter(BvhBuildStrategy::Binned, boxes.iter().copied().enumerate()),
            workspace: BvhWorkspace::default(),
        };
        kept.tree.refit(&mut kept.workspace);
        kept
    }

    /// Moves some boxes; the pairs of which one left its box.
    pub(crate) fn follow(&mut self, boxes: &[Aabb], moved: &[usize]) -> usize {
        if moved.is_empty() {
            return 0;
        }
        for &body in moved {
            self.tree
                .insert_or_update_partially(boxes[body], body as u32, MARGIN);
        }
        self.tree.refit(&mut self.workspace);
        self.tree.optimize_incremental(&mut self.workspace);
        let mut pairs = 0;
        let visit = &mut |_, _| pairs += 1;
        self.tree
            .traverse_bvtt_single_tree::<true>(&mut self.workspace, visit);
        pairs
    }
}

//! parry3d's `Bvh` over the boxes of the bodies, and a table of the pairs, as rapier3d's broad phase keeps them.

use foldhash::fast::FixedState;
use hashbrown::HashMap;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math::{Pose, Rotation, Vector};
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

/// A body at a place, turned by this angle, as parry3d has it.
pub(crate) fn pose(centre: [f64; 3], angle: f64) -> Pose {
    let [x, y, z] = centre.map(|c| c as f32);
    Pose::from_parts(Vector::new(x, y, z), Rotation::from_rotation_z(angle as f32))
}

/// The box of a body at rest, as a mesh keeps it.
pub(crate) fn local(radius: f64) -> Aabb {
    let side = Vector::splat(radius as f32);
    Aabb::new(-side, side)
}

/// The boxes of the bodies that move, from where they are, inflated by half the threshold.
pub(crate) fn posed(local: impl Fn(usize) -> Aabb, poses: &[Pose], moved: &[usize], boxes: &mut [Aabb]) {
    for &body in moved {
        boxes[body] = local(body).transform_by(&poses[body]).loosened(0.005);
    }
}

/// A new tree and its pairs.
pub(crate) fn anew(boxes: &[Aabb]) -> usize {
    let tree = Bvh::from_iter(BvhBuildStrategy::Binned, boxes.iter().copied().enumerate());
    let mut pairs = 0;
    tree.traverse_bvtt_single_tree::<false>(&mut BvhWorkspace::default(), &mut |_, _| pairs += 1);
    pairs
}

/// A tree that follows the motion, and the pairs of bodies whose boxes meet with the frame in which they were last seen.
pub(crate) struct Kept {
    tree: Bvh,
    workspace: BvhWorkspace,
    pairs: HashMap<(u32, u32), u32, FixedState>,
    frame: u32,
}

impl Kept {
    pub(crate) fn new(boxes: &[Aabb]) -> Self {
        let mut kept = Self {
            tree: Bvh::from_iter(BvhBuildStrategy::Binned, boxes.iter().copied().enumerate()),
            workspace: BvhWorkspace::default(),
            pairs: HashMap::default(),
            frame: 0,
        };
        kept.tree.refit(&mut kept.workspace);
        let pairs = &mut kept.pairs;
        let visit = &mut |a: u32, b: u32| {
            pairs.insert((a.min(b), a.max(b)), 0);
        };
        kept.tree
            .traverse_bvtt_single_tree::<false>(&mut kept.workspace, visit);
        kept
    }

    /// Moves some boxes. Returns how many pairs began or ended.
    pub(crate) fn follow(&mut self, boxes: &[Aabb], moved: &[usize]) -> usize {
        if moved.is_empty() {
            return 0;
        }
        self.frame += 1;
        for &body in moved {
            self.tree
                .insert_or_update_partially(boxes[body], body as u32, MARGIN);
        }
        self.tree.optimize_incremental(&mut self.workspace);
        self.tree.refit(&mut self.workspace);
        let (pairs, frame, mut events) = (&mut self.pairs, self.frame, 0);
        let visit = &mut |a: u32, b: u32| {
            events += usize::from(pairs.insert((a.min(b), a.max(b)), frame).is_none());
        };
        self.tree
            .traverse_bvtt_single_tree::<true>(&mut self.workspace, visit);
        let tree = &self.tree;
        self.pairs.retain(|&(a, b), seen| {
            let (Some(one), Some(two)) = (tree.leaf_node(a), tree.leaf_node(b)) else {
                return false;
            };
            let ended = *seen != frame && (one.is_changed() || two.is_changed()) && !one.intersects(two);
            events += usize::from(ended);
            !ended
        });
        events
    }
}

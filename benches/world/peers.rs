//! parry3d's `Bvh` over the boxes of the bodies and over the triangles of a mesh, and a table of the pairs, as rapier3d's broad phase keeps them.

use foldhash::fast::FixedState;
use hashbrown::HashMap;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math::{Pose, Rotation, Vector};
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhNode, BvhWorkspace};
use parry3d::shape::{Shape, Triangle};
use satisfice_collision::Mesh;

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
    let mut pairs = 0;
    each_pair(boxes, &mut |_, _| pairs += 1);
    pairs
}

/// The same as a list.
pub(crate) fn pairs(boxes: &[Aabb]) -> Vec<(u32, u32)> {
    let mut pairs = Vec::new();
    each_pair(boxes, &mut |a, b| pairs.push((a, b)));
    pairs
}

fn each_pair(boxes: &[Aabb], visit: &mut impl FnMut(u32, u32)) {
    let tree = Bvh::from_iter(BvhBuildStrategy::Binned, boxes.iter().copied().enumerate());
    tree.traverse_bvtt_single_tree::<false>(&mut BvhWorkspace::default(), visit);
}

/// The triangles of a mesh and a tree over them.
pub(crate) struct Triangles {
    shapes: Vec<Triangle>,
    tree: Bvh,
}

impl Triangles {
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let corner = |p: [f64; 3]| Vector::new(p[0] as f32, p[1] as f32, p[2] as f32);
        let shape = |t: usize| {
            let [p, q, r] = mesh.triangle(t).map(corner);
            Triangle::new(p, q, r)
        };
        let shapes: Vec<Triangle> = (0..mesh.triangles().len()).map(shape).collect();
        let boxes = shapes.iter().map(|t| t.compute_aabb(&Pose::IDENTITY));
        let tree = Bvh::from_iter(BvhBuildStrategy::Binned, boxes.enumerate());
        Self { shapes, tree }
    }

    /// How many pairs of triangles are closer than `delta`, where the other body is `apart` from here.
    pub(crate) fn near(&self, other: &Self, apart: [f64; 3], delta: f32) -> usize {
        let [x, y, z] = apart.map(|c| c as f32);
        let apart = Vector::new(x, y, z);
        let (here, there) = (Pose::IDENTITY, Pose::from_parts(apart, Rotation::IDENTITY));
        let margin = Vector::splat(delta);
        let meet = |a: &BvhNode, b: &BvhNode| {
            let (low, high) = (b.mins() + apart - margin, b.maxs() + apart + margin);
            a.mins().cmple(high).all() && a.maxs().cmpge(low).all()
        };
        let within = |&(i, j): &(u32, u32)| {
            let (p, q) = (&self.shapes[i as usize], &other.shapes[j as usize]);
            let distance = parry3d::query::distance(&here, p, &there, q);
            distance.expect("two triangles").distance < delta
        };
        self.tree.leaf_pairs(&other.tree, meet).filter(within).count()
    }
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

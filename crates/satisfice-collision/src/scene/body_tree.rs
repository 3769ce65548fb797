//! Which bodies can be near each other: a tree over the boxes of bodies, eight children to a node, that changes in place.
//!
//! An R-tree (Guttman 1984, doi 10.1145/602259.602266) of `f32` boxes relative to a local origin. Every coordinate is rounded
//! outwards, so that boxes that overlap in `f64` overlap here; the converse is left to the caller. All leaves have the same
//! depth. A new body goes down to the child that grows least, and a full node is split along its longest axis. Rebuilding
//! orders the bodies as [`BoxTree`](crate::broad) does and fills every node.

mod begun;
mod follow;
mod node;
#[cfg(test)]
mod tests;
mod visits;

pub(super) use begun::Meeting;
pub(super) use follow::Change;

use super::extent::{Extent, largest};
use super::whereabouts::Room;
use crate::Aabb;
use crate::broad::{Box32, Core, exponent, order_by_median, power_of_two};
use begun::Search;
use node::{NONE, Node, at_lane, lane_in, lanes, node_of};

impl Box32 {
    /// Whether two boxes share a point.
    pub(super) fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|k| self.min[k] <= other.max[k] && other.min[k] <= self.max[k])
    }

    /// A box rounded outwards: by the step in which the conversion rounds, or two. It is finite; what lies beyond the range of `f32`
    /// lies on its end.
    #[inline(always)]
    pub(super) fn outside(min: &[f64; 3], max: &[f64; 3]) -> Self {
        let mut bounds = Self::EMPTY;
        for k in 0..3 {
            let low = (min[k] as f32).clamp(f32::MIN, f32::MAX);
            let high = (max[k] as f32).clamp(f32::MIN, f32::MAX);
            let step = |x: f32| x.abs() * f32::EPSILON + f32::from_bits(1);
            bounds.min[k] = (low - step(low)).max(f32::MIN);
            bounds.max[k] = (high + step(high)).min(f32::MAX);
        }
        bounds
    }

    /// A box rounded inwards, by as much; of what lies beyond the range of `f32` only what is in it. It may be empty.
    #[inline(always)]
    pub(super) fn inside(min: &[f64; 3], max: &[f64; 3]) -> Self {
        let mut bounds = Self::EMPTY;
        for k in 0..3 {
            // what is no number stays so: nothing is in the box
            let low = if min[k] < f64::from(f32::MIN) {
                f32::MIN
            } else {
                min[k] as f32
            };
            let high = if max[k] > f64::from(f32::MAX) {
                f32::MAX
            } else {
                max[k] as f32
            };
            let step = |x: f32| x.abs() * f32::EPSILON + f32::from_bits(1);
            bounds.min[k] = low + step(low);
            bounds.max[k] = high - step(high);
        }
        bounds
    }

    /// Whether it is the empty box.
    pub(super) fn is_empty(&self) -> bool {
        self.min[0] > self.max[0]
    }

    /// The bits of the squared distance of two boxes, which are ordered as the numbers are; 0 where there is none.
    fn gap(&self, other: &Self) -> u32 {
        let side = |k: usize| {
            (other.min[k] - self.max[k])
                .max(self.min[k] - other.max[k])
                .max(0.0)
        };
        let square: f32 = (0..3).map(|k| side(k) * side(k)).sum();
        if square.is_finite() { square.to_bits() } else { 0 }
    }
}

/// Coordinates in the tree count from the origin, in this unit, which is one divided by the scale.
pub(super) struct TreeFrame {
    pub(super) origin: [f64; 3],
    pub(super) scale: f64,
    pub(super) unit: f64,
}

impl Default for TreeFrame {
    fn default() -> Self {
        Self::new([0.0; 3], 1.0)
    }
}

impl TreeFrame {
    /// The scale is a power of two.
    fn new(origin: [f64; 3], scale: f64) -> Self {
        Self {
            origin,
            scale,
            unit: 1.0 / scale,
        }
    }
}

/// What the tree knows of a body, on half a line of memory.
#[derive(Clone, Copy)]
#[repr(C, align(32))]
struct BodyLeaf {
    /// Its box; the empty one if it is not in the tree.
    bounds: Box32,
    /// Its place in its node, or [`NONE`].
    place: u32,
    /// Its number among the changes of the last search; out of date if it was not among them.
    number: u32,
}

impl BodyLeaf {
    const NONE: Self = Self {
        bounds: Box32::EMPTY,
        place: NONE,
        number: 0,
    };
}

/// The tree. Bodies are named by their slots.
#[derive(Default)]
pub(super) struct BodyTree {
    nodes: Vec<Node>,
    free: Vec<u32>,
    root: Option<u32>,
    /// By slot.
    leaves: Vec<BodyLeaf>,
    frame: TreeFrame,
    bodies: usize,
    /// Bodies put elsewhere since the tree was built.
    moves: usize,
    /// Nodes with a changed box, leaves first.
    changed: Vec<u32>,
    search: Search,
}

impl BodyTree {
    /// Whether a body is in the tree.
    pub(super) fn contains(&self, body: u32) -> bool {
        self.place_of(body).is_some()
    }

    /// The place of a body in its leaf.
    fn place_of(&self, body: u32) -> Option<u32> {
        let place = self.leaves.get(body as usize)?.place;
        (place != NONE).then_some(place)
    }

    /// The box of a body in the tree; the empty one for a body that is not there.
    #[inline]
    pub(super) fn box_of(&self, body: u32) -> Box32 {
        self.leaves
            .get(body as usize)
            .map_or(Box32::EMPTY, |leaf| leaf.bounds)
    }

    fn box_at(&self, place: u32) -> Box32 {
        self.nodes[node_of(place) as usize].lane_box(lane_in(place))
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
            + (self.free.capacity() + self.changed.capacity()) * 4
            + self.leaves.capacity() * size_of::<BodyLeaf>()
            + self.search.bytes()
    }

    /// Rebuilds the tree over these boxes, in a frame around them; all of them have changed. Cost: O(n log n).
    pub(super) fn build(&mut self, boxes: &[(u32, Aabb)]) {
        self.choose_frame(boxes);
        let placed = boxes.iter().map(|(body, bounds)| (*body, self.place(bounds)));
        self.arrange(&placed.collect::<Vec<_>>());
        self.mark_all();
    }

    /// Rebuilds the tree over these boxes.
    fn arrange(&mut self, boxes: &[(u32, Box32)]) {
        self.nodes.clear();
        self.free.clear();
        self.leaves.fill(BodyLeaf::NONE);
        self.changed.clear();
        (self.root, self.bodies, self.moves) = (None, boxes.len(), 0);
        if let Some(last) = boxes.iter().map(|&(body, _)| body).max() {
            self.make_room_for(last);
        }
        for (body, bounds) in boxes {
            self.leaves[*body as usize].bounds = *bounds;
        }
        let order = order_by_median(boxes.iter().map(|(_, bounds)| bounds.twice_centre()), false);
        let mut below: Vec<(u32, Box32)> = order.iter().map(|&at| boxes[at as usize]).collect();
        let mut level = 0;
        while self.root.is_none() && !below.is_empty() {
            let mut above = Vec::with_capacity(below.len().div_ceil(8));
            for children in below.chunks(8) {
                let id = self.nodes.len() as u32;
                let mut node = Node::empty(level);
                for (lane, (child, bounds)) in children.iter().enumerate() {
                    node.set(lane, *child, bounds);
                    self.adopt(*child, level, at_lane(id, lane));
                }
                let bounds = node.bounds();
                above.push((id, bounds));
                super::push(&mut self.nodes, node);
            }
            if above.len() == 1 {
                self.root = Some(above[0].0);
            }
            below = above;
            level += 1;
        }
    }

    /// Coordinates count from the middle of all boxes, in a unit in which `f32` overflows last; if few boxes are far away, from the
    /// middle of the others, near which `f32` is finest.
    fn choose_frame(&mut self, boxes: &[(u32, Aabb)]) {
        let mut all = boxes.iter().map(|(_, bounds)| bounds);
        let Some(first) = all.next() else {
            self.frame = TreeFrame::default();
            return;
        };
        let whole = all.fold(*first, |mut whole, bounds| {
            whole.include(bounds.min);
            whole.include(bounds.max);
            whole
        });
        let middle = |of: &Aabb| std::array::from_fn(|k| of.min[k] / 2.0 + of.max[k] / 2.0);
        let (origin, half) = match Core::find(boxes.len(), |at| middle(&boxes[at].1), &whole) {
            Some(core) => (core.centre, core.half),
            None => {
                let origin = middle(&whole);
                let half = (0..3).fold(0.0_f64, |half, k| half.max(whole.max[k] - origin[k]));
                (origin, half)
            }
        };
        let scale = match exponent(half) {
            _ if half == 0.0 => 1.0,
            -60..=60 => 1.0,
            e => power_of_two((-e).clamp(-1000, 1000)),
        };
        self.frame = TreeFrame::new(origin, scale);
    }

    /// A box in the frame, rounded outwards. It is finite, so that an empty lane never overlaps it.
    pub(super) fn place(&self, bounds: &Aabb) -> Box32 {
        let at = |corner: &[f64; 3]| {
            std::array::from_fn(|k| (corner[k] - self.frame.origin[k]) * self.frame.scale)
        };
        Box32::outside(&at(&bounds.min), &at(&bounds.max))
    }

    /// How far the centre of the ball around a body has to be from the sides of this box in the tree, so that the box holds the ball and
    /// `half` around it.
    fn reach(&self, known: &Box32, extent: &Extent, half: f64) -> f64 {
        let farthest = (0..3).fold(0.0_f32, |most, k| {
            most.max(known.min[k].abs()).max(known.max[k].abs())
        });
        let far = f64::from(farthest) * self.frame.unit + largest(&self.frame.origin);
        let reach = extent.radius() + half + 2.0 * extent.blur(far);
        // the sums round once each
        (reach + 1e-15 * far) * (1.0 + 1e-15) + f64::MIN_POSITIVE
    }

    /// Where a translation may be so that this box in the tree holds the ball around the body, whose centre is at `offset` before it, and
    /// `half` around it.
    pub(super) fn room(&self, known: &Box32, extent: &Extent, offset: &[f64; 3], half: f64) -> Room {
        let (by, scale) = (self.reach(known, extent, half), self.frame.scale);
        let low = |k: usize| f64::from(known.min[k]) + (by - offset[k]) * scale;
        let high = |k: usize| f64::from(known.max[k]) - (by + offset[k]) * scale;
        Room::within(&std::array::from_fn(low), &std::array::from_fn(high))
    }

    /// Whether this box in the tree holds the ball around the body with its centre here, and `half` around it.
    #[inline]
    pub(super) fn holds_ball(&self, known: &Box32, extent: &Extent, centre: &[f64; 3], half: f64) -> bool {
        let TreeFrame { origin, scale, .. } = &self.frame;
        let by = self.reach(known, extent, half) * scale;
        (0..3).fold(true, |inside, k| {
            let at = (centre[k] - origin[k]) * scale;
            inside & (f64::from(known.min[k]) + by <= at) & (at <= f64::from(known.max[k]) - by)
        })
    }

    /// The frame of the boxes.
    #[inline(always)]
    pub(super) fn frame(&self) -> &TreeFrame {
        &self.frame
    }

    fn adopt(&mut self, child: u32, level: u8, parent: u32) {
        if level == 0 {
            self.leaves[child as usize].place = parent;
        } else {
            self.nodes[child as usize].parent = parent;
        }
    }

    fn new_node(&mut self, level: u8) -> u32 {
        match self.free.pop() {
            Some(id) => {
                self.nodes[id as usize] = Node::empty(level);
                id
            }
            None => {
                super::push(&mut self.nodes, Node::empty(level));
                self.nodes.len() as u32 - 1
            }
        }
    }

    /// Gives a node another box in its parent.
    fn set_box(&mut self, place: u32, to: &Box32) {
        self.nodes[node_of(place) as usize].set_box(lane_in(place), to);
    }

    fn make_room_for(&mut self, body: u32) {
        if self.leaves.len() <= body as usize {
            self.leaves.resize(body as usize + 1, BodyLeaf::NONE);
        }
    }

    /// Inserts a body. Cost: O(log n).
    fn insert(&mut self, body: u32, to: &Box32) {
        self.make_room_for(body);
        self.leaves[body as usize].bounds = *to;
        self.bodies += 1;
        let root = match self.root {
            Some(root) => root,
            None => {
                let root = self.new_node(0);
                self.root = Some(root);
                root
            }
        };
        let leaf = self.descend(root, to);
        self.attach(leaf, body, to);
        if let Some(place) = self.place_of(body) {
            self.mark(place);
        }
    }

    /// The leaf below `node` that grows least by a box; the boxes on the way grow to hold it.
    fn descend(&mut self, mut node: u32, to: &Box32) -> u32 {
        while self.nodes[node as usize].level > 0 {
            let at = &self.nodes[node as usize];
            let growth = |lane: usize| {
                let known = at.lane_box(lane);
                let size = known.union(to).sum_of_sides();
                (size - known.sum_of_sides(), size)
            };
            let best = at.children().map(|(lane, _)| (growth(lane), lane));
            let best =
                best.min_by(|(one, _), (two, _)| one.0.total_cmp(&two.0).then(one.1.total_cmp(&two.1)));
            let lane = best.map_or(0, |(_, lane)| lane);
            let grown = at.lane_box(lane).union(to);
            let child = at.child[lane];
            self.set_box(at_lane(node, lane), &grown);
            node = child;
        }
        node
    }

    /// Puts a child into a node, which is split if it is full.
    fn attach(&mut self, node: u32, child: u32, to: &Box32) {
        let level = self.nodes[node as usize].level;
        if let Some(lane) = self.nodes[node as usize].free_lane() {
            self.nodes[node as usize].set(lane, child, to);
            self.adopt(child, level, at_lane(node, lane));
            return;
        }
        let full = self.nodes[node as usize].clone();
        let mut nine: Vec<(u32, Box32)> = full
            .children()
            .map(|(lane, id)| (id, full.lane_box(lane)))
            .collect();
        nine.push((child, *to));
        let whole = nine.iter().fold(Box32::EMPTY, |whole, (_, b)| whole.union(b));
        let extent = |k: usize| whole.max[k] - whole.min[k];
        let axis = (1..3).fold(0, |best, k| if extent(k) > extent(best) { k } else { best });
        nine.sort_by(|(_, a), (_, b)| (a.min[axis] + a.max[axis]).total_cmp(&(b.min[axis] + b.max[axis])));
        let other = self.new_node(level);
        let mut emptied = Node::empty(level);
        emptied.parent = full.parent;
        self.nodes[node as usize] = emptied;
        for (at, (id, b)) in nine.iter().enumerate() {
            let (home, lane) = if at < 4 { (node, at) } else { (other, at - 4) };
            self.nodes[home as usize].set(lane, *id, b);
            self.adopt(*id, level, at_lane(home, lane));
        }
        if level == 0 {
            // the boxes lie elsewhere now
            for home in [node, other] {
                self.nodes[home as usize].changed = self.nodes[home as usize].taken();
                self.changed.push(home);
            }
        }
        let bounds = [node, other].map(|node| self.nodes[node as usize].bounds());
        if full.parent == NONE {
            let root = self.new_node(level + 1);
            self.root = Some(root);
            for (lane, id) in [node, other].into_iter().enumerate() {
                self.nodes[root as usize].set(lane, id, &bounds[lane]);
                self.nodes[id as usize].parent = at_lane(root, lane);
            }
        } else {
            self.set_box(full.parent, &bounds[0]);
            self.attach(node_of(full.parent), other, &bounds[1]);
        }
    }

    /// Removes a body. Cost: O(log n).
    pub(super) fn remove(&mut self, body: u32) {
        let Some(mut place) = self.place_of(body) else {
            return;
        };
        self.leaves[body as usize] = BodyLeaf::NONE;
        self.bodies -= 1;
        loop {
            let id = node_of(place);
            let node = &mut self.nodes[id as usize];
            node.set(lane_in(place), NONE, &Box32::EMPTY);
            let parent = node.parent;
            if node.taken() != 0 {
                self.shrink(id);
                return;
            }
            node.changed = 0;
            self.free.push(id);
            if parent == NONE {
                self.root = None;
                return;
            }
            place = parent;
        }
    }

    /// Bounds a node and those above it as tightly as their children are.
    fn shrink(&mut self, mut node: u32) {
        loop {
            let bounds = self.nodes[node as usize].bounds();
            let parent = self.nodes[node as usize].parent;
            if parent == NONE || self.box_at(parent) == bounds {
                return;
            }
            self.set_box(parent, &bounds);
            node = node_of(parent);
        }
    }
}

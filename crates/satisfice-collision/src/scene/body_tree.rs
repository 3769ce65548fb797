//! Which bodies can be near each other: a tree over the boxes of bodies, eight children to a node, that changes in place.
//!
//! An R-tree (Guttman 1984, doi 10.1145/602259.602266) of `f32` boxes relative to a local origin. Every coordinate is rounded
//! outwards, so that boxes that overlap in `f64` overlap here; the converse is left to the caller. All leaves have the same
//! depth. A new body goes down to the child that grows least, and a full node is split along its longest axis. Rebuilding
//! orders the bodies as [`BoxTree`](crate::broad) does and fills every node.

use crate::Aabb;
use crate::broad::{Box32, exponent, order_by_median, power_of_two};
use crate::simd::{Floats as _, Lanes};

/// Marks an empty lane, and the parent of the root.
const NONE: u32 = u32::MAX;

/// Eight boxes side by side, and what is in them.
#[derive(Clone)]
struct Node {
    lower: [[f32; 8]; 3],
    upper: [[f32; 8]; 3],
    /// Nodes, or bodies on level 0.
    child: [u32; 8],
    parent: u32,
    /// 0 for a node whose children are bodies.
    level: u32,
}

impl Node {
    fn empty(level: u32) -> Self {
        Self {
            lower: [[f32::INFINITY; 8]; 3],
            upper: [[f32::NEG_INFINITY; 8]; 3],
            child: [NONE; 8],
            parent: NONE,
            level,
        }
    }

    fn set(&mut self, lane: usize, child: u32, to: &Box32) {
        self.child[lane] = child;
        self.set_box(lane, to);
    }

    fn set_box(&mut self, lane: usize, to: &Box32) {
        for k in 0..3 {
            self.lower[k][lane] = to.min[k];
            self.upper[k][lane] = to.max[k];
        }
    }

    fn lane_box(&self, lane: usize) -> Box32 {
        Box32 {
            min: std::array::from_fn(|k| self.lower[k][lane]),
            max: std::array::from_fn(|k| self.upper[k][lane]),
        }
    }

    fn bounds(&self) -> Box32 {
        (0..8).fold(Box32::EMPTY, |bounds, lane| bounds.union(&self.lane_box(lane)))
    }

    fn free_lane(&self) -> Option<usize> {
        self.child.iter().position(|&child| child == NONE)
    }

    fn lane_of(&self, child: u32) -> Option<usize> {
        self.child.iter().position(|&other| other == child)
    }

    fn children(&self) -> impl Iterator<Item = (usize, u32)> {
        self.child
            .iter()
            .copied()
            .enumerate()
            .filter(|&(_, child)| child != NONE)
    }

    /// Bit `lane` is set if the box of that lane overlaps `b`, which is finite.
    #[inline(always)]
    fn overlaps<L: Lanes>(&self, lanes: L, b: &Box32) -> u32 {
        let s = lanes.single();
        let on = |k: usize| {
            s.both(
                s.at_most(s.load(&self.lower[k]), s.splat(b.max[k])),
                s.at_most(s.splat(b.min[k]), s.load(&self.upper[k])),
            )
        };
        s.bits(s.both(s.both(on(0), on(1)), on(2)))
    }
}

/// The lanes of a mask, ascending.
#[inline(always)]
fn lanes(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (lane < 8).then_some(lane)
    })
}

impl Box32 {
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

/// The tree. Bodies are named by their slots.
#[derive(Default)]
pub(super) struct BodyTree {
    nodes: Vec<Node>,
    free: Vec<u32>,
    root: Option<u32>,
    /// The leaf of each body, by slot; [`NONE`] for those that are not in the tree.
    leaf: Vec<u32>,
    origin: [f64; 3],
    scale: f64,
    bodies: usize,
    /// Bodies put elsewhere since the tree was built.
    changes: usize,
}

impl BodyTree {
    /// Whether so many bodies have been put elsewhere since it was built that building it anew pays.
    pub(super) fn is_worn(&self) -> bool {
        self.changes > 4 * self.bodies + 64
    }

    /// Whether a body is in the tree.
    pub(super) fn contains(&self, body: u32) -> bool {
        self.leaf.get(body as usize).is_some_and(|&leaf| leaf != NONE)
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>() + (self.leaf.capacity() + self.free.capacity()) * 4
    }

    /// Builds the tree anew over these boxes. Cost: O(n log n).
    pub(super) fn build(&mut self, boxes: &[(u32, Aabb)]) {
        self.nodes.clear();
        self.free.clear();
        self.leaf.fill(NONE);
        (self.root, self.bodies, self.changes) = (None, boxes.len(), 0);
        self.choose_frame(boxes);
        let placed: Vec<Box32> = boxes.iter().map(|(_, bounds)| self.place(bounds)).collect();
        let order = order_by_median(&placed, false);
        if let Some(most) = boxes.iter().map(|&(body, _)| body as usize + 1).max()
            && most > self.leaf.len()
        {
            self.leaf.resize(most, NONE);
        }
        let mut below: Vec<(u32, Box32)> = order
            .iter()
            .map(|&at| (boxes[at as usize].0, placed[at as usize]))
            .collect();
        let mut level = 0;
        while self.root.is_none() && !below.is_empty() {
            let mut above = Vec::with_capacity(below.len().div_ceil(8));
            for children in below.chunks(8) {
                let id = self.nodes.len() as u32;
                let mut node = Node::empty(level);
                for (lane, (child, bounds)) in children.iter().enumerate() {
                    node.set(lane, *child, bounds);
                    self.adopt(*child, level, id);
                }
                above.push((id, node.bounds()));
                super::push(&mut self.nodes, node);
            }
            if above.len() == 1 {
                self.root = Some(above[0].0);
            }
            below = above;
            level += 1;
        }
    }

    /// Coordinates count from the middle of all boxes, in a unit in which `f32` overflows last.
    fn choose_frame(&mut self, boxes: &[(u32, Aabb)]) {
        let mut all = boxes.iter().map(|(_, bounds)| bounds);
        let Some(first) = all.next() else {
            (self.origin, self.scale) = ([0.0; 3], 1.0);
            return;
        };
        let whole = all.fold(*first, |mut whole, bounds| {
            whole.include(bounds.min);
            whole.include(bounds.max);
            whole
        });
        self.origin = std::array::from_fn(|k| whole.min[k] / 2.0 + whole.max[k] / 2.0);
        let half = (0..3).fold(0.0_f64, |half, k| half.max(whole.max[k] - self.origin[k]));
        self.scale = match exponent(half) {
            _ if half == 0.0 => 1.0,
            -60..=60 => 1.0,
            e => power_of_two((-e).clamp(-1000, 1000)),
        };
    }

    /// A box in the frame, rounded outwards: at least one step further than the rounded value. It is finite, so that an empty lane
    /// never overlaps it; what lies beyond the range of `f32` lies on its end.
    fn place(&self, bounds: &Aabb) -> Box32 {
        let at = |c: f64, k: usize| ((c - self.origin[k]) * self.scale) as f32;
        let within = |c: f32| c.clamp(f32::MIN, f32::MAX);
        Box32 {
            min: std::array::from_fn(|k| within(at(bounds.min[k], k).next_down())),
            max: std::array::from_fn(|k| within(at(bounds.max[k], k).next_up())),
        }
    }

    fn adopt(&mut self, child: u32, level: u32, parent: u32) {
        if level == 0 {
            self.leaf[child as usize] = parent;
        } else {
            self.nodes[child as usize].parent = parent;
        }
    }

    fn new_node(&mut self, level: u32) -> u32 {
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

    /// Puts a body into the tree, or elsewhere in it. Cost: O(log n).
    pub(super) fn put(&mut self, body: u32, bounds: &Aabb) {
        let to = self.place(bounds);
        self.changes += 1;
        if self.contains(body) {
            let leaf = self.leaf[body as usize] as usize;
            if let (true, Some(lane)) = (self.is_inside(leaf, &to), self.nodes[leaf].lane_of(body)) {
                self.nodes[leaf].set_box(lane, &to);
                return;
            }
            self.remove(body);
        }
        if self.leaf.len() <= body as usize {
            self.leaf.resize(body as usize + 1, NONE);
        }
        self.bodies += 1;
        let root = match self.root {
            Some(root) => root,
            None => {
                let root = self.new_node(0);
                self.root = Some(root);
                root
            }
        };
        let leaf = self.descend(root, &to);
        self.attach(leaf, body, &to);
    }

    /// Whether a box stays inside what its leaf's parent knows of the leaf.
    fn is_inside(&self, leaf: usize, to: &Box32) -> bool {
        let parent = self.nodes[leaf].parent;
        if parent == NONE {
            return true;
        }
        let parent = &self.nodes[parent as usize];
        let known = parent.lane_of(leaf as u32).map(|lane| parent.lane_box(lane));
        known.is_some_and(|known| (0..3).all(|k| known.min[k] <= to.min[k] && to.max[k] <= known.max[k]))
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
            self.nodes[node as usize].set_box(lane, &grown);
            node = child;
        }
        node
    }

    /// Puts a child into a node, which is split if it is full.
    fn attach(&mut self, node: u32, child: u32, to: &Box32) {
        let level = self.nodes[node as usize].level;
        if let Some(lane) = self.nodes[node as usize].free_lane() {
            self.nodes[node as usize].set(lane, child, to);
            self.adopt(child, level, node);
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
        self.nodes[node as usize] = Node {
            parent: full.parent,
            ..Node::empty(level)
        };
        for (at, (id, b)) in nine.iter().enumerate() {
            let (home, lane) = if at < 4 { (node, at) } else { (other, at - 4) };
            self.nodes[home as usize].set(lane, *id, b);
            self.adopt(*id, level, home);
        }
        let bounds = [node, other].map(|node| self.nodes[node as usize].bounds());
        if full.parent == NONE {
            let root = self.new_node(level + 1);
            self.root = Some(root);
            for (lane, id) in [node, other].into_iter().enumerate() {
                self.nodes[root as usize].set(lane, id, &bounds[lane]);
                self.nodes[id as usize].parent = root;
            }
        } else {
            let parent = &mut self.nodes[full.parent as usize];
            if let Some(lane) = parent.lane_of(node) {
                parent.set_box(lane, &bounds[0]);
            }
            self.attach(full.parent, other, &bounds[1]);
        }
    }

    /// Takes a body out. Cost: O(log n).
    pub(super) fn remove(&mut self, body: u32) {
        if !self.contains(body) {
            return;
        }
        let mut node = std::mem::replace(&mut self.leaf[body as usize], NONE);
        let mut child = body;
        self.bodies -= 1;
        loop {
            let at = &mut self.nodes[node as usize];
            if let Some(lane) = at.lane_of(child) {
                at.set(lane, NONE, &Box32::EMPTY);
            }
            let parent = at.parent;
            if at.child.iter().all(|&child| child == NONE) {
                self.free.push(node);
                if parent == NONE {
                    self.root = None;
                    return;
                }
                (child, node) = (node, parent);
                continue;
            }
            // boxes above may shrink
            let bounds = at.bounds();
            if parent == NONE {
                return;
            }
            (child, node) = (node, parent);
            let at = &mut self.nodes[node as usize];
            if let Some(lane) = at.lane_of(child) {
                at.set_box(lane, &bounds);
            }
            self.shrink(node);
            return;
        }
    }

    /// Bounds the nodes above `node` as tightly as their children are.
    fn shrink(&mut self, mut node: u32) {
        loop {
            let bounds = self.nodes[node as usize].bounds();
            let parent = self.nodes[node as usize].parent;
            if parent == NONE {
                return;
            }
            let above = &mut self.nodes[parent as usize];
            let Some(lane) = above.lane_of(node) else { return };
            if above.lane_box(lane) == bounds {
                return;
            }
            above.set_box(lane, &bounds);
            node = parent;
        }
    }
}

#[cfg(test)]
mod tests;
mod visits;

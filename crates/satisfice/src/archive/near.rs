//! Hits by their places: a k-d tree (Bentley 1975) with the bounding box of every node.
//!
//! Cells of a grid say little in many dimensions: where hits are a separation apart, thousands share the cells of a few coordinates, and a
//! ball meets too many cells of all of them. A box is passed by as soon as it is farther away than a radius. Where hits come in one
//! direction, a part of the tree that has become deep is built again (Galperin, Rivest 1993).

mod around;
mod distance;
#[cfg(test)]
mod tests;

use core::cell::RefCell;

use self::around::{Around, WIDEST};
use self::distance::{LANES, distance, square};
use crate::identity::Identity;

/// Points of a leaf, at most, unless no axis tells enough of them apart.
const LEAF: usize = 32;
/// Points on either side of a split, at least: a box of fewer takes longer to pass by than they do. Along each of many axes there are few.
const SIDE: usize = 8;
/// Squared distances, in radii, of what may be the same are at most this, by what distances are rounded.
const FARTHEST: f64 = 1.001;
/// When an insertion goes too deep, the part of the tree is built again in which one side holds more than this share of the points, and more
/// than `MORE` times the share that it held when it was built. Such a part has grown by a third at least, so that this helps.
const LOPSIDED: f64 = 0.7;
const MORE: f64 = 1.2;
/// The hits of an archive: a tree, and another one for each further list of radii, of which there should be none.
#[derive(Debug, Clone, Default)]
pub(super) struct NearIndex {
    trees: Vec<Tree>,
}

/// A place: coordinates, and the radius of each.
#[derive(Debug, Default)]
struct Point {
    coordinates: Vec<f64>,
    radii: Vec<f64>,
    /// Nodes that are left to look at.
    left: Vec<usize>,
}

thread_local! {
    /// Memory of one look-up, so that it allocates nothing.
    static POINT: RefCell<Point> = RefCell::default();
}

/// Calls `use_point` with the place of a solution.
fn with_point<T: Identity, R>(solution: &T, use_point: impl FnOnce(&mut Point) -> R) -> R {
    let mut point = POINT.take();
    point.coordinates.clear();
    point.radii.clear();
    solution.visit_place(&mut |coordinate, radius| {
        point.coordinates.push(coordinate);
        point.radii.push(radius);
    });
    let count = point.radii.len().max(1).next_multiple_of(LANES);
    point.coordinates.resize(count, 0.0);
    point.radii.resize(count, 1.0);
    let result = use_point(&mut point);
    POINT.set(point);
    result
}

impl NearIndex {
    /// Adds hit `number`. Cost: O(D) for each node on one way down, some log n, and what is built again.
    pub(super) fn insert<T: Identity>(&mut self, solution: &T, number: u32) {
        with_point(solution, |point| {
            let known = self.trees.iter().position(|tree| tree.radii == point.radii);
            let index = known.unwrap_or_else(|| {
                self.trees.push(Tree::new(&point.radii));
                self.trees.len() - 1
            });
            self.trees[index].insert(&point.coordinates, number);
        });
    }

    /// Whether one of the hits that may be the same as `solution` passes `test`.
    pub(super) fn any<T: Identity>(&self, solution: &T, mut test: impl FnMut(u32) -> bool) -> bool {
        with_point(solution, |point| {
            let mut trees = self.trees.iter().filter(|tree| tree.radii == point.radii);
            trees.any(|tree| tree.any(&point.coordinates, &mut point.left, &mut test))
        })
    }

    pub(super) fn bytes(&self) -> usize {
        self.trees.iter().map(Tree::bytes).sum()
    }
}

#[derive(Debug, Clone)]
struct Tree {
    radii: Vec<f64>,
    /// What a difference is multiplied by.
    scales: Vec<f64>,
    nodes: Vec<Node>,
    /// Lower and upper ends of the box of each node.
    boxes: Vec<f64>,
    /// Pairs of nodes, by the first, that are not in use.
    free: Vec<usize>,
    /// Memory of one way down.
    path: Vec<usize>,
    /// The hits around the last points looked up.
    around: Around,
}

#[derive(Debug, Clone)]
struct Node {
    /// Points below.
    count: usize,
    /// The share of them on the larger side, when it was split.
    share: f64,
    kind: NodeKind,
}

#[derive(Debug, Clone)]
enum NodeKind {
    Leaf {
        numbers: Vec<u32>,
        /// Their coordinates, one point after the other.
        points: Vec<f64>,
    },
    /// Points below `value` on `axis` are in node `first`, the others in the next one.
    Split { axis: usize, value: f64, first: usize },
}

impl Tree {
    fn new(radii: &[f64]) -> Self {
        let mut tree = Self {
            radii: radii.to_vec(),
            // Points that are equal have a distance of zero, also along an axis without a radius.
            scales: radii.iter().map(|radius| radius.recip().min(f64::MAX)).collect(),
            nodes: Vec::new(),
            boxes: Vec::new(),
            free: Vec::new(),
            path: Vec::new(),
            around: Around::default(),
        };
        tree.add_node();
        tree
    }

    fn dimension(&self) -> usize {
        self.radii.len()
    }

    /// Adds a node that is an empty leaf.
    fn add_node(&mut self) {
        self.nodes.push(Node {
            count: 0,
            share: 1.0,
            kind: NodeKind::Leaf {
                numbers: Vec::new(),
                points: Vec::new(),
            },
        });
        self.boxes.resize(2 * self.dimension() * self.nodes.len(), 0.0);
    }

    /// Makes a node a leaf of these points.
    fn set_leaf(&mut self, node: usize, numbers: Vec<u32>, points: Vec<f64>) {
        self.around.clear();
        let dimension = self.dimension();
        let (lower, upper) = self.box_of_mut(node);
        lower.fill(f64::INFINITY);
        upper.fill(f64::NEG_INFINITY);
        for point in points.chunks_exact(dimension) {
            self.extend(node, point);
        }
        self.nodes[node] = Node {
            count: numbers.len(),
            share: 1.0,
            kind: NodeKind::Leaf { numbers, points },
        };
    }

    fn box_of(&self, node: usize) -> (&[f64], &[f64]) {
        let dimension = self.dimension();
        self.boxes[2 * dimension * node..2 * dimension * (node + 1)].split_at(dimension)
    }

    fn box_of_mut(&mut self, node: usize) -> (&mut [f64], &mut [f64]) {
        let dimension = self.dimension();
        self.boxes[2 * dimension * node..2 * dimension * (node + 1)].split_at_mut(dimension)
    }

    /// Makes the box of a node hold a point.
    fn extend(&mut self, node: usize, point: &[f64]) {
        let (lower, upper) = self.box_of_mut(node);
        for ((lower, upper), &x) in lower.iter_mut().zip(upper).zip(point) {
            *lower = lower.min(x);
            *upper = upper.max(x);
        }
    }

    fn insert(&mut self, point: &[f64], number: u32) {
        if self.nodes[0].count == 0 {
            self.set_leaf(0, Vec::new(), Vec::new());
        }
        self.path.clear();
        let mut at = 0;
        loop {
            self.extend(at, point);
            self.path.push(at);
            let node = &mut self.nodes[at];
            node.count += 1;
            match &mut node.kind {
                NodeKind::Split { axis, value, first } => {
                    at = *first + usize::from(point[*axis] >= *value);
                }
                NodeKind::Leaf { numbers, points } => {
                    numbers.push(number);
                    let row = points.len();
                    points.extend_from_slice(point);
                    let scales = &self.scales;
                    self.around
                        .add(number, at, row, |centre| distance(centre, point, scales, WIDEST));
                    let times = numbers.len() / (LEAF + 1);
                    if numbers.len().is_multiple_of(LEAF + 1) && times.is_power_of_two() {
                        self.split_all(at);
                    }
                    break;
                }
            }
        }
        let leaves = 1.0 + self.nodes[0].count as f64 / (LEAF / 2) as f64;
        if self.path.len() as f64 > 2.0 + leaves.ln() / -LOPSIDED.ln() {
            self.balance();
        }
    }

    /// Splits a leaf, and its parts, as long as they have too many points.
    fn split_all(&mut self, leaf: usize) {
        let mut left = vec![leaf];
        while let Some(node) = left.pop() {
            if self.nodes[node].count > LEAF
                && let Some(first) = self.split(node)
            {
                left.extend([first, first + 1]);
            }
        }
    }

    /// Splits a leaf across the axis that is widest without its outermost points, in the middle of its points; not if that has no width on
    /// any. Returns the first part.
    fn split(&mut self, leaf: usize) -> Option<usize> {
        let dimension = self.dimension();
        let NodeKind::Leaf { numbers, points } = &self.nodes[leaf].kind else {
            return None;
        };
        let last = numbers.len().checked_sub(SIDE)?;
        let mut order = Vec::with_capacity(numbers.len());
        let (mut chosen, mut widest) = (None, 0.0);
        let (lower, upper) = self.box_of(leaf);
        for axis in 0..dimension {
            if (upper[axis] - lower[axis]) * self.scales[axis] <= widest {
                continue;
            }
            order.clear();
            order.extend(points.iter().skip(axis).step_by(dimension));
            let high = *order.select_nth_unstable_by(last, f64::total_cmp).1;
            let low = *order.select_nth_unstable_by(SIDE - 1, f64::total_cmp).1;
            let width = (high - low) * self.scales[axis];
            if width > widest {
                (chosen, widest) = (Some(axis), width);
            }
        }
        let axis = chosen?;
        order.clear();
        order.extend(points.iter().skip(axis).step_by(dimension));
        order.sort_unstable_by(f64::total_cmp);
        let middle = order.len() / 2;
        let steps = (SIDE..=last).filter(|&i| order[i - 1] < order[i]);
        let step = steps.min_by_key(|&i| i.abs_diff(middle))?;
        let value = order[step];
        let mut parts = [(Vec::new(), Vec::new()), (Vec::new(), Vec::new())];
        for (point, &number) in points.chunks_exact(dimension).zip(numbers) {
            let (numbers, points) = &mut parts[usize::from(point[axis] >= value)];
            numbers.push(number);
            points.extend_from_slice(point);
        }
        let first = self.free.pop().unwrap_or_else(|| {
            self.add_node();
            self.add_node();
            self.nodes.len() - 2
        });
        let larger = step.max(order.len() - step);
        self.nodes[leaf].share = larger as f64 / order.len() as f64;
        self.nodes[leaf].kind = NodeKind::Split { axis, value, first };
        for (node, (numbers, points)) in (first..).zip(parts) {
            self.set_leaf(node, numbers, points);
        }
        Some(first)
    }

    /// Builds the lowest lopsided part on the last way down again.
    fn balance(&mut self) {
        let is_lopsided = |node: &Node| match node.kind {
            NodeKind::Split { first, .. } => {
                let larger = self.nodes[first].count.max(self.nodes[first + 1].count);
                larger as f64 > LOPSIDED.max(MORE * node.share) * node.count as f64
            }
            NodeKind::Leaf { .. } => false,
        };
        let lowest = self
            .path
            .iter()
            .rev()
            .find(|&&node| is_lopsided(&self.nodes[node]));
        if let Some(&node) = lowest {
            self.rebuild(node);
        }
    }

    /// Builds the part below a node again. Cost: O(n log^2 n) for its n points.
    fn rebuild(&mut self, top: usize) {
        let (mut all, mut places) = (Vec::new(), Vec::new());
        let mut left = vec![top];
        while let Some(node) = left.pop() {
            match &mut self.nodes[node].kind {
                NodeKind::Leaf { numbers, points } => {
                    all.append(numbers);
                    places.append(points);
                }
                NodeKind::Split { first, .. } => {
                    left.extend([*first, *first + 1]);
                    self.free.push(*first);
                }
            }
        }
        self.set_leaf(top, all, places);
        self.split_all(top);
    }

    fn any(&self, point: &[f64], left: &mut Vec<usize>, test: &mut impl FnMut(u32) -> bool) -> bool {
        let around = self.around.any(self, point, left, test);
        around.unwrap_or_else(|| self.walk(point, left, test, &mut 0))
    }

    /// [`Tree::any`], by the boxes; counts them and the points that are looked at.
    fn walk(
        &self,
        point: &[f64],
        left: &mut Vec<usize>,
        test: &mut impl FnMut(u32) -> bool,
        cost: &mut usize,
    ) -> bool {
        left.clear();
        left.push(0);
        while let Some(at) = left.pop() {
            *cost += 1;
            if !self.is_box_within(at, point, FARTHEST) {
                continue;
            }
            match &self.nodes[at].kind {
                NodeKind::Split { axis, value, first } => {
                    let own = usize::from(point[*axis] >= *value);
                    left.extend([first + 1 - own, first + own]);
                }
                NodeKind::Leaf { numbers, points } => {
                    *cost += numbers.len();
                    let mut points = points.chunks_exact(self.dimension()).zip(numbers);
                    let is_near = |other| distance(point, other, &self.scales, FARTHEST).is_some();
                    if points.any(|(other, &number)| is_near(other) && test(number)) {
                        return true;
                    }
                }
            }
        }
        false
    }

    /// Visits the points around one, with their number, their leaf, their first coordinate there and the square of their distance, until `visit`
    /// returns `false`; returns whether it did not.
    fn each_around(
        &self,
        point: &[f64],
        left: &mut Vec<usize>,
        mut visit: impl FnMut(u32, usize, usize, f64) -> bool,
    ) -> bool {
        left.clear();
        left.push(0);
        while let Some(at) = left.pop() {
            if !self.is_box_within(at, point, WIDEST) {
                continue;
            }
            match &self.nodes[at].kind {
                NodeKind::Split { first, .. } => left.extend([first + 1, *first]),
                NodeKind::Leaf { numbers, points } => {
                    for (index, &number) in numbers.iter().enumerate() {
                        let row = index * self.dimension();
                        let other = &points[row..row + self.dimension()];
                        if let Some(square) = distance(point, other, &self.scales, WIDEST)
                            && !visit(number, at, row, square)
                        {
                            return false;
                        }
                    }
                }
            }
        }
        true
    }

    /// The coordinates of a point of a leaf, from their first.
    fn point(&self, leaf: usize, row: usize) -> &[f64] {
        match &self.nodes[leaf].kind {
            NodeKind::Leaf { points, .. } => &points[row..row + self.dimension()],
            NodeKind::Split { .. } => &[],
        }
    }

    /// Whether a box is that near to a point.
    fn is_box_within(&self, node: usize, point: &[f64], limit: f64) -> bool {
        let (lower, upper) = self.box_of(node);
        let ends = lower.chunks_exact(LANES).zip(upper.chunks_exact(LANES));
        let lanes = point.chunks_exact(LANES).zip(ends);
        let chunks = lanes.zip(self.scales.chunks_exact(LANES));
        let square = square(chunks, limit, |((x, (lower, upper)), scales), lane| {
            (lower[lane] - x[lane]).max(x[lane] - upper[lane]).max(0.0) * scales[lane]
        });
        square.is_some()
    }

    fn bytes(&self) -> usize {
        let leaves = self.nodes.iter().map(|node| match &node.kind {
            NodeKind::Leaf { numbers, points } => numbers.capacity() * 4 + points.capacity() * 8,
            NodeKind::Split { .. } => 0,
        });
        leaves.sum::<usize>()
            + self.nodes.capacity() * size_of::<Node>()
            + self.boxes.capacity() * 8
            + self.around.bytes()
    }
}

//! Hits by their places: a k-d tree (Bentley 1975) with the bounding box of every node.
//!
//! Cells of a grid say little in many dimensions: where hits are a separation apart, thousands share the cells of a few coordinates, and a
//! ball meets too many cells of all of them. A box is passed by as soon as it is farther away than a radius. Where hits come in one
//! direction, a part of the tree that has become deep is built again (Galperin, Rivest 1993).

use core::cell::RefCell;

use crate::identity::Identity;

/// Points of a leaf, at most, unless all are in one place.
const LEAF: usize = 32;
/// Squared distances, in radii, of what may be the same are at most this, by what distances are rounded.
const FARTHEST: f64 = 1.001;
/// Where a path is longer than in a tree whose parts have at most `LOPSIDED` of their points on one side, a part is built again that has more
/// there and `MORE` times the share that it had when it was built: so it has grown by a third at least, and helps.
const LOPSIDED: f64 = 0.7;
const MORE: f64 = 1.2;
/// So many coordinates are looked at together: each point has a multiple of them.
const LANES: usize = 4;

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

/// Whether distances along all coordinates are at most a radius together.
#[inline(always)]
fn is_within<T>(chunks: impl Iterator<Item = T>, distance: impl Fn(&T, usize) -> f64) -> bool {
    let mut squares = [0.0; LANES];
    for chunk in chunks {
        for (lane, square) in squares.iter_mut().enumerate() {
            let distance = distance(&chunk, lane);
            *square += distance * distance;
        }
        let [a, b, c, d] = squares;
        if (a + b) + (c + d) > FARTHEST {
            return false;
        }
    }
    true
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

    /// Removes hit `number`. Cost: O(D) for each node on one way down.
    pub(super) fn remove<T: Identity>(&mut self, solution: &T, number: u32) {
        with_point(solution, |point| {
            let tree = self.trees.iter_mut().find(|tree| tree.radii == point.radii);
            if let Some(tree) = tree {
                tree.remove(&point.coordinates, number);
            }
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
                    points.extend_from_slice(point);
                    if numbers.len().is_multiple_of(LEAF + 1) {
                        self.split(at);
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

    /// Removes a point that was inserted. Boxes stay as large as they are.
    fn remove(&mut self, point: &[f64], number: u32) {
        let mut at = 0;
        loop {
            let dimension = self.radii.len();
            let node = &mut self.nodes[at];
            node.count -= 1;
            match &mut node.kind {
                NodeKind::Split { axis, value, first } => {
                    at = *first + usize::from(point[*axis] >= *value);
                }
                NodeKind::Leaf { numbers, points } => {
                    if let Some(place) = numbers.iter().position(|&other| other == number) {
                        numbers.remove(place);
                        points.drain(place * dimension..(place + 1) * dimension);
                    }
                    return;
                }
            }
        }
    }

    /// Splits a leaf across its widest axis, in the middle of its points; not if all of them are in one place. Returns the first
    /// part.
    fn split(&mut self, leaf: usize) -> Option<usize> {
        let dimension = self.dimension();
        let (lower, upper) = self.box_of(leaf);
        let widths = lower.iter().zip(upper).zip(&self.scales);
        let widest = widths
            .map(|((lower, upper), scale)| (upper - lower) * scale)
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let (Some((axis, _)), NodeKind::Leaf { numbers, points }) = (widest, &self.nodes[leaf].kind) else {
            return None;
        };
        let mut order: Vec<f64> = points.iter().skip(axis).step_by(dimension).copied().collect();
        order.sort_unstable_by(f64::total_cmp);
        let middle = order.len() / 2;
        let steps = (1..order.len()).filter(|&i| order[i - 1] < order[i]);
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
        left.push(top);
        while let Some(node) = left.pop() {
            if self.nodes[node].count > LEAF
                && let Some(first) = self.split(node)
            {
                left.extend([first, first + 1]);
            }
        }
    }

    fn any(&self, point: &[f64], left: &mut Vec<usize>, test: &mut impl FnMut(u32) -> bool) -> bool {
        left.clear();
        left.push(0);
        while let Some(at) = left.pop() {
            if !self.is_box_near(at, point) {
                continue;
            }
            match &self.nodes[at].kind {
                NodeKind::Split { axis, value, first } => {
                    let own = usize::from(point[*axis] >= *value);
                    left.extend([first + 1 - own, first + own]);
                }
                NodeKind::Leaf { numbers, points } => {
                    let mut points = points.chunks_exact(self.dimension()).zip(numbers);
                    if points.any(|(other, &number)| self.is_near(point, other) && test(number)) {
                        return true;
                    }
                }
            }
        }
        false
    }

    fn is_near(&self, a: &[f64], b: &[f64]) -> bool {
        let lanes = a.chunks_exact(LANES).zip(b.chunks_exact(LANES));
        is_within(
            lanes.zip(self.scales.chunks_exact(LANES)),
            |((a, b), scales), lane| (a[lane] - b[lane]) * scales[lane],
        )
    }

    fn is_box_near(&self, node: usize, point: &[f64]) -> bool {
        let (lower, upper) = self.box_of(node);
        let ends = lower.chunks_exact(LANES).zip(upper.chunks_exact(LANES));
        let lanes = point.chunks_exact(LANES).zip(ends);
        is_within(
            lanes.zip(self.scales.chunks_exact(LANES)),
            |((x, (lower, upper)), scales), lane| {
                (lower[lane] - x[lane]).max(x[lane] - upper[lane]).max(0.0) * scales[lane]
            },
        )
    }

    fn bytes(&self) -> usize {
        let leaves = self.nodes.iter().map(|node| match &node.kind {
            NodeKind::Leaf { numbers, points } => numbers.capacity() * 4 + points.capacity() * 8,
            NodeKind::Split { .. } => 0,
        });
        leaves.sum::<usize>() + self.nodes.capacity() * size_of::<Node>() + self.boxes.capacity() * 8
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Located;

    /// The longest way down.
    fn depth(index: &NearIndex) -> usize {
        let tree = &index.trees[0];
        let (mut deepest, mut left) = (0, vec![(0, 1)]);
        while let Some((node, depth)) = left.pop() {
            deepest = deepest.max(depth);
            if let NodeKind::Split { first, .. } = tree.nodes[node].kind {
                left.extend([(first, depth + 1), (first + 1, depth + 1)]);
            }
        }
        let used = tree.nodes.len() - 2 * tree.free.len();
        assert_eq!(tree.nodes[0].count, index.count());
        assert!(used < index.count() / 4 + 2, "{used} nodes");
        deepest
    }

    impl NearIndex {
        /// Hits, counted leaf by leaf.
        fn count(&self) -> usize {
            let nodes = self.trees.iter().flat_map(|tree| &tree.nodes);
            let leaves = nodes.map(|node| match &node.kind {
                NodeKind::Leaf { numbers, .. } => numbers.len(),
                NodeKind::Split { .. } => 0,
            });
            leaves.sum()
        }
    }

    #[test]
    fn hits_in_one_direction_do_not_make_it_deep() {
        let mut index = NearIndex::default();
        let at = |x: f64| Located::new(&[x, 2.0 * x, 0.0, 1.0, 0.0], 0.5);
        for number in 0..20_000 {
            index.insert(&at(f64::from(number)), number);
        }
        assert!(depth(&index) < 30, "{}", depth(&index));
        for number in (0..20_000).step_by(7) {
            assert!(index.any(&at(f64::from(number) + 0.1), |found| found == number));
            assert!(!index.any(&at(f64::from(number) + 0.5), |_| true));
        }
    }

    /// Along each of many axes: most points are zero on each.
    #[test]
    fn a_star_is_searched_without_recursion() {
        let mut index = NearIndex::default();
        let at = |number: u32| {
            let mut x = vec![0.0; 200];
            x[number as usize % 200] = f64::from(1 + number / 200);
            Located::new(&x, 0.5)
        };
        for number in 0..8000 {
            index.insert(&at(number), number);
        }
        assert!(depth(&index) < 2000, "{}", depth(&index));
        for number in (0..8000).step_by(31) {
            assert!(index.any(&at(number), |found| found == number));
            assert!(!index.any(&at(number), |found| found != number));
        }
    }
}

//! Hits by their places: a k-d tree (Bentley 1975) with the bounding box of every node.
//!
//! Cells of a grid say little in many dimensions: where hits are a separation apart, thousands share the cells of a few coordinates, and a
//! ball meets too many cells of all of them. A box is passed by as soon as it is farther away than a radius.

use core::cell::RefCell;

use hashbrown::HashMap;

use crate::identity::Identity;

/// Points of a leaf, at most, unless all are in one place.
const LEAF: usize = 32;
/// Squared distances, in radii, of what may be the same are at most this, by what distances are rounded.
const FARTHEST: f64 = 1.001;
/// So many coordinates are looked at together: each point has a multiple of them.
const LANES: usize = 4;

/// The hits of an archive: a tree for each key of what is not told apart by a radius.
#[derive(Debug, Clone, Default)]
pub(super) struct NearIndex {
    trees: HashMap<u64, Vec<Tree>, foldhash::fast::FixedState>,
}

/// A place: coordinates, and the radius of each.
#[derive(Debug, Default)]
struct Point {
    coordinates: Vec<f64>,
    radii: Vec<f64>,
}

thread_local! {
    /// Memory of one look-up, so that it allocates nothing.
    static POINT: RefCell<Point> = RefCell::default();
}

/// Calls `use_point` with the place of a solution and the key of the rest of it; `None` if it has no place.
fn with_point<T: Identity, R>(solution: &T, use_point: impl FnOnce(u64, &Point) -> R) -> Option<R> {
    let mut point = POINT.take();
    point.coordinates.clear();
    point.radii.clear();
    let key = solution.visit_place(&mut |coordinate, radius| {
        point.coordinates.push(coordinate);
        point.radii.push(radius);
    });
    let count = point.radii.len().next_multiple_of(LANES);
    point.coordinates.resize(count, 0.0);
    point.radii.resize(count, 1.0);
    let result = key.map(|key| use_point(key, &point));
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
    /// Adds hit `number`. Cost: O(D log n), amortised.
    pub(super) fn insert<T: Identity>(&mut self, solution: &T, number: u32) {
        with_point(solution, |key, point| {
            let trees = self.trees.entry(key).or_default();
            let known = trees.iter().position(|tree| tree.radii == point.radii);
            let index = known.unwrap_or_else(|| {
                trees.push(Tree::new(&point.radii));
                trees.len() - 1
            });
            trees[index].insert(&point.coordinates, number);
        });
    }

    /// Whether one of the hits that may be the same as `solution` passes `test`.
    pub(super) fn any<T: Identity>(&self, solution: &T, mut test: impl FnMut(u32) -> bool) -> bool {
        let found = with_point(solution, |key, point| {
            let trees = self.trees.get(&key).map_or(&[][..], Vec::as_slice);
            let mut trees = trees.iter().filter(|tree| tree.radii == point.radii);
            trees.any(|tree| tree.any(&point.coordinates, &mut test))
        });
        found.unwrap_or(false)
    }

    pub(super) fn bytes(&self) -> usize {
        self.trees.values().flatten().map(Tree::bytes).sum()
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
}

#[derive(Debug, Clone)]
enum Node {
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
        Self {
            radii: radii.to_vec(),
            // No distance may come out too large, and none is no number where points are equal.
            scales: radii.iter().map(|radius| radius.recip().min(f64::MAX)).collect(),
            nodes: Vec::new(),
            boxes: Vec::new(),
        }
    }

    fn dimension(&self) -> usize {
        self.radii.len()
    }

    /// Adds a leaf of these points.
    fn push_leaf(&mut self, numbers: Vec<u32>, points: Vec<f64>) {
        let dimension = self.dimension();
        let start = self.boxes.len();
        self.boxes.resize(start + dimension, f64::INFINITY);
        self.boxes.resize(start + 2 * dimension, f64::NEG_INFINITY);
        for point in points.chunks_exact(dimension) {
            self.extend(self.nodes.len(), point);
        }
        self.nodes.push(Node::Leaf { numbers, points });
    }

    /// Makes the box of a node hold a point.
    fn extend(&mut self, node: usize, point: &[f64]) {
        let dimension = self.dimension();
        let (lower, upper) =
            self.boxes[2 * dimension * node..2 * dimension * (node + 1)].split_at_mut(dimension);
        for ((lower, upper), &x) in lower.iter_mut().zip(upper).zip(point) {
            *lower = lower.min(x);
            *upper = upper.max(x);
        }
    }

    fn insert(&mut self, point: &[f64], number: u32) {
        if self.nodes.is_empty() {
            self.push_leaf(Vec::new(), Vec::new());
        }
        let mut at = 0;
        loop {
            self.extend(at, point);
            match &mut self.nodes[at] {
                Node::Split { axis, value, first } => at = *first + usize::from(point[*axis] >= *value),
                Node::Leaf { numbers, points } => {
                    numbers.push(number);
                    points.extend_from_slice(point);
                    if numbers.len().is_multiple_of(LEAF + 1) {
                        self.split(at);
                    }
                    return;
                }
            }
        }
    }

    /// Splits a leaf across its widest axis, in the middle of its points; not if all of them are in one place.
    fn split(&mut self, leaf: usize) {
        let dimension = self.dimension();
        let (lower, upper) = self.boxes[2 * dimension * leaf..2 * dimension * (leaf + 1)].split_at(dimension);
        let widths = lower.iter().zip(upper).zip(&self.scales);
        let widest = widths
            .map(|((lower, upper), scale)| (upper - lower) * scale)
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let (Some((axis, _)), Node::Leaf { numbers, points }) = (widest, &self.nodes[leaf]) else {
            return;
        };
        let mut order: Vec<f64> = points.iter().skip(axis).step_by(dimension).copied().collect();
        order.sort_unstable_by(f64::total_cmp);
        let middle = order.len() / 2;
        let steps = (1..order.len()).filter(|&i| order[i - 1] < order[i]);
        let Some(step) = steps.min_by_key(|&i| i.abs_diff(middle)) else {
            return;
        };
        let value = order[step];
        let mut parts = [(Vec::new(), Vec::new()), (Vec::new(), Vec::new())];
        for (point, &number) in points.chunks_exact(dimension).zip(numbers) {
            let (numbers, points) = &mut parts[usize::from(point[axis] >= value)];
            numbers.push(number);
            points.extend_from_slice(point);
        }
        let first = self.nodes.len();
        self.nodes[leaf] = Node::Split { axis, value, first };
        for (numbers, points) in parts {
            self.push_leaf(numbers, points);
        }
    }

    fn any(&self, point: &[f64], test: &mut impl FnMut(u32) -> bool) -> bool {
        !self.nodes.is_empty() && self.any_below(0, point, test)
    }

    fn any_below(&self, node: usize, point: &[f64], test: &mut impl FnMut(u32) -> bool) -> bool {
        if !self.is_box_near(node, point) {
            return false;
        }
        match &self.nodes[node] {
            Node::Split { axis, value, first } => {
                let own = usize::from(point[*axis] >= *value);
                self.any_below(first + own, point, test) || self.any_below(first + 1 - own, point, test)
            }
            Node::Leaf { numbers, points } => {
                let mut points = points.chunks_exact(self.dimension()).zip(numbers);
                points.any(|(other, &number)| self.is_near(point, other) && test(number))
            }
        }
    }

    fn is_near(&self, a: &[f64], b: &[f64]) -> bool {
        let lanes = a.chunks_exact(LANES).zip(b.chunks_exact(LANES));
        is_within(
            lanes.zip(self.scales.chunks_exact(LANES)),
            |((a, b), scales), lane| (a[lane] - b[lane]) * scales[lane],
        )
    }

    fn is_box_near(&self, node: usize, point: &[f64]) -> bool {
        let dimension = self.dimension();
        let (lower, upper) = self.boxes[2 * dimension * node..2 * dimension * (node + 1)].split_at(dimension);
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
        let leaves = self.nodes.iter().map(|node| match node {
            Node::Leaf { numbers, points } => numbers.capacity() * 4 + points.capacity() * 8,
            Node::Split { .. } => 0,
        });
        leaves.sum::<usize>() + self.nodes.capacity() * size_of::<Node>() + self.boxes.capacity() * 8
    }
}

//! Look-ups one after another, of points that differ in few coordinates: steps along axes from one place.
//!
//! In hundreds of dimensions such a point is near every box around the place, and each look-up would measure distances to all hits there along
//! all coordinates. So the hits around one of the points are kept with their distances, of which another point changes a few terms. After
//! Verlet 1967, doi 10.1103/PhysRev.159.98.

use std::sync::Mutex;

use super::{FARTHEST, Tree};

/// With fewer coordinates, a look-up in the tree costs little.
const MANY: usize = 32;
/// Points that differ in more coordinates do not follow each other.
const CHANGED: usize = 8;
/// How far a point is, at most, from the one whose hits are kept, in radii; a point that is the same as a hit is at most `ROUNDED` away
/// from it.
const REACH: f64 = 3.0;
const ROUNDED: f64 = 1.01;
/// Boxes and hits that a look-up in the tree has to look at until it is worth to keep a list; one that is longer by this factor costs more.
const WORTH: usize = 64;
const LONGER: usize = 4;
/// Look-ups until a list is tried again that was too long.
const WAIT: usize = 64;

/// The list of a tree. It changes nothing but the time of a look-up, so that one that is in use elsewhere is passed by, and a copy of the tree
/// begins without.
#[derive(Debug, Default)]
pub(super) struct Around(Mutex<List>);

impl Clone for Around {
    fn clone(&self) -> Self {
        Self::default()
    }
}

#[derive(Debug, Default)]
struct List {
    /// Where it is; empty without a list.
    centre: Vec<f64>,
    hits: Vec<Entry>,
    /// The point of the last look-up in the tree, and how many boxes and hits it looked at.
    last: Vec<f64>,
    cost: usize,
    /// Look-ups to wait for.
    wait: usize,
}

#[derive(Debug, Clone, Copy)]
struct Entry {
    number: u32,
    leaf: usize,
    /// Its first coordinate among those of the leaf.
    row: usize,
    /// The squared distance from the centre.
    square: f64,
}

/// The coordinates in which two points differ.
#[derive(Debug, Default)]
struct Changes {
    axes: [usize; CHANGED],
    count: usize,
}

impl Changes {
    /// `None` if they are many, or if the points are not near each other.
    fn between(from: &[f64], to: &[f64], tree: &Tree) -> Option<Self> {
        if from.len() != to.len() {
            return None;
        }
        let (mut changes, mut square) = (Self::default(), 0.0);
        for (axis, (a, b)) in from.iter().zip(to).enumerate() {
            if a != b {
                *changes.axes.get_mut(changes.count)? = axis;
                changes.count += 1;
                let distance = (a - b) * tree.scales[axis];
                square += distance * distance;
            }
        }
        (square <= REACH * REACH).then_some(changes)
    }

    fn axes(&self) -> &[usize] {
        &self.axes[..self.count]
    }
}

impl Around {
    /// Whether a hit that may be the same as `point` passes `test`; `None` where a look-up in the tree is as good.
    pub(super) fn any(
        &self,
        tree: &Tree,
        point: &[f64],
        left: &mut Vec<usize>,
        test: &mut impl FnMut(u32) -> bool,
    ) -> Option<bool> {
        if point.len() < MANY {
            return None;
        }
        let mut list = self.0.try_lock().ok()?;
        let changes = match Changes::between(&list.centre, point, tree) {
            Some(changes) => changes,
            None if list.is_worth(tree, point) && list.fill(tree, point, left) => Changes::default(),
            None => {
                let mut cost = 0;
                let found = tree.walk(point, left, test, &mut cost);
                list.note(point, cost);
                return Some(found);
            }
        };
        Some(list.any(tree, point, &changes, test))
    }

    /// A hit has come to the end of a leaf.
    pub(super) fn add(
        &mut self,
        number: u32,
        leaf: usize,
        row: usize,
        square: impl FnOnce(&[f64]) -> Option<f64>,
    ) {
        let Ok(list) = self.0.get_mut() else { return };
        if !list.centre.is_empty()
            && let Some(square) = square(&list.centre)
        {
            list.hits.push(Entry {
                number,
                leaf,
                row,
                square,
            });
        }
    }

    /// Hits have moved.
    pub(super) fn clear(&mut self) {
        if let Ok(list) = self.0.get_mut() {
            list.centre.clear();
            list.hits.clear();
        }
    }

    pub(super) fn bytes(&self) -> usize {
        self.0.try_lock().map_or(0, |list| {
            (list.centre.capacity() + list.last.capacity()) * 8 + list.hits.capacity() * size_of::<Entry>()
        })
    }
}

/// Squared distances of the hits that are kept are at most this.
pub(super) const WIDEST: f64 = (REACH + ROUNDED) * (REACH + ROUNDED);

impl List {
    /// Whether a point follows the last one, whose look-up was long.
    fn is_worth(&mut self, tree: &Tree, point: &[f64]) -> bool {
        let follows = self.cost >= WORTH && Changes::between(&self.last, point, tree).is_some();
        self.wait = self.wait.saturating_sub(usize::from(follows));
        follows && self.wait == 0
    }

    /// Lists the hits around a point; `false` if they are too many.
    fn fill(&mut self, tree: &Tree, point: &[f64], left: &mut Vec<usize>) -> bool {
        self.hits.clear();
        self.centre.clear();
        let most = LONGER * self.cost;
        let hits = &mut self.hits;
        let is_whole = tree.each_around(point, left, |number, leaf, row, square| {
            hits.push(Entry {
                number,
                leaf,
                row,
                square,
            });
            hits.len() <= most
        });
        if is_whole {
            self.centre.extend_from_slice(point);
        } else {
            self.hits.clear();
            self.wait = WAIT;
        }
        is_whole
    }

    /// Notes a look-up in the tree.
    fn note(&mut self, point: &[f64], cost: usize) {
        self.last.clear();
        self.last.extend_from_slice(point);
        self.cost = cost;
    }

    fn any(&self, tree: &Tree, point: &[f64], changes: &Changes, test: &mut impl FnMut(u32) -> bool) -> bool {
        self.hits.iter().any(|hit| {
            let place = tree.point(hit.leaf, hit.row);
            let term = |x: f64, axis: usize| {
                let distance = (x - place[axis]) * tree.scales[axis];
                distance * distance
            };
            let axes = changes.axes().iter();
            let square = axes.fold(hit.square, |square, &axis| {
                square + (term(point[axis], axis) - term(self.centre[axis], axis))
            });
            let is_far = square > FARTHEST;
            !is_far && test(hit.number)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One coordinate of each point differs from the first: that one look-up walks through the tree is enough for all of them.
    #[test]
    fn steps_from_one_place_need_no_walk_through_the_tree() {
        let axes = 200;
        let mut tree = Tree::new(&vec![0.5; axes]);
        let step = |axis: usize, length: f64| {
            let mut point = vec![0.0; axes];
            point[axis] = length;
            point
        };
        for axis in 0..axes {
            tree.insert(&step(axis, 0.6), u32::try_from(axis).unwrap());
        }
        let mut left = Vec::new();
        let mut numbers = |tree: &Tree, point: &[f64]| {
            let mut numbers = Vec::new();
            tree.any(point, &mut left, &mut |number| {
                numbers.push(number);
                false
            });
            numbers
        };
        numbers(&tree, &step(0, -0.1));
        numbers(&tree, &step(0, -0.2));
        for axis in 0..axes {
            // 0.6 from another one, along both axes; 0.3 from its own.
            assert_eq!(numbers(&tree, &step(axis, 0.9)), [u32::try_from(axis).unwrap()]);
        }
        let list = tree.around.0.lock().unwrap();
        assert_eq!(
            (list.hits.len(), &list.last),
            (axes, &step(0, -0.1)),
            "walked again"
        );
    }
}

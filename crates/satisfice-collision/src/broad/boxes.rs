//! A tree of boxes with eight children a node, without pointers: level 0 holds the items' boxes in groups of eight, and
//! box g of level k + 1 bounds group g of level k. Refitting is one pass from the bottom up. Items that are points are kept as
//! such, in half the memory.

use super::clip::{four, greater, lesser, wide};
use super::frame::{EDGE, LocalFrame};
use crate::simd::{Eight, Lanes, Work, dispatch};

/// A box of `f32` coordinates; empty if a lower side lies above its upper one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Box32 {
    pub(crate) min: [f32; 3],
    pub(crate) max: [f32; 3],
}

impl Box32 {
    /// Bounds nothing; at an infinite distance from everything.
    pub(crate) const EMPTY: Self = Self {
        min: [f32::INFINITY; 3],
        max: [f32::NEG_INFINITY; 3],
    };

    /// The smallest box around some points.
    #[inline(always)]
    pub(crate) fn around<const N: usize>(points: [[f32; 3]; N]) -> Self {
        points.iter().fold(Self::EMPTY, |bounds, point| Self {
            min: std::array::from_fn(|k| lesser(point[k], bounds.min[k])),
            max: std::array::from_fn(|k| greater(point[k], bounds.max[k])),
        })
    }

    /// The smallest box around both.
    #[inline]
    pub(crate) fn union(&self, other: &Self) -> Self {
        Self {
            min: std::array::from_fn(|k| lesser(other.min[k], self.min[k])),
            max: std::array::from_fn(|k| greater(other.max[k], self.max[k])),
        }
    }

    /// Twice the centre.
    #[inline]
    pub(crate) fn twice_centre(&self) -> [f32; 3] {
        std::array::from_fn(|k| self.min[k] + self.max[k])
    }

    /// The sum of the sides.
    #[inline]
    pub(crate) fn sum_of_sides(&self) -> f32 {
        (0..3).map(|k| self.max[k] - self.min[k]).sum()
    }
}

/// Eight boxes side by side.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Group {
    pub(crate) lower: [Eight; 3],
    pub(crate) upper: [Eight; 3],
}

impl Group {
    pub(crate) const EMPTY: Self = Self {
        lower: [[f32::INFINITY; 8]; 3],
        upper: [[f32::NEG_INFINITY; 8]; 3],
    };

    #[inline(always)]
    fn set(&mut self, lane: usize, to: &Box32) {
        for k in 0..3 {
            self.lower[k][lane] = to.min[k];
            self.upper[k][lane] = to.max[k];
        }
    }
}

/// The tree.
#[derive(Debug, Clone, Default)]
pub(crate) struct BoxTree {
    /// The item at each place of level 0.
    pub(crate) order: Vec<u32>,
    /// From the items' boxes up to the one group of the root.
    levels: Vec<Vec<Group>>,
    /// Level 0 of a tree of points; `levels[0]` is then empty. Copies of the last point fill the last group.
    points: Vec<[Eight; 3]>,
    /// Which lanes of each group hold an item that moved at the last refit.
    moved: Vec<Vec<u8>>,
}

/// Which items of a tree count as moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dirty {
    All,
    None,
    /// Those marked at the last refit.
    Marked,
}

impl BoxTree {
    /// Orders items with these boxes, which a refit then puts into the tree. Cost: O(n log n).
    pub(crate) fn order(boxes: &[Box32], are_points: bool, threads: usize) -> Self {
        let mut tree = Self {
            order: order_by_median(boxes.iter().map(Box32::twice_centre), threads > 1),
            ..Self::default()
        };
        let mut groups = boxes.len().div_ceil(8);
        if are_points {
            tree.points = vec![[[0.0; 8]; 3]; groups];
        }
        while groups > 0 {
            let boxes = if are_points && tree.levels.is_empty() {
                0
            } else {
                groups
            };
            tree.levels.push(vec![Group::EMPTY; boxes]);
            tree.moved.push(vec![0xff; groups]);
            groups = if groups == 1 { 0 } else { groups.div_ceil(8) };
        }
        tree
    }

    /// Refits the tree after its items have moved; `boxes` are by item. Cost: O(n), and no allocation.
    pub(crate) fn refit(&mut self, boxes: &[Box32], threads: usize) {
        let Some((items, above)) = self.levels.split_first_mut() else {
            return;
        };
        chunks(threads, items, &self.order, |items, order| {
            for (group, order) in items.iter_mut().zip(order.chunks(8)) {
                for (lane, &id) in order.iter().enumerate() {
                    group.set(lane, &boxes[id as usize]);
                }
            }
        });
        bound(items, above, threads);
    }

    /// [`Self::refit`] for a tree of points, in a frame.
    pub(crate) fn refit_points(&mut self, points: &[[f64; 3]], frame: &LocalFrame, threads: usize) {
        let Some((_, above)) = self.levels.split_first_mut() else {
            return;
        };
        chunks(threads, &mut self.points, &self.order, |groups, order| {
            dispatch(PlacePoints {
                points,
                frame,
                order,
                groups,
            });
        });
        if let Some((first, above)) = above.split_first_mut() {
            fill(&self.points, first, threads);
            bound(first, above, threads);
        }
    }

    /// All items moved, or none.
    pub(crate) fn mark_all(&mut self, moved: bool) {
        for level in &mut self.moved {
            level.fill(if moved { 0xff } else { 0 });
        }
    }

    /// Marks the items that moved, level by level. Cost: O(n).
    pub(crate) fn mark(&mut self, moved: impl Fn(u32) -> bool) {
        let pack = |lanes: &mut dyn Iterator<Item = bool>| {
            lanes
                .enumerate()
                .fold(0_u8, |mask, (lane, moved)| mask | (u8::from(moved) << lane))
        };
        for level in 0..self.moved.len() {
            let (below, level_and_above) = self.moved.split_at_mut(level);
            for (group, mask) in level_and_above[0].iter_mut().enumerate() {
                *mask = match below.last() {
                    None => {
                        let items = &self.order[group * 8..self.order.len().min(group * 8 + 8)];
                        pack(&mut items.iter().map(|&id| moved(id)))
                    }
                    Some(below) => {
                        let children = &below[group * 8..below.len().min(group * 8 + 8)];
                        pack(&mut children.iter().map(|&mask| mask != 0))
                    }
                };
            }
        }
    }

    /// The lanes of a group that count as moved.
    #[inline(always)]
    pub(crate) fn moved(&self, which: Dirty, level: u8, group: u32) -> u32 {
        match which {
            Dirty::All => 0xff,
            Dirty::None => 0,
            Dirty::Marked => u32::from(self.moved[level as usize][group as usize]),
        }
    }

    /// The sum of all sides of the boxes of level 1: the larger, the more boxes overlap. 0 if there is no such level.
    pub(crate) fn sum_of_sides(&self) -> f64 {
        let sides = |group: &Group| {
            let sides = group.lower.as_flattened().iter().zip(group.upper.as_flattened());
            // an empty box has none
            sides.map(|(low, high)| (high - low).max(0.0)).sum::<f32>()
        };
        let groups = self.levels.get(1).map_or(&[][..], Vec::as_slice);
        groups.iter().map(|group| f64::from(sides(group))).sum()
    }

    /// The number of items.
    pub(crate) fn len(&self) -> usize {
        self.order.len()
    }

    /// The level of the root; `None` if there are no items.
    pub(crate) fn root(&self) -> Option<u8> {
        self.levels.len().checked_sub(1).map(|level| level as u8)
    }

    /// A group of boxes; `room` is for one of points.
    #[inline(always)]
    pub(crate) fn group<'g>(&'g self, level: u8, group: u32, room: &'g mut Group) -> &'g Group {
        match self.points.get(group as usize) {
            Some(&points) if level == 0 => {
                *room = Group {
                    lower: points,
                    upper: points,
                };
                room
            }
            _ => &self.levels[level as usize][group as usize],
        }
    }

    /// A group of level 0 of a tree of points.
    #[inline(always)]
    pub(crate) fn points(&self, group: u32) -> &[Eight; 3] {
        &self.points[group as usize]
    }

    /// The number of lanes in use in a group.
    #[inline(always)]
    pub(crate) fn lanes(&self, level: u8, group: u32) -> usize {
        let items = match level {
            0 => self.order.len(),
            _ => self.moved[level as usize - 1].len(),
        };
        (items - group as usize * 8).min(8)
    }
}

/// Something that bounds a group of eight.
trait Bounded: Sync {
    fn bounds(&self) -> Box32;
}

impl Bounded for Group {
    #[inline(always)]
    fn bounds(&self) -> Box32 {
        Box32 {
            min: std::array::from_fn(|k| fold(&self.lower[k], lesser)),
            max: std::array::from_fn(|k| fold(&self.upper[k], greater)),
        }
    }
}

impl Bounded for [Eight; 3] {
    #[inline(always)]
    fn bounds(&self) -> Box32 {
        Box32 {
            min: std::array::from_fn(|k| fold(&self[k], lesser)),
            max: std::array::from_fn(|k| fold(&self[k], greater)),
        }
    }
}

/// Picks one of eight.
#[inline(always)]
pub(crate) fn fold(of: &Eight, pick: fn(f32, f32) -> f32) -> f32 {
    let four: [f32; 4] = std::array::from_fn(|i| pick(of[i], of[i + 4]));
    pick(pick(four[0], four[2]), pick(four[1], four[3]))
}

/// Gives `place` the groups of level 0 and the items in them, in parts if there are threads for it.
fn chunks<G: Send>(threads: usize, groups: &mut [G], order: &[u32], place: impl Fn(&mut [G], &[u32]) + Sync) {
    use rayon::prelude::*;
    if threads < 2 || order.len() < 20_000 {
        place(groups, order);
    } else {
        groups
            .par_chunks_mut(512)
            .zip(order.par_chunks(512 * 8))
            .for_each(|(groups, order)| place(groups, order));
    }
}

/// Bounds a level, each level above it in turn.
fn bound<'g>(mut below: &'g [Group], above: &'g mut [Vec<Group>], threads: usize) {
    for level in above {
        fill(below, level, threads);
        below = level;
    }
}

fn fill(below: &[impl Bounded], level: &mut [Group], threads: usize) {
    use rayon::prelude::*;
    if threads < 2 || level.len() < 4096 {
        let groups = level.iter_mut().zip(below.chunks(8));
        groups.for_each(|(group, children)| set_all(group, children));
    } else {
        let groups = level.par_iter_mut().with_min_len(512).zip(below.par_chunks(8));
        groups.for_each(|(group, children)| set_all(group, children));
    }
}

fn set_all(group: &mut Group, children: &[impl Bounded]) {
    for (lane, child) in children.iter().enumerate() {
        group.set(lane, &child.bounds());
    }
}

/// Points of a body, put into groups of eight.
struct PlacePoints<'a> {
    points: &'a [[f64; 3]],
    frame: &'a LocalFrame,
    order: &'a [u32],
    groups: &'a mut [[Eight; 3]],
}

impl Work for PlacePoints<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let (origin, axes) = (wide(self.frame.origin), self.frame.axes());
        for (group, order) in self.groups.iter_mut().zip(self.order.chunks(8)) {
            // the last group may have fewer than eight: one of them fills the other lanes
            let ids: [u32; 8] = std::array::from_fn(|lane| order[lane.min(order.len() - 1)]);
            let mut rows = [[0.0; 4]; 8];
            for lane in 0..8 {
                let point = four(self.points, ids[lane] as usize);
                rows[lane] = lanes.place(&point, &origin, self.frame.scale, axes);
            }
            *group = lanes.columns(&rows);
            if self.frame.has_far {
                for c in group.as_flattened_mut() {
                    *c = c.clamp(-EDGE, EDGE);
                }
            }
        }
    }
}

#[derive(Clone, Copy)]
#[repr(C)]
struct Item {
    /// The centre of the box, as integers in the same order.
    centre: [i32; 3],
    id: u32,
}

/// A number as an integer, in the order of [`f32::total_cmp`]; and back.
#[inline(always)]
fn in_order(bits: i32) -> i32 {
    bits ^ (bits >> 31 & i32::MAX)
}

/// The numbers of some boxes with these centres, up to a common factor, in an order in which every aligned run of 8, 64, 512, … is
/// compact. Cost: O(n log n).
pub(crate) fn order_by_median(centres: impl IntoIterator<Item = [f32; 3]>, parallel: bool) -> Vec<u32> {
    let mut items: Vec<Item> = (0_u32..)
        .zip(centres)
        .map(|(id, centre)| Item {
            centre: centre.map(|c| in_order(c.to_bits() as i32)),
            id,
        })
        .collect();
    split(&mut items, parallel);
    items.iter().map(|item| item.id).collect()
}

/// The least and the greatest centres; what comes fourth are numbers.
struct Extremes<'i>(&'i [Item]);

impl Work for Extremes<'_> {
    type Output = [[i32; 4]; 2];

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> [[i32; 4]; 2] {
        let (mut min, mut max) = ([i32::MAX; 4], [i32::MIN; 4]);
        for item in self.0 {
            let [x, y, z] = item.centre;
            // all four, so that the compiler takes one instruction
            let row = [x, y, z, item.id as i32];
            for k in 0..4 {
                min[k] = if row[k] < min[k] { row[k] } else { min[k] };
                max[k] = if row[k] > max[k] { row[k] } else { max[k] };
            }
        }
        [min, max]
    }
}

/// Orders items so that every aligned run of 8, 64, 512, … is compact: halves by the median along the longest axis of the
/// centres, at multiples of the largest run that is shorter than the whole.
fn split(items: &mut [Item], parallel: bool) {
    let n = items.len();
    if n <= 8 {
        return;
    }
    let mut run = 8;
    while run * 8 < n {
        run *= 8;
    }
    let at = n.div_ceil(run).div_ceil(2) * run;
    let [min, max] = dispatch(Extremes(items));
    let number = |centre: i32| f32::from_bits(in_order(centre) as u32);
    let extent = |k: usize| number(max[k]) - number(min[k]);
    let axis = (1..3).fold(0, |best, k| if extent(k) > extent(best) { k } else { best });
    if extent(axis) > 0.0 {
        items.select_nth_unstable_by_key(at, |item| item.centre[axis]);
    }
    let (left, right) = items.split_at_mut(at);
    if parallel && n > 20_000 {
        rayon::join(|| split(left, true), || split(right, true));
    } else {
        split(left, false);
        split(right, false);
    }
}

//! The first triangle of a posed tree that a segment meets: boxes in the order in which it enters them, triangles decided
//! exactly.
//!
//! A side of a box is wrong by at most e, the error of its frame, and the ends of the segment by 2^-46 times all lengths
//! involved, as in `relative`. Ways along the segment are computed in `f64`; their rounding moves a point of it by less than
//! 2^-48 times the coordinates of its ends. Boxes are inflated by all of that.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::boxes::Group;
use super::features::FeatureTree;
use super::frame::{LocalFrame, power_of_two};
use super::gaps::outwards;
use crate::Placement;
use crate::distance::first_point::FirstPoint;
use crate::distance::{Segment, Triangle};

/// A segment among boxes of some frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slabs {
    from: [f64; 3],
    way: [f64; 3],
    /// Boxes are inflated by this.
    error: f64,
}

impl Slabs {
    /// Between two points of the frame; sides of boxes are wrong by at most `error` and may not be finite.
    pub(crate) fn new([from, to]: Segment, error: f64) -> Self {
        let largest = from.iter().chain(&to).fold(0.0_f64, |most, c| most.max(c.abs()));
        let error = error + power_of_two(-48) * largest + power_of_two(-1000);
        let sane = largest < power_of_two(500) && error.is_finite();
        Self {
            from,
            way: std::array::from_fn(|k| to[k] - from[k]),
            error: if sane { error } else { f64::INFINITY },
        }
    }

    /// The part of the way on which a box is entered, rounded down; `None` if the segment misses it.
    #[inline(always)]
    pub(crate) fn entry<T: Into<f64>>(&self, lower: [T; 3], upper: [T; 3]) -> Option<f64> {
        if self.error == f64::INFINITY {
            return Some(0.0);
        }
        let (mut enter, mut leave) = (0.0, 1.0);
        let (lower, upper) = (lower.map(T::into), upper.map(T::into));
        for k in 0..3 {
            let low = lower[k] - self.error - self.from[k];
            let high = upper[k] + self.error - self.from[k];
            let way = self.way[k];
            if way.abs() <= self.error {
                if low > self.error || high < -self.error {
                    return None;
                }
                continue;
            }
            let (one, two) = (low / way, high / way);
            let (first, last) = if way > 0.0 { (one, two) } else { (two, one) };
            enter = if first > enter { first } else { enter };
            leave = if last < leave { last } else { leave };
        }
        (enter <= leave).then_some(enter)
    }
}

/// The first triangle that a segment meets, over any number of trees; of several at once, the one with the least key.
#[derive(Debug)]
pub(crate) struct FirstHit<T> {
    segment: Segment,
    hit: Option<(FirstPoint, Triangle, T)>,
}

impl<T: Ord + Copy> FirstHit<T> {
    /// Nothing yet.
    pub(crate) fn new(segment: Segment) -> Self {
        Self { segment, hit: None }
    }

    /// Hits beyond this parameter no longer matter.
    pub(crate) fn bound(&self) -> f64 {
        self.hit.as_ref().map_or(1.0, |(first, ..)| first.at_most())
    }

    fn offer(&mut self, triangle: Triangle, key: T) {
        let Some(mut first) = FirstPoint::find(&self.segment, &triangle) else {
            return;
        };
        if let Some((best, of, known)) = &mut self.hit {
            let order = FirstPoint::compare(&self.segment, (&mut first, &triangle), (best, of));
            if order.then_with(|| key.cmp(known)).is_ge() {
                return;
            }
        }
        self.hit = Some((first, triangle, key));
    }

    /// Adds the hits of the segment in a tree of triangles; triangles that `keep` rejects do not count.
    pub(crate) fn add(
        &mut self,
        (tree, pose): (&FeatureTree, &Placement),
        keep: impl Fn(u32) -> bool,
        key: impl Fn(u32) -> T,
    ) {
        let slabs = in_body(tree, pose, &self.segment);
        let mut open = BinaryHeap::new();
        if let Some(root) = tree.tree.root() {
            open.push(Reverse((0, root, 0)));
        }
        while let Some(Reverse((entry, level, group))) = open.pop() {
            if f64::from_bits(entry) > self.bound() {
                return;
            }
            let mut room = Group::EMPTY;
            let boxes = tree.tree.group(level, group, &mut room);
            for lane in 0..tree.tree.lanes(level, group) {
                let entry = enter(&slabs, &tree.frame, boxes, lane);
                let Some(entry) = entry.filter(|&entry| entry <= self.bound()) else {
                    continue;
                };
                let below = group * 8 + lane as u32;
                if level > 0 {
                    open.push(Reverse((entry.to_bits(), level - 1, below)));
                    continue;
                }
                let triangle = tree.tree.order[below as usize];
                if keep(triangle) {
                    self.offer(tree.triangle(triangle).map(|p| pose.apply(p)), key(triangle));
                }
            }
        }
    }

    /// The key of the first hit, and its parameter along the segment.
    pub(crate) fn found(self) -> Option<(T, f64)> {
        let (mut first, triangle, key) = self.hit?;
        Some((key, first.value(&self.segment, &triangle)))
    }
}

/// Visits all triangles that a segment meets, and others near it, in no order.
pub(crate) fn near_segment(
    (tree, pose): (&FeatureTree, &Placement),
    segment: &Segment,
    mut visit: impl FnMut(u32),
) {
    let slabs = in_body(tree, pose, segment);
    let mut open: Vec<_> = tree.tree.root().map(|root| (root, 0)).into_iter().collect();
    while let Some((level, group)) = open.pop() {
        let mut room = Group::EMPTY;
        let boxes = tree.tree.group(level, group, &mut room);
        for lane in 0..tree.tree.lanes(level, group) {
            if enter(&slabs, &tree.frame, boxes, lane).is_none() {
                continue;
            }
            let below = group * 8 + lane as u32;
            match level.checked_sub(1) {
                Some(level) => open.push((level, below)),
                None => visit(tree.tree.order[below as usize]),
            }
        }
    }
}

/// The part of the way on which one of eight boxes of a frame is entered.
#[inline(always)]
fn enter(slabs: &Slabs, frame: &LocalFrame, boxes: &Group, lane: usize) -> Option<f64> {
    let side = |of: &[[f32; 8]; 3]| std::array::from_fn(|k| of[k][lane]);
    let (lower, upper) = (side(&boxes.lower), side(&boxes.upper));
    if frame.has_far {
        let [lower, upper] = outwards(frame, &lower, &upper);
        slabs.entry(lower, upper)
    } else {
        slabs.entry(lower, upper)
    }
}

/// A segment of the world in the frame of a body.
fn in_body(tree: &FeatureTree, pose: &Placement, segment: &Segment) -> Slabs {
    let frame = &tree.frame;
    let (rotation, shift) = (pose.rotation(), pose.translation());
    let ends = segment.map(|point| {
        let away: [f64; 3] = std::array::from_fn(|k| point[k] - shift[k]);
        std::array::from_fn(|i| {
            let local: f64 = if *pose == Placement::IDENTITY {
                point[i]
            } else {
                (0..3).map(|k| rotation[k][i] * away[k]).sum()
            };
            (local - frame.origin[i]) * frame.scale
        })
    });
    let largest = |v: &[f64; 3]| v.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
    let lengths = [&segment[0], &segment[1], &shift, &frame.origin]
        .map(largest)
        .iter()
        .sum::<f64>();
    Slabs::new(
        ends,
        frame.error + power_of_two(-45) * (lengths * frame.scale + frame.half),
    )
}

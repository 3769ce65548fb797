//! Polygons cut into triangles that cover them.
//!
//! A polygon is seen along its Newell normal. Whatever its corners are joined to, its triangles cover a point as often as it winds around
//! the point, those that are turned the other way counted with the opposite sign. So triangles of a simple polygon cover it and nothing
//! else, and do not overlap, exactly if all of them are turned the same way. The fan about the first corner is one such choice for a
//! convex polygon. For others ears are cut off: corners whose triangle is turned the right way and has no other corner in it. A simple
//! polygon always has one (Meisters 1975). Turns are decided exactly.

use std::collections::BTreeSet;

use super::hollows::{Hollows, Left};
use crate::broad::{exponent, power_of_two};
use crate::distance::Point;
use crate::distance::orientation::side_of_line;

/// A polygon whose ears take more looks at corners, and at boxes of corners, stays a fan.
const MOST_LOOKS: u64 = 1 << 28;
/// How often corners without a turn, such as repeated ones, are cut off because no ear is left.
const MOST_PASSES: usize = 4;

/// The triangles of a polygon, two fewer than it has corners.
pub(super) enum Cut {
    /// The fan about its first corner covers it.
    Fan,
    /// These do.
    Ears(Vec<[u32; 3]>),
    /// None were found that do, as where the polygon crosses itself.
    Nothing,
}

/// How a polygon is to be cut.
pub(super) fn cut(corners: &[u32], vertices: &[Point]) -> Cut {
    let Some(points) = seen_along_normal(corners, vertices) else {
        return if are_on_a_line(corners, vertices) {
            Cut::Fan
        } else {
            Cut::Nothing
        };
    };
    let fan = (2..points.len()).map(|k| turn(&points, [0, k - 1, k]));
    let (mut left, mut right) = (false, false);
    for turn in fan {
        left |= turn > 0;
        right |= turn < 0;
    }
    if !(left && right) {
        return Cut::Fan;
    }
    match Ring::new(&points).and_then(Ring::cut) {
        Some(ears) => Cut::Ears(ears.into_iter().map(|ear| ear.map(|k| corners[k])).collect()),
        None => Cut::Nothing,
    }
}

/// Whether all corners lie on one line.
fn are_on_a_line(corners: &[u32], vertices: &[Point]) -> bool {
    let points = || corners.iter().map(|&v| vertices[v as usize]);
    let first = vertices[corners[0] as usize];
    let Some(other) = points().find(|&p| p != first) else {
        return true;
    };
    points().all(|p| (0..3).all(|k| side_of_line(first, other, p, k) == 0))
}

/// The corners projected along the Newell normal onto a plane of two axes; `None` without a normal. Those in a plane of two axes keep their
/// coordinates up to the unit.
fn seen_along_normal(corners: &[u32], vertices: &[Point]) -> Option<Vec<Point>> {
    let all = || corners.iter().map(|&v| vertices[v as usize]);
    let size = all().flatten().fold(0.0_f64, |most, c| most.max(c.abs()));
    let scale = power_of_two((-exponent(size)).clamp(-1022, 1022));
    let origin = vertices[corners[0] as usize];
    let mut points: Vec<Point> = all()
        .map(|p| std::array::from_fn(|k| p[k] * scale - origin[k] * scale))
        .collect();
    let mut normal = [0.0; 3];
    for (p, q) in points.iter().zip(points.iter().cycle().skip(1)) {
        for (k, sum) in normal.iter_mut().enumerate() {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            *sum += (p[i] - q[i]) * (p[j] + q[j]);
        }
    }
    let axis = (1..3).fold(0, |most, k| {
        if normal[k].abs() > normal[most].abs() {
            k
        } else {
            most
        }
    });
    if normal[axis] == 0.0 {
        return None;
    }
    // along the normal onto the plane through the first corner, then along the axis
    let slope = normal.map(|c| c / normal[axis]);
    let square = slope.iter().map(|c| c * c).sum::<f64>();
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    for p in &mut points {
        let height = (0..3).map(|k| p[k] * slope[k]).sum::<f64>() / square;
        *p = [p[i] - height * slope[i], p[j] - height * slope[j], 0.0];
    }
    Some(points)
}

/// 1 if the way through three points turns left, -1 if it turns right.
fn turn(points: &[Point], [a, b, c]: [usize; 3]) -> i32 {
    side_of_line(points[a], points[b], points[c], 0)
}

/// The corners of a polygon that are not yet cut off.
struct Ring<'p> {
    points: &'p [Point],
    /// Which way the polygon turns around what is inside.
    way: i32,
    previous: Vec<usize>,
    next: Vec<usize>,
    /// Of each corner how its triangle turns: 1 as the polygon does.
    turns: Vec<i32>,
    /// Those that are left and do not turn as the polygon does.
    hollows: Hollows,
    /// Those whose triangles can be cut off.
    ears: BTreeSet<usize>,
    left: usize,
    /// A corner that is left.
    at: usize,
    triangles: Vec<[usize; 3]>,
}

impl<'p> Ring<'p> {
    /// `None` if the outermost corner has no turn.
    fn new(points: &'p [Point]) -> Option<Self> {
        let count = points.len();
        let mut ring = Self {
            points,
            way: 1,
            previous: (0..count).map(|k| (k + count - 1) % count).collect(),
            next: (0..count).map(|k| (k + 1) % count).collect(),
            turns: vec![0; count],
            hollows: Hollows::new(points),
            ears: BTreeSet::new(),
            left: count,
            at: 0,
            triangles: Vec::with_capacity(count - 2),
        };
        ring.way = ring.way_at_outermost()?;
        ring.look_at_all();
        Some(ring)
    }

    /// The outermost corner of a polygon turns as the polygon does.
    fn way_at_outermost(&self) -> Option<i32> {
        let points = self.points;
        let by_place = |&a: &usize, &b: &usize| {
            points[a]
                .partial_cmp(&points[b])
                .unwrap_or(std::cmp::Ordering::Equal)
        };
        let outermost = (0..points.len()).min_by(by_place)?;
        let other = |step: fn(&Self, usize) -> usize| {
            let mut corner = step(self, outermost);
            while points[corner] == points[outermost] && corner != outermost {
                corner = step(self, corner);
            }
            corner
        };
        let (before, after) = (other(|ring, k| ring.previous[k]), other(|ring, k| ring.next[k]));
        Some(turn(points, [before, outermost, after])).filter(|&way| way != 0)
    }

    /// Cuts off ears until a triangle is left; `None` if there is a polygon without an ear, or if it takes too long.
    fn cut(mut self) -> Option<Vec<[usize; 3]>> {
        let mut passes = 0;
        while self.left > 3 {
            if self.hollows.looks > MOST_LOOKS {
                return None;
            }
            if self.find_ear() {
                let [before, after] = self.cut_off(self.at);
                self.look(before);
                self.look(after);
                // not the neighbour, whose ears are long and thin
                self.at = self.next[after];
            } else if passes < MOST_PASSES {
                passes += 1;
                if !self.cut_off_straight() {
                    return None;
                }
                self.look_at_all();
            } else {
                return None;
            }
        }
        let last = self.triangle(self.at);
        self.triangles.push(last);
        (self.way * turn(self.points, last) >= 0).then_some(self.triangles)
    }

    /// Goes on to the next ear.
    fn find_ear(&mut self) -> bool {
        let behind = self.ears.range(self.at..).next();
        let Some(&ear) = behind.or(self.ears.first()) else {
            return false;
        };
        self.at = ear;
        true
    }

    fn triangle(&self, corner: usize) -> [usize; 3] {
        [self.previous[corner], corner, self.next[corner]]
    }

    fn cut_off(&mut self, corner: usize) -> [usize; 2] {
        let triangle = self.triangle(corner);
        let [before, _, after] = triangle;
        self.triangles.push(triangle);
        self.next[before] = after;
        self.previous[after] = before;
        self.hollows.mark(corner, false);
        self.ears.remove(&corner);
        self.left -= 1;
        self.at = after;
        [before, after]
    }

    /// Cuts off corners without a turn. Whether there was one.
    fn cut_off_straight(&mut self) -> bool {
        let before = self.left;
        for _ in 0..before {
            if self.left > 3 && turn(self.points, self.triangle(self.at)) == 0 {
                self.cut_off(self.at);
            } else {
                self.at = self.next[self.at];
            }
        }
        self.left < before
    }

    fn look_at_all(&mut self) {
        for _ in 0..self.left {
            self.look_at_turn(self.at);
            self.at = self.next[self.at];
        }
        for _ in 0..self.left {
            self.look_for_ear(self.at);
            self.at = self.next[self.at];
        }
    }

    fn look(&mut self, corner: usize) {
        self.look_at_turn(corner);
        self.look_for_ear(corner);
    }

    fn look_at_turn(&mut self, corner: usize) {
        self.turns[corner] = self.way * turn(self.points, self.triangle(corner));
        self.hollows.mark(corner, self.turns[corner] <= 0);
    }

    fn look_for_ear(&mut self, corner: usize) {
        if self.is_ear_now(corner) {
            self.ears.insert(corner);
        } else {
            self.ears.remove(&corner);
        }
    }

    /// Whether the triangle of a corner is turned as the polygon is, and has no other corner in it. If any is in it, so is one that turns
    /// the other way or not at all.
    fn is_ear_now(&mut self, corner: usize) -> bool {
        if self.turns[corner] <= 0 || self.hollows.looks > MOST_LOOKS {
            return false;
        }
        let mut own = self.triangle(corner).map(|k| self.points[k]);
        if self.way < 0 {
            own.swap(0, 2);
        }
        let points = self.points;
        let is_inside = |other: usize| {
            let point = points[other];
            let [a, b, c] = own;
            let is_left_of = |[from, to]: [Point; 2]| side_of_line(from, to, point, 0) >= 0;
            !own.contains(&point) && [[a, b], [b, c], [c, a]].into_iter().all(is_left_of)
        };
        !self.hollows.any_in(Left(own), is_inside)
    }
}

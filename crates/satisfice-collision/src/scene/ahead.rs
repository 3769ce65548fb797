//! Next boxes of bodies that leave theirs and are not turned.

use super::body_tree::{BodyTree, Change, TreeFrame};
use super::pairs::{NONE, Records};
use super::settle::{ALONE, ASIDE, FRAMES, MOST, MOST_ASIDE};
use super::whereabouts::{Room, Whereabouts};
use crate::broad::Box32;
use crate::mesh::Point;
use crate::simd::{DoubleNumber, Floats as _, Lanes, Work};

/// Gives bodies boxes that hold them for some frames; returns those for which that takes more.
pub(super) struct Ahead<'a> {
    pub(super) leaving: &'a [u32],
    pub(super) whereabouts: &'a mut [Whereabouts],
    pub(super) rooms: &'a mut [Room],
    pub(super) hulls: &'a [Box32],
    pub(super) tree: &'a BodyTree,
    pub(super) pairs: &'a Records,
    /// The boxes hold this much around the bodies.
    pub(super) half: f64,
    pub(super) changes: &'a mut Vec<Change>,
}

impl Work for Ahead<'_> {
    type Output = Vec<u32>;

    #[inline(always)]
    fn run<L: Lanes>(self, unit: L) -> Vec<u32> {
        let frame = self.tree.frame();
        let mut others = Vec::new();
        for &slot in self.leaving {
            let whereabouts = &mut self.whereabouts[slot as usize];
            let (room, hull) = (&mut self.rooms[slot as usize], &self.hulls[slot as usize]);
            // a body that was removed, replaced or placed again may stay
            if !whereabouts.set_leaves(false) || room.holds(frame, whereabouts.next()) {
                continue;
            }
            match whereabouts.upright_way() {
                Some(way) if !hull.is_empty() => {
                    let is_alone = self.pairs.first(slot) == NONE;
                    let (bounds, next) = ahead(unit, frame, hull, way, self.half, is_alone);
                    *room = next;
                    self.changes.push(Change::to(slot, bounds));
                }
                _ => others.push(slot),
            }
        }
        others
    }
}

/// A box in the tree that will hold a body with this hull, and `half` around it, for some frames if it continues as on its way, and for
/// some fewer if it turns; and where the body may be moved so that the box still does.
#[inline(always)]
pub(super) fn ahead<L: Lanes>(
    unit: L,
    frame: &TreeFrame,
    hull: &Box32,
    [from, to]: [Point; 2],
    half: f64,
    is_alone: bool,
) -> (Box32, Room) {
    // what goes to the standard library as a closure would not be compiled for the unit
    let d = unit.double();
    let four = |p: &Point| d.load(&[p[0], p[1], p[2], 0.0]);
    let broad = |p: &[f32; 3]| d.load(&[f64::from(p[0]), f64::from(p[1]), f64::from(p[2]), 0.0]);
    let largest = |x: DoubleNumber<L>| {
        let [x, y, z, _] = d.store(d.abs(x));
        x.max(y).max(z)
    };
    let zero = d.splat(0.0);
    let (from, to, origin) = (four(&from), four(&to), four(&frame.origin));
    let (low, high) = (broad(&hull.min), broad(&hull.max));
    let (size, reach) = (largest(d.sub(high, low)), largest(d.max(d.abs(low), d.abs(high))));
    // as far as rounding moves the sides of a posed box
    let slack = |far: f64| half + 4e-14 * (reach + far) + f64::MIN_POSITIVE;

    let step = d.sub(to, from);
    let [x, y, z, _] = d.store(d.mul(step, step));
    let out = d.sub(to, origin);
    // slow bodies have some steps of `f32` to go
    let least = 4.0 * f64::from(f32::EPSILON) * largest(out);
    let wide = if is_alone { ALONE } else { 1.0 };
    let aside = (wide * (ASIDE * (x + y + z).sqrt()).min(MOST_ASIDE * size)).max(least);
    let way = d.mul(step, d.splat(FRAMES));
    let way = d.min(d.max(way, d.splat(-MOST * size)), d.splat(MOST * size));
    let by = d.splat(aside + slack(largest(to)));
    let min = d.add(d.sub(d.add(to, low), by), d.min(way, zero));
    let max = d.add(d.add(d.add(to, high), by), d.max(way, zero));
    let scale = d.splat(frame.scale);
    let min = d.store(d.mul(d.sub(min, origin), scale));
    let max = d.store(d.mul(d.sub(max, origin), scale));
    let bounds = Box32::outside(&[min[0], min[1], min[2]], &[max[0], max[1], max[2]]);

    let (min, max) = (broad(&bounds.min), broad(&bounds.max));
    let far = largest(d.max(d.abs(min), d.abs(max))) * frame.unit + largest(origin);
    let by = d.splat(slack(far) + 1e-15 * far);
    let min = d.store(d.sub(min, d.mul(d.sub(low, by), scale)));
    let max = d.store(d.sub(max, d.mul(d.add(high, by), scale)));
    let room = Room::within(&[min[0], min[1], min[2]], &[max[0], max[1], max[2]]);
    (bounds, room)
}

//! Pairs of points in neighbouring cells: candidates gathered a cell at a time, tested eight at once.

use std::ops::Range;

use super::cells::{Cells, Sorted};
use super::clip::{greater, lesser};
use super::exact::ExactTest;
use super::frame::Filter;
use super::pair::Pair;
use super::watch::Watch;
use crate::simd::{Eight, Lanes, Work};

/// Tests between two calls of the watch: tens of microseconds.
const LOOK: u64 = 1 << 16;
/// A cell with more tests than this is left to trees.
const DENSE: usize = 1 << 17;

/// A cell with too many tests: the numbers of its points and of their candidates.
#[derive(Debug)]
pub(crate) struct DenseCell {
    pub(crate) a: Vec<u32>,
    pub(crate) b: Vec<u32>,
}

/// The memory of a task, kept between frames.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    near: [Vec<f32>; 3],
    near_id: Vec<u32>,
    /// The pairs found.
    pub(crate) found: Vec<Pair>,
    /// Cells left to trees.
    pub(crate) dense_cells: Vec<DenseCell>,
    /// Squared distances computed.
    pub(crate) tests: u64,
    /// Pairs decided exactly because the filter could not.
    pub(crate) in_band: u64,
    /// The number of tests at which to ask the watch next, and the number of pairs already reported to it.
    next_look: u64,
    told: usize,
}

impl Scratch {
    pub(crate) fn clear(&mut self) {
        self.found.clear();
        self.dense_cells.clear();
        self.tests = 0;
        self.in_band = 0;
        self.next_look = LOOK;
        self.told = 0;
    }

    /// Asks the watch whether to stop.
    fn is_enough(&mut self, watch: &Watch<'_>) -> bool {
        self.next_look = self.tests + LOOK;
        let new = self.found.len() - std::mem::replace(&mut self.told, self.found.len());
        watch.ask(new)
    }

    #[inline(always)]
    fn room(&mut self, len: usize) {
        if self.near_id.len() < len {
            self.grow(len.next_power_of_two());
        }
    }

    #[cold]
    fn grow(&mut self, len: usize) {
        self.near_id.resize(len, 0);
        for axis in &mut self.near {
            axis.resize(len, f32::INFINITY);
        }
    }
}

/// Joins the points of some layers of `a` with those of `b`; with `ONE_BODY` both are the same and each pair is found once.
pub(crate) struct Join<'a, const ONE_BODY: bool> {
    pub(crate) a: &'a Sorted,
    pub(crate) b: &'a Sorted,
    pub(crate) cells: &'a Cells,
    pub(crate) filter: &'a Filter,
    pub(crate) decide: &'a ExactTest<'a>,
    pub(crate) layers: Range<usize>,
    pub(crate) watch: &'a Watch<'a>,
    pub(crate) scratch: &'a mut Scratch,
}

impl<const ONE_BODY: bool> Work for Join<'_, ONE_BODY> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self, lanes: L) {
        let cells = *self.cells;
        let first = self.layers.start * cells.layer();
        let last = self.layers.end * cells.layer();
        for cell in first..last {
            let own = self.a.start[cell] as usize..self.a.start[cell + 1] as usize;
            if !own.is_empty() && self.cell(lanes, cell, own) {
                return;
            }
        }
    }
}

impl<const ONE_BODY: bool> Join<'_, ONE_BODY> {
    /// Joins a cell. Returns whether the watch says to stop.
    #[inline(always)]
    fn cell<L: Lanes>(&mut self, lanes: L, cell: usize, own: Range<usize>) -> bool {
        let reach = self.filter.reach;
        let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for k in 0..3 {
            for &c in &self.a.c[k][own.clone()] {
                min[k] = lesser(c, min[k]);
                max[k] = greater(c, max[k]);
            }
            min[k] -= reach;
            max[k] += reach;
        }
        let near = self.gather(lanes, cell, &own, min, max);
        if near == 0 {
            return false;
        }
        if own.len() * near > DENSE {
            let others = usize::from(ONE_BODY) * own.len();
            let dense = DenseCell {
                a: self.a.id[own].to_vec(),
                b: self.scratch.near_id[others..near].to_vec(),
            };
            self.scratch.dense_cells.push(dense);
            return false;
        }
        for (i, at) in own.enumerate() {
            let q = [self.a.c[0][at], self.a.c[1][at], self.a.c[2][at]];
            let skip = if ONE_BODY { i + 1 } else { 0 };
            self.scan(lanes, q, self.a.id[at], skip, near);
            self.scratch.tests += near as u64;
            if self.scratch.tests >= self.scratch.next_look && self.scratch.is_enough(self.watch) {
                return true;
            }
        }
        false
    }

    /// Copies the candidates of a cell side by side: in one body its own points first, then those of cells that follow it.
    #[inline(always)]
    fn gather<L: Lanes>(
        &mut self,
        lanes: L,
        cell: usize,
        own: &Range<usize>,
        min: [f32; 3],
        max: [f32; 3],
    ) -> usize {
        let cells = self.cells;
        let [columns, rows, _] = cells.count();
        let range = |k: usize| cells.cell(k, min[k])..cells.cell(k, max[k]) + 1;
        let (xs, ys, mut zs) = (range(0), range(1), range(2));
        if ONE_BODY {
            zs.start = cell / (columns * rows);
        }
        let start = &self.b.start[..];
        let points = |z: usize, y: usize| {
            let row = (z * rows + y) * columns;
            let (mut from, to) = (row + xs.start, row + xs.end);
            if ONE_BODY {
                from = from.max(cell + 1).min(to);
            }
            start[from] as usize..start[to] as usize
        };
        let mut most = own.len();
        for z in zs.clone() {
            for y in ys.clone() {
                most += points(z, y).len();
            }
        }
        self.scratch.room(most + 16);
        let Scratch {
            near: [nx, ny, nz],
            near_id,
            ..
        } = &mut *self.scratch;
        let [x, y, z] = &self.b.c;
        let mut copy = Copied {
            from: [x, y, z],
            from_id: &self.b.id,
            to: [nx, ny, nz],
            to_id: near_id,
            len: 0,
        };
        if ONE_BODY {
            copy.append(lanes, own.clone(), min, max);
        }
        for z in zs {
            for y in ys.clone() {
                copy.append(lanes, points(z, y), min, max);
            }
        }
        // the unused lanes of the last eight must not be candidates
        let len = copy.len;
        for axis in copy.to {
            axis[len..len + 8].fill(f32::INFINITY);
        }
        len
    }

    /// Tests one point against the gathered candidates from `skip` on.
    #[inline(always)]
    fn scan<L: Lanes>(&mut self, lanes: L, q: [f32; 3], id: u32, skip: usize, near: usize) {
        let Filter {
            definitely_inside_sq,
            definitely_outside_sq,
            ..
        } = *self.filter;
        let Scratch {
            near: [nx, ny, nz],
            near_id,
            found,
            in_band,
            ..
        } = &mut *self.scratch;
        let mut base = skip & !7;
        let mut first = !0_u64 << (skip - base);
        while base < near {
            // 64 candidates without a branch, then only the hits
            let mut bits = 0_u64;
            let mut at = base;
            let mut lane = 0;
            while at < near && lane < 64 {
                let c = [eight(nx, at), eight(ny, at), eight(nz, at)];
                bits |= u64::from(lanes.closer(c, q, definitely_outside_sq)) << lane;
                at += 8;
                lane += 8;
            }
            bits &= first;
            first = !0;
            while bits != 0 {
                let at = base + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                let (dx, dy, dz) = (nx[at] - q[0], ny[at] - q[1], nz[at] - q[2]);
                let (mut a, mut b) = (id, near_id[at]);
                if ONE_BODY && a > b {
                    (a, b) = (b, a);
                }
                if dx * dx + dy * dy + dz * dz >= definitely_inside_sq {
                    *in_band += 1;
                    if !self.decide.closer(a, b) {
                        continue;
                    }
                }
                found.push(Pair { a, b });
            }
            base += 64;
        }
    }
}

/// Candidates being copied side by side. All are slices, whose places the compiler can keep in registers.
struct Copied<'a> {
    from: [&'a [f32]; 3],
    from_id: &'a [u32],
    to: [&'a mut [f32]; 3],
    to_id: &'a mut [u32],
    len: usize,
}

impl Copied<'_> {
    /// Appends those of the sorted points `range` that lie inside the box, eight at a time.
    #[inline(always)]
    fn append<L: Lanes>(&mut self, lanes: L, range: Range<usize>, min: [f32; 3], max: [f32; 3]) {
        let [x, y, z] = self.from;
        let mut at = range.start;
        while at < range.end {
            let (x, y, z) = (eight(x, at), eight(y, at), eight(z, at));
            let rest = range.end - at;
            let valid = if rest < 8 { (1 << rest) - 1 } else { 0xff };
            let mask = lanes.inside([x, y, z], min, max) & valid;
            let [nx, ny, nz] = &mut self.to;
            lanes.compact(x, mask, eight_mut(nx, self.len));
            lanes.compact(y, mask, eight_mut(ny, self.len));
            lanes.compact(z, mask, eight_mut(nz, self.len));
            lanes.compact_ids(
                id_eight(self.from_id, at),
                mask,
                id_eight_mut(self.to_id, self.len),
            );
            self.len += mask.count_ones() as usize;
            at += 8;
        }
    }
}

// Eight neighbours of a slice; `Sorted` is padded and `Scratch::room` makes room, so that the indices are in range.
#[inline(always)]
#[expect(clippy::unwrap_used, reason = "a slice of length eight is an array of eight")]
pub(crate) fn eight(of: &[f32], at: usize) -> &Eight {
    of[at..at + 8].try_into().unwrap()
}

#[inline(always)]
#[expect(clippy::unwrap_used, reason = "a slice of length eight is an array of eight")]
fn eight_mut(of: &mut [f32], at: usize) -> &mut Eight {
    (&mut of[at..at + 8]).try_into().unwrap()
}

#[inline(always)]
#[expect(clippy::unwrap_used, reason = "a slice of length eight is an array of eight")]
pub(crate) fn id_eight(of: &[u32], at: usize) -> &[u32; 8] {
    of[at..at + 8].try_into().unwrap()
}

#[inline(always)]
#[expect(clippy::unwrap_used, reason = "a slice of length eight is an array of eight")]
fn id_eight_mut(of: &mut [u32], at: usize) -> &mut [u32; 8] {
    (&mut of[at..at + 8]).try_into().unwrap()
}

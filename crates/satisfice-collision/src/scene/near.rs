//! Lists of near vertices that outlive motion: a Verlet list whose vertices are looked up anew one by one.
//!
//! Every moving vertex i has a reference point r_i: where it was when it was looked up last. Listed are the pairs with
//! |r_i - r_j| < delta + 2 m. While no vertex is m or more away from its reference, every pair within delta is listed, by the
//! triangle inequality. A vertex that has gone so far gets a new reference and is looked up among the others in a hashed grid of
//! references; the rest of the list stays.
//!
//! Only relative motion counts: coordinates are taken less a drift that is common to all vertices, so that a body in free fall
//! keeps its list. Verlet 1967, doi 10.1103/PhysRev.159.98.

use crate::distance::{Point, Threshold, vertex_vertex};

/// m, in thresholds. Larger lists are looked through longer, smaller ones live shorter.
const MARGIN: f64 = 0.5;
/// From this share of vertices to look up on, a new grid is cheaper. Measured on a cloth: a look costs 0.5 us, a grid 0.1 us a
/// vertex.
const MOST_LOOKED_UP: f64 = 0.12;
/// Coordinates are at most so many cells from the origin: then roundings are far below [`SLACK`], and no cell has two names.
const FARTHEST: f64 = (1 << 20) as f64;
/// What roundings of coordinates, drifts and cells may cost, relative to a reach.
const SLACK: f64 = 1e-6;
/// Thresholds of which all squares are normal numbers.
const SANE: std::ops::Range<f64> = 1e-140..1e140;
/// Listed pairs a vertex, on average: beyond, the list is no longer cheap to look through, nor small.
const MOST_LISTED: usize = 48;
/// Vertices that tell the drift.
const SAMPLE: usize = 65;

/// The lists of a deforming body's vertices among themselves.
pub(super) struct NearList {
    threshold: Threshold,
    margin: f64,
    reach: f64,
    drift: Point,
    /// The references, less the drift: where the vertices were when they were looked up last.
    table: Table,
    /// When that was: a pair counts in the list of the one that was looked up later.
    stamps: Vec<u64>,
    clock: u64,
    lists: Lists,
    leavers: Vec<u32>,
}

impl NearList {
    /// How far a vertex may go before it is looked up anew.
    pub(super) fn margin(threshold: Threshold) -> f64 {
        MARGIN * threshold.get()
    }

    /// The lists of `points`; `None` where there would be too many pairs, or numbers are too large or small.
    pub(super) fn new(
        threshold: Threshold,
        points: &[Point],
        keeps: &dyn Fn(u32, u32) -> bool,
    ) -> Option<Self> {
        let (delta, margin) = (threshold.get(), Self::margin(threshold));
        let reach = (delta + 2.0 * margin) * (1.0 + SLACK);
        let mut list = Self {
            threshold,
            margin,
            reach,
            drift: [0.0; 3],
            stamps: vec![0; points.len()],
            clock: 0,
            table: Table::new(points, reach * (1.0 + SLACK)),
            lists: Lists::new(points.len()),
            leavers: Vec::new(),
        };
        if !SANE.contains(&delta) || !list.is_in_range(points) {
            return None;
        }
        for v in 0..points.len() as u32 {
            list.look_up(v, keeps);
            if list.is_too_long() {
                return None;
            }
        }
        Some(list)
    }

    fn is_too_long(&self) -> bool {
        self.lists.live > MOST_LISTED * self.stamps.len() + 4096
    }

    fn is_in_range(&self, points: &[Point]) -> bool {
        let most = FARTHEST / 2.0 * self.reach;
        let drift = self.drift.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        let largest = points.as_flattened().iter().fold(0.0_f64, |largest, c| {
            let c = c.abs();
            if c > largest { c } else { largest }
        });
        largest + drift < most
    }

    /// Follows the body to `points`. `false` if a new grid is cheaper: the lists are then of no more use.
    pub(super) fn follow(&mut self, points: &[Point], keeps: &dyn Fn(u32, u32) -> bool) -> bool {
        self.follow_drift(points);
        if !self.is_in_range(points) {
            return false;
        }
        let far = (self.margin * (1.0 - SLACK)).powi(2);
        let [x, y, z] = self.drift;
        let mut leavers = std::mem::take(&mut self.leavers);
        leavers.clear();
        leavers.resize(points.len(), 0);
        let mut count = 0;
        // branch-free: always written, kept by moving the end
        for (v, (p, r)) in points.iter().zip(&self.table.point).enumerate() {
            let d = [p[0] - x - r[0], p[1] - y - r[1], p[2] - z - r[2]];
            leavers[count] = v as u32;
            count += usize::from(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] >= far);
        }
        leavers.truncate(count);
        if count as f64 > MOST_LOOKED_UP * points.len() as f64 {
            return false;
        }
        for &v in &leavers {
            let p = points[v as usize];
            self.table.put(v, [p[0] - x, p[1] - y, p[2] - z]);
        }
        for &v in &leavers {
            self.look_up(v, keeps);
        }
        self.leavers = leavers;
        !self.is_too_long()
    }

    /// The drift follows the median of some vertices: of those that rest, if most do.
    fn follow_drift(&mut self, points: &[Point]) {
        let step = points.len().div_ceil(SAMPLE).max(1);
        let moves = points.iter().zip(&self.table.point).step_by(step);
        let moves: Vec<Point> = moves.map(|(p, r)| std::array::from_fn(|k| p[k] - r[k])).collect();
        for k in 0..3 {
            let mut along: Vec<f64> = moves.iter().map(|m| m[k]).collect();
            let middle = along.len() / 2;
            self.drift[k] = *along.select_nth_unstable_by(middle, f64::total_cmp).1;
        }
    }

    fn look_up(&mut self, v: u32, keeps: &dyn Fn(u32, u32) -> bool) {
        self.clock += 1;
        self.stamps[v as usize] = self.clock;
        let Self {
            table, lists, stamps, ..
        } = self;
        lists.open.clear();
        table.near(&table.point[v as usize], self.reach, |w| {
            // one that was never looked up will list the pair when it is
            if v != w && stamps[w as usize] > 0 && keeps(v, w) {
                lists.open.push(w);
            }
        });
        lists.close(v);
    }

    /// The pairs within the threshold, each once, in no order: the exact decision of all that is listed.
    pub(super) fn pairs(&mut self, points: &[Point], mut found: impl FnMut(u32, u32)) {
        let square = self.threshold.get() * self.threshold.get();
        let (sure, limit) = (square * (1.0 - 1e-12), square * (1.0 + 1e-12));
        let (stamps, threshold) = (&self.stamps, self.threshold);
        self.lists.visit(|v, list| {
            let p = &points[v as usize];
            let stamp = stamps[v as usize];
            list.retain(|w| {
                if stamps[w as usize] > stamp {
                    return false;
                }
                let q = &points[w as usize];
                let [x, y, z] = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
                let d = x * x + y * y + z * z;
                if d < limit && (d < sure || vertex_vertex::within(p, q, threshold)) {
                    found(v, w);
                }
                true
            });
        });
    }
}

const NONE: u32 = u32::MAX;

/// A cell's place along each axis.
fn place(p: &Point, inverse: f64) -> [i64; 3] {
    p.map(|c| (c * inverse).floor() as i64)
}

fn name([x, y, z]: [i64; 3]) -> u64 {
    let part = |c: i64| c as u64 & 0x1f_ffff;
    part(x) << 42 | part(y) << 21 | part(z)
}

/// Points in the cells of a hashed grid; each cell a chain.
struct Table {
    inverse: f64,
    shift: u32,
    head: Vec<u32>,
    next: Vec<u32>,
    before: Vec<u32>,
    cell: Vec<u64>,
    point: Vec<Point>,
}

impl Table {
    fn new(points: &[Point], edge: f64) -> Self {
        let bits = (2 * points.len()).next_power_of_two().trailing_zeros().max(4);
        let mut table = Self {
            inverse: 1.0 / edge,
            shift: 64 - bits,
            head: vec![NONE; 1 << bits],
            next: vec![NONE; points.len()],
            before: vec![NONE; points.len()],
            cell: vec![0; points.len()],
            point: points.to_vec(),
        };
        for v in 0..points.len() as u32 {
            table.insert(v);
        }
        table
    }

    fn bucket(&self, cell: u64) -> usize {
        (cell.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> self.shift) as usize
    }

    fn insert(&mut self, v: u32) {
        let at = v as usize;
        self.cell[at] = name(place(&self.point[at], self.inverse));
        let bucket = self.bucket(self.cell[at]);
        let first = std::mem::replace(&mut self.head[bucket], v);
        (self.next[at], self.before[at]) = (first, NONE);
        if first != NONE {
            self.before[first as usize] = v;
        }
    }

    /// Moves a point.
    fn put(&mut self, v: u32, to: Point) {
        let at = v as usize;
        self.point[at] = to;
        if self.cell[at] == name(place(&to, self.inverse)) {
            return;
        }
        let (next, before) = (self.next[at], self.before[at]);
        if before == NONE {
            let bucket = self.bucket(self.cell[at]);
            self.head[bucket] = next;
        } else {
            self.next[before as usize] = next;
        }
        if next != NONE {
            self.before[next as usize] = before;
        }
        self.insert(v);
    }

    /// All points within `reach`, which is at most the edge of a cell.
    fn near(&self, p: &Point, reach: f64, mut visit: impl FnMut(u32)) {
        let square = reach * reach;
        let [x, y, z] = place(p, self.inverse);
        for dx in -1..=1 {
            for dy in -1..=1 {
                for dz in -1..=1 {
                    let cell = name([x + dx, y + dy, z + dz]);
                    let mut v = self.head[self.bucket(cell)];
                    while v != NONE {
                        let at = v as usize;
                        if self.cell[at] == cell {
                            let q = &self.point[at];
                            let [x, y, z] = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
                            if x * x + y * y + z * z < square {
                                visit(v);
                            }
                        }
                        v = self.next[at];
                    }
                }
            }
        }
    }
}

/// A list of numbers for each of many owners, in one piece of memory.
struct Lists {
    /// Start, length and room of each.
    places: Vec<[u32; 3]>,
    entries: Vec<u32>,
    /// What all lists together have room for.
    live: usize,
    /// The list that is being written.
    open: Vec<u32>,
}

/// One of these lists.
struct List<'a> {
    entries: &'a mut [u32],
    len: &'a mut u32,
}

impl List<'_> {
    /// Leaves out what `keeps` does not keep; the order may change.
    #[inline]
    fn retain(&mut self, mut keeps: impl FnMut(u32) -> bool) {
        let mut at = 0;
        let mut len = *self.len as usize;
        while at < len {
            if keeps(self.entries[at]) {
                at += 1;
            } else {
                len -= 1;
                self.entries[at] = self.entries[len];
            }
        }
        *self.len = len as u32;
    }
}

impl Lists {
    fn new(owners: usize) -> Self {
        Self {
            places: vec![[0; 3]; owners],
            entries: Vec::new(),
            live: 0,
            open: Vec::new(),
        }
    }

    /// Puts the open list where the owner's old one was, or at the end if it is longer.
    fn close(&mut self, owner: u32) {
        let len = self.open.len() as u32;
        let [start, _, room] = self.places[owner as usize];
        if len > room {
            self.live -= room as usize;
            self.places[owner as usize] = [0; 3];
            if self.entries.len() > 3 * self.live + (1 << 16) {
                self.tidy();
            }
            let start = self.entries.len() as u32;
            let room = len + len / 2 + 2;
            self.live += room as usize;
            self.entries.extend_from_slice(&self.open);
            self.entries.resize((start + room) as usize, 0);
            self.places[owner as usize] = [start, len, room];
        } else {
            self.entries[start as usize..(start + len) as usize].copy_from_slice(&self.open);
            self.places[owner as usize] = [start, len, room];
        }
    }

    /// Closes the gaps that lists left which grew out of their places.
    fn tidy(&mut self) {
        let mut entries = Vec::with_capacity(2 * self.live);
        for [start, _, room] in &mut self.places {
            let from = std::mem::replace(start, entries.len() as u32) as usize;
            entries.extend_from_slice(&self.entries[from..from + *room as usize]);
        }
        self.entries = entries;
    }

    fn visit(&mut self, mut with: impl FnMut(u32, &mut List<'_>)) {
        for (owner, [start, len, room]) in (0..).zip(&mut self.places) {
            if *len > 0 {
                let entries = &mut self.entries[*start as usize..(*start + *room) as usize];
                with(owner, &mut List { entries, len });
            }
        }
    }
}

//! Drops points without a partner nearby before they are sorted, by a coarse bitmap of the other body.

use std::sync::atomic::{AtomicU64, Ordering};

use super::cells::whole;
use super::clip::{ClippedPart, Placed, greater, lesser};

/// Cells along an axis: a row is one word, the whole bitmap fits into the first-level cache.
const SIDE: usize = 64;
const ROWS: usize = SIDE * SIDE;
/// Fewer points than this are sorted faster than culled.
const WORTH: usize = 1 << 15;
/// The size of the sample that tells whether the other body fills the overlap, so that a cull would drop little: this many
/// uniform points are near half of the cells.
const SAMPLE: usize = 1 << 13;

/// Drops points without a partner nearby. Keeps its memory from call to call.
#[derive(Debug, Default)]
pub(crate) struct OccupancyCull {
    grid: Grid,
    /// The cells of one body; atomic, because several threads mark them.
    marks: Vec<AtomicU64>,
    /// The marked cells and their neighbours.
    near: Vec<u64>,
    spare: Vec<u64>,
}

impl OccupancyCull {
    /// Drops the points of either body that have no occupied cell of the other nearby. Returns their number.
    pub(crate) fn cull(
        &mut self,
        a: &mut [ClippedPart],
        b: &mut [ClippedPart],
        reach: f32,
        threads: usize,
    ) -> usize {
        let count = |parts: &[ClippedPart]| parts.iter().map(|part| part.points.len()).sum::<usize>();
        let before = count(a) + count(b);
        if before < WORTH || count(a) == 0 || count(b) == 0 {
            return 0;
        }
        self.grid = Grid::new(&a.iter().chain(b.iter()), reach);
        self.clear();
        let step = count(a).div_ceil(SAMPLE);
        // all parts as one sequence, so that the result does not depend on their number
        let points = a.iter().flat_map(|part| &part.points);
        points.step_by(step).for_each(|point| self.mark(point));
        self.widen();
        if self
            .near
            .iter()
            .map(|row| row.count_ones() as usize)
            .sum::<usize>()
            > ROWS * SIDE / 4
        {
            return 0;
        }
        self.mark_all(a, threads);
        self.keep(b, threads);
        self.clear();
        self.mark_all(b, threads);
        self.keep(a, threads);
        before - count(a) - count(b)
    }

    fn clear(&mut self) {
        self.marks.resize_with(ROWS, AtomicU64::default);
        self.marks.iter_mut().for_each(|row| *row.get_mut() = 0);
    }

    /// Marks the cell of a point. Most cells are marked already; then nothing is written, and no cache line changes hands.
    #[inline(always)]
    fn mark(&self, point: &Placed) {
        let (row, bit) = self.grid.cell(point);
        let row = &self.marks[row];
        if row.load(Ordering::Relaxed) >> bit & 1 == 0 {
            // the threads are joined before it is read
            row.fetch_or(1 << bit, Ordering::Relaxed);
        }
    }

    fn mark_all(&mut self, parts: &[ClippedPart], threads: usize) {
        let mark = |part: &ClippedPart| part.points.iter().for_each(|point| self.mark(point));
        if threads < 2 {
            parts.iter().for_each(mark);
        } else {
            use rayon::prelude::*;
            parts.par_iter().for_each(mark);
        }
        self.widen();
    }

    /// Marks as near every marked cell and those adjacent to it, corners included.
    fn widen(&mut self) {
        let Self {
            marks, near, spare, ..
        } = self;
        near.clear();
        near.extend(marks.iter_mut().map(|row| *row.get_mut()));
        near.iter_mut().for_each(|row| *row |= *row << 1 | *row >> 1);
        spare.clone_from(near);
        for (wide, rows) in near.chunks_exact_mut(SIDE).zip(spare.chunks_exact(SIDE)) {
            add(&mut wide[1..], rows);
            add(wide, &rows[1..]);
        }
        spare.clone_from(near);
        add(&mut near[SIDE..], spare);
        add(near, &spare[SIDE..]);
    }

    /// Drops the points that are not near, and recomputes the boxes.
    fn keep(&self, parts: &mut [ClippedPart], threads: usize) {
        let one = |part: &mut ClippedPart| {
            let mut len = 0;
            for at in 0..part.points.len() {
                let point = part.points[at];
                part.points[len] = point;
                let (row, bit) = self.grid.cell(&point);
                len += (self.near[row] >> bit & 1) as usize;
            }
            part.points.truncate(len);
            part.measure();
        };
        if threads < 2 {
            parts.iter_mut().for_each(one);
        } else {
            use rayon::prelude::*;
            parts.par_iter_mut().for_each(one);
        }
    }
}

/// Adds the marks of other rows, as many as there are in both.
fn add(rows: &mut [u64], others: &[u64]) {
    rows.iter_mut().zip(others).for_each(|(row, other)| *row |= other);
}

/// Cells wider than a reach, so that partners lie in the same or in adjacent cells.
#[derive(Debug, Default)]
struct Grid {
    lower: [f32; 3],
    inverse: [f32; 3],
}

impl Grid {
    fn new<'p>(parts: &(impl Iterator<Item = &'p ClippedPart> + Clone), reach: f32) -> Self {
        let lower: [f32; 3] =
            std::array::from_fn(|k| parts.clone().map(|part| part.min[k]).fold(f32::INFINITY, lesser));
        let inverse = std::array::from_fn(|k| {
            let upper = parts
                .clone()
                .map(|part| part.max[k])
                .fold(f32::NEG_INFINITY, greater);
            // 1.001: sixty-four cells are numbered with an error far below a thousandth
            1.0 / greater((upper - lower[k]) / SIDE as f32, reach * 1.001)
        });
        Self { lower, inverse }
    }

    /// The row of a point and its bit there.
    #[inline(always)]
    fn cell(&self, point: &Placed) -> (usize, usize) {
        let cell = |k: usize| whole((point.q[k] - self.lower[k]) * self.inverse[k], (SIDE - 1) as f32);
        (cell(2) * SIDE + cell(1), cell(0))
    }
}

#[cfg(test)]
mod tests {
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};

    use super::*;

    /// Two thin slabs that cross: what is kept is what has a point of the other in the same or an adjacent cell.
    #[test]
    fn keeps_whoever_has_a_partner_in_an_adjacent_cell() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(5);
        let mut body = |flat: usize| {
            let point = |id| {
                let mut q = [(); 3].map(|()| (rng.next_u32() >> 8) as f32 / (1 << 24) as f32);
                q[flat] = 0.5 + 0.01 * q[flat];
                Placed { q, id }
            };
            let mut part = ClippedPart {
                points: (0..20_000).map(point).collect(),
                ..ClippedPart::default()
            };
            part.measure();
            part
        };
        let whole = [body(0), body(1)];
        let copy = |part: &ClippedPart| ClippedPart {
            points: part.points.clone(),
            ..*part
        };
        let [mut a, mut b] = [0, 1].map(|body| [copy(&whole[body])]);
        let mut cull = OccupancyCull::default();
        let dropped = cull.cull(&mut a, &mut b, 0.01, 1);
        let cells = |part: &ClippedPart| {
            let cells = part.points.iter().map(|point| cull.grid.cell(point));
            cells
                .map(|(row, x)| [x, row % SIDE, row / SIDE])
                .collect::<Vec<_>>()
        };
        let [cells_a, cells_b] = [0, 1].map(|body| cells(&whole[body]));
        let wanted = |own: &[[usize; 3]], others: &[[usize; 3]]| {
            let others: std::collections::BTreeSet<_> = others.iter().collect();
            let near = |cell: &[usize; 3]| {
                let around = |k: usize| cell[k].saturating_sub(1)..=cell[k] + 1;
                around(0).any(|x| around(1).any(|y| around(2).any(|z| others.contains(&[x, y, z]))))
            };
            let kept = (0_u32..).zip(own).filter(|(_, cell)| near(cell));
            kept.map(|(id, _)| id).collect::<Vec<_>>()
        };
        let ids = |part: &ClippedPart| part.points.iter().map(|point| point.id).collect::<Vec<_>>();
        assert_eq!(ids(&a[0]), wanted(&cells_a, &cells_b));
        assert_eq!(ids(&b[0]), wanted(&cells_b, &cells_a));
        assert_eq!(dropped, 40_000 - a[0].points.len() - b[0].points.len());
        assert!(dropped > 10_000, "{dropped}");

        // in parts, on threads: the same
        let mut parts = [0, 1].map(|body| {
            let piece = |points: &[Placed]| {
                let mut part = ClippedPart {
                    points: points.to_vec(),
                    ..ClippedPart::default()
                };
                part.measure();
                part
            };
            let points: &ClippedPart = &whole[body];
            points.points.chunks(3001).map(piece).collect::<Vec<_>>()
        });
        let [parts_a, parts_b] = &mut parts;
        assert_eq!(cull.cull(parts_a, parts_b, 0.01, 2), dropped);
        let all = |parts: &[ClippedPart]| parts.iter().flat_map(ids).collect::<Vec<_>>();
        assert!(all(parts_a) == ids(&a[0]) && all(parts_b) == ids(&b[0]));
    }
}

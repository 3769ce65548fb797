//! Points without a partner nearby are dropped before they are sorted: a coarse bitmap of where the other body is.

use super::cells::whole;
use super::clip::{Part, Placed, greater, lesser};

/// Cells along an axis: a row is one word, the whole bitmap fits into the first-level cache.
const SIDE: usize = 64;
/// Fewer points than this are sorted faster than sieved.
const WORTH: usize = 1 << 15;
/// Points that tell whether the other body fills the overlap, so that a sieve would hold nothing back: uniform points of this
/// number are near to half of the cells.
const SAMPLE: usize = 1 << 13;

/// Drops the points of either body that have no cell of the other's nearby. Returns how many.
pub(crate) fn sieve(a: &mut [Part], b: &mut [Part], reach: f32, threads: usize) -> usize {
    let count = |parts: &[Part]| parts.iter().map(|part| part.points.len()).sum::<usize>();
    let before = count(a) + count(b);
    if before < WORTH || count(a) == 0 || count(b) == 0 {
        return 0;
    }
    let grid = Grid::new(&a.iter().chain(b.iter()), reach);
    let step = count(a).div_ceil(SAMPLE);
    let mut sample = Bitmap::new();
    for part in a.iter() {
        part.points
            .iter()
            .step_by(step)
            .for_each(|point| sample.mark(&grid, point));
    }
    if sample.near().filled() > SIDE * SIDE * SIDE / 4 {
        return 0;
    }
    let near_a = mark(a, &grid, threads).near();
    keep(b, &grid, &near_a, threads);
    let near_b = mark(b, &grid, threads).near();
    keep(a, &grid, &near_b, threads);
    before - count(a) - count(b)
}

fn mark(parts: &[Part], grid: &Grid, threads: usize) -> Bitmap {
    let mark = |parts: &[Part]| {
        let mut bitmap = Bitmap::new();
        for part in parts {
            part.points.iter().for_each(|point| bitmap.mark(grid, point));
        }
        bitmap
    };
    if threads < 2 {
        return mark(parts);
    }
    use rayon::prelude::*;
    // a bitmap a thread, not a part
    parts
        .par_chunks(parts.len().div_ceil(threads))
        .map(mark)
        .reduce(Bitmap::new, |all, part| all.or(&part))
}

fn keep(parts: &mut [Part], grid: &Grid, near: &Bitmap, threads: usize) {
    let one = |part: &mut Part| {
        let mut len = 0;
        for at in 0..part.points.len() {
            let point = part.points[at];
            part.points[len] = point;
            len += usize::from(near.holds(grid, &point));
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

/// Cells wider than a reach, so that partners lie in the same or in adjacent cells.
struct Grid {
    lower: [f32; 3],
    inverse: [f32; 3],
}

impl Grid {
    fn new<'p>(parts: &(impl Iterator<Item = &'p Part> + Clone), reach: f32) -> Self {
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

    #[inline(always)]
    fn cell(&self, point: &Placed) -> [usize; 3] {
        std::array::from_fn(|k| whole((point.q[k] - self.lower[k]) * self.inverse[k], (SIDE - 1) as f32))
    }
}

/// A bit a cell, a word a row.
struct Bitmap(Box<[u64; SIDE * SIDE]>);

impl Bitmap {
    fn new() -> Self {
        Self(Box::new([0; SIDE * SIDE]))
    }

    #[inline(always)]
    fn mark(&mut self, grid: &Grid, point: &Placed) {
        let [x, y, z] = grid.cell(point);
        self.0[z * SIDE + y] |= 1 << x;
    }

    #[inline(always)]
    fn holds(&self, grid: &Grid, point: &Placed) -> bool {
        let [x, y, z] = grid.cell(point);
        self.0[z * SIDE + y] >> x & 1 == 1
    }

    fn or(mut self, other: &Self) -> Self {
        self.0
            .iter_mut()
            .zip(other.0.iter())
            .for_each(|(to, from)| *to |= from);
        self
    }

    fn filled(&self) -> usize {
        self.0.iter().map(|row| row.count_ones() as usize).sum()
    }

    /// Every marked cell and those adjacent to it, corners included.
    fn near(&self) -> Self {
        let mut wide = self.0.clone();
        wide.iter_mut().for_each(|row| *row |= *row << 1 | *row >> 1);
        for stride in [1, SIDE] {
            let narrow = wide.clone();
            for (at, row) in wide.iter_mut().enumerate() {
                let along = at / stride % SIDE;
                if along > 0 {
                    *row |= narrow[at - stride];
                }
                if along + 1 < SIDE {
                    *row |= narrow[at + stride];
                }
            }
        }
        Self(wide)
    }
}

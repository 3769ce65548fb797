//! Points sorted into the cells of a uniform grid by counting, as a structure of arrays.

use super::clip::{ClippedPart, Placed, greater, lesser};

/// Cells along one axis at most: the cell of a coordinate then stays exact enough to be useful, and no index overflows.
const PER_AXIS: usize = 1 << 15;
/// Up to this many points are sorted in one pass; more are first dealt out to groups of layers that fit into the cache.
const ONE_PASS: usize = 1 << 16;

/// 2^23: added to a number from 0 to 2^22, it leaves the nearest whole number in the lowest bits of the sum.
const WHOLE: f32 = 8_388_608.0;

/// The nearest whole number of a number clamped to `0..=last`; monotone and branch-free, so that it vectorises.
#[inline(always)]
pub(crate) fn whole(real: f32, last: f32) -> usize {
    ((lesser(greater(real, 0.0), last) + WHOLE).to_bits() & 0x7f_ffff) as usize
}

/// A uniform grid in a frame. `cell` is monotone in the coordinate despite rounding: the cells between those of a - r and
/// a + r hold every point within r of a.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cells {
    lower: [f32; 3],
    inverse: f32,
    count: [usize; 3],
    last: [f32; 3],
}

/// Points a cell has on average where there are any.
const OCCUPANCY: f32 = 6.0;
/// The size of the sample that estimates how many points share a cell.
const SAMPLE: usize = 512;

impl Cells {
    /// The grid for these points, none of whose cells is much narrower than `reach`.
    pub(crate) fn fitting(parts: &[ClippedPart], reach: f32) -> Self {
        let n = parts.iter().map(|part| part.points.len()).sum::<usize>();
        let min: [f32; 3] =
            std::array::from_fn(|k| parts.iter().map(|part| part.min[k]).fold(f32::INFINITY, lesser));
        let max: [f32; 3] = std::array::from_fn(|k| {
            parts
                .iter()
                .map(|part| part.max[k])
                .fold(f32::NEG_INFINITY, greater)
        });
        let volume: f32 = (0..3).map(|k| greater(max[k] - min[k], reach)).product();
        let mut edge = greater((volume * OCCUPANCY / n as f32).cbrt(), reach);
        // points on surfaces fill few cells
        if n > 4 * SAMPLE {
            for _ in 0..3 {
                if edge <= reach {
                    break;
                }
                let crowd = crowd(parts, n, &Self::new(min, max, edge, usize::MAX));
                if crowd < 2.0 * OCCUPANCY {
                    break;
                }
                edge = greater(edge * (OCCUPANCY / crowd).sqrt(), reach);
            }
        }
        Self::new(min, max, edge, 2 * n + 64)
    }

    /// The grid over `min..=max` with cells of edge `edge` or longer, as needed to have at most `limit` of them.
    fn new(min: [f32; 3], max: [f32; 3], mut edge: f32, limit: usize) -> Self {
        loop {
            let count: [usize; 3] =
                std::array::from_fn(|k| ((max[k] - min[k]) / edge + 0.5).clamp(0.0, 1e9) as usize + 1);
            let total = count.iter().map(|&n| n as f64).product::<f64>();
            if count.iter().all(|&n| n <= PER_AXIS) && (total <= limit.max(1) as f64 || total <= 1.0) {
                return Self {
                    lower: min,
                    inverse: 1.0 / edge,
                    count,
                    last: count.map(|n| (n - 1) as f32),
                };
            }
            edge *= 1.25;
        }
    }

    /// Cells along each axis.
    pub(crate) fn count(&self) -> [usize; 3] {
        self.count
    }

    /// The cell of a coordinate along `axis`; coordinates outside belong to the outermost cells.
    #[inline(always)]
    pub(crate) fn cell(&self, axis: usize, c: f32) -> usize {
        whole((c - self.lower[axis]) * self.inverse, self.last[axis])
    }

    /// The serial number of a point's cell: x runs fastest, z slowest.
    #[inline(always)]
    pub(crate) fn index(&self, q: &[f32; 3]) -> usize {
        (self.cell(2, q[2]) * self.count[1] + self.cell(1, q[1])) * self.count[0] + self.cell(0, q[0])
    }

    /// Cells in one layer of equal z.
    pub(crate) fn layer(&self) -> usize {
        self.count[0] * self.count[1]
    }
}

/// The mean over all points of the number of points in their cell, estimated from a sample.
fn crowd(parts: &[ClippedPart], n: usize, cells: &Cells) -> f32 {
    let (mut sample, mut count) = ([0; SAMPLE], 0);
    // all parts as one sequence, so that the result does not depend on their number
    let points = parts
        .iter()
        .flat_map(|part| &part.points)
        .step_by(n.div_ceil(SAMPLE));
    for (place, point) in sample.iter_mut().zip(points) {
        *place = cells.index(&point.q);
        count += 1;
    }
    let sample = &mut sample[..count];
    sample.sort_unstable();
    let pairs: usize = sample
        .chunk_by(|a, b| a == b)
        .map(|same| same.len() * (same.len() - 1))
        .sum();
    1.0 + pairs as f32 / count as f32 * (n as f32 / count as f32)
}

/// Points in the order of their cells, and where each cell starts.
#[derive(Debug, Default)]
pub(crate) struct Sorted {
    pub(crate) c: [Vec<f32>; 3],
    pub(crate) id: Vec<u32>,
    /// One entry per cell and one for the end.
    pub(crate) start: Vec<u32>,
    /// The cell of each point, in the order of the input; computed once.
    cell_of: Vec<u32>,
    grouped: Vec<Vec<Placed>>,
    offsets: Vec<Vec<u32>>,
}

/// Behind the last point, so that eight lanes can be read from any point on.
pub(crate) const PADDING: usize = 8;

impl Sorted {
    /// Sorts the points of `parts`; those of one cell keep their order.
    pub(crate) fn sort(&mut self, parts: &[ClippedPart], cells: &Cells, threads: usize) {
        let n: usize = parts.iter().map(|part| part.points.len()).sum();
        let total = cells.layer() * cells.count[2];
        for axis in &mut self.c {
            axis.resize(n + PADDING, f32::INFINITY);
        }
        self.id.resize(n + PADDING, 0);
        self.cell_of.resize(n, 0);
        self.start.clear();
        self.start.resize(total + 1, 0);
        self.start[total] = n as u32;
        if n <= ONE_PASS || cells.count[2] == 1 {
            let [x, y, z] = &mut self.c;
            let mut group = CellGroup {
                x,
                y,
                z,
                id: &mut self.id,
                cell_of: &mut self.cell_of,
                start: &mut self.start[..total],
                base: 0,
                first: 0,
            };
            group.sort(parts.iter().map(|part| part.points.as_slice()), cells);
            return;
        }
        self.deal(parts, cells, threads);
        self.sort_groups(cells, n, threads);
    }

    /// First pass: every part's points dealt out to groups of layers.
    fn deal(&mut self, parts: &[ClippedPart], cells: &Cells, threads: usize) {
        self.grouped.resize_with(parts.len(), Vec::new);
        self.offsets.resize_with(parts.len(), Vec::new);
        let layers = cells.count[2];
        let deal = |(ClippedPart { points: part, .. }, (grouped, offsets)): (
            &ClippedPart,
            (&mut Vec<Placed>, &mut Vec<u32>),
        )| {
            offsets.clear();
            offsets.resize(layers + 1, 0);
            for point in part {
                offsets[cells.cell(2, point.q[2])] += 1;
            }
            let mut end = 0;
            for offset in offsets.iter_mut() {
                end += *offset;
                *offset = end;
            }
            grouped.resize(part.len(), Placed::default());
            for point in part.iter().rev() {
                let at = &mut offsets[cells.cell(2, point.q[2])];
                *at -= 1;
                grouped[*at as usize] = *point;
            }
        };
        if threads < 2 {
            parts
                .iter()
                .zip(self.grouped.iter_mut().zip(&mut self.offsets))
                .for_each(deal);
        } else {
            use rayon::prelude::*;
            parts
                .par_iter()
                .zip(self.grouped.par_iter_mut().zip(&mut self.offsets))
                .for_each(deal);
        }
    }

    /// Second pass: the points of each layer into its cells.
    fn sort_groups(&mut self, cells: &Cells, n: usize, threads: usize) {
        let Self {
            c: [x, y, z],
            id,
            start,
            cell_of,
            grouped,
            offsets,
        } = self;
        let (grouped, offsets) = (&*grouped, &*offsets);
        let layers = cells.count[2];
        let points_before = |layer: usize| offsets.iter().map(|o| o[layer] as usize).sum::<usize>();
        let sort_layers = |slab: &mut Slab<'_>| {
            for layer in slab.layers.clone() {
                let (from, to) = (
                    points_before(layer) - slab.base,
                    points_before(layer + 1) - slab.base,
                );
                let cell = (layer - slab.layers.start) * cells.layer();
                let mut group = CellGroup {
                    x: &mut slab.x[from..to],
                    y: &mut slab.y[from..to],
                    z: &mut slab.z[from..to],
                    id: &mut slab.id[from..to],
                    cell_of: &mut slab.cell_of[from..to],
                    start: &mut slab.start[cell..cell + cells.layer()],
                    base: (slab.base + from) as u32,
                    first: layer * cells.layer(),
                };
                let segments = grouped
                    .iter()
                    .zip(offsets)
                    .map(|(part, o)| &part[o[layer] as usize..o[layer + 1] as usize]);
                group.sort(segments, cells);
            }
        };
        let (mut x, mut y, mut z, mut id) = (&mut x[..], &mut y[..], &mut z[..], &mut id[..]);
        let (mut start, mut cell_of) = (&mut start[..], &mut cell_of[..]);
        if threads < 2 {
            sort_layers(&mut Slab {
                layers: 0..layers,
                base: 0,
                x,
                y,
                z,
                id,
                cell_of,
                start,
            });
            return;
        }
        let tasks = threads * 8;
        let mut slabs = Vec::with_capacity(tasks + 1);
        let mut first = 0;
        let mut base = 0;
        while first < layers {
            let mut last = first + 1;
            while last < layers && points_before(last) - base < n / tasks {
                last += 1;
            }
            let points = points_before(last) - base;
            slabs.push(Slab {
                layers: first..last,
                base,
                x: x.split_off_mut(..points).unwrap_or_default(),
                y: y.split_off_mut(..points).unwrap_or_default(),
                z: z.split_off_mut(..points).unwrap_or_default(),
                id: id.split_off_mut(..points).unwrap_or_default(),
                cell_of: cell_of.split_off_mut(..points).unwrap_or_default(),
                start: start
                    .split_off_mut(..(last - first) * cells.layer())
                    .unwrap_or_default(),
            });
            first = last;
            base += points;
        }
        use rayon::prelude::*;
        slabs.par_iter_mut().for_each(sort_layers);
    }
}

/// Consecutive layers and their parts of the sorted arrays.
struct Slab<'a> {
    layers: std::ops::Range<usize>,
    base: usize,
    x: &'a mut [f32],
    y: &'a mut [f32],
    z: &'a mut [f32],
    id: &'a mut [u32],
    cell_of: &'a mut [u32],
    start: &'a mut [u32],
}

/// The slices of the sorted arrays that some consecutive cells own.
struct CellGroup<'a> {
    x: &'a mut [f32],
    y: &'a mut [f32],
    z: &'a mut [f32],
    id: &'a mut [u32],
    /// Scratch space: one number per point.
    cell_of: &'a mut [u32],
    /// Zero on entry.
    start: &'a mut [u32],
    /// Points before the first of these cells.
    base: u32,
    /// The first of these cells.
    first: usize,
}

impl CellGroup<'_> {
    fn sort<'p, I>(&mut self, segments: I, cells: &Cells)
    where
        I: DoubleEndedIterator<Item = &'p [Placed]> + Clone,
    {
        let mut rest = &mut *self.cell_of;
        for segment in segments.clone() {
            let (cell_of, behind) = std::mem::take(&mut rest).split_at_mut(segment.len());
            rest = behind;
            // in a loop of its own: counting waits for memory, so that cells would be computed one at a time
            for (cell_of, point) in cell_of.iter_mut().zip(segment) {
                *cell_of = (cells.index(&point.q) - self.first) as u32;
            }
        }
        for &cell in &*self.cell_of {
            self.start[cell as usize] += 1;
        }
        let mut end = 0;
        for start in self.start.iter_mut() {
            end += *start;
            *start = end;
        }
        let n = self.x.len();
        let (x, y, z, id) = (
            &mut *self.x,
            &mut self.y[..n],
            &mut self.z[..n],
            &mut self.id[..n],
        );
        let mut left = self.cell_of.iter().rev();
        for segment in segments.rev() {
            for (point, &cell) in segment.iter().rev().zip(&mut left) {
                let start = &mut self.start[cell as usize];
                *start -= 1;
                let at = *start as usize;
                x[at] = point.q[0];
                y[at] = point.q[1];
                z[at] = point.q[2];
                id[at] = point.id;
            }
        }
        if self.base > 0 {
            for start in self.start.iter_mut() {
                *start += self.base;
            }
        }
    }
}

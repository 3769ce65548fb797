//! The part of a body that may be near the other: bounding boxes of blocks of points, and the points inside a region, in
//! coordinates of a frame.

use super::frame::LocalFrame;
use crate::mesh::all_finite;
use crate::simd::{Lanes, Work, dispatch};
use crate::{Aabb, Error};

/// Points in a run. Meshes number neighbours closely, so that a run has a small box and is usually inside or outside as a
/// whole.
pub(crate) const RUN: usize = 64;

/// The bounding boxes of a body's points, run by run.
#[derive(Debug, Default, Clone)]
pub(crate) struct BlockBounds {
    boxes: Vec<Aabb>,
    whole: Option<Aabb>,
}

impl BlockBounds {
    /// Measures `points`.
    ///
    /// # Errors
    /// [`Error::NonFiniteVertex`], which names the first vertex that is not finite.
    pub(crate) fn measure(&mut self, points: &[[f64; 3]], threads: usize) -> Result<(), Error> {
        self.whole = None;
        self.boxes.clear();
        self.boxes.resize(points.len().div_ceil(RUN), EMPTY);
        let tasks = threads.min(points.len() / 50_000 + 1);
        let finite = if tasks < 2 {
            dispatch(MeasureBlocks {
                points,
                boxes: &mut self.boxes,
            })
        } else {
            use rayon::prelude::*;
            let runs = self.boxes.len().div_ceil(tasks * 4);
            self.boxes
                .par_chunks_mut(runs)
                .zip(points.par_chunks(runs * RUN))
                .map(|(boxes, points)| dispatch(MeasureBlocks { points, boxes }))
                .reduce(|| true, |a, b| a & b)
        };
        if !finite {
            all_finite(points.iter().copied())?;
        }
        self.whole = self.boxes.iter().copied().reduce(|a, b| union(&a, &b));
        Ok(())
    }

    /// Copies the bounds of the same points from elsewhere.
    pub(crate) fn copy(&mut self, known: &Self) {
        self.boxes.clone_from(&known.boxes);
        self.whole = known.whole;
    }

    /// The box of all points; `None` if there are none.
    pub(crate) fn whole(&self) -> Option<Aabb> {
        self.whole
    }

    /// The box of each run.
    pub(crate) fn boxes(&self) -> &[Aabb] {
        &self.boxes
    }

    /// Lists the runs whose boxes meet a region, in ascending order.
    pub(crate) fn inside(&self, region: &Aabb, list: &mut Vec<u32>) {
        list.clear();
        let runs = (0..).zip(&self.boxes);
        list.extend(runs.filter_map(|(run, bounds)| intersection(bounds, region).map(|_| run)));
    }
}

const EMPTY: Aabb = Aabb {
    min: [f64::INFINITY; 3],
    max: [f64::NEG_INFINITY; 3],
};

/// The smallest box that holds both.
pub(crate) fn union(a: &Aabb, b: &Aabb) -> Aabb {
    Aabb {
        min: std::array::from_fn(|k| a.min[k].min(b.min[k])),
        max: std::array::from_fn(|k| a.max[k].max(b.max[k])),
    }
}

/// The intersection of two boxes; `None` if they do not meet.
pub(crate) fn intersection(a: &Aabb, b: &Aabb) -> Option<Aabb> {
    let min: [f64; 3] = std::array::from_fn(|k| a.min[k].max(b.min[k]));
    let max: [f64; 3] = std::array::from_fn(|k| a.max[k].min(b.max[k]));
    (0..3).all(|k| min[k] <= max[k]).then_some(Aabb { min, max })
}

/// A box that holds every point within `delta` of `bounds`, roundings included.
pub(crate) fn inflate(bounds: &Aabb, delta: f64) -> Aabb {
    Aabb {
        min: bounds.min.map(|c| (c - delta).next_down().max(f64::MIN)),
        max: bounds.max.map(|c| (c + delta).next_up().min(f64::MAX)),
    }
}

struct MeasureBlocks<'a> {
    points: &'a [[f64; 3]],
    boxes: &'a mut [Aabb],
}

impl Work for MeasureBlocks<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> bool {
        let mut all_finite = true;
        for (points, bounds) in self.points.chunks(RUN).zip(self.boxes) {
            // four points are twelve numbers: whole vectors of either width, the same axis in the same lane
            let (fours, rest) = points.as_flattened().as_chunks::<12>();
            let ([mut min, mut max], mut finite) = lanes.extremes(fours);
            for (k, &c) in rest.iter().enumerate() {
                min[k] = min[k].min(c);
                max[k] = max[k].max(c);
                finite &= c.is_finite();
            }
            all_finite &= finite;
            // plain comparisons: points that are not finite are refused anyway
            let least = |a: f64, b: f64| if a < b { a } else { b };
            let greatest = |a: f64, b: f64| if a > b { a } else { b };
            let fold = |of: &[f64; 12], k: usize, pick: fn(f64, f64) -> f64| {
                pick(pick(of[k], of[k + 3]), pick(of[k + 6], of[k + 9]))
            };
            *bounds = Aabb {
                min: std::array::from_fn(|k| fold(&min, k, least)),
                max: std::array::from_fn(|k| fold(&max, k, greatest)),
            };
        }
        all_finite
    }
}

/// A point in a frame, and its serial number.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Placed {
    pub(crate) q: [f32; 3],
    pub(crate) id: u32,
}

/// The points of one part of a body, placed, and the box around them.
#[derive(Debug)]
pub(crate) struct ClippedPart {
    pub(crate) points: Vec<Placed>,
    pub(crate) min: [f32; 3],
    pub(crate) max: [f32; 3],
}

impl Default for ClippedPart {
    fn default() -> Self {
        Self {
            points: Vec::new(),
            min: [f32::INFINITY; 3],
            max: [f32::NEG_INFINITY; 3],
        }
    }
}

impl ClippedPart {
    /// Recomputes the box.
    pub(crate) fn measure(&mut self) {
        dispatch(MeasurePart(self));
    }
}

struct MeasurePart<'a>(&'a mut ClippedPart);

impl Work for MeasurePart<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let ClippedPart { points, min, max } = self.0;
        let none = [[f32::INFINITY; 4], [f32::NEG_INFINITY; 4]];
        // two accumulators, because each operation waits for the one before
        let mut extremes = [none; 2];
        let mut widen = |of: usize, Placed { q: [x, y, z], .. }: &Placed| {
            lanes.widen(&mut extremes[of], [*x, *y, *z, 0.0]);
        };
        let (twos, rest) = points.as_chunks::<2>();
        for [one, two] in twos {
            widen(0, one);
            widen(1, two);
        }
        rest.iter().for_each(|one| widen(0, one));
        let [[min_one, max_one], [min_two, max_two]] = extremes;
        *min = std::array::from_fn(|k| lesser(min_one[k], min_two[k]));
        *max = std::array::from_fn(|k| greater(max_one[k], max_two[k]));
    }
}

/// A body to be clipped to a region, and the frame of the result.
#[derive(Clone, Copy)]
pub(crate) struct Clip<'a> {
    pub(crate) points: &'a [[f64; 3]],
    pub(crate) runs: &'a BlockBounds,
    /// Every run that reaches into the region.
    pub(crate) inside: &'a [u32],
    pub(crate) region: &'a Aabb,
    pub(crate) frame: &'a LocalFrame,
}

impl Clip<'_> {
    /// Places the points inside the region, in their order, in parts if there are threads for it.
    pub(crate) fn place(&self, parts: &mut Vec<ClippedPart>, threads: usize) {
        let runs = self.inside.len();
        let count = if threads < 2 {
            1
        } else {
            (runs / 64).clamp(1, 8 * threads)
        };
        parts.resize_with(count, ClippedPart::default);
        let one = |(part, to): (usize, &mut ClippedPart)| {
            self.part(&self.inside[runs * part / count..runs * (part + 1) / count], to);
        };
        if count == 1 {
            one((0, &mut parts[0]));
        } else {
            use rayon::prelude::*;
            parts.par_iter_mut().enumerate().for_each(one);
        }
    }

    fn part(&self, runs: &[u32], to: &mut ClippedPart) {
        to.points.clear();
        dispatch(Placing {
            clip: self,
            runs,
            to: &mut to.points,
        });
        to.measure();
    }
}

/// The runs of a part being placed.
struct Placing<'a> {
    clip: &'a Clip<'a>,
    runs: &'a [u32],
    to: &'a mut Vec<Placed>,
}

impl Work for Placing<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Clip {
            points,
            runs: BlockBounds { boxes, .. },
            region,
            frame,
            ..
        } = *self.clip;
        let (min, max, origin) = (wide(region.min), wide(region.max), wide(frame.origin));
        let axes = frame.axes();
        for &run in self.runs {
            let run = run as usize;
            let bounds = &boxes[run];
            let all = region.contains(bounds.min) && region.contains(bounds.max);
            let (first, last) = (run * RUN, points.len().min((run + 1) * RUN));
            // every point is written, and kept by moving the end: no branch
            let mut len = self.to.len();
            self.to.resize(len + last - first, Placed::default());
            for at in first..last {
                let four = four(points, at);
                let [x, y, z, _] = lanes.place(&four, &origin, frame.scale, axes);
                self.to[len] = Placed {
                    q: [x, y, z],
                    id: at as u32,
                };
                len += usize::from(all || lanes.is_inside(&four, &min, &max));
            }
            self.to.truncate(len);
        }
    }
}

/// Three numbers and an unused fourth lane.
#[inline(always)]
pub(crate) fn wide([x, y, z]: [f64; 3]) -> [f64; 4] {
    [x, y, z, 0.0]
}

/// A point and the number after it: one load, except for the last point.
#[inline(always)]
pub(crate) fn four(points: &[[f64; 3]], at: usize) -> [f64; 4] {
    match points.as_flattened().get(3 * at..3 * at + 4) {
        Some(&[x, y, z, next]) => [x, y, z, next],
        _ => wide(points[at]),
    }
}

/// The lesser of two finite numbers; one instruction, unlike `f32::min`.
#[inline(always)]
pub(crate) fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater of two finite numbers.
#[inline(always)]
pub(crate) fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

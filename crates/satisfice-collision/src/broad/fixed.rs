//! The points of a body that stays where it is, filed once in every cell of a grid that they are near to; a point of another body
//! is then looked up in its own cell alone.

use super::cells::{Cells, PADDING};
use super::clip::{Clip, Part, Runs, inflate};
use super::exact::Decide;
use super::frame::{Filter, Frame};
use super::join::{eight, id_eight};
use super::lanes::{Lanes, Work, dispatch};
use super::pair::Pair;
use crate::distance::Threshold;
use crate::{Aabb, Error};

/// The edge of a cell in reaches. Longer ones file a point in fewer cells, shorter ones have fewer points to look through.
const EDGE: f32 = 2.0;
/// Cells at most, for each point.
const CELLS: usize = 4;

/// A kept grid.
pub(crate) struct FixedGrid {
    threshold: Threshold,
    /// Nothing outside has a partner.
    region: Aabb,
    frame: Frame,
    filter: Filter,
    cells: Cells,
    near: Near,
}

/// The points near each cell, in the order of their numbers, structure of arrays.
///
/// Memory: 16 bytes for each cell that a point is near to. On a surface these are four to six for most points, if the threshold is
/// about as long as the points are apart.
#[derive(Debug, Default)]
struct Near {
    c: [Vec<f32>; 3],
    id: Vec<u32>,
    /// One entry a cell and one for the end.
    start: Vec<u32>,
}

impl Near {
    /// `None` where there are too many to be counted in 32 bits.
    fn new(parts: &[Part], cells: &Cells, reach: f32) -> Option<Self> {
        let count = cells.count();
        let mut start = vec![0_u32; count.iter().product::<usize>() + 1];
        let mut total = 0_u64;
        for point in parts.iter().flat_map(|part| &part.points) {
            cells.visit_near(&point.q, reach, |cell| {
                // what wraps around is refused below
                start[cell + 1] = start[cell + 1].wrapping_add(1);
                total += 1;
            });
        }
        let total = u32::try_from(total).ok()?;
        for cell in 1..start.len() {
            start[cell] += start[cell - 1];
        }
        let len = total as usize + PADDING;
        let mut near = Self {
            c: [(); 3].map(|()| vec![f32::INFINITY; len]),
            id: vec![0; len],
            start: Vec::new(),
        };
        let mut next = start.clone();
        for point in parts.iter().flat_map(|part| &part.points) {
            cells.visit_near(&point.q, reach, |cell| {
                let at = next[cell] as usize;
                next[cell] += 1;
                for (axis, &c) in near.c.iter_mut().zip(&point.q) {
                    axis[at] = c;
                }
                near.id[at] = point.id;
            });
        }
        near.start = start;
        Some(near)
    }
}

/// What a look into it found.
#[derive(Debug, Default)]
pub(crate) struct Found {
    /// The pairs, the looking body's point first, in its order.
    pub(crate) pairs: Vec<Pair>,
    /// Points outside the region.
    pub(crate) clipped: u64,
    /// Points inside it without a point nearby.
    pub(crate) lonely: u64,
}

impl FixedGrid {
    /// Sorts the points; `None` if there are none.
    ///
    /// # Errors
    /// [`Error::NonFiniteVertex`].
    pub(crate) fn new(points: &[[f64; 3]], threshold: Threshold) -> Result<Option<Self>, Error> {
        let mut runs = Runs::default();
        runs.measure(points, 1)?;
        let Some(bounds) = runs.whole() else {
            return Ok(None);
        };
        let region = inflate(&bounds, threshold.get());
        let frame = Frame::for_threshold(&region, threshold.get());
        let (mut parts, mut inside) = (Vec::new(), Vec::new());
        runs.inside(&region, &mut inside);
        Clip {
            points,
            runs: &runs,
            inside: &inside,
            region: &region,
            frame: &frame,
        }
        .place(&mut parts, 1);
        let filter = frame.filter(threshold.get());
        let bound = |of: fn(&Part) -> [f32; 3], more: fn(f32, f32) -> f32| {
            let bounds = parts.iter().map(of);
            bounds.reduce(|a, b| std::array::from_fn(|k| more(a[k], b[k])))
        };
        let (Some(min), Some(max)) = (
            bound(|part| part.min, super::clip::lesser),
            bound(|part| part.max, super::clip::greater),
        ) else {
            return Ok(None);
        };
        let cells = Cells::new(min, max, EDGE * filter.reach, CELLS * points.len() + 64);
        let Some(near) = Near::new(&parts, &cells, filter.reach) else {
            return Ok(None);
        };
        Ok(Some(Self {
            threshold,
            region,
            frame,
            filter,
            cells,
            near,
        }))
    }

    /// All pairs of a point of `a` and one of the points that were sorted, which are `b`.
    pub(crate) fn look_up(&self, a: &[[f64; 3]], b: &[[f64; 3]], found: &mut Found) {
        found.pairs.clear();
        (found.clipped, found.lonely) = (0, 0);
        let decide = &Decide {
            a,
            b,
            threshold: self.threshold,
        };
        dispatch(LookUp {
            grid: self,
            decide,
            found,
        });
    }
}

struct LookUp<'a> {
    grid: &'a FixedGrid,
    decide: &'a Decide<'a>,
    found: &'a mut Found,
}

impl Work for LookUp<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let FixedGrid {
            region,
            frame,
            filter: Filter { sure, limit, .. },
            cells,
            near:
                Near {
                    c: [x, y, z],
                    id,
                    start,
                },
            ..
        } = self.grid;
        for (a, point) in (0..).zip(self.decide.a) {
            let inside = (0..3).fold(true, |inside, k| {
                inside & (region.min[k] <= point[k]) & (point[k] <= region.max[k])
            });
            if !inside {
                self.found.clipped += 1;
                continue;
            }
            let q = frame.place(point);
            let cell = cells.index(&q);
            let (mut at, end) = (start[cell] as usize, start[cell + 1] as usize);
            self.found.lonely += u64::from(at == end);
            while at < end {
                let rest = end - at;
                let valid = if rest < 8 { (1 << rest) - 1 } else { 0xff };
                let c = [eight(x, at), eight(y, at), eight(z, at)];
                let mut hits = lanes.closer(c, q, *limit) & valid;
                while hits != 0 {
                    let lane = hits.trailing_zeros() as usize & 7;
                    hits &= hits - 1;
                    let d: [f32; 3] = std::array::from_fn(|k| c[k][lane] - q[k]);
                    let b = id_eight(id, at)[lane];
                    if d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < *sure || self.decide.closer(a, b) {
                        self.found.pairs.push(Pair { a, b });
                    }
                }
                at += 8;
            }
        }
    }
}

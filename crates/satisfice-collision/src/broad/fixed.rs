//! The points of a body that stays where it is, sorted into a grid once; every point of another body is looked up in it.

use super::cells::{Cells, Sorted};
use super::clip::{Clip, Runs, inflate};
use super::exact::Decide;
use super::frame::{Filter, Frame};
use super::join::{eight, id_eight};
use super::lanes::{Lanes, Work, dispatch};
use super::order::Packing;
use super::sieve::Presence;
use crate::distance::Threshold;
use crate::{Aabb, Error};

/// A kept grid.
pub(crate) struct FixedGrid {
    threshold: Threshold,
    /// Nothing outside has a partner.
    region: Aabb,
    frame: Frame,
    filter: Filter,
    presence: Presence,
    cells: Cells,
    sorted: Sorted,
}

/// What a look into it found.
#[derive(Debug, Default)]
pub(crate) struct Found {
    /// The pairs, packed, the looking body's point first, in its order.
    pub(crate) keys: Vec<u64>,
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
        let mut parts = Vec::new();
        Clip {
            points,
            runs: &runs,
            region: &region,
            frame: &frame,
        }
        .place(&mut parts, 1);
        let filter = frame.filter(threshold.get());
        let cells = Cells::fit(&parts, filter.reach);
        let mut sorted = Sorted::default();
        sorted.sort(&parts, &cells, 1);
        Ok(Some(Self {
            threshold,
            region,
            frame,
            filter,
            presence: Presence::of(&parts, filter.reach),
            cells,
            sorted,
        }))
    }

    /// All pairs of a point of `a` and one of the points that were sorted, which are `b`.
    pub(crate) fn look_up(&self, a: &[[f64; 3]], b: &[[f64; 3]], packing: Packing, found: &mut Found) {
        found.keys.clear();
        (found.clipped, found.lonely) = (0, 0);
        let decide = &Decide {
            a,
            b,
            threshold: self.threshold,
        };
        dispatch(LookUp {
            grid: self,
            decide,
            packing,
            found,
        });
    }
}

struct LookUp<'a> {
    grid: &'a FixedGrid,
    decide: &'a Decide<'a>,
    packing: Packing,
    found: &'a mut Found,
}

impl Work for LookUp<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let FixedGrid {
            region,
            frame,
            filter,
            presence,
            cells,
            sorted,
            ..
        } = self.grid;
        let Filter {
            sure, limit, reach, ..
        } = *filter;
        let [columns, rows, _] = cells.count();
        let ([x, y, z], start) = (&sorted.c, &sorted.start);
        for (a, point) in (0..).zip(self.decide.a) {
            let inside = (0..3).fold(true, |inside, k| {
                inside & (region.min[k] <= point[k]) & (point[k] <= region.max[k])
            });
            if !inside {
                self.found.clipped += 1;
                continue;
            }
            let q = frame.place(point);
            if !presence.near(q) {
                self.found.lonely += 1;
                continue;
            }
            let range = |k: usize| cells.cell(k, q[k] - reach)..cells.cell(k, q[k] + reach) + 1;
            let (xs, ys, zs) = (range(0), range(1), range(2));
            for layer in zs {
                for row in ys.clone() {
                    let row = (layer * rows + row) * columns;
                    let mut at = start[row + xs.start] as usize;
                    let end = start[row + xs.end] as usize;
                    while at < end {
                        let rest = end - at;
                        let valid = if rest < 8 { (1 << rest) - 1 } else { 0xff };
                        let c = [eight(x, at), eight(y, at), eight(z, at)];
                        let mut hits = lanes.closer(c, q, limit) & valid;
                        while hits != 0 {
                            let lane = hits.trailing_zeros() as usize & 7;
                            hits &= hits - 1;
                            let d: [f32; 3] = std::array::from_fn(|k| c[k][lane] - q[k]);
                            let b = id_eight(&sorted.id, at)[lane];
                            if d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < sure || self.decide.closer(a, b) {
                                self.found.keys.push(self.packing.pack(a, b));
                            }
                        }
                        at += 8;
                    }
                }
            }
        }
    }
}

//! Where candidates come from.

use super::lanes::{LANES, Lanes};
use super::record::Record;
use super::units::{Shape, Units};
use crate::seed::SearchRng;

/// Hits that count as the latest.
const LATEST: usize = 16;
/// Points of least F around which candidates are drawn while there are few hits.
const LEAST: usize = 8;
/// Share of the steps that leave the reach of a hit by just so much.
const JUST_OUTSIDE: f64 = 0.4;

/// Draws of a candidate near a hit, until it is new.
const TRIES: usize = 8;

/// What candidates are drawn from.
pub(super) struct CandidateSource<'a> {
    pub(super) units: &'a Units,
    pub(super) record: &'a Record,
    /// Indices of the points that the model knows.
    pub(super) known: &'a [usize],
    /// Length scales.
    pub(super) lengths: &'a [f64],
    /// How far from a hit the next distinct one may be, for each axis; 0 if that is not known.
    pub(super) reach: &'a [f64],
    /// Where uniform candidates are drawn.
    pub(super) bounds: (&'a [f64], &'a [f64]),
}

impl CandidateSource<'_> {
    /// A block of uniform candidates if `k` is even, else one near hits.
    pub(super) fn either(
        &self,
        k: usize,
        least: &[usize],
        is_known: &mut dyn FnMut(&[f64]) -> bool,
        rng: &mut SearchRng,
    ) -> Vec<Lanes> {
        if k.is_multiple_of(2) {
            self.uniform(rng)
        } else {
            self.near_hits(least, is_known, rng)
        }
    }

    /// A block of uniform candidates.
    fn uniform(&self, rng: &mut SearchRng) -> Vec<Lanes> {
        let (lower, upper) = self.bounds;
        self.block(&mut |_| false, |x| {
            for (x, (lower, upper)) in x.iter_mut().zip(lower.iter().zip(upper)) {
                *x = lower + (upper - lower) * rng.uniform();
            }
        })
    }

    /// A block of candidates near hits, or near the points of least F.
    fn near_hits(
        &self,
        least: &[usize],
        is_known: &mut dyn FnMut(&[f64]) -> bool,
        rng: &mut SearchRng,
    ) -> Vec<Lanes> {
        let mut step = vec![0.0; self.units.len()];
        self.block(is_known, |x| {
            let (from, is_hit) = self.base(least, rng);
            x.copy_from_slice(from);
            if is_hit && rng.uniform() < JUST_OUTSIDE && self.reach.iter().any(|&reach| reach > 0.0) {
                self.leave(&mut step, rng);
            } else {
                let longest = (rng.uniform() * (0.01_f64).ln()).exp();
                self.step(longest, &mut step, rng);
            }
            self.add(x, &step, rng);
        })
    }

    /// A block of candidates around one point, at several scales.
    pub(super) fn around(
        &self,
        point: &[f64],
        longest: f64,
        is_known: &mut dyn FnMut(&[f64]) -> bool,
        rng: &mut SearchRng,
    ) -> Vec<Lanes> {
        let mut step = vec![0.0; self.units.len()];
        self.block(is_known, |x| {
            x.copy_from_slice(point);
            let length = longest * (rng.uniform() * (0.1_f64).ln()).exp();
            self.step(length, &mut step, rng);
            self.add(x, &step, rng);
        })
    }

    /// Fills a block; known points are drawn again a few times.
    fn block(
        &self,
        is_known: &mut dyn FnMut(&[f64]) -> bool,
        mut fill: impl FnMut(&mut [f64]),
    ) -> Vec<Lanes> {
        let mut lanes = vec![[0.0; LANES]; self.units.len()];
        let mut x = vec![0.0; self.units.len()];
        for lane in 0..LANES {
            for _ in 0..TRIES {
                fill(&mut x);
                if !is_known(&x) {
                    break;
                }
            }
            self.units.round(&mut x);
            for (lanes, &x) in lanes.iter_mut().zip(&x) {
                lanes[lane] = x;
            }
        }
        lanes
    }

    /// A point to start from, and whether it is a hit.
    fn base(&self, least: &[usize], rng: &mut SearchRng) -> (&[f64], bool) {
        let hits = &self.record.hits;
        let choice = rng.uniform();
        if !hits.is_empty() && choice < 0.75 {
            let latest = if choice < 0.375 {
                LATEST.min(hits.len())
            } else {
                hits.len()
            };
            let hit = hits[hits.len() - 1 - rng.below(latest)];
            return (self.record.point(hit), true);
        }
        let among = if least.is_empty() { self.known } else { least };
        (self.record.point(among[rng.below(among.len())]), false)
    }

    /// A normal step, as long as `longest` length scales, along all axes or some.
    fn step(&self, longest: f64, step: &mut [f64], rng: &mut SearchRng) {
        let axes = step.len();
        let some = rng.uniform() < 0.5;
        let forced = rng.below(axes);
        #[expect(clippy::cast_precision_loss, reason = "a number of axes")]
        let share = 2.0 / axes as f64;
        for (j, step) in step.iter_mut().enumerate() {
            let moves = !some || j == forced || rng.uniform() < share;
            *step = if moves {
                longest * self.lengths[j].min(0.5) * rng.normal()
            } else {
                0.0
            };
        }
    }

    /// A step in a random direction to just outside the reach of a hit.
    fn leave(&self, step: &mut [f64], rng: &mut SearchRng) {
        let mut square = 0.0;
        for step in step.iter_mut() {
            *step = rng.normal();
            square += *step * *step;
        }
        let further = rng.uniform();
        let length = (1.001 + further * further) / square.sqrt();
        for (step, reach) in step.iter_mut().zip(self.reach) {
            *step *= length * reach;
        }
    }

    fn add(&self, x: &mut [f64], step: &[f64], rng: &mut SearchRng) {
        for ((x, &step), unit) in x.iter_mut().zip(step).zip(&self.units.axes) {
            let mut step = step;
            if unit.shape == Shape::Category {
                // Any other category, as probably as a step on an integer axis with as many cells.
                if step != 0.0 && rng.uniform() < step.abs() * unit.cells {
                    let others = 1.0 + (rng.uniform() * (unit.cells - 1.0)).floor();
                    *x = (*x + others / unit.cells).fract();
                }
                continue;
            }
            if unit.cells > 0.0 && step != 0.0 {
                // Whole cells, by chance up or down, so that short steps move at times.
                step = (step * unit.cells + rng.uniform()).floor() / unit.cells;
            }
            let moved = *x + step;
            if unit.shape == Shape::Circle {
                *x = moved - moved.floor();
                continue;
            }
            // Reflected once, then clamped: long steps are rare.
            let inside = if moved < 0.0 {
                -moved
            } else if moved > 1.0 {
                2.0 - moved
            } else {
                moved
            };
            *x = inside.clamp(0.0, 1.0);
        }
    }
}

/// The indices among `known` of the points of least F.
pub(super) fn least(record: &Record, known: &[usize]) -> Vec<usize> {
    let mut order: Vec<usize> = known
        .iter()
        .copied()
        .filter(|&i| !record.values[i].is_nan())
        .collect();
    order.sort_by(|&a, &b| record.values[a].total_cmp(&record.values[b]));
    // Hits have their own share.
    let hits = order.partition_point(|i| record.hits.binary_search(i).is_ok());
    order.drain(..hits.min(order.len()));
    order.truncate(LEAST);
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::{Axis, Space};

    /// Steps from one point of a space of five categories and a circle.
    #[test]
    fn steps_reach_every_other_category_alike_and_go_around_circles() {
        let axes = [Axis::categorical(5), Axis::continuous(0.0, 1.0).periodic()];
        let space = Space::<f64>::new(axes).unwrap();
        let units = Units::of(&space);
        let record = Record::default();
        let source = CandidateSource {
            units: &units,
            record: &record,
            known: &[],
            lengths: &[0.5, 0.5],
            reach: &[0.0, 0.0],
            bounds: (&[0.0, 0.0], &[1.0, 1.0]),
        };
        let mut rng = SearchRng::new(3);
        let (mut counts, mut around) = ([0_u32; 5], 0);
        for _ in 0..4_000 {
            let mut x: [f64; 2] = [0.9, 0.95];
            source.add(&mut x, &[0.1, 0.1], &mut rng);
            assert!((x[1] - 0.05).abs() < 1e-12);
            counts[(x[0] * 5.0) as usize] += 1;
            let mut x: [f64; 2] = [0.1, 0.02];
            source.add(&mut x, &[0.0, -0.1], &mut rng);
            around += u32::from((x[0], (x[1] - 0.92).abs() < 1e-12) == (0.1, true));
        }
        // Half of the steps leave the category, an eighth each for the four others: 500 of 4,000, within five deviations.
        assert!(
            counts[..4].iter().all(|count| (395..=605).contains(count)),
            "{counts:?}"
        );
        assert_eq!(around, 4_000);
    }
}

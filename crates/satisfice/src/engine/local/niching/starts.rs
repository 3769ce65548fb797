//! Where the searches of [`Niching`](super::Niching) start.

use super::{NichingSearch, StrategyRun, confined, to_place, usual_size};
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::Space;

/// Displacements from known ends, as shares of the axes: drawn log-uniformly.
const HOPS: (f64, f64) = (0.01, 0.2);
/// First steps after a displacement are this share of it or more.
const SETTLING: f64 = 0.5;
/// Points of which the one farthest from known hits becomes a start, at most; and coordinates of hits that are looked at for it.
const STARTS: usize = 100;
const LOOKED: usize = 1 << 16;
/// Once so many searches from far points in a row have come to known ends, half of their turns are for uniform points and this step.
const STREAK: u64 = 20;
const SMALL_STEP: f64 = 0.05;
/// The first step from a near miss; and the largest share of the evaluations that searches from there may take.
const REFINING_STEP: f64 = 0.003;
const REFINING: f64 = 0.05;
/// How often a generation is of twice the usual size, and how often again; up to so many coordinates.
const DOUBLING: f64 = 0.25;
const COORDINATES: usize = 1 << 20;

/// Where a search starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub(super) enum Start {
    /// From a point far from known hits.
    #[default]
    Far,
    /// From a uniform point, with a small step.
    Uniform,
    /// From beside a known end.
    Hop,
    /// From a near miss of recombinations.
    NearMiss,
}

impl Start {
    /// Whether such a search refuses samples near known hits, and changes their radii.
    pub(super) fn keeps_away(self) -> bool {
        matches!(self, Self::Far | Self::NearMiss)
    }
}

fn log_uniform(rng: &mut SearchRng, (smallest, largest): (f64, f64)) -> f64 {
    largest * (smallest / largest).powf(rng.uniform())
}

impl<S: Real> NichingSearch<S> {
    /// Starts the next search: from the best near miss every other time, else beside a known end or anywhere.
    pub(super) fn begin_run(&mut self, space: &Space<S>, rng: &mut SearchRng) {
        let dimension = self.start.len();
        self.restarts += 1;
        self.run = StrategyRun {
            running: true,
            from: Start::Far,
            origin: f64::INFINITY,
            first_spread: 0.0,
            size: usual_size(dimension),
            generations: 0,
            deleted: 0,
            best: core::mem::take(&mut self.run.best),
            fitness: f64::INFINITY,
            before: f64::INFINITY,
            looked: f64::INFINITY,
        };
        let step = if self.is_refining_due()
            && self
                .recombined
                .take_best_miss(|position, _| to_place(space, position, &mut self.start))
        {
            self.run.from = Start::NearMiss;
            REFINING_STEP
        } else {
            let step = self
                .hop(space, rng)
                .unwrap_or_else(|| self.start_anywhere(space, rng));
            self.started[usize::from(self.run.from != Start::Hop)] += 1;
            while 2 * self.run.size * dimension <= COORDINATES && rng.uniform() < DOUBLING {
                self.run.size *= 2;
            }
            step
        };
        self.distribution.reset(&self.start, step, self.run.size);
        self.run.first_spread = self.distribution.spread();
    }

    /// Whether it is the turn of a near miss.
    fn is_refining_due(&self) -> bool {
        let [refining, all] = self.spent.map(|count| count as f64);
        self.restarts.is_multiple_of(2) && refining <= REFINING * all
    }

    /// Writes a start that is beside no known end on purpose, and returns the first step.
    fn start_anywhere(&mut self, space: &Space<S>, rng: &mut SearchRng) -> f64 {
        if self.streak >= STREAK && rng.uniform() < 0.5 {
            self.start.fill_with(|| rng.uniform());
            self.run.from = Start::Uniform;
            return SMALL_STEP.min(self.settings.step);
        }
        self.draw_start(space, rng);
        self.settings.step
    }

    /// Writes a start that is far from known hits, in their radii, of points that cover the space evenly.
    fn draw_start(&mut self, space: &Space<S>, rng: &mut SearchRng) {
        let dimension = self.start.len();
        let coordinates = self.recombined.hits().len().min(self.ends.len() * dimension);
        let candidates = LOOKED
            .checked_div(coordinates)
            .map_or(1, |count| count.clamp(1, STARTS));
        let mut widest = 0.0;
        self.place.resize(dimension, 0.5);
        for _ in 0..candidates {
            self.even.draw(space, rng, &mut self.position);
            to_place(space, &self.position, &mut self.place);
            let room = self.ends.room(&self.place);
            if room > widest {
                widest = room;
                self.start.copy_from_slice(&self.place);
            }
        }
    }

    /// Writes a start beside a known end, if it is the turn of one, and returns the first step.
    fn hop(&mut self, space: &Space<S>, rng: &mut SearchRng) -> Option<f64> {
        let (share, [hops, others]) = (self.settings.hops, self.started.map(|count| count as f64));
        if hops * (1.0 - share) >= others * share {
            return None;
        }
        let dimension = self.start.len();
        let length = log_uniform(rng, HOPS);
        let end = self.ends.promising(length * (dimension as f64).sqrt())?;
        self.start.copy_from_slice(self.ends.place(end, dimension));
        for (x, axis) in self.start.iter_mut().zip(space.axes()) {
            *x = confined(axis, *x + length * rng.normal());
        }
        self.run.from = Start::Hop;
        self.run.origin = self.ends.fitness(end);
        Some(log_uniform(rng, (SETTLING * length, length)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::Niching;
    use super::*;
    use crate::space::Axis;

    /// Beside an end next to the end of an axis.
    #[test]
    fn a_search_beside_a_known_end_may_start_across_the_end_of_a_periodic_axis_only() {
        let bounded = Axis::continuous(0.0, 1.0);
        let space = Space::new([bounded.periodic(), bounded]).unwrap();
        let mut search = NichingSearch::<f64>::new(Niching::default());
        search.start = vec![0.5; 2];
        search.ends.add(&[0.995, 0.995], 1.0, false);
        let mut rng = SearchRng::new(1);
        let mut beyond = [0; 2];
        for _ in 0..200 {
            search.started = [0, 1];
            assert!(search.hop(&space, &mut rng).is_some());
            for (count, x) in beyond.iter_mut().zip(&search.start) {
                *count += u32::from(*x > 1.0);
            }
        }
        assert!(beyond[0] > 50 && beyond[1] == 0, "{beyond:?}");
    }
}

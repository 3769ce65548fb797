//! Near misses of the slice before: where a problem moves, most new hits were near misses.

use crate::error::Error;
use crate::scalar::Real;
use crate::state::{Part, Reader, State, read_rows, write_rows};

/// Most near misses that are handed on to the next slice, and most numbers of them; a running slice keeps up to twice as many. So
/// they take half a megabyte of a checkpoint at most.
const MOST: usize = 8192;
const NUMBERS: usize = 48 << 10;

fn most(dimension: usize) -> usize {
    MOST.min(NUMBERS / (dimension + 1)).max(1)
}

/// Past trials are halved at this number: the best are tried first, so the yield falls steadily.
const MEMORY: f64 = 128.0;

/// Points that were evaluated and missed, with their fitness.
#[derive(Debug, Clone, Default)]
struct Misses<S> {
    fitness: Vec<f64>,
    positions: Vec<S>,
}

impl<S: Real> Misses<S> {
    fn push(&mut self, fitness: f64, position: &[S]) {
        self.fitness.push(fitness);
        self.positions.extend_from_slice(position);
    }

    fn row(&self, index: usize, dimension: usize) -> &[S] {
        &self.positions[index * dimension..(index + 1) * dimension]
    }

    /// The indices of the best `count`, in no order; of equal ones the earlier.
    fn best_indices(&self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.fitness.len()).collect();
        if count < order.len() {
            order.select_nth_unstable_by(count, |&a, &b| self.rank(a, b));
            order.truncate(count);
        }
        order
    }

    fn rank(&self, a: usize, b: usize) -> core::cmp::Ordering {
        self.fitness[a].total_cmp(&self.fitness[b]).then(a.cmp(&b))
    }

    /// The best `count`, best first.
    fn best(&self, count: usize, dimension: usize) -> Self {
        let mut order = self.best_indices(count);
        order.sort_unstable_by(|&a, &b| self.rank(a, b));
        let mut best = Self {
            fitness: Vec::with_capacity(order.len()),
            positions: Vec::with_capacity(order.len() * dimension),
        };
        for index in order {
            best.push(self.fitness[index], self.row(index, dimension));
        }
        best
    }

    /// Forgets all but the best `count`, which stay in their order, and returns the fitness of the worst of them.
    fn keep_best(&mut self, count: usize, dimension: usize) -> f64 {
        let mut order = self.best_indices(count);
        order.sort_unstable();
        let mut worst = f64::NEG_INFINITY;
        for (to, &from) in order.iter().enumerate() {
            worst = worst.max(self.fitness[from]);
            self.fitness[to] = self.fitness[from];
            let row = from * dimension..(from + 1) * dimension;
            self.positions.copy_within(row, to * dimension);
        }
        self.fitness.truncate(order.len());
        self.positions.truncate(order.len() * dimension);
        worst
    }

    fn save(&self, state: &mut State) {
        write_rows(state, &self.fitness, 1);
        write_rows(
            state,
            &self.positions,
            self.positions.len() / self.fitness.len().max(1),
        );
    }

    fn restore(from: &mut Reader<'_>) -> Result<Self, Error> {
        Ok(Self {
            fitness: read_rows(from)?,
            positions: read_rows(from)?,
        })
    }
}

/// The near misses of the slice before, best first, and those of this one.
#[derive(Debug, Clone)]
pub(super) struct NearMisses<S> {
    before: Misses<S>,
    /// The next one of these.
    cursor: usize,
    now: Misses<S>,
    /// Misses that are not better than this are not kept.
    bound: f64,
    trials: f64,
    hits: f64,
}

impl<S: Real> NearMisses<S> {
    pub(super) fn new() -> Self {
        Self {
            before: Misses::default(),
            cursor: 0,
            now: Misses::default(),
            bound: f64::INFINITY,
            trials: 0.0,
            hits: 0.0,
        }
    }

    /// Begins a slice that tries the near misses of the last one again. `follows`: whether there was one.
    pub(super) fn begin(&mut self, dimension: usize, follows: bool) {
        let mut left = core::mem::take(&mut self.now);
        if follows {
            // Those that were not tried again are as good as before.
            for index in self.cursor..self.before.fitness.len() {
                left.push(self.before.fitness[index], self.before.row(index, dimension));
            }
            self.before = left.best(most(dimension), dimension);
        } else {
            self.before = Misses::default();
        }
        self.cursor = 0;
        self.bound = f64::INFINITY;
        (self.trials, self.hits) = (2.0, 1.0);
    }

    /// Whether restored lists belong to a space of so many axes.
    pub(super) fn fit(&self, dimension: usize) -> bool {
        [&self.before, &self.now]
            .iter()
            .all(|misses| Some(misses.positions.len()) == misses.fitness.len().checked_mul(dimension))
    }

    /// Rate of hits lately as `(hits, trials)`, if there is one to try.
    pub(super) fn posterior(&self) -> Option<(f64, f64)> {
        (self.cursor < self.before.fitness.len()).then_some((self.hits, self.trials))
    }

    /// Writes the next best; `false` when there is none.
    pub(super) fn propose(&mut self, position: &mut [S]) -> bool {
        if self.cursor >= self.before.fitness.len() {
            return false;
        }
        position.copy_from_slice(self.before.row(self.cursor, position.len()));
        self.cursor += 1;
        true
    }

    /// Counts one that was tried.
    pub(super) fn count(&mut self, hit: bool) {
        self.trials += 1.0;
        self.hits += f64::from(u8::from(hit));
        if self.trials > MEMORY {
            self.trials *= 0.5;
            self.hits *= 0.5;
        }
    }

    /// Keeps a miss of any source if it is among the best.
    #[inline]
    pub(super) fn keep(&mut self, position: &[S], fitness: S) {
        let fitness = fitness.f64();
        if fitness < self.bound {
            self.now.push(fitness, position);
            let most = most(position.len());
            if self.now.fitness.len() >= 2 * most {
                self.bound = self.now.keep_best(most, position.len());
            }
        }
    }
}

impl<S: Real> Part for NearMisses<S> {
    /// Of those of this slice, only what may still be among the best.
    fn save(&self, state: &mut State) {
        self.before.save(state);
        let dimension = self.now.positions.len() / self.now.fitness.len().max(1);
        let mut now = self.now.clone();
        now.keep_best(most(dimension), dimension);
        now.save(state);
        state.write(&(self.cursor, self.trials, self.hits));
    }

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.before = Misses::restore(from)?;
        self.now = Misses::restore(from)?;
        (self.cursor, self.trials, self.hits) = from.read()?;
        self.bound = f64::INFINITY;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_come_first_and_what_was_not_tried_is_not_forgotten() {
        let mut misses = NearMisses::<f64>::new();
        misses.begin(1, false);
        assert!(misses.posterior().is_none());
        for x in [5.0, 2.0, 3.0, 2.0] {
            misses.keep(&[10.0 * x], x);
        }
        misses.begin(1, true);
        let mut x = [0.0];
        assert!(misses.propose(&mut x));
        misses.keep(&x, 4.0); // it has moved away
        misses.begin(1, true);
        let mut order = Vec::new();
        while misses.propose(&mut x) {
            order.push(x[0]);
        }
        assert_eq!(order, [20.0, 30.0, 20.0, 50.0]);
    }

    #[test]
    fn only_so_many_are_kept_and_those_are_the_best() {
        let mut misses = NearMisses::<f64>::new();
        misses.begin(1, false);
        let count = 5 * MOST;
        for i in 0..count {
            let f = ((i * 7919) % count) as f64;
            misses.keep(&[f], f);
        }
        misses.begin(1, true);
        let mut x = [0.0];
        for want in 0..MOST {
            assert!(misses.propose(&mut x));
            assert!(x[0] == want as f64);
        }
        assert!(!misses.propose(&mut x));
    }

    #[test]
    fn a_first_slice_has_none() {
        let mut misses = NearMisses::<f64>::new();
        misses.begin(2, false);
        misses.keep(&[1.0, 2.0], 1.0);
        misses.begin(1, false);
        assert!(!misses.propose(&mut [0.0]));
    }
}

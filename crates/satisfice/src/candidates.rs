//! The candidates of one batch between proposal and outcome.

use crate::archive::{KnownHits, Mark};
use crate::batch::{Batch, Outcome};
use crate::error::Error;
use crate::problem::AnyProblem;
use crate::scalar::Real;
use crate::space::Space;

/// Coordinates prepared between two questions whether the slice is interrupted: much less than a millisecond.
const COORDINATES: usize = 1 << 14;

/// The candidates of one batch. Memory is reused from batch to batch.
#[derive(Debug)]
pub(crate) struct Candidates<S, T> {
    /// The first `live` solutions are to be evaluated; those after them are memory to be reused.
    pub(crate) solutions: Vec<T>,
    pub(crate) live: usize,
    /// The fitness of the live ones.
    pub(crate) fitness: Vec<S>,
    /// The number of live ones that are computed without a gap...
    pub(crate) ready: usize,
    /// ...and which are computed, if threads have left gaps.
    done: Vec<bool>,
    has_gaps: bool,
    /// One per point of the batch. Before they are settled: `Deleted` for a point that is not live, else `NotEvaluated`.
    pub(crate) outcomes: Vec<Outcome<S>>,
    /// Whether they are uniform probes, whose hits the engine does not see.
    pub(crate) probing: bool,
    values: Vec<S>,
    /// Whether found solutions are deleted from the space, as far as the engine is concerned.
    pub(crate) deletes: bool,
    /// When the live ones were not in the archive, if they were looked up.
    pub(crate) absent: Option<Mark>,
}

impl<S: Real, T> Default for Candidates<S, T> {
    fn default() -> Self {
        Self {
            solutions: Vec::new(),
            live: 0,
            fitness: Vec::new(),
            ready: 0,
            done: Vec::new(),
            has_gaps: false,
            outcomes: Vec::new(),
            probing: false,
            values: Vec::new(),
            deletes: true,
            absent: None,
        }
    }
}

impl<S: Real, T: crate::Identity + Clone + Send + Sync> Candidates<S, T> {
    /// Brings the points inside, decodes the first `limit` of them and looks them up in the archive. Interrupted, it leaves the
    /// others as if they were beyond the limit.
    #[inline]
    pub(crate) fn prepare(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        archive: &KnownHits<T>,
        batch: &mut Batch<S>,
        limit: usize,
        deletes: bool,
        is_interrupted: impl Fn() -> bool,
    ) {
        self.reset(deletes, archive);
        let points = batch.len().min(limit);
        let stride = (COORDINATES / batch.dimension()).max(1);
        for first in (0..points).step_by(stride) {
            if first > 0 && is_interrupted() {
                break;
            }
            for i in first..points.min(first + stride) {
                let values = inside(problem.space(), batch.point_mut(i), &mut self.values);
                match self.solutions.get_mut(self.live) {
                    Some(slot) => problem.decode_into(values, slot),
                    None => self.solutions.push(problem.decode(values)),
                }
                self.file(archive);
            }
        }
        self.make_room(batch.len());
    }

    /// Brings one point inside, decodes it and lets `judge` see the solution.
    #[inline]
    pub(crate) fn with_one<R>(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        point: &mut [S],
        judge: impl FnOnce(&T) -> R,
    ) -> R {
        let values = inside(problem.space(), point, &mut self.values);
        if !core::mem::needs_drop::<T>() {
            // A solution without memory stays in registers: loads from a list would wait for stores of another width.
            return judge(&problem.decode(values));
        }
        match self.solutions.first_mut() {
            Some(slot) => problem.decode_into(values, slot),
            None => self.solutions.push(problem.decode(values)),
        }
        judge(&self.solutions[0])
    }

    /// Prepares solutions that are known already, at the points of `batch`.
    pub(crate) fn prepare_solutions<'a>(
        &mut self,
        solutions: impl ExactSizeIterator<Item = &'a T>,
        archive: &KnownHits<T>,
        limit: usize,
    ) where
        T: 'a,
    {
        self.reset(true, archive);
        let points = solutions.len();
        for solution in solutions.take(limit) {
            match self.solutions.get_mut(self.live) {
                Some(slot) => slot.clone_from(solution),
                None => self.solutions.push(solution.clone()),
            }
            self.file(archive);
        }
        self.make_room(points);
    }

    #[inline]
    fn reset(&mut self, deletes: bool, archive: &KnownHits<T>) {
        self.deletes = deletes;
        self.absent = deletes.then(|| archive.mark());
        self.live = 0;
        self.ready = 0;
        self.has_gaps = false;
        self.outcomes.clear();
    }

    #[inline]
    fn make_room(&mut self, points: usize) {
        if self.outcomes.len() < points {
            self.outcomes.resize(points, Outcome::NotEvaluated);
        }
        if self.fitness.len() < self.live {
            self.fitness.resize(self.live, S::zero());
        }
    }

    /// Files the solution in slot `live` as the next point.
    #[inline]
    fn file(&mut self, archive: &KnownHits<T>) {
        let outcome = if self.deletes && archive.contains(&self.solutions[self.live]) {
            Outcome::Deleted
        } else {
            Outcome::NotEvaluated
        };
        self.live += usize::from(outcome != Outcome::Deleted);
        self.outcomes.push(outcome);
    }

    /// Whether the fitness in a slot is computed.
    #[inline]
    pub(crate) fn is_done(&self, slot: usize) -> bool {
        slot < self.ready || (self.has_gaps && self.done[slot])
    }

    /// Whether every live fitness is computed.
    pub(crate) fn is_complete(&self) -> bool {
        (self.ready..self.live).all(|slot| self.is_done(slot))
    }

    /// Solutions, fitness, and whether it is computed: to be filled in any order.
    #[cfg(feature = "rayon")]
    pub(crate) fn slots(&mut self) -> (&[T], &mut [S], &mut [bool]) {
        if !self.has_gaps {
            self.done.clear();
            self.done.resize(self.live, false);
            self.has_gaps = true;
        }
        let ready = self.ready.min(self.live);
        self.done[..ready].fill(true);
        (
            &self.solutions[..self.live],
            &mut self.fitness[..self.live],
            &mut self.done,
        )
    }

    /// The fitness of the live ones, as far as it is computed.
    pub(crate) fn computed(&self) -> Vec<Option<S>> {
        (0..self.live)
            .map(|slot| self.is_done(slot).then_some(self.fitness[slot]))
            .collect()
    }

    /// Takes fitness values that were computed before; missing ones remain to be evaluated.
    pub(crate) fn resume(&mut self, computed: &[Option<S>]) {
        for (fitness, computed) in self.fitness.iter_mut().zip(computed) {
            *fitness = computed.unwrap_or(*fitness);
        }
        self.done.clear();
        self.done.extend(computed.iter().map(Option::is_some));
        self.done.resize(self.live, false);
        self.has_gaps = true;
        self.ready = self.done.iter().take_while(|&&done| done).count();
    }

    /// The solutions to evaluate, in order.
    pub(crate) fn live(&self) -> &[T] {
        &self.solutions[..self.live]
    }

    /// Takes all fitness values, computed elsewhere.
    pub(crate) fn take_fitness(&mut self, fitness: &[S]) -> Result<(), Error> {
        if fitness.len() < self.live {
            return Err(Error::Tell {
                wanted: self.live,
                got: fitness.len(),
            });
        }
        self.take_first(fitness)
    }

    /// Takes the fitness of the first live ones, computed elsewhere.
    pub(crate) fn take_first(&mut self, fitness: &[S]) -> Result<(), Error> {
        if fitness.len() > self.live {
            return Err(Error::Tell {
                wanted: self.live,
                got: fitness.len(),
            });
        }
        self.fitness[..fitness.len()].copy_from_slice(fitness);
        self.ready = fitness.len();
        Ok(())
    }
}

/// Brings a point inside and returns its values, in `memory` if they are not the point itself.
#[inline(always)]
fn inside<'a, S: Real>(space: &Space<S>, point: &'a mut [S], memory: &'a mut Vec<S>) -> &'a [S] {
    if space.maps() {
        if memory.len() != point.len() {
            memory.resize(point.len(), S::zero());
        }
        space.keep_inside_with_values(point, memory);
        memory
    } else {
        space.keep_inside(point);
        point
    }
}

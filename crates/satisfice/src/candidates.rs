//! The candidates of one batch between proposal and outcome.

use crate::archive::Archive;
use crate::batch::{Batch, Outcome};
use crate::error::Error;
use crate::problem::SatisficingProblem;
use crate::scalar::Real;

/// The candidates of one batch between proposal and outcome. Memory is kept from batch to batch.
#[derive(Debug)]
pub(crate) struct Candidates<S, T> {
    /// What to evaluate: the first `live` solutions; those behind are memory to be used again.
    pub(crate) solutions: Vec<T>,
    pub(crate) live: usize,
    /// Their place in the batch.
    pub(crate) places: Vec<u32>,
    /// Their fitness, and whether it was computed.
    pub(crate) fitness: Vec<S>,
    pub(crate) done: Vec<bool>,
    /// One for each point of the batch.
    pub(crate) outcomes: Vec<Outcome<S>>,
    /// Whether they are uniform probes, whose hits the engine does not see.
    pub(crate) probing: bool,
    pub(crate) values: Vec<S>,
    /// Whether found solutions are deleted from the space, as far as the engine is concerned.
    pub(crate) deletes: bool,
}

impl<S: Real, T> Default for Candidates<S, T> {
    fn default() -> Self {
        Self {
            solutions: Vec::new(),
            live: 0,
            places: Vec::new(),
            fitness: Vec::new(),
            done: Vec::new(),
            outcomes: Vec::new(),
            probing: false,
            values: Vec::new(),
            deletes: true,
        }
    }
}

impl<S: Real, T: crate::Identity + Clone + Send + Sync> Candidates<S, T> {
    /// Brings the points inside, decodes the first `limit` of them and looks them up in C.
    pub(crate) fn prepare<P: SatisficingProblem<Scalar = S, Solution = T>>(
        &mut self,
        problem: &P,
        archive: &Archive<T>,
        batch: &mut Batch<S>,
        limit: usize,
        deletes: bool,
    ) {
        let space = problem.space();
        self.reset(batch.len(), deletes);
        self.values.resize(space.dimension(), S::zero());
        for i in 0..batch.len().min(limit) {
            let point = batch.point_mut(i);
            space.keep_inside(point);
            let values: &[S] = if space.has_integers() {
                space.values(point, &mut self.values);
                &self.values
            } else {
                point
            };
            match self.solutions.get_mut(self.live) {
                Some(slot) => problem.decode_into(values, slot),
                None => self.solutions.push(problem.decode(values)),
            }
            self.file(i, archive);
        }
        self.fitness.resize(self.live, S::zero());
        self.done.resize(self.live, false);
    }

    /// The same for solutions that are known already, at the points of `batch`.
    pub(crate) fn prepare_solutions<'a>(
        &mut self,
        solutions: impl ExactSizeIterator<Item = &'a T>,
        archive: &Archive<T>,
        limit: usize,
    ) where
        T: 'a,
    {
        self.reset(solutions.len(), true);
        for (i, solution) in solutions.take(limit).enumerate() {
            match self.solutions.get_mut(self.live) {
                Some(slot) => slot.clone_from(solution),
                None => self.solutions.push(solution.clone()),
            }
            self.file(i, archive);
        }
        self.fitness.resize(self.live, S::zero());
        self.done.resize(self.live, false);
    }

    fn reset(&mut self, points: usize, deletes: bool) {
        self.deletes = deletes;
        self.live = 0;
        self.places.clear();
        self.fitness.clear();
        self.done.clear();
        self.outcomes.clear();
        self.outcomes.resize(points, Outcome::NotEvaluated);
    }

    /// Files the solution in slot `live` as point `i`.
    #[inline]
    fn file(&mut self, i: usize, archive: &Archive<T>) {
        if archive.contains(&self.solutions[self.live]) {
            if self.deletes {
                self.outcomes[i] = Outcome::Deleted;
                return;
            }
            self.outcomes[i] = Outcome::Known(S::nan()); // its fitness is filled in by `settle`
        }
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a batch of 2^32 points does not fit in memory"
        )]
        self.places.push(i as u32);
        self.live += 1;
    }

    /// The fitness of what has to be evaluated, as far as it is computed.
    pub(crate) fn computed(&self) -> Vec<Option<S>> {
        let computed = self.done.iter().zip(&self.fitness);
        computed
            .map(|(&done, &fitness)| done.then_some(fitness))
            .collect()
    }

    /// Takes fitness values that were computed before; what is missing remains to be evaluated.
    pub(crate) fn resume(&mut self, computed: &[Option<S>]) {
        for ((fitness, done), computed) in self.fitness.iter_mut().zip(&mut self.done).zip(computed) {
            if let Some(computed) = computed {
                (*fitness, *done) = (*computed, true);
            }
        }
    }

    /// What has to be evaluated, in order.
    pub(crate) fn live(&self) -> &[T] {
        &self.solutions[..self.live]
    }

    /// Takes fitness values computed elsewhere.
    pub(crate) fn take_fitness(&mut self, fitness: &[S]) -> Result<(), Error> {
        if fitness.len() != self.live {
            return Err(Error::Tell {
                wanted: self.live,
                got: fitness.len(),
            });
        }
        self.fitness.copy_from_slice(fitness);
        self.done.fill(true);
        Ok(())
    }
}

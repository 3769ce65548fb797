//! A slice that has begun: driven to its end by the search, or by hand.

use super::checkpoint::Checkpoint;
use super::driven::Driven;
use super::kept::KeptSearch;
use super::running::{Running, Turn};
use crate::error::Error;
use crate::observer::Observer;
use crate::problem::SatisficingProblem;
use crate::report::Report;

/// A slice that has begun, to be driven by hand: [`ask`](Stepper::ask), evaluate, [`tell`](Stepper::tell) until `ask` gives
/// nothing, then [`finish`](Stepper::finish).
///
/// It borrows the search and the problem, so that neither can change before the slice is finished. Dropped before, the slice
/// is forgotten: the next one starts from the hits of the slice before.
///
/// ```
/// use satisfice::{from_fn, Budget, SatisficingProblem, Search, Space};
///
/// let problem = from_fn(Space::lattice(2, 50)?, 3.0, |x: &[f64]| x[0] + x[1]);
/// let mut search = Search::new();
/// let mut slice = search.start(&problem, &Budget::evaluations(5000))?;
/// loop {
///     let candidates = slice.ask()?;
///     if candidates.is_empty() {
///         break;
///     }
///     // On a cluster, in a simulator, in another language:
///     let fitness: Vec<f64> = candidates.iter().map(|c| problem.fitness(c)).collect();
///     slice.tell(&fitness)?;
/// }
/// assert_eq!(slice.finish().hit_count(), 6);
/// # Ok::<(), satisfice::Error>(())
/// ```
pub struct Stepper<'a, P: SatisficingProblem + ?Sized> {
    pub(super) problem: &'a P,
    pub(super) driven: Driven<'a, P::Scalar, P::Solution>,
}

impl<P: SatisficingProblem + ?Sized> core::fmt::Debug for Stepper<'_, P> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Stepper")
            .field("turn", &self.driven.turn)
            .finish_non_exhaustive()
    }
}

impl<'a, P: SatisficingProblem + ?Sized> Stepper<'a, P> {
    pub(super) fn new(
        kept: &'a mut KeptSearch<P::Scalar, P::Solution>,
        problem: &'a P,
        running: Running<P::Scalar, P::Solution>,
    ) -> Self {
        let driven = Driven {
            kept,
            running: Some(running),
            turn: Turn::Over,
        };
        Self { problem, driven }
    }

    /// The next solutions to evaluate, none of them in the archive; none at all once the slice is over.
    ///
    /// # Errors
    /// [`Error::Tell`] if the last ones have not been told.
    pub fn ask(&mut self) -> Result<&[P::Solution], Error> {
        self.ask_with(&mut ())
    }

    /// [`Stepper::ask`] with an observer, which is told of hits and progress and may end the slice.
    ///
    /// # Errors
    /// As [`Stepper::ask`].
    pub fn ask_with(&mut self, observer: &mut dyn Observer<P::Solution>) -> Result<&[P::Solution], Error> {
        self.driven.ask(&self.problem, observer)
    }

    /// Tells the fitness of what [`ask`](Stepper::ask) gave, in its order.
    ///
    /// # Errors
    /// [`Error::Tell`] if nothing was asked, or for another number of values; then the batch is still to be told.
    pub fn tell(&mut self, fitness: &[P::Scalar]) -> Result<(), Error> {
        self.tell_with(fitness, &mut ())
    }

    /// [`Stepper::tell`] with an observer, which is told of hits and progress and may end the slice.
    ///
    /// # Errors
    /// As [`Stepper::tell`].
    pub fn tell_with(
        &mut self,
        fitness: &[P::Scalar],
        observer: &mut dyn Observer<P::Solution>,
    ) -> Result<(), Error> {
        self.driven.tell(&self.problem, fitness, observer)
    }

    /// Enters the fitness of the first of the candidates that [`ask`](Stepper::ask) gave, as far as they are evaluated, so that a
    /// [checkpoint](Stepper::checkpoint) keeps it. All of the batch is still to be told.
    ///
    /// # Errors
    /// [`Error::Tell`] for more values than candidates.
    pub fn note(&mut self, fitness: &[P::Scalar]) -> Result<(), Error> {
        self.driven.note(fitness)
    }

    /// The fitness of the first of the candidates that [`ask`](Stepper::ask) gave, where it was [noted](Stepper::note) before the
    /// slice was saved. After [`start_resumed`](crate::Search::start_resumed) only the others need to be evaluated.
    ///
    /// ```
    /// use satisfice::{engine, from_fn, Budget, SatisficingProblem, Search, Space};
    /// let problem = from_fn(Space::lattice(2, 50)?, 3.0, |x: &[f64]| x[0] + x[1]);
    /// let mut search = Search::named("random")?;
    /// let mut slice = search.start(&problem, &Budget::evaluations(5000))?;
    /// slice.ask()?;
    /// slice.note(&[81.0, 7.0])?; // that took an hour
    /// let saved = slice.checkpoint();
    ///
    /// let mut search = Search::resume(saved, engine::Random::default())?;
    /// let mut slice = search.start_resumed(&problem)?;
    /// let batch = slice.ask()?.to_vec();
    /// let mut fitness = slice.noted().to_vec();
    /// assert_eq!(fitness, [81.0, 7.0]);
    /// fitness.extend(batch[2..].iter().map(|candidate| problem.fitness(candidate)));
    /// slice.tell(&fitness)?;
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    #[must_use]
    pub fn noted(&self) -> &[P::Scalar] {
        self.driven.noted()
    }

    /// Whether the time is up or the slice is cancelled. To be asked between the evaluations of a batch, which
    /// [`finish_with`](Stepper::finish_with) can end early.
    pub fn is_interrupted(&mut self) -> bool {
        self.driven.is_interrupted()
    }

    /// Ends the slice in the middle of a batch and reports: `fitness` is that of the first of the candidates that
    /// [`ask`](Stepper::ask) gave, as far as they are evaluated. The others are not counted.
    ///
    /// ```
    /// use satisfice::{from_fn, Budget, Search, Space, StopReason};
    /// let problem = from_fn(Space::lattice(2, 50)?, 3.0, |x: &[f64]| x[0] + x[1]);
    /// let mut search = Search::named("random")?;
    /// let mut slice = search.start(&problem, &Budget::evaluations(5000))?;
    /// assert!(slice.ask()?.len() > 3);
    /// let report = slice.finish_with(&[1.0, 7.0, 2.0])?; // and then the power failed
    /// assert_eq!((report.hit_count(), report.counts.evaluations), (2, 3));
    /// assert_eq!(report.stop_reason, StopReason::Cancelled);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Tell`] for more values than candidates.
    pub fn finish_with(mut self, fitness: &[P::Scalar]) -> Result<Report<P::Solution>, Error> {
        self.driven.end_with(&self.problem, fitness)?;
        Ok(self.finish())
    }

    /// The search and the slice as they are now; a batch that is out is asked for again after resuming. Cost: a copy of the
    /// archive and of the engines' state.
    #[must_use]
    pub fn checkpoint(&self) -> Checkpoint<P::Solution> {
        self.driven.checkpoint()
    }

    /// Ends the slice and reports. One that is not over counts as cancelled.
    #[must_use]
    pub fn finish(self) -> Report<P::Solution> {
        self.driven.finish(&self.problem)
    }
}

//! What a run may be given beyond problem and budget.

use core::time::Duration;

use super::checkpoint::Checkpoint;
use crate::budget::Cancel;
use crate::observer::Observer;

/// The first checkpoint after the one at the beginning comes after this time at the latest.
const FIRST: Duration = Duration::from_secs(1);

/// Options of [`Search::run_with`](crate::Search::run_with): an observer, checkpoints, what to do about panics.
///
/// ```
/// use std::time::Duration;
/// use satisfice::{from_fn, Budget, Checkpoint, Hit, Located, RunOptions, Search, Space};
///
/// let problem = from_fn(Space::lattice(2, 100)?, 3.0, |x: &[f64]| x[0] + x[1]);
/// let mut watch = |hit: Hit<'_, Located<f64>>, count: usize| {
///     println!("hit {count}: F = {} at {:?}", hit.fitness, hit.solution.coordinates);
///     std::ops::ControlFlow::Continue(())
/// };
/// let mut last = None;
/// let mut save = |checkpoint: &Checkpoint<_>| last = Some(checkpoint.clone());
/// let options = RunOptions::new().observer(&mut watch).checkpoints(Duration::from_secs(60), &mut save);
/// let report = Search::new().run_with(&problem, &Budget::evaluations(20_000), options)?;
/// assert_eq!((report.hit_count(), last.is_some()), (6, true));
/// # Ok::<(), satisfice::Error>(())
/// ```
pub struct RunOptions<'a, T> {
    pub(super) observer: Option<&'a mut dyn Observer<T>>,
    pub(super) keeper: Option<Keeper<'a, T>>,
    pub(super) cancel: Option<Cancel>,
    pub(super) catches_panics: bool,
}

impl<T> Default for RunOptions<'_, T> {
    fn default() -> Self {
        Self {
            observer: None,
            keeper: None,
            cancel: None,
            catches_panics: false,
        }
    }
}

impl<T> core::fmt::Debug for RunOptions<'_, T> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("RunOptions")
            .field("observer", &self.observer.is_some())
            .field("checkpoints", &self.keeper.as_ref().map(|keeper| keeper.every))
            .field("cancel", &self.cancel)
            .field("catches_panics", &self.catches_panics)
            .finish()
    }
}

impl<'a, T> RunOptions<'a, T> {
    /// No observer, no checkpoints; a panic of the problem is passed on.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Tells this observer of hits and of progress. With several islands, hits are told when the islands exchange them.
    #[must_use]
    pub fn observer(mut self, observer: &'a mut dyn Observer<T>) -> Self {
        self.observer = Some(observer);
        self
    }

    /// Calls `save` with a checkpoint: at the beginning, after a second at the latest, then about once in `every` (and for at
    /// most a tenth of the time), when the slice is cancelled, and at its end.
    ///
    /// Cost: a copy of the archive and of the engines' state each time. An engine that could [advance by
    /// itself](crate::Engine::advance) is asked for batches instead.
    #[must_use]
    pub fn checkpoints(mut self, every: Duration, save: &'a mut dyn FnMut(&Checkpoint<T>)) -> Self {
        self.keeper = Some(Keeper {
            every,
            next: Duration::ZERO,
            saves: 0,
            saved_cancellation: false,
            save,
        });
        self
    }

    /// Cancels the slice from another thread, beside the cancellation that the budget may have. For a slice that is
    /// [resumed](crate::Search::run_resumed), whose budget was saved without its cancellation.
    #[must_use]
    pub fn cancel(mut self, cancel: &Cancel) -> Self {
        self.cancel = Some(cancel.clone());
        self
    }

    /// Ends the slice with what was found if the problem panics, on any number of threads: the report says
    /// [`StopReason::Panicked`](crate::StopReason::Panicked), and the [message](crate::Report::panic). The panic is still printed by the
    /// panic hook.
    #[must_use]
    pub fn catch_panics(mut self) -> Self {
        self.catches_panics = true;
        self
    }
}

/// The message of a panic that was caught.
pub(super) fn message_of(panic: &(dyn core::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("the panic has no message")
        .to_owned()
}

/// When the next checkpoint is due, and where it goes.
pub(super) struct Keeper<'a, T> {
    every: Duration,
    next: Duration,
    saves: u64,
    saved_cancellation: bool,
    save: &'a mut dyn FnMut(&Checkpoint<T>),
}

impl<T> Keeper<'_, T> {
    /// When the next one is due, in time since the start of the slice.
    pub(super) fn next(&self) -> Duration {
        self.next
    }

    /// Saves at `begun`; `now` is asked for the time afterwards.
    pub(super) fn save(
        &mut self,
        checkpoint: &Checkpoint<T>,
        cancelled: bool,
        begun: Duration,
        now: impl FnOnce() -> Duration,
    ) {
        (self.save)(checkpoint);
        let end = now();
        self.saves += 1;
        let every = if self.saves == 1 {
            self.every.min(FIRST)
        } else {
            self.every
        };
        self.next = end.saturating_add(every.max(end.saturating_sub(begun).saturating_mul(9)));
        self.saved_cancellation = cancelled;
    }

    /// The last checkpoint, unless it is the one of a cancellation.
    pub(super) fn save_end(self, checkpoint: impl FnOnce() -> Checkpoint<T>) {
        if !self.saved_cancellation {
            (self.save)(&checkpoint());
        }
    }
}

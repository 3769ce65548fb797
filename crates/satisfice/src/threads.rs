//! The threads that share work: the calling one and its helpers.

use crate::error::Error;

/// Threads to evaluate on.
#[derive(Debug, Default)]
pub(crate) struct Threads {
    /// One less than the number of threads: the caller works, too.
    #[cfg(feature = "rayon")]
    helpers: Option<rayon::ThreadPool>,
}

impl Threads {
    /// So many threads, 0 for as many as there are cores. Without the feature `rayon` always one.
    #[cfg(feature = "rayon")]
    pub(crate) fn new(threads: usize) -> Result<Self, Error> {
        let threads = match threads {
            0 => std::thread::available_parallelism().map_or(1, core::num::NonZero::get),
            threads => threads,
        };
        if threads == 1 {
            return Ok(Self { helpers: None });
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads - 1).build();
        Ok(Self {
            helpers: Some(pool.map_err(|e| Error::Threads {
                threads,
                reason: e.to_string(),
            })?),
        })
    }

    #[cfg(not(feature = "rayon"))]
    #[expect(
        clippy::unnecessary_wraps,
        reason = "one signature with and without the feature"
    )]
    pub(crate) fn new(_threads: usize) -> Result<Self, Error> {
        Ok(Self {})
    }
}

impl Threads {
    /// The number of threads, including the caller.
    #[cfg(feature = "rayon")]
    pub(crate) fn count(&self) -> usize {
        1 + self
            .helpers
            .as_ref()
            .map_or(0, rayon::ThreadPool::current_num_threads)
    }

    /// Wakes sleeping helpers ahead of the next batch, while the engine computes it.
    pub(crate) fn wake(&self) {
        #[cfg(feature = "rayon")]
        if let Some(helpers) = &self.helpers {
            for _ in 0..helpers.current_num_threads() {
                helpers.spawn(|| {});
            }
        }
    }

    /// Applies `work` to each item on all threads; a free thread takes the next item.
    pub(crate) fn for_each<I>(&self, items: impl Iterator<Item = I> + Send, work: impl Fn(I) + Sync) {
        #[cfg(feature = "rayon")]
        if let Some(helpers) = &self.helpers {
            share(helpers, items, work);
            return;
        }
        items.for_each(work);
    }
}

/// The caller works, too, so that no thread has to be woken twice for each batch.
#[cfg(feature = "rayon")]
fn share<I>(helpers: &rayon::ThreadPool, items: impl Iterator<Item = I> + Send, work: impl Fn(I) + Sync) {
    use core::sync::atomic::{AtomicUsize, Ordering};
    use std::sync::{Mutex, PoisonError};

    /// How often the caller checks whether the helpers are done before it sleeps.
    const LOOKS: usize = 400;

    let items = Mutex::new(items);
    let next = || items.lock().unwrap_or_else(PoisonError::into_inner).next();
    let drain = || {
        while let Some(item) = next() {
            work(item);
        }
    };
    let count = helpers.current_num_threads();
    let busy = AtomicUsize::new(count);
    helpers.in_place_scope(|scope| {
        for _ in 0..count {
            scope.spawn(|_| {
                drain();
                busy.fetch_sub(1, Ordering::Release);
            });
        }
        drain();
        for _ in 0..LOOKS {
            if busy.load(Ordering::Acquire) == 0 {
                break;
            }
            core::hint::spin_loop();
        }
    });
}

#[cfg(all(test, feature = "rayon"))]
mod tests {
    use core::time::Duration;
    use std::sync::Mutex;

    use crate::{Budget, Search, Space, engine, from_fn};

    #[test]
    fn the_first_batch_of_an_expensive_fitness_is_shared() {
        let seen = Mutex::new(Vec::new());
        let problem = from_fn(Space::cube(1, 0.0, 1.0).unwrap(), -1.0, |x: &[f64]| {
            seen.lock().unwrap().push(std::thread::current().id());
            std::thread::sleep(Duration::from_millis(2));
            x[0]
        });
        let mut search = Search::with(engine::build("random").unwrap()).threads(2);
        search.run(&problem, &Budget::evaluations(64)).unwrap();
        let seen = seen.lock().unwrap();
        assert!(seen.len() == 64 && seen.iter().any(|id| *id != seen[0]));
    }
}

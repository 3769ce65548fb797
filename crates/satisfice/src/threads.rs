//! The threads that share work: the calling one and its helpers.

#[cfg(feature = "rayon")]
use std::sync::{Arc, Mutex, PoisonError};

use crate::error::Error;

/// Threads to evaluate on.
///
/// As many as there are cores are started at once. More, which a fitness that waits for something else can use, are started when a
/// batch has work for them.
#[derive(Debug, Default)]
pub(crate) struct Threads {
    /// The most to use, the caller included.
    #[cfg(feature = "rayon")]
    most: usize,
    /// One less than the number of threads: the caller works, too.
    #[cfg(feature = "rayon")]
    helpers: Mutex<Option<Arc<rayon::ThreadPool>>>,
}

#[cfg(feature = "rayon")]
fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, core::num::NonZero::get)
}

impl Threads {
    /// So many threads, 0 for as many as there are cores. Without the feature `rayon` always one.
    #[cfg(feature = "rayon")]
    pub(crate) fn new(threads: usize) -> Result<Self, Error> {
        let most = Self::most(threads);
        Ok(Self {
            most,
            helpers: Mutex::new(Self::start(most.min(cores()))?),
        })
    }

    /// How many threads that is.
    #[cfg(feature = "rayon")]
    pub(crate) fn most(threads: usize) -> usize {
        if threads == 0 { cores() } else { threads }
    }

    #[cfg(not(feature = "rayon"))]
    pub(crate) fn most(_threads: usize) -> usize {
        1
    }

    #[cfg(not(feature = "rayon"))]
    #[expect(
        clippy::unnecessary_wraps,
        reason = "one signature with and without the feature"
    )]
    pub(crate) fn new(_threads: usize) -> Result<Self, Error> {
        Ok(Self {})
    }

    /// Helpers for so many threads.
    #[cfg(feature = "rayon")]
    fn start(threads: usize) -> Result<Option<Arc<rayon::ThreadPool>>, Error> {
        if threads <= 1 {
            return Ok(None);
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads - 1).build();
        let pool = pool.map_err(|e| Error::Threads {
            threads,
            reason: e.to_string(),
        })?;
        Ok(Some(Arc::new(pool)))
    }

    /// The helpers for so many items. Where no more threads can be started, those that are there do the work.
    #[cfg(feature = "rayon")]
    fn helpers_for(&self, items: usize) -> Option<Arc<rayon::ThreadPool>> {
        let mut helpers = self.helpers.lock().unwrap_or_else(PoisonError::into_inner);
        let there = 1 + helpers.as_ref().map_or(0, |pool| pool.current_num_threads());
        let wanted = self.most.min(items);
        if wanted > there
            && let Ok(more) = Self::start(wanted)
        {
            *helpers = more;
        }
        helpers.clone()
    }
}

impl Threads {
    /// The number of threads that may work, including the caller.
    #[cfg(feature = "rayon")]
    pub(crate) fn count(&self) -> usize {
        self.most.max(1)
    }

    /// Wakes sleeping helpers ahead of the next batch, while the engine computes it.
    pub(crate) fn wake(&self) {
        #[cfg(feature = "rayon")]
        if let Some(helpers) = self.helpers_for(0) {
            for _ in 0..helpers.current_num_threads() {
                helpers.spawn(|| {});
            }
        }
    }

    /// Applies `work` to each item on all threads; a free thread takes the next item.
    pub(crate) fn for_each<I>(
        &self,
        items: impl ExactSizeIterator<Item = I> + Send,
        work: impl Fn(I) + Sync,
    ) {
        #[cfg(feature = "rayon")]
        if let Some(helpers) = self.helpers_for(items.len()) {
            share(&helpers, items, work);
            return;
        }
        items.for_each(work);
    }
}

/// The caller works, too, so that no thread has to be woken twice for each batch.
#[cfg(feature = "rayon")]
fn share<I>(helpers: &rayon::ThreadPool, items: impl Iterator<Item = I> + Send, work: impl Fn(I) + Sync) {
    use core::sync::atomic::{AtomicUsize, Ordering};

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

    /// A fitness that waits can use more threads than there are cores; none is started for which a batch has no candidate.
    #[test]
    fn no_more_threads_are_started_than_a_batch_can_use() {
        let (seen, at_once) = (Mutex::new(std::collections::BTreeSet::new()), Mutex::new((0, 0)));
        let problem = from_fn(Space::cube(1, 0.0, 1.0).unwrap(), -1.0, |x: &[f64]| {
            seen.lock()
                .unwrap()
                .insert(format!("{:?}", std::thread::current().id()));
            let mut count = at_once.lock().unwrap();
            *count = (count.0 + 1, count.1.max(count.0 + 1));
            drop(count);
            std::thread::sleep(Duration::from_millis(5));
            at_once.lock().unwrap().0 -= 1;
            x[0]
        });
        let engine = engine::find("random")
            .unwrap()
            .configure([("batch", "32")])
            .unwrap();
        let mut search = Search::with(engine).threads(10_000);
        search.run(&problem, &Budget::evaluations(64)).unwrap();
        // The first call is timed alone; then a pool for 31 and one for 32, beside the caller and helpers for the cores.
        assert!(seen.lock().unwrap().len() <= 100, "{seen:?}");
        let cores = std::thread::available_parallelism().unwrap().get();
        assert!(at_once.lock().unwrap().1 > cores.min(20), "{at_once:?}");
    }

    #[test]
    fn the_first_batch_of_an_expensive_fitness_is_shared() {
        let seen = Mutex::new(Vec::new());
        let problem = from_fn(Space::cube(1, 0.0, 1.0).unwrap(), -1.0, |x: &[f64]| {
            seen.lock().unwrap().push(std::thread::current().id());
            std::thread::sleep(Duration::from_millis(2));
            x[0]
        });
        let mut search = Search::with(engine::Random::default()).threads(2);
        search.run(&problem, &Budget::evaluations(64)).unwrap();
        let seen = seen.lock().unwrap();
        assert!(seen.len() == 64 && seen.iter().any(|id| *id != seen[0]));
    }
}

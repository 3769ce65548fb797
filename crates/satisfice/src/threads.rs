//! The threads that share work: the calling one and its helpers.

#[cfg(feature = "rayon")]
use std::sync::{Mutex, PoisonError};

use crate::error::Error;

/// Threads to evaluate on.
///
/// As many as there are cores stay for the whole search. More can only be used by work that waits for something else: they are
/// started for a batch of expensive work, and end with it. In a pool they would spend the time looking for work in each other's queues.
#[derive(Debug, Default)]
pub(crate) struct Threads {
    /// The most to use, the caller included.
    #[cfg(feature = "rayon")]
    most: usize,
    /// One less than the number of cores: the caller works, too.
    #[cfg(feature = "rayon")]
    helpers: Option<rayon::ThreadPool>,
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
        let kept = most.min(cores());
        let mut helpers = None;
        if kept > 1 {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(kept - 1).build();
            helpers = Some(pool.map_err(|e| Error::Threads {
                threads: kept,
                reason: e.to_string(),
            })?);
        }
        Ok(Self { most, helpers })
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
}

/// Whether items are worth a thread of their own beyond the cores.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(
    not(feature = "rayon"),
    expect(dead_code, reason = "only threads tell them apart")
)]
pub(crate) enum Items {
    Short,
    /// A millisecond at least, many times what starting a thread costs.
    Long,
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
        if let Some(helpers) = &self.helpers {
            for _ in 0..helpers.current_num_threads() {
                helpers.spawn(|| {});
            }
        }
    }

    /// Applies `work` to each item on all threads; a free thread takes the next item.
    pub(crate) fn for_each<I: Send>(
        &self,
        items: impl ExactSizeIterator<Item = I> + Send,
        length: Items,
        work: impl Fn(I) + Sync,
    ) {
        #[cfg(feature = "rayon")]
        {
            let kept = 1 + self
                .helpers
                .as_ref()
                .map_or(0, rayon::ThreadPool::current_num_threads);
            let more = match length {
                Items::Short => 0,
                Items::Long => self.most.min(items.len()).saturating_sub(kept),
            };
            if kept + more > 1 {
                share(self.helpers.as_ref(), more, items, work);
                return;
            }
        }
        let _ = length;
        items.for_each(work);
    }
}

/// The caller works, too, so that no thread has to be woken twice for each batch.
#[cfg(feature = "rayon")]
fn share<I: Send>(
    helpers: Option<&rayon::ThreadPool>,
    more: usize,
    items: impl ExactSizeIterator<Item = I> + Send,
    work: impl Fn(I) + Sync,
) {
    let items = Mutex::new(items);
    let items = || items.lock().unwrap_or_else(PoisonError::into_inner);
    let drain = || {
        loop {
            let item = items().next();
            let Some(item) = item else { return };
            work(item);
        }
    };
    std::thread::scope(|threads| {
        let mut started = Vec::new();
        let mut start_more = || {
            while started.len() < more && items().len() > 0 {
                // Where no more threads can be started, those that are there do the work.
                let Ok(thread) = std::thread::Builder::new().spawn_scoped(threads, drain) else {
                    break;
                };
                started.push(thread);
            }
        };
        match helpers {
            Some(helpers) => share_with(helpers, &mut start_more, drain),
            None => {
                start_more();
                drain();
            }
        }
        for thread in started {
            if let Err(panic) = thread.join() {
                std::panic::resume_unwind(panic);
            }
        }
    });
}

/// Drains on the helpers and the calling thread, which calls `first` before it works.
#[cfg(feature = "rayon")]
fn share_with(helpers: &rayon::ThreadPool, first: impl FnOnce(), drain: impl Fn() + Sync) {
    use core::sync::atomic::{AtomicUsize, Ordering};

    /// How often the caller checks whether the helpers are done before it sleeps.
    const LOOKS: usize = 400;

    let count = helpers.current_num_threads();
    let busy = AtomicUsize::new(count);
    helpers.in_place_scope(|scope| {
        for _ in 0..count {
            scope.spawn(|_| {
                drain();
                busy.fetch_sub(1, Ordering::Release);
            });
        }
        first();
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
        })
        .boxed();
        let engine = engine::find("random")
            .unwrap()
            .configure([("batch", "32")])
            .unwrap();
        let mut search = Search::with(engine).threads(10_000);
        search.run(&problem, &Budget::evaluations(64)).unwrap();
        // The first call is timed alone; then threads for 31 and for 32, beside the caller and helpers for the cores.
        assert!(seen.lock().unwrap().len() <= 100, "{seen:?}");
        let cores = std::thread::available_parallelism().unwrap().get();
        assert!(at_once.lock().unwrap().1 > cores.min(20), "{at_once:?}");
    }

    /// A thousand threads that look for work in each other's queues do not see a deadline.
    #[test]
    fn a_cheap_fitness_starts_no_more_threads_than_there_are_cores() {
        let seen = Mutex::new(std::collections::BTreeSet::new());
        let problem = from_fn(Space::cube(1, 0.0, 1.0).unwrap(), -1.0, |x: &[f64]| {
            seen.lock()
                .unwrap()
                .insert(format!("{:?}", std::thread::current().id()));
            (0..1000).fold(x[0], |sum, i| sum + f64::from(i).sqrt())
        })
        .boxed();
        let mut search = Search::new().threads(1024);
        let report = search.run(&problem, &Budget::millis(50)).unwrap();
        let cores = std::thread::available_parallelism().unwrap().get();
        // A few more where the machine is so busy that a call seemed to be expensive.
        assert!(seen.lock().unwrap().len() <= cores + 100);
        assert!(report.counts.evaluations > 1024, "{:?}", report.counts);
    }

    #[test]
    fn a_panic_beyond_the_cores_keeps_its_message() {
        let problem = from_fn(Space::cube(1, 0.0, 1.0).unwrap(), -1.0, |x: &[f64]| {
            std::thread::sleep(Duration::from_millis(2));
            assert!(x[0] < 0.9, "too large");
            x[0]
        })
        .boxed();
        let engine = engine::find("random")
            .unwrap()
            .configure([("batch", "32")])
            .unwrap();
        let mut search = Search::with(engine).threads(32);
        let run = std::panic::AssertUnwindSafe(|| search.run(&problem, &Budget::evaluations(200)));
        let panic = std::panic::catch_unwind(run).unwrap_err();
        assert_eq!(panic.downcast_ref::<&str>(), Some(&"too large"));
    }

    #[test]
    fn the_first_batch_of_an_expensive_fitness_is_shared() {
        let seen = Mutex::new(Vec::new());
        let problem = from_fn(Space::cube(1, 0.0, 1.0).unwrap(), -1.0, |x: &[f64]| {
            seen.lock().unwrap().push(std::thread::current().id());
            std::thread::sleep(Duration::from_millis(2));
            x[0]
        })
        .boxed();
        let mut search = Search::with(engine::Random::default()).threads(2);
        search.run(&problem, &Budget::evaluations(64)).unwrap();
        let seen = seen.lock().unwrap();
        assert!(seen.len() == 64 && seen.iter().any(|id| *id != seen[0]));
    }
}

//! The clock of a slice. No other file of the core reads the time.

use core::time::Duration;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;
#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
use std::time::Instant;

use crate::cancel::Cancel;
#[cfg(all(target_family = "wasm", target_os = "unknown"))]
use still::Instant;

/// Whether time passes here: the web's plain WebAssembly has no clock, and asking for it there panics.
pub(crate) const PASSES: bool = cfg!(not(all(target_family = "wasm", target_os = "unknown")));

/// A clock that stands still.
#[cfg(all(target_family = "wasm", target_os = "unknown"))]
mod still {
    use core::ops::Sub;
    use core::time::Duration;

    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    pub(crate) struct Instant;

    impl Instant {
        pub(crate) fn now() -> Self {
            Self
        }

        pub(crate) fn elapsed(self) -> Duration {
            Duration::ZERO
        }

        #[cfg(feature = "rayon")]
        pub(crate) fn checked_add(self, _: Duration) -> Option<Self> {
            None
        }
    }

    impl Sub for Instant {
        type Output = Duration;

        fn sub(self, _: Self) -> Duration {
            Duration::ZERO
        }
    }
}

/// About this much time may pass between two looks at the clock...
const LOOK_EVERY: Duration = Duration::from_micros(20);
/// ...and at most this many evaluations, so that a fitness that suddenly becomes slow is noticed.
const LOOK_AFTER: u64 = 4096;

#[cfg_attr(
    not(all(target_family = "wasm", target_os = "unknown")),
    expect(clippy::disallowed_methods, reason = "this is clock.rs")
)]
fn now() -> Instant {
    Instant::now()
}

/// Counts evaluations down to the next look at the time, and adapts their number to their cost.
///
/// Under a time limit, an [`Alarm`] covers a fitness whose cost jumps between two looks.
#[derive(Debug)]
pub(crate) struct Clock {
    start: Instant,
    before: Duration,
    last: Instant,
    /// Time since the start at the last look.
    seen: Duration,
    since: u64,
    interval: u64,
}

impl Clock {
    /// Starts now; `before` has elapsed already, in a run that is resumed.
    pub(crate) fn start(before: Duration) -> Self {
        let start = now();
        Self {
            start,
            before,
            last: start,
            seen: before,
            since: 0,
            interval: 1,
        }
    }

    /// Time since the start, as of the last look.
    pub(crate) fn seen(&self) -> Duration {
        self.seen
    }

    /// Time since the start, exactly.
    pub(crate) fn elapsed(&self) -> Duration {
        self.before.saturating_add(self.start.elapsed())
    }

    /// How many evaluations may pass before the next look, at least 1.
    #[inline]
    pub(crate) fn until_look(&self) -> u64 {
        self.interval.saturating_sub(self.since).max(1)
    }

    /// Counts evaluations that have passed. Returns the time if this was a look.
    #[inline]
    pub(crate) fn pass(&mut self, evaluations: u64) -> Option<Duration> {
        self.since += evaluations;
        (self.since >= self.interval).then(|| self.look())
    }

    #[cold]
    fn look(&mut self) -> Duration {
        let now = now();
        let passed = now - self.last;
        let cost = passed / u32::try_from(self.since.max(1)).unwrap_or(u32::MAX);
        let fits = LOOK_EVERY.as_nanos() / cost.as_nanos().max(1);
        self.interval = u64::try_from(fits)
            .unwrap_or(LOOK_AFTER)
            .clamp(1, (2 * self.interval).min(LOOK_AFTER));
        self.last = now;
        self.since = 0;
        self.seen = self.before.saturating_add(now - self.start);
        self.seen
    }

    /// The moment at which a limit of time since the start is reached.
    #[cfg(feature = "rayon")]
    pub(crate) fn deadline(&self, limit: Duration) -> Option<Instant> {
        self.start.checked_add(limit.saturating_sub(self.before))
    }
}

/// Times calls of the fitness alone: for scheduling, and for results only where time alone is limited.
#[derive(Debug)]
pub(crate) struct Stopwatch(Instant);

impl Stopwatch {
    pub(crate) fn start() -> Self {
        Self(now())
    }

    /// Nanoseconds since the start.
    pub(crate) fn stop(self) -> u64 {
        u64::try_from(self.0.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }
}

/// Whether a moment has come.
#[cfg(feature = "rayon")]
pub(crate) fn has_come(moment: Instant) -> bool {
    now() >= moment
}

/// Raises a flag after a time, from a thread of its own, which ends at once when the alarm is dropped.
#[derive(Debug)]
pub(crate) struct Alarm {
    rung: Cancel,
    dismissed: Arc<(Mutex<bool>, Condvar)>,
    thread: Option<JoinHandle<()>>,
}

impl Alarm {
    /// Rings in `time`. If no thread can be started, it never rings, and the looks at the clock must do.
    pub(crate) fn set(time: Duration) -> Self {
        let rung = Cancel::new();
        let dismissed = Arc::new((Mutex::new(false), Condvar::new()));
        let (flag, shared) = (rung.clone(), Arc::clone(&dismissed));
        let thread = std::thread::Builder::new()
            .name("satisfice-alarm".to_owned())
            .spawn(move || {
                let (lock, condition) = &*shared;
                let guard = lock.lock().unwrap_or_else(PoisonError::into_inner);
                let waited = condition.wait_timeout_while(guard, time, |dismissed| !*dismissed);
                if waited.is_ok_and(|(_, timeout)| timeout.timed_out()) {
                    flag.cancel();
                }
            });
        Self {
            rung,
            dismissed,
            thread: thread.ok(),
        }
    }

    /// Whether it has rung.
    #[inline]
    pub(crate) fn has_rung(&self) -> bool {
        self.rung.is_cancelled()
    }
}

impl Drop for Alarm {
    fn drop(&mut self) {
        let (lock, condition) = &*self.dismissed;
        *lock.lock().unwrap_or_else(PoisonError::into_inner) = true;
        condition.notify_one();
        if let Some(thread) = self.thread.take() {
            // The thread cannot panic; if it did, nothing would depend on it.
            drop(thread.join());
        }
    }
}

//! A question asked now and then while pairs are enumerated, from any thread: is it enough?

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Told how many pairs there are by now; says whether to stop.
pub(crate) type Stop<'a> = &'a (dyn Fn(usize) -> bool + Sync);

/// What every thread of an enumeration looks at.
pub(crate) struct Watch<'a> {
    stop: Option<Stop<'a>>,
    found: AtomicUsize,
    stopped: AtomicBool,
}

impl<'a> Watch<'a> {
    /// To the end.
    pub(crate) const fn none() -> Self {
        Self {
            stop: None,
            found: AtomicUsize::new(0),
            stopped: AtomicBool::new(false),
        }
    }

    /// Until `stop` says so.
    pub(crate) const fn until(stop: Stop<'a>) -> Self {
        Self {
            stop: Some(stop),
            ..Self::none()
        }
    }

    /// Tells of `new` pairs and asks. Once the answer is yes, it stays so.
    #[cold]
    #[inline(never)]
    pub(crate) fn ask(&self, new: usize) -> bool {
        let Some(stop) = self.stop else { return false };
        let found = self.found.fetch_add(new, Ordering::Relaxed) + new;
        if !self.stopped() && stop(found) {
            self.stopped.store(true, Ordering::Relaxed);
        }
        self.stopped()
    }

    /// Whether the answer was yes: something may be missing.
    pub(crate) fn stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }
}

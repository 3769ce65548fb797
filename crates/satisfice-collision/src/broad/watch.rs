//! The stop condition of an enumeration, asked now and then from any thread.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Gets the number of pairs found so far; returns whether to stop.
pub(crate) type Stop<'a> = &'a (dyn Fn(usize) -> bool + Sync);

/// The stop condition shared by all threads of an enumeration.
pub(crate) struct Watch<'a> {
    stop: Option<Stop<'a>>,
    found: AtomicUsize,
    stopped: AtomicBool,
}

impl<'a> Watch<'a> {
    /// Never stops.
    pub(crate) const fn none() -> Self {
        Self {
            stop: None,
            found: AtomicUsize::new(0),
            stopped: AtomicBool::new(false),
        }
    }

    /// Stops when `stop` returns true.
    pub(crate) const fn until(stop: Stop<'a>) -> Self {
        Self {
            stop: Some(stop),
            ..Self::none()
        }
    }

    /// Reports `new` pairs and asks whether to stop. A yes is final.
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

    /// Whether the enumeration was stopped, so that pairs may be missing.
    pub(crate) fn stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }
}

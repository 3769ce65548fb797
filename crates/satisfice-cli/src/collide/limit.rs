//! Until when to work.

use std::time::{Duration, Instant};

use satisfice::{Cancel, StopReason};

/// A time after the start, and Ctrl-C.
pub(super) struct Limit<'a> {
    start: Instant,
    time: Option<Duration>,
    cancel: &'a Cancel,
}

impl<'a> Limit<'a> {
    /// The time begins to run.
    #[expect(
        clippy::disallowed_methods,
        reason = "what is built before a search counts in its time, and the search does not see it"
    )]
    pub(super) fn new(time: Option<Duration>, cancel: &'a Cancel) -> Self {
        Self {
            start: Instant::now(),
            time,
            cancel,
        }
    }

    pub(super) fn start(&self) -> Instant {
        self.start
    }

    pub(super) fn elapsed(&self) -> Duration {
        self.start.elapsed()
    }

    /// How much longer it was than allowed.
    pub(super) fn late(&self, elapsed: Duration) -> Duration {
        self.time
            .map_or(Duration::ZERO, |time| elapsed.saturating_sub(time))
    }

    /// The time that is left, if it is limited.
    pub(super) fn left(&self) -> Option<Duration> {
        self.time.map(|time| time.saturating_sub(self.elapsed()))
    }

    pub(super) fn is_reached(&self) -> bool {
        self.cancel.is_cancelled() || self.left() == Some(Duration::ZERO)
    }

    pub(super) fn reason(&self) -> StopReason {
        match self.cancel.is_cancelled() {
            true => StopReason::Cancelled,
            false => StopReason::Time,
        }
    }
}

//! Until when to work.

use std::time::{Duration, Instant};

use satisfice::{Cancel, StopReason};

/// Nanoseconds that a pair takes after the search: to be listed in order. They are kept back from the limit.
const LISTING: u64 = 200;

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

    /// Whether no more is left than it takes to list so many pairs.
    pub(super) fn is_reached_after(&self, found: usize) -> bool {
        let listing = Duration::from_nanos(LISTING.saturating_mul(found as u64));
        self.cancel.is_cancelled() || self.left().is_some_and(|left| left <= listing)
    }

    pub(super) fn reason(&self) -> StopReason {
        match self.cancel.is_cancelled() {
            true => StopReason::Cancelled,
            false => StopReason::Time,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_list_brings_the_limit_nearer() {
        let cancel = Cancel::new();
        let limit = |time: Option<Duration>| Limit::new(time, &cancel);
        let day = Duration::from_secs(86_400);
        let most = usize::MAX;
        assert!(!limit(Some(day)).is_reached_after(1000) && !limit(None).is_reached_after(most));
        assert!(limit(Some(day)).is_reached_after(most) && !limit(Some(day)).is_reached());
        cancel.cancel();
        assert!(limit(None).is_reached_after(0));
    }
}

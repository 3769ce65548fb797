//! The reference count: how many hits there are, counted after the search and outside its clock.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use satisfice::Cancel;

use crate::message;

/// How often the count looks for Ctrl-C.
const LOOK_EVERY: Duration = Duration::from_millis(20);
/// A count that takes longer than this is waited for with the answer shown.
const QUICK: Duration = Duration::from_millis(200);
/// A count may always take this long.
const ALWAYS: Duration = Duration::from_secs(2);

/// How long to wait for a reference count.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Patience {
    /// As long as the run itself took, and at least two seconds.
    AsTheRun(Duration),
    /// Until the count ends, or Ctrl-C.
    Unlimited,
}

/// Counts by `count`; `None` if that takes too long or the user cancels. Calls `meanwhile` if the count takes a while.
pub(crate) fn wait_for(
    what: &str,
    patience: Patience,
    cancel: &Cancel,
    mut meanwhile: impl FnMut(),
    count: impl FnOnce() -> Option<u64> + Send + 'static,
) -> Option<u64> {
    if cancel.is_cancelled() {
        return None;
    }
    let (sender, receiver) = channel();
    let counting = std::thread::Builder::new()
        .name("reference".to_owned())
        .spawn(move || {
            // The receiver is gone if the user has cancelled.
            let _ = sender.send(count());
        });
    if counting.is_err() {
        return None;
    }
    let limit = match patience {
        Patience::AsTheRun(run) => run.max(ALWAYS),
        Patience::Unlimited => Duration::MAX,
    };
    let (mut waited, mut told) = (Duration::ZERO, false);
    let mut is_quick = true;
    loop {
        match receiver.recv_timeout(LOOK_EVERY) {
            Ok(count) => return count,
            Err(RecvTimeoutError::Timeout) if !cancel.is_cancelled() => waited += LOOK_EVERY,
            Err(_) => return None,
        }
        if is_quick && waited >= QUICK {
            is_quick = false;
            meanwhile();
        }
        if waited >= limit {
            message::say(format_args!(
                "all hits of {what} were not counted: that takes longer than the run; --reference waits for it"
            ));
            return None;
        }
        if !told && waited >= ALWAYS / 2 && limit == Duration::MAX {
            told = true;
            message::say(format_args!(
                "counting all hits of {what}, outside the clock; Ctrl-C leaves the count open"
            ));
        }
    }
}

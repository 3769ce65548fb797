//! Building what a search needs, such as trees and solids, which nothing interrupts: by a thread that is not waited for beyond the limit.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use anyhow::bail;

use crate::message;

/// How often to look at the limit.
const LOOK_EVERY: Duration = Duration::from_millis(2);
/// Features below this number take less than ten milliseconds, and need no thread, whose memory would be reserved beside them.
const QUICK: usize = 1 << 14;

/// What `build` returns for so many features, or `None` if the limit is reached before.
pub(super) fn within_limit<T: Send + 'static>(
    features: usize,
    is_reached: impl Fn() -> bool,
    build: impl FnOnce() -> T + Send + 'static,
) -> anyhow::Result<Option<T>> {
    if features < QUICK {
        return Ok(Some(build()));
    }
    let (sender, receiver) = channel();
    std::thread::Builder::new()
        .name("satisfice-build".to_owned())
        .spawn(move || {
            // Nobody may wait for it any more.
            let _ = sender.send(build());
        })?;
    loop {
        match receiver.recv_timeout(LOOK_EVERY) {
            Err(RecvTimeoutError::Disconnected) => bail!("what the search needs could not be built"),
            // On a busy machine this thread wakes up when they are built, long after the limit.
            Ok(_) | Err(RecvTimeoutError::Timeout) if is_reached() => {
                return Ok(None);
            }
            Ok(built) => return Ok(Some(built)),
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}

/// Why an answer is empty.
pub(super) fn say_nothing_compared(because: &str) {
    message::say(format_args!("no pair was compared: {because}"));
}

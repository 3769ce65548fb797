//! The reference count: the number of all hits, counted when the search is over and outside its clock.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use satisfice::Cancel;

const LOOK_EVERY: Duration = Duration::from_millis(20);
/// The number of looks after which the user is told why it takes so long.
const PATIENCE: u32 = 50;

/// Counts by `count`, which may take long; `None` once the user cancels.
pub(crate) fn wait_for(
    what: &str,
    cancel: &Cancel,
    count: impl FnOnce() -> Option<u64> + Send + 'static,
) -> Option<u64> {
    if cancel.is_cancelled() {
        return None;
    }
    let (sender, receiver) = channel();
    let counting = std::thread::Builder::new()
        .name("reference".to_owned())
        .spawn(move || {
            // Fails where the user cancelled meanwhile.
            let _ = sender.send(count());
        });
    if counting.is_err() {
        return None;
    }
    let mut looks = 0;
    loop {
        match receiver.recv_timeout(LOOK_EVERY) {
            Ok(count) => return count,
            Err(RecvTimeoutError::Timeout) if !cancel.is_cancelled() => looks += 1,
            Err(_) => return None,
        }
        if looks == PATIENCE {
            eprintln!("counting all hits of {what}, outside the clock; Ctrl-C leaves the count open");
        }
    }
}

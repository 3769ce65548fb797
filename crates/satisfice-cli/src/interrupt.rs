//! Ctrl-C and SIGTERM: the first one ends the work and keeps its results, a late second or a third one gives up.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use anyhow::Context;
use satisfice::Cancel;

use crate::output;

/// Exit code that shells report for a program ended by Ctrl-C.
const INTERRUPTED: i32 = 130;
/// A second signal within this time repeats the first one: `timeout` sends two, an impatient user several.
const SAME_WISH: Duration = Duration::from_secs(1);

/// Listens from now on. The signals set the returned flag.
///
/// # Errors
/// If the operating system refuses a signal handler.
pub(crate) fn listen() -> anyhow::Result<Cancel> {
    let cancel = Cancel::new();
    let flag = cancel.clone();
    let signals = Mutex::new(Signals::default());
    ctrlc::set_handler(move || {
        let mut signals = signals.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if signals.gives_up(now()) {
            output::remove_partial_files();
            std::process::exit(INTERRUPTED);
        }
        flag.cancel();
    })
    .context("cannot listen for Ctrl-C")?;
    Ok(cancel)
}

/// The signals so far.
#[derive(Debug, Default)]
struct Signals {
    first: Option<Instant>,
    count: u32,
}

impl Signals {
    /// Notes a signal at `now` and says whether it is to end the program at once.
    fn gives_up(&mut self, now: Instant) -> bool {
        self.count += 1;
        let first = *self.first.get_or_insert(now);
        match self.count {
            1 => false,
            2 => now.duration_since(first) >= SAME_WISH,
            _ => true,
        }
    }
}

#[expect(
    clippy::disallowed_methods,
    reason = "the time between two signals changes no result"
)]
fn now() -> Instant {
    Instant::now()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quick_second_signal_repeats_the_first() {
        let start = now();
        let at = |seconds| start + Duration::from_secs_f64(seconds);
        let mut twice = Signals::default();
        assert!(!twice.gives_up(at(0.0)) && !twice.gives_up(at(0.02)) && twice.gives_up(at(0.03)));
        let mut late = Signals::default();
        assert!(!late.gives_up(at(0.0)) && late.gives_up(at(1.5)));
    }
}

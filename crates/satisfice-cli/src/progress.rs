//! The progress of a search or an enumeration, on stderr if it is a terminal.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use satisfice_catalogue::Progress;

use crate::message;

const STEPS: u64 = 1000;
/// The time between progress lines of a sweep without a terminal.
const TELL_EVERY: Duration = Duration::from_secs(5);

/// A bar on a terminal, nothing elsewhere.
pub(crate) struct Bar(Option<ProgressBar>);

impl Bar {
    /// A bar for a number of slices.
    pub(crate) fn new() -> Self {
        if !std::io::stderr().is_terminal() {
            return Self(None);
        }
        let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent:>3} %  {msg}") {
            bar.set_style(style);
        }
        Self(Some(bar))
    }

    /// Shows how far a search is, the `part`-th of `parts`.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "a share of the bar"
    )]
    pub(crate) fn show(&self, progress: &Progress, part: u64, parts: u64) {
        if let Some(bar) = &self.0 {
            let share = (part as f64 + progress.share) / parts.max(1) as f64;
            bar.set_position((share * STEPS as f64) as u64);
            bar.set_message(format!(
                "{} hits, {:.1e} evaluations, {:.1} s",
                progress.now.hits, progress.now.evaluations as f64, progress.now.elapsed_seconds
            ));
        }
    }
}

/// The runs of a sweep: a bar on a terminal, a line every few seconds elsewhere.
pub(crate) struct Runs {
    bar: Option<ProgressBar>,
    all: u64,
    done: u64,
    told: Instant,
}

impl Runs {
    /// For a number of runs, some of them done.
    pub(crate) fn new(all: u64, done: u64) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::with_draw_target(Some(all), ProgressDrawTarget::stderr());
            if let Ok(style) =
                ProgressStyle::with_template("{bar:30} {pos} of {len} runs, {eta} to go  {msg}")
            {
                bar.set_style(style);
            }
            bar.set_position(done);
            bar.reset_eta();
            bar
        });
        Self {
            bar,
            all,
            done,
            told: now(),
        }
    }

    /// Shows what happens now.
    pub(crate) fn say(&self, what: &str) {
        if let Some(bar) = &self.bar {
            bar.set_message(what.to_owned());
        }
    }

    /// Another run has ended.
    pub(crate) fn finished(&mut self, what: &str) {
        self.done += 1;
        if let Some(bar) = &self.bar {
            bar.inc(1);
            bar.set_message(what.to_owned());
        } else if self.told.elapsed() > TELL_EVERY {
            self.told = now();
            message::say(format_args!("{} of {} runs; {what}", self.done, self.all));
        }
    }
}

impl Drop for Runs {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

/// Work whose end is not known: a line on a terminal, nothing elsewhere.
pub(crate) struct Counting {
    bar: Option<ProgressBar>,
    /// Milliseconds from the start to the number shown last.
    shown: AtomicU64,
}

impl Counting {
    /// The time between two drawings of the line.
    const EVERY: Duration = Duration::from_millis(100);

    pub(crate) fn new() -> Self {
        if !std::io::stderr().is_terminal() {
            return Self {
                bar: None,
                shown: AtomicU64::new(0),
            };
        }
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr_with_hz(10));
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg}  {elapsed}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Self::EVERY);
        Self {
            bar: Some(bar),
            shown: AtomicU64::new(0),
        }
    }

    /// Shows what happens now.
    pub(crate) fn say(&self, what: String) {
        if let Some(bar) = &self.bar {
            bar.set_message(what);
        }
    }

    /// Shows the number of pairs so far; called often, drawn rarely.
    pub(crate) fn show(&self, found: usize, start: Instant) {
        let Some(bar) = &self.bar else { return };
        let seconds = start.elapsed().as_secs_f64();
        let now = (1e3 * seconds) as u64;
        let last = self.shown.load(Ordering::Relaxed);
        if now > last + 50
            && self
                .shown
                .compare_exchange(last, now, Ordering::Relaxed, Ordering::Relaxed)
                .is_ok()
        {
            let rate = found as f64 / seconds;
            bar.set_message(format!("{found} pairs, {rate:.1e} a second; Ctrl-C keeps them"));
        }
    }
}

impl Drop for Counting {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

#[expect(
    clippy::disallowed_methods,
    reason = "decides when to print, not what a result is"
)]
fn now() -> Instant {
    Instant::now()
}

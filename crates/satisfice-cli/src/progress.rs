//! How far a search or an enumeration is, on stderr where that is a terminal.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use satisfice_bench::Progress;

const STEPS: u64 = 1000;

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

impl Drop for Bar {
    fn drop(&mut self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

/// What goes on, of which nobody knows the end: a line on a terminal, nothing elsewhere.
pub(crate) struct Counting(Option<ProgressBar>);

impl Counting {
    /// So often the line is drawn anew.
    const EVERY: Duration = Duration::from_millis(100);

    pub(crate) fn new() -> Self {
        if !std::io::stderr().is_terminal() {
            return Self(None);
        }
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr_with_hz(10));
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg}  {elapsed}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Self::EVERY);
        Self(Some(bar))
    }

    /// Says what goes on now.
    pub(crate) fn say(&self, what: String) {
        if let Some(bar) = &self.0 {
            bar.set_message(what);
        }
    }

    /// Says how many pairs there are so far; often called, seldom drawn.
    pub(crate) fn show(&self, found: usize, start: Instant) {
        if let Some(bar) = &self.0
            && found.is_multiple_of(64)
        {
            let rate = found as f64 / start.elapsed().as_secs_f64().max(1e-9);
            bar.set_message(format!("{found} pairs, {rate:.1e} a second; Ctrl-C keeps them"));
        }
    }
}

impl Drop for Counting {
    fn drop(&mut self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

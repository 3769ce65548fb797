//! How far a search is, on stderr where that is a terminal.

use std::io::IsTerminal;

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

//! What accompanies a run without being part of it: cancellation, progress, checkpoints.

use core::fmt;
use core::time::Duration;

use satisfice::{Cancel, TracePoint};

/// The progress of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// The slice that is running, from 0.
    pub slice: u64,
    /// Evaluations, time and hits of this slice.
    pub now: TracePoint,
    /// Used share of this slice's budget, in `[0, 1]`.
    pub share: f64,
}

/// Takes the bytes of a checkpoint.
pub type Save<'a> = dyn FnMut(&[u8]) + 'a;

/// Cancellation, progress and checkpoints of a run. By default it cannot be cancelled, is not watched, starts from its
/// beginning and is not saved.
///
/// ```
/// use satisfice_catalogue::{RunControl, RunSpec, catalogue};
/// let problem = catalogue::find("queens")?.build([])?;
/// let mut calls = 0;
/// let mut watch = |_: &satisfice_catalogue::Progress| calls += 1;
/// let control = RunControl { watch: Some(&mut watch), ..RunControl::default() };
/// problem.run(&RunSpec::new("random").evaluations(1000), control)?;
/// # Ok::<(), satisfice_catalogue::Error>(())
/// ```
#[derive(Default)]
pub struct RunControl<'a> {
    /// Ends the run; what it found until then is reported.
    pub cancel: Cancel,
    /// Is told of progress, at most about a hundred times a second.
    pub watch: Option<&'a mut dyn FnMut(&Progress)>,
    /// A checkpoint of the same run to continue from.
    pub resume: Option<&'a [u8]>,
    /// Takes checkpoints: one at the start, then one in about [`every`](Self::every), one at the start and end of each slice that
    /// takes a second or `every`, one when the run is cancelled, and one at the end.
    pub save: Option<&'a mut Save<'a>>,
    /// The time between checkpoints.
    pub every: Duration,
    /// Is told, once a run, what it could not make use of.
    pub remark: Option<&'a mut dyn FnMut(&str)>,
}

impl RunControl<'_> {
    /// A run that this ends.
    #[must_use]
    pub fn until(cancel: &Cancel) -> Self {
        Self {
            cancel: cancel.clone(),
            ..Self::default()
        }
    }
}

impl fmt::Debug for RunControl<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RunControl")
            .field("cancel", &self.cancel)
            .field("resume", &self.resume.map(<[u8]>::len))
            .field("every", &self.every)
            .finish_non_exhaustive()
    }
}

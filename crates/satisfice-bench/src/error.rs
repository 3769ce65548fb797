//! Every error of this crate, as data.

use std::path::PathBuf;

/// What was wrong with a request, a record or a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The framework refused it: an unknown name, a value out of range, a budget.
    #[error(transparent)]
    Search(#[from] satisfice::Error),
    /// A solution could not be written as JSON.
    #[error("a solution cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A checkpoint that cannot be read.
    #[error("no checkpoint of a run of this problem: {0}")]
    Checkpoint(String),
    /// A checkpoint of another run.
    #[error("the checkpoint's {what} is {saved}, not {now}: give the arguments that the run was begun with")]
    Other {
        /// What differs.
        what: &'static str,
        /// What the checkpoint says.
        saved: String,
        /// What was asked for.
        now: String,
    },
    /// No slice was asked for.
    #[error("0 slices leave nothing to run: give at least 1")]
    NoSlices,
    /// A chart whose file has another extension than those that can be drawn.
    #[error("cannot draw {}: a chart is an .svg or a .png file", .0.display())]
    ChartFormat(PathBuf),
    /// A chart that could not be encoded.
    #[error("cannot encode the chart: {0}")]
    Chart(String),
    /// An exact method on a problem that is not one of vertex pairs.
    #[error("`{method}` finds pairs of vertices, and `{problem}` has none: take an engine")]
    Exact {
        /// The method.
        method: String,
        /// The problem.
        problem: &'static str,
    },
    /// A suite that cannot be run as it is written.
    #[error("{place}: {what}")]
    Suite {
        /// Its name or file, and the part of it.
        place: String,
        /// What is wrong, and what would be right.
        what: String,
    },
    /// A file of a sweep that cannot be read or written.
    #[error("{}: {what}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// A scene that cannot be built.
    #[error(transparent)]
    Scene(#[from] satisfice_collision::Error),
    /// An engine has reported what exact enumeration does not know.
    #[error("{solution} was reported as a hit of frame {frame}, and is none")]
    NoHit {
        /// The solution.
        solution: String,
        /// The frame, from 0.
        frame: usize,
    },
    /// A picture of a scene that could not be drawn.
    #[error("cannot draw the picture: {0}")]
    Picture(String),
}

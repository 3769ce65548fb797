//! Every error of this crate, as data.

/// An error in a specification, a report or a checkpoint.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The framework refused it: an unknown name, a value out of range, a budget.
    #[error(transparent)]
    Search(#[from] satisfice::Error),
    /// A solution cannot be written as JSON.
    #[error("a solution cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// The file is not a checkpoint of this problem.
    #[error("this is not a checkpoint of a run of this problem: {0}")]
    Checkpoint(String),
    /// The checkpoint belongs to another run.
    #[error(
        "the checkpoint's {what} is {saved}, not {now}: give the arguments that the run was started with"
    )]
    Differs {
        /// The difference, as a path in the JSON of a [`RunSpec`](crate::RunSpec).
        what: String,
        /// Its value in the checkpoint.
        saved: String,
        /// The value asked for.
        now: String,
    },
    /// The specification has 0 slices.
    #[error("0 slices leave nothing to run: give at least 1")]
    NoSlices,
    /// An exact method was asked for on a problem that does not search for vertex pairs.
    #[error("`{method}` finds pairs of vertices, and `{problem}` has none: choose an engine")]
    Exact {
        /// The method.
        method: String,
        /// The problem.
        problem: &'static str,
    },
    /// The vertices or the threshold of a problem of vertex pairs are refused by the collision library.
    #[error("vertex pairs: {0}")]
    VertexPairs(#[from] satisfice_collision::Error),
}

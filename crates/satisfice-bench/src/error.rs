//! Every error of this crate, as data.

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
    /// No slice was asked for.
    #[error("0 slices leave nothing to run: give at least 1")]
    NoSlices,
}

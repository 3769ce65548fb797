//! Every error of this crate, as data.

use std::path::PathBuf;

/// An error in a suite, in one of its runs, or of a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A run failed, or the framework refused a name, a value or a budget.
    #[error(transparent)]
    Run(#[from] satisfice_catalogue::Error),
    /// A chart cannot be drawn.
    #[error(transparent)]
    Draw(#[from] satisfice_draw::Error),
    /// A picture of a scene cannot be drawn.
    #[error(transparent)]
    Picture(#[from] satisfice_picture::Error),
    /// A page cannot be made.
    #[error(transparent)]
    Page(#[from] satisfice_page::Error),
    /// A suite that cannot be run as it is written.
    #[error("{place}: {what}")]
    Suite {
        /// Its name or file, and the part of it.
        place: String,
        /// The problem, and what is allowed instead.
        what: String,
    },
    /// A file of a sweep that cannot be read or written.
    #[error("{}: {what}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The reason.
        what: String,
    },
}

impl From<satisfice::Error> for Error {
    fn from(error: satisfice::Error) -> Self {
        Self::Run(error.into())
    }
}

impl From<serde_json::Error> for Error {
    fn from(error: serde_json::Error) -> Self {
        Self::Run(error.into())
    }
}

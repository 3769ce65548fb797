//! Every error of this crate, as data.

/// Why a page cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Something names a body, a vertex or another part that the page does not have.
    #[error("the page has no {what} {number}: it has {count}")]
    Unknown {
        /// What is named.
        what: &'static str,
        /// Its number, from 0.
        number: usize,
        /// How many there are.
        count: usize,
    },
    /// A coordinate that is NaN or infinite.
    #[error("a coordinate of {what} is not finite")]
    NotFinite {
        /// What has it.
        what: String,
    },
    /// A body moves to another number of vertices than it has.
    #[error("body {body} has {expected} vertices, not {found}")]
    Vertices {
        /// Number of the body.
        body: usize,
        /// How many it has.
        expected: usize,
        /// How many it was given.
        found: usize,
    },
    /// The data cannot be compressed or written.
    #[error("cannot write the data of the page: {0}")]
    Pack(#[from] std::io::Error),
}

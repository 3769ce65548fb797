//! Every error of this crate, as data.

/// Why a picture cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The size, the view, or a picture of a strip is not allowed, or there is no memory.
    #[error("cannot draw the picture: {0}")]
    Picture(String),
}

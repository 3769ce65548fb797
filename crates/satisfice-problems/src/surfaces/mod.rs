//! Smooth functions of few variables, the usual tests of a search with few evaluations.

mod branin;
mod hartmann;
mod surface;

pub use branin::Branin;
pub use hartmann::Hartmann6;

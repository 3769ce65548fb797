//! Sets `{x : F(x) < delta}` of simple functions on a lattice of cells.

mod islands;
mod needles;
mod rastrigin;
mod shell;

pub use islands::Islands;
pub use needles::Needles;
pub use rastrigin::Rastrigin;
pub use shell::Shell;

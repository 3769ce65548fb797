//! Sets `{x : F(x) < delta}` of simple functions on a lattice of cells.

mod cec2006;
mod disc_packing;
mod islands;
mod needles;
mod rastrigin;
mod shell;

pub use cec2006::Cec2006;
pub use disc_packing::DiscPacking;
pub use islands::Islands;
pub use needles::Needles;
pub use rastrigin::Rastrigin;
pub use shell::Shell;

//! Sets `{x : F(x) < delta}` of simple functions.

mod cec2006;
mod disc_packing;
mod islands;
mod mixed_axes;
mod needles;
mod rastrigin;
mod shell;
mod small_regions;

pub use cec2006::Cec2006;
pub use disc_packing::DiscPacking;
pub use islands::Islands;
pub use mixed_axes::MixedAxes;
pub use needles::Needles;
pub use rastrigin::Rastrigin;
pub use shell::Shell;
pub use small_regions::{Shape, SmallRegions};

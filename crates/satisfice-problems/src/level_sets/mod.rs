//! Sets `{x : F(x) < delta}` of simple functions.

mod cec2006;
mod disc_packing;
mod islands;
mod mixed_axes;
mod needles;
mod rastrigin;
mod shell;
mod small_regions;

use satisfice::SearchRng;

pub use cec2006::Cec2006;
pub use disc_packing::DiscPacking;
pub use islands::Islands;
pub use mixed_axes::MixedAxes;
pub use needles::Needles;
pub use rastrigin::Rastrigin;
pub use shell::Shell;
pub use small_regions::{Shape, SmallRegions};

/// The random numbers of an instance, in a stream of their own: a search whose seed is the same number must not draw the places of the hits.
fn instance_rng(instance: u64) -> SearchRng {
    SearchRng::stream(instance, u64::from_be_bytes(*b"instance"))
}

//! Engines around engines.

mod flood_fill;
mod pruned;

pub(super) use flood_fill::FloodFill;
pub(super) use pruned::Pruned;

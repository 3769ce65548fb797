//! The baseline, where every comparison finds it.

pub(crate) use satisfice_bench::plain_grid::{between, within};

//! Exact search by bounds.

mod branch_and_bound;
pub(super) mod region_tree;

pub(super) use branch_and_bound::RegionSearch;
pub use branch_and_bound::{BranchAndBound, SplitRule};

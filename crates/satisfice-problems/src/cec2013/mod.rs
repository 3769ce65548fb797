//! The CEC2013 niching suite: 20 multimodal functions with 447 global optima.

mod basic;
mod composition;
mod data;
mod optima;
mod problem;
mod scoring;

pub use data::SuiteData;
pub use problem::Cec2013;
pub use scoring::{Score, peak_ratio};

#![doc = include_str!("../README.md")]

pub mod archive;
pub mod batch;
mod binomial;
pub mod budget;
mod candidates;
pub mod catalogue;
mod clock;
pub mod context;
pub mod engine;
mod error;
mod evaluate;
pub mod identity;
#[cfg(feature = "interval")]
pub mod interval;
pub mod observer;
mod probes;
pub mod problem;
pub mod report;
mod scalar;
mod search;
mod seed;
pub mod space;
pub mod state;
pub mod testing;
mod threads;
mod unseen;
mod view;

pub use archive::{Archive, Hit};
pub use batch::{Batch, Outcome};
pub use budget::{Budget, Cancel, StopReason};
pub use context::Context;
pub use engine::{Engine, WarmStart};
pub use error::Error;
pub use identity::{Identity, Located};
pub use observer::Observer;
pub use problem::{SatisficingProblem, from_fn};
pub use report::{Completeness, Counts, Report, TracePoint};
pub use scalar::Real;
pub use search::{Checkpoint, Islands, Saving, Search, Unfinished};
pub use seed::SearchRng;
pub use space::{Axis, AxisKind, Boundary, Region, Space};
pub use unseen::{Method, Unseen};

#![doc = include_str!("../README.md")]

mod accounting;
pub mod archive;
pub mod batch;
mod best;
mod binomial;
pub mod budget;
mod cancel;
mod candidates;
pub mod capability;
pub mod catalogue;
#[doc(hidden)]
pub mod checksum;
mod clock;
pub mod context;
mod description;
pub mod engine;
mod error;
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

pub mod checkpoint {
    //! What a saved search holds.
    pub use crate::search::{Checkpoint, Contents, Fingerprint, Unfinished};
}

pub use archive::{Archive, Hit};
pub use batch::{Batch, Outcome};
pub use best::Best;
pub use budget::{Budget, Cancel, StopReason};
pub use capability::{Bounds, Components, Encoding, Neighbourhood};
pub use context::Context;
pub use description::Description;
pub use engine::{Engine, WarmStart};
pub use error::Error;
pub use identity::{AxisSeparation, Identity, Located, Separation};
pub use observer::Observer;
pub use problem::{SatisficingProblem, from_fn};
pub use report::{Completeness, Counts, Report, RunReport, SourceCount, SourceRow, SourceTrace, TracePoint};
pub use scalar::Real;
pub use search::{
    Asked, Checkpoint, IslandRound, Order, Rounds, RunOptions, Search, Stepper, Ticket, TicketCounts,
    TicketEvent, TicketLog, Tickets, Told,
};
pub use seed::SearchRng;
pub use space::{Axis, AxisKind, Boundary, Region, Space};
pub use unseen::{Method, Unseen};

//! Pages to look into: one HTML file each, which works from disk, offline, and makes no request.
//!
//! [`ScenePage`] shows bodies with their contacts in three dimensions, frame by frame and in the order in which a search found
//! them. [`SearchPage`] shows the hits of a search over any of their coordinates, and [`ComparePage`] how the hits of several
//! engines come in. A page holds its data compressed; scripts and styles of our own are part of it, less than 60 kB together. It needs a
//! browser of 2023 or later: WebGL 2 for the view, without which a table of the contacts remains.
//!
//! Names and texts may contain anything: the data of a page is Base64, what a script shows of it is text and never markup, and
//! the page forbids itself every request by a content security policy.

mod compare;
mod error;
mod pack;
mod scene;
mod search;
mod shell;

pub use compare::ComparePage;
pub use error::Error;
pub use scene::{Contact, Feature, FeatureKind, ScenePage, Up};
pub use search::SearchPage;

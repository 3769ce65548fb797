//! Draws results as SVG and PNG: [charts](plot) of curves, maps and boards.

mod error;
pub mod plot;

pub use error::Error;

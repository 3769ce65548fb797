//! Draws results: [charts](plot) of curves, maps and boards, and [pictures](picture) of scenes, as SVG and PNG.

mod error;
pub mod picture;
pub mod plot;

pub use error::Error;

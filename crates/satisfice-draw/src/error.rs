//! Every error of this crate, as data.

use std::path::PathBuf;

/// Why something cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The extension of the file is not one of the formats of a chart.
    #[error("cannot draw {}: a chart is an .svg or a .png file", .0.display())]
    ChartFormat(PathBuf),
    /// The chart cannot be encoded.
    #[error("cannot encode the chart: {0}")]
    Chart(String),
}

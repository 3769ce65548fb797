//! Charts, drawn as SVG or PNG: curves over two axes; maps of points, lines and contours; boards.

mod boards;
mod draw;
mod map;

use std::path::Path;

pub use boards::{Board, Boards};
pub use draw::{draw, draw_boards, draw_maps};
pub use map::{Colour, Layer, Map, Maps, Marker, Shape};

use crate::error::Error;

/// One or more panels side by side, under a title.
///
/// ```
/// use satisfice_draw::plot::{Chart, Curve, Format, Panel, draw};
/// let curve = Curve { points: vec![(1.0, 2.0), (10.0, 5.0)], steps: true, ..Curve::default() };
/// let panel = Panel { x_label: "evaluations".to_owned(), log_x: true, curves: vec![curve], ..Panel::default() };
/// let chart = Chart { title: "Hits".to_owned(), panels: vec![panel] };
/// assert!(draw(&chart, Format::Svg)?.starts_with(b"<svg"));
/// # Ok::<(), satisfice_draw::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Chart {
    /// The title.
    pub title: String,
    /// The panels, left to right.
    pub panels: Vec<Panel>,
}

/// Curves over a pair of axes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Panel {
    /// Label of the horizontal axis, with its unit.
    pub x_label: String,
    /// Label of the vertical axis, with its unit.
    pub y_label: String,
    /// Whether the horizontal axis is logarithmic; points with x <= 0 are then left out.
    pub log_x: bool,
    /// Whether the vertical axis is logarithmic; points with y <= 0 are then left out.
    pub log_y: bool,
    /// The curves.
    pub curves: Vec<Curve>,
    /// A value of y that is marked by a dashed line, with its label.
    pub mark: Option<(f64, String)>,
}

/// One curve.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Curve {
    /// Its name in the legend; `None` for the only curve.
    pub label: Option<String>,
    /// Its points; those that are not finite are left out.
    pub points: Vec<(f64, f64)>,
    /// For each point the least and the greatest y of a band around it; empty if there is none.
    pub band: Vec<(f64, f64)>,
    /// Whether its points are marked by black dots instead of joined.
    pub marks: bool,
    /// Whether it goes up in steps.
    pub steps: bool,
}

/// File format of a chart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Scalable vector graphics.
    Svg,
    /// Portable network graphics, two pixels per unit.
    Png,
}

impl Format {
    /// The format of a path, by its extension.
    ///
    /// # Errors
    /// [`Error::ChartFormat`] for any other than `svg` and `png`.
    pub fn of(path: &Path) -> Result<Self, Error> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            _ => Err(Error::ChartFormat(path.to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_format_is_known_by_the_extension_in_either_case() {
        let text = Format::of("figure.pdf".as_ref()).unwrap_err().to_string();
        assert_eq!(text, "cannot draw figure.pdf: a chart is an .svg or a .png file");
        assert_eq!(Format::of("a.b/figure.PNG".as_ref()).unwrap(), Format::Png);
    }
}

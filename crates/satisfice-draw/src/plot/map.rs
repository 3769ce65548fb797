//! Maps: points, lines and contours over a plane.

/// Maps side by side, under a title.
///
/// ```
/// use satisfice_draw::plot::{Colour, Format, Layer, Map, Maps, draw_maps};
/// let hits = Layer::points(Colour::Blue, 2.0, vec![(0.1, 0.2), (0.5, 0.5)]).named("hits");
/// let map = Map { x_range: (0.0, 1.0), y_range: (0.0, 1.0), layers: vec![hits], ..Map::default() };
/// let maps = Maps { title: "Hits".to_owned(), size: (300.0, 300.0), panels: vec![map] };
/// assert!(draw_maps(&maps, Format::Svg)?.starts_with(b"<svg"));
/// # Ok::<(), satisfice_draw::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Maps {
    /// The title.
    pub title: String,
    /// Width and height of a panel in units, legend included; a PNG has two pixels per unit.
    pub size: (f64, f64),
    /// The panels, left to right.
    pub panels: Vec<Map>,
}

/// A part of a plane.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Map {
    /// The title.
    pub title: String,
    /// Label of the horizontal axis, with its unit.
    pub x_label: String,
    /// Label of the vertical axis, with its unit.
    pub y_label: String,
    /// Least and greatest x shown.
    pub x_range: (f64, f64),
    /// Least and greatest y shown.
    pub y_range: (f64, f64),
    /// Whether both axes are logarithmic; points that are not above 0 are then left out.
    pub logarithmic: bool,
    /// Whether a unit of x is as long as a unit of y; not of logarithmic axes.
    pub to_scale: bool,
    /// What is drawn, from below to above.
    pub layers: Vec<Layer>,
    /// Words, each over a place.
    pub notes: Vec<(f64, f64, String)>,
}

/// Points, lines or contours in one style. Points that are not finite are left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Its line in the legend, or the name of the colour bar of contours.
    pub label: Option<String>,
    /// Its colour; contours have a scale of their own.
    pub colour: Colour,
    /// Width of lines, radius of points, in units.
    pub size: f64,
    /// What is drawn.
    pub shape: Shape,
}

/// Forms of a [`Layer`].
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A mark at each of these points.
    Points(Marker, Vec<(f64, f64)>),
    /// Lines, each through its points.
    Lines(Vec<Vec<(f64, f64)>>),
    /// As [`Shape::Lines`], dashed.
    Dashes(Vec<Vec<(f64, f64)>>),
    /// Filled bands between levels of z, dark where z is small.
    Contours {
        /// The columns of the grid.
        x: Vec<f64>,
        /// The rows of the grid.
        y: Vec<f64>,
        /// z at `[row][column]`.
        z: Vec<Vec<f64>>,
        /// The levels of z between bands, rising.
        levels: Vec<f64>,
    },
}

/// Form of a mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// A disc.
    Disc,
    /// A square.
    Square,
    /// A triangle.
    Triangle,
    /// A diagonal cross.
    Cross,
}

/// Okabe and Ito's colours, which colour-blind readers can distinguish (<https://jfly.uni-koeln.de/color/>), and greys.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colour {
    /// Black.
    Black,
    /// Blue.
    Blue,
    /// Sky blue.
    Sky,
    /// Bluish green.
    Green,
    /// Orange.
    Orange,
    /// Vermilion.
    Vermilion,
    /// Reddish purple.
    Purple,
    /// A grey that recedes behind the colours.
    Grey,
    /// White, for rims.
    White,
}

impl Colour {
    pub(super) fn hexadecimal(self) -> &'static str {
        match self {
            Self::Black => "#000000",
            Self::Blue => "#0072b2",
            Self::Sky => "#56b4e9",
            Self::Green => "#009e73",
            Self::Orange => "#e69f00",
            Self::Vermilion => "#d55e00",
            Self::Purple => "#cc79a7",
            Self::Grey => "#b8b8b8",
            Self::White => "#ffffff",
        }
    }
}

impl Layer {
    /// Discs of this radius.
    #[must_use]
    pub fn points(colour: Colour, radius: f64, points: Vec<(f64, f64)>) -> Self {
        Self::marks(colour, radius, Marker::Disc, points)
    }

    /// Marks of this form and radius.
    #[must_use]
    pub fn marks(colour: Colour, radius: f64, marker: Marker, points: Vec<(f64, f64)>) -> Self {
        Self {
            label: None,
            colour,
            size: radius,
            shape: Shape::Points(marker, points),
        }
    }

    /// Lines of this width.
    #[must_use]
    pub fn lines(colour: Colour, width: f64, lines: Vec<Vec<(f64, f64)>>) -> Self {
        Self {
            label: None,
            colour,
            size: width,
            shape: Shape::Lines(lines),
        }
    }

    /// Dashed lines of this width.
    #[must_use]
    pub fn dashes(colour: Colour, width: f64, lines: Vec<Vec<(f64, f64)>>) -> Self {
        Self {
            label: None,
            colour,
            size: width,
            shape: Shape::Dashes(lines),
        }
    }

    /// With a line in the legend.
    #[must_use]
    pub fn named(mut self, label: impl Into<String>) -> Self {
        self.label = Some(label.into());
        self
    }
}

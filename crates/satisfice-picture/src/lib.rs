//! Pictures of a scene: shaded bodies with marked pairs, those that were found and those that were not.
//!
//! ```
//! use satisfice_picture::{Picture, View};
//! use satisfice_collision::{Placement, generate};
//! let ball = generate::icosphere(1.0, 2)?;
//! let other = Placement::from_translation([1.9, 0.0, 0.0])?.place(&ball)?;
//! let mut picture = Picture::new(320, 200, View::default());
//! picture.body(&ball);
//! picture.body(&other);
//! picture.pair([1.0, 0.0, 0.0], [0.9, 0.0, 0.0], true);
//! assert_eq!(&picture.png()?[1..4], b"PNG");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod camera;
mod error;
mod marks;
mod raster;
mod strip;

use std::collections::BTreeSet;

use satisfice_collision::Mesh;
pub use strip::strip;

use camera::Camera;
pub use error::Error;
use marks::Mark;
use raster::Raster;

/// Greatest width and height in pixels.
const LARGEST: u32 = 3000;

/// Pale tones of Okabe and Ito's colours (<https://jfly.uni-koeln.de/color/>), body after body; marks are in full tones.
const BODIES: [[f64; 3]; 6] = [
    [0.62, 0.80, 0.93], // sky blue
    [0.93, 0.88, 0.76], // sand
    [0.65, 0.86, 0.78], // green
    [0.90, 0.76, 0.84], // purple
    [0.80, 0.80, 0.80], // grey
    [0.72, 0.74, 0.95], // blue
];

/// Okabe and Ito's orange: triangles that are highlighted.
const HIGHLIGHT: [f64; 3] = [0.96, 0.66, 0.12];

/// Which axis points upwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Up {
    /// x; then y points where x does by default, and z where y does.
    X,
    /// y, as in most files made for rendering; z then points to the front.
    Y,
    /// z, as in most files made for construction.
    #[default]
    Z,
}

impl Up {
    /// Maps a direction from a world in which z points upwards to one in which this axis does.
    fn turn(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        match self {
            Self::X => [z, x, y],
            Self::Y => [x, z, -y],
            Self::Z => [x, y, z],
        }
    }
}

/// The direction from which a scene is seen, in parallel projection.
///
/// ```
/// use satisfice_picture::{Up, View};
/// let from_above = View { elevation: 90.0, up: Up::Y, ..View::default() };
/// assert_eq!(from_above.azimuth, -76.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Direction of the eye about the axis that points upwards, in degrees from the axis that is x where that is z.
    pub azimuth: f64,
    /// Height of the eye above the horizon, in degrees.
    pub elevation: f64,
    /// Which axis points upwards.
    pub up: Up,
}

impl Default for View {
    /// From the front right, a little from above.
    fn default() -> Self {
        Self {
            azimuth: -76.0,
            elevation: 24.0,
            up: Up::Z,
        }
    }
}

/// A picture of bodies and marked pairs.
#[derive(Debug, Clone)]
pub struct Picture<'a> {
    width: u32,
    height: u32,
    view: View,
    bodies: Vec<&'a Mesh>,
    /// The highlighted triangles of each body.
    highlights: Vec<BTreeSet<u32>>,
    marks: Vec<Mark>,
}

impl<'a> Picture<'a> {
    /// An empty picture of `width` times `height` pixels.
    #[must_use]
    pub fn new(width: u32, height: u32, view: View) -> Self {
        Self {
            width,
            height,
            view,
            bodies: Vec::new(),
            highlights: Vec::new(),
            marks: Vec::new(),
        }
    }

    /// Adds a body: its triangles; where it has none, its edges; where it has none, its vertices.
    pub fn body(&mut self, mesh: &'a Mesh) {
        self.bodies.push(mesh);
        self.highlights.push(BTreeSet::new());
    }

    /// Draws a triangle of a body, both by number from 0, in orange. An unknown body or triangle has no effect.
    pub fn highlight(&mut self, body: usize, triangle: u32) {
        if let Some(highlights) = self.highlights.get_mut(body) {
            highlights.insert(triangle);
        }
    }

    /// Marks a pair of points: in vermilion where it was `found`, in black otherwise. Marks behind a body are fainter. A pair whose
    /// points are apart in the picture is a line between two marks.
    /// Points that are not finite are left out.
    pub fn pair(&mut self, a: [f64; 3], b: [f64; 3], found: bool) {
        if a.iter().chain(&b).all(|c| c.is_finite()) {
            self.marks.push(Mark { ends: [a, b], found });
        }
    }

    /// Draws it as PNG. The same picture gives the same bytes.
    ///
    /// # Errors
    /// [`Error::Picture`] for a width or height out of `1..=3000`, or a view that is not finite.
    pub fn png(&self) -> Result<Vec<u8>, Error> {
        for (what, pixels) in [("width", self.width), ("height", self.height)] {
            if !(1..=LARGEST).contains(&pixels) {
                return Err(Error::Picture(format!(
                    "a {what} of {pixels} pixels: choose 1 to {LARGEST}"
                )));
            }
        }
        let View {
            azimuth, elevation, ..
        } = self.view;
        if !(azimuth.is_finite() && elevation.is_finite()) {
            return Err(Error::Picture(format!(
                "a view from {azimuth} and {elevation} degrees: both have to be finite"
            )));
        }
        let camera = self.camera();
        let mut raster = Raster::new(self.width, self.height);
        let tones = BODIES.iter().cycle();
        for ((mesh, highlights), tone) in self.bodies.iter().zip(&self.highlights).zip(tones) {
            let tone_of = |t: usize| match highlights.contains(&(t as u32)) {
                true => HIGHLIGHT,
                false => *tone,
            };
            raster.body(mesh, tone_of, &camera);
        }
        let mut pixmap = raster.pixmap().ok_or_else(|| no_memory("pixels"))?;
        for (mesh, tone) in self.bodies.iter().zip(BODIES.iter().cycle()) {
            marks::skeleton(&mut pixmap, mesh, *tone, &camera);
        }
        marks::pairs(&mut pixmap, &self.marks, &raster, &camera);
        pixmap
            .encode_png()
            .map_err(|error| Error::Picture(error.to_string()))
    }

    /// The camera that shows all bodies and marks.
    fn camera(&self) -> Camera {
        let marks = || self.marks.iter().flat_map(|mark| mark.ends);
        let vertices = || {
            self.bodies
                .iter()
                .flat_map(|mesh| mesh.vertices().iter().copied())
        };
        let framed: Vec<_> = vertices().chain(marks()).collect();
        // Coordinates relative to the largest one cannot overflow.
        let unit = vertices()
            .chain(marks())
            .flatten()
            .fold(0.0_f64, |m, c| m.max(c.abs()));
        Camera::new(
            &self.view,
            &framed,
            if unit > 0.0 { unit } else { 1.0 },
            [f64::from(self.width), f64::from(self.height)],
        )
    }
}

fn no_memory(what: &str) -> Error {
    Error::Picture(format!("there is no memory for its {what}"))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use satisfice_collision::generate;

    fn pixels(picture: &Picture<'_>) -> tiny_skia::Pixmap {
        tiny_skia::Pixmap::decode_png(&picture.png().unwrap()).unwrap()
    }

    fn vermilion(pixmap: &tiny_skia::Pixmap) -> usize {
        pixmap
            .pixels()
            .iter()
            .filter(|p| p.red() > 180 && p.green() < 120 && p.blue() < 60)
            .count()
    }

    /// Seen along x, a ball of radius 1 covers pi/4 of the square around it.
    #[test]
    fn a_ball_covers_its_disc() {
        let ball = generate::icosphere(1.0, 4).unwrap();
        let mut picture = Picture::new(
            200,
            200,
            View {
                azimuth: 0.0,
                elevation: 0.0,
                up: Up::Z,
            },
        );
        picture.body(&ball);
        let map = pixels(&picture);
        let covered = map.pixels().iter().filter(|p| p.red() < 250).count();
        let expected = std::f64::consts::PI / 4.0 * (200.0_f64 * 0.92).powi(2);
        assert!(
            (covered as f64 / expected - 1.0).abs() < 0.02,
            "{covered} of {expected}"
        );
    }

    #[test]
    fn the_nearer_body_hides_the_other_and_marks_behind_are_fainter() {
        let ball = generate::icosphere(1.0, 3).unwrap();
        let view = View {
            azimuth: 0.0,
            elevation: 0.0,
            up: Up::Z,
        };
        let marked = |x: f64| {
            let mut picture = Picture::new(200, 200, view);
            picture.body(&ball);
            picture.pair([x, -0.01, 0.0], [x, 0.01, 0.0], true);
            vermilion(&pixels(&picture))
        };
        assert!(marked(1.1) > 10, "in front of the ball");
        assert_eq!(marked(-1.1), 0, "behind it");
        let front = satisfice_collision::Placement::from_translation([3.0, 0.0, 0.0]).unwrap();
        let front = front.place(&ball).unwrap();
        let first = |bodies: [&Mesh; 2]| {
            let mut picture = Picture::new(64, 64, view);
            bodies.into_iter().for_each(|body| picture.body(body));
            pixels(&picture).pixel(32, 32).unwrap()
        };
        // Blue where the first body is in front, sand where the second one is.
        assert!(first([&front, &ball]).blue() > first([&front, &ball]).red());
        assert!(first([&ball, &front]).blue() < first([&ball, &front]).red());
    }

    #[test]
    fn a_pair_whose_points_are_apart_is_a_line() {
        let view = View {
            azimuth: 0.0,
            elevation: 0.0,
            up: Up::Z,
        };
        let corners = Mesh::new(vec![[0.0, -1.0, -1.0], [0.0, 1.0, 1.0]], vec![], vec![]).unwrap();
        let marked = |y: f64| {
            let mut picture = Picture::new(200, 200, view);
            picture.body(&corners);
            picture.pair([0.0, -y, 0.0], [0.0, y, 0.0], true);
            vermilion(&pixels(&picture))
        };
        // 200 pixels for 2.17 units: a line of 92 pixels beside two marks
        let (point, line) = (marked(0.001), marked(0.5));
        assert!(line > 2 * point + 70, "{point} and {line} pixels");
    }

    /// A scene whose axes are exchanged, seen with another axis upwards, is the same picture.
    #[test]
    fn each_axis_can_point_upwards() {
        let torus = generate::torus(1.0, 0.3, 24, 12).unwrap();
        let tilt = satisfice_collision::Placement::from_axis_angle([1.0, 0.5, 0.0], 0.4).unwrap();
        let upright = tilt.place(&torus).unwrap();
        let png = |mesh: &Mesh, up: Up| {
            let mut picture = Picture::new(
                90,
                70,
                View {
                    up,
                    ..View::default()
                },
            );
            picture.body(mesh);
            picture.png().unwrap()
        };
        let turned = |how: fn([f64; 3]) -> [f64; 3]| {
            let vertices = upright.vertices().iter().map(|&v| how(v)).collect();
            upright.with_vertices(vertices).unwrap()
        };
        let expected = png(&upright, Up::Z);
        assert_eq!(png(&turned(|[x, y, z]| [x, z, -y]), Up::Y), expected);
        assert_eq!(png(&turned(|[x, y, z]| [z, x, y]), Up::X), expected);
        assert_ne!(png(&upright, Up::Y), expected);
    }

    #[test]
    fn highlighted_triangles_are_orange() {
        let ball = generate::icosphere(1.0, 2).unwrap();
        let orange = |highlighted: &[u32]| {
            let mut picture = Picture::new(80, 80, View::default());
            picture.body(&ball);
            highlighted.iter().for_each(|&t| picture.highlight(0, t));
            picture.highlight(1, 0);
            let map = pixels(&picture);
            map.pixels()
                .iter()
                .filter(|p| p.red() > p.blue().saturating_mul(2))
                .count()
        };
        assert_eq!((orange(&[]), orange(&[9999])), (0, 0));
        let all: Vec<u32> = (0..320).collect();
        assert!(orange(&all) > 3000 && orange(&all[..160]) < orange(&all));
    }

    #[test]
    fn odd_scenes_are_drawn_or_refused() {
        let dot = Mesh::new(vec![[1e308, -1e308, 0.0]], vec![], vec![]).unwrap();
        let line = Mesh::new(vec![[0.0; 3], [-1e308, 1.0, 1e-308]], vec![[0, 1]], vec![]).unwrap();
        let flat = Mesh::new(vec![[0.0; 3]; 3], vec![], vec![[0, 1, 2]]).unwrap();
        for mesh in [&dot, &line, &flat] {
            let mut picture = Picture::new(40, 1, View::default());
            picture.body(mesh);
            picture.pair([0.0; 3], [0.0; 3], false);
            picture.pair([f64::NAN; 3], [0.0; 3], true);
            assert_eq!(pixels(&picture).width(), 40);
        }
        assert_eq!(pixels(&Picture::new(3, 3, View::default())).height(), 3);
        assert!(Picture::new(0, 3, View::default()).png().is_err());
        assert!(Picture::new(3, 3001, View::default()).png().is_err());
        let nowhere = View {
            azimuth: f64::NAN,
            ..View::default()
        };
        assert!(Picture::new(3, 3, nowhere).png().is_err());
    }
}

//! What is drawn over the shaded bodies: lines and points of bodies without triangles, and the marks of pairs.

use satisfice_collision::Mesh;
use tiny_skia::{Color, FillRule, Paint, Path, PathBuilder, Pixmap, Stroke, Transform};

use super::camera::Camera;
use super::raster::Raster;

/// A pair of points to be marked.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mark {
    pub(super) ends: [[f64; 3]; 2],
    pub(super) found: bool,
}

/// Radius of a mark in pixels, and of its white rim.
const RADIUS: f64 = 2.4;
const RIM: f64 = 3.4;
/// Opacity of a mark that a body hides.
const FAINT: f32 = 0.6;

/// Width of the line between the ends of a pair, in pixels.
const LINE: f32 = 2.0;

/// A pair in the picture: one point, or the two ends of a line where they are so far apart that their marks do not meet.
struct Placed {
    found: bool,
    hidden: bool,
    points: Vec<[f64; 3]>,
}

impl Placed {
    fn new(mark: &Mark, raster: &Raster, camera: &Camera) -> Self {
        let [a, b] = mark.ends.map(|end| camera.project(end));
        let is_long = (a[0] - b[0]).hypot(a[1] - b[1]) > 2.0 * RADIUS;
        Self {
            found: mark.found,
            // A pair lies between two surfaces: it counts as seen where one of its ends is.
            hidden: raster.hides(a, RADIUS) && raster.hides(b, RADIUS),
            points: match is_long {
                true => vec![a, b],
                false => vec![std::array::from_fn(|k| 0.5 * (a[k] + b[k]))],
            },
        }
    }
}

/// Marks pairs: those not found first, those found over them, each hidden ones first.
pub(super) fn pairs(pixmap: &mut Pixmap, marks: &[Mark], raster: &Raster, camera: &Camera) {
    let placed: Vec<_> = marks
        .iter()
        .map(|mark| Placed::new(mark, raster, camera))
        .collect();
    for (found, hidden) in [(false, true), (true, true), (false, false), (true, false)] {
        let chosen = || {
            placed
                .iter()
                .filter(move |mark| (mark.found, mark.hidden) == (found, hidden))
        };
        let points = || chosen().flat_map(|mark| mark.points.iter().copied());
        let opacity = if hidden { FAINT } else { 1.0 };
        let [red, green, blue] = if found { [0xd5, 0x5e, 0x00] } else { [0x00; 3] };
        let core = Color::from_rgba8(red, green, blue, (255.0 * opacity) as u8);
        let lines = || {
            let ends = chosen().filter_map(|mark| <&[_; 2]>::try_from(&mark.points[..]).ok());
            lines(ends.map(|ends| ends.map(|[x, y, _]| [x as f32, y as f32])))
        };
        if !hidden {
            stroke(pixmap, lines(), LINE + 2.0 * (RIM - RADIUS) as f32, Color::WHITE);
            fill(
                pixmap,
                discs(points(), if found { RIM } else { 0.85 * RIM }),
                Color::WHITE,
            );
        }
        stroke(pixmap, lines(), LINE, core);
        fill(
            pixmap,
            discs(points(), if found { RADIUS } else { 0.7 * RADIUS }),
            core,
        );
    }
}

/// A body without triangles: its edges, or its vertices.
pub(super) fn skeleton(pixmap: &mut Pixmap, mesh: &Mesh, tone: [f64; 3], camera: &Camera) {
    if !mesh.triangles().is_empty() {
        return;
    }
    let [red, green, blue] = tone.map(|t| (180.0 * t) as u8);
    let colour = Color::from_rgba8(red, green, blue, 255);
    if mesh.edges().is_empty() {
        let points = mesh.vertices().iter().map(|&p| camera.project(p));
        fill(pixmap, discs(points, 1.2), colour);
        return;
    }
    let ends = mesh.edges().iter().map(|edge| {
        edge.map(|v| {
            let [x, y, _] = camera.project(mesh.vertex(v));
            [x as f32, y as f32]
        })
    });
    stroke(pixmap, lines(ends), 0.8, colour);
}

/// Lines between points of the picture.
fn lines(ends: impl Iterator<Item = [[f32; 2]; 2]>) -> Option<Path> {
    let mut path = PathBuilder::new();
    for [a, b] in ends {
        path.move_to(a[0], a[1]);
        path.line_to(b[0], b[1]);
    }
    path.finish()
}

/// Discs of one radius about points of the picture.
fn discs(points: impl Iterator<Item = [f64; 3]>, radius: f64) -> Option<Path> {
    let mut path = PathBuilder::new();
    for [x, y, _] in points {
        path.push_circle(x as f32, y as f32, radius as f32);
    }
    path.finish()
}

fn fill(pixmap: &mut Pixmap, path: Option<Path>, colour: Color) {
    if let Some(path) = path {
        pixmap.fill_path(
            &path,
            &paint(colour),
            FillRule::Winding,
            Transform::identity(),
            None,
        );
    }
}

fn stroke(pixmap: &mut Pixmap, path: Option<Path>, width: f32, colour: Color) {
    if let Some(path) = path {
        let stroke = Stroke {
            width,
            ..Stroke::default()
        };
        pixmap.stroke_path(&path, &paint(colour), &stroke, Transform::identity(), None);
    }
}

fn paint(colour: Color) -> Paint<'static> {
    let mut paint = Paint {
        anti_alias: true,
        ..Paint::default()
    };
    paint.set_color(colour);
    paint
}

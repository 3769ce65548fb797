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

/// Marks pairs: those not found first, those found over them, each hidden ones first.
pub(super) fn pairs(pixmap: &mut Pixmap, marks: &[Mark], raster: &Raster, camera: &Camera) {
    let placed: Vec<_> = marks
        .iter()
        .map(|mark| {
            let [a, b] = mark.ends.map(|end| camera.project(end));
            let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
            // A pair lies between two surfaces: it counts as seen where one of its ends is.
            let hidden = raster.hides(a, RADIUS) && raster.hides(b, RADIUS);
            (mark.found, hidden, middle)
        })
        .collect();
    for (found, hidden) in [(false, true), (true, true), (false, false), (true, false)] {
        let chosen = || {
            placed
                .iter()
                .filter(move |mark| (mark.0, mark.1) == (found, hidden))
                .map(|mark| mark.2)
        };
        let opacity = if hidden { FAINT } else { 1.0 };
        let [red, green, blue] = if found { [0xd5, 0x5e, 0x00] } else { [0x00; 3] };
        let core = Color::from_rgba8(red, green, blue, (255.0 * opacity) as u8);
        if !hidden {
            fill(
                pixmap,
                discs(chosen(), if found { RIM } else { 0.85 * RIM }),
                Color::WHITE,
            );
        }
        fill(
            pixmap,
            discs(chosen(), if found { RADIUS } else { 0.7 * RADIUS }),
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
    let mut lines = PathBuilder::new();
    for edge in mesh.edges() {
        let [a, b] = edge.map(|v| camera.project(mesh.vertex(v)).map(|c| c as f32));
        lines.move_to(a[0], a[1]);
        lines.line_to(b[0], b[1]);
    }
    if let Some(path) = lines.finish() {
        let stroke = Stroke {
            width: 0.8,
            ..Stroke::default()
        };
        pixmap.stroke_path(&path, &paint(colour), &stroke, Transform::identity(), None);
    }
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

fn paint(colour: Color) -> Paint<'static> {
    let mut paint = Paint {
        anti_alias: true,
        ..Paint::default()
    };
    paint.set_color(colour);
    paint
}

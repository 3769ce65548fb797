//! Shaded triangles with a depth buffer, four samples a pixel.

use satisfice_collision::Mesh;
use tiny_skia::{Pixmap, PremultipliedColorU8};

use super::camera::{Camera, dot, unit};

/// Samples along each side of a pixel.
const SAMPLES: usize = 2;
/// Cosine of the angle above which two triangles meet in an edge that is shown as such.
const CREASE: f64 = 0.7;

/// Colour and nearness of every sample.
pub(super) struct Raster {
    width: usize,
    height: usize,
    nearness: Vec<f32>,
    colour: Vec<[u8; 3]>,
}

impl Raster {
    pub(super) fn new(width: u32, height: u32) -> Self {
        let [width, height] = [width, height].map(|n| n as usize * SAMPLES);
        Self {
            width,
            height,
            nearness: vec![f32::NEG_INFINITY; width * height],
            colour: vec![[255; 3]; width * height],
        }
    }

    /// Draws the triangles of a body, each in the tone that `tone_of` its number gives.
    pub(super) fn body(&mut self, mesh: &Mesh, tone_of: impl Fn(usize) -> [f64; 3], camera: &Camera) {
        let at: Vec<_> = mesh.vertices().iter().map(|&p| camera.project(p)).collect();
        let largest = mesh
            .vertices()
            .iter()
            .flatten()
            .fold(0.0_f64, |m, c| m.max(c.abs()));
        let faces: Vec<_> = mesh
            .triangles()
            .iter()
            .map(|corners| {
                normal(corners.map(|v| mesh.vertex(v).map(|c| c / largest.max(f64::MIN_POSITIVE))))
            })
            .collect();
        // Weighted by area: the cross products as they are.
        let mut smooth = vec![[0.0; 3]; at.len()];
        for (corners, face) in mesh.triangles().iter().zip(&faces) {
            for &v in corners {
                for (sum, c) in smooth[v as usize].iter_mut().zip(face) {
                    *sum += c;
                }
            }
        }
        let light = camera.light();
        for (t, (corners, face)) in mesh.triangles().iter().zip(&faces).enumerate() {
            let Some(face) = unit(*face) else { continue };
            let shades = corners.map(|v| {
                let round = unit(smooth[v as usize]).filter(|n| dot(n, &face) > CREASE);
                shade(&round.unwrap_or(face), &light, &camera.towards)
            });
            self.triangle(corners.map(|v| at[v as usize]), shades, tone_of(t));
        }
    }

    /// Fills a triangle whose brightness is linear between its corners.
    fn triangle(&mut self, corners: [[f64; 3]; 3], shades: [f64; 3], tone: [f64; 3]) {
        let [a, b, c] = corners.map(|[x, y, _]| [x * SAMPLES as f64, y * SAMPLES as f64]);
        let doubled_area = cross(a, b, c);
        if doubled_area == 0.0 || !doubled_area.is_finite() {
            return;
        }
        let range = |k: usize, end: usize| {
            let low = a[k].min(b[k]).min(c[k]).floor().clamp(0.0, end as f64) as usize;
            let high = a[k].max(b[k]).max(c[k]).ceil().clamp(0.0, end as f64) as usize;
            low..high
        };
        let columns = range(0, self.width);
        for y in range(1, self.height) {
            for x in columns.clone() {
                let p = [x as f64 + 0.5, y as f64 + 0.5];
                let weights = [cross(p, b, c), cross(a, p, c), cross(a, b, p)].map(|w| w / doubled_area);
                if weights.iter().any(|&w| w < 0.0) {
                    continue;
                }
                let nearness = (0..3).map(|k| weights[k] * corners[k][2]).sum::<f64>() as f32;
                let index = y * self.width + x;
                if nearness > self.nearness[index] {
                    let bright = (0..3).map(|k| weights[k] * shades[k]).sum::<f64>();
                    self.nearness[index] = nearness;
                    self.colour[index] = tone.map(|t| (255.0 * t * bright).clamp(0.0, 255.0) as u8);
                }
            }
        }
    }

    /// Whether a point of the picture lies behind what is drawn there, by more than `slack` pixels.
    pub(super) fn hides(&self, [x, y, nearness]: [f64; 3], slack: f64) -> bool {
        let (x, y) = (x * SAMPLES as f64, y * SAMPLES as f64);
        if !(x >= 0.0 && y >= 0.0 && x < self.width as f64 && y < self.height as f64) {
            return false;
        }
        f64::from(self.nearness[y as usize * self.width + x as usize]) > nearness + slack
    }

    /// The picture so far: the mean of each pixel's samples. `None` if there is no memory for it.
    pub(super) fn pixmap(&self) -> Option<Pixmap> {
        let (width, height) = (self.width / SAMPLES, self.height / SAMPLES);
        let mut pixmap = Pixmap::new(width as u32, height as u32)?;
        for (index, pixel) in pixmap.pixels_mut().iter_mut().enumerate() {
            let (x, y) = (index % width * SAMPLES, index / width * SAMPLES);
            let mut sum = [0_usize; 3];
            for row in y..y + SAMPLES {
                for sample in &self.colour[row * self.width + x..][..SAMPLES] {
                    for (sum, &c) in sum.iter_mut().zip(sample) {
                        *sum += usize::from(c);
                    }
                }
            }
            let [r, g, b] = sum.map(|c| (c / (SAMPLES * SAMPLES)) as u8);
            *pixel = PremultipliedColorU8::from_rgba(r, g, b, 255)?;
        }
        Some(pixmap)
    }
}

/// Brightness of a surface of either orientation: ambient and diffuse light, darker towards the outline.
fn shade(normal: &[f64; 3], light: &[f64; 3], towards: &[f64; 3]) -> f64 {
    let facing = dot(normal, towards);
    let diffuse = (dot(normal, light) * facing.signum()).max(0.0);
    (0.5 + 0.55 * diffuse) * (0.72 + 0.28 * facing.abs().sqrt())
}

/// Normal of a triangle, as long as twice its area.
fn normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let u: [f64; 3] = std::array::from_fn(|k| b[k] - a[k]);
    let v: [f64; 3] = std::array::from_fn(|k| c[k] - a[k]);
    [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ]
}

/// Twice the signed area of a triangle of the plane.
fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

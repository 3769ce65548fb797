//! Parallel projection: where a point of the scene lies on the picture.

use super::View;

/// Share of the width or height that the scene takes.
const ROOM: f64 = 0.92;

/// A direction of view with a scale that fits.
#[derive(Debug, Clone, Copy)]
pub(super) struct Camera {
    right: [f64; 3],
    up: [f64; 3],
    /// From the scene to the eye.
    pub(super) towards: [f64; 3],
    unit: f64,
    scale: f64,
    /// What lies in the middle of the picture, in units of the scene, and that middle in pixels.
    centre: [f64; 2],
    middle: [f64; 2],
}

impl Camera {
    /// Shows all of `framed` on a picture of `size` pixels, with a margin. `unit` is the largest
    /// coordinate of the scene.
    pub(super) fn new(view: &View, framed: &[[f64; 3]], unit: f64, size: [f64; 2]) -> Self {
        let (sin_a, cos_a) = view.azimuth.to_radians().sin_cos();
        let (sin_e, cos_e) = view.elevation.to_radians().sin_cos();
        let mut camera = Self {
            right: view.up.turn([-sin_a, cos_a, 0.0]),
            up: view.up.turn([-sin_e * cos_a, -sin_e * sin_a, cos_e]),
            towards: view.up.turn([cos_e * cos_a, cos_e * sin_a, sin_e]),
            unit,
            scale: 1.0,
            centre: [0.0; 2],
            middle: [0.0; 2],
        };
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in framed {
            let [x, y, _] = camera.project(*point);
            for (k, c) in [x, y].into_iter().enumerate() {
                low[k] = low[k].min(c);
                high[k] = high[k].max(c);
            }
        }
        if framed.is_empty() {
            (low, high) = ([0.0; 2], [0.0; 2]);
        }
        let fit = |k: usize| ROOM * size[k] / (high[k] - low[k]).max(1e-9);
        camera.centre = [0, 1].map(|k| 0.5 * (low[k] + high[k]));
        camera.middle = size.map(|s| 0.5 * s);
        camera.scale = fit(0).min(fit(1));
        camera
    }

    /// Pixels to the right and downwards from the upper left corner, and the nearness to the eye in units of a pixel.
    pub(super) fn project(&self, point: [f64; 3]) -> [f64; 3] {
        let p = point.map(|c| c / self.unit);
        let along = |axis: &[f64; 3]| axis.iter().zip(&p).map(|(a, c)| a * c).sum::<f64>();
        [
            (along(&self.right) - self.centre[0]) * self.scale + self.middle[0],
            (-along(&self.up) - self.centre[1]) * self.scale + self.middle[1],
            along(&self.towards) * self.scale,
        ]
    }

    /// A direction at unit length from above the left shoulder: the light.
    pub(super) fn light(&self) -> [f64; 3] {
        let direction: [f64; 3] =
            std::array::from_fn(|k| self.towards[k] + 0.7 * self.up[k] - 0.5 * self.right[k]);
        unit(direction).unwrap_or(self.towards)
    }
}

/// `v` at length 1, `None` if it has no direction.
pub(super) fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(&v, &v).sqrt();
    (length > 0.0 && length.is_finite()).then(|| v.map(|c| c / length))
}

pub(super) fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

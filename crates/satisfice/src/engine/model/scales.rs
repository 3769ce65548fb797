//! Parameters of the covariance.

use super::kernel::Feature;
use super::lanes::{LANES, Lanes};
use super::units::Shape;

/// Length scales, as shares of the axes, and noise, as a share of the variance of F.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scales {
    /// The logarithms of the length scales, then of the noise.
    pub(super) logs: Vec<f64>,
    /// Of each axis.
    pub(super) shapes: Vec<Shape>,
}

/// Natural logarithms between which length scales are sought: 0.02 to 20 axes.
const LENGTHS: (f64, f64) = (-3.9, 3.0);
/// The same of the noise: 1e-7 to 0.1 of the variance.
const NOISES: (f64, f64) = (-16.1, -2.3);
/// Deviation of the prior of the logarithm of a length scale.
const LENGTH_DEVIATION: f64 = 1.2;
/// Mean and deviation of the prior of the logarithm of the noise.
const NOISE_PRIOR: (f64, f64) = (-13.0, 4.0);

impl Scales {
    /// The mean of the prior for this many axes: half an axis in one dimension, and in proportion to the length of a cube's
    /// diagonal in more.
    pub(super) fn new(shapes: Vec<Shape>) -> Self {
        let axes = shapes.len();
        let mut logs = vec![prior_length(axes); axes];
        logs.push(NOISE_PRIOR.0);
        Self { logs, shapes }
    }

    /// The coordinates in which squared distances are sums over features. A point of a circle is a point of the plane (the
    /// periodic kernel of MacKay 1998, Introduction to Gaussian Processes, Eq. 47), with the distance along the chord.
    pub(super) fn features(&self) -> Vec<Feature> {
        let mut features = Vec::with_capacity(self.axes());
        for (j, shape) in self.shapes.iter().enumerate() {
            match shape {
                Shape::Line | Shape::Place(_) => features.push(Feature::Number { axis: j }),
                Shape::Circle => features.extend([Feature::Number { axis: j }; 2]),
                Shape::Category => features.push(Feature::Category {
                    axis: j,
                    square: self.length(j).powi(-2),
                }),
            }
        }
        features
    }

    /// The features of points, 16 at a time.
    pub(super) fn scaled(&self, units: &[Lanes]) -> Vec<Lanes> {
        let mut scaled = Vec::with_capacity(units.len());
        for ((lanes, shape), log) in units.iter().zip(&self.shapes).zip(&self.logs) {
            let inverse = 1.0 / log.exp();
            match shape {
                Shape::Line | Shape::Place(_) => scaled.push(lanes.map(|x| x * inverse)),
                Shape::Category => scaled.push(*lanes),
                Shape::Circle => {
                    let radius = inverse / core::f64::consts::TAU;
                    let angles = lanes.map(|x| (x * core::f64::consts::TAU).sin_cos());
                    scaled.push(angles.map(|(_, cosine)| radius * cosine));
                    scaled.push(angles.map(|(sine, _)| radius * sine));
                }
            }
        }
        scaled
    }

    /// The features of one point.
    pub(super) fn scaled_point(&self, units: &[f64]) -> Vec<f64> {
        let lanes: Vec<Lanes> = units.iter().map(|&x| [x; LANES]).collect();
        self.scaled(&lanes).iter().map(|lanes| lanes[0]).collect()
    }

    pub(super) fn axes(&self) -> usize {
        self.logs.len() - 1
    }

    /// Length scale of axis `j`.
    pub(super) fn length(&self, j: usize) -> f64 {
        self.logs[j].exp()
    }

    pub(super) fn noise(&self) -> f64 {
        self.logs[self.axes()].exp()
    }

    /// Moves parameter `k` by `step`, within its bounds.
    pub(super) fn shift(&mut self, k: usize, step: f64) {
        let (low, high) = if k < self.axes() { LENGTHS } else { NOISES };
        self.logs[k] = (self.logs[k] + step).clamp(low, high);
    }

    /// The negative logarithm of the prior up to a constant; adds its derivatives to `gradient`.
    pub(super) fn prior(&self, gradient: &mut [f64]) -> f64 {
        let axes = self.axes();
        let mut sum = 0.0;
        for (k, (x, slope)) in self.logs.iter().zip(gradient).enumerate() {
            let (mean, deviation) = if k < axes {
                (prior_length(axes), LENGTH_DEVIATION)
            } else {
                NOISE_PRIOR
            };
            let d = (x - mean) / deviation;
            sum += d * d / 2.0;
            *slope += d / deviation;
        }
        sum
    }
}

#[expect(clippy::cast_precision_loss, reason = "a number of axes")]
fn prior_length(axes: usize) -> f64 {
    0.5_f64.ln() + (axes.max(1) as f64).ln() / 2.0
}

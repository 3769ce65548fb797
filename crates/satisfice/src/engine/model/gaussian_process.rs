//! The model on its own: for pictures and for checks.

use super::lanes::LANES;
use super::likelihood::likeliest;
use super::process::{Block, Process};
use super::scales::Scales;
use super::units::Shape;

/// A Gaussian process through points of the unit cube, with a Matérn 5/2 kernel and the length scales that are likeliest: the
/// model of the engine [`Surrogate`](super::Surrogate).
///
/// ```
/// use satisfice::engine::GaussianProcess;
///
/// let points: Vec<f64> = (0..=10).map(|i| f64::from(i) / 10.0).collect();
/// let values: Vec<f64> = points.iter().map(|x| (5.0 * x).sin()).collect();
/// let model = GaussianProcess::fit(1, &points, &values).expect("one value for each point");
/// let (mean, variance) = model.predict(&[0.55]);
/// assert!((mean - (5.0_f64 * 0.55).sin()).abs() < 0.01 && variance < 1e-3);
/// ```
#[derive(Debug, Clone)]
pub struct GaussianProcess {
    process: Process,
}

/// Steps of the likelihood's ascent.
const STEPS: usize = 60;

impl GaussianProcess {
    /// Fits length scales, noise, mean and variance. `points` holds `axes` coordinates for each value, about 0 to 1. Cost:
    /// O(n³) for n points.
    ///
    /// `None` without points or axes, where the lengths do not fit, or where a number is not finite.
    #[must_use]
    pub fn fit(axes: usize, points: &[f64], values: &[f64]) -> Option<Self> {
        let finite = points.iter().chain(values).all(|x| x.is_finite());
        if axes == 0 || values.is_empty() || points.len() != axes * values.len() || !finite {
            return None;
        }
        let inputs: Vec<&[f64]> = points.chunks_exact(axes).collect();
        let values = [values.to_vec()];
        let scales = likeliest(
            &Scales::new(vec![Shape::Line; axes]),
            &inputs,
            &values,
            STEPS,
            &|| false,
        );
        Some(Self {
            process: Process::new(scales, &inputs, &values),
        })
    }

    /// Mean and variance of F at a point. Cost: O(n²).
    ///
    /// # Panics
    /// If the point does not have a coordinate for each axis.
    #[must_use]
    pub fn predict(&self, point: &[f64]) -> (f64, f64) {
        assert_eq!(
            point.len(),
            self.process.scales.axes(),
            "a coordinate for each axis"
        );
        let mut block = Block::new(point.iter().map(|&x| [x; LANES]).collect());
        self.process.update(&mut block);
        let (means, variances) = self.process.predictions(&block, 0);
        (means[0], variances[0])
    }

    /// Length scale of each axis, as a share of it.
    #[must_use]
    pub fn lengths(&self) -> Vec<f64> {
        (0..self.process.scales.axes())
            .map(|j| self.process.scales.length(j))
            .collect()
    }
}

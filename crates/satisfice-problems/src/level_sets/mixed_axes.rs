//! Windows of good settings on categorical, logarithmic, periodic and integer axes at once.

use std::f64::consts::TAU;

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Axis, Encoding, Error, SatisficingProblem, Space};

use crate::lattice::{ENUMERABLE, description};

/// Range of the rate.
const RATES: (f64, f64) = (1e-3, 1e3);
/// Layers.
const LAYERS: u32 = 24;
/// Every so many categories has a window.
const EVERY: usize = 3;

/// The good settings of a process of some *kind*, with a *rate* over six decades, an *angle* on a circle, and a number of
/// *layers*:
///
/// F = max(|log10(rate / rate_k)| / 3, angle between angle and angle_k / pi, |layers - layers_k| / 24) < delta
///
/// where kind k has its own best rate, angle and layers, drawn by `instance`. Kinds have no order, and only every third has a
/// window: for the others F is larger by 1. What counts as distinct is a cell: the rate in `cells` equal parts of its logarithm, the angle
/// in `cells` parts of the circle; F is that of the cell's centre. The space is mixed: a categorical axis, a logarithmic one, a
/// periodic one, an integer one.
///
/// ```
/// use satisfice::{Budget, Search};
/// use satisfice::catalogue::Catalogued;
/// let problem = satisfice_problems::MixedAxes::new(12, 60, 0.04, 1)?;
/// let report = Search::new().run(&problem, &Budget::evaluations(30_000))?;
/// assert!(report.hit_count() as u64 > problem.reference_hits().unwrap_or(0) / 2);
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct MixedAxes {
    space: Space<f64>,
    threshold: f64,
    description: Description,
    cells: u32,
    windows: Vec<BestSettings>,
}

/// The best settings of a kind.
#[derive(Debug, Clone, Copy)]
struct BestSettings {
    /// Shares of the axes of rate and angle.
    rate: f64,
    angle: f64,
    layers: f64,
    /// Added to F.
    offset: f64,
}

impl MixedAxes {
    /// `kinds` kinds, `cells` cells of rate and of angle, windows of half-width `threshold`.
    ///
    /// # Errors
    /// [`Error::Bounds`] without kinds; [`Error::Parameter`] without cells; [`Error::Threshold`] for NaN.
    pub fn new(kinds: u32, cells: u32, threshold: f64, instance: u64) -> Result<Self, Error> {
        if threshold.is_nan() {
            return Err(Error::Threshold);
        }
        if cells == 0 {
            return Err(Error::parameter("cells", cells, "a whole number from 1 on"));
        }
        let mut rng = super::instance_rng(instance);
        let windows = (0..kinds as usize).map(|kind| BestSettings {
            rate: rng.uniform(),
            angle: rng.uniform(),
            layers: rng.below(LAYERS as usize) as f64,
            offset: if kind % EVERY == instance as usize % EVERY {
                0.0
            } else {
                1.0
            },
        });
        Ok(Self {
            windows: windows.collect(),
            space: Space::new([
                Axis::categorical(kinds),
                Axis::continuous(RATES.0, RATES.1).logarithmic(),
                Axis::continuous(0.0, TAU).periodic(),
                Axis::integer(1, i64::from(LAYERS)),
            ])?,
            threshold,
            description: description(
                Self::NAME,
                [
                    ("kinds", kinds.to_string()),
                    ("cells", cells.to_string()),
                    ("threshold", threshold.to_string()),
                    ("instance", instance.to_string()),
                ],
            ),
            cells,
        })
    }

    /// Share of its axis that a cell's centre has.
    fn centre(&self, cell: u32) -> f64 {
        (f64::from(cell) + 0.5) / f64::from(self.cells)
    }

    /// The cell of a share of an axis.
    fn cell(&self, share: f64) -> u32 {
        ((share * f64::from(self.cells)) as u32).min(self.cells - 1)
    }

    /// Kind, rate, angle and layers of a solution, in the units of the space; `None` if it is none.
    #[must_use]
    pub fn settings(&self, solution: &[u32; 4]) -> Option<[f64; 4]> {
        let [kind, rate, angle, layer] = *solution;
        let inside = (kind as usize) < self.windows.len() && rate.max(angle) < self.cells && layer < LAYERS;
        let (low, high) = (RATES.0.ln(), RATES.1.ln());
        inside.then(|| {
            [
                f64::from(kind),
                (low + (high - low) * self.centre(rate)).exp(),
                TAU * self.centre(angle),
                f64::from(layer + 1),
            ]
        })
    }
}

impl SatisficingProblem for MixedAxes {
    type Scalar = f64;
    /// Kind, cell of the rate, cell of the angle, layers - 1.
    type Solution = [u32; 4];

    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> [u32; 4] {
        let (low, high) = (RATES.0.ln(), RATES.1.ln());
        [
            values[0] as u32,
            self.cell((values[1].ln() - low) / (high - low)),
            self.cell(values[2] / TAU),
            (values[3] - 1.0) as u32,
        ]
    }
    fn fitness(&self, solution: &[u32; 4]) -> f64 {
        let [kind, rate, angle, layer] = *solution;
        let Some(window) = self.windows.get(kind as usize) else {
            return f64::NAN;
        };
        if rate.max(angle) >= self.cells || layer >= LAYERS {
            return f64::NAN;
        }
        let around = (self.centre(angle) - window.angle).abs();
        let layers = (f64::from(layer) - window.layers).abs() / f64::from(LAYERS);
        let rate = (self.centre(rate) - window.rate).abs() * 2.0;
        rate.max(2.0 * around.min(1.0 - around)).max(layers) + window.offset
    }
    fn threshold(&self) -> f64 {
        self.threshold
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, [u32; 4]>> {
        Some(self)
    }
    fn description(&self) -> Description {
        self.description.clone()
    }
}

impl Encoding<f64, [u32; 4]> for MixedAxes {
    fn encode(&self, solution: &[u32; 4], values: &mut [f64]) -> bool {
        let settings = self.settings(solution);
        if let Some(settings) = settings.filter(|settings| settings.len() == values.len()) {
            values.copy_from_slice(&settings);
        }
        settings.is_some()
    }
}

impl Catalogued for MixedAxes {
    const NAME: &'static str = "mixed-axes";
    const SUMMARY: &'static str =
        "good settings on a categorical, a logarithmic, a periodic and an integer axis at once";
    const SOURCE: &'static str = "this project; counts by enumeration of the cells";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer(
            "kinds",
            "categories, of which every third has a window",
            12,
            1,
            1000,
        ),
        Parameter::integer("cells", "cells of the rate and of the angle", 60, 1, 10_000),
        Parameter::real("threshold", "half-width of a window, delta", 0.1, 0.0, 2.0),
        Parameter::integer("instance", "which windows", 0, 0, i64::MAX),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(
            params.count("kinds") as u32,
            params.count("cells") as u32,
            params.real("threshold"),
            params.count("instance") as u64,
        )
    }

    /// By visiting every cell, where there are at most 2 * 10^7.
    fn reference_hits(&self) -> Option<u64> {
        let (kinds, cells) = (self.windows.len() as u32, self.cells);
        let all = f64::from(kinds) * f64::from(cells).powi(2) * f64::from(LAYERS);
        if all > ENUMERABLE {
            return None;
        }
        let mut hits = 0;
        for kind in 0..kinds {
            for rate in 0..cells {
                for angle in 0..cells {
                    let layers = (0..LAYERS).map(|layer| self.fitness(&[kind, rate, angle, layer]));
                    hits += layers.filter(|f| *f < self.threshold).count() as u64;
                }
            }
        }
        Some(hits)
    }
}

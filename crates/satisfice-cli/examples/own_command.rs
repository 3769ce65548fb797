//! The whole command for a problem of your own: `list`, `run`, `bench` and `verify` know it by its name.
//!
//! `cargo run --release -p satisfice-cli --example own_command -- run gear-trains --time 100ms --json report.json`

use std::process::ExitCode;

use satisfice::catalogue::{Catalogued, Parameter, Params};
use satisfice::{Axis, Error, SatisficingProblem, Space};

/// Four gears whose ratio is near a given one, as in the example `getting_started`.
pub(crate) struct GearTrains {
    space: Space<f64>,
    ratio: f64,
}

impl SatisficingProblem for GearTrains {
    type Scalar = f64;
    type Solution = [u32; 4];

    fn space(&self) -> &Space<f64> {
        &self.space
    }

    fn decode(&self, teeth: &[f64]) -> [u32; 4] {
        [0, 1, 2, 3].map(|gear| teeth[gear] as u32)
    }

    fn fitness(&self, &[a, b, c, d]: &[u32; 4]) -> f64 {
        (f64::from(a * b) / f64::from(c * d) - self.ratio).abs()
    }

    fn threshold(&self) -> f64 {
        1e-6
    }
}

impl Catalogued for GearTrains {
    const NAME: &'static str = "gear-trains";
    const SUMMARY: &'static str = "four gears of 12 to 60 teeth near a ratio";
    const SOURCE: &'static str = "after Sandgren 1990, doi 10.1115/1.2912596";
    const PARAMETERS: &'static [Parameter] = &[Parameter::real(
        "ratio",
        "the ratio wanted",
        1.0 / 6.931,
        0.04,
        25.0,
    )];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Ok(Self {
            space: Space::new([12, 12, 12, 12].map(|least| Axis::integer(least, 60)))?,
            ratio: params.real("ratio"),
        })
    }
}

pub(crate) fn main() -> ExitCode {
    satisfice_cli::Command::new().problem::<GearTrains>().main()
}

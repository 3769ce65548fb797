//! A car with an automatic transmission that must keep to its specification.

use core::f64::consts::PI;

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, SatisficingProblem};

use super::temporal_logic::{Specification, Trace};
use crate::lattice::{ENUMERABLE, Lattice, count_hits, description, lattice_methods};

/// Parts of the manoeuvre with constant throttle, and with constant brake.
const THROTTLES: usize = 4;
const BRAKES: usize = 2;
/// Steps and their length in seconds: 30 s.
const STEPS: usize = 300;
const STEP: f64 = 0.1;
const RATIOS: [f64; 4] = [2.393, 1.450, 1.0, 0.677];
const FINAL: f64 = 3.23;
/// Wheel radius in m, mass in kg, drag in N s^2 / m^2, rolling resistance in N, largest braking force in N.
const WHEEL: f64 = 0.3;
const MASS: f64 = 1500.0;
const DRAG: f64 = 0.6;
const ROLLING: f64 = 180.0;
const BRAKE: f64 = 6000.0;
const IDLE: f64 = 800.0;

const SPECIFICATIONS: &[&str] = &["speed", "engine", "calm-start", "late-gear"];

/// All manoeuvres of a car with automatic transmission that falsify a specification in signal temporal logic.
///
/// Inputs are the throttle on 4 equal parts of 30 s, at m levels from shut to full, and the brake on 2 parts, at 4 levels from
/// none to full. Signals are speed v in km/h, engine speed w in 1/min and gear. The torque of the engine at throttle u is
/// 200 u (1 - (w / 6500)^2) N m. The gear goes up above w = 2600 + 2200 u, down below 1100 + 900 u, and by one gear a second
/// at most. Drag, rolling resistance and brake oppose it. Euler steps of 0.1 s. Specifications:
///
/// - `speed`: always v < 110,
/// - `engine`: always w < 4780,
/// - `calm-start`: if always w < 3200, then always in the first 8 s v < 40,
/// - `late-gear`: gear < 4 until, within 20 s, v > 100, or never gear 4.
///
/// F is the robustness, in the units of the signals; a hit is F < 0. Hits in different cells of inputs are distinct.
///
/// Source: after Hoxha, Abbas, Fainekos 2014, Benchmarks for temporal logic requirements for automotive systems (ARCH), with
/// a simpler engine; counts by enumeration.
///
/// ```
/// use satisfice_problems::Transmission;
/// let problem = Transmission::new("speed", 5)?;
/// let coasting = problem.trace(&[0; 6]).unwrap(); // throttle shut, brake off
/// assert!(coasting.signals()[0].iter().all(|&v| v < 110.0));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Transmission {
    lattice: Lattice,
    threshold: f64,
    description: Description,
    specification: Specification,
    levels: usize,
}

impl Transmission {
    /// Manoeuvres with `levels` levels of the throttle that falsify the specification of this name.
    ///
    /// # Errors
    /// [`Error::Unknown`] for an unknown name, [`Error::Parameter`] for fewer than 2 levels.
    pub fn new(specification: &str, levels: usize) -> Result<Self, Error> {
        if !(2..=1000).contains(&levels) {
            return Err(Error::parameter(
                "levels",
                levels,
                "a whole number from 2 to 1000",
            ));
        }
        let all = 0..=STEPS;
        let formula = match specification {
            "speed" => Specification::below(0, 110.0).always(all),
            "engine" => Specification::below(1, 4780.0).always(all),
            "calm-start" => {
                let calm = Specification::below(1, 3200.0).always(all);
                calm.implies(Specification::below(0, 40.0).always(0..=80))
            }
            "late-gear" => {
                let low = Specification::below(2, 3.5);
                low.clone()
                    .until(Specification::above(0, 100.0), 0..=200)
                    .or(low.always(all))
            }
            _ => {
                return Err(Error::unknown(
                    "specification",
                    specification,
                    SPECIFICATIONS.iter().copied(),
                ));
            }
        };
        let cells = core::iter::repeat_n(levels, THROTTLES).chain([4; BRAKES]);
        Ok(Self {
            lattice: Lattice::new(cells)?,
            threshold: 0.0,
            description: description(
                Self::NAME,
                [
                    ("specification", specification.to_owned()),
                    ("levels", levels.to_string()),
                ],
            ),
            specification: formula,
            levels,
        })
    }

    /// Speed, engine speed and gear after each step; `None` if they are not cells of this problem.
    #[must_use]
    pub fn trace(&self, cells: &[u32]) -> Option<Trace> {
        if !self.lattice.holds(cells) {
            return None;
        }
        let (throttles, brakes) = cells.split_at(THROTTLES);
        let mut signals: Vec<Vec<f64>> = (0..3).map(|_| Vec::with_capacity(STEPS)).collect();
        let (mut speed, mut gear, mut shifted) = (0.0_f64, 0, 0);
        for step in 0..STEPS {
            let throttle = f64::from(throttles[step * THROTTLES / STEPS]) / (self.levels - 1) as f64;
            let brake = f64::from(brakes[step * BRAKES / STEPS]) / 3.0;
            let turns = |gear: usize| (speed / WHEEL * RATIOS[gear] * FINAL * 30.0 / PI).max(IDLE);
            if step >= shifted + 10 {
                let before = gear;
                if turns(gear) > 2600.0 + 2200.0 * throttle && gear < 3 {
                    gear += 1;
                } else if turns(gear) < 1100.0 + 900.0 * throttle && gear > 0 {
                    gear -= 1;
                }
                if gear != before {
                    shifted = step;
                }
            }
            let engine = turns(gear);
            let torque = 200.0 * throttle * (1.0 - (engine / 6500.0) * (engine / 6500.0));
            let force =
                torque * RATIOS[gear] * FINAL / WHEEL - DRAG * speed * speed - ROLLING - BRAKE * brake;
            speed = (speed + STEP * force / MASS).max(0.0);
            signals[0].push(3.6 * speed);
            signals[1].push(engine);
            signals[2].push((gear + 1) as f64);
        }
        Trace::new(signals).ok()
    }
}

impl SatisficingProblem for Transmission {
    lattice_methods!();

    fn fitness(&self, cells: &Vec<u32>) -> f64 {
        self.trace(cells)
            .map_or(f64::NAN, |trace| self.specification.robustness(&trace))
    }
}

impl Catalogued for Transmission {
    const NAME: &'static str = "transmission";
    const SUMMARY: &'static str =
        "manoeuvres of a car with automatic transmission that falsify a specification";
    const SOURCE: &'static str = "after Hoxha, Abbas, Fainekos 2014 (ARCH benchmarks); counts by enumeration";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::choice(
            "specification",
            "what has to be falsified",
            "speed",
            SPECIFICATIONS,
        ),
        Parameter::integer("levels", "levels of the throttle, m", 10, 2, 1000),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(params.text("specification"), params.count("levels"))
    }

    fn reference_hits(&self) -> Option<u64> {
        count_hits(self, ENUMERABLE)
    }
}

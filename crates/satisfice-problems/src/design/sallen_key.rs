//! A filter made of standard parts.

use core::f64::consts::TAU;

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, SatisficingProblem};

use crate::lattice::{ENUMERABLE, Lattice, count_hits, description, lattice_methods};

/// Preferred numbers of IEC 60063.
const E24: [f64; 24] = [
    1.0, 1.1, 1.2, 1.3, 1.5, 1.6, 1.8, 2.0, 2.2, 2.4, 2.7, 3.0, 3.3, 3.6, 3.9, 4.3, 4.7, 5.1, 5.6, 6.2, 6.8,
    7.5, 8.2, 9.1,
];
const E12: [f64; 12] = [1.0, 1.2, 1.5, 1.8, 2.2, 2.7, 3.3, 3.9, 4.7, 5.6, 6.8, 8.2];
/// The published quality, four digits of 1 / sqrt 2.
#[expect(
    clippy::approx_constant,
    reason = "the published window has these four digits"
)]
const BUTTERWORTH: f64 = 0.7071;
const DECADES: usize = 3;
/// Hits of the default parameters, by `--example enumerate`.
const PUBLISHED_HITS: u64 = 138;

/// All designs of a Sallen-Key low-pass filter of unity gain, from standard parts, inside a window around the wanted
/// corner frequency and quality:
///
/// F = max(|ln(f0 / f)| / t_f, |ln(Q / q)| / t_q) < 1,
/// f0 = 1 / (2 pi sqrt(R1 R2 C1 C2)), Q = sqrt(R1 R2 C1 C2) / (C2 (R1 + R2)).
///
/// R1, R2 are E24 values over three decades from 1 kilohm, C1, C2 are E12 values over three decades from 1 nanofarad:
/// 72^2 x 36^2 lattice points in the order of the parts' values. A hit is a choice of parts.
///
/// Source: Sallen, Key 1955, doi 10.1109/TCT.1955.6500159; part series: IEC 60063.
///
/// ```
/// use satisfice::SatisficingProblem;
/// use satisfice_problems::{SallenKey, Window};
/// let problem = SallenKey::new(Window::default())?;
/// let parts = problem.parts(&[0, 0, 0, 0]).unwrap();
/// assert_eq!((parts.resistances, parts.capacitances), ([1e3; 2], [1e-9; 2]));
/// assert!(problem.fitness(&vec![0, 0, 0, 0]) > 1.0); // 159 kHz instead of 1 kHz
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct SallenKey {
    lattice: Lattice,
    threshold: f64,
    description: Description,
    window: Window,
    resistors: Vec<f64>,
    capacitors: Vec<f64>,
}

/// The specification of a [`SallenKey`] filter.
///
/// ```
/// use satisfice_problems::Window;
/// let audio = Window { frequency: 20e3, ..Window::default() };
/// assert_eq!(audio.quality, 0.7071);
/// # let _ = audio;
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Corner frequency in Hz, f.
    pub frequency: f64,
    /// Quality, q.
    pub quality: f64,
    /// Tolerance of the frequency as a natural logarithm, t_f.
    pub frequency_tolerance: f64,
    /// Tolerance of the quality as a natural logarithm, t_q.
    pub quality_tolerance: f64,
}

/// 1 kHz within 1 %, 0.7071 within 2 %: a Butterworth filter.
impl Default for Window {
    fn default() -> Self {
        Self {
            frequency: 1e3,
            quality: BUTTERWORTH,
            frequency_tolerance: 0.01,
            quality_tolerance: 0.02,
        }
    }
}

/// A choice of parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parts {
    /// Resistance of R1 and R2 in ohm.
    pub resistances: [f64; 2],
    /// Capacitance of C1 and C2 in farad.
    pub capacitances: [f64; 2],
}

impl Parts {
    /// The corner frequency f0 in Hz.
    #[must_use]
    pub fn frequency(&self) -> f64 {
        1.0 / (TAU * self.root())
    }
    /// The quality Q.
    #[must_use]
    pub fn quality(&self) -> f64 {
        self.root() / (self.capacitances[1] * (self.resistances[0] + self.resistances[1]))
    }
    fn root(&self) -> f64 {
        let ([r1, r2], [c1, c2]) = (self.resistances, self.capacitances);
        (r1 * r2 * c1 * c2).sqrt()
    }
}

impl SallenKey {
    /// The designs inside `window`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a number of the window is not positive and finite.
    pub fn new(window: Window) -> Result<Self, Error> {
        let parameters = [
            ("frequency", window.frequency),
            ("quality", window.quality),
            ("frequency-tolerance", window.frequency_tolerance),
            ("quality-tolerance", window.quality_tolerance),
        ];
        for (name, value) in parameters {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::parameter(name, value, "a number above 0"));
            }
        }
        let series = |values: &[f64], unit: f64| -> Vec<f64> {
            (0..DECADES)
                .flat_map(|decade| {
                    values
                        .iter()
                        .map(move |value| value * unit * 10_f64.powi(decade as i32))
                })
                .collect()
        };
        let (resistors, capacitors) = (series(&E24, 1e3), series(&E12, 1e-9));
        let (r, c) = (resistors.len(), capacitors.len());
        Ok(Self {
            lattice: Lattice::new([r, r, c, c])?,
            threshold: 1.0,
            description: description(
                Self::NAME,
                parameters.map(|(name, value)| (name, value.to_string())),
            ),
            window,
            resistors,
            capacitors,
        })
    }

    /// The parts of a solution (R1, R2, C1, C2); `None` if they are not cells of this problem.
    #[must_use]
    pub fn parts(&self, cells: &[u32]) -> Option<Parts> {
        let &[r1, r2, c1, c2] = cells else { return None };
        let resistor = |cell: u32| self.resistors.get(cell as usize).copied();
        let capacitor = |cell: u32| self.capacitors.get(cell as usize).copied();
        Some(Parts {
            resistances: [resistor(r1)?, resistor(r2)?],
            capacitances: [capacitor(c1)?, capacitor(c2)?],
        })
    }
}

/// The logarithms of frequency and quality by those of the window, by their tolerances and the threshold.
impl satisfice::Components<f64, Vec<u32>> for SallenKey {
    fn count(&self) -> usize {
        2
    }

    fn write(&self, cells: &Vec<u32>, components: &mut [f64]) {
        let Some(parts) = self.parts(cells) else {
            return components.fill(f64::NAN);
        };
        let window = &self.window;
        let frequency = (parts.frequency() / window.frequency).ln() / window.frequency_tolerance;
        let quality = (parts.quality() / window.quality).ln() / window.quality_tolerance;
        components.copy_from_slice(&[frequency / self.threshold, quality / self.threshold]);
    }
}

impl SatisficingProblem for SallenKey {
    lattice_methods!();

    fn components(&self) -> Option<&dyn satisfice::Components<f64, Vec<u32>>> {
        Some(self)
    }

    #[inline]
    fn fitness(&self, cells: &Vec<u32>) -> f64 {
        let Some(parts) = self.parts(cells) else {
            return f64::NAN;
        };
        let window = &self.window;
        let frequency = (parts.frequency() / window.frequency).ln().abs() / window.frequency_tolerance;
        let quality = (parts.quality() / window.quality).ln().abs() / window.quality_tolerance;
        frequency.max(quality)
    }
}

impl Catalogued for SallenKey {
    const NAME: &'static str = "sallen-key";
    const SUMMARY: &'static str =
        "low-pass filters from E24 resistors and E12 capacitors inside a design window";
    const SOURCE: &'static str = "Sallen, Key 1955, doi 10.1109/TCT.1955.6500159; count by enumeration";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::real("frequency", "corner frequency in Hz, f", 1000.0, 1e-3, 1e9),
        Parameter::real("quality", "quality, q", BUTTERWORTH, 1e-3, 1e3),
        Parameter::real("frequency-tolerance", "tolerance of ln(f0 / f)", 0.01, 1e-9, 10.0),
        Parameter::real("quality-tolerance", "tolerance of ln(Q / q)", 0.02, 1e-9, 10.0),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(Window {
            frequency: params.real("frequency"),
            quality: params.real("quality"),
            frequency_tolerance: params.real("frequency-tolerance"),
            quality_tolerance: params.real("quality-tolerance"),
        })
    }

    fn reference_hits(&self) -> Option<u64> {
        if self.window == Window::default() {
            Some(PUBLISHED_HITS)
        } else {
            count_hits(self, ENUMERABLE)
        }
    }
}

//! A damped oscillator that must not swing too far.

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, SatisficingProblem};

use crate::lattice::{Lattice, Published, centres, description, lattice_methods, reference};

/// Inputs, levels, threshold, hits. The hits are those of `--example enumerate`.
const PUBLISHED: &[Published] = &[(INPUTS, 20, 0.0, 8_662)];
const PUBLISHED_LIMIT: f64 = 2.25;

const INPUTS: usize = 5;
/// Steps per input, and their length.
const STEPS: usize = 20;
const STEP: f64 = 0.08;

/// All inputs that falsify "always |x| <= limit" for
///
/// x'' = -x - 0.3 x' + u(t), x(0) = x'(0) = 0.
///
/// u is constant on five equal parts of the 100 steps of 0.08, each at the centre of one of 20 equal cells of [-1, 1].
/// Steps are semi-implicit Euler (v += h x'', x += h v). The fitness is the robustness of the specification,
/// F = limit - max_t |x(t)|, and a hit is F < 0. Hits in different cells of inputs are distinct.
///
/// Source of the setting: Annpureddy, Liu, Fainekos, Sankaranarayanan 2011, doi 10.1007/978-3-642-19835-9_21.
///
/// ```
/// use satisfice::catalogue::Catalogued;
/// use satisfice_problems::Falsification;
/// assert_eq!(Falsification::new(20, 2.25)?.reference_hits(), Some(8_662));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Falsification {
    lattice: Lattice,
    threshold: f64,
    description: Description,
    limit: f64,
    levels: Vec<f64>,
}

impl Falsification {
    /// The inputs at `levels` levels that drive |x| above `limit`.
    ///
    /// # Errors
    /// [`Error::Bounds`] for 0 levels; [`Error::Parameter`] for a limit that is not finite.
    pub fn new(levels: usize, limit: f64) -> Result<Self, Error> {
        if !limit.is_finite() {
            return Err(Error::parameter("limit", limit, "a finite number"));
        }
        Ok(Self {
            lattice: Lattice::new([levels; INPUTS])?,
            threshold: 0.0,
            description: description(
                Self::NAME,
                [("levels", levels.to_string()), ("limit", limit.to_string())],
            ),
            limit,
            levels: centres(levels, -1.0, 1.0),
        })
    }

    /// The positions x after each step under the inputs of a solution; empty if they are not cells of this problem.
    #[must_use]
    pub fn trajectory(&self, cells: &[u32]) -> Vec<f64> {
        let mut trajectory = Vec::with_capacity(INPUTS * STEPS);
        if self.lattice.holds(cells) {
            self.simulate(cells, |x| trajectory.push(x));
        }
        trajectory
    }

    #[inline]
    fn simulate(&self, cells: &[u32], mut visit: impl FnMut(f64)) {
        let (mut x, mut v) = (0.0, 0.0);
        for &cell in cells {
            let input = self.levels[cell as usize];
            for _ in 0..STEPS {
                v += STEP * (-x - 0.3 * v + input);
                x += STEP * v;
                visit(x);
            }
        }
    }
}

impl SatisficingProblem for Falsification {
    lattice_methods!();

    #[inline]
    fn fitness(&self, cells: &Vec<u32>) -> f64 {
        if !self.lattice.holds(cells) {
            return f64::NAN;
        }
        let mut greatest = 0.0_f64;
        self.simulate(cells, |x| greatest = greatest.max(x.abs()));
        self.limit - greatest
    }
}

impl Catalogued for Falsification {
    const NAME: &'static str = "falsification";
    const SUMMARY: &'static str = "input signals that drive a damped oscillator out of its specification";
    const SOURCE: &'static str =
        "after Annpureddy et al. 2011, doi 10.1007/978-3-642-19835-9_21; count by enumeration";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer("levels", "levels per input", 20, 1, 10_000),
        Parameter::real("limit", "what |x| must not exceed", PUBLISHED_LIMIT, 0.0, 100.0),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(params.count("levels"), params.real("limit"))
    }

    fn reference_hits(&self) -> Option<u64> {
        let rows = if self.limit.total_cmp(&PUBLISHED_LIMIT).is_eq() {
            PUBLISHED
        } else {
            &[]
        };
        reference(rows, self, INPUTS, self.levels.len())
    }
}

//! A system e(x) = 0 in a box, as a satisficing problem; shared by all root problems.

use satisfice::interval::{Interval, IntervalOps, lower_bound, side};
use satisfice::{Axis, Error, Located, Region, Space};
use satisfice::{Bounds, Components, Encoding};

use crate::number::{Dual, Number};

/// Systems have at most this many unknowns, so that evaluation needs no allocation.
pub(crate) const UNKNOWNS: usize = 24;

/// A system in each arithmetic that it is evaluated in. Each function writes all equations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Functions {
    pub(crate) real: fn(&[f64], &mut [f64]),
    pub(crate) interval: fn(&[Interval], &mut [Interval]),
    pub(crate) dual: fn(&[Dual<f64>], &mut [Dual<f64>]),
    pub(crate) dual_interval: fn(&[Dual<Interval>], &mut [Dual<Interval>]),
}

/// `Functions` from a function that is generic over `Number`.
macro_rules! functions {
    ($system:path) => {
        $crate::roots::equations::Functions {
            real: $system,
            interval: $system,
            dual: $system,
            dual_interval: $system,
        }
    };
}
pub(crate) use functions;

/// The system with its box.
#[derive(Debug, Clone)]
pub(crate) struct Equations {
    pub(crate) functions: Functions,
    /// Number of equations, at least as many as unknowns; more are solved by least squares.
    pub(crate) residuals: usize,
    pub(crate) space: Space<f64>,
    pub(crate) threshold: f64,
    pub(crate) separation: f64,
}

impl Equations {
    /// `threshold` (of the sum of squares) and `separation` (of roots) are positive.
    pub(crate) fn new(
        functions: Functions,
        bounds: impl IntoIterator<Item = (f64, f64)>,
        threshold: f64,
        separation: f64,
    ) -> Result<Self, Error> {
        for (name, value) in [("threshold", threshold), ("separation", separation)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::parameter(name, value, "a number above 0"));
            }
        }
        let space = Space::new(
            bounds
                .into_iter()
                .map(|(lower, upper)| Axis::continuous(lower, upper)),
        )?;
        if space.dimension() > UNKNOWNS {
            return Err(Error::parameter(
                "unknowns",
                space.dimension(),
                format!("at most {UNKNOWNS}"),
            ));
        }
        Ok(Self {
            functions,
            residuals: space.dimension(),
            space,
            threshold,
            separation,
        })
    }

    #[inline]
    pub(crate) fn decode(&self, values: &[f64]) -> Located<f64> {
        Located::new(values, self.separation)
    }

    #[inline]
    pub(crate) fn decode_into(&self, values: &[f64], solution: &mut Located<f64>) {
        solution.set(values, &self.separation.into());
    }

    /// The sum of the squares of the equations.
    #[inline]
    pub(crate) fn fitness(&self, x: &[f64]) -> f64 {
        let n = self.space.dimension();
        if x.len() != n {
            return f64::NAN;
        }
        let mut residuals = [0.0; UNKNOWNS];
        (self.functions.real)(x, &mut residuals[..self.residuals]);
        residuals[..self.residuals].iter().fold(0.0, |sum, e| sum + e * e)
    }
}

/// The residuals, by the root of the threshold.
impl Components<f64, Located<f64>> for Equations {
    fn count(&self) -> usize {
        self.residuals
    }

    fn write(&self, solution: &Located<f64>, components: &mut [f64]) {
        if solution.coordinates.len() != self.space.dimension() {
            return components.fill(f64::NAN);
        }
        (self.functions.real)(&solution.coordinates, components);
        let limit = self.threshold.sqrt();
        components.iter_mut().for_each(|component| *component /= limit);
    }
}

impl Encoding<f64, Located<f64>> for Equations {
    fn encode(&self, solution: &Located<f64>, values: &mut [f64]) -> bool {
        let fits = solution.coordinates.len() == values.len() && self.space.contains(&solution.coordinates);
        if fits {
            values.copy_from_slice(&solution.coordinates);
        }
        fits
    }
    fn covers(&self, hit: &Located<f64>, region: &Region<f64>) -> bool {
        hit.covers(region)
    }
}

impl Bounds<f64> for Equations {
    /// The sum in interval arithmetic, which contains every rounding of `fitness`.
    fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
        let n = self.space.dimension();
        if region.lower.len() != n || region.upper.len() != n {
            return None;
        }
        let zero = Interval::new(0.0, 0.0);
        let mut x = [zero; UNKNOWNS];
        for (axis, x) in x[..n].iter_mut().enumerate() {
            *x = side(region, axis);
        }
        let mut residuals = [zero; UNKNOWNS];
        (self.functions.interval)(&x[..n], &mut residuals[..self.residuals]);
        let squares = residuals[..self.residuals].iter().map(|e| e.square());
        lower_bound(squares.fold(zero, |sum, square| sum + square))
    }
}

/// The methods of `SatisficingProblem` for a type with the fields `equations` and `description`.
macro_rules! root_methods {
    () => {
        type Scalar = f64;
        type Solution = satisfice::Located<f64>;

        fn space(&self) -> &satisfice::Space<f64> {
            &self.equations.space
        }
        fn decode(&self, values: &[f64]) -> satisfice::Located<f64> {
            self.equations.decode(values)
        }
        #[inline]
        fn decode_into(&self, values: &[f64], solution: &mut satisfice::Located<f64>) {
            self.equations.decode_into(values, solution);
        }
        #[inline]
        fn fitness(&self, solution: &satisfice::Located<f64>) -> f64 {
            self.equations.fitness(&solution.coordinates)
        }
        fn threshold(&self) -> f64 {
            self.equations.threshold
        }
        fn encoding(&self) -> Option<&dyn satisfice::Encoding<f64, satisfice::Located<f64>>> {
            Some(&self.equations)
        }
        fn bounds(&self) -> Option<&dyn satisfice::Bounds<f64>> {
            Some(&self.equations)
        }
        fn components(&self) -> Option<&dyn satisfice::Components<f64, satisfice::Located<f64>>> {
            Some(&self.equations)
        }
        fn canonical(&self, hit: &satisfice::Located<f64>) -> Option<satisfice::Located<f64>> {
            self.equations.canonical(hit)
        }
        fn description(&self) -> satisfice::catalogue::Description {
            self.description.clone()
        }
    };
}
pub(crate) use root_methods;

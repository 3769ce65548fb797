//! One problem of the suite as a satisficing problem.

use satisfice::Encoding;
use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Axis, Error, Located, SatisficingProblem, Space};

use super::basic;
use super::composition::{Composition, recipe};
use super::data::{SuiteData, WHERE};
use super::optima;
use crate::lattice::description;

/// With a looser accuracy, points around one optimum would count as several.
const LOOSEST: f64 = 1e-3;

/// A row of the suite's table.
struct Row {
    function: &'static str,
    dimension: usize,
    bounds: (f64, f64),
    peak: f64,
    radius: f64,
    max_evaluations: u64,
}

const fn row(
    function: &'static str,
    dimension: usize,
    bounds: (f64, f64),
    peak: f64,
    radius: f64,
    max_evaluations: u64,
) -> Row {
    Row {
        function,
        dimension,
        bounds,
        peak,
        radius,
        max_evaluations,
    }
}

/// Problems 1 to 20. F5 has other bounds on its second axis.
const TABLE: [Row; 20] = [
    row("F1", 1, (0.0, 30.0), 200.0, 0.01, 50_000),
    row("F2", 1, (0.0, 1.0), 1.0, 0.01, 50_000),
    row("F3", 1, (0.0, 1.0), 1.0, 0.01, 50_000),
    row("F4", 2, (-6.0, 6.0), 200.0, 0.01, 50_000),
    row("F5", 2, (-1.9, 1.9), 1.031_628_453_489_877, 0.5, 50_000),
    row("F6", 2, (-10.0, 10.0), 186.730_908_831_023_9, 0.5, 200_000),
    row("F7", 2, (0.25, 10.0), 1.0, 0.2, 200_000),
    row("F6", 3, (-10.0, 10.0), 2_709.093_505_572_82, 0.5, 400_000),
    row("F7", 3, (0.25, 10.0), 1.0, 0.2, 400_000),
    row("F8", 2, (0.0, 1.0), -2.0, 0.01, 200_000),
    row("CF1", 2, (-5.0, 5.0), 0.0, 0.01, 200_000),
    row("CF2", 2, (-5.0, 5.0), 0.0, 0.01, 200_000),
    row("CF3", 2, (-5.0, 5.0), 0.0, 0.01, 200_000),
    row("CF3", 3, (-5.0, 5.0), 0.0, 0.01, 400_000),
    row("CF4", 3, (-5.0, 5.0), 0.0, 0.01, 400_000),
    row("CF3", 5, (-5.0, 5.0), 0.0, 0.01, 400_000),
    row("CF4", 5, (-5.0, 5.0), 0.0, 0.01, 400_000),
    row("CF3", 10, (-5.0, 5.0), 0.0, 0.01, 400_000),
    row("CF4", 10, (-5.0, 5.0), 0.0, 0.01, 400_000),
    row("CF4", 20, (-5.0, 5.0), 0.0, 0.01, 400_000),
];
const F5_SECOND: (f64, f64) = (-1.1, 1.1);

#[derive(Debug, Clone)]
enum Function {
    Trap,
    EqualMaxima,
    UnevenDecreasingMaxima,
    Himmelblau,
    SixHumpCamelBack,
    Shubert,
    Vincent,
    ModifiedRastrigin,
    Composition(Box<Composition>),
}

/// One of the 20 problems of the CEC2013 competition on niching: find all global maxima f = peak.
///
/// F(x) = peak - f(x) < delta, with delta the accuracy, 1e-4 by default. Hits within the suite's niche radius rho of each
/// other count once. The reference count is the number of global optima: 2, 5, 1, 4, 2, 18, 36, 81, 216, 12, and 6, 8, 6, 6,
/// 8, 6, 8, 6, 8, 8 of the compositions. Problems 11 to 20 read shifts and rotations from the suite's own data folder.
///
/// Source: Li, Engelbrecht, Epitropakis 2013, Benchmark functions for CEC'2013 special session and competition on niching
/// methods for multimodal function optimization, with the corrections of 2016.
///
/// ```
/// use satisfice::catalogue::Catalogued;
/// use satisfice_problems::Cec2013;
/// let vincent = Cec2013::new(7, 1e-4, "")?;
/// assert_eq!((vincent.reference_hits(), vincent.max_evaluations()), (Some(36), 200_000));
/// assert_eq!(vincent.score(&vincent.optima(), 1e-5).by_place, 36);
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Cec2013 {
    space: Space<f64>,
    accuracy: f64,
    description: Description,
    function: Function,
    index: usize,
}

impl Cec2013 {
    /// Problem `problem`, 1 to 20. A hit is a point whose f is within `accuracy` of the peak. `data` is the folder of the suite's
    /// data; problems 1 to 10 need none.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a number or accuracy out of range and for malformed data, [`Error::Missing`] for a problem that needs data,
    /// and [`Error::File`] for data that cannot be read.
    pub fn new(problem: usize, accuracy: f64, data: &str) -> Result<Self, Error> {
        Self::build(problem, accuracy, data, |function, parts, dimension, rotated| {
            if data.is_empty() {
                return Err(Error::Missing {
                    parameter: "data".to_owned(),
                    reason: format!("problem {problem} needs {WHERE}; set data=DIR"),
                });
            }
            SuiteData::read(data, function, parts, dimension, rotated)
        })
    }

    /// One of problems 11 to 20 with your own shifts and rotations.
    ///
    /// # Errors
    /// As [`Cec2013::new`].
    pub fn with_data(problem: usize, accuracy: f64, data: SuiteData) -> Result<Self, Error> {
        Self::build(problem, accuracy, "given", |_, _, _, _| Ok(data))
    }

    fn build(
        problem: usize,
        accuracy: f64,
        data: &str,
        read: impl FnOnce(usize, usize, usize, bool) -> Result<SuiteData, Error>,
    ) -> Result<Self, Error> {
        let index = problem.wrapping_sub(1);
        let Some(row) = TABLE.get(index) else {
            return Err(Error::parameter(
                "problem",
                problem,
                "a whole number from 1 to 20",
            ));
        };
        if !(accuracy > 0.0 && accuracy.is_finite()) {
            return Err(Error::parameter("accuracy", accuracy, "a number above 0"));
        }
        let function = match row.function {
            "F1" => Function::Trap,
            "F2" => Function::EqualMaxima,
            "F3" => Function::UnevenDecreasingMaxima,
            "F4" => Function::Himmelblau,
            "F5" => Function::SixHumpCamelBack,
            "F6" => Function::Shubert,
            "F7" => Function::Vincent,
            "F8" => Function::ModifiedRastrigin,
            composition => {
                let number = usize::from(composition.as_bytes()[2] - b'0');
                let (recipe, rotated) = recipe(number);
                let data = read(number, recipe.len(), row.dimension, rotated)?;
                data.check(recipe.len(), row.dimension, rotated)?;
                Function::Composition(Box::new(Composition::new(recipe, data.shifts, data.rotations)))
            }
        };
        let bounds = |axis: usize| match (&function, axis) {
            (Function::SixHumpCamelBack, 1) => F5_SECOND,
            _ => row.bounds,
        };
        let axes: Vec<_> = (0..row.dimension)
            .map(bounds)
            .map(|(lower, upper)| Axis::continuous(lower, upper))
            .collect();
        Ok(Self {
            space: Space::new(axes)?,
            accuracy,
            description: description(
                Self::NAME,
                [
                    ("problem", problem.to_string()),
                    ("accuracy", accuracy.to_string()),
                    ("data", data.to_owned()),
                ],
            ),
            function,
            index,
        })
    }

    /// f(x), to be maximised; NaN for a wrong number of coordinates.
    #[must_use]
    pub fn height(&self, x: &[f64]) -> f64 {
        match (&self.function, x) {
            _ if x.len() != self.space.dimension() => f64::NAN,
            (Function::Trap, &[x]) => basic::five_uneven_peak_trap(x),
            (Function::EqualMaxima, &[x]) => basic::equal_maxima(x),
            (Function::UnevenDecreasingMaxima, &[x]) => basic::uneven_decreasing_maxima(x),
            (Function::Himmelblau, &[x, y]) => basic::himmelblau(x, y),
            (Function::SixHumpCamelBack, &[x, y]) => basic::six_hump_camel_back(x, y),
            (Function::Shubert, x) => basic::shubert(x),
            (Function::Vincent, x) => basic::vincent(x),
            (Function::ModifiedRastrigin, x) => basic::modified_rastrigin(x),
            (Function::Composition(composition), x) => composition.value(x),
            _ => f64::NAN,
        }
    }

    /// The height of the global optima.
    #[must_use]
    pub fn peak(&self) -> f64 {
        TABLE[self.index].peak
    }

    /// The niche radius rho: optima are farther apart, hits within it count once.
    #[must_use]
    pub fn radius(&self) -> f64 {
        TABLE[self.index].radius
    }

    /// The evaluations that the competition allows per run, `MaxFEs`.
    #[must_use]
    pub fn max_evaluations(&self) -> u64 {
        TABLE[self.index].max_evaluations
    }

    /// The positions of the global optima, for scoring; for compositions, the shifts.
    #[must_use]
    pub fn optima(&self) -> Vec<Vec<f64>> {
        let dimension = self.space.dimension();
        match &self.function {
            Function::Trap => optima::trap(),
            Function::EqualMaxima => optima::equal_maxima(),
            Function::UnevenDecreasingMaxima => optima::uneven_decreasing_maxima(),
            Function::Himmelblau => optima::himmelblau(),
            Function::SixHumpCamelBack => optima::six_hump_camel_back(),
            Function::Shubert => optima::shubert(dimension),
            Function::Vincent => optima::vincent(dimension),
            Function::ModifiedRastrigin => optima::modified_rastrigin(),
            Function::Composition(composition) => composition.optima(),
        }
    }
}

impl SatisficingProblem for Cec2013 {
    type Scalar = f64;
    type Solution = Located<f64>;

    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> Located<f64> {
        Located::new(values, self.radius())
    }
    fn decode_into(&self, values: &[f64], solution: &mut Located<f64>) {
        solution.set(values, &self.radius().into());
    }
    #[inline]
    fn fitness(&self, solution: &Located<f64>) -> f64 {
        self.peak() - self.height(&solution.coordinates)
    }
    fn threshold(&self) -> f64 {
        self.accuracy
    }
    fn description(&self) -> Description {
        self.description.clone()
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, Located<f64>>> {
        Some(self)
    }
}

impl Encoding<f64, Located<f64>> for Cec2013 {
    fn encode(&self, solution: &Located<f64>, values: &mut [f64]) -> bool {
        let fits = solution.coordinates.len() == values.len() && self.space.contains(&solution.coordinates);
        if fits {
            values.copy_from_slice(&solution.coordinates);
        }
        fits
    }
}

impl Catalogued for Cec2013 {
    const NAME: &'static str = "cec2013";
    const SUMMARY: &'static str = "all global optima of one of the 20 functions of the CEC2013 niching suite";
    const SOURCE: &'static str =
        "Li, Engelbrecht, Epitropakis 2013, corrected 2016; https://github.com/mikeagn/CEC2013";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer("problem", "number in the suite", 7, 1, 20),
        Parameter::real(
            "accuracy",
            "distance from the peak height that is a hit, delta",
            1e-4,
            1e-12,
            1.0,
        ),
        Parameter::text(
            "data",
            "folder of the suite's data, which problems 11 to 20 need",
            "",
        ),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(
            params.count("problem"),
            params.real("accuracy"),
            params.text("data"),
        )
    }

    /// The number of global optima, up to the accuracy 1e-3; with a looser one, an optimum gives several hits.
    fn reference_hits(&self) -> Option<u64> {
        (self.accuracy <= LOOSEST).then(|| self.optima().len() as u64)
    }
}

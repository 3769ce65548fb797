//! A problem whose fitness is computed elsewhere: by a program, by another language.

use std::sync::Arc;

use satisfice::catalogue::Description;
use satisfice::{Encoding, Identity, Located, Region, SatisficingProblem, Space};
use serde::{Deserialize, Serialize};

use crate::error::Error;

/// Integers that differ are farther apart than this, so with this half-axis they are different answers.
const LESS_THAN_ONE: f64 = 0.5;

/// Within which distance two points are one answer.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Separation {
    /// Different points are different answers.
    #[default]
    Exact,
    /// Within this Euclidean distance, in units of the space.
    Radius(f64),
    /// Within the ellipsoid with these half-axes, one per axis of the space. 0 on an integer axis: different values there are
    /// different answers.
    PerAxis(Vec<f64>),
}

impl Separation {
    /// The half-axes; `None` for exact coordinates.
    fn half_axes(&self, space: &Space<f64>) -> Result<Option<Arc<[f64]>>, satisfice::Error> {
        let widths = match self {
            Self::Exact => return Ok(None),
            Self::Radius(radius) => &vec![*radius; space.dimension()],
            Self::PerAxis(widths) => widths,
        };
        let refused = |value: String, text: &str| satisfice::Error::parameter("separation", value, text);
        if widths.len() != space.dimension() {
            let wanted = format!("one number for each of {} axes", space.dimension());
            return Err(refused(format!("{} numbers", widths.len()), &wanted));
        }
        let half_axis = |(&width, axis): (&f64, &satisfice::Axis<f64>)| {
            if width == 0.0 && axis.is_integer() && matches!(self, Self::PerAxis(_)) {
                Ok(LESS_THAN_ONE)
            } else if width > 0.0 && width.is_finite() {
                Ok(width)
            } else {
                Err(refused(
                    width.to_string(),
                    "a positive, finite number, or none for exact coordinates",
                ))
            }
        };
        widths
            .iter()
            .zip(space.axes())
            .map(half_axis)
            .collect::<Result<_, _>>()
            .map(Some)
    }
}

/// A point of a [`BlackBox`]. Two are one answer within its separation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(from = "Plain")]
pub struct Point {
    /// Coordinates, in the units of the space.
    pub coordinates: Vec<f64>,
    /// Half-axes of the ellipsoid within which points are one answer.
    #[serde(skip_serializing_if = "Option::is_none")]
    separation: Option<Arc<[f64]>>,
    /// The coordinates in units of the half-axes.
    #[serde(skip)]
    scaled: Located<f64>,
}

/// A point as it is written.
#[derive(Deserialize)]
struct Plain {
    coordinates: Vec<f64>,
    #[serde(default)]
    separation: Option<Arc<[f64]>>,
}

impl From<Plain> for Point {
    fn from(plain: Plain) -> Self {
        Self::new(&plain.coordinates, plain.separation)
    }
}

impl Point {
    fn new(coordinates: &[f64], separation: Option<Arc<[f64]>>) -> Self {
        let mut point = Self {
            coordinates: Vec::new(),
            separation,
            scaled: Located::new(&[], 0.0),
        };
        point.set(coordinates);
        point
    }

    fn set(&mut self, coordinates: &[f64]) {
        self.coordinates.clear();
        self.coordinates.extend_from_slice(coordinates);
        let scaled = &mut self.scaled.coordinates;
        scaled.clear();
        match &self.separation {
            None => scaled.extend_from_slice(coordinates),
            Some(half_axes) => {
                self.scaled.separation = satisfice::Separation::Radius(1.0);
                scaled.extend(coordinates.iter().zip(&**half_axes).map(|(x, width)| x / width));
            }
        }
    }
}

impl Identity for Point {
    fn key(&self) -> u64 {
        self.scaled.key()
    }
    fn same(&self, other: &Self) -> bool {
        self.scaled.same(&other.scaled)
    }
    fn visit_keys(&self, visit: &mut impl FnMut(u64) -> bool) -> bool {
        self.scaled.visit_keys(visit)
    }
}

/// A problem of which only the fitness values are known: a space, delta, and within which distance hits are one.
///
/// ```
/// use satisfice::{Budget, Search, Space};
/// use satisfice_catalogue::black_box::{BlackBox, Separation};
///
/// // Near the unit circle; hits 0.2 apart in x or 0.4 in y count as different.
/// let circle = BlackBox::new(Space::cube(2, -2.0, 2.0)?, 0.01, &Separation::PerAxis(vec![0.2, 0.4]), |x: &[f64]| {
///     (x[0].hypot(x[1]) - 1.0).abs()
/// })?;
/// let report = Search::new().run(&circle, &Budget::evaluations(20_000))?;
/// assert!((10..40).contains(&report.hit_count()));
/// # Ok::<(), satisfice_catalogue::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct BlackBox<F> {
    space: Space<f64>,
    threshold: f64,
    half_axes: Option<Arc<[f64]>>,
    fitness: F,
    name: String,
}

impl<F: Fn(&[f64]) -> f64 + Sync> BlackBox<F> {
    /// All points of `space` with `fitness(values) < threshold`. A search that is driven by hand
    /// ([`Search::start`](satisfice::Search::start)) does not call `fitness`.
    ///
    /// # Errors
    /// [`satisfice::Error::Parameter`] for a separation that is not positive and finite or has another number of axes.
    pub fn new(
        space: Space<f64>,
        threshold: f64,
        separation: &Separation,
        fitness: F,
    ) -> Result<Self, Error> {
        Ok(Self {
            half_axes: separation.half_axes(&space)?,
            space,
            threshold,
            fitness,
            name: "black-box".to_owned(),
        })
    }

    /// Its name in reports, `black-box` by default.
    #[must_use]
    pub fn named(mut self, name: &str) -> Self {
        name.clone_into(&mut self.name);
        self
    }
}

impl<F: Fn(&[f64]) -> f64 + Sync> SatisficingProblem for BlackBox<F> {
    type Scalar = f64;
    type Solution = Point;

    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> Point {
        Point::new(values, self.half_axes.clone())
    }
    fn decode_into(&self, values: &[f64], point: &mut Point) {
        point.separation.clone_from(&self.half_axes);
        point.set(values);
    }
    fn fitness(&self, point: &Point) -> f64 {
        (self.fitness)(&point.coordinates)
    }
    fn threshold(&self) -> f64 {
        self.threshold
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, Point>> {
        Some(self)
    }
    fn description(&self) -> Description {
        Description {
            name: self.name.clone(),
            parameters: Vec::new(),
        }
    }
}

impl<F: Fn(&[f64]) -> f64 + Sync> Encoding<f64, Point> for BlackBox<F> {
    fn encode(&self, point: &Point, values: &mut [f64]) -> bool {
        let fits = point.coordinates.len() == values.len();
        if fits {
            values.copy_from_slice(&point.coordinates);
        }
        fits
    }
    fn covers(&self, hit: &Point, region: &Region<f64>) -> bool {
        let scale = |ends: &[f64]| Point::new(ends, hit.separation.clone()).scaled.coordinates;
        hit.scaled.covers(&Region {
            lower: scale(&region.lower),
            upper: scale(&region.upper),
        })
    }
}

#[cfg(test)]
mod tests {
    use satisfice::{Axis, Budget, Search};

    use super::*;

    fn mixed() -> Space<f64> {
        Space::new([Axis::integer(0, 9), Axis::continuous(0.0, 1.0)]).unwrap()
    }

    #[test]
    fn it_obeys_the_laws_of_problems() {
        for separation in [
            Separation::Exact,
            Separation::Radius(0.1),
            Separation::PerAxis(vec![0.0, 0.2]),
        ] {
            let problem =
                BlackBox::new(mixed(), 0.5, &separation, |x: &[f64]| (x[0] - 4.0).abs() + x[1]).unwrap();
            assert_eq!(
                satisfice::testing::problem::check(&problem, 1),
                [],
                "{separation:?}"
            );
        }
    }

    #[test]
    fn the_separation_is_an_ellipsoid() {
        let same = |separation: &Separation, a: [f64; 2], b: [f64; 2]| {
            let problem = BlackBox::new(mixed(), 0.5, separation, |_: &[f64]| 0.0).unwrap();
            let [a, b] = [a, b].map(|x| problem.decode(&x));
            let mut archive = satisfice::Archive::default();
            archive.insert(a.clone(), 0.0, 1, 0.0);
            assert_eq!(archive.contains(&b), a.same(&b), "{a:?} {b:?}");
            a.same(&b)
        };
        assert!(!same(&Separation::Exact, [1.0, 0.5], [1.0, 0.5 + 1e-15]));
        let radius = Separation::Radius(1.25);
        assert!(same(&radius, [1.0, 0.0], [2.0, 0.75]) && !same(&radius, [1.0, 0.0], [2.0, 0.7500001]));
        let widths = Separation::PerAxis(vec![0.0, 0.5]);
        assert!(same(&widths, [1.0, 0.0], [1.0, 0.5]) && !same(&widths, [1.0, 0.0], [2.0, 0.0]));
        let wide = Separation::PerAxis(vec![2.0, 0.5]);
        assert!(same(&wide, [1.0, 0.0], [2.0, 0.4]) && !same(&wide, [1.0, 0.0], [2.0, 0.45]));
    }

    #[test]
    fn a_point_comes_back_from_json() {
        for separation in [Separation::Exact, Separation::PerAxis(vec![0.0, 0.1])] {
            let problem = BlackBox::new(mixed(), 0.5, &separation, |_: &[f64]| 0.0).unwrap();
            let point = problem.decode(&[3.0, 0.1]);
            let text = serde_json::to_string(&point).unwrap();
            assert_eq!(serde_json::from_str::<Point>(&text).unwrap(), point, "{text}");
        }
    }

    #[test]
    fn a_separation_that_is_not_usable_is_refused() {
        for separation in [
            Separation::Radius(0.0),
            Separation::Radius(f64::NAN),
            Separation::PerAxis(vec![0.1]),
            Separation::PerAxis(vec![0.1, 0.0]),
            Separation::PerAxis(vec![-1.0, 0.1]),
        ] {
            let refused = BlackBox::new(mixed(), 0.5, &separation, |_: &[f64]| 0.0);
            assert!(
                refused.is_err_and(|error| error.to_string().contains("separation")),
                "{separation:?}"
            );
        }
    }

    #[test]
    fn it_finds_what_the_closure_of_the_framework_finds() {
        let f = |x: &[f64]| (x[0].hypot(x[1]) - 1.0).abs();
        let space = Space::cube(2, -2.0, 2.0).unwrap();
        let boxed = BlackBox::new(space.clone(), 0.01, &Separation::Radius(0.25), f).unwrap();
        let closure = satisfice::from_fn(space, 0.01, f).separation(0.25);
        let budget = Budget::evaluations(5000);
        let report = Search::new().seed(3).run(&boxed, &budget).unwrap();
        let other = Search::new().seed(3).run(&closure, &budget).unwrap();
        let ours = report
            .hits()
            .map(|hit| (&hit.solution.coordinates, hit.evaluation));
        let theirs = other
            .hits()
            .map(|hit| (&hit.solution.coordinates, hit.evaluation));
        assert!(ours.eq(theirs) && report.hit_count() > 5);
    }
}

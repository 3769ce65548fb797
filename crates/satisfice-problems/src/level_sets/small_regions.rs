//! A few small regions of the unit cube: boxes, balls, or thin ellipsoids that are turned.

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Encoding, Error, Located, Region, SatisficingProblem, SearchRng, Space};

use crate::lattice::description;

const SHAPES: &[&str] = &["box", "ball", "ellipsoid"];
/// Draws of centres before the regions count as too large.
const DRAWS: usize = 100_000;
/// Draws after which all centres are drawn anew: the first ones may leave no room for the last.
const ANEW: usize = 10_000;
/// The separation, in radii, where regions are far from each other.
const MOST_SEPARATION: f64 = 4.0;

/// The shape of the regions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Boxes along the axes.
    Box,
    /// Balls.
    Ball,
    /// Ellipsoids turned at random, whose half-axes fall geometrically from the radius.
    Ellipsoid,
}

impl Shape {
    fn of(name: &str) -> Self {
        match name {
            "ball" => Self::Ball,
            "ellipsoid" => Self::Ellipsoid,
            _ => Self::Box,
        }
    }

    fn name(self) -> &'static str {
        SHAPES[self as usize]
    }
}

/// Disjoint regions of equal size at random places of the unit cube, of which each counts once:
///
/// F(x) = min_k d_k(x) < 1,
///
/// where d_k is the distance from centre k in units of the region's size in that direction: max_j |x_j - c_j| / radius for boxes,
/// |x - c| / radius for balls, and |S^-1 Q^T (x - c)| for ellipsoids with axes Q and half-axes S. With `steps` > 0, F is
/// min(floor(d), steps), a staircase of plateaus.
///
/// A hit becomes the centre of its region. Points within the separation of a known centre are the same answer: half the least
/// distance of two centres, at most four radii.
///
/// ```
/// use satisfice::{Budget, Search};
/// use satisfice_problems::{Shape, SmallRegions};
/// let boxes = SmallRegions::new(3, 5, Shape::Box, 0.1, 1.0, 0, 7)?;
/// let report = Search::new().run(&boxes, &Budget::evaluations(5_000))?;
/// assert_eq!(report.hit_count(), 5);
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct SmallRegions {
    space: Space<f64>,
    description: Description,
    shape: Shape,
    radius: f64,
    /// 0 for a continuous F.
    steps: f64,
    /// `dimension` coordinates each.
    centres: Vec<f64>,
    /// For each ellipsoid the rows of S^-1 Q^T.
    turns: Vec<f64>,
    separation: f64,
}

impl SmallRegions {
    /// `count` regions in `dimension` dimensions. `radius` is half the side of a box, the radius of a ball, the longest half-axis of
    /// an ellipsoid, whose shortest is `radius / aspect`. `steps` is 0 for a continuous F. `instance` chooses places and turns.
    ///
    /// # Errors
    /// [`Error::NoAxis`]; [`Error::Parameter`] for a radius that is not in (0, 0.5), an aspect below 1, and regions for which no
    /// room is found.
    pub fn new(
        dimension: usize,
        count: usize,
        shape: Shape,
        radius: f64,
        aspect: f64,
        steps: usize,
        instance: u64,
    ) -> Result<Self, Error> {
        if !(radius > 0.0 && radius < 0.5) {
            return Err(Error::parameter(
                "radius",
                radius,
                "a number above 0 and below 0.5",
            ));
        }
        if !(aspect >= 1.0 && aspect.is_finite()) {
            return Err(Error::parameter("aspect", aspect, "a finite number from 1 on"));
        }
        let space = Space::cube(dimension, 0.0, 1.0)?;
        let mut rng = super::instance_rng(instance);
        let centres = places(dimension, count, shape, radius, &mut rng).ok_or_else(|| {
            Error::parameter(
                "radius",
                radius,
                "so small that all regions fit in beside each other",
            )
        })?;
        let thin = shape == Shape::Ellipsoid;
        let half_axis = |j: usize| radius * aspect.powf(-(j as f64) / (dimension.max(2) - 1) as f64);
        let turns = if thin {
            (0..count)
                .flat_map(|_| turn(dimension, half_axis, &mut rng))
                .collect()
        } else {
            Vec::new()
        };
        Ok(Self {
            space,
            description: description(
                Self::NAME,
                [
                    ("dimension", dimension.to_string()),
                    ("count", count.to_string()),
                    ("shape", shape.name().to_owned()),
                    ("radius", radius.to_string()),
                    ("aspect", aspect.to_string()),
                    ("steps", steps.to_string()),
                    ("instance", instance.to_string()),
                ],
            ),
            shape,
            radius,
            steps: steps as f64,
            separation: (least_distance(&centres, dimension) / 2.0).min(MOST_SEPARATION * radius),
            centres,
            turns,
        })
    }

    /// The centres of the regions.
    pub fn centres(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.centres.chunks_exact(self.space.dimension())
    }

    /// d_k(x).
    #[inline]
    fn distance(&self, k: usize, x: &[f64]) -> f64 {
        let n = x.len();
        let centre = &self.centres[k * n..(k + 1) * n];
        let offsets = || x.iter().zip(centre).map(|(x, c)| x - c);
        match self.shape {
            Shape::Box => offsets().fold(0.0, |most, d| d.abs().max(most)) / self.radius,
            Shape::Ball => offsets().map(|d| d * d).sum::<f64>().sqrt() / self.radius,
            Shape::Ellipsoid => {
                let rows = self.turns[k * n * n..(k + 1) * n * n].chunks_exact(n);
                let along = |row: &[f64]| row.iter().zip(offsets()).map(|(q, d)| q * d).sum::<f64>();
                rows.map(|row| along(row).powi(2)).sum::<f64>().sqrt()
            }
        }
    }

    /// The nearest region and its distance.
    #[inline]
    fn nearest(&self, x: &[f64]) -> (usize, f64) {
        let distances = (0..self.centres().len()).map(|k| (k, self.distance(k, x)));
        distances.fold(
            (0, f64::INFINITY),
            |best, next| if next.1 < best.1 { next } else { best },
        )
    }
}

/// Centres of regions that are disjoint and inside the cube.
fn places(
    dimension: usize,
    count: usize,
    shape: Shape,
    radius: f64,
    rng: &mut SearchRng,
) -> Option<Vec<f64>> {
    let mut centres: Vec<f64> = Vec::new();
    let mut centre = vec![0.0; dimension];
    let mut draws = 0;
    while centres.len() < count * dimension {
        if draws == DRAWS {
            return None;
        }
        if draws.is_multiple_of(ANEW) {
            centres.clear();
        }
        draws += 1;
        for x in &mut centre {
            *x = radius + (1.0 - 2.0 * radius) * rng.uniform();
        }
        let apart = |other: &[f64]| {
            let offsets = other.iter().zip(&centre).map(|(a, b)| (a - b).abs());
            let distance = if shape == Shape::Box {
                offsets.fold(0.0, f64::max)
            } else {
                offsets.map(|d| d * d).sum::<f64>().sqrt()
            };
            distance > 2.0 * radius
        };
        if centres.chunks_exact(dimension).all(apart) {
            centres.extend_from_slice(&centre);
        }
    }
    Some(centres)
}

/// The least distance of two centres; infinite where there is one.
fn least_distance(centres: &[f64], dimension: usize) -> f64 {
    let centre = |k: usize| &centres[k * dimension..(k + 1) * dimension];
    let square = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    let count = centres.len() / dimension;
    let pairs = (0..count).flat_map(|i| (0..i).map(move |j| (i, j)));
    let least = pairs
        .map(|(i, j)| square(centre(i), centre(j)))
        .fold(f64::INFINITY, f64::min);
    least.sqrt()
}

/// The rows of S^-1 Q^T for a random orthogonal Q: normal vectors, made orthogonal by Gram and Schmidt.
fn turn(dimension: usize, half_axis: impl Fn(usize) -> f64, rng: &mut SearchRng) -> Vec<f64> {
    let mut rows: Vec<Vec<f64>> = Vec::new();
    while rows.len() < dimension {
        let mut row: Vec<f64> = (0..dimension).map(|_| rng.normal()).collect();
        // Twice is enough to the last digits.
        for _ in 0..2 {
            for known in &rows {
                let along: f64 = row.iter().zip(known).map(|(a, b)| a * b).sum();
                row.iter_mut().zip(known).for_each(|(x, k)| *x -= along * k);
            }
        }
        let length = row.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > 1e-6 {
            rows.push(row.iter().map(|x| x / length).collect());
        }
    }
    let scaled = rows.into_iter().enumerate();
    scaled
        .flat_map(|(j, row)| row.into_iter().map(move |x| (j, x)))
        .map(|(j, x)| x / half_axis(j))
        .collect()
}

impl SatisficingProblem for SmallRegions {
    type Scalar = f64;
    type Solution = Located<f64>;

    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> Located<f64> {
        Located::new(values, self.separation)
    }
    fn decode_into(&self, values: &[f64], solution: &mut Located<f64>) {
        solution.set(values, &self.separation.into());
    }
    fn fitness(&self, solution: &Located<f64>) -> f64 {
        if solution.coordinates.len() != self.space.dimension() {
            return f64::NAN;
        }
        let (_, distance) = self.nearest(&solution.coordinates);
        if self.steps > 0.0 {
            distance.floor().min(self.steps)
        } else {
            distance
        }
    }
    fn threshold(&self) -> f64 {
        1.0
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, Located<f64>>> {
        Some(self)
    }
    fn canonical(&self, hit: &Located<f64>) -> Option<Located<f64>> {
        let (k, _) = self.nearest(&hit.coordinates);
        self.centres().nth(k).map(|centre| self.decode(centre))
    }
    fn description(&self) -> Description {
        self.description.clone()
    }
}

impl Encoding<f64, Located<f64>> for SmallRegions {
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

impl Catalogued for SmallRegions {
    const NAME: &'static str = "small-regions";
    const SUMMARY: &'static str = "disjoint small boxes, balls or thin turned ellipsoids in the unit cube, each one answer; also as plateaus";
    const SOURCE: &'static str = "this project; the number of regions is a parameter";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer("dimension", "axes", 6, 1, 100),
        Parameter::integer("count", "regions", 8, 1, 10_000),
        Parameter::choice("shape", "shape of a region", "box", SHAPES),
        Parameter::real(
            "radius",
            "half the side of a box, radius of a ball, longest half-axis of an ellipsoid",
            0.05,
            1e-6,
            0.5,
        ),
        Parameter::real(
            "aspect",
            "longest half-axis of an ellipsoid by its shortest",
            10.0,
            1.0,
            1e6,
        ),
        Parameter::integer(
            "steps",
            "plateaus of F outside the regions; 0 for a continuous F",
            0,
            0,
            1_000_000,
        ),
        Parameter::integer("instance", "which places and turns", 0, 0, i64::MAX),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(
            params.count("dimension"),
            params.count("count"),
            Shape::of(params.text("shape")),
            params.real("radius"),
            params.real("aspect"),
            params.count("steps"),
            params.count("instance") as u64,
        )
    }

    fn reference_hits(&self) -> Option<u64> {
        Some(self.centres().len() as u64)
    }
}

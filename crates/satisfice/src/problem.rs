//! Problems: what a candidate means, how good it is, and when it is good enough.

mod bounds;
mod neighbours;
mod reference;

use std::sync::Arc;

use bounds::FnBounds;
use neighbours::FnNeighbours;
pub(crate) use reference::AnyProblem;

use crate::capability::{Bounds, Components, Encoding, Neighbourhood};
use crate::description::Description;
use crate::error::Error;
use crate::identity::{AxisSeparation, Identity, Located, Separation};
use crate::scalar::Real;
use crate::space::{Axis, AxisKind, Region, Space};

/// A problem whose answers are all candidates with F(x) < delta.
///
/// Four methods define the problem. The others are optional: [capabilities](crate::capability) that help engines, and faster
/// forms. Methods get *values* (whole on integer axes), never the real positions that engines move.
///
/// All methods must be pure: the same arguments give the same result, from any thread, until the problem is changed between
/// two slices. [`testing::problem::check`](crate::testing::problem::check) checks these laws.
///
/// ```
/// use satisfice::{Axis, SatisficingProblem, Space};
///
/// /// Pairs of numbers below 100 whose sum of squares is a square.
/// struct Pythagoras(Space<f64>);
///
/// impl SatisficingProblem for Pythagoras {
///     type Scalar = f64;
///     type Solution = [u32; 2];
///     fn space(&self) -> &Space<f64> { &self.0 }
///     fn decode(&self, values: &[f64]) -> [u32; 2] { [values[0] as u32, values[1] as u32] }
///     fn fitness(&self, &[a, b]: &[u32; 2]) -> f64 {
///         let root = f64::from(a * a + b * b).sqrt();
///         root - root.floor()
///     }
///     fn threshold(&self) -> f64 { 1e-9 }
/// }
/// # Pythagoras(Space::new([Axis::integer(1, 99), Axis::integer(1, 99)])?);
/// # Ok::<(), satisfice::Error>(())
/// ```
pub trait SatisficingProblem: Sync {
    /// The scalar of the search: `f32` or `f64`.
    type Scalar: Real;
    /// The type that points decode to; solutions that are the [same](Identity) count once.
    type Solution: Identity + Clone + Send + Sync;

    /// The box that is searched. Its number of axes must not change during a search.
    fn space(&self) -> &Space<Self::Scalar>;

    /// The solution at `values`, one per axis, each inside its bounds and whole on integer axes.
    fn decode(&self, values: &[Self::Scalar]) -> Self::Solution;

    /// F: smaller is better. A fitness that is NaN or infinite is never a hit.
    fn fitness(&self, solution: &Self::Solution) -> Self::Scalar;

    /// delta: a hit is F < delta, strictly. Any value but NaN, 0 and negative ones included.
    fn threshold(&self) -> Self::Scalar;

    /// Decodes into an existing solution; worth writing if a solution owns memory.
    #[inline]
    fn decode_into(&self, values: &[Self::Scalar], solution: &mut Self::Solution) {
        *solution = self.decode(values);
    }

    /// F of many solutions at once, into `fitness` of the same length; worth writing if F vectorises.
    #[inline]
    fn fitness_all(&self, solutions: &[Self::Solution], fitness: &mut [Self::Scalar]) {
        for (solution, fitness) in solutions.iter().zip(fitness) {
            *fitness = self.fitness(solution);
        }
    }

    /// At which values a solution is; `None`, the default, if that is not offered.
    fn encoding(&self) -> Option<&dyn Encoding<Self::Scalar, Self::Solution>> {
        None
    }

    /// The solutions next to a solution; `None`, the default, if they are not offered. Needs an
    /// [`encoding`](SatisficingProblem::encoding).
    fn neighbourhood(&self) -> Option<&dyn Neighbourhood<Self::Solution>> {
        None
    }

    /// Lower bounds of F over regions; `None`, the default, if they are not offered.
    fn bounds(&self) -> Option<&dyn Bounds<Self::Scalar>> {
        None
    }

    /// The components of F, which are near 0 at a hit, for engines that model F; `None`, the default, if they are not offered.
    fn components(&self) -> Option<&dyn Components<Self::Scalar, Self::Solution>> {
        None
    }

    /// The representative of a hit, for example a root polished to the last digit or a pair in ascending order; `None`, the
    /// default, if the hit represents itself. Called for hits only. Two hits with the same representative count once.
    ///
    /// The representative is a hit, too, and the one that is listed, with its own fitness: that call of the fitness is
    /// counted nowhere. One that is no hit is not used, and the hit is listed itself; a run does not say so, but
    /// [`testing::problem::check`](crate::testing::problem::check) does.
    fn canonical(&self, _hit: &Self::Solution) -> Option<Self::Solution> {
        None
    }

    /// Name and parameters, for the report. By default the name is `unnamed`; to give one:
    ///
    /// ```
    /// use satisfice::Description;
    /// # struct Rings;
    /// # impl Rings {
    /// fn description(&self) -> Description {
    ///     Description { name: "rings".to_owned(), ..Description::default() }
    /// }
    /// # }
    /// # assert_eq!(Rings.description().name, "rings");
    /// ```
    fn description(&self) -> Description {
        Description::default()
    }
}

/// The problem made by [`from_fn`].
#[derive(Debug, Clone)]
pub struct FnProblem<S, F> {
    space: Space<S>,
    threshold: S,
    separation: Separation<S>,
    fitness: F,
    components: Option<FnComponents<S>>,
    neighbours: Option<FnNeighbours<S>>,
    bounds: Option<FnBounds<S>>,
    description: Description,
}

/// Writes the components of F at values.
type WriteComponents<S> = dyn Fn(&[S], &mut [S]) + Send + Sync;

/// The components of F of a [`FnProblem`].
#[derive(Clone)]
struct FnComponents<S> {
    count: usize,
    write: Arc<WriteComponents<S>>,
}

impl<S> core::fmt::Debug for FnComponents<S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{} components", self.count)
    }
}

impl<S: Real> Components<S, Located<S>> for FnComponents<S> {
    fn count(&self) -> usize {
        self.count
    }

    fn write(&self, solution: &Located<S>, components: &mut [S]) {
        (self.write)(&solution.coordinates, components);
    }
}

/// The closure of a problem that is [boxed](FnProblem::boxed).
pub type BoxedFn<'a, S> = Box<dyn Fn(&[S]) -> S + Send + Sync + 'a>;

/// A problem from a closure: all points of `space` with `fitness(values) < threshold`.
///
/// On an all-integer space, different values are different answers. With a continuous axis, points within a separation
/// radius count once: 1 % of each continuous axis, unless [`FnProblem::separation`] or [`FnProblem::separations`] says
/// otherwise. Different values on an integer axis are different answers anyway. On a logarithmic axis distances are those
/// of the logarithms; on a periodic one they go around the circle.
///
/// A closure may also name [neighbours](FnProblem::neighbours), [components](FnProblem::components) and [bounds](FnProblem::bounds).
/// Representatives need the [trait](SatisficingProblem).
///
/// ```
/// use satisfice::{engine, from_fn, Budget, Search, Space};
/// let problem = from_fn(Space::lattice(2, 100)?, 2.5, |x: &[f64]| ((x[0] - 50.0).powi(2) + (x[1] - 20.0).powi(2)).sqrt());
/// let report = Search::with(engine::Random::default()).seed(1).run(&problem, &Budget::evaluations(100_000))?;
/// assert_eq!(report.hit_count(), 21); // the lattice points of a disc of radius 2.5
/// # Ok::<(), satisfice::Error>(())
/// ```
pub fn from_fn<S: Real, F: Fn(&[S]) -> S + Sync>(
    space: Space<S>,
    threshold: S,
    fitness: F,
) -> FnProblem<S, F> {
    let separation = separation_of(&space, |axis| match axis.kind() {
        AxisKind::Continuous => S::of(0.01) * axis.width(),
        AxisKind::Integer | AxisKind::Categorical | AxisKind::Place => S::zero(),
    });
    FnProblem {
        space,
        threshold,
        separation,
        fitness,
        components: None,
        neighbours: None,
        bounds: None,
        description: Description {
            name: "closure".to_owned(),
            ..Description::default()
        },
    }
}

/// A radius for each continuous axis of a space, by its rule; the others are exact. Where all axes are straight and have the
/// same radius, distances are those of the space.
fn separation_of<S: Real>(space: &Space<S>, radius: impl Fn(&Axis<S>) -> S) -> Separation<S> {
    let axes = space.axes();
    let straight =
        |axis: &Axis<S>| axis.kind() == AxisKind::Continuous && !axis.is_logarithmic() && !axis.is_periodic();
    let whole = |axis: &Axis<S>| axis.kind() == AxisKind::Integer && !axis.is_periodic();
    let first = axes.first().map_or(S::zero(), &radius);
    if axes.iter().all(|axis| straight(axis) && radius(axis) == first) || axes.iter().all(whole) {
        return Separation::Radius(first);
    }
    Separation::axes(axes.iter().map(|axis| {
        if axis.kind() == AxisKind::Continuous {
            separation_on(axis, radius(axis))
        } else {
            AxisSeparation::exact()
        }
    }))
}

/// A radius on one axis, by its rule; categories are always exact.
fn separation_on<S: Real>(axis: &Axis<S>, radius: S) -> AxisSeparation<S> {
    if matches!(axis.kind(), AxisKind::Categorical | AxisKind::Place) {
        return AxisSeparation::exact();
    }
    let within = AxisSeparation::within(radius);
    if axis.is_logarithmic() {
        within.logarithmic()
    } else if axis.is_periodic() {
        within.periodic(axis.width())
    } else {
        within
    }
}

/// A problem whose fitness is known elsewhere only, for [`Tickets`](crate::Tickets): all points of `space` with F < `threshold`.
/// Its own fitness is NaN. Points are told apart as by [`from_fn`].
///
/// ```
/// use satisfice::{problem::evaluated_elsewhere, Budget, Search, Space, Tickets};
/// let problem = evaluated_elsewhere(Space::lattice(2, 50)?, 3.0);
/// let mut tickets = Tickets::ordered(Search::new(), problem, &Budget::evaluations(3000))?;
/// loop {
///     let asked = tickets.ask(16);
///     if asked.is_empty() {
///         break;
///     }
///     for job in asked.iter().rev() {
///         tickets.tell(job.ticket, job.solution.coordinates.iter().sum())?;
///     }
/// }
/// assert_eq!(tickets.finish().hit_count(), 6);
/// # Ok::<(), satisfice::Error>(())
/// ```
pub fn evaluated_elsewhere<S: Real>(space: Space<S>, threshold: S) -> FnProblem<S, fn(&[S]) -> S> {
    from_fn(space, threshold, |_| S::nan())
}

impl<S: Real, F: Fn(&[S]) -> S + Sync> FnProblem<S, F> {
    /// The same problem with its closure behind a pointer. Every closure is a type of its own; boxed problems are of one type and can be
    /// kept in one list. Each evaluation costs a call through the pointer.
    ///
    /// ```
    /// use satisfice::{Budget, Search, Space, from_fn};
    /// let space = Space::lattice(2, 50)?;
    /// let problems = [from_fn(space.clone(), 3.0, |x: &[f64]| x[0] + x[1]).boxed(), from_fn(space, 3.0, |x: &[f64]| x[0] * x[1]).boxed()];
    /// for problem in &problems {
    ///     println!("{}", Search::new().run(problem, &Budget::evaluations(3000))?);
    /// }
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    pub fn boxed<'a>(self) -> FnProblem<S, BoxedFn<'a, S>>
    where
        F: Send + 'a,
    {
        FnProblem {
            space: self.space,
            threshold: self.threshold,
            separation: self.separation,
            fitness: Box::new(self.fitness),
            components: self.components,
            neighbours: self.neighbours,
            bounds: self.bounds,
            description: self.description,
        }
    }
}

impl<S: Real, F> FnProblem<S, F> {
    /// The same problem under another name in reports; `closure` by default.
    #[must_use]
    pub fn named(mut self, name: &str) -> Self {
        name.clone_into(&mut self.description.name);
        self
    }

    /// The same problem with the [components](Components) of F: `write` gets values and writes `count` numbers, each divided by its
    /// limit, so that at every hit all magnitudes are at most 1.
    ///
    /// A problem of your own that passes its calls on to this one calls the method of the trait by its full name,
    /// `SatisficingProblem::components(&inner)`: this one has the same.
    ///
    /// ```
    /// use satisfice::{Budget, Search, Space, engine::Surrogate, from_fn};
    /// let (space, delta) = (Space::cube(3, -2.0, 2.0)?, 1e-3);
    /// let residuals = |x: &[f64]| [x[0] * x[1] - 1.0, x[1] + x[2] * x[2] - 2.0, x[0] - x[1] * x[2]];
    /// let roots = from_fn(space, delta, move |x: &[f64]| residuals(x).into_iter().fold(0.0, |f, r| r.abs().max(f)))
    ///     .components(3, move |x, components| components.copy_from_slice(&residuals(x).map(|r| r / delta)));
    /// let report = Search::with(Surrogate::default()).run(&roots, &Budget::evaluations(40))?;
    /// assert_eq!(report.hit_count(), 3);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    #[must_use]
    pub fn components(
        mut self,
        count: usize,
        write: impl Fn(&[S], &mut [S]) + Send + Sync + 'static,
    ) -> Self {
        let write = Arc::new(write);
        self.components = (count > 0).then_some(FnComponents { count, write });
        self
    }

    /// The same problem with another radius within which two points are one answer, in units of the space; 0 lets only
    /// equal points be one. A negative radius or NaN counts as 0. Beside continuous axes, integer axes remain exact.
    #[must_use]
    pub fn separation(mut self, radius: S) -> Self {
        self.separation = separation_of(&self.space, |_| radius.max(S::zero()));
        self.description.parameters = vec![("separation".to_owned(), radius.to_string())];
        self
    }

    /// The same problem with a radius for each axis, in units of the space: two points are one answer if the squares of
    /// distance / radius sum to at most 1. With a radius of 0 only equal values are one, and so it is on a categorical axis and on
    /// the places of a permutation, whatever their radius. On a logarithmic axis distances are those of the natural logarithms.
    ///
    /// ```
    /// use satisfice::{from_fn, Axis, Space};
    /// let space = Space::new([Axis::integer(0, 20), Axis::continuous(0.0, 1000.0), Axis::continuous(-1.0, 1.0)])?;
    /// let problem = from_fn(space, 1.0, |x: &[f64]| x[2].abs()).separations(&[0.0, 25.0, 0.1])?;
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Parameter`] unless there is one radius per axis, finite and not negative.
    pub fn separations(mut self, radii: &[S]) -> Result<Self, Error> {
        let axes = self.space.axes();
        if radii.len() != axes.len() {
            let count = |number: usize, one: &str, more: &str| match number {
                1 => format!("1 {one}"),
                _ => format!("{number} {more}"),
            };
            let (radii, axes) = (
                count(radii.len(), "radius", "radii"),
                count(axes.len(), "axis", "axes"),
            );
            let value = format!("{radii} for {axes}");
            return Err(Error::parameter(
                "separations",
                value,
                "give one radius for each axis",
            ));
        }
        if let Some(radius) = radii
            .iter()
            .find(|radius| !(**radius >= S::zero() && radius.is_finite()))
        {
            return Err(Error::parameter(
                "separations",
                radius,
                "finite radii that are not negative",
            ));
        }
        let pairs = axes.iter().zip(radii);
        self.separation = Separation::axes(pairs.map(|(axis, &radius)| separation_on(axis, radius)));
        let text: Vec<_> = radii.iter().map(S::to_string).collect();
        self.description.parameters = vec![("separations".to_owned(), text.join(" "))];
        Ok(self)
    }
}

impl<S: Real, F: Fn(&[S]) -> S + Sync> SatisficingProblem for FnProblem<S, F> {
    type Scalar = S;
    type Solution = Located<S>;

    fn space(&self) -> &Space<S> {
        &self.space
    }
    fn decode(&self, values: &[S]) -> Located<S> {
        Located::new(values, self.separation.clone())
    }
    #[inline]
    fn decode_into(&self, values: &[S], solution: &mut Located<S>) {
        solution.set(values, &self.separation);
    }
    #[inline]
    fn fitness(&self, solution: &Located<S>) -> S {
        (self.fitness)(&solution.coordinates)
    }
    fn threshold(&self) -> S {
        self.threshold
    }
    fn encoding(&self) -> Option<&dyn Encoding<S, Located<S>>> {
        Some(self)
    }
    fn neighbourhood(&self) -> Option<&dyn Neighbourhood<Located<S>>> {
        self.neighbours.as_ref().map(|neighbours| neighbours as _)
    }
    fn components(&self) -> Option<&dyn Components<S, Located<S>>> {
        self.components.as_ref().map(|components| components as _)
    }
    fn bounds(&self) -> Option<&dyn Bounds<S>> {
        self.bounds.as_ref().map(|bounds| bounds as _)
    }
    fn description(&self) -> Description {
        self.description.clone()
    }
}

impl<S: Real, F> Encoding<S, Located<S>> for FnProblem<S, F> {
    fn encode(&self, solution: &Located<S>, values: &mut [S]) -> bool {
        let fits = solution.coordinates.len() == values.len();
        if fits {
            values.copy_from_slice(&solution.coordinates);
        }
        fits
    }
    fn covers(&self, hit: &Located<S>, region: &Region<S>) -> bool {
        hit.covers(region)
    }
}

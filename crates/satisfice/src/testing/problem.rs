//! The suite for problems: what every implementation of [`SatisficingProblem`] keeps to.
//!
//! ```
//! use satisfice::{from_fn, testing, Space};
//! let problem = from_fn(Space::cube(2, -1.0, 1.0)?, 0.1, |x: &[f64]| x[0].hypot(x[1]));
//! let checked = testing::problem::check(&problem, 1);
//! assert_eq!(checked, []); // no law is broken
//! assert_eq!(checked.untested, []); // and hits were there to test those about hits
//! # Ok::<(), satisfice::Error>(())
//! ```

mod points;

use core::ops::Deref;

use super::Violation;
use crate::identity::Identity;
use crate::problem::{AnyProblem, SatisficingProblem};
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::Region;

/// The laws that the suite checks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ProblemLaw {
    /// The threshold is not NaN and always the same.
    Threshold,
    /// The same values decode to the same solution, also into one that exists.
    Decode,
    /// A solution is the same as itself, sameness is symmetric, and keys find what is the same.
    Identity,
    /// The same solution has the same F to the last bit, alone and among others.
    Fitness,
    /// Encoded values are inside the bounds, whole on integer axes, and decode to the same solution.
    Encode,
    /// Neighbours are offered together with an encoding, and come in the same order each time; those that are encoded are
    /// inside and decode to themselves.
    Neighbours,
    /// No F in a region is below its lower bound, which is not NaN.
    LowerBound,
    /// There is a component, all are the same each time, and none exceeds 1 at a hit.
    Components,
    /// The representative of a hit is its own representative, a hit, and in the space if it is encoded.
    Canonical,
}

/// Neighbours examined from either end of their indices.
const MOST_NEIGHBOURS: usize = 500;
/// Regions examined, and points in each.
const REGIONS: usize = 100;
const SAMPLES: usize = 30;
/// By how much rounding may lift a component of a hit above 1.
const ROUNDING: f64 = 1e-6;

/// The result of [`check`]: the violations, as a slice, and what could not be tested.
///
/// It equals a list if its violations do: `assert_eq!(check(&problem, 1), [])` says that no law was seen broken, and
/// `assert_eq!(check(&problem, 1).untested, [])` that hits were there to see.
#[derive(Debug, Clone)]
pub struct Checked {
    /// The first violation of each law.
    pub violations: Vec<Violation<ProblemLaw>>,
    /// The hits examined.
    pub hits: usize,
    /// The laws about hits, if no hit was found: nothing is known of them. Empty otherwise.
    pub untested: Vec<ProblemLaw>,
}

impl Deref for Checked {
    type Target = [Violation<ProblemLaw>];

    fn deref(&self) -> &Self::Target {
        &self.violations
    }
}

impl<const N: usize> PartialEq<[Violation<ProblemLaw>; N]> for Checked {
    fn eq(&self, other: &[Violation<ProblemLaw>; N]) -> bool {
        self.violations == other
    }
}

impl core::fmt::Display for Checked {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        for violation in &self.violations {
            writeln!(f, "{violation}")?;
        }
        let (violations, hits) = (self.violations.len(), self.hits);
        write!(f, "{violations} laws broken, {hits} hits examined")?;
        if !self.untested.is_empty() {
            write!(f, "; not tested for want of hits: {:?}", self.untested)?;
        }
        Ok(())
    }
}

/// Checks the laws at the corners, in the middle and at random points of a problem's space, and at hits. Lists the first
/// violation of each law.
///
/// Hits come from a search by the default engine: up to 4,000 evaluations, until there are 30. Where hits are so rare that it finds none, the laws
/// about hits are not tested: [`Checked::untested`] lists them. Test `canonical` and `components` at a known hit yourself then, or check
/// the problem with a larger delta.
///
/// Cost: about 9,000 calls of F and `decode`, and about 300 of the other methods.
#[must_use]
pub fn check<P: SatisficingProblem + ?Sized>(problem: &P, seed: u64) -> Checked {
    check_any(&problem, seed)
}

/// Compiled once for each type of solution.
fn check_any<S: Real, T: Identity + Clone + Send + Sync>(
    problem: &AnyProblem<'_, S, T>,
    seed: u64,
) -> Checked {
    let mut rng = SearchRng::new(seed);
    let mut points = points::points(problem.space(), &mut rng);
    let random = points.len();
    let mut suite = ProblemSuite {
        problem,
        violations: Vec::new(),
    };
    suite.threshold();
    points.extend(points::hits(problem, seed));
    suite.decode(&points);
    suite.identity(&points);
    suite.fitness(&points);
    suite.encode(&points);
    suite.neighbours(&points);
    suite.lower_bound(&points, random, &mut rng);
    suite.components(&points);
    suite.canonical(&points);
    let hits = points
        .iter()
        .filter(|point| suite.is_hit(&problem.decode(point)))
        .count();
    let mut untested = Vec::new();
    if hits == 0 {
        untested.extend(problem.components().map(|_| ProblemLaw::Components));
        untested.push(ProblemLaw::Canonical);
    }
    Checked {
        violations: suite.violations,
        hits,
        untested,
    }
}

/// Whether two numbers are the same to the last bit; NaN is NaN.
fn same_bits<S: Real>(a: S, b: S) -> bool {
    a.to_word() == b.to_word() || (a.is_nan() && b.is_nan())
}

struct ProblemSuite<'a, S, T> {
    problem: &'a AnyProblem<'a, S, T>,
    violations: Vec<Violation<ProblemLaw>>,
}

impl<S: Real, T: Identity + Clone + Send + Sync> ProblemSuite<'_, S, T> {
    fn say(&mut self, law: ProblemLaw, at: &[S], what: impl Into<String>) {
        if self.violations.iter().all(|violation| violation.law != law) {
            self.violations.push(Violation {
                law,
                case: format!("{} at {at:?}", self.problem.description().name),
                what: what.into(),
            });
        }
    }

    fn is_hit(&self, solution: &T) -> bool {
        let fitness = self.problem.fitness(solution);
        fitness.is_finite() && fitness < self.problem.threshold()
    }

    fn threshold(&mut self) {
        let [a, b] = [self.problem.threshold(), self.problem.threshold()];
        if a.is_nan() || a != b {
            self.say(ProblemLaw::Threshold, &[], format!("it is {a}, then {b}"));
        }
    }

    fn decode(&mut self, points: &[Vec<S>]) {
        let mut used = None;
        for point in points {
            let [a, b] = [self.problem.decode(point), self.problem.decode(point)];
            if !a.same(&b) {
                self.say(ProblemLaw::Decode, point, "decoded twice, it is another solution");
            }
            let slot = used.get_or_insert_with(|| a.clone());
            self.problem.decode_into(point, slot);
            if !a.same(slot) || a.key() != slot.key() {
                self.say(
                    ProblemLaw::Decode,
                    point,
                    "`decode_into` gives another solution than `decode`",
                );
            }
        }
    }

    fn identity(&mut self, points: &[Vec<S>]) {
        let solutions: Vec<_> = points.iter().map(|point| self.problem.decode(point)).collect();
        for (i, a) in solutions.iter().enumerate() {
            if !a.same(a) {
                self.say(
                    ProblemLaw::Identity,
                    &points[i],
                    "a solution is not the same as itself",
                );
            }
            for b in &solutions {
                let same = a.same(b);
                if same != b.same(a) {
                    self.say(ProblemLaw::Identity, &points[i], "sameness is not symmetric");
                }
                let key = b.key();
                if same && !a.visit_keys(&mut |visited| visited == key) {
                    self.say(
                        ProblemLaw::Identity,
                        &points[i],
                        "a solution that is the same has no visited key",
                    );
                }
            }
        }
    }

    fn fitness(&mut self, points: &[Vec<S>]) {
        let solutions: Vec<_> = points.iter().map(|point| self.problem.decode(point)).collect();
        let mut together = vec![S::of(f64::NAN); solutions.len()];
        self.problem.fitness_all(&solutions, &mut together);
        for ((point, solution), among_others) in points.iter().zip(&solutions).zip(together) {
            let [a, b] = [self.problem.fitness(solution), self.problem.fitness(solution)];
            if !same_bits(a, b) {
                self.say(ProblemLaw::Fitness, point, format!("F is {a}, then {b}"));
            }
            if !same_bits(a, among_others) {
                self.say(
                    ProblemLaw::Fitness,
                    point,
                    format!("F is {a}, but {among_others} by `fitness_all`"),
                );
            }
        }
    }

    fn encode(&mut self, points: &[Vec<S>]) {
        for point in points {
            let solution = self.problem.decode(point);
            self.encodes_to_itself(ProblemLaw::Encode, point, &solution);
        }
    }

    /// Whether a solution that can be encoded decodes to itself.
    fn encodes_to_itself(&mut self, law: ProblemLaw, point: &[S], solution: &T) {
        let mut values = vec![S::of(f64::NAN); point.len()];
        let encoding = self.problem.encoding();
        if !encoding.is_some_and(|encoding| encoding.encode(solution, &mut values)) {
            return;
        }
        if let Err(error) = self.problem.space().check_values(&values) {
            self.say(law, point, format!("encoded as {values:?}: {error}"));
        } else if !self.problem.decode(&values).same(solution) {
            self.say(
                law,
                point,
                format!("encoded as {values:?}, which is another solution"),
            );
        }
    }

    fn neighbours(&mut self, points: &[Vec<S>]) {
        let Some(neighbourhood) = self.problem.neighbourhood() else {
            return;
        };
        if self.problem.encoding().is_none() {
            self.say(
                ProblemLaw::Neighbours,
                &points[0],
                "neighbours are offered without an encoding",
            );
        }
        // Whatever is in it, a neighbour is written over it.
        let mut written = self.problem.decode(&points[0]);
        for point in points {
            let solution = self.problem.decode(point);
            let count = neighbourhood.count(&solution);
            // The first ones and the last ones, where there are many.
            let some = (0..count.min(MOST_NEIGHBOURS)).chain(count.saturating_sub(MOST_NEIGHBOURS)..count);
            for index in some {
                let neighbour = neighbourhood.neighbour(&solution, index);
                let again = neighbourhood.neighbour(&solution, index);
                let is_written = neighbourhood.neighbour_into(&solution, index, &mut written);
                let alike = |other: Option<&T>| match (&neighbour, other) {
                    (Some(a), Some(b)) => a.same(b),
                    (None, None) => true,
                    _ => false,
                };
                let [is_again, is_the_same] = [again.as_ref(), is_written.then_some(&written)].map(alike);
                if !is_again {
                    self.say(
                        ProblemLaw::Neighbours,
                        point,
                        "asked twice, there is another neighbour",
                    );
                }
                if !is_the_same {
                    self.say(
                        ProblemLaw::Neighbours,
                        point,
                        "`neighbour_into` gives another neighbour than `neighbour`",
                    );
                }
                if let Some(neighbour) = neighbour {
                    self.encodes_to_itself(ProblemLaw::Neighbours, point, &neighbour);
                }
            }
            if neighbourhood.neighbour(&solution, count).is_some() {
                self.say(
                    ProblemLaw::Neighbours,
                    point,
                    format!("a neighbour at index {count}, which is the count"),
                );
            }
        }
    }

    /// `random` points were drawn; after them come hits.
    fn lower_bound(&mut self, points: &[Vec<S>], random: usize, rng: &mut SearchRng) {
        let Some(bounds) = self.problem.bounds() else {
            return;
        };
        for i in (0..REGIONS).chain(random..points.len()) {
            let region = region_between(&points[i % 3], &points[i]);
            let bound = bounds.lower_bound(&region);
            let Some(bound) = bound else { continue };
            if bound.is_nan() {
                self.say(
                    ProblemLaw::LowerBound,
                    &points[i],
                    format!("it is NaN in {region:?}"),
                );
            }
            for _ in 0..SAMPLES {
                let Some(point) = points::sample(self.problem.space(), &region, rng) else {
                    break;
                };
                let fitness = self.problem.fitness(&self.problem.decode(&point));
                if fitness < bound {
                    self.say(
                        ProblemLaw::LowerBound,
                        &point,
                        format!("F is {fitness}, the bound {bound} in {region:?}"),
                    );
                }
            }
        }
        for point in points {
            let region = region_between::<S>(point, point);
            let fitness = self.problem.fitness(&self.problem.decode(point));
            if let Some(bound) = bounds.lower_bound(&region)
                && (fitness < bound || bound.is_nan())
            {
                self.say(
                    ProblemLaw::LowerBound,
                    point,
                    format!("F is {fitness}, the bound of that point alone {bound}"),
                );
            }
        }
    }

    fn components(&mut self, points: &[Vec<S>]) {
        let Some(components) = self.problem.components() else {
            return;
        };
        let count = components.count();
        if count == 0 {
            self.say(ProblemLaw::Components, &points[0], "there are none");
        }
        let one = S::of(1.0 + ROUNDING);
        for point in points {
            let solution = self.problem.decode(point);
            let [first, again] = [(); 2].map(|()| {
                let mut all = vec![S::of(f64::NAN); count];
                components.write(&solution, &mut all);
                all
            });
            if !first.iter().zip(&again).all(|(&a, &b)| same_bits(a, b)) {
                let what = format!("they are {first:?}, then {again:?}");
                self.say(ProblemLaw::Components, point, what);
            }
            if self.is_hit(&solution) && !first.iter().all(|x| x.abs() <= one) {
                let fitness = self.problem.fitness(&solution);
                let what = format!("F is {fitness}, a hit, and the components are {first:?}");
                self.say(ProblemLaw::Components, point, what);
            }
        }
    }

    fn canonical(&mut self, points: &[Vec<S>]) {
        for point in points {
            let solution = self.problem.decode(point);
            if !self.is_hit(&solution) {
                continue;
            }
            let Some(once) = self.problem.canonical(&solution) else {
                continue;
            };
            self.encodes_to_itself(ProblemLaw::Canonical, point, &once);
            if !self.is_hit(&once) {
                self.say(
                    ProblemLaw::Canonical,
                    point,
                    "the representative of a hit is no hit",
                );
            } else if self
                .problem
                .canonical(&once)
                .is_some_and(|twice| !twice.same(&once))
            {
                self.say(
                    ProblemLaw::Canonical,
                    point,
                    "a representative has another representative",
                );
            }
        }
    }
}

/// The box that two points span.
fn region_between<S: Real>(a: &[S], b: &[S]) -> Region<S> {
    Region {
        lower: a.iter().zip(b).map(|(&a, &b)| a.min(b)).collect(),
        upper: a.iter().zip(b).map(|(&a, &b)| a.max(b)).collect(),
    }
}

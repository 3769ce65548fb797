//! The suite for problems: what every implementation of [`SatisficingProblem`] keeps to.
//!
//! ```
//! use satisfice::{from_fn, testing, Space};
//! let problem = from_fn(Space::cube(2, -1.0, 1.0)?, 0.1, |x: &[f64]| x[0].hypot(x[1]));
//! assert_eq!(testing::problem::check(&problem, 1), []);
//! # Ok::<(), satisfice::Error>(())
//! ```

use num_traits::Float;

use super::Violation;
use crate::identity::Identity;
use crate::problem::SatisficingProblem;
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
    /// The representative of a hit is its own representative and a hit.
    Canonical,
}

/// Points examined.
const POINTS: usize = 300;
/// Neighbours examined from either end of their indices.
const MOST_NEIGHBOURS: usize = 500;
/// Regions examined, and points in each.
const REGIONS: usize = 100;
const SAMPLES: usize = 30;
/// By how much rounding may lift a component of a hit above 1.
const ROUNDING: f64 = 1e-6;

type Point<P> = Vec<<P as SatisficingProblem>::Scalar>;

/// Checks the laws at the corners, in the middle and at random points of a problem's space. Lists the first violation of each
/// law. Cost: about 4,000 calls of F and `decode`, and about 300 of the other methods.
#[must_use]
pub fn check<P: SatisficingProblem>(problem: &P, seed: u64) -> Vec<Violation<ProblemLaw>> {
    let mut rng = SearchRng::new(seed);
    let points = points(problem, &mut rng);
    let mut suite = ProblemSuite {
        problem,
        violations: Vec::new(),
    };
    suite.threshold();
    suite.decode(&points);
    suite.identity(&points);
    suite.fitness(&points);
    suite.encode(&points);
    suite.neighbours(&points);
    suite.lower_bound(&points, &mut rng);
    suite.components(&points);
    suite.canonical(&points);
    suite.violations
}

/// Random values in a region.
fn sample<P: SatisficingProblem>(problem: &P, region: &Region<P::Scalar>, rng: &mut SearchRng) -> Point<P> {
    let ends = region.lower.iter().zip(&region.upper);
    ends.zip(problem.space().axes())
        .map(|((&lower, &upper), axis)| {
            // The ends themselves are where mistakes are.
            let share = match rng.below(8) {
                0 => 0.0,
                1 => 1.0,
                _ => rng.uniform(),
            };
            let x = lower + P::Scalar::of(share) * (upper - lower);
            let x = if axis.is_integer() { x.round() } else { x };
            x.max(lower).min(upper)
        })
        .collect()
}

fn points<P: SatisficingProblem>(problem: &P, rng: &mut SearchRng) -> Vec<Point<P>> {
    let region = problem.space().region();
    let axes = problem.space().axes();
    let middle = axes.iter().map(|axis| axis.value(axis.at(0.5))).collect();
    let mut points = vec![region.lower.clone(), region.upper.clone(), middle];
    points.extend((0..POINTS).map(|_| sample(problem, &region, rng)));
    points
}

/// Whether two numbers are the same to the last bit; NaN is NaN.
fn same_bits<S: Real>(a: S, b: S) -> bool {
    a.to_word() == b.to_word() || (a.is_nan() && b.is_nan())
}

struct ProblemSuite<'a, P> {
    problem: &'a P,
    violations: Vec<Violation<ProblemLaw>>,
}

impl<P: SatisficingProblem> ProblemSuite<'_, P> {
    fn say(&mut self, law: ProblemLaw, at: &[P::Scalar], what: impl Into<String>) {
        if self.violations.iter().all(|violation| violation.law != law) {
            self.violations.push(Violation {
                law,
                case: format!("{} at {at:?}", self.problem.description().name),
                what: what.into(),
            });
        }
    }

    /// What is wrong with values.
    fn outside(&self, values: &[P::Scalar]) -> Option<String> {
        let axes = self.problem.space().axes();
        for (j, (axis, &x)) in axes.iter().zip(values).enumerate() {
            if !(axis.lower() <= x && x <= axis.upper()) {
                return Some(format!(
                    "{x} on axis {j}, outside [{}, {}]",
                    axis.lower(),
                    axis.upper()
                ));
            }
            if axis.is_integer() && x.round() != x {
                return Some(format!("{x} on axis {j} is not whole"));
            }
        }
        None
    }

    fn threshold(&mut self) {
        let [a, b] = [self.problem.threshold(), self.problem.threshold()];
        if a.is_nan() || a != b {
            self.say(ProblemLaw::Threshold, &[], format!("it is {a}, then {b}"));
        }
    }

    fn decode(&mut self, points: &[Point<P>]) {
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

    fn identity(&mut self, points: &[Point<P>]) {
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

    fn fitness(&mut self, points: &[Point<P>]) {
        let solutions: Vec<_> = points.iter().map(|point| self.problem.decode(point)).collect();
        let mut together = vec![P::Scalar::of(f64::NAN); solutions.len()];
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

    fn encode(&mut self, points: &[Point<P>]) {
        for point in points {
            let solution = self.problem.decode(point);
            self.encodes_to_itself(ProblemLaw::Encode, point, &solution);
        }
    }

    /// Whether a solution that can be encoded decodes to itself.
    fn encodes_to_itself(&mut self, law: ProblemLaw, point: &[P::Scalar], solution: &P::Solution) {
        let mut values = vec![P::Scalar::of(f64::NAN); point.len()];
        let encoding = self.problem.encoding();
        if !encoding.is_some_and(|encoding| encoding.encode(solution, &mut values)) {
            return;
        }
        if let Some(what) = self.outside(&values) {
            self.say(law, point, format!("encoded as {what}"));
        } else if !self.problem.decode(&values).same(solution) {
            self.say(
                law,
                point,
                format!("encoded as {values:?}, which is another solution"),
            );
        }
    }

    fn neighbours(&mut self, points: &[Point<P>]) {
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
                let alike = |other: Option<&P::Solution>| match (&neighbour, other) {
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

    fn lower_bound(&mut self, points: &[Point<P>], rng: &mut SearchRng) {
        let Some(bounds) = self.problem.bounds() else {
            return;
        };
        for i in 0..REGIONS {
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
                let point = sample(self.problem, &region, rng);
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
            let region = region_between::<P::Scalar>(point, point);
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

    fn components(&mut self, points: &[Point<P>]) {
        let Some(components) = self.problem.components() else {
            return;
        };
        let count = components.count();
        if count == 0 {
            self.say(ProblemLaw::Components, &points[0], "there are none");
        }
        let one = P::Scalar::of(1.0 + ROUNDING);
        for point in points {
            let solution = self.problem.decode(point);
            let [first, again] = [(); 2].map(|()| {
                let mut all = vec![P::Scalar::of(f64::NAN); count];
                components.write(&solution, &mut all);
                all
            });
            if !first.iter().zip(&again).all(|(&a, &b)| same_bits(a, b)) {
                let what = format!("they are {first:?}, then {again:?}");
                self.say(ProblemLaw::Components, point, what);
            }
            let fitness = self.problem.fitness(&solution);
            let is_hit = fitness.is_finite() && fitness < self.problem.threshold();
            if is_hit && !first.iter().all(|x| x.abs() <= one) {
                let what = format!("F is {fitness}, a hit, and the components are {first:?}");
                self.say(ProblemLaw::Components, point, what);
            }
        }
    }

    fn canonical(&mut self, points: &[Point<P>]) {
        for point in points {
            let solution = self.problem.decode(point);
            let is_hit = |solution: &P::Solution| self.problem.fitness(solution) < self.problem.threshold();
            if !is_hit(&solution) {
                continue;
            }
            let Some(once) = self.problem.canonical(&solution) else {
                continue;
            };
            if !is_hit(&once) {
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

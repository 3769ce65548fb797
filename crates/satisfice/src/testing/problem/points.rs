//! Where the suite examines a problem: points of its space, and hits of a short search.

use core::ops::Range;

use crate::budget::Budget;
use crate::capability::{Encoding, Neighbourhood};
use crate::identity::{Identity, Located};
use crate::problem::{AnyProblem, BoxedFn, FnProblem, SatisficingProblem, from_fn};
use crate::scalar::Real;
use crate::search::Search;
use crate::seed::SearchRng;
use crate::space::{AxisKind, Region, Space};

/// Points examined.
const POINTS: usize = 300;
/// Evaluations of the searches for hits, and how many the engine is to plan for. Of many, it fits no model of F, which takes longer than
/// most F; the second search, if the first one finds nothing, does.
const SEARCHES: [(u64, u64); 2] = [(3_500, 20_000), (500, 500)];
/// Hits that are enough.
const ENOUGH: u64 = 30;

/// Random values in a region; `None` if it holds no order of a permutation.
pub(super) fn sample<S: Real>(space: &Space<S>, region: &Region<S>, rng: &mut SearchRng) -> Option<Vec<S>> {
    let ends = region.lower.iter().zip(&region.upper);
    let mut values: Vec<S> = ends
        .zip(space.axes())
        .map(|((&lower, &upper), axis)| {
            // The ends themselves are where mistakes are.
            let share = match rng.below(8) {
                0 => 0.0,
                1 => 1.0,
                _ => rng.uniform(),
            };
            let x = lower + S::of(share) * (upper - lower);
            let x = if axis.kind() == AxisKind::Continuous {
                x
            } else {
                x.round()
            };
            x.max(lower).min(upper)
        })
        .collect();
    if !space.order_inside(region, &mut values) {
        return None;
    }
    space.shuffle_inside(region, &mut values, &mut |range: Range<usize>| {
        range.start + rng.below(range.len())
    });
    Some(values)
}

/// The corners and the middle of the space, and random points.
pub(super) fn points<S: Real>(space: &Space<S>, rng: &mut SearchRng) -> Vec<Vec<S>> {
    let region = space.region();
    let [mut lower, mut upper] = [region.lower.clone(), region.upper.clone()];
    // The corners of a permutation: ascending and descending.
    space.order_inside(&region, &mut lower);
    space.order_inside(&region, &mut upper);
    for (axis, x) in space.axes().iter().zip(&mut upper) {
        if axis.kind() == AxisKind::Place {
            *x = axis.lower() + (axis.upper() - *x);
        }
    }
    let mut middle: Vec<S> = space.axes().iter().map(|axis| axis.at(0.5)).collect();
    space.to_values(&mut middle);
    let mut points = vec![lower, upper, middle];
    points.extend((0..POINTS).filter_map(|_| sample(space, &region, rng)));
    points
}

/// Hits that the default engine finds, as values. The problem's bounds, components and representatives are not used, for
/// they may be wrong.
pub(super) fn hits<S: Real, T: Identity + Clone + Send + Sync>(
    problem: &AnyProblem<'_, S, T>,
    seed: u64,
) -> Vec<Vec<S>> {
    let fitness = |x: &[S]| problem.fitness(&problem.decode(x));
    let neighbours = Neighbours { problem };
    let is_offered = problem.neighbourhood().is_some() && problem.encoding().is_some();
    search(
        &Bare {
            inner: from_fn(problem.space().clone(), problem.threshold(), fitness).boxed(),
            neighbours: is_offered.then_some(&neighbours),
        },
        seed,
    )
}

/// Compiled once for each scalar, not for each problem.
fn search<S: Real>(problem: &Bare<'_, S>, seed: u64) -> Vec<Vec<S>> {
    for (evaluations, horizon) in SEARCHES {
        let budget = Budget::evaluations(evaluations)
            .with_horizon(horizon)
            .and_hits(ENOUGH);
        // A threshold of NaN is refused; the suite has a law for it.
        if let Ok(report) = Search::new().seed(seed).run(problem, &budget)
            && report.hit_count() > 0
        {
            return report
                .hits()
                .map(|hit| hit.solution.coordinates.clone())
                .collect();
        }
    }
    Vec::new()
}

/// A problem by its values alone, whatever its solutions are.
struct Bare<'a, S> {
    inner: FnProblem<S, BoxedFn<'a, S>>,
    neighbours: Option<&'a (dyn Neighbourhood<Located<S>> + Sync)>,
}

impl<S: Real> SatisficingProblem for Bare<'_, S> {
    type Scalar = S;
    type Solution = Located<S>;

    fn space(&self) -> &Space<S> {
        self.inner.space()
    }
    fn decode(&self, values: &[S]) -> Located<S> {
        self.inner.decode(values)
    }
    fn fitness(&self, solution: &Located<S>) -> S {
        self.inner.fitness(solution)
    }
    fn threshold(&self) -> S {
        self.inner.threshold()
    }
    fn encoding(&self) -> Option<&dyn Encoding<S, Located<S>>> {
        self.inner.encoding()
    }
    fn neighbourhood(&self) -> Option<&dyn Neighbourhood<Located<S>>> {
        self.neighbours.map(|neighbours| neighbours as _)
    }
}

/// The neighbours that a problem names, at their values.
struct Neighbours<'a, S, T> {
    problem: &'a AnyProblem<'a, S, T>,
}

impl<S: Real, T: Identity + Clone + Send + Sync> Neighbourhood<Located<S>> for Neighbours<'_, S, T> {
    fn count(&self, of: &Located<S>) -> usize {
        let solution = self.problem.decode(&of.coordinates);
        let neighbourhood = self.problem.neighbourhood();
        neighbourhood.map_or(0, |neighbourhood| neighbourhood.count(&solution))
    }

    fn neighbour(&self, of: &Located<S>, index: usize) -> Option<Located<S>> {
        let solution = self.problem.decode(&of.coordinates);
        let neighbour = self.problem.neighbourhood()?.neighbour(&solution, index)?;
        let mut values = of.coordinates.clone();
        let encoded = self.problem.encoding()?.encode(&neighbour, &mut values);
        // Neighbours outside the space are for the suite to report.
        let is_inside = encoded && self.problem.space().check_values(&values).is_ok();
        is_inside.then(|| Located::new(&values, of.separation.clone()))
    }
}

//! Whether points that were evaluated contradict the bounds by which a slice excluded regions.

use crate::accounting::Ledger;
use crate::identity::Identity;
use crate::problem::AnyProblem;
use crate::scalar::Real;
use crate::space::{AxisKind, Region, Space};

/// Calls of the bounds that are made to look for one, beside a share of those of the slice.
const CALLS: u64 = 64;
const SHARE: u64 = 8;
/// By how much of F and delta rounding may lift a bound above F where it excludes no hit.
const ROUNDING: f64 = 1e-6;

/// Whether a bound is above F of a point in its region: of the best candidate or of a hit, in the whole space and in ever smaller halves around
/// the point. Cost: at most 64 calls of the bounds and an eighth of those `made` so far, which are counted nowhere.
pub(super) fn is_contradicted<S: Real, T: Identity + Clone + Send + Sync>(
    problem: &AnyProblem<'_, S, T>,
    ledger: &Ledger<T>,
    made: u64,
) -> bool {
    let Some(bounds) = problem.bounds() else {
        return false;
    };
    let (space, threshold) = (problem.space(), problem.threshold().f64());
    let mut calls = 0;
    let mut contradicts = |region: &Region<S>, fitness: f64| {
        calls += 1;
        let bound = bounds.lower_bound(region).map_or(f64::NEG_INFINITY, Real::f64);
        let excludes_a_hit = fitness < threshold && threshold <= bound;
        let is_far = bound - fitness > ROUNDING * (fitness.abs() + threshold.abs());
        (excludes_a_hit || is_far, calls < CALLS + made / SHARE)
    };
    let best = ledger.best.get().map(|best| (&best.solution, best.fitness));
    let hits = ledger.archive.iter().map(|hit| (hit.solution, hit.fitness));
    let mut region = space.region();
    for (solution, fitness) in best.into_iter().chain(hits) {
        let mut values = region.lower.clone();
        let encoding = problem.encoding();
        let is_encoded = encoding.is_some_and(|encoding| encoding.encode(solution, &mut values));
        region = space.region();
        loop {
            match contradicts(&region, fitness) {
                (true, _) => return true,
                (false, false) => return false,
                (false, true) => {}
            }
            let is_known = is_encoded && space.check_values(&values).is_ok();
            if !(is_known && halve(space, &mut region, &values)) {
                break;
            }
        }
    }
    false
}

/// Halves a region on its longest axis, relative to the length of the whole axis, around values inside; `false` if all axes are fixed.
fn halve<S: Real>(space: &Space<S>, region: &mut Region<S>, values: &[S]) -> bool {
    let length = |j: usize| {
        space.axes()[j]
            .share_between(region.lower[j], region.upper[j])
            .f64()
    };
    let longest = (0..values.len())
        .filter(|&j| region.lower[j] < region.upper[j])
        .max_by(|&a, &b| length(a).total_cmp(&length(b)));
    let Some(j) = longest else { return false };
    let middle = region.middle(space, j);
    if values[j] <= middle {
        let is_smaller = middle < region.upper[j];
        region.upper[j] = middle;
        is_smaller
    } else {
        let step = if space.axes()[j].kind() == AxisKind::Continuous {
            S::zero()
        } else {
            S::one()
        };
        let is_smaller = middle + step > region.lower[j];
        region.lower[j] = middle + step;
        is_smaller
    }
}

#[cfg(test)]
mod tests {
    use crate::{
        Bounds, Budget, Completeness, Encoding, Located, Region, SatisficingProblem, Search, Space,
        StopReason,
    };

    #[derive(Debug, Clone, Copy, PartialEq)]
    enum Bound {
        /// The least sum.
        Sound,
        /// The same, lifted by rounding.
        Rounded,
        Infinite,
        /// The greatest sum.
        WrongEnd,
    }

    /// Sums of two numbers.
    struct Sums {
        space: Space<f64>,
        bound: Bound,
        threshold: f64,
    }

    impl SatisficingProblem for Sums {
        type Scalar = f64;
        type Solution = Located<f64>;
        fn space(&self) -> &Space<f64> {
            &self.space
        }
        fn decode(&self, values: &[f64]) -> Located<f64> {
            Located::new(values, 0.0)
        }
        fn fitness(&self, at: &Located<f64>) -> f64 {
            at.coordinates.iter().sum::<f64>() + 7.0
        }
        fn threshold(&self) -> f64 {
            self.threshold
        }
        fn encoding(&self) -> Option<&dyn Encoding<f64, Located<f64>>> {
            Some(self)
        }
        fn bounds(&self) -> Option<&dyn Bounds<f64>> {
            Some(self)
        }
    }

    impl Encoding<f64, Located<f64>> for Sums {
        fn encode(&self, at: &Located<f64>, values: &mut [f64]) -> bool {
            values.copy_from_slice(&at.coordinates);
            true
        }
    }

    impl Bounds<f64> for Sums {
        fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
            let least = region.lower.iter().sum::<f64>() + 7.0;
            Some(match self.bound {
                Bound::Sound => least,
                Bound::Rounded => least * (1.0 + 1e-15),
                Bound::Infinite => f64::INFINITY,
                Bound::WrongEnd => region.upper.iter().sum::<f64>() + 7.0,
            })
        }
    }

    /// The number of hits of a run, and whether it is proved that there are no others.
    fn run(engine: &str, bound: Bound, threshold: f64) -> (usize, Completeness) {
        let space = Space::lattice(2, 300).unwrap();
        let problem = Sums {
            space,
            bound,
            threshold,
        };
        let mut search = Search::named(engine).unwrap().probes(0.0);
        let report = search.run(&problem, &Budget::evaluations(20_000)).unwrap();
        assert_eq!(report.stop_reason, StopReason::Covered, "{bound:?}");
        (report.hit_count(), report.completeness)
    }

    #[test]
    fn a_sound_bound_proves() {
        for engine in ["branch-and-bound", "portfolio"] {
            for bound in [Bound::Sound, Bound::Rounded] {
                assert_eq!(run(engine, bound, 20.0), (91, Completeness::Proved), "{engine}");
                assert_eq!(run(engine, bound, 7.0), (0, Completeness::Proved), "{engine}");
            }
        }
    }

    #[test]
    fn a_bound_above_the_fitness_of_a_point_that_was_evaluated_proves_nothing() {
        for bound in [Bound::Infinite, Bound::WrongEnd] {
            let (_, completeness) = run("portfolio", bound, 20.0);
            assert_eq!(completeness, Completeness::Unknown, "{bound:?}");
        }
        // No hit, but an F that is below a bound.
        assert_eq!(run("portfolio", Bound::Infinite, 7.0), (0, Completeness::Unknown));
    }
}

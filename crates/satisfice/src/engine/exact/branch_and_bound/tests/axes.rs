//! Logarithmic and periodic axes, and large permutations.

use super::*;
use crate::{AxisSeparation, Separation};

/// A function of one coordinate with its bound.
struct OneAxis<F, B> {
    space: Space<f64>,
    separation: AxisSeparation<f64>,
    threshold: f64,
    fitness: F,
    bound: B,
}

impl<F: Fn(f64) -> f64 + Sync, B: Fn(f64, f64) -> f64 + Sync> SatisficingProblem for OneAxis<F, B> {
    type Scalar = f64;
    type Solution = Located<f64>;
    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> Located<f64> {
        Located::new(values, Separation::axes([self.separation]))
    }
    fn fitness(&self, at: &Located<f64>) -> f64 {
        (self.fitness)(at.coordinates[0])
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

impl<F, B> Encoding<f64, Located<f64>> for OneAxis<F, B> {
    fn encode(&self, hit: &Located<f64>, values: &mut [f64]) -> bool {
        values.copy_from_slice(&hit.coordinates);
        true
    }
    fn covers(&self, hit: &Located<f64>, region: &Region<f64>) -> bool {
        hit.covers(region)
    }
}

impl<F, B: Fn(f64, f64) -> f64> Bounds<f64> for OneAxis<F, B> {
    fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
        Some((self.bound)(region.lower[0], region.upper[0]))
    }
}

#[test]
fn a_logarithmic_axis_is_halved_and_measured_by_its_logarithm() {
    for (lower, place) in [(1e-15, 1e-13), (1e-300, 1e-290), (1e-300, 0.5)] {
        let space = Space::new([Axis::continuous(lower, 1.0).logarithmic()]).unwrap();
        let problem = OneAxis {
            space,
            separation: AxisSeparation::within(0.05).logarithmic(),
            threshold: 0.2,
            fitness: |x: f64| (x / place).ln().abs(),
            bound: |lower: f64, upper: f64| {
                let away = (-(upper / place).ln()).max((lower / place).ln());
                away.max(0.0) - 1e-9
            },
        };
        let report = run(&problem, &[], 2000);
        assert_eq!(report.completeness, Completeness::Proved, "{report}");
        let hits: Vec<f64> = report.hits().map(|hit| hit.solution.coordinates[0]).collect();
        for i in 0..1000 {
            let x = place * (0.3998 * (f64::from(i) / 999.0 - 0.5)).exp();
            assert!(
                hits.iter().any(|hit| (hit / x).ln().abs() < 0.05 + 1e-12),
                "{x}: {hits:?}"
            );
        }
    }
}

#[test]
fn halves_of_a_logarithmic_axis_lose_no_value() {
    let space = Space::<f64>::new([Axis::continuous(1e-200, 1.0).logarithmic()]).unwrap();
    let mut rng = SearchRng::new(2);
    for _ in 0..200 {
        let x = (-460.0 * rng.uniform()).exp();
        let mut region = space.region();
        for _ in 0..200 {
            let middle = region.middle(&space, 0);
            assert!(region.lower[0] <= middle && middle <= region.upper[0]);
            if x <= middle {
                region.upper[0] = middle;
            } else {
                region.lower[0] = middle;
            }
        }
        // Down to two neighbours among the numbers.
        assert!(
            region.upper[0].to_bits() - region.lower[0].to_bits() <= 1,
            "{region:?}"
        );
    }
}

/// The angles near one of them, on either side of the end of the turn.
#[test]
fn a_periodic_axis_is_proved_over_its_end() {
    let space = Space::new([Axis::continuous(0.0, 360.0).periodic()]).unwrap();
    let away = |x: f64| x.min(360.0 - x);
    let problem = OneAxis {
        space,
        separation: AxisSeparation::within(15.0).periodic(360.0),
        threshold: 20.0,
        fitness: away,
        bound: |lower: f64, upper: f64| away(lower).min(away(upper)),
    };
    let report = run(&problem, &[], 2000);
    assert_eq!(report.completeness, Completeness::Proved, "{report}");
    let hits: Vec<f64> = report.hits().map(|hit| hit.solution.coordinates[0]).collect();
    for i in -199..200 {
        let x = f64::from(i) / 10.0;
        assert!(
            hits.iter().any(|hit| away((hit - x).rem_euclid(360.0)) <= 15.0),
            "{x}: {hits:?}"
        );
    }
}

/// The sum of the distances of values from their places, with its bound.
struct Displacement {
    space: Space<f64>,
}

impl SatisficingProblem for Displacement {
    type Scalar = f64;
    type Solution = Vec<u32>;
    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> Vec<u32> {
        values.iter().map(|&x| x as u32).collect()
    }
    fn fitness(&self, order: &Vec<u32>) -> f64 {
        (0..)
            .zip(order)
            .map(|(place, &x)| f64::from(x.abs_diff(place)))
            .sum()
    }
    fn threshold(&self) -> f64 {
        1e6
    }
    fn bounds(&self) -> Option<&dyn Bounds<f64>> {
        Some(self)
    }
}

impl Bounds<f64> for Displacement {
    fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
        let sides = region.lower.iter().zip(&region.upper).zip(0..);
        let away = |((&lower, &upper), place): ((&f64, &f64), u32)| {
            (lower - f64::from(place)).max(f64::from(place) - upper).max(0.0)
        };
        Some(sides.map(away).sum())
    }
}

/// The way to the first leaf of a permutation of hundreds is thousands of regions long, of which each one's bound counts.
#[test]
fn large_permutations_are_evaluated_before_the_first_leaf() {
    let problem = Displacement {
        space: Space::new(Axis::permutation(300)).unwrap(),
    };
    let report = run(&problem, &[], 2000);
    assert!(report.counts.bound_calls > 1500, "{report}");
    assert!(
        report.counts.evaluations > 10 && report.hit_count() > 5,
        "{report}"
    );
    for hit in report.hits() {
        let mut order = hit.solution.clone();
        order.sort_unstable();
        assert!(order.into_iter().eq(0..300));
    }
}

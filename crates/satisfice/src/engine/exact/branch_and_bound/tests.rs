//! Proofs are checked by enumeration, or by new samples of the space.

mod axes;

use crate::{Bounds, Encoding};
use std::collections::BTreeSet;

use crate::engine::find;
use crate::{
    Axis, Budget, Completeness, Located, Real, Region, Report, SatisficingProblem, Search, SearchRng, Space,
    StopReason, from_fn,
};

/// All points within `width` of a sphere: F = | |x - centre| - radius |, with or without its bound.
struct Shell<S> {
    space: Space<S>,
    centre: Vec<S>,
    radius: S,
    width: S,
    separation: S,
    bounded: bool,
    /// Subtracted from the bound.
    slack: S,
    covers: bool,
}

impl<S: Real> Shell<S> {
    fn new(space: Space<S>, centre: &[f64], radius: f64, width: f64, separation: f64) -> Self {
        Self {
            space,
            centre: centre.iter().map(|&x| S::of(x)).collect(),
            radius: S::of(radius),
            width: S::of(width),
            separation: S::of(separation),
            bounded: true,
            slack: S::zero(),
            covers: true,
        }
    }
    fn distance(&self, at: impl Iterator<Item = S>) -> S {
        at.zip(&self.centre)
            .fold(S::zero(), |sum, (x, &c)| sum + (x - c) * (x - c))
            .sqrt()
    }
    fn value(&self, at: &[S]) -> S {
        (self.distance(at.iter().copied()) - self.radius).abs()
    }
}

impl<S: Real> SatisficingProblem for Shell<S> {
    type Scalar = S;
    type Solution = Located<S>;
    fn space(&self) -> &Space<S> {
        &self.space
    }
    fn decode(&self, values: &[S]) -> Located<S> {
        Located::new(values, self.separation)
    }
    fn fitness(&self, at: &Located<S>) -> S {
        self.value(&at.coordinates)
    }
    fn threshold(&self) -> S {
        self.width
    }
    fn encoding(&self) -> Option<&dyn Encoding<S, Located<S>>> {
        Some(self)
    }
    fn bounds(&self) -> Option<&dyn Bounds<S>> {
        self.bounded.then_some(self as _)
    }
}

impl<S: Real> Encoding<S, Located<S>> for Shell<S> {
    fn encode(&self, hit: &Located<S>, values: &mut [S]) -> bool {
        values.copy_from_slice(&hit.coordinates);
        true
    }
    fn covers(&self, hit: &Located<S>, region: &Region<S>) -> bool {
        self.covers && hit.covers(region)
    }
}

impl<S: Real> Bounds<S> for Shell<S> {
    fn lower_bound(&self, region: &Region<S>) -> Option<S> {
        let ends = || region.lower.iter().zip(&region.upper).zip(&self.centre);
        // Every operation is monotone, rounding included.
        let nearest = self.distance(ends().map(|((&l, &u), &c)| c.max(l).min(u)));
        let farthest = self.distance(ends().map(|((&l, &u), &c)| if c - l > u - c { l } else { u }));
        Some((nearest - self.radius).max(self.radius - farthest).max(S::zero()) - self.slack)
    }
}

fn run<P: SatisficingProblem>(
    problem: &P,
    settings: &[(&str, &str)],
    evaluations: u64,
) -> Report<P::Solution> {
    let engine = find("branch-and-bound")
        .unwrap()
        .configure(settings.iter().copied())
        .unwrap();
    Search::with(engine)
        .run(problem, &Budget::evaluations(evaluations))
        .unwrap()
}

/// Every lattice point of a problem of integer axes from 0, and whether it is a hit.
fn enumerate<S: Real>(problem: &Shell<S>) -> BTreeSet<Vec<i64>> {
    let mut hits = BTreeSet::new();
    let mut point = vec![0_i64; problem.space.dimension()];
    loop {
        let values: Vec<S> = point.iter().map(|&x| S::of(x as f64)).collect();
        if problem.value(&values) < problem.width {
            hits.insert(point.clone());
        }
        let axes = problem.space.axes();
        let Some(j) = (0..point.len()).rfind(|&j| S::of(point[j] as f64) < axes[j].upper()) else {
            return hits;
        };
        point[j] += 1;
        point[j + 1..].fill(0);
    }
}

fn integers<S: Real>(report: &Report<Located<S>>) -> BTreeSet<Vec<i64>> {
    report
        .hits()
        .map(|hit| hit.solution.coordinates.iter().map(|x| x.f64() as i64).collect())
        .collect()
}

fn lattices_are_searched_exactly<S: Real>() {
    for (dimension, cells) in [(1, 1), (1, 100), (2, 37), (3, 17), (5, 5)] {
        let space = Space::<S>::lattice(dimension, cells).unwrap();
        let middle = vec![f64::from(cells) / 2.0; dimension];
        let mut problem = Shell::new(space, &middle, f64::from(cells) / 3.0, 0.6, 0.0);
        let expected = enumerate(&problem);
        let points = u64::from(cells).pow(dimension as u32);
        for settings in [
            &[][..],
            &[("leaf", "1")],
            &[("leaf", "1000"), ("batch", "1")],
            &[("regions", "1")],
            &[("regions", "3"), ("split", "first")],
        ] {
            problem.bounded = true;
            let report = run(&problem, settings, 100 * points + 1000);
            assert_eq!(integers(&report), expected, "{settings:?}");
            assert_eq!(
                (report.stop_reason, report.completeness),
                (StopReason::Covered, Completeness::Proved)
            );
            assert!(report.counts.evaluations <= points && report.counts.duplicates == 0);

            problem.bounded = false;
            let report = run(&problem, settings, points);
            assert_eq!(integers(&report), expected, "{settings:?}");
            assert_eq!(report.completeness, Completeness::Proved);
            assert_eq!(report.counts.evaluations, points, "an enumeration");
            assert_eq!(report.counts.bound_calls, 0);
        }
    }
}

#[test]
fn lattices_are_searched_exactly_in_f64() {
    lattices_are_searched_exactly::<f64>();
}
#[test]
fn lattices_are_searched_exactly_in_f32() {
    lattices_are_searched_exactly::<f32>();
}

#[test]
fn bounds_spare_most_of_a_large_space() {
    let space = Space::<f64>::lattice(2, 20_000).unwrap();
    let problem = Shell::new(space, &[5000.0, 7000.0], 40.0, 0.25, 0.0);
    let report = run(&problem, &[], 100_000);
    // Gauss's circle, counted by hand: points with 39.75 < r < 40.25.
    let expected = (-41_i32..=41)
        .flat_map(|x| (-41_i32..=41).map(move |y| f64::from(x * x + y * y).sqrt()))
        .filter(|r| (r - 40.0).abs() < 0.25)
        .count();
    assert_eq!(
        (report.hit_count(), report.completeness),
        (expected, Completeness::Proved)
    );
    assert!(
        report.counts.evaluations + report.counts.bound_calls < 10_000,
        "{report}"
    );
}

/// New sample points of the shell are all the same answer as some hit.
fn covers_the_shell<S: Real>(problem: &Shell<S>, report: &Report<Located<S>>) {
    let mut rng = SearchRng::new(5);
    let (mut position, mut values) = (vec![S::zero(); problem.space.dimension()], Vec::new());
    let mut drawn = 0;
    for _ in 0..200_000 {
        rng.position(&problem.space, &mut position);
        values.clone_from(&position);
        problem.space.values(&position, &mut values);
        if problem.value(&values) < problem.width {
            drawn += 1;
            assert!(
                report.archive.contains(&problem.decode(&values)),
                "{values:?} is missing"
            );
        }
    }
    assert!(drawn > 100, "{drawn} samples are no evidence");
}

fn continuous_spaces_are_proved<S: Real>() {
    let line = Space::cube(1, S::of(-2.0), S::of(2.0)).unwrap();
    let plane = Space::cube(2, S::of(-2.0), S::of(2.0)).unwrap();
    let solid = Space::cube(3, S::of(-2.0), S::of(2.0)).unwrap();
    let mixed = Space::new([Axis::integer(-2, 2), Axis::continuous(S::of(-2.0), S::of(2.0))]).unwrap();
    let fixed = Space::new([
        Axis::continuous(S::of(-2.0), S::of(2.0)),
        Axis::continuous(S::of(0.5), S::of(0.5)),
    ])
    .unwrap();
    for (space, width, separation) in [
        (line, 0.1, 0.5),
        (plane.clone(), 0.05, 0.3),
        (plane, 0.7, 0.25),
        (solid, 0.1, 0.6),
        (mixed, 0.05, 0.1),
        (fixed, 0.2, 0.2),
    ] {
        let centre = [0.1, -0.2, 0.05];
        let problem = Shell::new(space, &centre, 1.2, width, separation);
        let report = run(&problem, &[], 100_000);
        assert_eq!(
            report.completeness,
            Completeness::Proved,
            "{report} {:?}",
            problem.space
        );
        covers_the_shell(&problem, &report);
        for (i, a) in report.hits().enumerate() {
            assert!(problem.value(&a.solution.coordinates) < problem.width);
            assert!(
                report
                    .hits()
                    .skip(i + 1)
                    .all(|b| !crate::Identity::same(a.solution, b.solution))
            );
        }
        // In bounded memory the proof is the same, in another order.
        let frugal = run(&problem, &[("regions", "64")], 100_000);
        assert_eq!(frugal.completeness, Completeness::Proved, "{frugal}");
        covers_the_shell(&problem, &frugal);
    }
}

#[test]
fn continuous_spaces_are_proved_in_f64() {
    continuous_spaces_are_proved::<f64>();
}
#[test]
fn continuous_spaces_are_proved_in_f32() {
    continuous_spaces_are_proved::<f32>();
}

#[test]
fn no_hit_can_be_a_theorem() {
    let plane = Space::<f64>::cube(2, -2.0, 2.0).unwrap();
    let problem = Shell::new(plane, &[0.0, 0.0], 5.0, 0.1, 0.1);
    let report = run(&problem, &[], 1000);
    assert_eq!(
        (report.hit_count(), report.completeness),
        (0, Completeness::Proved)
    );
    // F at the corners is 5 - 2 sqrt 2 or more: the first bound says so.
    assert_eq!((report.counts.evaluations, report.counts.bound_calls), (0, 1));
}

#[test]
fn what_cannot_be_proved_is_not_claimed() {
    let plane = || Space::<f64>::cube(2, -2.0, 2.0).unwrap();
    // F touches the threshold everywhere on a circle and is below it nowhere.
    let mut touching = Shell::new(plane(), &[0.0, 0.0], 1.0, 0.0, 0.1);
    touching.slack = 0.05;
    let report = run(&touching, &[("resolution", "0.05")], 100_000);
    assert_eq!(
        (report.hit_count(), report.stop_reason, report.completeness),
        (0, StopReason::Exhausted, Completeness::Unknown)
    );
    // Hits are found, but the problem does not say what they cover.
    (touching.width, touching.slack) = (0.1, 0.0);
    touching.covers = false;
    let report = run(&touching, &[("resolution", "0.05")], 100_000);
    assert!(report.hit_count() > 20, "{report}");
    assert_eq!(
        (report.stop_reason, report.completeness),
        (StopReason::Exhausted, Completeness::Unknown)
    );
}

#[test]
fn bounds_use_up_the_budget() {
    // A bound that excludes nothing, of a fitness without hits: only the budget ends this in time.
    let mut problem = Shell::new(
        Space::<f64>::cube(3, -2.0, 2.0).unwrap(),
        &[0.0; 3],
        1.0,
        0.0,
        0.1,
    );
    problem.slack = 10.0;
    for limit in [1, 2, 3, 10, 1000] {
        let report = run(&problem, &[], limit);
        let spent = report.counts.evaluations + report.counts.bound_calls;
        assert_eq!(report.stop_reason, StopReason::Evaluations);
        assert!(spent >= limit && spent <= limit + 2, "{spent} of {limit}");
        assert!(report.counts.evaluations <= limit);
    }
    // On a large lattice, many bounds come before the first point.
    problem.space = Space::lattice(3, 100_000).unwrap();
    problem.slack = 1e9;
    let cancel = crate::Cancel::new();
    let budget = Budget::until(&cancel).and_time(core::time::Duration::from_millis(20));
    let mut search = Search::with(find("branch-and-bound").unwrap().configure([]).unwrap());
    assert_eq!(
        search.run(&problem, &budget).unwrap().stop_reason,
        StopReason::Time
    );
}

#[test]
fn the_last_point_of_the_space_and_of_the_budget() {
    let problem = from_fn(Space::<f64>::lattice(2, 8).unwrap(), 1.0, |x: &[f64]| x[0] * x[1]).boxed();
    let report = run(&problem, &[], 64);
    assert_eq!((report.counts.evaluations, report.counts.bound_calls), (64, 0));
    assert_eq!(
        (report.hit_count(), report.completeness),
        (15, Completeness::Proved)
    );
    let report = run(&problem, &[], 63);
    assert_eq!(report.completeness, Completeness::Unknown);
}

#[cfg(feature = "interval")]
#[test]
fn the_four_roots_of_himmelblau_are_all() {
    use crate::interval::{EnclosureOps, lower_bound, sides};

    struct Himmelblau(Space<f64>);
    impl SatisficingProblem for Himmelblau {
        type Scalar = f64;
        type Solution = Located<f64>;
        fn space(&self) -> &Space<f64> {
            &self.0
        }
        fn decode(&self, values: &[f64]) -> Located<f64> {
            Located::new(values, 0.5)
        }
        fn fitness(&self, at: &Located<f64>) -> f64 {
            let (x, y) = (at.coordinates[0], at.coordinates[1]);
            let (a, b) = (x * x + y - 11.0, x + y * y - 7.0);
            a * a + b * b
        }
        fn threshold(&self) -> f64 {
            1e-6
        }
        fn encoding(&self) -> Option<&dyn Encoding<f64, Located<f64>>> {
            Some(self)
        }
        fn bounds(&self) -> Option<&dyn Bounds<f64>> {
            Some(self)
        }
    }

    impl Encoding<f64, Located<f64>> for Himmelblau {
        fn encode(&self, hit: &Located<f64>, values: &mut [f64]) -> bool {
            values.copy_from_slice(&hit.coordinates);
            true
        }
        fn covers(&self, hit: &Located<f64>, region: &Region<f64>) -> bool {
            hit.covers(region)
        }
    }

    impl Bounds<f64> for Himmelblau {
        fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
            let [x, y] = sides(region)?;
            lower_bound((x.sqr() + y - 11.0).sqr() + (x + y.sqr() - 7.0).sqr())
        }
    }
    let report = run(&Himmelblau(Space::cube(2, -6.0, 6.0).unwrap()), &[], 100_000);
    assert_eq!(
        (report.hit_count(), report.completeness),
        (4, Completeness::Proved),
        "{report}"
    );
    for (x, y) in [
        (3.0, 2.0),
        (-2.805118, 3.131312),
        (-3.779310, -3.283186),
        (3.584428, -1.848126),
    ] {
        assert!(report.hits().any(|hit| {
            let at = &hit.solution.coordinates;
            (at[0] - x).hypot(at[1] - y) < 1e-3
        }));
    }
}

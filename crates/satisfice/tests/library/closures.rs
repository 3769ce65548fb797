//! What a problem from a closure may say beside its fitness.

#![allow(clippy::unwrap_used, reason = "a test")]

use satisfice::problem::{BoxedFn, FnProblem};
use satisfice::testing::problem::{ProblemLaw, check};
use satisfice::{Axis, Budget, SatisficingProblem, Search, Space, from_fn};

/// By how much a choice of 30 items is heavier than 300 and worth less than 338. The lightest choice worth so much is not much lighter.
fn knapsack(x: &[f64]) -> f64 {
    let (mut weight, mut value) = (0.0, 0.0);
    for (x, i) in x.iter().zip(0..) {
        let item = f64::from(5 + 37 * i % 41);
        weight += x * item;
        value += x * (item * (0.6 + 0.8 * f64::from(53 * i % 97) / 97.0)).round();
    }
    (weight - 300.0).max(0.0) + (338.0 - value).max(0.0)
}

#[test]
fn neighbours_are_those_of_the_closure() {
    let space = Space::lattice(4, 2).unwrap();
    let problem = from_fn(space, 1.0, |x: &[f64]| x[0])
        .neighbours(6, |x, i| {
            if i >= 4 {
                return false;
            }
            x[i] = 1.0 - x[i];
            true
        })
        .boxed();
    let neighbours = problem.neighbourhood().unwrap();
    let of = problem.decode(&[0.0, 1.0, 0.0, 1.0]);
    assert_eq!(neighbours.count(&of), 6);
    let at = |i| neighbours.neighbour(&of, i).map(|there| there.coordinates);
    assert_eq!(at(1), Some(vec![0.0, 0.0, 0.0, 1.0]));
    assert_eq!((at(4), at(6), at(1000)), (None, None, None));
    assert_eq!(check(&problem, 1), []);
}

#[test]
fn neighbours_outside_the_space_are_found_out() {
    let space = Space::lattice(2, 10).unwrap();
    let problem = from_fn(space, 5.0, |x: &[f64]| x[0] + x[1])
        .neighbours(1, |x, _| {
            x[0] += 1.0;
            true
        })
        .boxed();
    let laws: Vec<_> = check(&problem, 1).iter().map(|violation| violation.law).collect();
    assert_eq!(laws, [ProblemLaw::Neighbours]);
}

/// A swap of an item inside for one outside keeps a choice near its weight; a step along one axis does not. Both searches are without a
/// model, which takes most of their time and knows nothing of neighbours.
#[test]
fn neighbours_of_a_closure_are_used() {
    let plain = from_fn(Space::lattice(30, 2).unwrap(), 0.5, knapsack).boxed();
    let named = with_swaps();
    let hits = |problem, evaluations, seeds: u64| {
        let one = |seed| {
            Search::new()
                .set("without", "model")
                .unwrap()
                .seed(seed)
                .run(problem, &Budget::evaluations(evaluations))
        };
        (1..=seeds)
            .map(|seed| one(seed).unwrap().hit_count())
            .sum::<usize>()
    };
    for (evaluations, seeds) in [(1000, 24), (10_000, 24)] {
        let (without, with) = (hits(&plain, evaluations, seeds), hits(&named, evaluations, seeds));
        println!(
            "{evaluations} evaluations, {seeds} seeds: {without} hits without named neighbours, {with} with them"
        );
        assert!(with > 2 * without, "{with} {without}");
    }
}

fn with_swaps() -> FnProblem<f64, BoxedFn<'static, f64>> {
    from_fn(Space::lattice(30, 2).unwrap(), 0.5, knapsack)
        .neighbours(31 * 30, |x, index| {
            let (i, j) = (index % 30, index / 30);
            if j == 30 {
                x[i] = 1.0 - x[i];
                return true;
            }
            x.swap(i, j);
            i < j && x[i] != x[j]
        })
        .boxed()
}

#[test]
fn too_few_radii_are_counted() {
    let problem = |axes| from_fn(Space::new(axes).unwrap(), 1.0, |x: &[f64]| x[0]).boxed();
    let axis = Axis::continuous(0.0, 1.0);
    let text = |axes, radii: &[f64]| match problem(axes).separations(radii) {
        Err(error) => error.to_string(),
        Ok(_) => String::new(),
    };
    assert_eq!(
        text(vec![axis; 2], &[0.1]),
        "separations = 1 radius for 2 axes is not allowed: give one radius for each axis"
    );
    assert!(text(vec![axis], &[0.1, 0.2]).starts_with("separations = 2 radii for 1 axis "));
}

#[test]
fn bounds_that_are_known_of_small_regions_only_prove_all_the_same() {
    let space = Space::lattice(2, 4096).unwrap();
    let problem = from_fn(space, 4.0, |x: &[f64]| {
        (x[0] - 2000.0).abs() + (x[1] - 1000.0).abs()
    })
    .bounds(|region| {
        let is_small = (0..2).all(|k| region.upper[k] - region.lower[k] < 40.0);
        let beyond = |k: usize, at: f64| (region.lower[k] - at).max(at - region.upper[k]).max(0.0);
        is_small.then(|| beyond(0, 2000.0) + beyond(1, 1000.0))
    })
    .boxed();
    let mut search = Search::named("branch-and-bound").unwrap();
    let report = search.run(&problem, &Budget::evaluations(200_000)).unwrap();
    assert_eq!(report.completeness, satisfice::Completeness::Proved);
    assert_eq!(report.hit_count(), 25);
}

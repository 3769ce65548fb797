//! A slice that follows another, after Chen et al.: what moves is searched again from what is known.

#![allow(clippy::unwrap_used, reason = "a test")]

use satisfice::engine::WarmStart;
use satisfice::problem::{BoxedFn, FnProblem};
use satisfice::{Budget, Report, Search, Space, from_fn};

/// Points near a corner of a large lattice, `height` above which F is at least: two bodies that approach each other.
fn at_height(height: f64) -> FnProblem<f64, BoxedFn<'static, f64>> {
    let space = Space::lattice(2, 1000).unwrap();
    let distance = move |x: &[f64]| (x[0] - 871.0).abs() + (x[1] - 263.0).abs() + height;
    from_fn(space, 40.0, distance).boxed()
}

/// How many hits and near misses of the slice before a slice evaluates, after one without hits.
fn after_a_slice_without_hits(rule: WarmStart) -> (usize, u64) {
    let mut search = Search::new()
        .set("without", "model")
        .unwrap()
        .seed(3)
        .warm_start(rule);
    let mut run = |height: f64, evaluations: u64| -> Report<_> {
        search
            .run(&at_height(height), &Budget::evaluations(evaluations))
            .unwrap()
    };
    assert_eq!(run(45.0, 3_000).hit_count(), 0);
    let report = run(38.0, 100);
    let sources = &report.sources;
    let place = sources.names.iter().position(|name| name == "near misses");
    let last = sources.rows.last().unwrap();
    (report.hit_count(), last.proposed[place.unwrap()])
}

#[test]
fn near_misses_of_a_slice_without_hits_are_tried_first_in_the_next() {
    let (hits, tried) = after_a_slice_without_hits(WarmStart::Verify);
    // Of a million points these are all below delta.
    assert_eq!(hits, 5);
    assert!(tried > 4, "{tried}");
}

#[test]
fn a_cold_slice_knows_nothing_of_the_one_before() {
    let (hits, tried) = after_a_slice_without_hits(WarmStart::Cold);
    assert_eq!((hits, tried), (0, 0));
}

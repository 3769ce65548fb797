use core::ops::ControlFlow;

use super::Islands;
use crate::engine::{self, WarmStart};
use crate::{Budget, Completeness, Error, Hit, SatisficingProblem, Search, Space, StopReason, from_fn};

/// The lattice points of a disc, in a space of a million.
fn disc(radius: f64) -> impl SatisficingProblem<Scalar = f64, Solution = crate::Located<f64>> {
    from_fn(Space::lattice(2, 1000).unwrap(), radius, |x: &[f64]| {
        (x[0] - 700.0).hypot(x[1] - 300.0)
    })
}

fn islands(count: usize) -> Islands<f64, crate::Located<f64>> {
    Islands::new(count, || engine::build("portfolio"))
        .unwrap()
        .seed(3)
}

#[test]
fn threads_change_nothing() {
    let problem = disc(40.0);
    for name in ["portfolio", "latest-hit-qpso", "random", "descent-flood"] {
        let run = |threads| {
            let mut islands = Islands::new(5, || engine::build(name))
                .unwrap()
                .seed(3)
                .threads(threads);
            let mut seen = Vec::new();
            for _ in 0..2 {
                let report = islands.run(&problem, &Budget::evaluations(10_007)).unwrap();
                assert_eq!(report.counts.evaluations, 10_007, "{name}");
                assert_eq!(report.stop_reason, StopReason::Evaluations);
                let hits: Vec<_> = report
                    .hits()
                    .map(|hit| (hit.solution.coordinates.clone(), hit.evaluation))
                    .collect();
                seen.push((hits, report.counts, report.unseen));
            }
            seen
        };
        let one = run(1);
        assert!(one[0].0.len() > 10, "{name}: {} hits", one[0].0.len());
        for threads in [2, 3, 8] {
            assert_eq!(run(threads), one, "{name} on {threads} threads");
        }
    }
}

#[test]
fn every_hit_is_a_hit_and_listed_once() {
    let problem = disc(40.0);
    let report = islands(4).run(&problem, &Budget::evaluations(40_000)).unwrap();
    let mut cells: Vec<(u64, u64)> = report
        .hits()
        .map(|hit| {
            assert!(problem.fitness(hit.solution) < problem.threshold());
            (
                hit.solution.coordinates[0] as u64,
                hit.solution.coordinates[1] as u64,
            )
        })
        .collect();
    cells.sort_unstable();
    cells.dedup();
    assert_eq!(cells.len(), report.hit_count());
    let all = (0..1_000_000)
        .filter(|i| (f64::from(i % 1000) - 700.0).hypot(f64::from(i / 1000) - 300.0) < 40.0)
        .count();
    assert_eq!(report.hit_count(), all, "{:?}", report.counts);
    // By themselves, four searches would have found nearly three quarters of their hits in vain.
    assert!(report.counts.duplicates < 2 * all as u64, "{:?}", report.counts);
    assert!(report.hits().map(|hit| hit.evaluation).is_sorted());
    assert_eq!(report.counts.probes, 800);
}

#[test]
fn one_island_without_probes_is_a_search() {
    let problem = disc(40.0);
    let budget = Budget::evaluations(20_000);
    let build = || engine::build("portfolio");
    let mut alone = Search::new(build().unwrap()).seed(3).probes(0.0);
    let mut island = Islands::new(1, build).unwrap().seed(3).probes(0.0);
    let (alone, island) = (
        alone.run(&problem, &budget).unwrap(),
        island.run(&problem, &budget).unwrap(),
    );
    assert_eq!(alone.counts, island.counts);
    assert!(alone.archive.solutions().iter().eq(island.archive.solutions()));
}

#[test]
fn limits_end_all_of_them() {
    let problem = disc(40.0);
    let report = islands(3)
        .run(&problem, &Budget::evaluations(100_000).and_hits(100))
        .unwrap();
    assert_eq!((report.hit_count(), report.stop_reason), (100, StopReason::Hits));
    let mut seen = 0;
    let mut stop = |_: Hit<'_, crate::Located<f64>>, count: usize| {
        seen = count;
        if count == 7 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let report = islands(3)
        .run_observed(&problem, &Budget::evaluations(100_000), &mut stop)
        .unwrap();
    assert_eq!(
        (report.hit_count(), report.stop_reason),
        (7, StopReason::Observer)
    );
    assert_eq!(seen, 7);
    let cancel = crate::Cancel::new();
    cancel.cancel();
    let report = islands(3).run(&problem, &Budget::until(&cancel)).unwrap();
    assert_eq!(report.stop_reason, StopReason::Cancelled);
    let time = core::time::Duration::from_millis(20);
    let report = islands(3).run(&problem, &Budget::time(time)).unwrap();
    assert_eq!(report.stop_reason, StopReason::Time);
    assert!(report.counts.evaluations > 0);
    // Fewer evaluations than islands.
    let report = islands(8).run(&problem, &Budget::evaluations(3)).unwrap();
    assert_eq!(report.counts.evaluations, 3);
    assert!(matches!(
        Islands::<f64, crate::Located<f64>>::new(0, || engine::build("random")),
        Err(Error::Parameter { .. })
    ));
}

#[test]
fn a_space_that_one_of_them_has_covered_is_covered() {
    let problem = from_fn(Space::lattice(2, 30).unwrap(), 5.0, |x: &[f64]| x[0] + x[1]);
    let report = islands(4).run(&problem, &Budget::evaluations(100_000)).unwrap();
    assert_eq!(report.stop_reason, StopReason::Covered);
    assert_eq!(report.completeness, Completeness::Proved);
    assert_eq!(report.hit_count(), 15);
}

#[test]
fn the_hits_of_the_slice_before_are_verified_once() {
    let problem = disc(40.0);
    let mut islands = islands(4).warm_start(WarmStart::Verify);
    let first = islands.run(&problem, &Budget::evaluations(40_000)).unwrap();
    let second = islands.run(&problem, &Budget::evaluations(40_000)).unwrap();
    assert_eq!(second.counts.verified, first.hit_count() as u64);
    assert_eq!(second.hit_count(), first.hit_count());
    // The budget is too small for more than the verification.
    let third = islands
        .run(&problem, &Budget::evaluations(first.hit_count() as u64))
        .unwrap();
    assert!(third.hit_count() * 10 >= first.hit_count() * 9);
}

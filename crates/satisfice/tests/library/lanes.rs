//! Several lanes of one search: what they find together, and that threads change nothing.

#![allow(clippy::unwrap_used, reason = "a test")]

use core::ops::ControlFlow;

use satisfice::engine::WarmStart;
use satisfice::{
    Budget, Cancel, Completeness, Error, Hit, Located, RunOptions, SatisficingProblem, Search, Space,
    StopReason, from_fn,
};

/// The lattice points of a disc, in a space of a million.
fn disc(radius: f64) -> impl SatisficingProblem<Scalar = f64, Solution = Located<f64>> {
    from_fn(Space::lattice(2, 1000).unwrap(), radius, |x: &[f64]| {
        (x[0] - 700.0).hypot(x[1] - 300.0)
    })
    .boxed()
}

fn islands<P: SatisficingProblem>(count: usize) -> Search<P> {
    Search::named("portfolio").unwrap().islands(count).seed(3)
}

#[test]
fn threads_change_nothing() {
    let problem = disc(40.0);
    for name in ["portfolio", "latest-hit-qpso", "random", "descent-flood"] {
        let run = |threads| {
            let mut islands = Search::named(name).unwrap().islands(5).seed(3).threads(threads);
            let mut seen = Vec::new();
            // Of a long search: a model of F, whose proposals take milliseconds, stays out of it.
            let budget = Budget::evaluations(10_007).with_horizon(100_000);
            for _ in 0..2 {
                let report = islands.run(&problem, &budget).unwrap();
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
    // Four separate searches would have found nearly three quarters of their hits more than once.
    assert!(
        report.counts.duplicates < 3 * all as u64 / 2,
        "{:?}",
        report.counts
    );
    assert!(report.hits().map(|hit| hit.evaluation).is_sorted());
    assert_eq!(report.counts.probes, 800);
}

/// One lane after the other, by hand: the same report.
#[test]
fn by_hand_they_are_the_same() {
    let problem = disc(40.0);
    let budget = Budget::evaluations(1_003);
    let report = islands(4).run(&problem, &budget).unwrap();
    let mut search = islands(4);
    let mut slice = search.start(&problem, &budget).unwrap();
    loop {
        let fitness: Vec<f64> = slice.ask().unwrap().iter().map(|c| problem.fitness(c)).collect();
        if fitness.is_empty() {
            break;
        }
        slice.tell(&fitness).unwrap();
    }
    assert_eq!(satisfice::testing::difference(&report, &slice.finish()), None);
}

#[test]
fn limits_end_all_of_them() {
    let problem = disc(40.0);
    let report = islands(3)
        .run(&problem, &Budget::evaluations(100_000).and_hits(100))
        .unwrap();
    assert_eq!((report.hit_count(), report.stop_reason), (100, StopReason::Hits));
    let mut seen = 0;
    let mut stop = |_: Hit<'_, Located<f64>>, count: usize| {
        seen = count;
        if count == 7 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let report = islands(3)
        .run_with(
            &problem,
            &Budget::evaluations(100_000),
            RunOptions::new().observer(&mut stop),
        )
        .unwrap();
    assert_eq!(
        (report.hit_count(), report.stop_reason),
        (7, StopReason::Observer)
    );
    assert_eq!(seen, 7);
    let cancel = Cancel::new();
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
        islands(0).run(&problem, &Budget::evaluations(3)),
        Err(Error::Parameter { .. })
    ));
}

#[test]
fn a_space_that_one_of_them_has_covered_is_covered() {
    let problem = from_fn(Space::lattice(2, 30).unwrap(), 5.0, |x: &[f64]| x[0] + x[1]).boxed();
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

/// What F costs is the time that a batch is out, not that of the other islands' turns: a cheap F wakes no model of it.
#[test]
fn islands_that_are_evaluated_by_hand_know_what_a_cheap_f_costs() {
    let ring = from_fn(Space::<f64>::cube(2, -2.0, 2.0).unwrap(), 1e-3, |x: &[f64]| {
        (x[0].hypot(x[1]) - 1.0).powi(2)
    })
    .separation(0.02);
    for islands in [1, 4] {
        let budget = Budget::time(core::time::Duration::from_secs(3600));
        let mut search = Search::new().islands(islands).seed(1);
        let mut slice = search.start(&ring, &budget).unwrap();
        let mut told = 0;
        while told < 12_000 {
            let values: Vec<f64> = slice.ask().unwrap().iter().map(|x| ring.fitness(x)).collect();
            told += values.len();
            slice.tell(&values).unwrap();
            if told < 100 {
                // Somebody else has the time: all the islands together are slow.
                std::thread::sleep(core::time::Duration::from_millis(5));
            }
        }
        let report = slice.finish();
        let of_model = report.sources.names.iter().position(|name| name == "model");
        let last = report.sources.rows.last().unwrap();
        assert!(
            of_model.is_none_or(|model| last.proposed[model] == 0),
            "{islands}: {:?} {last:?}",
            report.sources.names
        );
    }
}

#[test]
fn a_time_limit_may_be_as_long_as_can_be_told() {
    let budget = Budget::time(core::time::Duration::MAX).and_evaluations(1_000);
    let mut search = Search::named("random").unwrap().islands(2).seed(1);
    let report = search.run(&disc(40.0), &budget).unwrap();
    assert_eq!(report.counts.evaluations, 1_000);
}

#[test]
fn a_hit_that_is_not_evaluated_again_is_not_verified() {
    let problem = disc(40.0);
    for search in [Search::named("random").unwrap(), islands(2)] {
        let mut search = search.seed(3).warm_start(WarmStart::Verify);
        let first = search.run(&problem, &Budget::evaluations(40_000)).unwrap();
        assert!(first.hit_count() > 70);
        let one = Budget::evaluations(10_000).and_hits(1);
        let second = search.run(&problem, &one).unwrap();
        assert_eq!(second.counts.verified, second.counts.evaluations);
    }
}

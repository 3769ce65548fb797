//! A problem that panics: how the run ends, and what holds afterwards.

#![allow(clippy::unwrap_used, reason = "a test")]

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use satisfice::engine::WarmStart;
use satisfice::{
    Budget, Completeness, Located, RunOptions, SatisficingProblem, Search, Space, StopReason, from_fn,
};

/// Sums of coordinates below 40; the call `fatal` panics. Slow enough for threads to be used.
fn mortal(calls: &AtomicU64, fatal: u64) -> impl SatisficingProblem<Scalar = f64, Solution = Located<f64>> {
    from_fn(Space::lattice(2, 60).unwrap(), 40.0, move |x: &[f64]| {
        let call = calls.fetch_add(1, Ordering::Relaxed) + 1;
        assert!(call != fatal, "call {call} is fatal");
        (0..5_000).fold(x[0] + x[1], |sum: f64, i| {
            core::hint::black_box(sum + f64::from(i) * 1e-300)
        })
    })
    .boxed()
}

#[test]
fn what_was_found_is_reported() {
    for (islands, threads) in [(1, 1), (1, 3), (4, 1), (4, 3)] {
        for name in ["random", "walk", "latest-hit-qpso"] {
            let calls = AtomicU64::new(0);
            let problem = mortal(&calls, 1_500);
            let mut search = Search::named(name)
                .unwrap()
                .islands(islands)
                .threads(threads)
                .warm_start(WarmStart::Verify);
            let budget = Budget::evaluations(4_000);
            let report = search
                .run_with(&problem, &budget, RunOptions::new().catch_panics())
                .unwrap();
            // Beside a lane that panics, others go on to the next exchange.
            let alone = islands > 1 && threads > 1;
            let case = format!("{name}, {islands} lanes on {threads} threads: {report}");
            assert_eq!(report.stop_reason, StopReason::Panicked, "{case}");
            assert_eq!(report.completeness, Completeness::Unknown, "{case}");
            assert_eq!(report.panic.as_deref(), Some("call 1500 is fatal"), "{case}");
            assert!(
                case.contains("a panic of the problem: call 1500 is fatal; "),
                "{case}"
            );
            assert!(
                report.hit_count() > 0 && (alone || report.counts.fitness_calls < 1_500),
                "{case}"
            );
            for hit in report.hits() {
                assert_eq!(hit.fitness, problem.fitness(hit.solution), "{case}");
            }
            // The search continues, warm from these hits.
            let next = search.run(&problem, &budget).unwrap();
            assert_eq!(next.counts.verified, report.hit_count() as u64, "{case}");
            assert!(next.hit_count() >= report.hit_count(), "{case}");
        }
    }
}

/// A circle and a parabola, whose residuals are also the components of F; the call `fatal` of the components panics.
fn mortal_components(
    calls: Arc<AtomicU64>,
    fatal: u64,
) -> impl SatisficingProblem<Scalar = f64, Solution = Located<f64>> {
    let residuals = |x: &[f64]| [x[0] * x[0] + x[1] * x[1] - 1.0, x[0] * x[0] - x[1] - 0.5];
    from_fn(Space::cube(2, -2.0, 2.0).unwrap(), 0.2, move |x: &[f64]| {
        residuals(x).map(f64::abs).into_iter().fold(0.0, f64::max)
    })
    .components(2, move |x, components| {
        let call = calls.fetch_add(1, Ordering::Relaxed) + 1;
        assert!(call != fatal, "call {call} is fatal");
        components.copy_from_slice(&residuals(x).map(|residual| residual / 0.2));
    })
    .boxed()
}

#[test]
fn a_panic_of_the_components_is_one_of_the_problem() {
    for (islands, threads) in [(1, 1), (1, 3), (4, 1), (4, 3)] {
        for name in ["surrogate", "portfolio"] {
            let problem = mortal_components(Arc::new(AtomicU64::new(0)), 40);
            let mut search = Search::named(name).unwrap().islands(islands).threads(threads);
            let budget = Budget::evaluations(160);
            let report = search
                .run_with(&problem, &budget, RunOptions::new().catch_panics())
                .unwrap();
            let case = format!("{name}, {islands} lanes on {threads} threads: {report}");
            assert_eq!(report.stop_reason, StopReason::Panicked, "{case}");
            assert!(report.hit_count() > 0, "{case}");
            for hit in report.hits() {
                assert_eq!(hit.fitness, problem.fitness(hit.solution), "{case}");
            }
            let next = search.run(&problem, &budget).unwrap();
            assert_eq!(next.stop_reason, StopReason::Evaluations, "{case}");
            // Passed on, it leaves a search that works as well.
            let problem = mortal_components(Arc::new(AtomicU64::new(0)), 40);
            let run = catch_unwind(AssertUnwindSafe(|| search.run(&problem, &budget)));
            assert!(run.is_err(), "{case}");
            assert!(search.run(&problem, &budget).unwrap().hit_count() > 0, "{case}");
        }
    }
}

#[test]
fn a_panic_that_is_passed_on_leaves_a_search_that_works() {
    for threads in [1, 3] {
        let calls = AtomicU64::new(0);
        let problem = mortal(&calls, 700);
        let mut search = Search::named("random").unwrap().seed(4).threads(threads);
        let budget = Budget::evaluations(2_000);
        let run = catch_unwind(AssertUnwindSafe(|| search.run(&problem, &budget)));
        assert!(run.is_err());
        let after = search.run(&problem, &budget).unwrap();
        let fresh = Search::named("random")
            .unwrap()
            .seed(4)
            .run(&problem, &budget)
            .unwrap();
        assert_eq!(satisfice::testing::difference(&after, &fresh), None);
    }
}

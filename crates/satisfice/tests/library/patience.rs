//! Patience: a slice ends after so many evaluations without a new hit, and is up to there what it would have been anyway.

#![allow(clippy::unwrap_used, reason = "a test")]

use std::sync::Arc;

use satisfice::{
    Budget, Located, Report, RunOptions, SatisficingProblem, Search, Space, StopReason, Tickets, engine,
    from_fn,
};

type Hits = Vec<(Vec<f64>, u64)>;

/// The lattice points of two discs, in a space of a million.
fn discs() -> impl SatisficingProblem<Scalar = f64, Solution = Located<f64>> {
    from_fn(Space::lattice(2, 1000).unwrap(), 6.0, |x: &[f64]| {
        let to = |a: f64, b: f64| (x[0] - a).hypot(x[1] - b);
        to(700.0, 300.0).min(to(100.0, 850.0))
    })
    .boxed()
}

fn hits(report: &Report<Located<f64>>) -> Hits {
    let listed = report.hits();
    listed
        .map(|hit| (hit.solution.coordinates.clone(), hit.evaluation))
        .collect()
}

/// The hits and the length of a slice that ends after `patience` evaluations in succession without one of these.
fn expected(all: &Hits, patience: u64, limit: u64) -> (Hits, u64, StopReason) {
    let mut last = 0;
    let mut until = all.len();
    for (index, (_, evaluation)) in all.iter().enumerate() {
        if *evaluation > last + patience {
            until = index;
            break;
        }
        last = *evaluation;
    }
    let end = last + patience;
    if end <= limit && (until < all.len() || end < limit) {
        (all[..until].to_vec(), end, StopReason::Patience)
    } else {
        (all.clone(), limit, StopReason::Evaluations)
    }
}

#[test]
fn a_slice_ends_at_the_first_gap_of_that_length() {
    let problem = discs();
    let mut ended_early = 0;
    for engine in engine::all().iter().filter(|engine| !engine.expensive_proposals) {
        let run = |budget: Budget| {
            Search::named(engine.name)
                .unwrap()
                .seed(5)
                .run(&problem, &budget)
                .unwrap()
        };
        let whole = run(Budget::evaluations(6_000));
        if whole.stop_reason != StopReason::Evaluations {
            continue;
        }
        for patience in [1, 150, 1_700] {
            let report = run(Budget::evaluations(6_000).and_patience(patience));
            let (wanted, evaluations, reason) = expected(&hits(&whole), patience, 6_000);
            let name = format!("{}, patience {patience}", engine.name);
            assert_eq!(hits(&report), wanted, "{name}");
            assert_eq!(
                (report.counts.evaluations, report.stop_reason),
                (evaluations, reason),
                "{name}"
            );
            ended_early += usize::from(reason == StopReason::Patience && !wanted.is_empty());
        }
    }
    assert!(ended_early > 5, "{ended_early} slices ended between hits");
}

#[test]
fn it_is_a_limit_by_itself() {
    let report = Search::named("random")
        .unwrap()
        .run(&discs(), &Budget::default().and_patience(30_000))
        .unwrap();
    let last = report.hits().last().map_or(0, |hit| hit.evaluation);
    assert_eq!(report.counts.evaluations, last + 30_000);
    let error = Search::named("random")
        .unwrap()
        .run(&discs(), &Budget::default().and_patience(0))
        .unwrap_err();
    assert!(error.to_string().contains("patience"), "{error}");
}

#[test]
fn islands_end_together_on_any_number_of_threads() {
    let problem = discs();
    let run = |threads| {
        let mut search = Search::named("portfolio")
            .unwrap()
            .islands(4)
            .seed(3)
            .threads(threads);
        let budget = Budget::evaluations(200_000).and_patience(8_000);
        search.run(&problem, &budget).unwrap()
    };
    let report = run(1);
    let last = report.hits().last().unwrap().evaluation;
    assert_eq!(report.stop_reason, StopReason::Patience);
    // They exchange after 1,024 evaluations each.
    let waited = report.counts.evaluations - last;
    assert!((8_000..8_000 + 4 * 1_024).contains(&waited), "{waited}");
    let again = run(3);
    assert_eq!(hits(&again), hits(&report));
    assert_eq!(again.counts, report.counts);
}

#[test]
fn it_goes_on_where_a_slice_was_saved() {
    let problem = discs();
    let budget = Budget::evaluations(6_000).and_patience(1_200);
    let search = || Search::named("latest-hit-qpso").unwrap().seed(5);
    let whole = search().run(&problem, &budget).unwrap();
    let mut first = search();
    let mut slice = first.start(&problem, &budget).unwrap();
    for _ in 0..10 {
        let fitness: Vec<f64> = slice.ask().unwrap().iter().map(|x| problem.fitness(x)).collect();
        slice.tell(&fitness).unwrap();
    }
    let mut resumed = Search::resume(slice.checkpoint(), engine::LatestHitQpso::default()).unwrap();
    let report = resumed.run_resumed(&problem, RunOptions::new()).unwrap();
    assert_eq!((hits(&report), report.counts), (hits(&whole), whole.counts));
}

#[test]
fn answers_from_elsewhere_count_as_well() {
    let problem = Arc::new(discs());
    let budget = Budget::evaluations(6_000).and_patience(500);
    let search = || Search::named("random").unwrap().seed(5);
    let whole = search().run(&*problem, &budget).unwrap();
    assert_eq!(whole.stop_reason, StopReason::Patience);
    let mut tickets = Tickets::ordered(search(), Arc::clone(&problem), &budget).unwrap();
    loop {
        let asked = tickets.ask(3);
        if asked.is_empty() {
            break;
        }
        for asked in asked.into_iter().rev() {
            tickets
                .tell(asked.ticket, problem.fitness(&asked.solution))
                .unwrap();
        }
    }
    let report = tickets.finish();
    assert_eq!((hits(&report), report.counts), (hits(&whole), whole.counts));
}

//! Islands that run elsewhere, round by round: the report is that of islands in one search.

#![allow(clippy::unwrap_used, reason = "a test")]

use std::time::Duration;

use satisfice::{
    Budget, Cancel, Error, IslandRound, Located, Report, Rounds, RunOptions, SatisficingProblem, Search,
    Space, StopReason, engine, from_fn,
};

type Island = IslandRound<Located<f64>>;

/// The lattice points of a disc, in a space of a million.
fn disc() -> impl SatisficingProblem<Scalar = f64, Solution = Located<f64>> + Clone {
    from_fn(Space::lattice(2, 1000).unwrap(), 40.0, |x: &[f64]| {
        (x[0] - 700.0).hypot(x[1] - 300.0)
    })
}

fn islands<P: SatisficingProblem>(name: &str) -> Search<P> {
    Search::named(name).unwrap().islands(5).seed(3)
}

/// As it comes back from another machine.
fn sent(island: &Island) -> Island {
    serde_json::from_str(&serde_json::to_string(island).unwrap()).unwrap()
}

fn assert_same(one: &Report<Located<f64>>, two: &Report<Located<f64>>, of: &str) {
    let hits = |report: &Report<Located<f64>>| -> Vec<_> {
        let hits = report.hits();
        hits.map(|hit| (hit.solution.coordinates.clone(), hit.evaluation))
            .collect()
    };
    assert_eq!(hits(one), hits(two), "{of}");
    assert_eq!(one.counts, two.counts, "{of}");
    assert_eq!(one.unseen, two.unseen, "{of}");
    assert_eq!(one.stop_reason, two.stop_reason, "{of}");
    let trace = |report: &Report<Located<f64>>| -> Vec<_> {
        report
            .trace
            .iter()
            .map(|point| (point.evaluations, point.hits))
            .collect()
    };
    assert_eq!(trace(one), trace(two), "{of}");
}

/// Every third round is lost and run again, islands come back in another order, and the search moves to a file and back.
#[test]
fn lost_rounds_change_nothing() {
    let problem = disc();
    for name in ["portfolio", "latest-hit-qpso", "random", "descent-flood"] {
        // Of a long search: a model of F, whose proposals take milliseconds, stays out of it.
        let budget = Budget::evaluations(10_007).with_horizon(100_000);
        let start = [[700.0, 300.0], [3.0, 4.0], [690.0, 300.0]];
        let expected = islands(name).start_from(start).run(&problem, &budget).unwrap();
        let mut rounds = Rounds::begin(islands(name).start_from(start), problem.clone(), &budget).unwrap();
        let mut runs = 0;
        loop {
            let mut round = rounds.round(&mut ());
            if round.is_empty() {
                break;
            }
            round.reverse();
            for island in round {
                runs += 1;
                if runs % 3 == 0 {
                    sent(&island)
                        .run(engine::ConfiguredEngine::named(name).unwrap(), &problem, None)
                        .unwrap();
                }
                let done = sent(&island)
                    .run(engine::ConfiguredEngine::named(name).unwrap(), &problem, None)
                    .unwrap();
                rounds.take(sent(&done)).unwrap();
                if runs % 7 == 0 {
                    rounds = Rounds::resume(
                        rounds.checkpoint(),
                        engine::ConfiguredEngine::named(name).unwrap(),
                        problem.clone(),
                    )
                    .unwrap();
                }
            }
        }
        assert!(runs >= 15, "{runs} rounds");
        rounds.evaluate_probes();
        let report = rounds.finish();
        assert!(report.hit_count() > 10, "{name}: {} hits", report.hit_count());
        assert_same(&report, &expected, name);
    }
}

/// A round whose points are evaluated by another language.
#[test]
fn rounds_by_hand_are_the_same() {
    let problem = disc();
    let budget = Budget::evaluations(1_500);
    let expected = islands("portfolio").run(&problem, &budget).unwrap();
    let mut rounds = Rounds::begin(islands("portfolio"), problem.clone(), &budget).unwrap();
    loop {
        let round = rounds.round(&mut ());
        if round.is_empty() {
            break;
        }
        for island in round {
            let mut search = island.search(engine::default()).unwrap();
            let mut slice = search.start_resumed(&problem).unwrap();
            loop {
                let points = slice.ask().unwrap();
                if points.is_empty() {
                    break;
                }
                let fitness: Vec<f64> = points.iter().map(|point| problem.fitness(point)).collect();
                slice.tell(&fitness).unwrap();
            }
            rounds.take(island.clone().done(slice, &[]).unwrap()).unwrap();
        }
    }
    loop {
        let fitness: Vec<f64> = rounds
            .ask_probes()
            .iter()
            .map(|probe| problem.fitness(probe))
            .collect();
        if fitness.is_empty() {
            break;
        }
        rounds.tell_probes(&fitness).unwrap();
    }
    assert_same(&rounds.finish(), &expected, "by hand");
}

#[test]
fn a_time_that_is_up_ends_an_island_in_its_batch() {
    let problem = disc();
    let budget = Budget::time(Duration::from_secs(3600));
    let mut rounds = Rounds::begin(islands("random"), problem.clone(), &budget).unwrap();
    for island in rounds.round(&mut ()) {
        let late = island.at(Duration::from_secs(3600));
        let done = late
            .run(engine::ConfiguredEngine::named("random").unwrap(), &problem, None)
            .unwrap();
        rounds.take(done).unwrap();
    }
    assert!(rounds.round(&mut ()).is_empty());
    rounds.evaluate_probes();
    assert_eq!(rounds.finish().stop_reason, StopReason::Time);

    let mut rounds = Rounds::begin(islands("random"), problem.clone(), &budget).unwrap();
    for island in rounds.round(&mut ()) {
        let mut search = island
            .search(engine::ConfiguredEngine::named("random").unwrap())
            .unwrap();
        let mut slice = search.start_resumed(&problem).unwrap();
        assert!(slice.ask().unwrap().len() > 3);
        rounds
            .take(island.clone().done(slice, &[50.0, 1.0, 2.0]).unwrap())
            .unwrap();
    }
    rounds.end(StopReason::Observer);
    assert!(rounds.ask_probes().is_empty());
    let report = rounds.finish();
    assert_eq!((report.counts.evaluations, report.hit_count()), (15, 10));
    assert_eq!(report.stop_reason, StopReason::Observer);
}

#[test]
fn what_does_not_fit_is_refused() {
    let problem = disc();
    let budget = Budget::evaluations(10_000);
    let alone = Search::named("random").unwrap();
    let refused = Rounds::begin(alone, problem.clone(), &budget).unwrap_err();
    assert!(matches!(refused, Error::Parameter { .. }), "{refused}");

    let random = || engine::ConfiguredEngine::<f64>::named("random").unwrap();
    let mut rounds = Rounds::begin(islands("random"), problem.clone(), &budget).unwrap();
    let first = rounds.round(&mut ());
    assert!(
        matches!(rounds.take(first[0].clone()), Err(Error::State(_))),
        "it has not run"
    );
    let cancel = Cancel::new();
    cancel.cancel();
    assert!(first[0].clone().run(random(), &problem, Some(&cancel)).is_err());
    assert!(matches!(
        first[0]
            .clone()
            .run(engine::ConfiguredEngine::named("pso").unwrap(), &problem, None),
        Err(Error::State(_))
    ));
    let done: Vec<Island> = first
        .into_iter()
        .map(|island| island.run(random(), &problem, None).unwrap())
        .collect();
    for island in &done {
        rounds.take(island.clone()).unwrap();
    }
    assert_eq!(rounds.round(&mut ()).len(), 5);
    assert!(
        matches!(rounds.take(done[0].clone()), Err(Error::State(_))),
        "it is of the round before"
    );
    assert!(rounds.tell_probes(&[1.0]).is_err());
}

/// What one island does is saved by itself and goes on, past its round: it still has the hits that all islands know.
#[test]
fn an_island_that_is_saved_keeps_the_hits_of_all() {
    let problem = disc();
    let budget = Budget::evaluations(10_000);
    let mut rounds = Rounds::begin(islands("latest-hit-qpso"), problem.clone(), &budget).unwrap();
    let engine = || engine::ConfiguredEngine::named("latest-hit-qpso").unwrap();
    for island in rounds.round(&mut ()) {
        rounds
            .take(island.run(engine(), &problem, None).unwrap())
            .unwrap();
    }
    let island = rounds.round(&mut ()).swap_remove(0);
    let known = usize::try_from(rounds.progress().hits).unwrap();
    let mut alone = sent(&island).search(engine()).unwrap();
    let saved = alone.start_resumed(&problem).unwrap().checkpoint();
    let mut alone = Search::resume(saved, engine()).unwrap();
    let report = alone.run_resumed(&problem, RunOptions::new()).unwrap();
    rounds.end(StopReason::Cancelled);
    let of_all = rounds.finish();
    assert!(known > 5 && of_all.hit_count() == known && report.hit_count() > known);
    assert_eq!(&report.archive.solutions()[..known], of_all.archive.solutions());
}

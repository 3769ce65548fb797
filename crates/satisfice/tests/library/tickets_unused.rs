//! Values that come after the end of a slice within their batch.

#![allow(clippy::unwrap_used, reason = "a test")]

use satisfice::{Budget, SatisficingProblem, Search, Space, StopReason, Tickets, Told, engine, from_fn};

/// Every value was taken; those that the report does not count are the unused ones.
#[test]
fn values_after_a_limit_within_a_batch_are_counted() {
    let limits: [fn(Budget) -> Budget; 2] = [|b| b.and_hits(3), |b| b.and_patience(7)];
    for (limit, reason) in limits.into_iter().zip([StopReason::Hits, StopReason::Patience]) {
        let budget = limit(Budget::evaluations(1000));
        let fitness = |x: &[f64]| x[0] + x[1];
        let problem = from_fn(Space::lattice(2, 30).unwrap(), 20.0, fitness);
        let search = || Search::named("random").unwrap().seed(4);
        let run = search().run(&problem, &budget).unwrap();
        let mut tickets = Tickets::ordered(search(), problem.clone(), &budget).unwrap();
        let mut told = 0;
        loop {
            let asked = tickets.ask(1000);
            if asked.is_empty() {
                break;
            }
            for asked in asked {
                let value = problem.fitness(&asked.solution);
                assert_eq!(tickets.tell(asked.ticket, value), Ok(Told::Taken));
                told += 1;
            }
        }
        let counts = tickets.ticket_counts();
        let saved = serde_json::to_string(&tickets.checkpoint()).unwrap();
        let saved = serde_json::from_str(&saved).unwrap();
        let engine = engine::ConfiguredEngine::named("random").unwrap();
        let resumed = Tickets::resume(saved, engine, problem.clone()).unwrap();
        assert_eq!(resumed.ticket_counts(), counts);
        let report = tickets.finish();
        assert_eq!((report.stop_reason, run.stop_reason), (reason, reason));
        assert_eq!((counts.taken, counts.over), (told, 0));
        assert_eq!(counts.unused, told - run.counts.fitness_calls);
        assert!(counts.unused > 0, "{counts:?}");
    }
}

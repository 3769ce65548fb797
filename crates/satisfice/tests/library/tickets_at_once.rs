//! How many evaluations go on at once: whoever asks for tickets shows it, and need not say so.

#![allow(clippy::unwrap_used, reason = "a test")]

use std::collections::VecDeque;

use satisfice::{Budget, SatisficingProblem, Search, Space, Tickets, from_fn};

/// Twelve valleys on a slope. 32 evaluations go on at once, and end in the order in which they began.
fn found(budget: &Budget) -> (Vec<(Vec<f64>, u64)>, u64) {
    let slope = || {
        from_fn(Space::<f64>::cube(3, -1.0, 1.0).unwrap(), 0.08, |x: &[f64]| {
            let valley = (x[0] * 12.0).cos() + (x[1] * 9.0).sin();
            (valley * 0.3).powi(2) + (x[2] - 0.3 * x[0]).powi(2) + 0.1 * (x[0] + 0.8).abs()
        })
        .boxed()
        .separation(0.05)
    };
    let mut tickets = Tickets::eager(Search::new().seed(5), slope(), budget).unwrap();
    let (elsewhere, mut out) = (slope(), VecDeque::new());
    loop {
        out.extend(tickets.ask(32 - out.len()));
        let Some(asked) = out.pop_front() else { break };
        let value = elsewhere.fitness(&asked.solution);
        tickets.tell(asked.ticket, value).unwrap();
    }
    let report = tickets.finish();
    let hits = report.hits();
    (
        hits.map(|hit| (hit.solution.coordinates.clone(), hit.evaluation))
            .collect(),
        report.counts.evaluations,
    )
}

#[test]
fn it_need_not_be_said_how_many_tickets_are_out() {
    for evaluations in [400, 20_000] {
        let budget = Budget::evaluations(evaluations);
        let (hits, made) = found(&budget);
        assert_eq!(made, evaluations);
        assert!(hits.len() > 10, "{}", hits.len());
        assert_eq!(found(&budget.with_parallel(32)), (hits, made));
    }
}

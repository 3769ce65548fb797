//! How many evaluations go on at once: whoever asks for tickets shows it, and need not say so.

#![allow(clippy::unwrap_used, reason = "a test")]

use std::collections::VecDeque;

use satisfice::{Budget, Completeness, Report, SatisficingProblem, Search, Space, Tickets, from_fn};

/// The report where so many evaluations go on at once, and end in the order in which they began.
fn answered<P>(mut tickets: Tickets<P>, elsewhere: &P, at_once: usize) -> Report<P::Solution>
where
    P: SatisficingProblem<Scalar = f64>,
{
    let mut out = VecDeque::new();
    loop {
        out.extend(tickets.ask(at_once - out.len()));
        let Some(asked) = out.pop_front() else { break };
        tickets
            .tell(asked.ticket, elsewhere.fitness(&asked.solution))
            .unwrap();
    }
    tickets.finish()
}

/// Twelve valleys on a slope, of which 32 evaluations go on at once.
fn found(budget: &Budget) -> (Vec<(Vec<f64>, u64)>, u64) {
    let slope = || {
        from_fn(Space::<f64>::cube(3, -1.0, 1.0).unwrap(), 0.08, |x: &[f64]| {
            let valley = (x[0] * 12.0).cos() + (x[1] * 9.0).sin();
            (valley * 0.3).powi(2) + (x[2] - 0.3 * x[0]).powi(2) + 0.1 * (x[0] + 0.8).abs()
        })
        .boxed()
        .separation(0.05)
    };
    let tickets = Tickets::eager(Search::new().seed(5), slope(), budget).unwrap();
    let report = answered(tickets, &slope(), 32);
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

/// A lattice of 6,400 points, for which the budget has little more room. Once the rest is enumerated, the points that are out take their part
/// of what is left: 1,000 evaluations go on at once.
#[test]
fn an_enumeration_leaves_room_for_the_tickets_that_are_out() {
    let sums = || {
        from_fn(Space::<f64>::lattice(2, 80).unwrap(), 5.0, |x: &[f64]| {
            x[0] + x[1]
        })
    };
    for (evaluations, is_proved) in [(8_600, true), (6_000, false)] {
        let budget = Budget::evaluations(evaluations);
        let search = Search::new().seed(5).set("without", "model").unwrap();
        let report = answered(Tickets::eager(search, sums(), &budget).unwrap(), &sums(), 1_000);
        let found = report.completeness == Completeness::Proved;
        assert_eq!((found, report.hit_count()), (is_proved, 15), "{report}");
    }
}

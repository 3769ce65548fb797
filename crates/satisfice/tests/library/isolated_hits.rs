//! Hits far apart, with several evaluations out at a time.

#![allow(clippy::unwrap_used, reason = "a test")]

use std::collections::VecDeque;

use satisfice::{Budget, Search, Space, Tickets, engine::Surrogate, from_fn};

/// Six balls of radius 0.05 in four axes. A point that is out and probably misses must not keep others from the way to a ball: when it kept
/// them out of its separation radius, these four seeds had 9 of 24 balls, not 22.
#[test]
fn points_that_are_out_and_improbable_keep_no_others_away() {
    let centres = [
        [0.2, 0.2, 0.3, 0.7],
        [0.8, 0.3, 0.8, 0.2],
        [0.3, 0.8, 0.7, 0.8],
        [0.7, 0.7, 0.2, 0.3],
        [0.5, 0.2, 0.5, 0.5],
        [0.2, 0.6, 0.2, 0.2],
    ];
    let mut found = 0;
    for seed in 0..4 {
        let distance = move |x: &[f64]| {
            let squares = |c: &[f64; 4]| x.iter().zip(c).map(|(x, c)| (x - c).powi(2)).sum::<f64>();
            centres.iter().map(squares).fold(f64::INFINITY, f64::min).sqrt()
        };
        let problem = from_fn(Space::cube(4, 0.0, 1.0).unwrap(), 0.05, distance).separation(0.2);
        let search = Search::with(Surrogate::default()).seed(seed);
        let mut tickets = Tickets::eager(search, problem, &Budget::evaluations(160)).unwrap();
        let mut out = VecDeque::new();
        loop {
            out.extend(tickets.ask(4 - out.len()));
            let Some(next) = out.pop_front() else { break };
            let value = distance(&next.solution.coordinates);
            tickets.tell(next.ticket, value).unwrap();
        }
        found += tickets.finish().hit_count();
    }
    assert!(found >= 18, "{found}");
}

//! Four ways to end a search early, and how to watch one: by a number of hits, an observer, another thread, a time.
//!
//! `cargo run --release --example stop_and_observe`

use std::ops::ControlFlow;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use satisfice::{
    Budget, Cancel, Hit, Located, Observer, RunOptions, Search, StopReason, TracePoint, engine, from_fn,
};
use satisfice::{SatisficingProblem, Space};

/// A generous limit, so that nothing runs forever if the other limit fails.
const FAR: u64 = 1_000_000_000;

const BARREN: u64 = 100_000;

/// Prints progress, and ends the search after a number of evaluations without a new hit.
struct Patience {
    latest: u64,
    printed: u64,
}

impl Observer<Located<f64>> for Patience {
    fn hit(&mut self, hit: Hit<'_, Located<f64>>, _count: usize) -> ControlFlow<()> {
        self.latest = hit.evaluation;
        ControlFlow::Continue(())
    }
    fn progress(&mut self, now: TracePoint, _share: f64) -> ControlFlow<()> {
        if now.evaluations > 4 * self.printed {
            self.printed = now.evaluations;
            println!("  {:>10} evaluations: {} hits", now.evaluations, now.hits);
        }
        if now.evaluations > self.latest + BARREN {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }
}

fn search<P: SatisficingProblem<Scalar = f64>>() -> Result<Search<P>, satisfice::Error> {
    Ok(Search::with(engine::LatestHitQpso::default()).seed(1))
}

fn main() -> Result<(), satisfice::Error> {
    // Points near the unit sphere in [-2, 2]^3, at least 0.1 apart.
    let sphere = |x: &[f64]| (x.iter().map(|c| c * c).sum::<f64>().sqrt() - 1.0).abs();
    let problem = from_fn(Space::cube(3, -2.0, 2.0)?, 0.01, sphere).separation(0.1);
    assert!(problem.threshold() > 0.0);

    println!("a number of hits:");
    let report = search()?.run(&problem, &Budget::hits(50).and_evaluations(FAR))?;
    println!("  {report}");
    assert_eq!((report.stop_reason, report.hit_count()), (StopReason::Hits, 50));

    println!("a closure that has seen enough at the first hit with z > 0.9:");
    let mut north = None;
    let mut watch = |hit: Hit<'_, Located<f64>>, count: usize| {
        if hit.solution.coordinates[2] > 0.9 {
            north = Some((hit.solution.clone(), count));
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    };
    let report = search()?.run_with(
        &problem,
        &Budget::evaluations(FAR),
        RunOptions::new().observer(&mut watch),
    )?;
    println!("  {report}");
    let (solution, count) = north.expect("a sphere has a north");
    println!("  hit {count}: {:?}", solution.coordinates);
    assert_eq!(
        (report.stop_reason, report.hit_count()),
        (StopReason::Observer, count)
    );

    println!("an observer that loses patience after {BARREN} evaluations without a new hit:");
    let mut patience = Patience {
        latest: 0,
        printed: 0,
    };
    let report = search()?.run_with(
        &problem,
        &Budget::evaluations(FAR),
        RunOptions::new().observer(&mut patience),
    )?;
    println!("  {report}");
    assert_eq!(
        report.stop_reason,
        StopReason::Observer,
        "it never stops finding hits, or the observer never gave up"
    );

    println!("another thread that cancels after the twentieth hit:");
    let cancel = Cancel::new();
    let (sender, receiver) = mpsc::channel();
    let report = thread::scope(|scope| {
        let flag = &cancel;
        scope.spawn(move || {
            if receiver.iter().any(|count: usize| count == 20) {
                flag.cancel();
            }
        });
        let mut tell = move |_: Hit<'_, Located<f64>>, count: usize| {
            // The receiver is gone after the twentieth hit; that is no reason to stop.
            let _ = sender.send(count);
            ControlFlow::Continue(())
        };
        search()?.run_with(
            &problem,
            &Budget::until(&cancel).and_evaluations(FAR),
            RunOptions::new().observer(&mut tell),
        )
    })?;
    println!("  {report}");
    assert_eq!(report.stop_reason, StopReason::Cancelled);
    assert!(report.hit_count() >= 20, "hits before the cancellation are kept");

    println!("20 ms of a fitness that takes 1 ms: the last evaluation may end late, none begins late");
    let slow = from_fn(Space::cube(3, -2.0, 2.0)?, 0.5, |x: &[f64]| {
        thread::sleep(Duration::from_millis(1));
        sphere(x)
    });
    let report = search()?.run(&slow, &Budget::time(Duration::from_millis(20)))?;
    println!(
        "  {report}\n  {:.2} ms too long",
        1e3 * report.overshoot.as_secs_f64()
    );
    assert_eq!(report.stop_reason, StopReason::Time);
    assert!(
        report.counts.evaluations <= 20,
        "each evaluation takes at least a millisecond"
    );
    Ok(())
}

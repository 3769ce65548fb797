//! Searches that are saved and resumed, against searches that were never interrupted: equal in all but the times.

#![allow(clippy::unwrap_used, reason = "a test")]

use core::sync::atomic::{AtomicU64, Ordering};
use core::time::Duration;

use satisfice::engine::{self, ConfiguredEngine, EngineSpec};
use satisfice::{
    Axis, Budget, Cancel, Checkpoint, Error, Located, Report, RunOptions, SatisficingProblem, Search, Space,
    StopReason, from_fn,
};

mod components;
mod interrupts;
mod one_answer;
mod refused;
mod size;

type Saved = Checkpoint<Located<f64>>;

trait Problem: SatisficingProblem<Scalar = f64, Solution = Located<f64>> {}
impl<P: SatisficingProblem<Scalar = f64, Solution = Located<f64>>> Problem for P {}

/// What a file does to a checkpoint.
fn through_a_file(checkpoint: &Saved) -> Saved {
    serde_json::from_str(&serde_json::to_string(checkpoint).unwrap()).unwrap()
}

/// All of a report but times.
fn timeless(report: &Report<Located<f64>>) -> String {
    let hits: Vec<_> = report.hits().map(|hit| (hit.solution, hit.evaluation)).collect();
    let trace: Vec<_> = report
        .trace
        .iter()
        .map(|point| (point.evaluations, point.hits))
        .collect();
    format!(
        "{:?} {:?} {} {} {:?} {:?} {:?} {:?} {trace:?} {hits:?}",
        report.problem,
        report.engine,
        report.seed,
        report.slice,
        report.stop_reason,
        report.counts,
        report.completeness,
        report.unseen
    )
}

fn space(name: &str) -> Space<f64> {
    match name {
        "lattice" => Space::lattice(3, 12),
        "square" => Space::cube(2, -2.0, 2.0),
        "wide" => Space::cube(10_000, -2.0, 2.0),
        _ => Space::new([Axis::integer(-3, 3), Axis::continuous(-2.0, 2.0)]),
    }
    .unwrap()
}

/// A shell with hits for everyone; `calls` counts, and call number `fatal` cancels.
fn problem<'a>(
    name: &str,
    calls: &'a AtomicU64,
    fatal: u64,
    cancel: &'a Cancel,
) -> impl SatisficingProblem<Scalar = f64, Solution = Located<f64>> + 'a {
    let (middle, width) = match name {
        "lattice" => (5.5, 0.4),
        "wide" => (0.1, 1e9), // everything hits
        _ => (0.1, 0.1),
    };
    from_fn(space(name), width, move |x: &[f64]| {
        if calls.fetch_add(1, Ordering::Relaxed) + 1 == fatal {
            cancel.cancel();
        }
        let square: f64 = x.iter().map(|x| (x - middle) * (x - middle)).sum();
        // A patch without a number.
        let distance = if x[0] > 1.9 && x[0] < 2.1 {
            f64::NAN
        } else {
            square.sqrt()
        };
        (distance - if middle > 1.0 { 4.0 } else { 1.2 }).abs()
    })
    .separation(0.02)
}

const EVALUATIONS: u64 = 300;
const SLICES: usize = 3;

fn search<P: Problem>(entry: &EngineSpec, probes: f64) -> Search<P> {
    Search::with(entry.configure([]).unwrap()).seed(9).probes(probes)
}

fn resume<P: Problem>(entry: &EngineSpec, saved: &Saved) -> Search<P> {
    Search::resume(through_a_file(saved), entry.configure([]).unwrap()).unwrap()
}

fn budget() -> Budget {
    Budget::evaluations(EVALUATIONS)
}

/// The first part of a long run, for which no engine builds a model of F: hundreds of runs take seconds.
fn part_of_a_long_run() -> Budget {
    budget().with_horizon(100 * EVALUATIONS)
}

/// Reports of an uninterrupted search, its checkpoints between slices, and calls of the fitness at the end of each.
fn uninterrupted(
    entry: &EngineSpec,
    name: &str,
    probes: f64,
    budget: &Budget,
) -> (Vec<String>, Vec<Saved>, Vec<u64>) {
    let (calls, cancel) = (AtomicU64::new(0), Cancel::new());
    let problem = problem(name, &calls, 0, &cancel);
    let mut search = search(entry, probes);
    let (mut reports, mut saved, mut ends) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..SLICES {
        saved.push(search.checkpoint());
        reports.push(timeless(&search.run(&problem, budget).unwrap()));
        ends.push(calls.load(Ordering::Relaxed));
    }
    (reports, saved, ends)
}

/// The engines that can be run hundreds of times; laws test the same of the others, on fewer points.
fn quick() -> impl Iterator<Item = &'static EngineSpec> {
    engine::all().iter().filter(|entry| !entry.expensive_proposals)
}

#[test]
fn at_every_slice_boundary() {
    for entry in quick() {
        for name in ["lattice", "square", "mixed"] {
            let (expected, saved, _) = uninterrupted(entry, name, 0.1, &budget());
            for (slice, saved) in saved.iter().enumerate() {
                let (calls, cancel) = (AtomicU64::new(0), Cancel::new());
                let problem = problem(name, &calls, 0, &cancel);
                let mut search = resume(entry, saved);
                for expected in &expected[slice..] {
                    let report = search.run(&problem, &budget()).unwrap();
                    assert_eq!(&timeless(&report), expected, "{} on {name}", entry.name);
                }
            }
        }
    }
}

/// Interrupts the search at fitness call `fatal`, resumes it, and compares all reports.
/// Returns whether the slice was cut short.
fn interrupted_at(
    entry: &EngineSpec,
    name: &str,
    probes: f64,
    budget: &Budget,
    fatal: u64,
    (expected, ends): (&[String], &[u64]),
) -> bool {
    let mut cut_short = false;
    let case = format!("{} on {name}, interrupted at call {fatal}", entry.name);
    let (calls, cancel) = (AtomicU64::new(0), Cancel::new());
    let problem = problem(name, &calls, fatal, &cancel);
    let mut search = search(entry, probes);
    let mut kept = None;
    for (slice, expected) in expected.iter().enumerate() {
        let mut report = if kept.is_none() {
            search
                .run_with(
                    &problem,
                    &budget.clone().and_until(&cancel),
                    RunOptions::new()
                        .checkpoints(Duration::MAX, &mut |saved: &Saved| kept = Some(saved.clone())),
                )
                .unwrap()
        } else {
            search.run(&problem, budget).unwrap()
        };
        if report.stop_reason == StopReason::Cancelled {
            cut_short = true;
            let found: Vec<_> = report.hits().map(|hit| hit.evaluation).collect();
            let saved = kept.clone().unwrap();
            search = resume(entry, &saved);
            report = search.run_resumed(&problem, RunOptions::new()).unwrap();
            // What was found before the interruption was reported then.
            let again = report.hits().map(|hit| hit.evaluation).take(found.len());
            assert!(again.eq(found.iter().copied()), "{case}");
        } else if !cancel.is_cancelled() {
            kept = None;
        }
        assert_eq!(&timeless(&report), expected, "{case}, slice {slice}");
        assert_eq!(
            calls.load(Ordering::Relaxed),
            ends[slice],
            "{case}: evaluated twice or never"
        );
    }
    cut_short
}

fn after_an_interrupt_anywhere(name: &str, probes: f64) {
    let budget = part_of_a_long_run();
    for entry in quick() {
        let (expected, _, ends) = uninterrupted(entry, name, probes, &budget);
        let (first, second) = (ends[0], ends[1]);
        let anywhere = [1, 2, 3, 17, 29, 30, 31, 63, 64, 65, 128, first - 1, first];
        let later = [1, 2, 5, 33, 64, 65, 100, second - first].map(|calls| first + calls);
        let cut_short = anywhere
            .into_iter()
            .chain(later)
            .filter(|&fatal| interrupted_at(entry, name, probes, &budget, fatal, (&expected, &ends)));
        // Not where the last evaluation of a slice ends it anyway.
        assert!(cut_short.count() >= 18, "{} on {name}", entry.name);
    }
}

/// With so many axes 26 particles are proposed at a time: a swarm of 30 or 40 starts in two parts, from C_prev in later slices.
#[test]
fn after_an_interrupt_between_the_parts_of_a_swarm() {
    let budget = Budget::evaluations(42);
    for name in ["pso", "spso-2011", "niching-pso-dbscan"] {
        let entry = engine::find(name).unwrap();
        let (expected, _, ends) = uninterrupted(entry, "wide", 0.0, &budget);
        for fatal in [28, ends[0] + 28] {
            assert!(
                interrupted_at(entry, "wide", 0.0, &budget, fatal, (&expected, &ends)),
                "{name}"
            );
        }
    }
}

#[test]
fn after_an_interrupt_anywhere_on_a_lattice() {
    after_an_interrupt_anywhere("lattice", 0.0);
}

#[test]
fn after_an_interrupt_anywhere_in_a_square() {
    after_an_interrupt_anywhere("square", 0.15);
}

#[test]
fn after_an_interrupt_anywhere_on_mixed_axes() {
    after_an_interrupt_anywhere("mixed", 0.0);
}

#[test]
fn from_every_checkpoint_of_a_run() {
    for name in [
        "random",
        "latest-hit-qpso",
        "descent-flood",
        "branch-and-bound",
        "portfolio",
    ] {
        let entry = engine::find(name).unwrap();
        let (expected, _, _) = uninterrupted(entry, "mixed", 0.1, &budget());
        let (calls, cancel) = (AtomicU64::new(0), Cancel::new());
        let problem = problem("mixed", &calls, 0, &cancel);
        let mut saved = Vec::new();
        let report = search(entry, 0.1)
            .run_with(
                &problem,
                &budget(),
                RunOptions::new().checkpoints(Duration::ZERO, &mut |checkpoint: &Saved| {
                    saved.push(checkpoint.clone());
                }),
            )
            .unwrap();
        assert_eq!(timeless(&report), expected[0], "saving changes nothing");
        let ended = saved.pop().unwrap();
        assert_eq!(
            ended.contents.unfinished.as_ref().unwrap().stop,
            Some(report.stop_reason)
        );
        for saved in saved.iter().step_by(1 + saved.len() / 20).chain([&ended]) {
            let report = resume(entry, saved)
                .run_resumed(&problem, RunOptions::new())
                .unwrap();
            assert_eq!(timeless(&report), expected[0], "{name}");
        }
    }
}

#[test]
fn while_a_batch_is_out() {
    for entry in quick() {
        let (calls, cancel) = (AtomicU64::new(0), Cancel::new());
        let problem = problem("square", &calls, 0, &cancel);
        let (expected, ..) = uninterrupted(entry, "square", 0.1, &budget());
        for resumed_after in [0, 1, 4] {
            let mut search = search(entry, 0.1);
            for expected in &expected[..2] {
                let mut slice = search.start(&problem, &budget()).unwrap();
                let mut saved = None;
                for batch in 0.. {
                    let candidates = slice.ask().unwrap().to_vec();
                    if candidates.is_empty() {
                        break;
                    }
                    if batch == resumed_after {
                        saved = Some((slice.checkpoint(), candidates));
                        break;
                    }
                    let fitness: Vec<f64> = candidates.iter().map(|c| problem.fitness(c)).collect();
                    slice.tell(&fitness).unwrap();
                }
                let Some((saved, candidates)) = saved else {
                    assert_eq!(&timeless(&slice.finish()), expected, "{}", entry.name);
                    continue;
                };
                drop(slice);
                search = resume(entry, &saved);
                let mut slice = search.start_resumed(&problem).unwrap();
                let mut asked = slice.ask().unwrap().to_vec();
                assert_eq!(asked, candidates, "{}", entry.name);
                while !asked.is_empty() {
                    let fitness: Vec<f64> = asked.iter().map(|c| problem.fitness(c)).collect();
                    slice.tell(&fitness).unwrap();
                    asked = slice.ask().unwrap().to_vec();
                }
                assert_eq!(&timeless(&slice.finish()), expected, "{}", entry.name);
            }
        }
    }
}

/// Cut short on several threads, a batch has holes.
#[cfg(feature = "rayon")]
#[test]
fn on_threads() {
    let entry = engine::find("random").unwrap();
    let cancel = Cancel::new();
    let calls = AtomicU64::new(0);
    let problem = from_fn(Space::lattice(2, 60).unwrap(), 30.0, |x: &[f64]| {
        if calls.fetch_add(1, Ordering::Relaxed) + 1 == 700 {
            cancel.cancel();
        }
        // Long enough for threads to be used.
        (0..20_000).fold(x[0] * x[1], |sum: f64, i| {
            core::hint::black_box(sum + f64::from(i) * 1e-300)
        })
    });
    let whole = Search::with(entry.configure([]).unwrap())
        .run(&problem, &Budget::evaluations(400))
        .unwrap();
    let mut saved: Option<Saved> = None;
    let part = Search::with(entry.configure([]).unwrap())
        .threads(2)
        .run_with(
            &problem,
            &Budget::evaluations(400).and_until(&cancel),
            RunOptions::new().checkpoints(Duration::MAX, &mut |checkpoint: &Saved| {
                saved = Some(checkpoint.clone());
            }),
        )
        .unwrap();
    assert_eq!(part.stop_reason, StopReason::Cancelled);
    let resumed = resume(entry, &saved.unwrap())
        .threads(2)
        .run_resumed(&problem, RunOptions::new())
        .unwrap();
    assert_eq!(timeless(&resumed), timeless(&whole));
}

fn lanes<P: Problem>(entry: &EngineSpec) -> Search<P> {
    search(entry, 0.1).islands(3)
}

/// Several lanes are saved together, while a batch is out, while their probes are, and when they are cancelled.
#[test]
fn lanes_are_saved_and_resumed() {
    for name in ["latest-hit-qpso", "walk", "portfolio"] {
        let entry = engine::find(name).unwrap();
        let never = (AtomicU64::new(0), Cancel::new());
        let plain = problem("mixed", &never.0, 0, &never.1);
        let budget = Budget::evaluations(600);
        let mut straight = lanes(entry);
        let expected = [0, 1].map(|_| timeless(&straight.run(&plain, &budget).unwrap()));
        let ends = never.0.load(Ordering::Relaxed);
        for fatal in [
            1,
            20,
            90,
            240,
            450,
            535,
            ends / 2 - 3,
            ends / 2 + 12,
            ends / 2 + 270,
        ] {
            let (calls, cancel) = (AtomicU64::new(0), Cancel::new());
            let mortal = problem("mixed", &calls, fatal, &cancel);
            let (mut search, mut kept) = (lanes(entry), None);
            for expected in &expected {
                let limits = if cancel.is_cancelled() {
                    budget.clone()
                } else {
                    budget.clone().and_until(&cancel)
                };
                let mut keep = |saved: &Saved| kept = Some(saved.clone());
                let options = RunOptions::new().checkpoints(Duration::MAX, &mut keep);
                let mut report = search.run_with(&mortal, &limits, options).unwrap();
                if report.stop_reason == StopReason::Cancelled {
                    search = resume(entry, kept.as_ref().unwrap());
                    report = search.run_resumed(&mortal, RunOptions::new()).unwrap();
                }
                assert_eq!(&timeless(&report), expected, "{name}, cancelled at call {fatal}");
            }
            assert_eq!(
                calls.load(Ordering::Relaxed),
                ends,
                "{name}: evaluated twice or never"
            );
        }
        // By hand, resumed at every 40th batch.
        let mut search = lanes(entry);
        let mut saved = search.start(&plain, &budget).unwrap().checkpoint();
        loop {
            let mut resumed = resume(entry, &saved);
            let mut slice = resumed.start_resumed(&plain).unwrap();
            for _ in 0..40 {
                let fitness: Vec<f64> = slice.ask().unwrap().iter().map(|c| plain.fitness(c)).collect();
                if fitness.is_empty() {
                    break;
                }
                slice.tell(&fitness).unwrap();
            }
            if slice.ask().unwrap().is_empty() {
                assert_eq!(timeless(&slice.finish()), expected[0], "{name}, by hand");
                break;
            }
            saved = slice.checkpoint();
        }
    }
}

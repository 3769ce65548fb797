//! Searches that are saved and resumed, against searches that were never interrupted: equal in all but the times.

#![allow(clippy::unwrap_used, reason = "a test")]

use core::sync::atomic::{AtomicU64, Ordering};
use core::time::Duration;

use satisfice::engine::{self, EngineSpec};
use satisfice::{
    Axis, Budget, Cancel, Checkpoint, Error, Located, Report, SatisficingProblem, Saving, Search, Space,
    StopReason, from_fn,
};

type Saved = Checkpoint<Located<f64>>;

/// What a file does to a checkpoint. Without the feature there are no files, and it is kept as it is.
#[cfg(feature = "serde")]
fn through_a_file(checkpoint: &Saved) -> Saved {
    serde_json::from_str(&serde_json::to_string(checkpoint).unwrap()).unwrap()
}
#[cfg(not(feature = "serde"))]
fn through_a_file(checkpoint: &Saved) -> Saved {
    checkpoint.clone()
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
    let (middle, width) = if name == "lattice" { (5.5, 0.4) } else { (0.1, 0.1) };
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

fn search(entry: &EngineSpec, probes: f64) -> Search<f64, Located<f64>> {
    Search::new(entry.configure([]).unwrap()).seed(9).probes(probes)
}

fn resume(entry: &EngineSpec, saved: &Saved) -> Search<f64, Located<f64>> {
    Search::resume(through_a_file(saved), entry.configure([]).unwrap()).unwrap()
}

fn budget() -> Budget {
    Budget::evaluations(EVALUATIONS)
}

/// Reports of a search that nobody interrupts, its checkpoints between slices, and calls of the fitness at the end of each.
fn uninterrupted(entry: &EngineSpec, name: &str, probes: f64) -> (Vec<String>, Vec<Saved>, Vec<u64>) {
    let (calls, cancel) = (AtomicU64::new(0), Cancel::new());
    let problem = problem(name, &calls, 0, &cancel);
    let mut search = search(entry, probes);
    let (mut reports, mut saved, mut ends) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..SLICES {
        saved.push(search.checkpoint());
        reports.push(timeless(&search.run(&problem, &budget()).unwrap()));
        ends.push(calls.load(Ordering::Relaxed));
    }
    (reports, saved, ends)
}

#[test]
fn at_every_slice_boundary() {
    for entry in engine::all() {
        for name in ["lattice", "square", "mixed"] {
            let (expected, saved, _) = uninterrupted(entry, name, 0.1);
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
    fatal: u64,
    expected: &[String],
    ends: &[u64],
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
                .run_saving(
                    &problem,
                    &budget().and_until(&cancel),
                    &mut (),
                    Saving::every(Duration::MAX, &mut |saved: &Saved| kept = Some(saved.clone())),
                )
                .unwrap()
        } else {
            search.run(&problem, &budget()).unwrap()
        };
        if report.stop_reason == StopReason::Cancelled {
            cut_short = true;
            let found: Vec<_> = report.hits().map(|hit| hit.evaluation).collect();
            let saved = kept.clone().unwrap();
            search = resume(entry, &saved);
            report = search.run_resumed(&problem, None, &mut (), None).unwrap();
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

#[test]
fn after_an_interrupt_anywhere() {
    for entry in engine::all() {
        for (name, probes) in [("lattice", 0.0), ("square", 0.15), ("mixed", 0.0)] {
            let (expected, _, ends) = uninterrupted(entry, name, probes);
            let (first, second) = (ends[0], ends[1]);
            let anywhere = [1, 2, 3, 17, 29, 30, 31, 63, 64, 65, 128, first - 1, first];
            let later = [1, 2, 5, 33, 64, 65, 100, second - first].map(|calls| first + calls);
            let cut_short = anywhere
                .into_iter()
                .chain(later)
                .filter(|&fatal| interrupted_at(entry, name, probes, fatal, &expected, &ends));
            // Not where the last evaluation of a slice ends it anyway.
            assert!(cut_short.count() >= 18, "{} on {name}", entry.name);
        }
    }
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
        let (expected, _, _) = uninterrupted(entry, "mixed", 0.1);
        let (calls, cancel) = (AtomicU64::new(0), Cancel::new());
        let problem = problem("mixed", &calls, 0, &cancel);
        let mut saved = Vec::new();
        let report = search(entry, 0.1)
            .run_saving(
                &problem,
                &budget(),
                &mut (),
                Saving::every(Duration::ZERO, &mut |checkpoint: &Saved| {
                    saved.push(checkpoint.clone());
                }),
            )
            .unwrap();
        assert_eq!(timeless(&report), expected[0], "saving changes nothing");
        let ended = saved.pop().unwrap();
        assert_eq!(ended.slice.as_ref().unwrap().stop, Some(report.stop_reason));
        for saved in saved.iter().step_by(1 + saved.len() / 20).chain([&ended]) {
            let report = resume(entry, saved)
                .run_resumed(&problem, None, &mut (), None)
                .unwrap();
            assert_eq!(timeless(&report), expected[0], "{name}");
        }
    }
}

#[test]
fn while_a_batch_is_out() {
    for entry in engine::all() {
        let (calls, cancel) = (AtomicU64::new(0), Cancel::new());
        let problem = problem("square", &calls, 0, &cancel);
        let (expected, ..) = uninterrupted(entry, "square", 0.1);
        for resumed_after in [0, 1, 4] {
            let mut search = search(entry, 0.1);
            for expected in &expected[..2] {
                search.begin(&problem, &budget()).unwrap();
                for batch in 0.. {
                    let mut candidates = search.ask(&problem).unwrap().to_vec();
                    if candidates.is_empty() {
                        break;
                    }
                    if batch == resumed_after {
                        search = resume(entry, &search.checkpoint());
                        let again = search.ask(&problem).unwrap();
                        assert_eq!(again, candidates, "{}", entry.name);
                        candidates = again.to_vec();
                    }
                    let fitness: Vec<f64> = candidates.iter().map(|c| problem.fitness(c)).collect();
                    search.tell(&problem, &fitness).unwrap();
                }
                assert_eq!(
                    &timeless(&search.finish(&problem).unwrap()),
                    expected,
                    "{}",
                    entry.name
                );
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
    let whole = Search::<f64, _>::new(entry.configure([]).unwrap())
        .run(&problem, &Budget::evaluations(400))
        .unwrap();
    let mut saved: Option<Saved> = None;
    let part = Search::<f64, _>::new(entry.configure([]).unwrap())
        .threads(2)
        .run_saving(
            &problem,
            &Budget::evaluations(400).and_until(&cancel),
            &mut (),
            Saving::every(Duration::MAX, &mut |checkpoint: &Saved| {
                saved = Some(checkpoint.clone());
            }),
        )
        .unwrap();
    assert_eq!(part.stop_reason, StopReason::Cancelled);
    let resumed = resume(entry, &saved.unwrap())
        .threads(2)
        .run_resumed(&problem, None, &mut (), None)
        .unwrap();
    assert_eq!(timeless(&resumed), timeless(&whole));
}

fn refused(result: Result<Search<f64, Located<f64>>, Error>) -> String {
    match result {
        Err(Error::State(why)) => why,
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("accepted"),
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let (calls, cancel) = (AtomicU64::new(0), Cancel::new());
    let lattice = problem("lattice", &calls, 0, &cancel);
    let entry = engine::find("latest-hit-qpso").unwrap();
    let mut search = search(entry, 0.0);
    search.begin(&lattice, &budget()).unwrap();
    assert!(!search.ask(&lattice).unwrap().is_empty());
    let saved = search.checkpoint();

    let with = |settings: &[(&str, &str)]| entry.configure(settings.iter().copied()).unwrap();
    assert!(refused(Search::resume(saved.clone(), engine::build("walk").unwrap())).contains("engine is"));
    assert!(refused(Search::resume(saved.clone(), with(&[("particles", "31")]))).contains("particles=30"));
    let mut other = saved.clone();
    other.version = "0.0.0".to_owned();
    assert!(refused(Search::resume(other, with(&[]))).contains("version"));
    let mut other = saved.clone();
    other.scalar = "f32".to_owned();
    assert!(refused(Search::resume(other, with(&[]))).contains("scalar"));
    let mut other = saved.clone();
    other.dimension = None;
    assert!(refused(Search::resume(other, with(&[]))).contains("axes"));

    // Another problem, of another dimension and of the same.
    let square = problem("square", &calls, 0, &cancel);
    let mut resumed = Search::resume(saved.clone(), with(&[])).unwrap();
    assert!(matches!(
        resumed.run_resumed(&square, None, &mut (), None),
        Err(Error::SpaceChanged { before: 3, now: 2 })
    ));
    let mut other = saved.clone();
    other.problem = Some(satisfice::catalogue::Description::default());
    let mut resumed = Search::resume(other, with(&[])).unwrap();
    assert!(matches!(
        resumed.run_resumed(&lattice, None, &mut (), None),
        Err(Error::State(why)) if why.contains("problem is unnamed")
    ));
    // Nothing has begun.
    let mut fresh = Search::<f64, Located<f64>>::new(with(&[]));
    assert!(fresh.run_resumed(&lattice, None, &mut (), None).is_err());
}

/// One word changed, one word or one hit missing: found out.
#[cfg(feature = "serde")]
#[test]
fn damage_is_found() {
    let (calls, cancel) = (AtomicU64::new(0), Cancel::new());
    let problem = problem("square", &calls, 0, &cancel);
    let entry = engine::find("latest-hit-qpso").unwrap();
    let mut search = search(entry, 0.1);
    search.begin(&problem, &budget()).unwrap();
    for _ in 0..100 {
        let candidates = search.ask(&problem).unwrap().to_vec();
        let fitness: Vec<f64> = candidates.iter().map(|c| problem.fitness(c)).collect();
        search.tell(&problem, &fitness).unwrap();
    }
    let saved = serde_json::to_value(search.checkpoint()).unwrap();
    let words = saved["state"].as_array().unwrap().len();
    let resumed = |value: serde_json::Value| {
        let checkpoint: Saved = serde_json::from_value(value).map_err(|e| Error::State(e.to_string()))?;
        Search::<f64, _>::resume(checkpoint, entry.configure([]).unwrap())
    };
    assert!(resumed(saved.clone()).is_ok());
    for word in (0..words).step_by(7) {
        let mut changed = saved.clone();
        let bits = changed["state"][word].as_u64().unwrap();
        changed["state"][word] = (bits ^ 1 << (word % 8)).into();
        assert!(resumed(changed).is_err(), "word {word}");
        let mut cut = saved.clone();
        cut["state"].as_array_mut().unwrap().remove(word);
        assert!(resumed(cut).is_err(), "without word {word}");
    }
    let mut cut = saved.clone();
    assert!(cut["slice"]["archive"].as_array_mut().unwrap().pop().is_some());
    assert!(resumed(cut).is_err());
}

//! The user's start points: evaluated first, counted, told to every engine, refused if they are not in the space.

#![allow(clippy::unwrap_used, reason = "a test")]

use std::sync::{Arc, Mutex};

use satisfice::{
    Axis, Budget, Checkpoint, Error, Located, RunOptions, SatisficingProblem, Search, Space, Tickets, engine,
    from_fn,
};

type Problem = dyn SatisficingProblem<Scalar = f64, Solution = Located<f64>> + Send;

/// All points that were evaluated, in order.
type Evaluated = Arc<Mutex<Vec<Vec<f64>>>>;

/// Hits within 0.01 of the origin of a mixed space, which is not its middle, and the order in which points are evaluated.
fn problem() -> (Arc<Problem>, Evaluated) {
    let seen = Arc::new(Mutex::new(Vec::new()));
    let log = Arc::clone(&seen);
    let space = Space::new([Axis::continuous(-6.0, 5.0), Axis::integer(-100, 100)]).unwrap();
    let problem = from_fn(space, 0.01, move |x: &[f64]| {
        log.lock().unwrap().push(x.to_vec());
        x[0].hypot(x[1])
    })
    .boxed();
    (Arc::new(problem), seen)
}

const STARTS: [[f64; 2]; 3] = [[0.5, 2.0], [0.001, 0.0], [-3.0, 50.0]];

#[test]
fn they_come_first_for_every_engine() {
    for entry in engine::all() {
        for islands in [1, 2] {
            let (problem, seen) = problem();
            let search = || {
                Search::<Problem>::with(entry.configure([]).unwrap())
                    .islands(islands)
                    .start_from(STARTS)
            };
            let report = search().run(&*problem, &Budget::evaluations(40)).unwrap();
            assert_eq!(report.counts.evaluations, 40, "{}", entry.name);
            let first = &report.hits().next().unwrap();
            assert_eq!(first.solution.coordinates, [0.001, 0.0], "{}", entry.name);
            let seen = std::mem::take(&mut *seen.lock().unwrap());
            let firsts = |from: usize, n: usize| seen[from..from + n].to_vec();
            if islands == 1 {
                assert_eq!(firsts(0, 3), STARTS, "{}", entry.name);
                assert_eq!(first.evaluation, 2);
                // By hand it is the same.
                let mut tickets =
                    Tickets::ordered(search(), Arc::clone(&problem), &Budget::evaluations(40)).unwrap();
                let mut asked = tickets.ask(1000);
                while !asked.is_empty() {
                    for job in asked.iter().rev() {
                        tickets.tell(job.ticket, problem.fitness(&job.solution)).unwrap();
                    }
                    asked = tickets.ask(1000);
                }
                let by_hand = tickets.finish();
                assert!(
                    by_hand
                        .hits()
                        .map(|hit| hit.solution)
                        .eq(report.hits().map(|hit| hit.solution))
                );
            }
            let mut eager = Tickets::eager(search(), Arc::clone(&problem), &Budget::evaluations(40)).unwrap();
            let solutions: Vec<_> = eager
                .ask(3)
                .into_iter()
                .map(|job| job.solution.coordinates)
                .collect();
            assert_eq!(solutions, STARTS, "{}", entry.name);
        }
    }
}

#[test]
fn a_local_search_begins_at_the_best_of_them() {
    for name in ["descent", "descent-flood"] {
        let space = Space::lattice(4, 100).unwrap();
        let problem = from_fn(space, 0.5, |x: &[f64]| x.iter().map(|x| (x - 70.0).abs()).sum()).boxed();
        let hits = |starts: &[[f64; 4]]| {
            let mut search = Search::named(name).unwrap().start_from(starts.to_vec());
            search
                .run(&problem, &Budget::evaluations(90))
                .unwrap()
                .hit_count()
        };
        assert_eq!(hits(&[]), 0, "{name}");
        assert_eq!(
            hits(&[[10.0; 4], [68.0, 70.0, 71.0, 70.0], [0.0; 4]]),
            1,
            "{name}"
        );
    }
}

/// A hit in a small basin of a plain of 10^8 points: nothing but the start leads there.
#[test]
fn the_descents_of_the_default_begin_there() {
    let basin = |x: &[f64]| {
        let far: f64 = x.iter().map(|x| (x - 70.0).abs()).sum();
        if far < 6.0 { far } else { 1e3 }
    };
    let problem = from_fn(Space::lattice(4, 100).unwrap(), 0.5, basin).boxed();
    let hits = |starts: &[[f64; 4]]| {
        let mut search = Search::new().start_from(starts.to_vec());
        search
            .run(&problem, &Budget::evaluations(11_000))
            .unwrap()
            .hit_count()
    };
    assert_eq!(hits(&[]), 0);
    assert_eq!(hits(&[[10.0; 4], [68.0, 70.0, 71.0, 70.0]]), 1);
}

#[test]
fn one_that_is_not_of_the_space_is_refused_with_its_number() {
    let (problem, _) = problem();
    for bad in [[0.0, 0.5], [5.5, 0.0], [f64::NAN, 0.0], [0.0, 101.0]] {
        let mut search = Search::<Problem>::named("random")
            .unwrap()
            .start_from([[0.0, 0.0], bad]);
        let refused = search.run(&*problem, &Budget::evaluations(10)).unwrap_err();
        assert!(matches!(refused, Error::StartPoint { index: 1, .. }), "{refused}");
        assert!(refused.to_string().starts_with("start point 1: "), "{refused}");
    }
    let mut search = Search::<Problem>::named("random")
        .unwrap()
        .start_from([vec![0.0]]);
    let refused = search.run(&*problem, &Budget::evaluations(10)).unwrap_err();
    assert!(matches!(refused, Error::StartPoint { index: 0, .. }), "{refused}");
}

#[test]
fn a_saved_slice_still_has_them() {
    let starts: Vec<[f64; 2]> = (0..100)
        .map(|i| [f64::from(i) / 100.0, f64::from(i % 7)])
        .collect();
    let run = || Search::<Problem>::named("walk").unwrap().start_from(&starts);
    let (problem, _) = problem();
    let budget = Budget::evaluations(150);
    let whole = run().run(&*problem, &budget).unwrap();
    let mut search = run();
    let mut slice = search.start(&*problem, &budget).unwrap();
    let mut saved: Vec<Checkpoint<_>> = vec![slice.checkpoint()];
    for _ in 0..5 {
        let fitness: Vec<f64> = slice.ask().unwrap().iter().map(|c| problem.fitness(c)).collect();
        saved.push(slice.checkpoint());
        slice.tell(&fitness).unwrap();
    }
    for checkpoint in saved {
        let mut resumed = Search::<Problem>::resume(checkpoint, engine::Walk::default()).unwrap();
        let report = resumed.run_resumed(&*problem, RunOptions::new()).unwrap();
        assert!(
            report
                .hits()
                .map(|hit| hit.solution)
                .eq(whole.hits().map(|hit| hit.solution))
        );
        assert_eq!(report.counts, whole.counts);
    }
}

#[test]
fn a_checkpoint_before_the_slice_has_them() {
    let (problem, seen) = problem();
    let search: Search<Problem> = Search::with(engine::Walk::default()).start_from(STARTS);
    let saved = serde_json::to_string(&search.checkpoint()).unwrap();
    let saved: Checkpoint<Located<f64>> = serde_json::from_str(&saved).unwrap();
    let mut resumed: Search<Problem> = Search::resume(saved, engine::Walk::default()).unwrap();
    resumed.run(&*problem, &Budget::evaluations(10)).unwrap();
    assert_eq!(seen.lock().unwrap()[..3], STARTS.map(|point| point.to_vec()));
}

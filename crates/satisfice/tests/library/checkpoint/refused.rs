//! A checkpoint of another search is refused, and damage is detected.

use satisfice::Boundary;
use satisfice::state::State;

use super::*;

fn refused<P: Problem>(_: &P, saved: Saved, engine: ConfiguredEngine<f64>) -> String {
    match Search::<P>::resume(saved, engine) {
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
    let mut slice = search.start(&lattice, &budget()).unwrap();
    assert!(!slice.ask().unwrap().is_empty());
    let saved = slice.checkpoint();

    let with = |settings: &[(&str, &str)]| entry.configure(settings.iter().copied()).unwrap();
    let walk = engine::Walk::default().into();
    assert!(refused(&lattice, saved.clone(), walk).contains("engine is"));
    assert!(refused(&lattice, saved.clone(), with(&[("particles", "31")])).contains("particles=30"));
    let mut other = saved.clone();
    other.contents.version = "0.0.0".to_owned();
    assert!(refused(&lattice, other, with(&[])).contains("version"));
    let mut other = saved.clone();
    other.contents.scalar = "f32".to_owned();
    assert!(refused(&lattice, other, with(&[])).contains("scalar"));
    let mut other = saved.clone();
    other.contents.dimension = None;
    assert!(refused(&lattice, other, with(&[])).contains("axes"));
    let mut other = saved.clone();
    other.contents.unfinished.as_mut().unwrap().counts.evaluations = u64::MAX;
    assert!(refused(&lattice, other, with(&[])).contains("out of range"));

    // Another problem, of another dimension and of the same.
    let square = problem("square", &calls, 0, &cancel);
    let mut resumed = Search::resume(saved.clone(), with(&[])).unwrap();
    assert!(matches!(
        resumed.run_resumed(&square, RunOptions::new()),
        Err(Error::SpaceChanged { before: 3, now: 2 })
    ));
    let mut other = saved.clone();
    other.contents.problem.as_mut().unwrap().description = satisfice::catalogue::Description::default();
    let mut resumed = Search::resume(other, with(&[])).unwrap();
    assert!(matches!(
        resumed.run_resumed(&lattice, RunOptions::new()),
        Err(Error::State(why)) if why.contains("problem is unnamed")
    ));
    // Closures have one name; their separations, spaces and thresholds tell them apart.
    let wider = from_fn(space("lattice"), 0.5, |x: &[f64]| x[0]).separation(0.02);
    let mut resumed = Search::resume(saved, with(&[])).unwrap();
    assert!(matches!(
        resumed.run_resumed(&wider, RunOptions::new()),
        Err(Error::State(why)) if why == "its threshold is 0.4, not 0.5"
    ));
    // How far apart answers are is a part of their description; the boundary rule is one of the space.
    let start = |separation: f64, boundary: Boundary| {
        let space = space("lattice").with_boundary(boundary);
        let problem = from_fn(space, 0.5, |x: &[f64]| x[0]).separation(separation);
        let mut search = Search::with(with(&[]));
        let saved = search
            .start(&problem, &Budget::evaluations(100))
            .unwrap()
            .checkpoint();
        (saved, problem)
    };
    let (saved, same) = start(0.5, Boundary::Reflect);
    for (other, reason) in [
        (start(0.6, Boundary::Reflect).1, "separation=0.5"),
        (start(0.5, Boundary::Clamp).1, "another space"),
    ] {
        let mut resumed = Search::resume(saved.clone(), with(&[])).unwrap();
        assert!(matches!(
            resumed.run_resumed(&other, RunOptions::new()),
            Err(Error::State(why)) if why.contains(reason)
        ));
    }
    let mut resumed = Search::resume(saved, with(&[])).unwrap();
    assert!(resumed.run_resumed(&same, RunOptions::new()).is_ok());
    // Nothing has begun.
    let mut fresh = Search::with(with(&[]));
    assert!(fresh.run_resumed(&lattice, RunOptions::new()).is_err());
}

#[test]
fn between_slices_a_problem_of_another_name_is_refused() {
    struct Named(Space<f64>);
    impl SatisficingProblem for Named {
        type Scalar = f64;
        type Solution = u32;
        fn space(&self) -> &Space<f64> {
            &self.0
        }
        fn decode(&self, values: &[f64]) -> u32 {
            values[0] as u32
        }
        fn fitness(&self, solution: &u32) -> f64 {
            f64::from(*solution)
        }
        fn threshold(&self) -> f64 {
            3.0
        }
    }
    let named = Named(Space::lattice(1, 50).unwrap());
    let budget = Budget::evaluations(20);
    let mut search = Search::named("random").unwrap();
    search.run(&named, &budget).unwrap();
    let mut saved = search.checkpoint();
    saved.contents.problem.as_mut().unwrap().description.name = "other".to_owned();
    let mut resumed = Search::resume(saved, engine::Random::default()).unwrap();
    assert!(
        matches!(resumed.run(&named, &budget), Err(Error::State(why)) if why.contains("problem is other"))
    );
}

/// An elapsed time that no slice can reach is no reason to panic.
#[test]
fn a_crafted_time_does_no_harm() {
    let (calls, cancel) = (AtomicU64::new(0), Cancel::new());
    let problem = problem("square", &calls, 0, &cancel);
    let entry = engine::find("random").unwrap();
    for time in [None, Some(Duration::from_secs(1)), Some(Duration::MAX)] {
        let mut search = search(entry, 0.0);
        let mut limits = budget();
        limits.time = time;
        let mut saved = search.start(&problem, &limits).unwrap().checkpoint();
        let long = Duration::from_secs(1 << 40);
        saved.contents.unfinished.as_mut().unwrap().elapsed = long;
        let report = resume(entry, &saved)
            .run_resumed(&problem, RunOptions::new())
            .unwrap();
        assert!(report.elapsed >= long);
        saved.contents.unfinished.as_mut().unwrap().elapsed = Duration::MAX;
        let engine = entry.configure([]).unwrap();
        assert!(refused(&problem, saved, engine).contains("time is out of range"));
    }
}

/// Every byte counts: a changed number, text or hit is found out.
#[test]
fn damage_is_found() {
    let (calls, cancel) = (AtomicU64::new(0), Cancel::new());
    let problem = problem("square", &calls, 0, &cancel);
    let entry = engine::find("latest-hit-qpso").unwrap();
    let mut search = search(entry, 0.1);
    let mut slice = search.start(&problem, &budget()).unwrap();
    for _ in 0..100 {
        let fitness: Vec<f64> = slice.ask().unwrap().iter().map(|c| problem.fitness(c)).collect();
        slice.tell(&fitness).unwrap();
    }
    let saved = serde_json::to_string(&slice.checkpoint()).unwrap();
    assert!(serde_json::from_str::<Saved>(&saved).is_ok());
    let mut refused = 0;
    for (place, byte) in saved
        .bytes()
        .enumerate()
        .filter(|(_, byte)| byte.is_ascii_alphanumeric())
    {
        if place % 7 != 0 {
            continue;
        }
        let other = if matches!(byte, b'9' | b'Z' | b'z') {
            b'1'
        } else {
            byte + 1
        };
        let mut changed = saved.clone().into_bytes();
        changed[place] = other;
        let Ok(read) = serde_json::from_slice::<Saved>(&changed) else {
            refused += 1;
            continue;
        };
        // The last digits of a number may be beyond what a float holds.
        assert_eq!(
            serde_json::to_string(&read).unwrap(),
            saved,
            "byte {place} changed"
        );
    }
    assert!(refused > 500, "{refused}");
    let mut value: serde_json::Value = serde_json::from_str(&saved).unwrap();
    let packed = &mut value["contents"]["unfinished"]["archive"]["packed"];
    let State(mut hits) = serde_json::from_value(packed.clone()).unwrap();
    let fitness = slice
        .checkpoint()
        .contents
        .unfinished
        .unwrap()
        .archive
        .get(0)
        .unwrap()
        .fitness;
    let place = hits
        .windows(8)
        .position(|bytes| bytes == fitness.to_le_bytes())
        .unwrap();
    hits[place..place + 8].copy_from_slice(&30.0_f64.to_le_bytes());
    *packed = serde_json::to_value(State(hits)).unwrap();
    let error = serde_json::from_value::<Saved>(value).unwrap_err();
    assert!(
        error.to_string().contains("damaged"),
        "a hit with another fitness: {error}"
    );
}

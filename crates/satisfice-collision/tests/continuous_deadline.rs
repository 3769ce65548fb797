//! Motions whose decision by integers takes long, left when the caller says so.
#![allow(clippy::unwrap_used)]

use std::cell::Cell;

use satisfice_collision::Mesh;
use satisfice_collision::continuous::{FeatureOf, MovingContact, Separation, Step};
use satisfice_collision::distance::PairKind;
use satisfice_collision::scene::Completeness;

/// Two triangles whose coordinates differ by six hundred digits, so that no piece of the step tells where they are near.
fn step() -> Step {
    let mesh = |vertices: [[f64; 3]; 3]| Mesh::new(vertices.to_vec(), vec![], vec![[0, 1, 2]]).unwrap();
    let mut step = Step::new();
    step.add_rigid(
        &mesh([
            [-3e300, 1e-300, -1e-300],
            [0.0, 3e-300, 3e-300],
            [0.0, 0.0, 1e-300],
        ]),
        &[
            [1.5e300, 0.0, 0.0],
            [-3e300, 1e-300, -1e300],
            [3e-300, 0.0, 3e300],
        ],
    )
    .unwrap();
    step.add_rigid(
        &mesh([
            [0.0, 1e300, 1e300],
            [1e300, 3e-300, -1.5e300],
            [1e-300, 1.5e300, 0.0],
        ]),
        &[
            [1e300, -1e-300, 0.0],
            [0.0, 0.0, -1e300],
            [3e300, 1.5e-300, -1e-300],
        ],
    )
    .unwrap();
    step
}

const DELTA: f64 = 1.0;

fn on_threads<T: Send>(threads: usize, ask: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap().install(ask)
}

#[test]
fn a_decision_that_takes_long_is_left() {
    let step = step();
    let separation = Separation::new(DELTA).unwrap();
    let all = step.hits(PairKind::EdgeEdge, separation).unwrap();
    assert!(!all.pairs.is_empty() && all.by_integers > 0 && all.undecided == 0);
    for threads in [1, 2] {
        // the first question comes before any decision
        let calls = Cell::new(0);
        let step = &step;
        let some = on_threads(threads, move || {
            let mut stop = || {
                calls.set(calls.get() + 1);
                calls.get() > 1
            };
            step.hits_until(PairKind::EdgeEdge, separation, &mut stop)
        });
        let some = some.unwrap();
        assert!(some.undecided > 0 && some.undecided <= 9, "{some:?}");
        assert!(some.pairs.iter().all(|pair| all.pairs.contains(pair)));
        assert!(some.pairs.len() as u64 + some.undecided >= all.pairs.len() as u64);
    }
}

#[test]
fn an_earliest_impact_that_takes_long_is_left_with_proved_bounds() {
    let step = step();
    let separation = Separation::new(DELTA).unwrap();
    let kinds = [PairKind::EdgeEdge];
    let whole = step
        .earliest_among(&kinds, separation, 1e-6, &mut || false)
        .unwrap();
    assert!(whole.is_proved && whole.undecided == 0, "{whole:?}");
    let left = step
        .earliest_among(&kinds, separation, 1e-6, &mut || true)
        .unwrap();
    assert!(!left.is_proved && left.undecided > 0, "{left:?}");
    assert!(
        left.time[0] <= whole.time[0] && whole.time[1] <= left.time[1],
        "{left:?} {whole:?}"
    );
}

#[test]
fn the_time_of_a_pair_that_takes_long_is_left() {
    let step = step();
    let separation = Separation::new(DELTA).unwrap();
    let feature = |body: u32| FeatureOf { body, index: 0 };
    let pair = MovingContact {
        a: feature(0),
        b: feature(1),
    };
    let ask = |is_over: bool| {
        let kind = PairKind::EdgeEdge;
        step.impact_of_until(kind, &pair, separation, 1e-6, &|| is_over)
            .unwrap()
    };
    assert_eq!(ask(true), (None, Completeness::Unknown));
    let (impact, completeness) = ask(false);
    assert!(impact.is_some() && completeness == Completeness::Proved);
}

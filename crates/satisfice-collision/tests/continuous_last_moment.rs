//! Impacts at the end of a step: the search for the first one finds one exactly when there are pairs.
#![allow(clippy::unwrap_used)]

use satisfice_collision::continuous::{Separation, Step};
use satisfice_collision::{Mesh, Placement, generate};

const TOLERANCE: f64 = 1e-6;

/// A unit cube with its lowest corner here.
fn cube(corner: [f64; 3]) -> Mesh {
    let vertex = |i: usize| std::array::from_fn(|k| corner[k] + (i >> k & 1) as f64);
    let sides = [
        [0, 1, 3, 2],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 3, 7, 5],
    ];
    let triangles = sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    Mesh::new((0..8).map(vertex).collect(), Vec::new(), triangles.collect()).unwrap()
}

fn check(step: &Step, separation: Separation, case: &str) {
    let mut pairs = 0;
    for kind in step.kinds() {
        step.each_hit(kind, separation, &mut || false, &mut |_| pairs += 1)
            .unwrap();
    }
    let earliest = step.earliest(separation, TOLERANCE).unwrap();
    let [low, high] = earliest.time;
    assert!(earliest.is_proved, "{case}");
    assert_eq!(
        earliest.first.is_some(),
        pairs > 0,
        "{case}: {pairs} pairs, {earliest:?}"
    );
    assert!(low <= high && high <= 1.0, "{case}: {earliest:?}");
    let free = step.free_step(separation).unwrap();
    assert_eq!(free < 1.0, pairs > 0, "{case}: {pairs} pairs, free until {free}");
}

/// A cube that comes from afar and ends this deep in another, or this far from it.
#[test]
fn a_cube_that_arrives_at_the_end() {
    let mut hits = 0;
    for distance in [2.0, 1e3, 1e6] {
        for depth in [0.5, 1e-3, 1e-6, 1e-7, 1e-9, 1e-12, 0.0, -1e-12, -1e-7] {
            for separation in [Separation::TOUCHING, Separation::new(1e-7).unwrap()] {
                let resting = cube([0.0, 0.0, 0.0]);
                let from = cube([1.0 + distance, 0.25, 0.125]);
                let to = cube([1.0 - depth, 0.25, 0.125]);
                let mut step = Step::new();
                step.add_rigid(&from, to.vertices()).unwrap();
                step.add_rigid(&resting, resting.vertices()).unwrap();
                let case = format!("from {distance}, {depth} deep, below {separation:?}");
                check(&step, separation, &case);
                hits += u32::from(step.earliest(separation, TOLERANCE).unwrap().first.is_some());
            }
        }
    }
    assert!(hits > 40, "{hits}");
}

/// A step of balls, cut at its first impact or just beside it.
#[test]
fn a_step_that_is_cut_at_its_first_impact() {
    let ball = generate::icosphere(1.0, 2).unwrap();
    let resting = Placement::from_translation([3.0, 0.4, -0.3])
        .unwrap()
        .place(&ball)
        .unwrap();
    let step_of = |part: f64| {
        let along = |p: &[f64; 3]| [p[0] + 3.0 * part, p[1] + 0.5 * part, p[2] - 0.25 * part];
        let to: Vec<_> = ball.vertices().iter().map(along).collect();
        let mut step = Step::new();
        step.add_rigid(&ball, &to).unwrap();
        step.add_rigid(&resting, resting.vertices()).unwrap();
        step
    };
    for separation in [Separation::TOUCHING, Separation::new(0.01).unwrap()] {
        let whole = step_of(1.0).earliest(separation, 1e-12).unwrap();
        for beyond in [-1e-6, -1e-9, -1e-12, 0.0, 1e-12, 1e-9, 1e-7, 1e-6, 1e-3] {
            let part = whole.time[1] * (1.0 + beyond);
            check(
                &step_of(part),
                separation,
                &format!("{separation:?}, {beyond} beyond"),
            );
        }
    }
}

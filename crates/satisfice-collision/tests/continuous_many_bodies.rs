//! The first impact among many bodies: its work, and the same impact among all of them.
#![allow(clippy::unwrap_used)]

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use satisfice_collision::continuous::{Separation, Step};
use satisfice_collision::distance::{PairKind, Point};
use satisfice_collision::{Mesh, Placement, generate};

/// How bodies are placed in a cube whose volume is in proportion to their number.
#[derive(Debug, Clone, Copy)]
enum Scene {
    /// Anywhere: some are in each other at the start.
    Random,
    /// In the cells of a grid, which none leaves.
    Apart,
    /// The same inside a hollow ball, near whose box all of them are.
    Enclosed,
}

/// Balls of several sizes and numbers of features that move a little, in an order that says nothing about where they are.
fn balls(count: usize, scene: Scene, seed: u64) -> Vec<(Mesh, Vec<Point>)> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut number = move || (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    let across = (count as f64).cbrt();
    let cells = across.ceil() as usize;
    let mut order: Vec<usize> = (0..cells.pow(3)).collect();
    for last in (1..order.len()).rev() {
        order.swap(last, (number() * (last + 1) as f64) as usize);
    }
    let ball = |cell: usize| {
        let radius = 0.15 + 0.1 * number();
        let ball = generate::icosphere(radius, if cell.is_multiple_of(7) { 2 } else { 1 }).unwrap();
        let at = match scene {
            Scene::Random => [0; 3].map(|_| number() * across),
            Scene::Apart | Scene::Enclosed => {
                [cell % cells, cell / cells % cells, cell / cells / cells].map(|c| c as f64)
            }
        };
        let by = [0; 3].map(|_| 0.2 * number() - 0.1);
        let placed = Placement::from_translation(at).unwrap().place(&ball).unwrap();
        let to = Placement::from_translation(by).unwrap().place(&placed).unwrap();
        let to = to.vertices().to_vec();
        (placed, to)
    };
    let mut balls: Vec<_> = order.into_iter().take(count).map(ball).collect();
    if matches!(scene, Scene::Enclosed) {
        let around = generate::icosphere(1.5 * across, 2).unwrap();
        let middle = [0.5 * (cells as f64 - 1.0); 3];
        let around = Placement::from_translation(middle)
            .unwrap()
            .place(&around)
            .unwrap();
        let to = around.vertices().to_vec();
        balls.push((around, to));
    }
    balls
}

fn step(balls: &[(Mesh, Vec<Point>)]) -> Step {
    let mut step = Step::new();
    for (ball, to) in balls {
        step.add_rigid(ball, to).unwrap();
    }
    step
}

/// How often the search asks whether to stop, which it does after every few pairs of groups or of features.
fn work(count: usize, scene: Scene) -> f64 {
    let mut asked = 0_u32;
    let mut stop = || {
        asked += 1;
        false
    };
    let step = step(&balls(count, scene, 1));
    let first = step
        .earliest_until(Separation::TOUCHING, 1e-6, &mut stop)
        .unwrap();
    assert!(first.is_proved);
    assert_eq!(first.first.is_none(), !matches!(scene, Scene::Random));
    f64::from(asked)
}

#[test]
fn work_grows_like_n_log_n_with_the_number_of_bodies() {
    assert!(
        work(4_096, Scene::Apart) == 0.0,
        "bodies that are apart have no work"
    );
    for scene in [Scene::Random, Scene::Enclosed] {
        let counts = [125, 1_000, 4_096];
        let works = counts.map(|count| work(count, scene));
        for i in 1..counts.len() {
            let [before, now] = [i - 1, i].map(|i| counts[i] as f64 * (counts[i] as f64).ln());
            assert!(
                works[i] / works[i - 1] < 1.2 * now / before,
                "{scene:?}: {works:?}"
            );
        }
    }
}

#[test]
fn the_first_impact_of_many_bodies_is_the_least_of_all() {
    for seed in 0..12 {
        let count = 2 + 11 * seed as usize;
        let step = step(&balls(count, Scene::Random, seed));
        let mut least = [1.0_f64; 2];
        for kind in [PairKind::VertexTriangle, PairKind::EdgeEdge] {
            for contact in &step.hits(kind, Separation::TOUCHING).unwrap().pairs {
                let impact = step.impact_of(kind, contact, Separation::TOUCHING, 1e-12);
                let time = impact.unwrap().unwrap().time;
                least = [0, 1].map(|end| least[end].min(time[end]));
            }
        }
        let first = step.earliest(Separation::TOUCHING, 1e-9).unwrap();
        assert!(first.is_proved && first.time[1] - first.time[0] <= 1e-9);
        assert!(
            first.time[0] <= least[1] && least[0] <= first.time[1],
            "{count} bodies: {:?} {least:?}",
            first.time
        );
    }
}

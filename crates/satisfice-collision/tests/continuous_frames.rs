//! Whole steps: all pairs, the first impact, free steps, rigid motions.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use satisfice::SatisficingProblem;
use satisfice_collision::continuous::{
    FeatureOf, Moving, MovingContact, MovingPairs, RigidMotion, Separation, Step, decide, impact, rigid_hits,
};
use satisfice_collision::distance::PairKind;
use satisfice_collision::{Error, Mesh, Placement, generate};

const KINDS: [PairKind; 4] = [
    PairKind::VertexVertex,
    PairKind::VertexEdge,
    PairKind::VertexTriangle,
    PairKind::EdgeEdge,
];

fn feature(body: u32, index: usize) -> FeatureOf {
    FeatureOf {
        body,
        index: index as u32,
    }
}

/// Bodies of a step with the frames they go to.
struct Scene {
    bodies: Vec<(Mesh, Vec<[f64; 3]>, bool)>,
}

impl Scene {
    fn step(&self) -> Step {
        let mut step = Step::new();
        for (mesh, to, deforms) in &self.bodies {
            if *deforms {
                step.add_deforming(mesh, to).unwrap();
            } else {
                step.add_rigid(mesh, to).unwrap();
            }
        }
        step
    }

    /// A cloth whose vertices are shaken, and a ball that falls through it.
    fn shaken(seed: u64) -> Self {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut noise = |size: f64| size * ((rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64 - 0.5);
        let cloth = generate::cloth(1.0, 1.0, 6, 6).unwrap();
        let mut shake = |p: [f64; 3]| [p[0] + noise(0.3), p[1] + noise(0.3), p[2] + noise(0.6)];
        let from: Vec<_> = cloth.vertices().iter().map(|&p| shake(p)).collect();
        let to = cloth.vertices().iter().map(|&p| shake(p)).collect();
        let cloth = cloth.with_vertices(from).unwrap();
        let ball = generate::icosphere(0.2, 1).unwrap();
        let ball = Placement::from_translation([0.1, 0.0, 0.6])
            .unwrap()
            .place(&ball)
            .unwrap();
        let below = ball.vertices().iter().map(|&[x, y, z]| [x, y, z - 1.1]).collect();
        Self {
            bodies: vec![(cloth, to, true), (ball, below, false)],
        }
    }

    fn count(&self, body: usize, kind: PairKind, second: bool) -> usize {
        let mesh = &self.bodies[body].0;
        match (kind, second) {
            (PairKind::EdgeEdge, _) | (PairKind::VertexEdge, true) => mesh.edges().len(),
            (PairKind::VertexTriangle, true) => mesh.triangles().len(),
            _ => mesh.vertices().len(),
        }
    }

    fn corners(&self, body: usize, kind: PairKind, second: bool, index: usize) -> Vec<u32> {
        let mesh = &self.bodies[body].0;
        match (kind, second) {
            (PairKind::EdgeEdge, _) | (PairKind::VertexEdge, true) => mesh.edges()[index].to_vec(),
            (PairKind::VertexTriangle, true) => mesh.triangles()[index].to_vec(),
            _ => vec![index as u32],
        }
    }

    fn moving<const N: usize>(&self, body: usize, corners: &[u32]) -> Moving<[[f64; 3]; N]> {
        let (mesh, to, _) = &self.bodies[body];
        let from = std::array::from_fn(|k| mesh.vertices()[corners[k] as usize]);
        Moving::new(from, std::array::from_fn(|k| to[corners[k] as usize]))
    }

    fn vertex(&self, body: usize, corners: &[u32]) -> Moving<[f64; 3]> {
        let moving = self.moving::<1>(body, corners);
        Moving::new(moving.from[0], moving.to[0])
    }

    /// All pairs by asking about every one, with the first time of each.
    fn brute_force(&self, kind: PairKind, separation: Separation) -> Vec<(MovingContact, [f64; 2])> {
        let mut found = Vec::new();
        for a in 0..self.bodies.len() {
            for b in 0..self.bodies.len() {
                for i in 0..self.count(a, kind, false) {
                    for j in 0..self.count(b, kind, true) {
                        let same_list = matches!(kind, PairKind::VertexVertex | PairKind::EdgeEdge);
                        if same_list && (b, j) <= (a, i) || a == b && !self.bodies[a].2 {
                            continue;
                        }
                        let (p, q) = (self.corners(a, kind, false, i), self.corners(b, kind, true, j));
                        let joined = kind == PairKind::VertexVertex
                            && self.bodies[a]
                                .0
                                .edges()
                                .contains(&[p[0].min(q[0]), p[0].max(q[0])]);
                        if a == b && (joined || p.iter().any(|v| q.contains(v))) {
                            continue;
                        }
                        let impact = match kind {
                            PairKind::VertexVertex => {
                                impact(&self.vertex(a, &p), &self.vertex(b, &q), separation, 1e-9)
                            }
                            PairKind::VertexEdge => {
                                impact(&self.vertex(a, &p), &self.moving::<2>(b, &q), separation, 1e-9)
                            }
                            PairKind::VertexTriangle => {
                                impact(&self.vertex(a, &p), &self.moving::<3>(b, &q), separation, 1e-9)
                            }
                            _ => impact(
                                &self.moving::<2>(a, &p),
                                &self.moving::<2>(b, &q),
                                separation,
                                1e-9,
                            ),
                        };
                        if let Some(impact) = impact.unwrap() {
                            let (a, b) = (feature(a as u32, i), feature(b as u32, j));
                            found.push((MovingContact { a, b }, impact.time));
                        }
                    }
                }
            }
        }
        found
    }
}

#[test]
fn all_pairs_are_those_of_asking_about_each() {
    for seed in 0..2 {
        let scene = Scene::shaken(seed);
        let step = scene.step();
        let mut total = 0;
        for kind in KINDS {
            for delta in [0.0, 0.03] {
                let separation = Separation::new(delta).unwrap();
                let mut expected: Vec<_> = scene
                    .brute_force(kind, separation)
                    .into_iter()
                    .map(|(contact, _)| contact)
                    .collect();
                expected.sort_unstable();
                let hits = step.hits(kind, separation).unwrap();
                assert_eq!(hits.pairs, expected, "{kind} {delta}");
                assert_eq!(hits.undecided, 0);
                total += hits.pairs.len();
            }
        }
        assert!(total > 50, "{total}");
    }
}

#[test]
fn the_first_impact_is_the_least_of_all() {
    for seed in 0..4 {
        let scene = Scene::shaken(seed);
        for delta in [0.0, 1e-3] {
            let separation = Separation::new(delta).unwrap();
            let earliest = scene.step().earliest(separation, 1e-6).unwrap();
            let times = [PairKind::VertexTriangle, PairKind::EdgeEdge]
                .into_iter()
                .flat_map(|kind| scene.brute_force(kind, separation))
                .map(|(_, time)| time);
            let least = times.fold([1.0_f64; 2], |least, time| {
                [least[0].min(time[0]), least[1].min(time[1])]
            });
            assert!(earliest.is_proved && earliest.undecided == 0);
            assert!(earliest.time[1] - earliest.time[0] <= 1e-6, "{earliest:?}");
            // The true time lies within both intervals.
            assert!(
                earliest.time[0] <= least[1] && least[0] <= earliest.time[1],
                "{earliest:?} {least:?}"
            );
        }
    }
}

/// A step of a ball above a floor that is hit at 3/4, stopped early.
#[test]
fn a_stopped_search_has_proved_bounds() {
    let floor = generate::cloth(2.0, 2.0, 21, 21).unwrap();
    let ball = generate::icosphere(0.25, 3).unwrap();
    let above = Placement::from_translation([0.0, 0.0, 1.0])
        .unwrap()
        .place(&ball)
        .unwrap();
    let to: Vec<_> = above
        .vertices()
        .iter()
        .map(|&[x, y, z]| [x, y, z - 1.0])
        .collect();
    let mut step = Step::new();
    step.add_rigid(&above, &to).unwrap();
    step.add_rigid(&floor, floor.vertices()).unwrap();
    let mut looks = 0;
    let mut seen_open = false;
    for most in 0..40 {
        looks = 0;
        let mut stop = || {
            looks += 1;
            looks > most
        };
        let found = step
            .earliest_until(Separation::TOUCHING, 1e-9, &mut stop)
            .unwrap();
        assert!(
            found.time[0] <= 0.75 + 1e-9 && found.time[1] >= 0.75 - 1e-9,
            "{found:?}"
        );
        assert_eq!(found.undecided == 0, found.is_proved);
        seen_open |= !found.is_proved;
    }
    assert!(seen_open && looks > 0);
    let whole = step.earliest(Separation::TOUCHING, 1e-9).unwrap();
    assert!(
        whole.is_proved && (whole.time[0] - 0.75).abs() < 1e-8,
        "{whole:?}"
    );
    let free = step.free_step(Separation::TOUCHING).unwrap();
    assert!(0.749_99 < free && free <= 0.75 + 1e-12);
    let stopped = step
        .hits_until(PairKind::EdgeEdge, Separation::TOUCHING, &mut || true)
        .unwrap();
    assert!(stopped.undecided > 0 && stopped.pairs.is_empty());
}

#[test]
fn a_step_without_impact_is_free() {
    let sheet = generate::cloth(1.0, 1.0, 5, 5).unwrap();
    let to: Vec<_> = sheet
        .vertices()
        .iter()
        .map(|&[x, y, z]| [x + 1.0, y, z + 0.5])
        .collect();
    let mut step = Step::new();
    step.add_deforming(&sheet, &to).unwrap();
    assert_eq!(step.free_step(Separation::TOUCHING).unwrap(), 1.0);
    let earliest = step.earliest(Separation::TOUCHING, 1e-6).unwrap();
    assert!(earliest.is_proved && earliest.first.is_none() && earliest.time == [1.0, 1.0]);
    assert!(
        Step::new()
            .earliest(Separation::TOUCHING, 1e-6)
            .unwrap()
            .is_proved
    );
}

#[test]
fn frames_that_do_not_fit_are_refused() {
    let sheet = generate::cloth(1.0, 1.0, 5, 5).unwrap();
    let mut step = Step::new();
    let message = step
        .add_deforming(&sheet, &sheet.vertices()[1..])
        .unwrap_err()
        .to_string();
    assert!(message.contains("topology"), "{message}");
    let mut bad = sheet.vertices().to_vec();
    bad[7][1] = f64::NAN;
    assert!(matches!(
        step.add_deforming(&sheet, &bad),
        Err(Error::NonFiniteVertex {
            vertex: 7,
            axis: 'y',
            ..
        })
    ));
    assert_eq!(step.bodies(), 0);
    step.add_deforming(&sheet, sheet.vertices()).unwrap();
    assert!(
        step.hits(PairKind::TriangleTriangle, Separation::TOUCHING)
            .is_err()
    );
    assert!(step.earliest(Separation::TOUCHING, f64::NAN).is_err());
}

/// Vertices of one place in another: all of them pairs at once, and a tree that can not tell them apart.
#[test]
fn identical_vertices_are_all_pairs() {
    let many = Mesh::new(vec![[0.25; 3]; 100_000], vec![], vec![]).unwrap();
    let one = Mesh::new(vec![[0.25, 0.25, 1.0]], vec![], vec![]).unwrap();
    let mut step = Step::new();
    step.add_rigid(&many, many.vertices()).unwrap();
    step.add_rigid(&one, &[[0.25, 0.25, 0.0]]).unwrap();
    let hits = step.hits(PairKind::VertexVertex, Separation::TOUCHING).unwrap();
    assert_eq!(hits.pairs.len(), 100_000);
    let first = step.earliest(Separation::TOUCHING, 1e-9).unwrap();
    assert!(first.is_proved && first.time[0] <= 0.75 && 0.75 <= first.time[1]);
}

#[test]
fn the_threads_do_not_change_the_answer() {
    let scene = Scene::shaken(9);
    let ask = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            scene
                .step()
                .hits(PairKind::EdgeEdge, Separation::TOUCHING)
                .unwrap()
        })
    };
    assert_eq!(ask(1), ask(3));
}

/// A bar that turns by half a turn sweeps over a peg which straight paths of its ends would miss.
#[test]
fn rotation_is_followed() {
    let bar = Mesh::new(vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], vec![[0, 1]], vec![]).unwrap();
    let peg = Mesh::new(vec![[0.0, 0.9, -1.0], [0.0, 0.9, 1.0]], vec![[0, 1]], vec![]).unwrap();
    let turn = RigidMotion {
        angle: std::f64::consts::PI,
        ..RigidMotion::REST
    };
    let delta = Separation::new(0.01).unwrap();
    let hits = |peg: &Mesh, tolerance: f64| {
        rigid_hits(
            &[(&bar, turn), (peg, RigidMotion::REST)],
            PairKind::EdgeEdge,
            delta,
            tolerance,
        )
        .unwrap()
    };
    let found = hits(&peg, 1e-3);
    assert_eq!((found.certain.len(), found.possible.len()), (1, 0), "{found:?}");
    assert!(found.pieces > 10);
    // Linear motion alone contracts the bar to its middle and passes the peg by.
    let ends = bar
        .vertices()
        .iter()
        .map(|&[x, y, z]| [-x, -y, z])
        .collect::<Vec<_>>();
    let straight = Moving::new([bar.vertices()[0], bar.vertices()[1]], [ends[0], ends[1]]);
    let still = Moving::at_rest([peg.vertices()[0], peg.vertices()[1]]);
    assert!(!decide(&straight, &still, delta).within);
    // A peg just out of reach is possible with coarse pieces and excluded with fine ones.
    let outside = Mesh::new(
        vec![[0.0, 1.0101, -1.0], [0.0, 1.0101, 1.0]],
        vec![[0, 1]],
        vec![],
    )
    .unwrap();
    assert!(hits(&outside, 0.05).certain.is_empty());
    assert_eq!(
        hits(&outside, 1e-5).possible.len() + hits(&outside, 1e-5).certain.len(),
        0
    );
    assert!(rigid_hits(&[(&bar, turn)], PairKind::EdgeEdge, delta, 0.0).is_err());
    // A touch is never certain: the places of vertices are rounded.
    let falls = RigidMotion {
        translation: [0.0, 2.0, 0.0],
        ..RigidMotion::REST
    };
    let bodies = [(&bar, falls), (&peg, RigidMotion::REST)];
    let touch = rigid_hits(&bodies, PairKind::EdgeEdge, Separation::TOUCHING, 1e-3).unwrap();
    assert_eq!((touch.certain.len(), touch.possible.len()), (0, 1), "{touch:?}");
    let bad = RigidMotion {
        axis: [0.0; 3],
        ..turn
    };
    assert!(rigid_hits(&[(&bar, bad)], PairKind::EdgeEdge, delta, 0.1).is_err());
}

/// Each pair of one list has two places in the space and counts once; all bounds hold.
#[test]
fn the_candidates_of_a_step_are_a_problem() {
    let scene = Scene::shaken(3);
    let step = scene.step();
    for kind in KINDS {
        for delta in [0.0, 0.03] {
            let separation = Separation::new(delta).unwrap();
            let problem = MovingPairs::new(&step, kind, separation).unwrap();
            assert_eq!(satisfice::testing::problem::check(&problem, 1), [], "{kind}");
            let [m, n] = problem.positions();
            let mut found = BTreeSet::new();
            for i in 0..m {
                for j in 0..n {
                    let pair = problem.decode(&[f64::from(i), f64::from(j)]);
                    if problem.fitness(&pair) < problem.threshold() {
                        found.insert(pair);
                    }
                }
            }
            let hits = step.hits(kind, separation).unwrap();
            assert_eq!(found.into_iter().collect::<Vec<_>>(), hits.pairs);
        }
    }
}

#[test]
fn a_free_step_is_above_zero_whenever_the_start_is_free() {
    let floor = Mesh::new(
        vec![[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]],
        vec![],
        vec![[0, 1, 2]],
    )
    .unwrap();
    for exponent in [-20, -41, -60, -200, -900] {
        let height = 2.0_f64.powi(exponent);
        let point = Mesh::new(vec![[1.0, 1.0, height]], vec![], vec![]).unwrap();
        let mut step = Step::new();
        step.add_rigid(&point, &[[1.0, 1.0, height - 1.0]]).unwrap();
        step.add_rigid(&floor, floor.vertices()).unwrap();
        let free = step.free_step(Separation::TOUCHING).unwrap();
        // It touches at the time `height`, or just after for heights lost in `height - 1`.
        assert!(
            0.0 < free && free <= height * (1.0 + 1e-12),
            "2^{exponent}: {free}"
        );
        let first = step.earliest(Separation::TOUCHING, 1e-6).unwrap();
        assert!(first.time[1] >= height && !first.first.unwrap().2.at_start);
    }
    // Exactly delta apart at the start is free, but nothing after it is.
    let point = Mesh::new(vec![[1.0, 1.0, 1.0]], vec![], vec![]).unwrap();
    let mut step = Step::new();
    step.add_rigid(&point, &[[1.0, 1.0, 0.0]]).unwrap();
    step.add_rigid(&floor, floor.vertices()).unwrap();
    let first = step.earliest(Separation::new(1.0).unwrap(), 1e-6).unwrap();
    assert!(first.time[0] == 0.0 && first.time[1] < 1e-6 && !first.first.unwrap().2.at_start);
}

#[test]
fn a_hundred_thousand_identical_vertices() {
    let count = 100_000;
    let points = Mesh::new(vec![[1.0, 1.0, 1.0]; count], vec![], vec![]).unwrap();
    let floor = Mesh::new(
        vec![[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]],
        vec![],
        vec![[0, 1, 2]],
    )
    .unwrap();
    let mut falling = Step::new();
    falling
        .add_rigid(&points, &vec![[1.0, 1.0, -1.0]; count])
        .unwrap();
    falling.add_rigid(&floor, floor.vertices()).unwrap();
    let hits = falling
        .hits(PairKind::VertexTriangle, Separation::TOUCHING)
        .unwrap();
    assert_eq!(hits.pairs.len(), count);
    let first = falling.earliest(Separation::TOUCHING, 1e-6).unwrap();
    assert!(first.is_proved && first.time[0] <= 0.5 && 0.5 <= first.time[1]);
    // A step without motion, of a body with itself: they touch at the start.
    let mut resting = Step::new();
    resting.add_deforming(&points, points.vertices()).unwrap();
    let first = resting.earliest(Separation::TOUCHING, 1e-6).unwrap();
    assert!(first.is_proved && first.time == [0.0, 0.0] && first.first.unwrap().2.at_start);
}

#[test]
fn any_number_of_threads_delivers_the_same_pairs_in_the_same_order() {
    let ball = generate::icosphere(0.5, 3).unwrap();
    let to: Vec<_> = ball.vertices().iter().map(|&[x, y, z]| [x, y, z + 0.4]).collect();
    let mut step = Step::new();
    step.add_rigid(&ball, &to).unwrap();
    step.add_rigid(&ball, ball.vertices()).unwrap();
    let visited = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let mut pairs = Vec::new();
            let counts = step.each_hit(
                PairKind::EdgeEdge,
                Separation::TOUCHING,
                &mut || false,
                &mut |pair| pairs.push(pair),
            );
            (pairs, counts.unwrap())
        })
    };
    let one = visited(1);
    assert!(!one.0.is_empty() && one.1.undecided == 0);
    assert_eq!(one, visited(2));
    assert_eq!(one, visited(5));
}

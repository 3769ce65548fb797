//! A few things far away from all others change neither the answers about the others nor the work for them.
#![allow(clippy::unwrap_used)]

use rand::{RngExt as _, SeedableRng as _};
use rand_xoshiro::Xoshiro256PlusPlus;
use satisfice_collision::broad::{FeatureTree, Method, PointGrid, TreeJoin, TreeWork, closest_pairs};
use satisfice_collision::distance::{PairKind, Threshold};
use satisfice_collision::scene::{Body, Contact, SharedMesh, World};
use satisfice_collision::{FeatureKind, Mesh, Placement};

type Point = [f64; 3];

const HERE: Placement = Placement::IDENTITY;

/// Small triangles in a cube, and one at each of these places.
fn soup(n: u32, size: f64, seed: u64, strays: &[Point]) -> Mesh {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for t in 0..n + strays.len() as u32 {
        let at = strays.get(t.wrapping_sub(n) as usize).copied();
        let at = at.unwrap_or_else(|| std::array::from_fn(|_| rng.random()));
        for _ in 0..3 {
            vertices.push(at.map(|c| c + size * rng.random::<f64>()));
        }
        triangles.push([3 * t, 3 * t + 1, 3 * t + 2]);
    }
    Mesh::new(vertices, vec![], triangles).unwrap()
}

fn contacts(kind: PairKind, method: Method, delta: f64, meshes: [&Mesh; 2], at: Placement) -> Vec<Contact> {
    let mut world = World::new(kind, Threshold::new(delta).unwrap()).with_method(method);
    world.add(Body::rigid(meshes[0].clone()).at(at)).unwrap();
    world.add(Body::rigid(meshes[1].clone())).unwrap();
    world.frame().unwrap().contacts
}

fn places() -> Vec<Point> {
    let mut places = vec![[1e15, -1e4, 1e12]];
    for far in [1e4, 1e7, 1e9, 1e29, 1e31, 1e100, 1e300] {
        places.extend([[far, 0.0, 0.0], [0.1, -far, far]]);
    }
    places
}

#[test]
fn trees_with_strays_agree_with_brute_force() {
    let turned = Placement::from_axis_angle([1.0, 2.0, 3.0], 0.7).unwrap();
    let poses = [HERE, HERE.moved([0.1, 0.2, 0.0]).unwrap(), turned];
    let (mut touching, mut touching_strays) = (0, 0);
    for kind in [
        PairKind::TriangleTriangle,
        PairKind::EdgeEdge,
        PairKind::VertexVertex,
        PairKind::VertexTriangle,
    ] {
        for (number, &place) in places().iter().enumerate() {
            let one = soup(60, 0.1, number as u64, &[place]);
            let other = [vec![], vec![place], vec![place.map(|c| -c), place]];
            let two = soup(60, 0.1, 77, &other[number % 3]);
            let pose = poses[number / 2 % 3];
            let [brute, tree] = [Method::BruteForce, Method::Tree]
                .map(|method| contacts(kind, method, 0.03, [&one, &two], pose));
            assert_eq!(tree, brute, "{kind:?}, {place:?}, {number}");
            touching += brute.len();
            let first = if kind == PairKind::TriangleTriangle {
                60
            } else {
                180
            };
            touching_strays += brute.iter().filter(|contact| contact.a >= first).count();
        }
    }
    assert!(
        touching > 0 && touching_strays > 0,
        "{touching}, {touching_strays}"
    );
}

fn work(meshes: [&Mesh; 2], kind: FeatureKind, delta: f64) -> (usize, TreeWork) {
    let trees = meshes.map(|mesh| FeatureTree::new(mesh, kind));
    let threshold = Threshold::new(delta).unwrap();
    let mut join = TreeJoin::new();
    let between = join
        .between((&trees[0], &HERE), (&trees[1], &HERE), threshold, None)
        .unwrap()
        .len();
    let work = join.work();
    let within = join.within(&trees[0], threshold, None).len();
    let more = join.work();
    let both = TreeWork {
        visits: work.visits + more.visits,
        candidates: work.candidates + more.candidates,
        decisions: work.decisions + more.decisions,
        neighbours: 0,
    };
    (between + within, both)
}

#[test]
fn a_stray_feature_does_not_multiply_the_work() {
    let n = 4000;
    for kind in [FeatureKind::Triangle, FeatureKind::Edge, FeatureKind::Vertex] {
        let two = soup(n, 0.01, 2, &[]);
        let (_, usual) = work([&soup(n, 0.01, 1, &[]), &two], kind, 1e-4);
        for place in places() {
            let one = soup(n, 0.01, 1, &[place]);
            let (_, with) = work([&one, &two], kind, 1e-4);
            // at most each with the stray
            let linear = 16 * u64::from(n) * 3;
            assert!(
                with.visits < 2 * usual.visits + linear,
                "{kind:?}, {place:?}: {with:?}, {usual:?}"
            );
            assert!(
                with.candidates < 2 * usual.candidates + linear,
                "{kind:?}, {place:?}: {with:?}, {usual:?}"
            );
        }
    }
}

#[test]
fn the_closest_pairs_are_not_those_of_the_stray() {
    let turned = Placement::from_axis_angle([1.0, 2.0, 3.0], 0.7).unwrap();
    let away = turned.moved([3.0, 0.0, 0.0]).unwrap();
    let two = soup(200, 0.1, 2, &[]);
    for kind in [FeatureKind::Triangle, FeatureKind::Vertex] {
        let find = |strays: &[Point]| {
            let trees = [&soup(200, 0.1, 1, strays), &two].map(|mesh| FeatureTree::new(mesh, kind));
            closest_pairs((&trees[0], &HERE), (&trees[1], &away), 20, None).unwrap()
        };
        let usual = find(&[]);
        for place in places() {
            assert_eq!(find(&[place]), usual, "{kind:?}, {place:?}");
        }
    }
}

#[test]
fn points_on_all_scales() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(3);
    let points: Vec<Point> = (0..6000)
        .map(|_| {
            let scale = 10.0_f64.powf(24.0 * rng.random::<f64>() - 12.0);
            std::array::from_fn(|_| scale * (2.0 * rng.random::<f64>() - 1.0))
        })
        .collect();
    let threshold = Threshold::new(1e-12).unwrap();
    let mesh = Mesh::new(points.clone(), vec![], vec![]).unwrap();
    let mut join = TreeJoin::new();
    let tree = FeatureTree::new(&mesh, FeatureKind::Vertex);
    let found = join.within(&tree, threshold, None).to_vec();
    assert_eq!(found, PointGrid::new().within(&points, threshold).unwrap());
    let near = |p: &Point, q: &Point| (0..3).map(|k| (p[k] - q[k]) * (p[k] - q[k])).sum::<f64>() < 1e-24;
    let brute = (0..points.len()).map(|i| {
        (i + 1..points.len())
            .filter(|&j| near(&points[i], &points[j]))
            .count()
    });
    assert_eq!(found.len(), brute.sum::<usize>());
    let work = join.work();
    assert!(work.candidates < 20 * found.len() as u64 + 60_000, "{work:?}");
    assert!(work.visits < 60_000, "{work:?}");
}

/// A world of small bodies and one at a place, if there is any: contacts in all frames, and pairs kept.
fn world(far: Option<Point>) -> (Vec<Vec<Contact>>, usize) {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(5);
    let corners = vec![[0.0; 3], [0.3, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 0.3]];
    let faces = vec![[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];
    let mesh = SharedMesh::from(Mesh::new(corners, vec![], faces).unwrap());
    let mut world = World::new(PairKind::TriangleTriangle, Threshold::new(1e-3).unwrap());
    let mut places: Vec<Point> = (0..1000)
        .map(|_| std::array::from_fn(|_| 10.0 * rng.random::<f64>()))
        .collect();
    let at = |place: &Point| Placement::from_translation(*place).unwrap();
    let mut bodies = Vec::new();
    for place in &places {
        bodies.push(world.add(Body::rigid(mesh.clone()).at(at(place))).unwrap());
    }
    if let Some(far) = far {
        world.add(Body::rigid(mesh).at(at(&far))).unwrap();
    }
    let (mut all, mut most) = (Vec::new(), 0);
    for _ in 0..20 {
        all.push(world.frame().unwrap().contacts);
        most = most.max(world.kept_pairs());
        for (&body, place) in bodies.iter().zip(&mut places) {
            for c in &mut *place {
                *c += 0.1 * (rng.random::<f64>() - 0.5);
            }
            world.translate(body, *place).unwrap();
        }
    }
    (all, most)
}

#[test]
fn a_far_body_changes_nothing_for_the_others() {
    let (usual, kept) = world(None);
    for place in places() {
        let (with, kept_with) = world(Some(place));
        assert_eq!(with, usual, "{place:?}");
        assert!(
            kept_with <= kept + kept / 2,
            "{place:?}: {kept_with} instead of {kept}"
        );
    }
}

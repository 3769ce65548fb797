//! Queries on worlds against brute force over all features of all bodies, also after bodies were removed.

use rand::{RngExt as _, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::referee::KINDS;
use crate::distance::{self, PairKind, Threshold};
use crate::scene::{Body, BodyId, Contact, SharedMesh, World};
use crate::{Aabb, Error, Mesh, Placement, Shape, generate};

/// A world of turned bodies of several sizes, a sheet that collides with itself, and the posed meshes by handle.
struct Stage {
    world: World,
    posed: Vec<(BodyId, Mesh)>,
    sheet: BodyId,
    gone: Vec<BodyId>,
}

fn scaled(mesh: &Mesh, factor: f64) -> Mesh {
    let vertices = mesh.vertices().iter().map(|p| p.map(|c| factor * c));
    mesh.with_vertices(vertices.collect()).unwrap()
}

fn stage(kind: PairKind, seed: u64) -> Stage {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut number = || 2.0 * rng.random::<f64>() - 1.0;
    let mut world = World::new(kind, Threshold::new(0.3).unwrap());
    let ball = generate::icosphere(0.3, 0).unwrap();
    let shapes = [
        ball.clone(),
        scaled(&ball, 0.01),
        generate::torus(0.4, 0.1, 5, 3).unwrap(),
    ];
    let shared = shapes.clone().map(SharedMesh::from);
    let (mut posed, mut gone) = (Vec::new(), Vec::new());
    for n in 0..14 {
        let turned = Placement::from_axis_angle([number(), 1.0, number()], 3.0 * number()).unwrap();
        let to = turned
            .moved([3.0 * number(), 3.0 * number(), 3.0 * number()])
            .unwrap();
        let id = world.add(Body::rigid(shared[n % 3].clone())).unwrap();
        world.place(id, to).unwrap();
        posed.push((id, to.place(&shapes[n % 3]).unwrap()));
    }
    let sheet = generate::cloth(1.0, 1.0, 4, 4).unwrap();
    let folded: Vec<_> = sheet
        .vertices()
        .iter()
        .map(|&[x, y, z]| [x.abs(), y, z + 0.2 * x + 0.05 * y])
        .collect();
    let id = world.add(Body::deforming(sheet.clone())).unwrap();
    world.update().unwrap();
    world.deform(id, &folded).unwrap();
    posed.push((id, sheet.with_vertices(folded).unwrap()));
    for n in [9, 4, 0] {
        let (id, _) = posed.remove(n);
        world.remove(id).unwrap();
        gone.push(id);
    }
    Stage {
        world,
        posed,
        sheet: id,
        gone,
    }
}

impl Stage {
    /// Every pair of features that counts, with its distance, sorted; of bodies with themselves too, if `own`.
    fn pairs(&self, own: bool) -> Vec<(f64, Contact)> {
        let (kind_a, kind_b) = self.world.feature_kinds();
        let mut all = Vec::new();
        for (body_a, one) in &self.posed {
            for (body_b, two) in &self.posed {
                let is_own = body_a == body_b;
                if (kind_a == kind_b && body_a > body_b) || (is_own && !(own && *body_a == self.sheet)) {
                    continue;
                }
                let (of_a, of_b) = (one.features(kind_a), two.features(kind_b));
                for a in 0..of_a.len() as u32 {
                    for b in 0..of_b.len() as u32 {
                        let meet = of_a.corners(a).iter().any(|v| of_b.corners(b).contains(v));
                        if is_own && (meet || (kind_a == kind_b && a >= b)) {
                            continue;
                        }
                        let (p, q) = (of_a.shape(a, |v| one.vertex(v)), of_b.shape(b, |v| two.vertex(v)));
                        let contact = Contact {
                            body_a: *body_a,
                            body_b: *body_b,
                            a,
                            b,
                        };
                        all.push((distance::proximity(&p, &q).distance, contact));
                    }
                }
            }
        }
        all.sort_by(|(d, a), (e, b)| d.total_cmp(e).then(a.cmp(b)));
        all
    }
}

#[test]
fn the_closest_pairs_at_any_distance() {
    for (at, kind) in KINDS.into_iter().enumerate() {
        let mut stage = stage(kind, at as u64);
        let all = stage.pairs(true);
        for k in [0, 1, 5, 400] {
            let found = stage.world.nearest(k).unwrap();
            let found: Vec<_> = found.iter().map(|(contact, p)| (p.distance, *contact)).collect();
            assert_eq!(found, all[..k], "{kind} {k}");
        }
        // below the threshold: among the contacts
        let threshold = stage.world.threshold();
        let contacts = stage.world.frame().unwrap().contacts.len();
        assert!(contacts > 0 && contacts < all.len());
        let found = stage.world.closest(contacts + 10).unwrap();
        assert_eq!(found.len(), contacts);
        let found: Vec<_> = found.iter().map(|(contact, p)| (p.distance, *contact)).collect();
        assert_eq!(found, all[..contacts], "{kind} {threshold:?}");
    }
}

#[test]
fn distances_of_bodies() {
    for (at, kind) in KINDS.into_iter().enumerate() {
        let mut stage = stage(kind, 10 + at as u64);
        let all = stage.pairs(false);
        let (contact, proximity) = stage.world.closest_bodies().unwrap().unwrap();
        assert_eq!(proximity.distance, all[0].0, "{kind}");
        assert_ne!(contact.body_a, contact.body_b);
        let ids: Vec<BodyId> = stage.posed.iter().map(|(id, _)| *id).collect();
        // a pair that may not collide has a distance
        stage.world.exclude(ids[0], ids[1]).unwrap();
        for (n, &a) in ids.iter().enumerate() {
            for &b in &ids[n + 1..] {
                let least = all.iter().find(|(_, c)| c.bodies() == (a, b)).unwrap();
                for (one, two) in [(a, b), (b, a)] {
                    let (contact, proximity) = stage.world.distance(one, two).unwrap().unwrap();
                    assert_eq!(
                        (proximity.distance, contact.bodies()),
                        (least.0, (a, b)),
                        "{kind}"
                    );
                    assert_eq!(stage.world.proximity(contact).unwrap(), proximity);
                }
            }
        }
        let is_refused = |answer: Result<_, Error>| matches!(answer, Err(Error::Parameter { .. }));
        for &gone in &stage.gone {
            assert!(is_refused(stage.world.distance(ids[0], gone).map(|_| ())));
            assert!(is_refused(
                stage.world.distance_to_point(gone, [0.0; 3]).map(|_| ())
            ));
        }
        assert!(is_refused(stage.world.distance(ids[0], ids[0]).map(|_| ())));
    }
}

#[test]
fn the_feature_closest_to_a_point() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(8);
    for kind in KINDS {
        let mut stage = stage(kind, 20);
        let (_, kind_b) = kind.features();
        for round in 0..12 {
            let wide = [2.0, 8.0, 1e6][round % 3];
            let point = [(); 3].map(|()| wide * (rng.random::<f64>() - 0.5));
            let mut least = f64::INFINITY;
            for (id, mesh) in &stage.posed {
                let features = mesh.features(kind_b);
                let of = |n: u32| {
                    let shape = features.shape(n, |v| mesh.vertex(v));
                    distance::proximity(&Shape::Vertex(point), &shape).distance
                };
                let nearest = (0..features.len() as u32).map(of).fold(f64::INFINITY, f64::min);
                let found = stage.world.distance_to_point(*id, point).unwrap().unwrap();
                assert_eq!((found.body, found.kind), (*id, kind_b));
                assert_eq!((found.proximity.distance, of(found.feature)), (nearest, nearest));
                least = least.min(nearest);
            }
            let found = stage.world.nearest_to_point(point).unwrap().unwrap();
            assert_eq!(found.proximity.distance, least);
        }
        assert!(stage.world.nearest_to_point([0.0, f64::NAN, 0.0]).is_err());
    }
}

#[test]
fn bodies_in_a_box() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(9);
    let mut stage = stage(PairKind::TriangleTriangle, 30);
    let mut counts = [0; 3];
    for _ in 0..60 {
        let mut corner = || [(); 3].map(|()| 8.0 * (rng.random::<f64>() - 0.5));
        let mut region = Aabb::point(corner());
        region.include(corner());
        let found = stage.world.bodies_in(&region).unwrap();
        let meets = |id: &BodyId| {
            let b = stage.world.bounds(*id).unwrap();
            (0..3).all(|k| b.min[k] <= region.max[k] && region.min[k] <= b.max[k])
        };
        let expected: Vec<BodyId> = stage.world.bodies().filter(meets).collect();
        assert_eq!(found, expected);
        counts[usize::from(!found.is_empty()) + usize::from(found.len() > 4)] += 1;
    }
    assert!(counts.iter().all(|&count| count > 3), "{counts:?}");
    let all = Aabb {
        min: [f64::NEG_INFINITY; 3],
        max: [f64::INFINITY; 3],
    };
    assert_eq!(stage.world.bodies_in(&all).unwrap().len(), stage.posed.len());
    for (low, high) in [(1.0, 0.0), (f64::NAN, 1.0)] {
        let region = Aabb {
            min: [0.0, low, 0.0],
            max: [1.0, high, 1.0],
        };
        assert!(stage.world.bodies_in(&region).is_err());
    }
}

#[test]
fn worlds_of_no_and_of_one_body() {
    let mut world = World::new(PairKind::TriangleTriangle, Threshold::new(0.1).unwrap());
    let all = Aabb {
        min: [-9.0; 3],
        max: [9.0; 3],
    };
    for bodies in 0..2 {
        assert!(world.nearest(3).unwrap().is_empty() && world.closest(3).unwrap().is_empty());
        assert!(world.closest_bodies().unwrap().is_none());
        assert_eq!(world.bodies_in(&all).unwrap().len(), bodies);
        let nearest = world.nearest_to_point([3.0, 0.0, 0.0]).unwrap();
        assert_eq!(nearest.is_some(), bodies == 1);
        world
            .add(Body::rigid(generate::icosphere(0.5, 0).unwrap()))
            .unwrap();
    }
}

#[test]
fn features_that_do_not_count_have_no_distance() {
    let mut world = World::new(PairKind::TriangleTriangle, Threshold::new(0.1).unwrap());
    let ball = generate::icosphere(0.5, 0).unwrap();
    let upper = |v: u32| ball.vertex(v)[2] > 0.0;
    let a = world.add(Body::rigid(ball.clone()).with_vertices(upper)).unwrap();
    let b = world
        .add(Body::rigid(ball.clone()).with_vertices(|_| false))
        .unwrap();
    let c = world.add(Body::rigid(ball.clone())).unwrap();
    world
        .place(c, Placement::from_translation([0.0, 0.0, -3.0]).unwrap())
        .unwrap();
    assert!(world.distance(a, b).unwrap().is_none());
    assert!(world.distance_to_point(b, [0.0; 3]).unwrap().is_none());
    let (_, proximity) = world.distance(a, c).unwrap().unwrap();
    assert!(proximity.distance > 2.0 && proximity.distance < 3.0);
    let (_, proximity) = world.nearest(1).unwrap()[0];
    assert!(proximity.distance > 2.0);
}

/// A search that is stopped says so and has found only what there is.
#[test]
fn a_stopped_search_for_the_closest() {
    let mut stage = stage(PairKind::TriangleTriangle, 40);
    let all = stage.pairs(true);
    let asked = std::sync::atomic::AtomicUsize::new(0);
    let stop = |_: usize| asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed) >= 3;
    let (found, completeness) = stage.world.nearest_until(100_000, &stop).unwrap();
    assert_eq!(completeness, crate::scene::Completeness::Unknown);
    assert!(!found.is_empty() && found.len() < all.len());
    for (contact, proximity) in found {
        assert!(all.contains(&(proximity.distance, contact)));
    }
    let (found, completeness) = stage.world.nearest_until(10, &|_| false).unwrap();
    assert_eq!(
        (found.len(), completeness),
        (10, crate::scene::Completeness::Proved)
    );
}

/// The first hit by trying every triangle with fractions that never round.
fn first_by_trying(posed: &[(BodyId, Mesh)], from: [f64; 3], to: [f64; 3]) -> Option<(BodyId, u32)> {
    let mut best: Option<(BodyId, u32, f64)> = None;
    for (id, mesh) in posed {
        for t in 0..mesh.triangles().len() {
            let triangle = mesh.triangle(t);
            if distance::edge_triangle::proximity(&[from, to], &triangle).distance != 0.0 {
                continue;
            }
            // far from parallel rays only: the crossing with the plane
            let minus = |p: [f64; 3], q: [f64; 3]| [0, 1, 2].map(|k| p[k] - q[k]);
            let ([a, b, c], way) = (triangle, minus(to, from));
            let (x, y) = (minus(b, a), minus(c, a));
            let normal = [0, 1, 2].map(|k| x[(k + 1) % 3] * y[(k + 2) % 3] - x[(k + 2) % 3] * y[(k + 1) % 3]);
            let dot = |p: [f64; 3]| (0..3).map(|k| normal[k] * p[k]).sum::<f64>();
            let part = dot(minus(a, from)) / dot(way);
            if best.is_none_or(|(.., least)| part < least - 1e-9) {
                best = Some((*id, t as u32, part));
            }
        }
    }
    best.map(|(id, t, _)| (id, t))
}

#[test]
fn rays_meet_what_brute_force_finds_first() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(12);
    let mut counts = [0; 2];
    for seed in 0..4 {
        let mut stage = stage(PairKind::VertexVertex, 50 + seed);
        for round in 0..60 {
            let mut point = |size: f64| [(); 3].map(|()| size * (rng.random::<f64>() - 0.5));
            let (from, mut through) = (point(9.0), point(6.0));
            if round % 3 > 0 {
                let (_, mesh) = &stage.posed[round % stage.posed.len()];
                through = Shape::Triangle(mesh.triangle(round % 7)).middle();
            }
            let to = [0, 1, 2].map(|k| from[k] + 1.7 * (through[k] - from[k]));
            let hit = stage.world.cast_ray(from, to).unwrap();
            let expected = first_by_trying(&stage.posed, from, to);
            assert_eq!(
                hit.map(|hit| (hit.body, hit.triangle)),
                expected,
                "{from:?} {to:?}"
            );
            counts[usize::from(hit.is_some())] += 1;
            if let Some(hit) = hit {
                assert!(hit.part >= 0.0 && hit.part <= 1.0);
                let nearest = stage.world.distance_to_point(hit.body, hit.point).unwrap();
                assert!(nearest.is_some());
                // others only: not this one
                let other = stage
                    .world
                    .cast_ray_where(from, to, |body| body != hit.body)
                    .unwrap();
                assert!(other.is_none_or(|other| other.body != hit.body && other.part >= hit.part));
            }
        }
    }
    assert!(counts.iter().all(|&count| count > 20), "{counts:?}");
}

/// No ray from the inside gets out, however exactly it is aimed at an edge or a vertex, wherever the body is.
#[test]
fn closed_bodies_are_watertight() {
    let ball = generate::icosphere(1.0, 2).unwrap();
    for (scale, at) in [
        (1.0, [0.0; 3]),
        (1e-3, [700.0, -3.0, 0.1]),
        (1e8, [1.0, 2e8, 3.0]),
    ] {
        let mesh = scaled(&ball, scale);
        let mut world = World::new(PairKind::TriangleTriangle, Threshold::new(0.1).unwrap());
        let id = world.add(Body::rigid(mesh.clone())).unwrap();
        let turned = Placement::from_axis_angle([0.3, 1.0, 0.2], 0.4)
            .unwrap()
            .moved(at)
            .unwrap();
        world.place(id, turned).unwrap();
        let posed = turned.place(&mesh).unwrap();
        let aims = posed.edges().iter().map(|&[a, b]| {
            let (p, q) = (posed.vertex(a), posed.vertex(b));
            [0, 1, 2].map(|k| p[k] / 2.0 + q[k] / 2.0)
        });
        for aim in aims.chain(posed.vertices().iter().copied()) {
            let beyond = [0, 1, 2].map(|k| at[k] + 3.0 * (aim[k] - at[k]));
            let hit = world.cast_ray(at, beyond).unwrap().unwrap();
            assert!((hit.part - 1.0 / 3.0).abs() < 0.02, "{hit:?}");
            assert!(
                world
                    .cast_ray(at, [0, 1, 2].map(|k| at[k] + 0.9 * (aim[k] - at[k])))
                    .unwrap()
                    .is_none()
            );
        }
        // exactly through a vertex, from a point whose coordinates need not be rounded: one of its triangles, the first one
        let vertex = posed.vertex(7);
        let hit = world.cast_ray(vertex, vertex).unwrap().unwrap();
        let around = (0..)
            .zip(posed.triangles())
            .find(|(_, corners)| corners.contains(&7));
        assert_eq!(
            (hit.triangle, hit.part, hit.point),
            (around.unwrap().0, 0.0, vertex)
        );
    }
    let mut world = World::new(PairKind::TriangleTriangle, Threshold::new(0.1).unwrap());
    assert!(world.cast_ray([0.0; 3], [1.0; 3]).unwrap().is_none());
    assert!(world.cast_ray([0.0; 3], [1.0, f64::INFINITY, 0.0]).is_err());
}

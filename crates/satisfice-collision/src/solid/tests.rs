//! Against solid angles, boxes whose depth is known, and all directions that can be the shallowest.
#![allow(clippy::unwrap_used)]

use std::sync::atomic::{AtomicUsize, Ordering};

use rand::{RngExt as _, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::hull::{dot, sub};
use super::*;
use crate::generate;

fn number(rng: &mut Xoshiro256PlusPlus) -> f64 {
    rng.random::<f64>() - 0.5
}

fn point(rng: &mut Xoshiro256PlusPlus, size: f64) -> Point {
    [0; 3].map(|_| size * number(rng))
}

fn moved(mesh: &Mesh, by: Point) -> Mesh {
    Placement::from_translation(by).unwrap().place(mesh).unwrap()
}

fn turned(mesh: &Mesh, rng: &mut Xoshiro256PlusPlus) -> Mesh {
    let axis = point(rng, 1.0);
    let pose = Placement::from_axis_angle(axis, 6.0 * number(rng)).unwrap();
    pose.place(mesh).unwrap()
}

fn solid(mesh: &Mesh) -> Solid {
    Solid::new(mesh).unwrap()
}

fn overlap_of(a: &Mesh, b: &Mesh) -> Option<Overlap> {
    let (overlap, completeness) = overlap(&solid(a), &solid(b), &|| false);
    assert_eq!(completeness, Completeness::Proved);
    overlap
}

/// A box of these sides around the origin, each side of so many squares.
fn block(sides: Point, squares: u32) -> Mesh {
    let n = squares + 1;
    let at = |x: u32, y: u32, z: u32| {
        let part = |k: usize, i: u32| sides[k] * (f64::from(i) / f64::from(squares) - 0.5);
        [part(0, x), part(1, y), part(2, z)]
    };
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for axis in 0..3 {
        for end in [0, squares] {
            let first = vertices.len() as u32;
            for i in 0..n {
                for j in 0..n {
                    let mut place = [end; 3];
                    (place[(axis + 1) % 3], place[(axis + 2) % 3]) = (i, j);
                    vertices.push(at(place[0], place[1], place[2]));
                }
            }
            for i in 0..squares {
                for j in 0..squares {
                    let [a, b, c, d] =
                        [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| first + n * i + j);
                    let (one, two) = if end > 0 {
                        ([a, b, c], [a, c, d])
                    } else {
                        ([a, c, b], [a, d, c])
                    };
                    triangles.extend([one, two]);
                }
            }
        }
    }
    Mesh::new(vertices, Vec::new(), triangles).unwrap()
}

fn both(a: &Mesh, b: &Mesh) -> Mesh {
    let shift = a.vertices().len() as u32;
    let vertices = [a.vertices(), b.vertices()].concat();
    let others = b.triangles().iter().map(|t| t.map(|v| v + shift));
    Mesh::new(
        vertices,
        Vec::new(),
        a.triangles().iter().copied().chain(others).collect(),
    )
    .unwrap()
}

/// The winding number by solid angles (van Oosterom and Strackee 1983, doi:10.1109/TBME.1983.325207).
fn winding(mesh: &Mesh, at: Point) -> f64 {
    let angle = |t: usize| {
        let [a, b, c] = mesh.triangle(t).map(|p| sub(p, at));
        let length = |p: Point| dot(p, p).sqrt();
        let (la, lb, lc) = (length(a), length(b), length(c));
        let cross = [
            b[1] * c[2] - b[2] * c[1],
            b[2] * c[0] - b[0] * c[2],
            b[0] * c[1] - b[1] * c[0],
        ];
        let below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
        2.0 * dot(a, cross).atan2(below)
    };
    (0..mesh.triangles().len()).map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

#[test]
fn inside_is_where_the_winding_number_is_odd() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    let ball = generate::icosphere(0.7, 2).unwrap();
    let ring = generate::torus(0.9, 0.3, 24, 12).unwrap();
    let hollow = both(&ball, &generate::icosphere(0.4, 1).unwrap());
    let linked = both(&ring, &moved(&turned(&ring, &mut rng), [0.2, 0.1, 0.3]));
    for mesh in [&ball, &ring, &hollow, &linked, &block([1.0, 0.5, 1.5], 3)] {
        let mesh = turned(mesh, &mut rng);
        let body = solid(&mesh);
        // which way the triangles are turned does not matter
        let flipped = mesh
            .triangles()
            .iter()
            .enumerate()
            .map(|(k, &[a, b, c])| if k % 3 == 0 { [a, b, c] } else { [b, a, c] });
        let flipped = solid(&Mesh::new(mesh.vertices().to_vec(), Vec::new(), flipped.collect()).unwrap());
        let mut inside = 0;
        for _ in 0..400 {
            let at = point(&mut rng, 2.4);
            let expected = (winding(&mesh, at).round() as i64).rem_euclid(2) == 1;
            assert_eq!(body.contains(at), expected, "{at:?}");
            assert_eq!(flipped.contains(at), expected, "{at:?}");
            inside += usize::from(expected);
        }
        assert!((10..390).contains(&inside), "{inside}");
    }
}

/// The way up meets edges and vertices, and runs along faces.
#[test]
fn a_lattice_of_points_in_a_block() {
    for squares in [1, 2, 4] {
        let body = solid(&block([2.0, 2.0, 2.0], squares));
        for k in 0..9_i32.pow(3) {
            let at = [k % 9, k / 9 % 9, k / 81].map(|i| 0.5 * f64::from(i) - 2.0);
            let far = at.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
            if far != 1.0 {
                assert_eq!(body.contains(at), far < 1.0, "{at:?}");
            }
        }
        let near = 1.0_f64.next_down();
        assert!(body.contains([near, near, near]) && !body.contains([1.0_f64.next_up(), 0.0, 0.0]));
        assert!(!body.contains([f64::NAN, 0.0, 0.0]));
    }
}

#[test]
fn holes_are_refused() {
    let sheet = generate::cloth(1.0, 1.0, 3, 2).unwrap();
    let Err(Error::NotClosed { edges, triangles, .. }) = Solid::new(&sheet) else {
        panic!("a sheet is open");
    };
    assert_eq!((edges, triangles), (6, 1));
    let ball = generate::icosphere(1.0, 1).unwrap();
    let torn = Mesh::new(
        ball.vertices().to_vec(),
        Vec::new(),
        ball.triangles()[1..].to_vec(),
    )
    .unwrap();
    let error = Solid::new(&torn).unwrap_err().to_string();
    assert!(
        error.starts_with("the surface is not closed: 3 edges have an odd number of triangles, the first of them between vertices ")
            && error.ends_with(" (1 triangle); close its holes"),
        "{error}"
    );
    let line = Mesh::new(vec![[0.0; 3], [1.0; 3]], vec![[0, 1]], Vec::new()).unwrap();
    assert!(Solid::new(&line).is_err());
    // Seams with equal coordinates are no holes, nor are triangles without area.
    let corners = ball
        .triangles()
        .iter()
        .flatten()
        .map(|&v| ball.vertex(v))
        .collect();
    let loose = (0..ball.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    let loose = loose.chain([[0, 0, 1], [2, 2, 2]]).collect();
    assert!(Solid::new(&Mesh::new(corners, Vec::new(), loose).unwrap()).is_ok());
}

#[test]
fn convex_bodies_are_recognised() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(2);
    assert!(solid(&block([1.0, 2.0, 0.5], 4)).is_convex());
    assert!(solid(&turned(&block([1.0, 2.0, 0.5], 1), &mut rng)).is_convex());
    assert!(solid(&turned(&generate::icosphere(1.0, 2).unwrap(), &mut rng)).is_convex());
    let ring = generate::torus(0.9, 0.3, 24, 12).unwrap();
    assert!(!solid(&ring).is_convex());
    let ball = generate::icosphere(1.0, 1).unwrap();
    assert!(!solid(&both(&ball, &moved(&ball, [5.0, 0.0, 0.0]))).is_convex());
    // Convex at every edge, but it winds twice around its axis.
    let corner = |k: u32| {
        let angle = 0.8 * std::f64::consts::PI * f64::from(k);
        [angle.cos(), angle.sin(), 0.0]
    };
    let vertices = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]
        .into_iter()
        .chain((0..5).map(corner))
        .collect();
    let star = (0..5).flat_map(|k| {
        let (a, b) = (2 + k, 2 + (k + 1) % 5);
        [[0, a, b], [1, b, a]]
    });
    assert!(!solid(&Mesh::new(vertices, Vec::new(), star.collect()).unwrap()).is_convex());
    // One vertex pressed in.
    let mut dented = ball.vertices().to_vec();
    dented[7] = dented[7].map(|c| 0.7 * c);
    assert!(!solid(&ball.with_vertices(dented).unwrap()).is_convex());
}

#[test]
fn how_two_solids_lie() {
    let ball = |radius: f64| generate::icosphere(radius, 2).unwrap();
    let large = ball(2.0);
    let relation = |a: &Mesh, b: &Mesh| overlap_of(a, b).map(|overlap| overlap.relation);
    for (x, expected) in [
        (0.0, Some(Relation::SecondInsideFirst)),
        (1.2, Some(Relation::SecondInsideFirst)),
        (1.7, Some(Relation::SurfacesMeet)),
        (2.3, Some(Relation::SurfacesMeet)),
        (2.6, None),
        (9.0, None),
    ] {
        let small = moved(&ball(0.5), [x, 0.0, 0.0]);
        assert_eq!(relation(&large, &small), expected, "{x}");
        let swapped = match expected {
            Some(Relation::SecondInsideFirst) => Some(Relation::FirstInsideSecond),
            other => other,
        };
        assert_eq!(relation(&small, &large), swapped, "{x}");
    }
    // In the hole of a ring, and in a hollow.
    let ring = generate::torus(2.0, 0.3, 40, 12).unwrap();
    assert_eq!(relation(&ring, &ball(1.0)), None);
    let hollow = both(&large, &ball(1.0));
    assert_eq!(relation(&hollow, &ball(0.5)), None);
    // A ball inside and one outside.
    let two = both(&ball(0.5), &moved(&ball(0.5), [4.0, 0.0, 0.0]));
    assert_eq!(relation(&large, &two), Some(Relation::PartsInside));
}

#[test]
fn depths_of_blocks_are_known() {
    let large = block([10.0, 10.0, 10.0], 1);
    for (scale, squares) in [(1.0, 1), (1.0, 3), (1e-200, 2), (1e200, 2)] {
        let scaled = |mesh: &Mesh| {
            let vertices = mesh.vertices().iter().map(|p| p.map(|c| scale * c)).collect();
            mesh.with_vertices(vertices).unwrap()
        };
        for (by, expected, direction) in [
            ([0.0; 3], 5.5, None),
            ([3.0, 0.0, 1.0], 2.5, Some([-1.0, 0.0, 0.0])),
            ([0.0, -5.25, 1.0], 0.25, Some([0.0, 1.0, 0.0])),
            ([5.5, 0.0, 0.0], 0.0, None),
        ] {
            let small = moved(&block([1.0, 1.0, 1.0], squares), by);
            let depth = overlap_of(&scaled(&large), &scaled(&small)).unwrap().depth;
            let expected = expected * scale;
            let error = 1e-10 * scale;
            assert!((depth.at_most - expected).abs() <= error, "{by:?} {depth:?}");
            assert!(
                depth.at_least <= depth.at_most && depth.at_least >= expected - error,
                "{by:?} {depth:?}"
            );
            if let Some(direction) = direction {
                assert!(dot(direction, depth.direction) > 1.0 - 1e-12, "{depth:?}");
            }
        }
    }
}

/// The least over all directions that can be the shallowest: normals of faces, and of two edges.
fn shallowest(a: &Mesh, b: &Mesh) -> f64 {
    let cross = |x: Point, y: Point| {
        [
            x[1] * y[2] - x[2] * y[1],
            x[2] * y[0] - x[0] * y[2],
            x[0] * y[1] - x[1] * y[0],
        ]
    };
    let edges = |mesh: &Mesh| -> Vec<Point> {
        let edges = mesh.edges().iter();
        edges.map(|&[v, w]| sub(mesh.vertex(w), mesh.vertex(v))).collect()
    };
    let faces = [a, b].into_iter().flat_map(|mesh| {
        (0..mesh.triangles().len()).map(|t| {
            let [p, q, r] = mesh.triangle(t);
            cross(sub(q, p), sub(r, p))
        })
    });
    let (of_a, of_b) = (edges(a), edges(b));
    let pairs = of_a.iter().flat_map(|&x| of_b.iter().map(move |&y| cross(x, y)));
    let depth = |n: Point| {
        let length = dot(n, n).sqrt();
        let n = n.map(|c| c / length);
        let most = |mesh: &Mesh, n: Point| {
            mesh.vertices()
                .iter()
                .map(|&p| dot(n, p))
                .fold(f64::MIN, f64::max)
        };
        most(a, n) + most(b, n.map(|c| -c))
    };
    faces
        .chain(pairs)
        .filter(|&n| dot(n, n) > 1e-20)
        .flat_map(|n| [depth(n), depth(n.map(|c| -c))])
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn convex_depths_are_exact() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(3);
    let shapes = [
        block([1.0, 0.7, 0.4], 1),
        generate::icosphere(0.6, 0).unwrap(),
        generate::icosphere(0.5, 1).unwrap(),
    ];
    let mut overlapping = 0;
    for round in 0..30 {
        let [a, b] = [round % 3, round / 3 % 3].map(|k| turned(&shapes[k], &mut rng));
        let b = moved(&b, point(&mut rng, 1.2));
        let expected = shallowest(&a, &b);
        let Some(found) = overlap_of(&a, &b) else {
            assert!(expected < 1e-12, "{expected}");
            continue;
        };
        overlapping += 1;
        let depth = found.depth;
        assert!((depth.at_most - expected).abs() < 1e-11, "{depth:?} {expected}");
        assert!(
            depth.at_least <= expected && depth.at_least > expected - 1e-11,
            "{depth:?} {expected}"
        );
        // the translation that it names separates them
        let apart = moved(&a, depth.direction.map(|c| c * (depth.at_most + 1e-9)));
        assert_eq!(overlap_of(&apart, &b), None);
    }
    assert!(overlapping > 15, "{overlapping}");
}

/// The mesh with some triangles turned over.
fn mixed(mesh: &Mesh, rng: &mut Xoshiro256PlusPlus) -> Mesh {
    let triangles = mesh.triangles().iter();
    let turned = triangles.map(|&[a, b, c]| if rng.random() { [a, b, c] } else { [a, c, b] });
    Mesh::new(mesh.vertices().to_vec(), Vec::new(), turned.collect()).unwrap()
}

#[test]
fn convex_depths_are_exact_whichever_way_triangles_are_turned() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(4);
    let tetrahedron = Mesh::new(
        vec![
            [1.0, 3.0, 3.0],
            [3.0, -3.0, -1.0],
            [-3.0, 0.0, 3.0],
            [0.0, 0.0, 2.0],
        ],
        Vec::new(),
        vec![[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]],
    );
    let ball = generate::icosphere(0.5, 1).unwrap();
    let shapes = [tetrahedron.unwrap(), block([1.0, 0.7, 0.4], 2), ball];
    for shape in &shapes {
        let expected = shallowest(shape, shape);
        for _ in 0..8 {
            let (a, b) = (mixed(shape, &mut rng), mixed(shape, &mut rng));
            assert!(solid(&a).is_convex());
            let depth = overlap_of(&a, &b).unwrap().depth;
            let is_near = |bound: f64| (bound - expected).abs() < 1e-10;
            assert!(
                is_near(depth.at_least) && is_near(depth.at_most),
                "{depth:?} {expected}"
            );
        }
    }
    // Two surfaces that touch at a vertex, and one with a dent, are not convex however they are turned.
    let [ball, opposite] = [1.0, -1.0].map(|sign| {
        let ball = generate::icosphere(1.0, 1).unwrap();
        let top = ball.vertex(0);
        let vertices = ball.vertices().iter().map(|&p| sub(p, top).map(|c| sign * c));
        ball.with_vertices(vertices.collect()).unwrap()
    });
    let mut dented = ball.vertices().to_vec();
    dented[7] = [0, 1, 2].map(|k| 0.7 * dented[7][k] + 0.3 * dented[0][k]);
    for shape in [both(&ball, &opposite), ball.with_vertices(dented).unwrap()] {
        for _ in 0..8 {
            assert!(!solid(&mixed(&shape, &mut rng)).is_convex());
        }
    }
}

#[test]
fn other_depths_are_bounded() {
    let ring = generate::torus(2.0, 0.5, 60, 30).unwrap();
    // A ball within the ring: 0.5 - 0.2 from its surface, and of 0.4 across.
    let ball = moved(&generate::icosphere(0.2, 2).unwrap(), [2.0, 0.0, 0.0]);
    let found = overlap_of(&ball, &ring).unwrap();
    assert_eq!(found.relation, Relation::FirstInsideSecond);
    let depth = found.depth;
    assert!(
        depth.at_least > 0.4 && depth.at_least < 0.7 && depth.at_most >= 0.7 - 0.02,
        "{depth:?}"
    );
}

/// Ended after any number of questions, what is said is true: the bounds are wide, and still bounds.
#[test]
fn an_answer_that_is_ended_says_nothing_wrong() {
    let ring = generate::torus(2.0, 0.5, 60, 30).unwrap();
    let ball = |size: f64, x: f64| solid(&moved(&generate::icosphere(size, 2).unwrap(), [x, 0.0, 0.0]));
    for (other, lies) in [
        (ball(0.2, 2.0), Some(Relation::FirstInsideSecond)),
        (ball(0.2, 2.5), Some(Relation::SurfacesMeet)),
        (ball(9.0, 0.0), Some(Relation::SecondInsideFirst)),
        (ball(1.2, 0.0), None),
    ] {
        let ring = solid(&ring);
        let (whole, completeness) = overlap(&other, &ring, &|| false);
        assert_eq!(completeness, Completeness::Proved);
        assert_eq!(whole.map(|whole| whole.relation), lies);
        let mut some = [0; 2];
        for most in (0..).flat_map(|k| {
            if k < 60 {
                Some(k)
            } else {
                (k % 97 == 0).then_some(k)
            }
        }) {
            let asked = AtomicUsize::new(0);
            let stop = || asked.fetch_add(1, Ordering::Relaxed) >= most;
            let (found, completeness) = overlap(&other, &ring, &stop);
            assert_eq!(completeness == Completeness::Unknown, asked.into_inner() > most);
            if completeness == Completeness::Proved {
                assert_eq!(found, whole);
                break;
            }
            some[usize::from(found.is_some())] += 1;
            if let Some(found) = found {
                let whole = whole.unwrap();
                assert_eq!(found.relation, whole.relation);
                let [hasty, depth] = [found.depth, whole.depth];
                assert!(
                    hasty.at_least <= depth.at_least && hasty.at_most >= depth.at_most,
                    "{hasty:?}"
                );
            }
        }
        assert!(some[0] > 0 && (some[1] > 0) == lies.is_some(), "{some:?}");
    }
}

#[test]
fn what_encloses_nothing_or_is_too_large_is_refused() {
    let refused = |mesh: Result<Mesh, Error>, name: &str| match Solid::new(&mesh.unwrap()) {
        Err(Error::Parameter { parameter, .. }) => assert_eq!(parameter, name),
        other => panic!("{name}: {other:?}"),
    };
    let sheet = |points: [Point; 3]| Mesh::new(points.to_vec(), Vec::new(), vec![[0, 1, 2], [0, 2, 1]]);
    let none = "number of triangles with an area";
    refused(sheet([[0.5; 3]; 3]), none);
    refused(sheet([[0.0; 3], [1.0; 3], [3.0; 3]]), none);
    let ball = generate::icosphere(1.0, 1).unwrap();
    let scaled = |by: f64| ball.with_vertices(ball.vertices().iter().map(|p| p.map(|c| by * c)).collect());
    refused(scaled(f64::MAX), "size of the surface");
    refused(scaled(f64::MAX / 4.0), "size of the surface");
    // the largest ones have depths, and so have flat ones
    let large = solid(&scaled(f64::MAX / 10.0).unwrap());
    let beside = moved(&scaled(f64::MAX / 10.0).unwrap(), [f64::MAX / 20.0, 0.0, 0.0]);
    for other in [&large, &solid(&beside)] {
        let depth = overlap(&large, other, &|| false).0.unwrap().depth;
        assert!(
            depth.at_most.is_finite() && depth.at_least > 0.9 * depth.at_most,
            "{depth:?}"
        );
    }
    let flat = solid(&sheet([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap());
    assert_eq!(overlap(&flat, &flat, &|| false).0.unwrap().depth.at_most, 0.0);
}

//! Polygons cut into triangles, against areas in whole numbers.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use super::{OBJ, OFF, PLY};
use crate::io::{AnimatedScene, UncutFaces, parse};

type Corner = [i64; 2];

/// Twice the area, above 0 for corners in counter-clockwise order.
fn twice_area(corners: &[Corner]) -> i64 {
    let next = corners.iter().cycle().skip(1);
    corners
        .iter()
        .zip(next)
        .map(|(p, q)| p[0] * q[1] - p[1] * q[0])
        .sum()
}

fn fan(corners: usize) -> Vec<[u32; 3]> {
    (2..corners as u32).map(|k| [0, k - 1, k]).collect()
}

/// The triangles of a face with these corners, which lie in a plane.
fn triangles_in(corners: &[Corner], plane: impl Fn(Corner) -> [i64; 3]) -> Vec<[u32; 3]> {
    let vertices = corners.iter().map(|&corner| {
        let [x, y, z] = plane(corner);
        format!("v {x} {y} {z}\n")
    });
    let face: String = (1..=corners.len()).map(|corner| format!(" {corner}")).collect();
    let text = format!("{}f{face}\n", vertices.collect::<String>());
    parse(OBJ, text.as_bytes()).unwrap().triangles().to_vec()
}

fn triangles(corners: &[Corner]) -> Vec<[u32; 3]> {
    triangles_in(corners, |[x, y]| [x, y, 0])
}

/// Triangles that are turned like the polygon and have its area in all cover it and nothing else.
fn assert_covered(corners: &[Corner], triangles: &[[u32; 3]]) {
    let whole = twice_area(corners);
    let areas = triangles
        .iter()
        .map(|t| twice_area(&t.map(|k| corners[k as usize])));
    assert_eq!(triangles.len(), corners.len() - 2);
    assert_eq!(
        areas.map(i64::abs).sum::<i64>(),
        whole.abs(),
        "{corners:?} {triangles:?}"
    );
    assert!(
        triangles
            .iter()
            .all(|t| twice_area(&t.map(|k| corners[k as usize])) * whole >= 0)
    );
}

const ARROWHEAD: [Corner; 4] = [[0, 0], [4, 3], [0, 6], [1, 3]];

#[test]
fn an_arrowhead_is_cut_from_its_notch() {
    for first in 0..4 {
        let mut corners = ARROWHEAD;
        corners.rotate_left(first);
        for _ in 0..2 {
            let cut = triangles(&corners);
            assert_covered(&corners, &cut);
            let notch = corners.iter().position(|&corner| corner == [1, 3]).unwrap() as u32;
            assert!(cut.iter().all(|triangle| triangle.contains(&notch)), "{cut:?}");
            corners.reverse();
        }
    }
    let expected = [[3, 0, 1], [3, 1, 2]];
    let sorted = |mut triangles: Vec<[u32; 3]>| {
        for triangle in &mut triangles {
            let first = triangle.iter().position(|&v| v == 3).unwrap();
            triangle.rotate_left(first);
        }
        triangles.sort_unstable();
        triangles
    };
    assert_eq!(sorted(triangles(&ARROWHEAD)), expected);
    let off = "OFF 4 1 0\n0 0 0\n4 3 0\n0 6 0\n1 3 0\n4 0 1 2 3\n";
    // the face comes before its vertices
    let ply = "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 4\n\
        property float x\nproperty float y\nproperty float z\nend_header\n4 0 1 2 3\n0 0 0\n4 3 0\n0 6 0\n1 3 0\n";
    let forward = "f 1 2 3 4\nv 0 0 0\nv 4 3 0\nv 0 6 0\nv 1 3 0\n";
    for (format, text) in [(OFF, off), (PLY, ply), (OBJ, forward)] {
        let mesh = parse(format, text.as_bytes()).unwrap();
        assert_eq!(sorted(mesh.triangles().to_vec()), expected, "{text}");
    }
}

#[test]
fn other_faces_stay_where_they_are() {
    let text = "v 0 0 0\nv 4 3 0\nv 0 6 0\nv 1 3 0\nf 1 2 3\nf 1 2 3 4\nf 2 3 4\nf 1 2\n";
    let mesh = parse(OBJ, text.as_bytes()).unwrap();
    let triangles = mesh.triangles();
    assert_eq!(
        (triangles.len(), triangles[0], triangles[3]),
        (4, [0, 1, 2], [1, 2, 3])
    );
    assert_eq!(mesh.lines(), [[0, 1]]);
}

#[test]
fn fans_that_cover_a_polygon_are_kept() {
    let convex = [[0, 0], [4, 0], [8, 1], [9, 5], [5, 9], [0, 7]];
    // corners within a side and repeated ones, a notch that the first corner sees
    let straight = [[0, 0], [1, 0], [2, 0], [2, 0], [2, 1], [2, 2], [0, 2], [0, 1]];
    let seen = [[1, 3], [0, 0], [4, 3], [0, 6]];
    for corners in [&convex[..], &straight, &seen] {
        assert_eq!(triangles(corners), fan(corners.len()), "{corners:?}");
        assert_covered(corners, &fan(corners.len()));
    }
}

#[test]
fn a_polygon_that_crosses_itself_stays_a_fan() {
    let bow_tie = [[0, 0], [4, 4], [4, 0], [0, 3]];
    let pentagram = [[0, 9], [6, -8], [-9, 3], [9, 3], [-6, -8]];
    let no_area = [[0, 0], [2, 2], [4, 4], [1, 1], [3, 3]];
    let one_place = [[5, 5]; 6];
    for corners in [&bow_tie[..], &pentagram, &no_area, &one_place] {
        assert_eq!(triangles(corners), fan(corners.len()), "{corners:?}");
    }
}

/// A strip of the width 1 along a way that turns inwards at right angles.
fn spiral(turns: i64) -> Vec<Corner> {
    let plus = |p: Corner, q: Corner, times: i64| [p[0] + times * q[0], p[1] + times * q[1]];
    let ways = [[1, 0], [0, 1], [-1, 0], [0, -1]];
    let way = |k: i64| ways[k as usize % 4];
    let left = |k: i64| way(k + 1);
    let (mut outer, mut inner) = (vec![[0, 0]], vec![left(0)]);
    for k in 0..4 * turns {
        let length = 8 * turns - 4 * ((k - 1).max(0) / 2);
        let corner = plus(outer[outer.len() - 1], way(k), length);
        outer.push(corner);
        let is_last = k + 1 == 4 * turns;
        inner.push(plus(plus(corner, left(k), 1), left(k + 1), i64::from(!is_last)));
    }
    outer.into_iter().chain(inner.into_iter().rev()).collect()
}

#[test]
fn a_spiral_is_covered() {
    for turns in 1..6 {
        let corners = spiral(turns);
        assert_eq!(crossings(&corners), 0);
        assert_covered(&corners, &triangles(&corners));
    }
}

#[test]
fn corners_within_a_side_give_no_triangles_without_area() {
    let corners = [
        [0, 0],
        [3, 0],
        [6, 0],
        [6, 1],
        [6, 2],
        [4, 2],
        [2, 2],
        [2, 3],
        [2, 4],
        [2, 6],
        [1, 6],
        [0, 6],
        [0, 3],
    ];
    for first in 0..corners.len() {
        let mut corners = corners;
        corners.rotate_left(first);
        let cut = triangles(&corners);
        assert_covered(&corners, &cut);
        let area = |t: &[u32; 3]| twice_area(&t.map(|k| corners[k as usize]));
        if cut != fan(corners.len()) {
            assert!(cut.iter().all(|t| area(t) != 0), "{cut:?}");
        }
    }
}

#[test]
fn repeated_corners_and_a_hole_on_a_bridge_are_covered() {
    let repeated = ARROWHEAD.map(|corner| [corner; 3]).concat();
    let hole = [
        [0, 0],
        [9, 0],
        [9, 9],
        [0, 9],
        [0, 0],
        [3, 3],
        [3, 6],
        [6, 6],
        [6, 3],
        [3, 3],
    ];
    for corners in [&repeated[..], &hole] {
        assert_covered(corners, &triangles(corners));
    }
}

/// A comb with teeth of so many corners.
fn comb(teeth: i64) -> Vec<Corner> {
    let tips = (0..teeth).flat_map(|k| [[2 * k, 9], [2 * k + 1, 1]]).rev();
    [[-1, 0], [2 * teeth, 0]].into_iter().chain(tips).collect()
}

#[test]
fn combs_and_spirals_of_very_many_corners_are_covered() {
    for corners in [comb(500), comb(1 << 14), spiral(1 << 10)] {
        let cut = triangles(&corners);
        assert_covered(&corners, &cut);
        assert_ne!(cut, fan(corners.len()));
    }
}

/// How many faces a scene of this OBJ file leaves uncut.
fn uncut(text: &str) -> usize {
    let scene = AnimatedScene::read_resting_from(text.as_bytes(), OBJ, "polygon", ".").unwrap();
    scene.uncut_faces().iter().map(|file| file.faces).sum()
}

#[test]
fn faces_that_cross_themselves_are_counted() {
    let vertices = "v 0 0 0\nv 4 4 0\nv 4 0 0\nv 0 3 0\nv 1 1 0\nv 9 9 9\n";
    for (faces, count) in [
        ("f 1 2 3 4\n", 1),
        // a bow tie without a normal
        ("f 1 2 3 4\nf 1 3 2 4\nv 0 4 0\nf 1 2 3 7\n", 2),
        ("f 1 3 2 4\nf 1 2 3\nf 1 2\n", 0),
        // on a line, and at one place
        ("f 1 2 5 2\nf 6 6 6 6\n", 0),
    ] {
        assert_eq!(uncut(&format!("{vertices}{faces}")), count, "{faces}");
    }
}

#[test]
fn files_of_a_list_tell_which_faces_were_not_cut() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("bow.obj", "v 0 0 0\nv 4 4 0\nv 4 0 0\nv 0 3 0\nf 1 2 3 4\n");
    write("flat.obj", "v 0 0 0\nv 4 0 0\nv 0 3 0\nf 1 2 3\n");
    write(
        "list.toml",
        "bodies = [{ mesh = 'flat.obj' }, { mesh = 'bow.obj' }, { mesh = 'bow.obj', at = [9, 0, 0] }]",
    );
    let scene = AnimatedScene::read_resting(folder.path().join("list.toml")).unwrap();
    let file = folder.path().join("bow.obj");
    assert_eq!(scene.uncut_faces(), [UncutFaces { file, faces: 1 }]);
}

fn side(a: Corner, b: Corner, c: Corner) -> i64 {
    ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).signum()
}

/// Whether two sides have a point in common.
fn meet([a, b]: [Corner; 2], [c, d]: [Corner; 2]) -> bool {
    let is_between = |p: Corner, q: Corner, r: Corner| {
        side(p, q, r) == 0 && (0..2).all(|k| p[k].min(q[k]) <= r[k] && r[k] <= p[k].max(q[k]))
    };
    let is_across = side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
    is_across || is_between(a, b, c) || is_between(a, b, d) || is_between(c, d, a) || is_between(c, d, b)
}

/// The pairs of sides that are no neighbours and meet.
fn crossings(corners: &[Corner]) -> usize {
    let n = corners.len();
    let of = |k: usize| [corners[k], corners[(k + 1) % n]];
    let apart = |i: usize, j: usize| j > i + 1 && (i, j) != (0, n - 1);
    let pairs = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    pairs.filter(|&(i, j)| apart(i, j) && meet(of(i), of(j))).count()
}

/// A simple polygon: random corners in an order that is untangled, or nothing if that takes long.
fn random_polygon(rng: &mut Xoshiro256PlusPlus) -> Option<Vec<Corner>> {
    let count = 4 + rng.next_u64() as usize % 14;
    let mut number = || (rng.next_u64() % 21) as i64;
    let mut corners: Vec<Corner> = (0..count).map(|_| [number(), number()]).collect();
    for _ in 0..200 {
        let of = |k: usize| [corners[k], corners[(k + 1) % count]];
        let pairs = (0..count).flat_map(|i| (i + 2..count).map(move |j| (i, j)));
        let crossing = pairs
            .filter(|&(i, j)| (i, j) != (0, count - 1))
            .find(|&(i, j)| meet(of(i), of(j)));
        match crossing {
            Some((i, j)) => corners[i + 1..=j].reverse(),
            None => {
                let doubles = (0..count)
                    .any(|k| side(corners[k], corners[(k + 1) % count], corners[(k + 2) % count]) == 0);
                return (!doubles).then_some(corners);
            }
        }
    }
    None
}

#[test]
fn random_simple_polygons_are_covered_in_every_plane() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    let planes: [fn(Corner) -> [i64; 3]; 4] = [
        |[x, y]| [x, y, -7],
        |[x, y]| [1_000_000, x, y],
        |[x, y]| [y, 3, x],
        |[x, y]| [x, y, x + 2 * y],
    ];
    let (mut simple, mut cut) = (0, 0);
    while simple < 400 {
        let Some(corners) = random_polygon(&mut rng) else {
            continue;
        };
        simple += 1;
        for plane in planes {
            let triangles = triangles_in(&corners, plane);
            assert_covered(&corners, &triangles);
            cut += u32::from(triangles != fan(corners.len()));
        }
    }
    assert!(cut > 800, "{cut}");
}

//! Scenes with and without one thing far away: time, and the work of the trees.
//!
//! `cargo run --release -p satisfice-collision --example far_away`; with `ordinary` behind it, only those where nothing is far.
#![expect(clippy::disallowed_methods, reason = "an example asks the time")]

use std::error::Error;
use std::time::Instant;

use rand::{RngExt as _, SeedableRng as _};
use rand_xoshiro::Xoshiro256PlusPlus;
use satisfice_collision::broad::{FeatureTree, PointGrid, TreeJoin};
use satisfice_collision::distance::{PairKind, Threshold};
use satisfice_collision::scene::{Body, SharedMesh, World};
use satisfice_collision::{FeatureKind, Mesh, Placement, generate};

const FRAMES: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    if std::env::args().any(|argument| argument == "ordinary") {
        world(8000, 0.0)?;
        world(100, 0.0)?;
        soup(20_000, 0.0)?;
        points(20_000, 0.0)?;
        return refits();
    }
    for far in [0.0, 1e7, 1e9, 1e300] {
        world(8000, far)?;
    }
    for far in [0.0, 1e6, 1e8, 1e300] {
        spheres(far)?;
        soup(20_000, far)?;
        points(20_000, far)?;
    }
    for n in [10_000, 30_000] {
        scales(n)?;
    }
    refits()
}

/// A stray triangle or point; none at 0.
fn stray(vertices: &mut Vec<[f64; 3]>, triangles: &mut Vec<[u32; 3]>, far: f64) {
    if far > 0.0 {
        let first = vertices.len() as u32;
        vertices.extend([[far, 0.0, 0.0], [far, 1.0, 0.0], [far, 0.0, 1.0]]);
        triangles.push([first, first + 1, first + 2]);
    }
}

fn world(n: usize, far: f64) -> Result<(), Box<dyn Error>> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(0);
    let side = (n as f64).cbrt();
    let mut world = World::new(PairKind::TriangleTriangle, Threshold::new(1e-3)?);
    let corners = vec![[0.0; 3], [0.3, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 0.3]];
    let faces = vec![[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];
    let mesh = SharedMesh::from(Mesh::new(corners, vec![], faces)?);
    let mut places: Vec<[f64; 3]> = (0..n)
        .map(|_| std::array::from_fn(|_| side * rng.random::<f64>()))
        .collect();
    let mut bodies = Vec::new();
    for &place in &places {
        bodies.push(world.add(Body::rigid(mesh.clone()).at(Placement::from_translation(place)?))?);
    }
    if far > 0.0 {
        world.add(Body::rigid(mesh).at(Placement::from_translation([far, 0.0, 0.0])?))?;
    }
    world.update()?;
    let mut seconds = 0.0;
    for _ in 0..FRAMES {
        for (&body, place) in bodies.iter().zip(&mut places) {
            for c in &mut *place {
                *c += 0.07 * (rng.random::<f64>() - 0.5);
            }
            world.translate(body, *place)?;
        }
        let clock = Instant::now();
        world.update()?;
        seconds += clock.elapsed().as_secs_f64();
    }
    println!(
        "world of {n}, far {far:e}: {:.4} s a frame, {} kept pairs, {} kB, {} contacts",
        seconds / FRAMES as f64,
        world.kept_pairs(),
        world.bytes() / 1000,
        world.contacts().count()
    );
    Ok(())
}

fn join(name: &str, [a, b]: [&Mesh; 2], kind: FeatureKind, delta: f64) -> Result<(), Box<dyn Error>> {
    let trees = [a, b].map(|mesh| FeatureTree::new(mesh, kind));
    let mut join = TreeJoin::new();
    let here = Placement::IDENTITY;
    let clock = Instant::now();
    let found = join
        .between(
            (&trees[0], &here),
            (&trees[1], &here),
            Threshold::new(delta)?,
            None,
        )?
        .len();
    let seconds = clock.elapsed().as_secs_f64();
    println!("{name}: {seconds:.4} s, {found} pairs, {:?}", join.work());
    Ok(())
}

fn spheres(far: f64) -> Result<(), Box<dyn Error>> {
    let ball = generate::icosphere(1.0, 5)?;
    let moved = ball
        .vertices()
        .iter()
        .map(|&[x, y, z]| [x + 2.01, y, z])
        .collect();
    let (mut vertices, mut triangles) = (ball.vertices().to_vec(), ball.triangles().to_vec());
    stray(&mut vertices, &mut triangles, far);
    let one = Mesh::new(vertices, vec![], triangles)?;
    let two = Mesh::new(moved, vec![], ball.triangles().to_vec())?;
    join(
        &format!("spheres, far {far:e}"),
        [&one, &two],
        FeatureKind::Triangle,
        0.02,
    )
}

fn soup(n: usize, far: f64) -> Result<(), Box<dyn Error>> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut mesh = |far: f64| {
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for t in 0..n as u32 {
            let at: [f64; 3] = std::array::from_fn(|_| rng.random());
            for _ in 0..3 {
                vertices.push(at.map(|c| c + 0.01 * rng.random::<f64>()));
            }
            triangles.push([3 * t, 3 * t + 1, 3 * t + 2]);
        }
        stray(&mut vertices, &mut triangles, far);
        Mesh::new(vertices, vec![], triangles)
    };
    let meshes = [mesh(far)?, mesh(0.0)?];
    join(
        &format!("soup, far {far:e}"),
        [&meshes[0], &meshes[1]],
        FeatureKind::Triangle,
        1e-4,
    )
}

fn points(n: usize, far: f64) -> Result<(), Box<dyn Error>> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(2);
    let mut cloud = |far: f64| {
        let mut points: Vec<[f64; 3]> = (0..n).map(|_| std::array::from_fn(|_| rng.random())).collect();
        if far > 0.0 {
            points.push([far, 0.0, 0.0]);
        }
        Mesh::new(points, vec![], vec![])
    };
    let clouds = [cloud(far)?, cloud(0.0)?];
    join(
        &format!("points, far {far:e}"),
        [&clouds[0], &clouds[1]],
        FeatureKind::Vertex,
        1e-3,
    )?;
    within(
        &format!("points in a grid, far {far:e}"),
        clouds[0].vertices(),
        1e-3,
    )
}

fn within(name: &str, points: &[[f64; 3]], delta: f64) -> Result<(), Box<dyn Error>> {
    let mut grid = PointGrid::new();
    let clock = Instant::now();
    let found = grid.within(points, Threshold::new(delta)?)?.len();
    let seconds = clock.elapsed().as_secs_f64();
    println!("{name}: {seconds:.4} s, {found} pairs, {:?}", grid.work());
    Ok(())
}

/// Points on scales from 1e-12 to 1e12.
fn scales(n: usize) -> Result<(), Box<dyn Error>> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(3);
    let points: Vec<[f64; 3]> = (0..n)
        .map(|_| {
            let scale = 10.0_f64.powf(24.0 * rng.random::<f64>() - 12.0);
            std::array::from_fn(|_| scale * (2.0 * rng.random::<f64>() - 1.0))
        })
        .collect();
    within(&format!("{n} points on all scales"), &points, 1e-13)
}

/// An ordinary mesh, refitted and joined with itself, moved and turned.
fn refits() -> Result<(), Box<dyn Error>> {
    const TIMES: usize = 200;
    let ball = generate::icosphere(1.0, 5)?;
    let turned = Placement::from_axis_angle([1.0, 2.0, 3.0], 0.7)?.moved([2.01, 0.0, 0.0])?;
    for kind in [FeatureKind::Triangle, FeatureKind::Vertex] {
        let mut tree = FeatureTree::new(&ball, kind);
        let clock = Instant::now();
        for _ in 0..TIMES {
            tree.refit(ball.vertices())?;
        }
        let refit = clock.elapsed().as_secs_f64() / TIMES as f64;
        let mut join = TreeJoin::new();
        let clock = Instant::now();
        for _ in 0..TIMES {
            join.between(
                (&tree, &Placement::IDENTITY),
                (&tree, &turned),
                Threshold::new(0.04)?,
                None,
            )?;
        }
        let joined = clock.elapsed().as_secs_f64() / TIMES as f64;
        let clock = Instant::now();
        for _ in 0..TIMES / 20 {
            join.within(&tree, Threshold::new(0.01)?, None);
        }
        let own = clock.elapsed().as_secs_f64() / (TIMES / 20) as f64;
        println!(
            "ordinary {kind:?}: refit {:.4} ms, join {:.4} ms, itself {:.3} ms",
            1e3 * refit,
            1e3 * joined,
            1e3 * own
        );
    }
    Ok(())
}

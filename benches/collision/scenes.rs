//! The scenes: teapots, uniform clouds, a cloth over a ball.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use satisfice_collision::{Mesh, Placement, generate, io};

pub(crate) type Points = Vec<[f64; 3]>;

/// Two bodies of points and a threshold.
pub(crate) struct Pair {
    pub(crate) name: String,
    pub(crate) a: Points,
    pub(crate) b: Points,
    pub(crate) delta: f64,
    /// Whether brute force is bearable.
    pub(crate) small: bool,
}

/// `n` points, uniform in the unit cube.
pub(crate) fn uniform(n: usize, seed: u64) -> Points {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut real = || (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    (0..n).map(|_| [real(), real(), real()]).collect()
}

/// A mesh moved by an offset.
pub(crate) fn moved(mesh: &Mesh, by: [f64; 3]) -> Mesh {
    let placement = Placement::from_translation(by).expect("a finite offset");
    placement.place(mesh).expect("finite vertices")
}

/// The Utah teapot with so many segments along a patch edge: 13 make 5,461 vertices, 180 make 1,037,521.
pub(crate) fn teapot(segments: usize) -> Mesh {
    generate::teapot(segments).expect("a positive number of segments")
}

/// One teapot's foot in the lid of the other; spout through handle; apart.
pub(crate) const TOUCHING: [f64; 3] = [0.0, 0.0, 3.1];
pub(crate) const CROSSING: [f64; 3] = [4.5, 0.0, 0.0];
pub(crate) const APART: [f64; 3] = [20.0, 0.0, 0.0];

/// The scenes of points, small ones only in a test.
pub(crate) fn points(full: bool) -> Vec<Pair> {
    let mut scenes = Vec::new();
    let mut add = |name: String, a: &Points, b: Points, delta, small| {
        scenes.push(Pair {
            name,
            a: a.clone(),
            b,
            delta,
            small,
        });
    };
    let sizes: &[(usize, f64, bool)] = if full {
        &[(13, 0.05, true), (180, 0.01, false)]
    } else {
        &[(6, 0.1, true)]
    };
    for &(segments, delta, small) in sizes {
        let pot = teapot(segments);
        let a = pot.vertices().to_vec();
        for (name, offset) in [("touching", TOUCHING), ("crossing", CROSSING), ("apart", APART)] {
            let b = moved(&pot, offset).vertices().to_vec();
            add(
                format!("teapots {name}, {} points each, r = {delta}", a.len()),
                &a,
                b,
                delta,
                small,
            );
        }
    }
    let sizes: &[(usize, f64, bool)] = if full {
        &[(5000, 0.05, true), (1_000_000, 0.0062, false)]
    } else {
        &[(800, 0.1, true)]
    };
    for &(n, delta, small) in sizes {
        add(
            format!("uniform, {n} points each, r = {delta}"),
            &uniform(n, 1),
            uniform(n, 2),
            delta,
            small,
        );
    }
    scenes
}

/// A file of the data folder, if there is one.
pub(crate) fn data(file: &str) -> Option<Mesh> {
    let folder = std::env::var_os("SATISFICE_DATA")?;
    match io::read(std::path::Path::new(&folder).join(file)) {
        Ok(mesh) => Some(mesh),
        Err(error) => {
            eprintln!("{file}: {error}");
            None
        }
    }
}

/// A sheet of `side * side` vertices that hangs in waves; `t` is the time.
pub(crate) fn sheet(side: usize, t: f64) -> Mesh {
    let flat = generate::cloth(10.0, 10.0, side, side).expect("two sides");
    let wave = |p: &[f64; 3]| {
        let h = 0.6 * (3.0 * p[0] + t).sin() * (2.0 * p[1] - t).cos();
        // folded three times over itself
        let fold = (p[0] / 2.5 + 10.0).fract();
        [2.5 * (fold - 0.5).abs(), p[1], 0.25 * h + 0.04 * p[0]]
    };
    flat.with_vertices(flat.vertices().iter().map(wave).collect())
        .expect("finite vertices")
}

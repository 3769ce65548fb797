//! Families of hard pairs of triangles. Other kinds of pairs take the first points of each.

use rand_xoshiro::Xoshiro256PlusPlus;

use super::{Point, below, unit};

/// Two triangles.
pub type Pair = ([Point; 3], [Point; 3]);

/// A named family; each draw is a fresh pair.
pub struct Family {
    pub name: &'static str,
    pub draw: fn(&mut Xoshiro256PlusPlus) -> Pair,
}

/// Every family.
pub const ALL: &[Family] = &[
    Family {
        name: "random",
        draw: random,
    },
    Family {
        name: "near-parallel",
        draw: near_parallel,
    },
    Family {
        name: "near-coplanar",
        draw: near_coplanar,
    },
    Family {
        name: "above a face",
        draw: above_face,
    },
    Family {
        name: "crossing edges",
        draw: crossing_edges,
    },
    Family {
        name: "intersecting",
        draw: intersecting,
    },
    Family {
        name: "slivers to 1:1e12",
        draw: slivers,
    },
    Family {
        name: "degenerate",
        draw: degenerate,
    },
    Family {
        name: "duplicates",
        draw: duplicates,
    },
    Family {
        name: "small integers",
        draw: small_integers,
    },
    Family {
        name: "offsets to 1e12",
        draw: offsets,
    },
    Family {
        name: "scales 1e-150 to 1e150",
        draw: scales,
    },
    Family {
        name: "mixed exponents",
        draw: mixed_exponents,
    },
    Family {
        name: "denormals",
        draw: denormals,
    },
    Family {
        name: "near f64::MAX / 2",
        draw: huge,
    },
];

fn point(rng: &mut Xoshiro256PlusPlus) -> Point {
    [unit(rng), unit(rng), unit(rng)]
}

fn triangle(rng: &mut Xoshiro256PlusPlus) -> [Point; 3] {
    [point(rng), point(rng), point(rng)]
}

fn plus(p: Point, q: Point, s: f64) -> Point {
    [0, 1, 2].map(|k| p[k] + s * q[k])
}

/// `2^-k` for a uniform `k` below `n`.
fn tiny(rng: &mut Xoshiro256PlusPlus, n: u64) -> f64 {
    2f64.powi(-(below(rng, n) as i32))
}

fn random(rng: &mut Xoshiro256PlusPlus) -> Pair {
    let gap = point(rng);
    (triangle(rng), triangle(rng).map(|p| plus(p, gap, 2.0)))
}

/// The second triangle is the first, shifted, each vertex disturbed by a tiny amount.
fn near_parallel(rng: &mut Xoshiro256PlusPlus) -> Pair {
    let a = triangle(rng);
    let (gap, noise, size) = (point(rng), tiny(rng, 60), tiny(rng, 12));
    (a, a.map(|p| plus(plus(p, gap, size), point(rng), noise)))
}

/// Both near the plane z = 0.
fn near_coplanar(rng: &mut Xoshiro256PlusPlus) -> Pair {
    let height = tiny(rng, 60);
    let flat = |p: Point| [p[0], p[1], p[2] * height];
    let (a, b) = random(rng);
    (a.map(flat), b.map(flat))
}

/// A vertex of the first straight above the inside of the second.
fn above_face(rng: &mut Xoshiro256PlusPlus) -> Pair {
    let b = triangle(rng);
    let (x, y) = (unit(rng).abs(), unit(rng).abs());
    let sum = 1.0 + x + y;
    let foot: Point = [0, 1, 2].map(|k| (b[0][k] + x * b[1][k] + y * b[2][k]) / sum);
    let (d, e): (Point, Point) = (plus(b[1], b[0], -1.0), plus(b[2], b[0], -1.0));
    let n = [
        d[1] * e[2] - d[2] * e[1],
        d[2] * e[0] - d[0] * e[2],
        d[0] * e[1] - d[1] * e[0],
    ];
    let tip = plus(foot, n, tiny(rng, 40));
    let a = [
        tip,
        plus(plus(tip, n, 1.0), point(rng), 0.5),
        plus(plus(tip, n, 1.0), point(rng), 0.5),
    ];
    (a, b)
}

/// Edges that pass each other at a small distance.
fn crossing_edges(rng: &mut Xoshiro256PlusPlus) -> Pair {
    let gap = tiny(rng, 40);
    let (d, e) = (unit(rng), unit(rng));
    let a = [[-1.0, d, 0.0], [1.0, -d, 0.0], [d, e, -1.0 - d.abs()]];
    let b = [[e, -1.0, gap], [-e, 1.0, gap], [e, d, gap + 1.0 + e.abs()]];
    // A rotation with rounding puts it into general position.
    let turn = |p: Point| {
        [
            0.6 * p[0] - 0.8 * p[2],
            0.28 * p[0] + 0.936 * p[1] + 0.21 * p[2],
            0.77 * p[0] + 0.3 * p[1] + 0.56 * p[2],
        ]
    };
    (a.map(turn), b.map(turn))
}

/// The second is moved so that its centroid lies on the first's.
fn intersecting(rng: &mut Xoshiro256PlusPlus) -> Pair {
    let (a, b) = (triangle(rng), triangle(rng));
    let centre = |t: &[Point; 3]| [0, 1, 2].map(|k| (t[0][k] + t[1][k] + t[2][k]) / 3.0);
    let (from, to) = (centre(&b), centre(&a));
    (a, b.map(|p| plus(plus(p, from, -1.0), to, 1.0)))
}

/// Needles, thin by a factor of up to 1e12.
fn slivers(rng: &mut Xoshiro256PlusPlus) -> Pair {
    let thin = tiny(rng, 41);
    let sliver = |rng: &mut Xoshiro256PlusPlus| {
        let (from, to, along) = (point(rng), point(rng), unit(rng));
        let middle = plus(from, plus(to, from, -1.0), along);
        [from, plus(middle, point(rng), thin), to]
    };
    let shift = point(rng);
    let size = tiny(rng, 30);
    (sliver(rng), sliver(rng).map(|p| plus(p, shift, size)))
}

/// Collinear triangles and points; exactly so, on integers.
fn degenerate(rng: &mut Xoshiro256PlusPlus) -> Pair {
    let flat = |rng: &mut Xoshiro256PlusPlus| {
        let (from, step) = (integers(rng, 1000), integers(rng, 10));
        [
            from,
            plus(from, step, below(rng, 5) as f64),
            plus(from, step, below(rng, 9) as f64 - 4.0),
        ]
    };
    let b = flat(rng);
    (
        if below(rng, 2) == 0 {
            flat(rng)
        } else {
            triangle(rng).map(|p| p.map(|x| 100.0 * x))
        },
        b,
    )
}

/// Vertices used twice, within a triangle and across.
fn duplicates(rng: &mut Xoshiro256PlusPlus) -> Pair {
    let points = [point(rng), point(rng), point(rng), point(rng)];
    let mut take = |_| points[below(rng, 4) as usize];
    ([0, 1, 2].map(&mut take), [0, 1, 2].map(&mut take))
}

fn integers(rng: &mut Xoshiro256PlusPlus, n: u64) -> Point {
    [0, 1, 2].map(|_| below(rng, 2 * n + 1) as f64 - n as f64)
}

/// Coordinates from -3 to 3: exact ties, coplanar and touching pairs.
fn small_integers(rng: &mut Xoshiro256PlusPlus) -> Pair {
    ([0; 3].map(|_| integers(rng, 3)), [0; 3].map(|_| integers(rng, 3)))
}

fn offsets(rng: &mut Xoshiro256PlusPlus) -> Pair {
    let offset = point(rng).map(|x| x * 10f64.powi(below(rng, 13) as i32));
    let (a, b) = random(rng);
    (a.map(|p| plus(offset, p, 1.0)), b.map(|p| plus(offset, p, 1.0)))
}

fn scales(rng: &mut Xoshiro256PlusPlus) -> Pair {
    let scale = 10f64.powi(below(rng, 301) as i32 - 150);
    let (a, b) = if below(rng, 2) == 0 {
        random(rng)
    } else {
        crossing_edges(rng)
    };
    (a.map(|p| p.map(|x| x * scale)), b.map(|p| p.map(|x| x * scale)))
}

/// Each coordinate has an exponent of its own.
fn mixed_exponents(rng: &mut Xoshiro256PlusPlus) -> Pair {
    let span = [3, 20, 150][below(rng, 3) as usize];
    let mut any = |_| [0; 3].map(|_| unit(rng) * 10f64.powi(below(rng, 2 * span + 1) as i32 - span as i32));
    ([0; 3].map(&mut any), [0; 3].map(&mut any))
}

fn denormals(rng: &mut Xoshiro256PlusPlus) -> Pair {
    let n = [5, 1000, 1 << 40][below(rng, 3) as usize];
    let mut any = |_| [0; 3].map(|_| (below(rng, 2 * n + 1) as f64 - n as f64) * f64::from_bits(1));
    ([0; 3].map(&mut any), [0; 3].map(&mut any))
}

/// Up to one step below `f64::MAX / 2`, the corners taken often.
fn huge(rng: &mut Xoshiro256PlusPlus) -> Pair {
    let most = (f64::MAX / 2.0).next_down();
    let mut any = |_| {
        [0; 3].map(|_| match below(rng, 4) {
            0 => most,
            1 => -most,
            _ => most * unit(rng),
        })
    };
    ([0; 3].map(&mut any), [0; 3].map(&mut any))
}

/// A threshold near the distance `d`: `d (1 +- 2^-k)`, a few steps from it, or a power of two where `d` is 0.
pub fn threshold_near(d: f64, rng: &mut Xoshiro256PlusPlus) -> f64 {
    let d = d.min(f64::MAX);
    let delta = if d == 0.0 {
        [f64::from_bits(1), tiny(rng, 1000), tiny(rng, 60)][below(rng, 3) as usize]
    } else {
        match below(rng, 4) {
            0 => d * (1.0 + tiny(rng, 54)),
            1 => d * (1.0 - tiny(rng, 54)),
            2 => f64::from_bits(
                (d.to_bits() + below(rng, 7))
                    .saturating_sub(3)
                    .min(f64::MAX.to_bits()),
            ),
            _ => d * (2.0 * unit(rng).abs()),
        }
    };
    delta.clamp(f64::from_bits(1), f64::MAX)
}

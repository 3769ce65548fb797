//! The scenes: where bodies are at first, which of them move, and how.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// The radius of a body.
pub(crate) const RADIUS: f64 = 0.4;
/// The longest step of a body in a frame along an axis.
const STEP: f64 = 0.005;

/// A scene before its first frame.
pub(crate) struct Scene {
    pub(crate) name: String,
    pub(crate) centres: Vec<[f64; 3]>,
    /// The radius of body 0, which does not move, if it is larger than the others.
    pub(crate) huge: Option<f64>,
    /// Every so many-th body moves; 0 for none.
    pub(crate) every: usize,
    /// By how much a moving body turns a frame, in radians.
    pub(crate) turn: f64,
    /// Whether triangles are examined too.
    pub(crate) triangles: bool,
}

/// Frames of a scene of so many bodies.
pub(crate) fn frames(bodies: usize) -> usize {
    (1_000_000 / bodies).clamp(24, 200)
}

fn unit(rng: &mut Xoshiro256PlusPlus) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

fn lattice(bodies: usize, spacing: f64) -> Vec<[f64; 3]> {
    let side = (bodies as f64).cbrt().ceil() as usize;
    let at = |n: usize| [n % side, n / side % side, n / side / side].map(|c| c as f64 * spacing);
    (0..bodies).map(at).collect()
}

fn random(bodies: usize, size: f64) -> Vec<[f64; 3]> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(7);
    (0..bodies)
        .map(|_| [(); 3].map(|()| size * unit(&mut rng)))
        .collect()
}

impl Scene {
    fn new(name: impl Into<String>, centres: Vec<[f64; 3]>, every: usize) -> Self {
        Self {
            name: name.into(),
            centres,
            huge: None,
            every,
            turn: 0.0,
            triangles: true,
        }
    }

    /// All scenes of so many bodies.
    pub(crate) fn all(bodies: usize) -> Vec<Self> {
        let side = (bodies as f64).cbrt();
        let mut scenes: Vec<Self> = [(0, "0"), (1000, "0.1 %"), (10, "10 %"), (1, "100 %")]
            .map(|(every, share)| Self::new(format!("lattice, {share} moving"), lattice(bodies, 1.0), every))
            .into();
        scenes.push(Self {
            turn: 0.05,
            ..Self::new("lattice, 100 % moving and turning", lattice(bodies, 1.0), 1)
        });
        // bodies in a pile touch a few others
        let jitter = random(bodies, 0.15);
        let pile = lattice(bodies, 0.78).into_iter().zip(jitter);
        let pile = pile.map(|(p, q)| [p[0] + q[0], p[1] + q[1], p[2] + q[2]]);
        scenes.push(Self {
            triangles: bodies <= 10_000,
            ..Self::new("pile, 100 % moving", pile.collect(), 1)
        });
        let mut around = lattice(bodies, 1.0);
        around[0] = [side / 2.0; 3];
        scenes.push(Self {
            huge: Some(side / 2.0),
            ..Self::new("one huge body, 10 % moving", around, 10)
        });
        let line = (0..bodies).map(|n| [n as f64, 0.0, 0.0]).collect();
        scenes.push(Self::new("in one line, 100 % moving", line, 1));
        scenes.push(Self::new(
            "sparse dust, 10 % moving",
            random(bodies, 5.0 * side),
            10,
        ));
        if bodies <= 1000 {
            scenes.push(Self {
                triangles: false,
                ..Self::new("in one place, 100 % moving", random(bodies, 0.1), 1)
            });
        }
        scenes
    }

    /// Whether a body moves.
    pub(crate) fn moves(&self, body: usize) -> bool {
        self.every > 0 && body.is_multiple_of(self.every) && !(body == 0 && self.huge.is_some())
    }

    /// The radius of a body.
    pub(crate) fn radius(&self, body: usize) -> f64 {
        match self.huge {
            Some(radius) if body == 0 => radius,
            _ => RADIUS,
        }
    }
}

/// Which way bodies go.
pub(crate) struct Course {
    rng: Xoshiro256PlusPlus,
    ways: Vec<[f64; 3]>,
    frame: usize,
}

impl Course {
    pub(crate) fn new(bodies: usize) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(1),
            ways: vec![[0.0; 3]; bodies],
            frame: 0,
        }
    }

    /// Moves the centres of a scene by a frame, and lists the bodies that move.
    pub(crate) fn step(&mut self, scene: &Scene, centres: &mut [[f64; 3]], moved: &mut Vec<usize>) {
        moved.clear();
        for (body, (centre, way)) in centres.iter_mut().zip(&mut self.ways).enumerate() {
            if !scene.moves(body) {
                continue;
            }
            if self.frame.is_multiple_of(8) {
                *way = [(); 3].map(|()| STEP * (2.0 * unit(&mut self.rng) - 1.0));
            }
            *centre = std::array::from_fn(|k| centre[k] + way[k]);
            moved.push(body);
        }
        self.frame += 1;
    }
}

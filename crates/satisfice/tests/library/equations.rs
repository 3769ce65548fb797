//! Engines against their published equations, written out once more without any of their code. Both draw the same random numbers.

#![allow(clippy::unwrap_used, missing_docs)]

use satisfice::engine::{Ask, BoundedSwarms, Descent, EngineConfig, NichingPsoDbscan, Origin, Pso, Spso2011};
use satisfice::testing::BareContext;
use satisfice::{Axis, Batch, Boundary, Context, Engine, Outcome, SearchRng, Space};

const LOWER: [f64; 3] = [-5.0, 0.0, 10.0];
const WIDTHS: [f64; 3] = [10.0, 1.0, 4.0];

fn context() -> BareContext<f64> {
    let axes = [0, 1, 2].map(|j| Axis::continuous(LOWER[j], LOWER[j] + WIDTHS[j]));
    BareContext::new(Space::new(axes).unwrap())
}

/// Least in a corner of the space, so that particles leave it.
fn fitness(x: &[f64]) -> f64 {
    let corner = [-5.0, 1.0, 10.5];
    let terms = (0..3).map(|j| ((x[j] - corner[j]) / WIDTHS[j]).powi(2) * [1.0, 3.0, 0.5][j]);
    terms.sum()
}

/// An engine that is run by hand.
struct Driven {
    engine: Box<dyn Engine<f64>>,
    context: BareContext<f64>,
    rng: SearchRng,
}

impl Driven {
    fn new(settings: &impl EngineConfig) -> (Self, SearchRng) {
        let (context, rng) = (context(), SearchRng::new(5));
        let mut engine = settings.build::<f64>();
        engine.begin(&context);
        let twin = rng.clone();
        (Self { engine, context, rng }, twin)
    }

    /// The next points, put back into the space, and told.
    fn next(&mut self) -> Vec<[f64; 3]> {
        let mut batch = Batch::new(3);
        while batch.is_empty() {
            let said = self.engine.ask(&self.context, &mut self.rng, &mut batch);
            assert_eq!(said, Ask::More);
        }
        for i in 0..batch.len() {
            self.context.space().keep_inside(batch.point_mut(i));
        }
        let outcomes: Vec<_> = batch.points().map(|x| Outcome::Miss(fitness(x))).collect();
        self.engine.tell(&self.context, &batch, &outcomes, Origin::Engine);
        batch.points().map(|x| x.try_into().unwrap()).collect()
    }
}

fn assert_near(found: &[f64; 3], expected: &[f64; 3]) {
    for j in 0..3 {
        assert!(
            (found[j] - expected[j]).abs() < 1e-9 * WIDTHS[j],
            "{found:?} {expected:?}"
        );
    }
}

/// The particles as the equations know them.
struct Particles {
    x: Vec<[f64; 3]>,
    v: Vec<[f64; 3]>,
    p: Vec<[f64; 3]>,
    f: Vec<f64>,
}

impl Particles {
    fn at(x: Vec<[f64; 3]>, v: Vec<[f64; 3]>) -> Self {
        let f = x.iter().map(|x| fitness(x)).collect();
        let p = x.clone();
        Self { x, v, p, f }
    }

    fn best_of(&self, among: impl Iterator<Item = usize>) -> usize {
        among.min_by(|&a, &b| self.f[a].total_cmp(&self.f[b])).unwrap()
    }

    fn evaluate(&mut self, i: usize) {
        let f = fitness(&self.x[i]);
        if f < self.f[i] {
            (self.p[i], self.f[i]) = (self.x[i], f);
        }
    }
}

/// Clerc 2012, sections 3.1 to 3.4: the random topology, the hypersphere round the centre of gravity, the confinement. Lengths are
/// in units of the axes.
#[test]
fn spso_2011_moves_as_published() {
    const N: usize = 7;
    let settings = Spso2011 {
        particles: N,
        ..Spso2011::default()
    };
    let (w, c, k) = (1.0 / (2.0 * 2.0_f64.ln()), 0.5 + 2.0_f64.ln(), 3);
    let (mut driven, mut twin) = Driven::new(&settings);
    let x = driven.next();
    let drawn: Vec<[f64; 3]> = (0..N).map(|_| [0; 3].map(|_| twin.uniform())).collect();
    for (x, u) in x.iter().zip(&drawn) {
        assert_near(x, &[0, 1, 2].map(|j| LOWER[j] + u[j] * WIDTHS[j]));
    }
    // V ~ U(lower - X, upper - X)
    let v: Vec<[f64; 3]> = (0..N)
        .map(|i| [0, 1, 2].map(|j| LOWER[j] + twin.uniform() * WIDTHS[j] - x[i][j]))
        .collect();
    let mut swarm = Particles::at(x, v);
    let (mut links, mut least_before) = (Vec::new(), f64::INFINITY);
    let (mut drawn_anew, mut confined, mut kept) = (0, 0, 0);
    for _ in 0..30 {
        let least = swarm.f[swarm.best_of(0..N)];
        if links.is_empty() || least >= least_before {
            links = (0..N * k).map(|link| (link / k, twin.below(N))).collect();
            drawn_anew += 1;
        } else {
            kept += 1;
        }
        least_before = least;
        for i in 0..N {
            let informants = links.iter().filter(|(_, to)| *to == i).map(|(from, _)| *from);
            let l = swarm.best_of(std::iter::once(i).chain(informants));
            let normal = [0; 3].map(|_| twin.normal());
            let length = normal.iter().map(|z| z * z).sum::<f64>().sqrt();
            let u = twin.uniform();
            let (x, p, best) = (swarm.x[i], swarm.p[i], swarm.p[l]);
            let centre = [0, 1, 2].map(|j| {
                let own = x[j] + c * (p[j] - x[j]);
                let local = x[j] + c * (best[j] - x[j]);
                if l == i {
                    (x[j] + own) / 2.0
                } else {
                    (x[j] + own + local) / 3.0
                }
            });
            let offsets = [0, 1, 2].map(|j| (centre[j] - x[j]) / WIDTHS[j]);
            let radius = u * offsets.iter().map(|d| d * d).sum::<f64>().sqrt();
            for j in 0..3 {
                let (lower, upper) = (LOWER[j], LOWER[j] + WIDTHS[j]);
                let drawn = centre[j] + radius * normal[j] / length * WIDTHS[j];
                let v = w * swarm.v[i][j] + drawn - x[j];
                swarm.v[i][j] = v;
                swarm.x[i][j] = x[j] + v;
                if swarm.x[i][j] < lower || swarm.x[i][j] > upper {
                    swarm.x[i][j] = swarm.x[i][j].clamp(lower, upper);
                    swarm.v[i][j] = -v / 2.0;
                    confined += 1;
                }
            }
            assert_near(&driven.next()[0], &swarm.x[i]);
            swarm.evaluate(i);
        }
    }
    assert!(
        drawn_anew > 1 && kept > 1 && confined > 1,
        "{drawn_anew} {kept} {confined}"
    );
}

/// chi (V + phi/2 r1 (P - X) + phi/2 r2 (G - X)), no longer than `limit` (Clerc, Kennedy 2002).
fn constricted(v: f64, to_best: f64, to_leader: f64, (r1, r2): (f64, f64), limit: f64) -> f64 {
    let phi = 4.1_f64;
    let chi = 2.0 / (2.0 - phi - (phi * phi - 4.0 * phi).sqrt()).abs();
    let v = chi * (v + phi / 2.0 * r1 * to_best + phi / 2.0 * r2 * to_leader);
    v.clamp(-limit, limit)
}

/// A swarm with constriction whose particle `i` is led by `leader`, mirrored at the bounds.
fn moves_with_constriction(settings: &impl EngineConfig, leader: impl Fn(&Particles, usize) -> usize) {
    const N: usize = 6;
    let (mut driven, mut twin) = Driven::new(settings);
    assert_eq!(driven.context.space().boundary(), Boundary::Reflect);
    let x = driven.next();
    for _ in 0..3 * N {
        let _ = twin.uniform(); // the positions
    }
    let v: Vec<[f64; 3]> = (0..N)
        .map(|_| [0, 1, 2].map(|j| WIDTHS[j] / 2.0 * (2.0 * twin.uniform() - 1.0)))
        .collect();
    let mut swarm = Particles::at(x, v);
    let mut mirrored = 0;
    for _ in 0..8 {
        for i in 0..N {
            let g = swarm.p[leader(&swarm, i)];
            for j in 0..3 {
                let (lower, upper) = (LOWER[j], LOWER[j] + WIDTHS[j]);
                let x = swarm.x[i][j];
                let r = (twin.uniform(), twin.uniform());
                let limit = WIDTHS[j] / 2.0;
                let v = constricted(swarm.v[i][j], swarm.p[i][j] - x, g[j] - x, r, limit);
                (swarm.x[i][j], swarm.v[i][j]) = match x + v {
                    moved if moved < lower => (2.0 * lower - moved, -v),
                    moved if moved > upper => (2.0 * upper - moved, -v),
                    moved => (moved, v),
                };
                mirrored += usize::from(swarm.v[i][j] != v);
            }
            assert_near(&driven.next()[0], &swarm.x[i]);
            swarm.evaluate(i);
        }
    }
    assert!(mirrored > 1);
}

#[test]
fn pso_is_led_by_the_best_of_all() {
    let settings = Pso {
        particles: 6,
        ..Pso::default()
    };
    moves_with_constriction(&settings, |swarm, _| swarm.best_of(0..6));
}

#[test]
fn a_niche_is_led_by_its_best_and_an_outlier_by_itself() {
    let with = |eps| NichingPsoDbscan {
        particles: 6,
        eps,
        ..NichingPsoDbscan::default()
    };
    moves_with_constriction(&with(10.0), |swarm, _| swarm.best_of(0..6));
    let still = NichingPsoDbscan {
        still: 0.0,
        ..with(0.0)
    };
    moves_with_constriction(&still, |_, i| i);
}

/// The swarm of one leaf, the whole space: the best of the last sweep leads all, and the edge stops a particle.
#[test]
fn the_swarm_of_a_leaf_moves_as_published() {
    let settings = BoundedSwarms::default();
    let n = settings.particles;
    let (mut driven, mut twin) = Driven::new(&settings);
    let x = driven.next();
    let mut v = vec![[0.0; 3]; n];
    for i in 0..n {
        for j in 0..3 {
            let at = LOWER[j] + twin.uniform() * WIDTHS[j];
            assert!((x[i][j] - at).abs() < 1e-12);
            v[i][j] = WIDTHS[j] / 2.0 * (2.0 * twin.uniform() - 1.0);
        }
    }
    let mut swarm = Particles::at(x, v);
    let mut stopped = 0;
    for _ in 1..settings.sweeps {
        let g = swarm.p[swarm.best_of(0..n)];
        for i in 0..n {
            for j in 0..3 {
                let x = swarm.x[i][j];
                let r = (twin.uniform(), twin.uniform());
                let limit = WIDTHS[j] / 2.0;
                let v = constricted(swarm.v[i][j], swarm.p[i][j] - x, g[j] - x, r, limit);
                let at = (x + v).clamp(LOWER[j], LOWER[j] + WIDTHS[j]);
                let stops = at != x + v;
                (swarm.x[i][j], swarm.v[i][j]) = (at, if stops { -v } else { v });
                stopped += usize::from(stops);
            }
        }
        for (found, expected) in driven.next().iter().zip(&swarm.x) {
            assert_near(found, expected);
        }
        (0..n).for_each(|i| swarm.evaluate(i));
    }
    assert!(stopped > 1);
}

/// Kolda, Lewis, Torczon 2003, section 1.1: poll a step to both sides of each axis, move to a better point, halve the step when none
/// is. The poll continues at the side that was better last.
#[test]
fn a_descent_is_a_compass_search() {
    let settings = Descent::default();
    let (mut driven, mut twin) = Driven::new(&settings);
    let mut x = [0, 1, 2].map(|j| LOWER[j] + twin.uniform() * WIDTHS[j]);
    assert_near(&driven.next()[0], &x);
    let (mut step, mut first, mut halved) = (settings.step, 0, 0);
    while step >= settings.shortest {
        let better = (0..6).map(|turn| (first + turn) % 6).find(|side| {
            let (j, sign) = (side / 2, [-1.0, 1.0][side % 2]);
            let mut poll = x;
            poll[j] = (poll[j] + sign * step * WIDTHS[j]).clamp(LOWER[j], LOWER[j] + WIDTHS[j]);
            if poll == x {
                return false; // a bound
            }
            assert_near(&driven.next()[0], &poll);
            let improves = fitness(&poll) < fitness(&x);
            if improves {
                x = poll;
            }
            improves
        });
        match better {
            Some(side) => first = side,
            None => (step, halved) = (step / 2.0, halved + 1),
        }
    }
    assert_eq!(halved, 18);
    assert!(fitness(&x) < 1e-10, "{x:?}");
}

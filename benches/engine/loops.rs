//! What two engines do, written by hand without the framework: the same numbers drawn, the same hits found.

use foldhash::fast::FixedState;
use hashbrown::HashSet;
use satisfice::{SatisficingProblem, SearchRng};

/// Latest-hit QPSO without the framework: two integer axes, reflection, a set of hits, and nothing else.
pub(crate) fn latest_hit_loop<P>(problem: &P, evaluations: usize, seed: u64) -> usize
where
    P: SatisficingProblem<Scalar = f64, Solution = (u32, u32)>,
{
    const N: usize = 30;
    let width: [f64; 2] = core::array::from_fn(|j| problem.space().axes()[j].end());
    let last = width.map(|w| w - 1.0);
    let threshold = problem.threshold();
    let mut rng = SearchRng::new(seed);
    let mut hits: HashSet<(u32, u32), FixedState> = HashSet::default();
    let decode = |x: &[f64; 2]| problem.decode(&[x[0].floor().min(last[0]), x[1].floor().min(last[1])]);

    let mut positions = [[0.0; 2]; N];
    for x in &mut positions {
        *x = core::array::from_fn(|j| rng.uniform() * width[j]);
    }
    let mut fitness = positions.map(|x| {
        let solution = decode(&x);
        let f = if hits.contains(&solution) {
            f64::INFINITY
        } else {
            problem.fitness(&solution)
        };
        if f < threshold {
            hits.insert(solution);
        }
        f
    });
    let mut bests = positions;
    let mut latest: Option<[f64; 2]> = None;
    let mut leader = (0..N).min_by(|&a, &b| fitness[a].total_cmp(&fitness[b])).unwrap();

    let (mut i, mut mean) = (0, [0.0; 2]);
    for _ in N..evaluations {
        if i == 0 {
            mean = [0.0; 2];
            for best in &bests {
                for j in 0..2 {
                    mean[j] += best[j] * (1.0 / N as f64);
                }
            }
        }
        let attractor = latest.unwrap_or(bests[leader]);
        let mut x = positions[i];
        for j in 0..2 {
            let (phi, negative) = rng.uniform_and_sign();
            let centre = attractor[j] + phi * (bests[i][j] - attractor[j]);
            let spread = (mean[j] - x[j]).abs() * rng.exponential();
            x[j] = if negative {
                centre - spread
            } else {
                centre + spread
            };
            if !(0.0..=width[j]).contains(&x[j]) {
                let rest = x[j].abs() % (2.0 * width[j]);
                x[j] = if rest > width[j] {
                    width[j] - (rest - width[j])
                } else {
                    rest
                };
            }
        }
        positions[i] = x;
        let solution = decode(&x);
        if !hits.contains(&solution) {
            let f = problem.fitness(&solution);
            if f < threshold {
                hits.insert(solution);
                latest = Some(x);
                bests[i] = x;
                fitness[i] = f;
            } else if f < fitness[i] {
                bests[i] = x;
                fitness[i] = f;
                if f < fitness[leader] {
                    leader = i;
                }
            }
        }
        i = if i + 1 == N { 0 } else { i + 1 };
    }
    hits.len()
}

/// Uniform sampling without the framework.
pub(crate) fn random_loop<P>(problem: &P, evaluations: usize, seed: u64) -> usize
where
    P: SatisficingProblem<Scalar = f64, Solution = (u32, u32)>,
{
    let width: [f64; 2] = core::array::from_fn(|j| problem.space().axes()[j].end());
    let mut rng = SearchRng::new(seed);
    let mut hits: HashSet<(u32, u32), FixedState> = HashSet::default();
    for _ in 0..evaluations {
        let x = width.map(|w| (rng.uniform() * w).floor().min(w - 1.0));
        let solution = problem.decode(&x);
        if !hits.contains(&solution) && problem.fitness(&solution) < problem.threshold() {
            hits.insert(solution);
        }
    }
    hits.len()
}

//! Root problems: every root is found from the threshold, and nothing else; bounds are sound.
#![allow(clippy::unwrap_used, missing_docs)]

use satisfice::catalogue::{Catalogued, Params};
use satisfice::{Region, SatisficingProblem, SearchRng};
use satisfice_problems::{Himmelblau, Roots};

fn problem<P: Catalogued>(settings: &[(&str, &str)]) -> P {
    P::from_params(&Params::with(P::PARAMETERS, P::NAME, settings.iter().copied()).unwrap()).unwrap()
}

/// Points of a fine grid with F below the threshold, polished: the distinct roots, each at least `apart` from the others.
fn roots_on_grid<P>(problem: &P, steps: usize, level: f64, apart: f64) -> Vec<Vec<f64>>
where
    P: Catalogued<Scalar = f64, Solution = satisfice::Located<f64>>,
{
    let [a, b] = problem.space().axes() else {
        panic!("two unknowns")
    };
    let mut roots: Vec<Vec<f64>> = Vec::new();
    for i in 0..=steps {
        for j in 0..=steps {
            let x = a.lower() + a.width() * i as f64 / steps as f64;
            let y = b.lower() + b.width() * j as f64 / steps as f64;
            let hit = problem.decode(&[x, y]);
            if problem.fitness(&hit) >= level {
                continue;
            }
            let root = problem.canonical(&hit).unwrap_or(hit);
            assert!(problem.fitness(&root) < 1e-20, "{root:?} is no root");
            let root = root.coordinates;
            let near = |other: &Vec<f64>| (other[0] - root[0]).hypot(other[1] - root[1]);
            match roots.iter().map(near).fold(f64::INFINITY, f64::min) {
                distance if distance > apart => roots.push(root),
                distance => assert!(distance < 1e-9, "{distance}"),
            }
        }
    }
    roots
}

fn bounds_are_sound<P>(problem: &P)
where
    P: Catalogued<Scalar = f64, Solution = satisfice::Located<f64>>,
{
    let mut rng = SearchRng::new(17);
    for trial in 0..5_000 {
        let scale = [1.0, 0.1, 1e-3, 0.0][trial % 4];
        let (mut lower, mut upper) = (Vec::new(), Vec::new());
        for axis in problem.space().axes() {
            let (a, b) = (axis.at(rng.uniform()), axis.at(rng.uniform()));
            lower.push(a.min(b));
            upper.push(a.min(b) + scale * (a - b).abs());
        }
        let region = Region { lower, upper };
        let bound = problem.bounds().unwrap().lower_bound(&region).unwrap();
        for _ in 0..10 {
            let inside = region.lower.iter().zip(&region.upper);
            let values: Vec<f64> = inside
                .map(|(a, b)| (a + rng.uniform() * (b - a)).min(*b))
                .collect();
            let fitness = problem.fitness(&problem.decode(&values));
            assert!(bound <= fitness, "{bound} > {fitness} in {region:?}");
            if scale == 0.0 {
                assert!(fitness - bound <= 1e-12 * fitness.max(1.0));
            }
        }
    }
}

#[test]
fn himmelblau() {
    let himmelblau = problem::<Himmelblau>(&[]);
    bounds_are_sound(&himmelblau);
    let mut roots = roots_on_grid(&himmelblau, 600, 10.0, 3.5);
    roots.sort_by(|a, b| a[0].total_cmp(&b[0]));
    assert_eq!(himmelblau.reference_hits(), Some(roots.len() as u64));
    for (root, known) in roots.iter().zip([
        [-3.779_310_253_377_747, -3.283_185_991_286_17],
        [-2.805_118_086_952_745, 3.131_312_518_250_573],
        [3.0, 2.0],
        [3.584_428_340_330_492, -1.848_126_526_964_404],
    ]) {
        approx::assert_relative_eq!(root[..], known[..], max_relative = 1e-12);
    }
    let at = |x: f64, y: f64| himmelblau.fitness(&himmelblau.decode(&[x, y]));
    approx::assert_relative_eq!(
        at(1.0, 2.0),
        (1.0_f64 + 2.0 - 11.0).powi(2) + (1.0_f64 + 4.0 - 7.0).powi(2)
    );
    assert!(himmelblau.fitness(&satisfice::Located::new(&[1.0], 0.5)).is_nan());
}

#[test]
fn roots() {
    let roots = problem::<Roots>(&[]);
    bounds_are_sound(&roots);
    assert_eq!(roots_on_grid(&roots, 800, 0.01, 0.05).len(), 144);
    assert_eq!(roots.reference_hits(), Some(144));
    assert_eq!(problem::<Roots>(&[("threshold", "1")]).reference_hits(), None);
}

/// Through the search: hits are polished, counted once, and deleted with all that is near them.
#[test]
fn a_swarm_finds_all_four() {
    let himmelblau = problem::<Himmelblau>(&[]);
    let engine = satisfice::engine::LatestHitQpso::default();
    let budget = satisfice::Budget::evaluations(100_000).and_hits(4);
    let report = satisfice::Search::with(engine)
        .seed(1)
        .run(&himmelblau, &budget)
        .unwrap();
    assert_eq!(report.hit_count(), 4);
    assert!(report.hits().all(|hit| himmelblau.fitness(hit.solution) < 1e-20));
}

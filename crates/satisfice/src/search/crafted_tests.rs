//! The state of an engine with a wrong byte, past the checksum of its checkpoint: it is refused, or the search goes on to its end. Which byte of which engine
//! does harm was looked for with 600 random ones for each engine and space; `TRIALS=600` does so again, in a quarter of an hour.

use super::RunOptions;
use crate::engine::{self, EngineSpec};
use crate::identity::Located;
use crate::problem::{SatisficingProblem, from_fn};
use crate::seed::SearchRng;
use crate::space::{Axis, Space};
use crate::{Budget, Search};

const SPACES: [&str; 4] = ["lattice", "square", "mixed", "permutation"];

fn problem(name: &str) -> impl SatisficingProblem<Scalar = f64, Solution = Located<f64>> {
    let space = match name {
        "lattice" => Space::lattice(3, 40),
        "square" => Space::cube(2, -2.0, 2.0),
        "permutation" => Space::new(Axis::permutation(9)),
        _ => Space::new([
            Axis::integer(-3, 3),
            Axis::continuous(-2.0, 2.0),
            Axis::categorical(4),
        ]),
    };
    let ring = |x: &[f64]| {
        let pairs = x.iter().zip([0.1, 0.2, 0.3].into_iter().cycle());
        (pairs
            .map(|(x, middle)| (x - middle) * (x - middle))
            .sum::<f64>()
            .sqrt()
            - 1.2)
            .abs()
    };
    from_fn(space.unwrap(), 0.3, ring).separation(0.02)
}

/// Saves a search in its middle, changes one byte of its engine's state, and goes on.
fn trials(entry: &EngineSpec, space: &str, trials: usize, rng: &mut SearchRng) {
    let problem = problem(space);
    let (evaluations, planned) = match entry.expensive_proposals {
        true => (30, 30),
        false => (200, 20_000),
    };
    let budget = Budget::evaluations(evaluations).with_horizon(planned);
    let mut search = Search::with(entry.configure([]).unwrap()).seed(9);
    let mut slice = search.start(&problem, &budget).unwrap();
    let mut told = 0;
    while told < evaluations / 2 {
        let values: Vec<f64> = slice.ask().unwrap().iter().map(|x| problem.fitness(x)).collect();
        told += values.len() as u64;
        slice.tell(&values).unwrap();
    }
    let saved = slice.checkpoint();
    for _ in 0..trials {
        let mut other = saved.clone();
        let state = &mut other.contents.lanes[0].0;
        let place = rng.below(state.len());
        state[place] = match rng.below(4) {
            0 => 0xff,
            1 => 0,
            2 => state[place].wrapping_add(1),
            _ => u8::try_from(rng.below(256)).unwrap(),
        };
        let Ok(mut resumed) = Search::resume(other, entry.configure([]).unwrap()) else {
            continue;
        };
        let report = resumed.run_resumed(&problem, RunOptions::new()).unwrap();
        assert!(report.counts.evaluations <= evaluations, "{} {space}", entry.name);
    }
}

#[test]
fn a_wrong_byte_of_an_engine_does_no_harm() {
    let count = std::env::var("TRIALS").map_or(20, |count| count.parse().unwrap());
    let mut rng = SearchRng::new(7);
    for entry in engine::all() {
        for space in SPACES {
            trials(entry, space, count, &mut rng);
        }
    }
}

//! How large a checkpoint is.

use satisfice::engine::{self, EngineSpec};
use satisfice::space::Axis;
use satisfice::{Budget, Encoding, Located, Neighbourhood, SatisficingProblem, Search, Space, from_fn};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::quick;

/// Bytes of a checkpoint for each hit, and beside them.
const A_HIT: usize = 200;
const BESIDE: usize = 1_000_000;

#[test]
fn a_checkpoint_takes_few_bytes_a_hit() {
    let shell = from_fn(Space::lattice(3, 60).unwrap(), 1.0, |x: &[f64]| {
        let square: f64 = x.iter().map(|x| (x - 29.5) * (x - 29.5)).sum();
        (square.sqrt() - 20.0).abs()
    });
    // With so many hits the rest is the smaller part.
    let most = most_hits(&shell, 30_000);
    assert!(most > 8_000, "{most}");
}

/// The ball of radius `delta.sqrt()` in a cube.
fn ball(axes: usize, delta: f64) -> impl SatisficingProblem<Scalar = f64, Solution = Located<f64>> {
    from_fn(Space::cube(axes, -1.0, 1.0).unwrap(), delta, |x: &[f64]| {
        x.iter().map(|x| (x - 0.1) * (x - 0.1)).sum()
    })
}

#[test]
fn coordinates_of_many_digits_do_not_make_it_longer() {
    let most = most_hits(&ball(6, 0.5), 30_000);
    assert!(most > 20_000, "{most}");
}

#[test]
fn many_axes_do_not_make_that_of_the_default_longer() {
    assert!(hits_of(engine::find("portfolio").unwrap(), &ball(20, 0.1), 30_000) > 0);
}

/// Any order of the keys stands for a permutation: what is kept is its rank.
#[test]
fn permutations_do_not_make_it_longer() {
    const PLACES: u32 = 30;
    let space = Space::new(Axis::permutation(PLACES)).unwrap();
    let detours = from_fn(space, f64::from(PLACES * PLACES / 3), |x: &[f64]| {
        x.windows(2).map(|pair| (pair[0] - pair[1]).abs()).sum()
    });
    let most = most_hits(&detours, 10_000);
    assert!(most > 7_000, "{most}");
}

/// Runs every engine and looks at the size of its checkpoint; the most hits of any.
fn most_hits<P>(problem: &P, evaluations: u64) -> usize
where
    P: SatisficingProblem<Scalar = f64, Solution: Serialize + DeserializeOwned>,
{
    quick()
        .map(|entry| hits_of(entry, problem, evaluations))
        .max()
        .unwrap()
}

/// Runs an engine and looks at the size of its checkpoint; its hits.
fn hits_of<P>(entry: &EngineSpec, problem: &P, evaluations: u64) -> usize
where
    P: SatisficingProblem<Scalar = f64, Solution: Serialize + DeserializeOwned>,
{
    let mut search = Search::with(entry.configure([]).unwrap()).seed(5);
    let report = search.run(problem, &Budget::evaluations(evaluations)).unwrap();
    let bytes = serde_json::to_vec(&search.checkpoint()).unwrap().len();
    let hits = report.hit_count();
    assert!(
        bytes <= A_HIT * hits + BESIDE,
        "{}: {bytes} bytes for {hits} hits",
        entry.name
    );
    hits
}

/// Queens on a board: a row for each column. Neighbours move one of them.
struct Queens {
    space: Space<f64>,
}

const QUEENS: usize = 8;

impl SatisficingProblem for Queens {
    type Scalar = f64;
    type Solution = Vec<u8>;
    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> Vec<u8> {
        values.iter().map(|&x| x as u8).collect()
    }
    fn fitness(&self, rows: &Vec<u8>) -> f64 {
        let attack = |i: usize, j: usize| {
            let apart = rows[i].abs_diff(rows[j]);
            apart == 0 || usize::from(apart) == j - i
        };
        let pairs = (0..QUEENS).flat_map(|j| (0..j).map(move |i| (i, j)));
        pairs.filter(|&(i, j)| attack(i, j)).count() as f64
    }
    fn threshold(&self) -> f64 {
        0.5
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, Vec<u8>>> {
        Some(self)
    }
    fn neighbourhood(&self) -> Option<&dyn Neighbourhood<Vec<u8>>> {
        Some(self)
    }
}

impl Encoding<f64, Vec<u8>> for Queens {
    fn encode(&self, rows: &Vec<u8>, values: &mut [f64]) -> bool {
        values
            .iter_mut()
            .zip(rows)
            .for_each(|(x, &row)| *x = f64::from(row));
        true
    }
}

impl Neighbourhood<Vec<u8>> for Queens {
    fn count(&self, _: &Vec<u8>) -> usize {
        QUEENS * QUEENS
    }
    fn neighbour(&self, of: &Vec<u8>, index: usize) -> Option<Vec<u8>> {
        let mut moved = of.clone();
        *moved.get_mut(index / QUEENS)? = (index % QUEENS) as u8;
        (moved != *of).then_some(moved)
    }
}

/// Millions of neighbours are predicted, of which only the best are kept.
#[test]
fn neighbours_take_no_room_in_a_checkpoint() {
    let queens = Queens {
        space: Space::lattice(QUEENS, 8).unwrap(),
    };
    let most = most_hits(&queens, 30_000);
    assert!(most > 20, "{most}");
}

//! A hundred thousand axes: the memory of every engine is linear in them, so that it ends soon after its deadline.

#![allow(clippy::unwrap_used, reason = "a test")]

use allocation_counter::measure;
use satisfice::{Budget, Encoding, Neighbourhood, SatisficingProblem, Search, Space, engine};

/// F: the share of coordinates above their middle; no hit exists. Neighbours, if declared, exchange two coordinates.
struct Many {
    space: Space<f64>,
    neighbours: bool,
}

impl SatisficingProblem for Many {
    type Scalar = f64;
    type Solution = Vec<u32>;
    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> Vec<u32> {
        values.iter().map(|&x| (4.0 * x) as u32).collect()
    }
    fn fitness(&self, solution: &Vec<u32>) -> f64 {
        solution.iter().filter(|&&x| x > 1).count() as f64 / solution.len() as f64
    }
    fn threshold(&self) -> f64 {
        1e-9
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, Vec<u32>>> {
        Some(self)
    }
    fn neighbourhood(&self) -> Option<&dyn Neighbourhood<Vec<u32>>> {
        self.neighbours.then_some(self as _)
    }
}

impl Encoding<f64, Vec<u32>> for Many {
    fn encode(&self, solution: &Vec<u32>, values: &mut [f64]) -> bool {
        for (value, &x) in values.iter_mut().zip(solution) {
            *value = f64::from(x) / 4.0;
        }
        true
    }
}

impl Neighbourhood<Vec<u32>> for Many {
    fn count(&self, of: &Vec<u32>) -> usize {
        of.len() * of.len()
    }
    fn neighbour(&self, of: &Vec<u32>, index: usize) -> Option<Vec<u32>> {
        (index < self.count(of)).then(|| {
            let mut neighbour = of.clone();
            neighbour.swap(index / of.len(), index % of.len());
            neighbour
        })
    }
}

/// What no engine exceeds: a swarm of forty has some vectors a particle, and regions may take a gigabyte at any number of axes.
const BYTES_AN_AXIS: u64 = 4096;
const BYTES: u64 = 1 << 30;

/// Ten points: some milliseconds of drawing them, between two looks at the clock.
const COORDINATES_AT_ONCE: usize = 1 << 20;

/// The clock is read between two batches.
#[test]
fn memory_is_linear_in_the_axes_and_no_batch_has_many_coordinates() {
    let axes = 100_000;
    let cube = || Space::cube(axes, 0.0, 1.0).unwrap();
    let too_much: Vec<String> = [
        ("lattice", Space::lattice(axes, 2).unwrap(), false),
        ("cube", cube(), false),
        ("neighbours", cube(), true),
    ]
    .into_iter()
    .flat_map(|(name, space, neighbours)| {
        let problem = Many { space, neighbours };
        engine::all().iter().filter_map(move |spec| {
            let mut most = 0;
            let memory = measure(|| {
                // Two batches of most swarms. An engine that lists all neighbours, or has a matrix, does not get so far.
                let mut search = Search::named(spec.name).unwrap().seed(1);
                most = largest_batch(&mut search, &problem, &Budget::evaluations(64));
            });
            let bytes = memory.bytes_max;
            (bytes > BYTES_AN_AXIS * axes as u64 + BYTES || most * axes > COORDINATES_AT_ONCE)
                .then(|| format!("{} on the {name}: {bytes} bytes, {most} points", spec.name))
        })
    })
    .collect();
    assert!(too_much.is_empty(), "{}", too_much.join("\n"));
}

/// Searches, and returns the points of the largest batch.
fn largest_batch(search: &mut Search<Many>, problem: &Many, budget: &Budget) -> usize {
    let mut stepper = search.start(problem, budget).unwrap();
    let mut most = 0;
    loop {
        let batch = stepper.ask().unwrap();
        if batch.is_empty() {
            return most;
        }
        most = most.max(batch.len());
        let fitness: Vec<f64> = batch.iter().map(|solution| problem.fitness(solution)).collect();
        stepper.tell(&fitness).unwrap();
    }
}

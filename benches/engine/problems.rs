//! Problems whose fitness costs next to nothing, or ten microseconds.
#![expect(clippy::disallowed_methods, reason = "a bench asks the time")]

use satisfice::{Encoding, Neighbourhood};
use std::hint::black_box;
use std::time::Instant;

use satisfice::{SatisficingProblem, Space};

/// Two indices, and hits in a diamond of 1,200 of a million points: next to nothing to compute.
pub(crate) struct Lattice(Space<f64>);

impl Lattice {
    pub(crate) fn new() -> Self {
        Self(Space::lattice(2, 1000).unwrap())
    }
}

impl SatisficingProblem for Lattice {
    type Scalar = f64;
    type Solution = (u32, u32);
    fn space(&self) -> &Space<f64> {
        &self.0
    }
    #[inline]
    fn decode(&self, values: &[f64]) -> (u32, u32) {
        (values[0] as u32, values[1] as u32)
    }
    #[inline]
    fn fitness(&self, &(i, j): &(u32, u32)) -> f64 {
        (f64::from(i) - 700.0).abs() + (f64::from(j) - 300.0).abs()
    }
    fn threshold(&self) -> f64 {
        25.0
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, (u32, u32)>> {
        Some(self)
    }
    fn neighbourhood(&self) -> Option<&dyn Neighbourhood<(u32, u32)>> {
        Some(self)
    }
}

impl Encoding<f64, (u32, u32)> for Lattice {
    fn encode(&self, &(i, j): &(u32, u32), values: &mut [f64]) -> bool {
        values.copy_from_slice(&[f64::from(i), f64::from(j)]);
        true
    }
}

impl Neighbourhood<(u32, u32)> for Lattice {
    fn count(&self, _: &(u32, u32)) -> usize {
        4
    }

    fn neighbour(&self, &(i, j): &(u32, u32), index: usize) -> Option<(u32, u32)> {
        let (k, l) = match index {
            0 => (i.wrapping_sub(1), j),
            1 => (i + 1, j),
            2 => (i, j.wrapping_sub(1)),
            3 => (i, j + 1),
            _ => return None,
        };
        (k < 1000 && l < 1000).then_some((k, l))
    }
}

/// The lattice, with arithmetic of ten microseconds before each answer.
pub(crate) struct Slow {
    lattice: Lattice,
    /// Steps of arithmetic that take ten microseconds on this machine.
    steps: usize,
}

impl Slow {
    /// Finds out how much arithmetic that is: the fastest of some tries, each of about a millisecond.
    pub(crate) fn new() -> Self {
        const STEPS: usize = 100_000;
        let fastest = (0..20).map(|_| {
            let start = Instant::now();
            black_box(chain(STEPS));
            start.elapsed().as_secs_f64()
        });
        let seconds = fastest.fold(f64::INFINITY, f64::min).max(1e-6);
        Self {
            lattice: Lattice::new(),
            steps: (10e-6 / seconds * STEPS as f64) as usize,
        }
    }
}

/// A chain of divisions, sums and stores of some nanoseconds each, which is always 0.
fn chain(steps: usize) -> f64 {
    let mut x = 1.0_f64;
    for _ in 0..steps {
        x = black_box(1.0 + 1.0 / x);
    }
    0.0 * x
}

impl SatisficingProblem for Slow {
    type Scalar = f64;
    type Solution = (u32, u32);
    fn space(&self) -> &Space<f64> {
        self.lattice.space()
    }
    fn decode(&self, values: &[f64]) -> (u32, u32) {
        self.lattice.decode(values)
    }
    fn fitness(&self, solution: &(u32, u32)) -> f64 {
        self.lattice.fitness(solution) + chain(self.steps)
    }
    fn threshold(&self) -> f64 {
        self.lattice.threshold()
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, (u32, u32)>> {
        self.lattice.encoding()
    }
    fn neighbourhood(&self) -> Option<&dyn Neighbourhood<(u32, u32)>> {
        self.lattice.neighbourhood()
    }
}

/// Cells of an axis of a [`Wide`] lattice.
const CELLS: u32 = 20;

/// A lattice of many axes whose solutions are bytes; about half of its points are hits.
pub(crate) struct Wide(Space<f64>);

impl Wide {
    pub(crate) fn new(axes: usize) -> Self {
        Self(Space::lattice(axes, CELLS).unwrap())
    }

    /// The same with solutions as [`satisfice::from_fn`] makes them.
    pub(crate) fn located(axes: usize) -> impl SatisficingProblem<Scalar = f64> {
        let space = Space::lattice(axes, CELLS).unwrap();
        satisfice::from_fn(space, Self::middle(axes), |x: &[f64]| x.iter().sum())
    }

    fn middle(axes: usize) -> f64 {
        axes as f64 * f64::from(CELLS - 1) / 2.0
    }
}

impl SatisficingProblem for Wide {
    type Scalar = f64;
    type Solution = Vec<u8>;
    fn space(&self) -> &Space<f64> {
        &self.0
    }
    fn decode(&self, values: &[f64]) -> Vec<u8> {
        values.iter().map(|&x| x as u8).collect()
    }
    fn decode_into(&self, values: &[f64], solution: &mut Vec<u8>) {
        solution.clear();
        solution.extend(values.iter().map(|&x| x as u8));
    }
    fn fitness(&self, solution: &Vec<u8>) -> f64 {
        solution.iter().map(|&x| f64::from(x)).sum()
    }
    fn threshold(&self) -> f64 {
        Self::middle(self.0.dimension())
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, Vec<u8>>> {
        Some(self)
    }
}

impl Encoding<f64, Vec<u8>> for Wide {
    fn encode(&self, solution: &Vec<u8>, values: &mut [f64]) -> bool {
        for (value, &x) in values.iter_mut().zip(solution) {
            *value = f64::from(x);
        }
        true
    }
}

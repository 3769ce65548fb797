//! Problems whose fitness costs next to nothing, or ten microseconds.

use std::hint::black_box;

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
    fn encode(&self, &(i, j): &(u32, u32), values: &mut [f64]) -> bool {
        values.copy_from_slice(&[f64::from(i), f64::from(j)]);
        true
    }
    fn neighbours(&self, &(i, j): &(u32, u32), visit: &mut dyn FnMut((u32, u32))) -> bool {
        for (k, l) in [
            (i.wrapping_sub(1), j),
            (i + 1, j),
            (i, j.wrapping_sub(1)),
            (i, j + 1),
        ] {
            if k < 1000 && l < 1000 {
                visit((k, l));
            }
        }
        true
    }
}

/// The lattice, with arithmetic of about ten microseconds before each answer.
pub(crate) struct Slow(Lattice);

impl Slow {
    pub(crate) fn new() -> Self {
        Self(Lattice::new())
    }
}

impl SatisficingProblem for Slow {
    type Scalar = f64;
    type Solution = (u32, u32);
    fn space(&self) -> &Space<f64> {
        self.0.space()
    }
    fn decode(&self, values: &[f64]) -> (u32, u32) {
        self.0.decode(values)
    }
    fn fitness(&self, solution: &(u32, u32)) -> f64 {
        let mut x = 1.0_f64;
        for _ in 0..1000 {
            // A chain of divisions, sums and stores of some 10 ns each.
            x = black_box(1.0 + 1.0 / x);
        }
        self.0.fitness(solution) + 0.0 * x
    }
    fn threshold(&self) -> f64 {
        self.0.threshold()
    }
    fn encode(&self, solution: &(u32, u32), values: &mut [f64]) -> bool {
        self.0.encode(solution, values)
    }
    fn neighbours(&self, of: &(u32, u32), visit: &mut dyn FnMut((u32, u32))) -> bool {
        self.0.neighbours(of, visit)
    }
}

//! A search among regions that are one answer each, saved and resumed.

use super::interrupts::Interrupt;
use super::*;

const CENTRES: [[f64; 3]; 5] = [
    [0.2, 0.3, 0.25],
    [0.75, 0.3, 0.6],
    [0.25, 0.8, 0.7],
    [0.7, 0.75, 0.2],
    [0.3, 0.35, 0.8],
];

/// Balls that are represented by their centres.
struct Balls {
    space: Space<f64>,
    interrupt: Interrupt,
}

impl Balls {
    /// The nearest centre and its distance, in radii.
    fn nearest(x: &[f64]) -> ([f64; 3], f64) {
        let square = |c: &[f64; 3]| c.iter().zip(x).map(|(c, x)| (c - x).powi(2)).sum::<f64>();
        let nearest = CENTRES
            .into_iter()
            .min_by(|a, b| square(a).total_cmp(&square(b)))
            .unwrap();
        (nearest, square(&nearest).sqrt() / 0.15)
    }
}

impl SatisficingProblem for Balls {
    type Scalar = f64;
    type Solution = Located<f64>;
    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> Located<f64> {
        Located::new(values, 0.2)
    }
    fn fitness(&self, at: &Located<f64>) -> f64 {
        self.interrupt.count();
        Self::nearest(&at.coordinates).1
    }
    fn threshold(&self) -> f64 {
        1.0
    }
    fn canonical(&self, hit: &Located<f64>) -> Option<Located<f64>> {
        Some(Located::new(&Self::nearest(&hit.coordinates).0, 0.2))
    }
}

fn balls(interrupt: Interrupt) -> Balls {
    Balls {
        space: Space::cube(3, 0.0, 1.0).unwrap(),
        interrupt,
    }
}

#[test]
fn after_an_interrupt_with_regions_that_are_one_answer() {
    interrupts::do_not_change_the_report(balls, [9, 17, 30, 44, 59], 3);
}

//! A search by the components of F that is saved and resumed.

use satisfice::Components;

use super::interrupts::Interrupt;
use super::*;

/// Where a sphere, a plane and a wave meet, on one integer axis and two continuous ones.
struct Meetings {
    space: Space<f64>,
    interrupt: Interrupt,
}

const LIMIT: f64 = 0.05;

fn residuals(x: &[f64]) -> [f64; 2] {
    if x[1] > 1.8 {
        // A patch without a number.
        return [f64::NAN, 0.1];
    }
    let radius = x[0] * x[0] / 9.0 + x[1] * x[1] + x[2] * x[2] - 1.5;
    [radius, (2.0 * x[1]).sin() - x[2]]
}

impl SatisficingProblem for Meetings {
    type Scalar = f64;
    type Solution = Located<f64>;
    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> Located<f64> {
        Located::new(values, 0.1)
    }
    fn fitness(&self, at: &Located<f64>) -> f64 {
        self.interrupt.count();
        let [a, b] = residuals(&at.coordinates);
        if a.is_nan() { a } else { a.hypot(b) }
    }
    fn threshold(&self) -> f64 {
        LIMIT
    }
    fn components(&self) -> Option<&dyn Components<f64, Located<f64>>> {
        Some(self)
    }
}

impl Components<f64, Located<f64>> for Meetings {
    fn count(&self) -> usize {
        2
    }
    fn write(&self, at: &Located<f64>, components: &mut [f64]) {
        components.copy_from_slice(&residuals(&at.coordinates).map(|residual| residual / LIMIT));
    }
}

fn meetings(interrupt: Interrupt) -> Meetings {
    let axes = [
        Axis::integer(-3, 3),
        Axis::continuous(-2.0, 2.0),
        Axis::continuous(-2.0, 2.0),
    ];
    Meetings {
        space: Space::new(axes).unwrap(),
        interrupt,
    }
}

#[test]
fn after_an_interrupt_with_a_model_of_the_components() {
    // It searches by them: of uniform points fewer than one in a hundred hits.
    interrupts::do_not_change_the_report(meetings, [3, 17, 30, 44, 59], 3);
}

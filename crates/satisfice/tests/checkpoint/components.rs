//! A search by the components of F that is saved and resumed.

use satisfice::Components;

use super::*;

/// Where a sphere, a plane and a wave meet, on one integer axis and two continuous ones; call number `fatal` cancels.
struct Meetings<'a> {
    space: Space<f64>,
    calls: AtomicU64,
    fatal: u64,
    cancel: &'a Cancel,
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

impl SatisficingProblem for Meetings<'_> {
    type Scalar = f64;
    type Solution = Located<f64>;
    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> Located<f64> {
        Located::new(values, 0.1)
    }
    fn fitness(&self, at: &Located<f64>) -> f64 {
        if self.calls.fetch_add(1, Ordering::Relaxed) + 1 == self.fatal {
            self.cancel.cancel();
        }
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

impl Components<f64, Located<f64>> for Meetings<'_> {
    fn count(&self) -> usize {
        2
    }
    fn write(&self, at: &Located<f64>, components: &mut [f64]) {
        components.copy_from_slice(&residuals(&at.coordinates).map(|residual| residual / LIMIT));
    }
}

fn meetings(cancel: &Cancel, fatal: u64) -> Meetings<'_> {
    let axes = [
        Axis::integer(-3, 3),
        Axis::continuous(-2.0, 2.0),
        Axis::continuous(-2.0, 2.0),
    ];
    Meetings {
        space: Space::new(axes).unwrap(),
        calls: AtomicU64::new(0),
        fatal,
        cancel,
    }
}

#[test]
fn after_an_interrupt_with_a_model_of_the_components() {
    let budget = Budget::evaluations(60);
    for name in ["surrogate", "portfolio"] {
        let entry = engine::find(name).unwrap();
        let never = Cancel::new();
        let expected = search(entry, 0.0).run(&meetings(&never, 0), &budget).unwrap();
        // It searches by them: of uniform points fewer than one in a hundred hits.
        assert!(expected.hit_count() >= 3, "{name}: {}", expected.hit_count());
        for fatal in [3, 17, 30, 44, 59] {
            let cancel = Cancel::new();
            let problem = meetings(&cancel, fatal);
            let mut kept: Option<Saved> = None;
            let mut first = search(entry, 0.0);
            let report = first
                .run_with(
                    &problem,
                    &budget.clone().and_until(&cancel),
                    RunOptions::new()
                        .checkpoints(Duration::MAX, &mut |saved: &Saved| kept = Some(saved.clone())),
                )
                .unwrap();
            assert_eq!(report.stop_reason, StopReason::Cancelled, "{name} at {fatal}");
            let mut again = resume(entry, &kept.unwrap());
            let report = again.run_resumed(&problem, RunOptions::new()).unwrap();
            assert_eq!(timeless(&report), timeless(&expected), "{name} at {fatal}");
        }
    }
}

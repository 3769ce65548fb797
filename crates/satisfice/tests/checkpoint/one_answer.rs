//! A search among regions that are one answer each, saved and resumed.

use super::*;

const CENTRES: [[f64; 3]; 5] = [
    [0.2, 0.3, 0.25],
    [0.75, 0.3, 0.6],
    [0.25, 0.8, 0.7],
    [0.7, 0.75, 0.2],
    [0.3, 0.35, 0.8],
];

/// Balls that are represented by their centres; call number `fatal` cancels.
struct Balls<'a> {
    space: Space<f64>,
    calls: AtomicU64,
    fatal: u64,
    cancel: &'a Cancel,
}

impl Balls<'_> {
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

impl SatisficingProblem for Balls<'_> {
    type Scalar = f64;
    type Solution = Located<f64>;
    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> Located<f64> {
        Located::new(values, 0.2)
    }
    fn fitness(&self, at: &Located<f64>) -> f64 {
        if self.calls.fetch_add(1, Ordering::Relaxed) + 1 == self.fatal {
            self.cancel.cancel();
        }
        Self::nearest(&at.coordinates).1
    }
    fn threshold(&self) -> f64 {
        1.0
    }
    fn canonical(&self, hit: &Located<f64>) -> Option<Located<f64>> {
        Some(Located::new(&Self::nearest(&hit.coordinates).0, 0.2))
    }
}

fn balls(cancel: &Cancel, fatal: u64) -> Balls<'_> {
    Balls {
        space: Space::cube(3, 0.0, 1.0).unwrap(),
        calls: AtomicU64::new(0),
        fatal,
        cancel,
    }
}

#[test]
fn after_an_interrupt_with_regions_that_are_one_answer() {
    let budget = Budget::evaluations(60);
    for name in ["surrogate", "portfolio"] {
        let entry = engine::find(name).unwrap();
        let never = Cancel::new();
        let expected = search(entry, 0.0).run(&balls(&never, 0), &budget).unwrap();
        assert!(expected.hit_count() >= 3, "{name}: {}", expected.hit_count());
        for fatal in [9, 17, 30, 44, 59] {
            let cancel = Cancel::new();
            let problem = balls(&cancel, fatal);
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

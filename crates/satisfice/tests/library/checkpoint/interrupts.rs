//! Searches with a model of F that are interrupted at a call of the fitness, saved and resumed.

use super::*;

use std::sync::Arc;

/// Raises its flag at one call of the fitness; at none, if that is number 0.
pub(crate) struct Interrupt {
    calls: Arc<AtomicU64>,
    fatal: u64,
    cancel: Cancel,
}

impl Interrupt {
    fn at(fatal: u64, cancel: &Cancel) -> Self {
        Self {
            calls: Arc::default(),
            fatal,
            cancel: cancel.clone(),
        }
    }

    pub(crate) fn count(&self) {
        if self.calls.fetch_add(1, Ordering::Relaxed) + 1 == self.fatal {
            self.cancel.cancel();
        }
    }
}

/// Interrupts 60 evaluations of the engines with a model at these calls, or at the last but one: the report is that of the uninterrupted
/// search, which has at least so many hits.
pub(crate) fn do_not_change_the_report<P: Problem>(
    problem: impl Fn(Interrupt) -> P,
    fatal_calls: [u64; 5],
    least: usize,
) {
    let budget = Budget::evaluations(60);
    for name in ["surrogate", "portfolio"] {
        let entry = engine::find(name).unwrap();
        let interrupt = Interrupt::at(0, &Cancel::new());
        let calls = Arc::clone(&interrupt.calls);
        let undisturbed = problem(interrupt);
        let expected = search(entry, 0.0).run(&undisturbed, &budget).unwrap();
        assert!(expected.hit_count() >= least, "{name}: {}", expected.hit_count());
        let last = calls.load(Ordering::Relaxed);
        for fatal in fatal_calls.map(|fatal| fatal.min(last - 1)) {
            let cancel = Cancel::new();
            let problem = problem(Interrupt::at(fatal, &cancel));
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

//! What is run for each law.

use super::probe::{Probe, Restored};
use super::{EngineLaw, EngineSuite, LONG_RUN};
use crate::budget::{Budget, StopReason};
use crate::engine::WarmStart;
use crate::error::Error;
use crate::identity::Located;
use crate::report::Report;
use crate::scalar::Real;
use crate::search::Search;
use crate::space::Space;
use crate::testing::case::{Case, Poison, spaces};
use crate::testing::{difference, difference_in_hits};

impl<S: Real> EngineSuite<'_, S> {
    /// A run twice, and once with its proposals examined.
    pub(super) fn ordinary(&mut self, case: &Case<S>) -> Result<(), Error> {
        let budget = self.ordinary_budget();
        let report = self.run(case, &budget)?;
        let again = self.search()?.run(case, &budget)?;
        self.say_if(EngineLaw::SameSeed, &case.name, difference(&report, &again));
        let by_hand = self.run_by_hand(case, &budget)?;
        self.say_if(EngineLaw::ByHand, &case.name, difference(&report, &by_hand));
        let (probe, findings) = Probe::around(self.engine);
        let probed = Search::with(probe).seed(42).run(case, &budget)?;
        self.say_if(EngineLaw::Proposals, &case.name, findings.first());
        self.say_if(
            EngineLaw::SameSeed,
            &case.name,
            difference_in_hits(&report, &probed, self.run),
        );
        Ok(())
    }

    pub(super) fn budgets(&mut self) -> Result<(), Error> {
        for evaluations in [1, 2, 7, 29, 30, 31, 64, 65] {
            for case in spaces()? {
                self.run(&case, &Budget::evaluations(evaluations))?;
            }
        }
        // 1,171 evaluations, or 41 where they are expensive: primes, no multiple of a batch.
        for case in spaces()? {
            let budget = Budget::evaluations(self.run - 29).with_horizon(self.planned);
            self.run(&case, &budget)?;
        }
        Ok(())
    }

    pub(super) fn prefixes(&mut self) -> Result<(), Error> {
        for (case, twin) in spaces()?.into_iter().zip(spaces()?) {
            let budget = |evaluations| {
                let budget = Budget::evaluations(evaluations);
                if self.engine.is_scheduled() {
                    budget.with_horizon(self.planned.max(4 * self.run))
                } else {
                    budget
                }
            };
            let (short, long) = (budget(self.run), budget(4 * self.run));
            let short = self.run(&case, &short)?;
            let long = self.run(&twin, &long)?;
            self.say_if(
                EngineLaw::Prefix,
                &case.name,
                difference_in_hits(&short, &long, self.run),
            );
            let common = |report: &Report<Located<S>>| -> Vec<_> {
                let trace = report.trace.iter().map(|point| (point.evaluations, point.hits));
                trace.filter(|&(evaluations, _)| evaluations < self.run).collect()
            };
            let (short, long) = (common(&short), common(&long));
            if !long.starts_with(&short) {
                self.say(
                    EngineLaw::Prefix,
                    &case.name,
                    format!("traces {short:?} and {long:?}"),
                );
            }
        }
        Ok(())
    }

    pub(super) fn threads(&mut self) -> Result<(), Error> {
        for mut case in spaces()? {
            // Slow enough to be worth several threads.
            case.work = 1000;
            let budget = Budget::evaluations(self.run / 2).with_horizon(self.planned);
            let one = self.run(&case, &budget)?;
            for threads in [2, 3, 8] {
                let many = self.search()?.threads(threads).run(&case, &budget)?;
                let what = difference(&one, &many).map(|what| format!("{threads} threads: {what}"));
                self.say_if(EngineLaw::Threads, &case.name, what);
            }
        }
        Ok(())
    }

    pub(super) fn poison(&mut self) -> Result<(), Error> {
        let values = [S::nan(), S::infinity(), S::neg_infinity()];
        let kinds: [fn(S) -> Poison<S>; 2] = [Poison::Third, Poison::Everywhere];
        for poison in kinds {
            for index in 0..spaces::<S>()?.len() {
                let mut reports = Vec::new();
                let healthy = spaces()?.swap_remove(index);
                let healthy = self.run(&healthy, &self.ordinary_budget())?;
                for value in values {
                    let case = spaces()?.swap_remove(index).poisoned(poison(value));
                    let (probe, findings) = Probe::around(self.engine);
                    let mut search = Search::with(probe).seed(42);
                    let report = self.run_by(&mut search, &case, &self.ordinary_budget())?;
                    self.say_if(EngineLaw::Proposals, &case.name, findings.first());
                    // An engine that covers the space, which the audit checks, has not given up.
                    let covered = report.stop_reason == StopReason::Covered;
                    if report.counts.evaluations < healthy.counts.evaluations && !covered {
                        self.say(
                            EngineLaw::NonFinite,
                            &case.name,
                            format!("gave up after {} evaluations", report.counts.evaluations),
                        );
                    }
                    if matches!(case.poison, Poison::Everywhere(_)) && report.hit_count() > 0 {
                        self.say(
                            EngineLaw::NonFinite,
                            &case.name,
                            "found hits where there are none",
                        );
                    }
                    reports.push((case.name, report));
                }
                for (name, report) in &reports[1..] {
                    self.say_if(EngineLaw::NonFinite, name, difference(&reports[0].1, report));
                }
            }
        }
        Ok(())
    }

    pub(super) fn hit_counts(&mut self) -> Result<(), Error> {
        for threshold in [0.1, 0.0, -3.0] {
            let case = Case::new("an easy lattice", Space::lattice(2, 40)?, 0.1).with_threshold(threshold);
            let report = self.run(&case, &Budget::evaluations(LONG_RUN))?;
            let (found, all) = (report.hit_count() as u64, case.count());
            if found * 4 < all || found > all {
                self.say(EngineLaw::HitCount, &case.name, format!("{found} hits of {all}"));
            }
        }
        Ok(())
    }

    pub(super) fn restoring(&mut self) -> Result<(), Error> {
        for case in spaces()? {
            let budget = self.ordinary_budget();
            let straight = self.search()?.run(&case, &budget)?;
            for every in [1, 7] {
                let (restored, findings) = Restored::around(self.engine, every);
                let report = Search::with(restored).seed(42).run(&case, &budget)?;
                self.say_if(EngineLaw::Restore, &case.name, findings.first());
                self.say_if(
                    EngineLaw::Restore,
                    &case.name,
                    difference_in_hits(&straight, &report, self.run),
                );
                if straight.counts != report.counts {
                    self.say(
                        EngineLaw::Restore,
                        &case.name,
                        format!("{:?} and {:?}", straight.counts, report.counts),
                    );
                }
            }
        }
        Ok(())
    }

    pub(super) fn slices(&mut self) -> Result<(), Error> {
        for rule in [WarmStart::Cold, WarmStart::Engine, WarmStart::Verify] {
            for index in 0..2 * spaces::<S>()?.len() {
                let pick = || -> Result<Case<S>, Error> {
                    let case = spaces()?.swap_remove(index / 2);
                    Ok(if index % 2 == 0 {
                        case
                    } else {
                        case.offering_nothing()
                    })
                };
                let (first, moved, again) = (pick()?, pick()?.moved(0.02), pick()?.moved(0.02));
                let mut twins = [self.search()?.warm_start(rule), self.search()?.warm_start(rule)];
                let budget = self.ordinary_budget();
                let before = self.run_by(&mut twins[0], &first, &budget)?;
                let after = self.run_by(&mut twins[0], &moved, &budget)?;
                twins[1].run(&first, &budget)?;
                let twin = twins[1].run(&again, &budget)?;
                let name = format!("{}, {rule:?}", moved.name);
                self.say_if(EngineLaw::Slices, &name, difference(&after, &twin));
                let wanted = if rule == WarmStart::Verify {
                    before.hit_count() as u64
                } else {
                    0
                };
                if after.counts.verified != wanted.min(self.run) {
                    self.say(
                        EngineLaw::Slices,
                        &name,
                        format!("{} of {wanted} hits verified", after.counts.verified),
                    );
                }
            }
        }
        Ok(())
    }
}

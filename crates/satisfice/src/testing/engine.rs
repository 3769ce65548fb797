//! The conformance suite of engines: what every engine keeps to, whatever it does.
//!
//! ```
//! use satisfice::{engine, testing};
//! let entry = engine::find("walk")?;
//! assert_eq!(testing::engine::check_entry(entry, &[])?, []);
//! # Ok::<(), satisfice::Error>(())
//! ```

use super::case::{Case, spaces};
use crate::budget::Budget;
use crate::catalogue::Params;
use crate::engine::{Entry, Named};
use crate::error::Error;
use crate::identity::Located;
use crate::problem::SatisficingProblem;
use crate::report::Report;
use crate::scalar::Real;
use crate::search::Search;

mod audit;
mod laws;
mod probe;

/// The laws that the suite looks after.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Law {
    /// Proposals have a coordinate for each axis, none of them NaN, whatever the fitness.
    Proposals,
    /// Every candidate is inside the bounds, and whole on integer axes.
    Inside,
    /// A report's numbers fit each other and what the problem has seen; its hits are hits, and distinct.
    Books,
    /// A budget of evaluations is kept exactly, unless the engine has nothing more to propose.
    Budget,
    /// The same seed gives the same report.
    SameSeed,
    /// So it does where points are evaluated by hand, whether or not the engine [advances](crate::engine::Engine::advance).
    ByHand,
    /// So it does on any number of threads (feature `rayon`).
    Threads,
    /// A short run is the beginning of a long one; under one horizon where a schedule follows the budget.
    Prefix,
    /// Fitness of NaN and of either infinity is the same to the search, and harmless.
    NonFinite,
    /// An easy problem has hits, at least a quarter of all and no more than there are; under thresholds of 0 and below too.
    HitCount,
    /// An engine saved and restored at any time goes on as if nothing had been, and refuses a state that is cut short.
    Restore,
    /// A search goes on with a second slice, under each rule of warm starts.
    Slices,
    /// Who says that the space is covered has covered it.
    Covered,
}

/// What the suite reports.
pub type Violation = super::Violation<Law>;

/// Evaluations of an ordinary run.
const RUN: u64 = 600;
/// Evaluations in which an easy problem is solved.
const LONG_RUN: u64 = 20_000;

/// Runs the suite on an engine of the registry with these parameters, in `f32` and in `f64`. Cost: some seconds unoptimised.
///
/// # Errors
/// As [`Entry::build`].
pub fn check_entry(entry: &Entry, settings: &[(&str, &str)]) -> Result<Vec<Violation>, Error> {
    let values = Params::with(entry.parameters, entry.name, settings.iter().copied())?;
    let scheduled = (entry.scheduled)(&values);
    let mut violations = Vec::new();
    entry.build::<f32>(settings.iter().copied())?;
    for (name, found) in [
        (
            "f32",
            check::<f32>(scheduled, &mut || entry.build(settings.iter().copied()))?,
        ),
        (
            "f64",
            check::<f64>(scheduled, &mut || entry.build(settings.iter().copied()))?,
        ),
    ] {
        violations.extend(found.into_iter().map(|mut violation| {
            violation.case = format!("{} in {name}, {}", entry.name, violation.case);
            violation
        }));
    }
    Ok(violations)
}

/// Runs the suite on an engine of one's own, which `make` builds anew for each run, always with the same parameters.
/// `scheduled` says whether a schedule follows the budget.
///
/// # Errors
/// Those of `make`, and of starting threads.
pub fn check<S: Real>(
    scheduled: bool,
    make: &mut dyn FnMut() -> Result<Named<S>, Error>,
) -> Result<Vec<Violation>, Error> {
    let mut suite = Suite {
        make,
        scheduled,
        violations: Vec::new(),
    };
    for case in spaces()? {
        suite.ordinary(&case)?;
    }
    for case in spaces()? {
        suite.ordinary(&case.offering_nothing())?;
    }
    suite.budgets()?;
    suite.prefixes()?;
    suite.threads()?;
    suite.poison()?;
    suite.hit_counts()?;
    suite.restoring()?;
    suite.slices()?;
    Ok(suite.violations)
}

struct Suite<'a, S> {
    make: &'a mut dyn FnMut() -> Result<Named<S>, Error>,
    scheduled: bool,
    violations: Vec<Violation>,
}

impl<S: Real> Suite<'_, S> {
    fn say(&mut self, law: Law, case: &str, what: impl Into<String>) {
        self.violations.push(Violation {
            law,
            case: case.to_owned(),
            what: what.into(),
        });
    }

    fn say_if(&mut self, law: Law, case: &str, what: Option<String>) {
        if let Some(what) = what {
            self.say(law, case, what);
        }
    }

    fn search(&mut self) -> Result<Search<S, Located<S>>, Error> {
        Ok(Search::new((self.make)()?).seed(42))
    }

    /// A run by the engine, its books audited.
    fn run(&mut self, case: &Case<S>, budget: &Budget) -> Result<Report<Located<S>>, Error> {
        let mut search = self.search()?;
        self.run_by(&mut search, case, budget)
    }

    /// The same run, driven by hand.
    fn run_by_hand(&mut self, case: &Case<S>, budget: &Budget) -> Result<Report<Located<S>>, Error> {
        let mut search = self.search()?;
        search.begin(case, budget)?;
        loop {
            let fitness: Vec<S> = search.ask(case)?.iter().map(|c| case.fitness(c)).collect();
            if fitness.is_empty() {
                return search.finish(case);
            }
            search.tell(case, &fitness)?;
        }
    }

    /// A slice of this search, its books audited.
    fn run_by(
        &mut self,
        search: &mut Search<S, Located<S>>,
        case: &Case<S>,
        budget: &Budget,
    ) -> Result<Report<Located<S>>, Error> {
        let before = case.calls();
        let report = search.run(case, budget)?;
        audit::audit(case, &report, case.calls() - before, &mut self.violations);
        Ok(report)
    }
}

//! The conformance suite of engines: the laws that every engine keeps.
//!
//! ```
//! use satisfice::{engine, testing};
//! let walk = engine::find("walk")?;
//! assert_eq!(testing::engine::check_spec(walk, &[])?, []);
//! # Ok::<(), satisfice::Error>(())
//! ```

use super::Violation;
use super::case::{Case, spaces};
use crate::budget::Budget;
use crate::engine::{ConfiguredEngine, EngineSpec};
use crate::error::Error;
use crate::identity::Located;
use crate::problem::SatisficingProblem;
use crate::report::Report;
use crate::scalar::Real;
use crate::search::Search;

mod audit;
mod laws;
mod probe;

/// The laws that the suite checks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum EngineLaw {
    /// Proposals have a coordinate for each axis, none of them NaN, whatever the fitness.
    Proposals,
    /// Every candidate is inside the bounds, and whole on integer axes.
    Inside,
    /// The numbers of a report agree with each other and with the calls of the problem; its hits are hits, and distinct.
    Accounting,
    /// A budget of evaluations is kept exactly, unless the engine has nothing more to propose.
    Budget,
    /// The same seed gives the same report.
    SameSeed,
    /// The same holds where points are evaluated by hand, whether or not the engine
    /// [advances](crate::engine::Engine::advance).
    ByHand,
    /// The same holds on any number of threads (feature `rayon`).
    Threads,
    /// A short run is the beginning of a long one; under one horizon where a schedule follows the budget.
    Prefix,
    /// NaN and both infinities have the same, harmless effect as a fitness.
    NonFinite,
    /// An easy problem has hits, at least a quarter of all and no more than there are; under thresholds of 0 and below too.
    HitCount,
    /// An engine that is saved and restored at any time continues as without, and refuses a truncated state.
    Restore,
    /// A search continues with a second slice, under each rule of warm starts.
    Slices,
    /// The space is covered if the engine says so.
    Covered,
}

/// Evaluations of an ordinary run, and how many are planned: too many for a model of F.
const RUN: RunLength = RunLength {
    evaluations: 1_200,
    planned: 20_000,
};
/// Those of a run by an engine whose proposals are expensive.
const EXPENSIVE_RUN: RunLength = RunLength {
    evaluations: 70,
    planned: 70,
};
/// Evaluations in which an easy problem is solved.
const LONG_RUN: u64 = 20_000;

/// Runs the suite on an engine of the registry with these parameters, in `f32` and in `f64`, on a thread each. Takes
/// seconds; minutes where proposals are expensive, as those of `surrogate` at its defaults.
///
/// # Errors
/// As [`EngineSpec::configure`].
pub fn check_spec(spec: &EngineSpec, settings: &[(&str, &str)]) -> Result<Vec<Violation<EngineLaw>>, Error> {
    let run = if spec.expensive_proposals {
        EXPENSIVE_RUN
    } else {
        RUN
    };
    let settings = || settings.iter().copied();
    let single = spec.configure::<f32>(settings())?;
    let double = spec.configure::<f64>(settings())?;
    let (single, double) = std::thread::scope(|scope| {
        let of_single = || check_in(&single, run);
        let beside = std::thread::Builder::new().spawn_scoped(scope, of_single);
        let double = check_in(&double, run);
        match beside.map(std::thread::ScopedJoinHandle::join) {
            Ok(Ok(single)) => (single, double),
            Ok(Err(panic)) => std::panic::resume_unwind(panic),
            Err(_) => (of_single(), double), // no thread can be started here
        }
    });
    let mut violations = Vec::new();
    for (scalar, found) in [("f32", single?), ("f64", double?)] {
        violations.extend(found.into_iter().map(|mut violation| {
            violation.case = format!("{} in {scalar}, {}", spec.name, violation.case);
            violation
        }));
    }
    Ok(violations)
}

/// Runs the suite on an engine, which is rebuilt for each run.
///
/// # Errors
/// As [`ConfiguredEngine::build`]; errors of starting threads.
pub fn check<S: Real>(engine: &ConfiguredEngine<S>) -> Result<Vec<Violation<EngineLaw>>, Error> {
    check_in(engine, RUN)
}

/// The suite, with such ordinary runs.
fn check_in<S: Real>(
    engine: &ConfiguredEngine<S>,
    run: RunLength,
) -> Result<Vec<Violation<EngineLaw>>, Error> {
    engine.check()?;
    let mut suite = EngineSuite {
        engine,
        run: run.evaluations,
        planned: run.planned,
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

/// How long a run is.
#[derive(Debug, Clone, Copy)]
struct RunLength {
    evaluations: u64,
    planned: u64,
}

struct EngineSuite<'a, S> {
    engine: &'a ConfiguredEngine<S>,
    /// Evaluations of an ordinary run.
    run: u64,
    /// Evaluations that it is planned for.
    planned: u64,
    violations: Vec<Violation<EngineLaw>>,
}

impl<S: Real> EngineSuite<'_, S> {
    fn say(&mut self, law: EngineLaw, case: &str, what: impl Into<String>) {
        self.violations.push(Violation {
            law,
            case: case.to_owned(),
            what: what.into(),
        });
    }

    fn say_if(&mut self, law: EngineLaw, case: &str, what: Option<String>) {
        if let Some(what) = what {
            self.say(law, case, what);
        }
    }

    /// The budget of an ordinary run.
    fn ordinary_budget(&self) -> Budget {
        Budget::evaluations(self.run).with_horizon(self.planned)
    }

    fn search(&mut self) -> Result<Search<Case<S>>, Error> {
        Ok(Search::with(self.engine.clone()).seed(42))
    }

    /// A run by the engine; its report is audited.
    fn run(&mut self, case: &Case<S>, budget: &Budget) -> Result<Report<Located<S>>, Error> {
        let mut search = self.search()?;
        self.run_by(&mut search, case, budget)
    }

    /// The same run, driven by hand.
    fn run_by_hand(&mut self, case: &Case<S>, budget: &Budget) -> Result<Report<Located<S>>, Error> {
        let mut search = self.search()?;
        let mut slice = search.start(case, budget)?;
        loop {
            let fitness: Vec<S> = slice.ask()?.iter().map(|c| case.fitness(c)).collect();
            if fitness.is_empty() {
                return Ok(slice.finish());
            }
            slice.tell(&fitness)?;
        }
    }

    /// A slice of this search; its report is audited.
    fn run_by(
        &mut self,
        search: &mut Search<Case<S>>,
        case: &Case<S>,
        budget: &Budget,
    ) -> Result<Report<Located<S>>, Error> {
        let before = case.calls();
        let report = search.run(case, budget)?;
        audit::audit(case, &report, case.calls() - before, &mut self.violations);
        Ok(report)
    }
}

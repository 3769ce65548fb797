//! The head of a report against itself, its lists and its scene: sums, limits, and what follows from what.

use satisfice::{Completeness, Method as Estimate, StopReason, engine};
use satisfice_catalogue::report::recall;
use satisfice_catalogue::{RunSpec, Settings};
use serde_json::Value;

use super::super::arguments::Find;
use super::super::report::{BodyLine, Head};
use super::checks::Checks;

/// What is known beside the head.
#[derive(Debug)]
pub(in super::super) struct Beside<'a> {
    /// The names of the exact methods that could have been used.
    pub(in super::super) methods: &'a [&'a str],
    pub(in super::super) find: Find,
    /// Of the scene, read again.
    pub(in super::super) settings: Settings,
    pub(in super::super) bodies: Vec<BodyLine>,
    /// The bodies that the report lists.
    pub(in super::super) listed_bodies: &'a [BodyLine],
    /// How many pairs are listed, and how many of them are measured.
    pub(in super::super) listed: u64,
    pub(in super::super) measured: u64,
    /// Whether what was asked for is proved, as far as the lists tell.
    pub(in super::super) answer: Completeness,
}

impl Head {
    fn is_proved(&self) -> bool {
        self.completeness == Completeness::Proved
    }
}

pub(in super::super) fn check(head: &Head, beside: &Beside<'_>, checks: &mut Checks) {
    settings(head, beside, checks);
    engine_of(head, beside, checks);
    counts(head, beside, checks);
    limits(head, beside, checks);
    proof(head, beside, checks);
}

/// The scene as it was asked for and is described.
fn settings(head: &Head, beside: &Beside<'_>, checks: &mut Checks) {
    let again = &beside.settings;
    let unlike = head
        .problem_parameters
        .iter()
        .find(|&(name, value)| again.get(name) != Some(value));
    let missing = again
        .iter()
        .find(|&(name, _)| head.problem_parameters.get(name).is_none());
    if let Some((name, _)) = unlike.or(missing) {
        let value = |settings: &Settings| settings.get(name).cloned().unwrap_or(Value::Null);
        let place = format!("problem_parameters.{name}");
        checks.that(false, place, value(&head.problem_parameters), value(again));
    }
    let threshold = again
        .get("threshold")
        .and_then(Value::as_f64)
        .unwrap_or(f64::INFINITY);
    checks.equal(
        "threshold",
        &head.threshold,
        &threshold,
        "as in problem_parameters",
    );
    let (count, known) = (beside.listed_bodies.len(), beside.bodies.len());
    checks.that(count == known, "bodies", count, format!("{known} bodies"));
    for (number, (listed, is)) in beside.listed_bodies.iter().zip(&beside.bodies).enumerate() {
        checks.equal(&format!("bodies[{number}]"), listed, is, "as the file has it");
    }
}

/// The method, its parameters, and what only engines have.
fn engine_of(head: &Head, beside: &Beside<'_>, checks: &mut Checks) {
    if beside.methods.contains(&head.engine.as_str()) {
        let none = "an exact method has none";
        checks.equal(
            "engine_parameters",
            &head.engine_parameters,
            &Settings::default(),
            none,
        );
        checks.equal("seed", &head.seed, &0, none);
        checks.that(
            head.best.is_none(),
            "best",
            &head.best,
            "null, since an exact method has none",
        );
        return;
    }
    let spec = RunSpec {
        engine_parameters: head.engine_parameters.clone(),
        ..RunSpec::new(&head.engine)
    };
    // Methods of other problems are no engines.
    let is_known = beside.find == Find::All && engine::find(&head.engine).is_ok();
    match spec.complete() {
        Ok(spec) if is_known => {
            let same = spec.engine_parameters == head.engine_parameters;
            checks.that(
                same,
                "engine_parameters",
                &head.engine_parameters,
                "those of the engine",
            );
        }
        Err(error) if is_known => checks.that(false, "engine_parameters", &head.engine_parameters, error),
        _ => checks.that(false, "engine", &head.engine, "a method that answers this"),
    }
}

fn counts(head: &Head, beside: &Beside<'_>, checks: &mut Checks) {
    checks.equal("hits", &head.hits, &beside.listed, "the number of pairs");
    let unmeasured = beside.listed - beside.measured;
    checks.equal(
        "unmeasured",
        &head.unmeasured,
        &unmeasured,
        "the pairs without a distance or time",
    );
    let share = head.reference_hits.and_then(|all| recall(head.hits, all));
    checks.equal("recall", &head.recall, &share, "hits / reference_hits");
    let most = head.reference_hits.unwrap_or(u64::MAX);
    checks.that(
        head.hits <= most,
        "hits",
        head.hits,
        format!("at most the {most} that there are"),
    );
}

/// The limits of the run, and the one that ended it.
fn limits(head: &Head, beside: &Beside<'_>, checks: &mut Checks) {
    let (budget, evaluations) = (&head.budget, head.evaluations);
    let (elapsed, late) = (head.elapsed_seconds, head.overshoot_seconds);
    checks.that(elapsed >= 0.0, "elapsed_seconds", elapsed, "no negative time");
    let within = format!("from 0 to the {elapsed} that passed");
    checks.that(
        (0.0..=elapsed.max(0.0)).contains(&late),
        "overshoot_seconds",
        late,
        within,
    );
    let most = budget.hits.unwrap_or(u64::MAX);
    checks.that(
        head.hits <= most,
        "hits",
        head.hits,
        format!("at most the budget of {most}"),
    );
    let most = budget.evaluations.unwrap_or(u64::MAX);
    checks.that(
        evaluations <= most,
        "evaluations",
        evaluations,
        format!("at most the budget of {most}"),
    );
    let wanted_some = budget.hits.is_some() || matches!(beside.find, Find::First | Find::Closest(_));
    let could_be = match head.stop_reason {
        StopReason::Time => budget.time.is_some(),
        StopReason::Evaluations => budget.evaluations.is_some(),
        StopReason::Patience => budget.patience.is_some(),
        StopReason::Hits => wanted_some && head.hits > 0,
        // The exact methods then know all pairs.
        StopReason::Covered if beside.methods.contains(&head.engine.as_str()) => {
            head.is_proved() || head.reference_hits.is_some_and(|all| all > head.hits)
        }
        _ => true,
    };
    checks.that(
        could_be,
        "stop_reason",
        head.stop_reason,
        "a limit that was set and reached",
    );
}

/// What is said to be proved, and of pairs that are not seen.
fn proof(head: &Head, beside: &Beside<'_>, checks: &mut Checks) {
    checks.equal(
        "answer",
        &head.answer,
        &beside.answer,
        "as the other keys have it",
    );
    let unseen = (head.unseen_estimate, head.unseen_interval);
    let how = (head.unseen_confidence, head.unseen_method);
    if head.is_proved() {
        let why = "since completeness is proved";
        let there_are = head.reference_hits.unwrap_or(head.hits);
        checks.equal("reference_hits", &there_are, &head.hits, why);
        checks.equal("unseen_estimate", &unseen.0, &Some(0.0), why);
        checks.equal("unseen_interval", &unseen.1, &Some((0.0, Some(0.0))), why);
        checks.equal("unseen_confidence", &how.0, &Some(1.0), why);
        checks.equal("unseen_method", &how.1, &Some(Estimate::Proved), why);
        return;
    }
    let is_estimated = unseen.0.is_some();
    let exact = beside.methods.contains(&head.engine.as_str());
    checks.that(
        !(exact && is_estimated),
        "unseen_estimate",
        unseen.0,
        "null, since nothing was probed",
    );
    let together = [unseen.1.is_some(), how.0.is_some(), how.1.is_some()] == [is_estimated; 3];
    checks.that(
        together,
        "unseen_interval",
        unseen.1,
        "all of estimate, interval, confidence and method, or none",
    );
    if let (Some(estimate), Some((low, high))) = unseen {
        let holds = (0.0..=estimate).contains(&low) && high.is_none_or(|high| estimate <= high);
        checks.that(holds, "unseen_estimate", estimate, "a number within its interval");
    }
    let is_share = how.0.is_none_or(|share| (0.0..1.0).contains(&share));
    checks.that(
        is_share,
        "unseen_confidence",
        how.0,
        "a share below 1, since nothing is proved",
    );
}

//! Records of runs by name: their contents, that runs repeat, and that a false report is detected.

#![allow(clippy::unwrap_used, missing_docs)]

use satisfice::Encoding;
use satisfice::catalogue::{Catalogued, Parameter, Params};
use satisfice::{Axis, Cancel, Error, SatisficingProblem, Space};
use satisfice_catalogue::{ProblemSpec, RunControl, RunReport, RunSpec, catalogue};

/// Lattice points below a diagonal: `x + y < sum` in `[0, width)^2`.
struct Corner {
    space: Space<f64>,
    sum: u32,
}

impl SatisficingProblem for Corner {
    type Scalar = f64;
    type Solution = [u32; 2];
    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> [u32; 2] {
        [values[0] as u32, values[1] as u32]
    }
    fn fitness(&self, &[x, y]: &[u32; 2]) -> f64 {
        f64::from(x + y)
    }
    fn threshold(&self) -> f64 {
        f64::from(self.sum)
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, [u32; 2]>> {
        Some(self)
    }
}

impl Encoding<f64, [u32; 2]> for Corner {
    fn encode(&self, solution: &[u32; 2], values: &mut [f64]) -> bool {
        values.copy_from_slice(&solution.map(f64::from));
        true
    }
}

impl Catalogued for Corner {
    const NAME: &'static str = "corner";
    const SUMMARY: &'static str = "lattice points below a diagonal";
    const SOURCE: &'static str = "made for this test";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer("width", "points on a side", 40, 1, 1000),
        Parameter::integer("sum", "delta", 5, 0, 1000),
    ];
    fn from_params(params: &Params) -> Result<Self, Error> {
        let width = params.integer("width");
        if params.integer("sum") > width {
            return Err(Error::parameter(
                "sum",
                params.integer("sum"),
                "at most the width",
            ));
        }
        Ok(Self {
            space: Space::new([Axis::integer(0, width - 1), Axis::integer(0, width - 1)])?,
            sum: u32::try_from(params.count("sum")).unwrap(),
        })
    }
    fn reference_hits(&self) -> Option<u64> {
        Some(u64::from(self.sum * (self.sum + 1) / 2))
    }
}

const CORNER: ProblemSpec = ProblemSpec::of::<Corner>();

fn run(spec: &RunSpec) -> RunReport {
    CORNER
        .build([])
        .unwrap()
        .run(spec, RunControl::default())
        .unwrap()
}

/// Everything but times.
fn timeless(mut report: RunReport) -> RunReport {
    (report.elapsed_seconds, report.overshoot_seconds) = (0.0, 0.0);
    report
        .trace
        .iter_mut()
        .for_each(|point| point.elapsed_seconds = 0.0);
    report
        .solutions
        .iter_mut()
        .for_each(|solution| solution.seconds = 0.0);
    for slice in &mut report.slices {
        (slice.elapsed_seconds, slice.overshoot_seconds) = (0.0, 0.0);
    }
    report
}

#[test]
fn a_record_has_the_keys_of_the_contract() {
    let instance = CORNER.build([("width", "30")]).unwrap();
    let spec = RunSpec::new("random")
        .evaluations(20_000)
        .seed(3)
        .set("batch", "7");
    let mut report = instance.run(&spec, RunControl::default()).unwrap();
    report.set_reference(instance.reference_hits());
    let json = serde_json::to_value(&report).unwrap();
    for key in [
        "problem",
        "problem_parameters",
        "engine",
        "engine_parameters",
        "scalar",
        "threshold",
        "seed",
        "budget",
        "evaluations",
        "fitness_calls",
        "duplicates",
        "non_finite",
        "verified",
        "neighbour_calls",
        "bound_calls",
        "elapsed_seconds",
        "overshoot_seconds",
        "stop_reason",
        "hits",
        "reference_hits",
        "recall",
        "completeness",
        "unseen_estimate",
        "unseen_interval",
        "trace",
        "solutions",
        "version",
    ] {
        assert!(json.get(key).is_some(), "{key}");
    }
    assert_eq!(json["problem"], "corner");
    assert_eq!(
        json["problem_parameters"],
        serde_json::json!({"width": 30, "sum": 5})
    );
    assert_eq!(json["engine_parameters"]["batch"], 7);
    assert_eq!(
        (json["hits"].as_u64(), json["reference_hits"].as_u64()),
        (Some(15), Some(15))
    );
    assert_eq!(json["recall"], 1.0);
    assert_eq!(json["evaluations"], 20_000);
    let back: RunReport = serde_json::from_str(&serde_json::to_string(&report).unwrap()).unwrap();
    assert!(back == report, "a report is read as it was written");
    assert_eq!(instance.verify(&back, instance.reference_hits()), []);
}

#[test]
fn the_same_request_gives_the_same_record_on_any_number_of_threads() {
    let spec = RunSpec::new("latest-hit-qpso").evaluations(5000).seed(9);
    let one = timeless(run(&spec));
    for threads in [1, 2, 3] {
        let mut spec = spec.clone();
        spec.threads = threads;
        assert!(timeless(run(&spec)) == one, "{threads} threads");
    }
    assert!(timeless(run(&spec.seed(10))) != one, "another seed");
}

#[test]
fn slices_are_united() {
    let mut spec = RunSpec::new("random").evaluations(300).seed(1);
    spec.budget.slices = 4;
    let instance = CORNER.build([]).unwrap();
    let report = instance.run(&spec, RunControl::default()).unwrap();
    assert_eq!(report.slices.len(), 4);
    assert_eq!(report.counts.evaluations, 1200);
    assert_eq!(
        report.hits,
        report.slices.iter().map(|slice| slice.new_hits).sum::<u64>()
    );
    assert!(report.hits > report.slices[0].hits);
    assert_eq!(instance.verify(&report, Some(15)), []);
}

#[test]
fn a_run_ends_with_enough_hits_and_when_cancelled() {
    let mut spec = RunSpec::new("random").hits(3);
    spec.budget.slices = 5;
    let report = run(&spec);
    assert_eq!((report.hits, report.slices.len()), (3, 1));

    let cancel = Cancel::new();
    cancel.cancel();
    let problem = CORNER.build([]).unwrap();
    let report = problem.run(&spec, RunControl::until(&cancel)).unwrap();
    assert_eq!((report.hits, report.slices.len()), (0, 1));
}

#[test]
fn what_is_misspelt_or_out_of_range_is_named() {
    let error = |result: Result<RunReport, satisfice_catalogue::Error>| result.unwrap_err().to_string();
    let instance = CORNER.build([]).unwrap();
    let text = error(instance.run(&RunSpec::new("randon").evaluations(10), RunControl::default()));
    assert!(text.contains("did you mean `random`?"), "{text}");
    let text = error(instance.run(
        &RunSpec::new("random").evaluations(10).set("bach", "3"),
        RunControl::default(),
    ));
    assert!(
        text.contains("unknown parameter of `random` `bach`, did you mean `batch`?"),
        "{text}"
    );
    let text = error(instance.run(&RunSpec::new("random").evaluations(0), RunControl::default()));
    assert!(text.contains("the number of evaluations is zero"), "{text}");
    let text = CORNER.build([("widht", "3")]).err().unwrap().to_string();
    assert!(text.contains("did you mean `width`?"), "{text}");
    let text = CORNER.build([("sum", "41")]).err().unwrap().to_string();
    assert_eq!(text, "sum = 41 is not allowed: at most the width");
    let mut spec = RunSpec::new("random").evaluations(10);
    spec.budget.slices = 0;
    assert_eq!(
        error(instance.run(&spec, RunControl::default())),
        "0 slices leave nothing to run: give at least 1"
    );
}

/// Every false report is found out, at the place that was changed.
#[test]
fn a_false_record_is_found_out() {
    let instance = CORNER.build([]).unwrap();
    let spec = RunSpec::new("random").evaluations(20_000).seed(2);
    let mut report = instance.run(&spec, RunControl::default()).unwrap();
    report.set_reference(Some(15));
    assert_eq!(instance.verify(&report, Some(15)), []);
    let last = report.solutions.len() - 1;
    type Change = fn(&mut RunReport);
    let changes: [(&str, Change); 16] = [
        ("solutions[0].solution", |r| {
            r.solutions[0].solution = serde_json::json!([30, 1]);
        }),
        ("solutions[0].solution", |r| {
            r.solutions[0].solution = serde_json::json!([4_000_000_000_u32, 4_000_000_000_u32]);
        }),
        ("solutions[0].solution", |r| {
            r.solutions[0].solution = serde_json::json!("no pair");
        }),
        ("solutions[1].solution", |r| {
            r.solutions[1] = r.solutions[0].clone();
        }),
        ("solutions[2].fitness", |r| r.solutions[2].fitness += 0.5),
        ("solutions[2].evaluation", |r| r.solutions[2].evaluation = 1),
        ("solutions[2].seconds", |r| r.solutions[2].seconds = 1e9),
        ("hits", |r| r.hits += 1),
        ("duplicates", |r| r.counts.duplicates = 0),
        ("fitness_calls", |r| r.counts.fitness_calls = 20_001),
        ("evaluations", |r| r.counts.evaluations = 19_999),
        ("trace[3].evaluations", |r| r.trace[3].evaluations = 0),
        ("trace[10].hits", |r| r.trace[10].hits += 1),
        ("reference_hits", |r| r.reference_hits = Some(20)),
        ("recall", |r| r.recall = Some(0.99)),
        ("threshold", |r| r.threshold = Some(6.0)),
    ];
    for (place, change) in changes {
        let mut false_one = report.clone();
        change(&mut false_one);
        let found = instance.verify(&false_one, Some(15));
        assert!(found.iter().any(|m| m.place == place), "{place}: {found:?}");
    }
    let mut proved = report.clone();
    proved.solutions.truncate(last);
    proved.hits -= 1;
    proved.completeness = satisfice::Completeness::Proved;
    let found = instance.verify(&proved, Some(15));
    for place in ["completeness", "unseen_estimate"] {
        assert!(found.iter().any(|m| m.place == place), "{place}: {found:?}");
    }
    let told = |report: &RunReport| -> Vec<String> {
        let found = instance.verify(report, Some(15));
        found.iter().map(ToString::to_string).collect()
    };
    proved.unseen_estimate = None;
    proved.unseen_interval = Some((0.0, Some(134_925.0)));
    let wanted =
        "unseen_estimate: found null in [0, 134925], expected 0 in [0, 0], since completeness is proved";
    assert!(
        told(&proved).iter().any(|line| line == wanted),
        "{:?}",
        told(&proved)
    );
    // Two hits may share an evaluation.
    let mut early = report.clone();
    early.solutions[2].evaluation = 1;
    let wanted = format!(
        "solutions[2].evaluation: found 1, expected at least {} and at most 20000",
        report.solutions[1].evaluation
    );
    assert!(told(&early).contains(&wanted), "{:?}", told(&early));
}

/// A search by bounds spends most of its budget on them: a report that leaves them out has not spent its budget.
#[test]
fn bounds_count_towards_the_budget_that_was_spent() {
    let instance = catalogue::find("rastrigin").unwrap().build([]).unwrap();
    let spec = RunSpec::new("branch-and-bound").evaluations(500);
    let mut report = instance.run(&spec, RunControl::default()).unwrap();
    assert_eq!(report.stop_reason, satisfice::StopReason::Evaluations);
    assert!(report.counts.evaluations < 500 && report.counts.bound_calls > 100);
    assert_eq!(instance.verify(&report, None), []);
    report.counts.bound_calls = 0;
    let found = instance.verify(&report, None);
    assert!(found.iter().any(|m| m.place == "evaluations"), "{found:?}");
}

#[test]
fn an_unknown_problem_is_an_error() {
    let error = catalogue::find("no such problem").err().unwrap().to_string();
    assert!(error.starts_with("unknown problem `no such problem`"), "{error}");
}

/// Names are unique, every problem builds with its defaults, runs and verifies.
#[test]
fn every_problem_of_the_catalogue_runs_and_verifies() {
    let mut names: Vec<_> = catalogue::all().iter().map(|entry| entry.name).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), catalogue::all().len());
    for entry in catalogue::all() {
        let instance = entry.build([]).unwrap();
        assert_eq!(instance.name(), entry.name);
        let spec = RunSpec::new("latest-hit-qpso").evaluations(3000).seed(1);
        let report = instance.run(&spec, RunControl::default()).unwrap();
        let again: RunReport = serde_json::from_str(&serde_json::to_string(&report).unwrap()).unwrap();
        assert_eq!(instance.verify(&again, None), [], "{}", entry.name);
        let texts = again.spec.problem_parameters.texts();
        let settings = texts.iter().map(|(name, text)| (name.as_str(), text.as_str()));
        let rebuilt = entry.build(settings).unwrap();
        assert_eq!(rebuilt.parameters(), instance.parameters(), "{}", entry.name);
    }
}

//! What a suite amounts to, looked up and checked as a whole before anything runs. Runs are made as they are needed.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

use satisfice::engine;
use satisfice_catalogue::quantity::shown;
use satisfice_catalogue::{Catalogue, Instance, RunSpec, exact, options};
use serde::Serialize;

use super::grid;
use super::suite::{Choice, Part, Suite};
use crate::error::Error;
use crate::studies;

/// The greatest number of runs of a sweep.
const MOST_RUNS: u64 = 10_000_000;

/// All runs of a suite.
pub struct Plan {
    /// The suite.
    pub suite: Suite,
    /// The problems, each once.
    pub instances: Vec<Arc<dyn Instance>>,
    /// The runs but for their seeds, in the order of the suite.
    pub cells: Vec<Cell>,
    pub(super) places: BTreeMap<String, usize>,
    len: u64,
}

/// The runs of one engine on one problem under one budget, over all seeds.
#[derive(Debug, Clone)]
pub struct Cell {
    /// Its part's place in the suite.
    pub part: usize,
    /// Its problem's place among the instances.
    pub instance: usize,
    /// The problem with the parameters that the suite sets.
    pub problem_label: String,
    /// The engine with the parameters that the suite sets.
    pub engine_label: String,
    /// The specification of the runs, with seed 0.
    pub spec: RunSpec,
    /// The seeds.
    pub seeds: Range<u64>,
    /// The number of its first run.
    first: u64,
}

/// One run of a plan.
#[derive(Debug, Clone, Copy)]
pub struct Planned<'a> {
    /// All but the seed.
    pub cell: &'a Cell,
    /// The seed.
    pub seed: u64,
}

impl Cell {
    /// Whether a clock limits its runs, so that nothing else may run meanwhile.
    #[must_use]
    pub fn is_timed(&self) -> bool {
        self.spec.budget.time.is_some()
    }

    /// The number of its runs.
    #[must_use]
    pub fn len(&self) -> u64 {
        self.seeds.end - self.seeds.start
    }

    /// Whether it has no run.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.seeds.is_empty()
    }
}

impl Planned<'_> {
    /// The specification.
    #[must_use]
    pub fn spec(&self) -> RunSpec {
        self.cell.spec.clone().seed(self.seed)
    }

    /// Its number, unique within the plan.
    #[must_use]
    pub fn number(&self) -> u64 {
        self.cell.first + (self.seed - self.cell.seeds.start)
    }
}

impl Plan {
    /// Checks the size of a suite, looks everything up, and builds every problem and every engine once.
    ///
    /// # Errors
    /// [`Error::Suite`] with the part, and what is wrong: too many runs, an unknown name with the nearest known one, a
    /// parameter out of range, an engine listed twice.
    pub fn new(suite: Suite, catalogue: &Catalogue) -> Result<Self, Error> {
        check_size(&suite)?;
        let mut plan = Self {
            suite,
            instances: Vec::new(),
            cells: Vec::new(),
            places: BTreeMap::new(),
            len: 0,
        };
        for study in &plan.suite.studies {
            studies::find(study)?;
        }
        for at in 0..plan.suite.parts.len() {
            plan.add_part(at, catalogue).map_err(|error| Error::Suite {
                place: format!("{}, {}", plan.suite.name, plan.suite.parts[at].place(at)),
                what: error.to_string(),
            })?;
        }
        plan.check_regret()?;
        Ok(plan)
    }

    /// The number of runs.
    #[must_use]
    pub fn len(&self) -> u64 {
        self.len
    }

    /// Whether there is nothing to run.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The runs seed by seed, so that a sweep that is cut short has seen every engine. Memory: O(cells).
    pub fn runs(&self) -> impl Iterator<Item = Planned<'_>> {
        let mut ends: Vec<u64> = self
            .cells
            .iter()
            .flat_map(|cell| [cell.seeds.start, cell.seeds.end])
            .collect();
        ends.sort_unstable();
        ends.dedup();
        let spans: Vec<Range<u64>> = ends.windows(2).map(|ends| ends[0]..ends[1]).collect();
        spans.into_iter().flatten().flat_map(|seed| {
            let cells = self.cells.iter().filter(move |cell| cell.seeds.contains(&seed));
            cells.map(move |cell| Planned { cell, seed })
        })
    }

    /// The longest time that the runs limited by a clock can take together, in seconds.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "an estimate")]
    pub fn timed_seconds(&self) -> f64 {
        let seconds = |cell: &Cell| {
            let time = cell.spec.budget.time.map_or(0.0, |time| time.as_secs_f64());
            time * cell.spec.budget.slices as f64 * cell.len() as f64
        };
        self.cells.iter().map(seconds).sum()
    }

    fn add_part(&mut self, at: usize, catalogue: &Catalogue) -> Result<(), Error> {
        let part = self.suite.parts[at].clone();
        let engines = engines(&part.engines)?;
        let problems = self.problems(&part.problems, catalogue)?;
        check_names(&part, &engines, &problems)?;
        for (spec, _) in engines
            .iter()
            .filter(|(spec, _)| exact::find(&spec.engine).is_some())
        {
            let plain = |(place, _): &&(usize, String)| !self.instances[*place].is_geometric();
            if let Some((place, _)) = problems.iter().find(plain) {
                let (method, problem) = (spec.engine.clone(), self.instances[*place].name());
                return Err(satisfice_catalogue::Error::Exact { method, problem }.into());
            }
        }
        for (instance, problem_label) in &problems {
            for (engine, engine_label) in &engines {
                for values in grid::combinations(&part.options) {
                    let problem = &self.instances[*instance];
                    let mut spec = RunSpec {
                        problem: problem.name().to_owned(),
                        problem_parameters: problem.parameters().clone(),
                        ..engine.clone()
                    };
                    for (name, text) in &values {
                        let set = options::find(name).map(|option| option.set(&mut spec, text));
                        set.transpose().map_err(|what| Error::Suite {
                            place: name.clone(),
                            what,
                        })?;
                    }
                    self.add_cell(Cell {
                        part: at,
                        instance: *instance,
                        problem_label: problem_label.clone(),
                        engine_label: engine_label.clone(),
                        spec,
                        seeds: part.seeds.clone(),
                        first: self.len,
                    });
                }
            }
        }
        Ok(())
    }

    /// Refuses an engine or a problem of `regret` that is not in the suite.
    fn check_regret(&self) -> Result<(), Error> {
        let Some(regret) = &self.suite.regret else {
            return Ok(());
        };
        let engines = || self.cells.iter().map(|cell| cell.engine_label.as_str());
        if !engines().any(|label| label == regret.engine) {
            return Err(satisfice::Error::unknown("engine of this suite", &regret.engine, engines()).into());
        }
        let problems = || self.cells.iter().map(|cell| cell.problem_label.as_str());
        match regret
            .held_back
            .iter()
            .find(|held| !problems().any(|label| label == *held))
        {
            Some(label) => Err(satisfice::Error::unknown("problem of this suite", label, problems()).into()),
            None => Ok(()),
        }
    }

    fn add_cell(&mut self, cell: Cell) {
        let part = &self.suite.parts[cell.part];
        let at_seconds = seconds(&part.at_times);
        let version = env!("CARGO_PKG_VERSION");
        let key = key(&part.name, &cell.spec, &part.at_evaluations, &at_seconds, version);
        self.places.insert(key, self.cells.len());
        self.len += cell.len();
        self.cells.push(cell);
    }

    /// Places of the instances, built where they are new, with their labels.
    fn problems(&mut self, choices: &[Choice], catalogue: &Catalogue) -> Result<Vec<(usize, String)>, Error> {
        let mut found: Vec<(usize, String)> = Vec::new();
        for choice in choices {
            for settings in grid::combinations(&choice.settings) {
                let label = grid::label(&choice.name, &settings);
                let texts = settings.iter().map(|(name, text)| (name.as_str(), text.as_str()));
                let built = catalogue.find(&choice.name)?.build(texts)?;
                let same = |known: &Arc<dyn Instance>| {
                    known.name() == built.name() && known.parameters() == built.parameters()
                };
                let place = self.instances.iter().position(same).unwrap_or_else(|| {
                    self.instances.push(Arc::from(built));
                    self.instances.len() - 1
                });
                if found.iter().any(|(known, _)| *known == place) {
                    return Err(twice(&label));
                }
                found.push((place, label));
            }
        }
        Ok(found)
    }
}

/// A text that identifies the runs of a cell.
pub(super) fn key(
    part: &str,
    spec: &RunSpec,
    at_evaluations: &[u64],
    at_seconds: &[f64],
    version: &str,
) -> String {
    #[derive(Serialize)]
    struct Key<'a>(&'a str, &'a RunSpec, &'a [u64], &'a [f64], &'a str);
    // Numbers, texts and maps of those: this cannot fail.
    serde_json::to_string(&Key(part, spec, at_evaluations, at_seconds, version)).unwrap_or_default()
}

/// Times in seconds.
pub(super) fn seconds(times: &[Duration]) -> Vec<f64> {
    times.iter().map(Duration::as_secs_f64).collect()
}

/// Refuses a suite with too many runs before any list of them is made.
fn check_size(suite: &Suite) -> Result<(), Error> {
    let mut all = 0_u64;
    for (at, part) in suite.parts.iter().enumerate() {
        let choices = |choices: &[Choice]| {
            choices.iter().fold(0_u64, |sum, choice| {
                sum.saturating_add(grid::size(&choice.settings))
            })
        };
        let cells = choices(&part.engines)
            .saturating_mul(choices(&part.problems))
            .saturating_mul(grid::size(&part.options));
        let seeds = part.seeds.end - part.seeds.start;
        all = all.saturating_add(cells.saturating_mul(seeds));
        if all > MOST_RUNS {
            return Err(Error::Suite {
                place: format!("{}, {}", suite.name, part.place(at)),
                what: format!(
                    "{} seeds of {} engines, problems and budgets are more than {} runs: give fewer",
                    shown::count(seeds),
                    shown::count(cells),
                    shown::count(MOST_RUNS)
                ),
            });
        }
    }
    Ok(())
}

/// Refuses names in `against` and `beside` that are not of this part.
fn check_names(
    part: &Part,
    engines: &[(RunSpec, String)],
    problems: &[(usize, String)],
) -> Result<(), Error> {
    if let Some(against) = &part.against {
        let known = || part.engines.iter().map(|choice| choice.name.as_str());
        if !known().any(|name| name == against) && !engines.iter().any(|(_, label)| label == against) {
            return Err(satisfice::Error::unknown("engine of this part", against, known()).into());
        }
    }
    let labels = || problems.iter().map(|(_, label)| label.as_str());
    let is_known = |beside: &str| labels().any(|label| label == beside);
    match part.beside.keys().find(|beside| !is_known(beside)) {
        Some(label) => Err(satisfice::Error::unknown("problem of this part", label, labels()).into()),
        None => Ok(()),
    }
}

/// Refuses a name that is none of an engine or an exact method.
pub(super) fn check_engine(name: &str) -> Result<(), Error> {
    if exact::find(name).is_some() || engine::find(name).is_ok() {
        return Ok(());
    }
    let engines = engine::all().iter().map(|entry| entry.name);
    let known = engines.chain(exact::METHODS.iter().map(|method| method.name));
    Err(satisfice::Error::unknown("engine", name, known).into())
}

/// The engines with all their parameters, and their labels.
fn engines(choices: &[Choice]) -> Result<Vec<(RunSpec, String)>, Error> {
    let mut found: Vec<(RunSpec, String)> = Vec::new();
    for choice in choices {
        check_engine(&choice.name)?;
        for settings in grid::combinations(&choice.settings) {
            let label = grid::label(&choice.name, &settings);
            let mut spec = RunSpec::new(&choice.name);
            spec.engine_parameters = settings.into_iter().collect();
            let spec = spec.complete()?;
            if found.iter().any(|(known, _)| *known == spec) {
                return Err(twice(&label));
            }
            found.push((spec, label));
        }
    }
    Ok(found)
}

fn twice(label: &str) -> Error {
    Error::Suite {
        place: "list".to_owned(),
        what: format!("`{label}` is listed twice with the same parameters: leave one out"),
    }
}

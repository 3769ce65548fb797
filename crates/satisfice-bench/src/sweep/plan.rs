//! What a suite amounts to, looked up and validated as a whole before anything runs.

use std::sync::Arc;

use satisfice::{Budget, engine};

use super::row::Key;
use super::suite::{Choice, Part, Suite};
use crate::error::Error;
use crate::studies;
use satisfice_catalogue::Instance;
use satisfice_catalogue::Request;
use satisfice_catalogue::Settings;
use satisfice_catalogue::catalogue;
use satisfice_catalogue::exact;
use satisfice_catalogue::record::Limits;

/// All runs of a suite.
pub struct Plan {
    /// The suite.
    pub suite: Suite,
    /// The problems, each once.
    pub instances: Vec<Arc<dyn Instance>>,
    /// The runs, seed by seed, so that a sweep that is cut short has seen every engine.
    pub runs: Vec<Planned>,
}

/// One run.
#[derive(Debug, Clone)]
pub struct Planned {
    /// What tells it from all others.
    pub key: Key,
    /// Its part's place in the suite.
    pub part: usize,
    /// Its problem's place among the instances.
    pub instance: usize,
    /// The problem with the parameters that the suite names.
    pub problem_label: String,
    /// The engine with the parameters that the suite names.
    pub engine_label: String,
    /// What to run; the budget cannot be cancelled yet.
    pub request: Request,
}

impl Planned {
    /// Whether it is stopped by a clock, so that nothing else may run meanwhile.
    #[must_use]
    pub fn is_timed(&self) -> bool {
        self.request.budget.time.is_some()
    }
}

impl Plan {
    /// Looks everything up, builds every problem and every engine once.
    ///
    /// # Errors
    /// [`Error::Suite`] with the part, and what is wrong: an unknown name with the nearest known one, a parameter out of
    /// range, an engine named twice.
    pub fn new(suite: Suite) -> Result<Self, Error> {
        let mut plan = Self {
            suite,
            instances: Vec::new(),
            runs: Vec::new(),
        };
        for study in &plan.suite.studies {
            studies::find(study)?;
        }
        for at in 0..plan.suite.parts.len() {
            plan.add_part(at).map_err(|error| Error::Suite {
                place: format!("{}, part `{}`", plan.suite.name, plan.suite.parts[at].name),
                what: error.to_string(),
            })?;
        }
        plan.runs.sort_by_key(|run| run.request.seed);
        Ok(plan)
    }

    fn add_part(&mut self, at: usize) -> Result<(), Error> {
        let part = self.suite.parts[at].clone();
        let engines = engines(&part.engines)?;
        if let Some(against) = &part.against {
            let known = || part.engines.iter().map(|choice| choice.name.as_str());
            if !known().any(|name| name == against) && !engines.iter().any(|engine| engine.label == *against)
            {
                return Err(satisfice::Error::unknown("engine of this part", against, known()).into());
            }
        }
        let problems = self.problems(&part.problems)?;
        let labels = || problems.iter().map(|(_, label)| label.as_str());
        if let Some((label, _)) = part
            .beside
            .iter()
            .find(|(beside, _)| !labels().any(|label| label == beside))
        {
            return Err(satisfice::Error::unknown("problem of this part", label, labels()).into());
        }
        for method in engines
            .iter()
            .filter(|engine| exact::find(&engine.name).is_some())
        {
            let plain = |(place, _): &&(usize, String)| !self.instances[*place].is_geometric();
            if let Some((place, _)) = problems.iter().find(plain) {
                return Err(satisfice_catalogue::Error::Exact {
                    method: method.name.clone(),
                    problem: self.instances[*place].name(),
                }
                .into());
            }
        }
        let limits = Limits {
            time_seconds: part.time.map(|time| time.as_secs_f64()),
            evaluations: part.evaluations,
            hits: part.hits,
            slices: part.slices,
        };
        for (instance, problem_label) in &problems {
            for engine in &engines {
                for seed in part.seeds.clone() {
                    let problem = &self.instances[*instance];
                    let key = Key {
                        part: part.name.clone(),
                        problem: problem.name().to_owned(),
                        problem_parameters: problem.parameters().clone(),
                        engine: engine.name.clone(),
                        engine_parameters: engine.parameters.clone(),
                        seed,
                        budget: limits,
                        probes: part.probes,
                        at_evaluations: part.at_evaluations.clone(),
                        at_seconds: part
                            .at_times
                            .iter()
                            .map(std::time::Duration::as_secs_f64)
                            .collect(),
                        version: env!("CARGO_PKG_VERSION").to_owned(),
                    };
                    self.runs.push(Planned {
                        key,
                        part: at,
                        instance: *instance,
                        problem_label: problem_label.clone(),
                        engine_label: engine.label.clone(),
                        request: request(&part, engine, seed),
                    });
                }
            }
        }
        Ok(())
    }

    /// Places of the instances, built where they are new, with their labels.
    fn problems(&mut self, choices: &[Choice]) -> Result<Vec<(usize, String)>, Error> {
        let mut found: Vec<(usize, String)> = Vec::new();
        for (settings, label, name) in grids(choices) {
            let entry = catalogue::find(&name)?;
            let built = entry.build(pairs(&settings))?;
            let same =
                |known: &Arc<dyn Instance>| known.name() == name && known.parameters() == built.parameters();
            let place = self.instances.iter().position(same).unwrap_or_else(|| {
                self.instances.push(Arc::from(built));
                self.instances.len() - 1
            });
            if found.iter().any(|(known, _)| *known == place) {
                return Err(twice(&label));
            }
            found.push((place, label));
        }
        Ok(found)
    }
}

/// An engine with its parameters.
struct Chosen {
    name: String,
    label: String,
    settings: Vec<(String, String)>,
    parameters: Settings,
}

fn engines(choices: &[Choice]) -> Result<Vec<Chosen>, Error> {
    let mut found: Vec<Chosen> = Vec::new();
    for (settings, label, name) in grids(choices) {
        if exact::find(&name).is_some() {
            // It has no parameters: whatever is set is unknown.
            satisfice::catalogue::Params::with(&[], &name, pairs(&settings))?;
            found.push(Chosen {
                name,
                label,
                settings,
                parameters: Settings::default(),
            });
            continue;
        }
        let known = engine::all()
            .iter()
            .map(|entry| entry.name)
            .chain(exact::METHODS.iter().map(|method| method.name));
        let entry = engine::find(&name).map_err(|_| satisfice::Error::unknown("engine", &name, known))?;
        let built = entry.configure::<f64>(pairs(&settings))?;
        let parameters = Settings::typed(&built.parameters(), entry.parameters());
        if found
            .iter()
            .any(|known| known.name == name && known.parameters == parameters)
        {
            return Err(twice(&label));
        }
        found.push(Chosen {
            name,
            label,
            settings,
            parameters,
        });
    }
    Ok(found)
}

fn grids(choices: &[Choice]) -> impl Iterator<Item = (Vec<(String, String)>, String, String)> {
    choices.iter().flat_map(|choice| {
        let name = choice.name.clone();
        choice
            .grid()
            .into_iter()
            .map(move |(settings, label)| (settings, label, name.clone()))
    })
}

fn pairs(settings: &[(String, String)]) -> impl Iterator<Item = (&str, &str)> {
    settings
        .iter()
        .map(|(name, value)| (name.as_str(), value.as_str()))
}

fn twice(label: &str) -> Error {
    let what = format!("`{label}` is listed twice with the same parameters: leave one out");
    Error::Suite {
        place: "list".to_owned(),
        what,
    }
}

fn request(part: &Part, engine: &Chosen, seed: u64) -> Request {
    let budget = Budget {
        time: part.time,
        evaluations: part.evaluations,
        hits: part.hits,
        ..Budget::default()
    };
    let mut request = Request::new(&engine.name, budget).seed(seed);
    request.engine_settings.clone_from(&engine.settings);
    request.probes = part.probes;
    request.slices = part.slices;
    request
}

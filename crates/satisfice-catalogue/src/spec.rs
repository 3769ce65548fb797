//! What to run: the one description that the command line, suites, checkpoints and reports share.

use core::time::Duration;

use satisfice::engine;
use satisfice::{Budget, Cancel, Real};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::error::Error;
use crate::method;
use crate::settings::Settings;

/// A run: a problem, an engine, a seed and a budget.
///
/// Under a budget of evaluations the same specification gives the same report, apart from times, on any number of threads; on
/// another platform the last bit of `exp` or `sin` may change it. As JSON it is the first part of a [`RunReport`](crate::RunReport).
///
/// ```
/// use satisfice_catalogue::RunSpec;
/// let spec = RunSpec::new("latest-hit-qpso").set("particles", "60").evaluations(10_000).seed(1);
/// let again: RunSpec = serde_json::from_str(&serde_json::to_string(&spec)?)?;
/// assert_eq!(again, spec);
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunSpec {
    /// Name of the problem. An [`Instance`](crate::Instance) enters its own.
    pub problem: String,
    /// Parameters of the problem. An [`Instance`](crate::Instance) enters its own.
    pub problem_parameters: Settings,
    /// Name of the engine, or of an [exact method](crate::exact).
    pub engine: String,
    /// Parameters of the engine; those that are missing have their defaults. A report lists all of them.
    pub engine_parameters: Settings,
    /// The seed; 0 by default.
    pub seed: u64,
    /// The limits of the run; none by default.
    pub budget: Limits,
    /// The share of the evaluations spent on uniform probes, from 0 to 0.5; `None`, the default, leaves it to the engine.
    #[serde(default, rename = "requested_probe_share")]
    pub probes: Option<f64>,
    /// The number of engines that run side by side and share their hits; 1 by default.
    #[serde(default = "one")]
    pub islands: usize,
    /// The number of threads that evaluate, 0 for one per core; 1 by default. It does not change the result and is not saved.
    #[serde(skip, default = "one")]
    pub threads: usize,
}

/// The budget of each slice, and the number of slices.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Wall time per slice.
    #[serde(
        rename = "time_seconds",
        serialize_with = "to_seconds",
        deserialize_with = "from_seconds"
    )]
    pub time: Option<Duration>,
    /// Evaluations per slice.
    pub evaluations: Option<u64>,
    /// The number of distinct hits at which the run ends.
    pub hits: Option<u64>,
    /// Evaluations in succession without a new hit after which a slice ends ([`Budget::and_patience`]).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub patience: Option<u64>,
    /// The number of slices, each warm from the previous one. The run ends earlier when the space is covered, enough hits
    /// are found, or it is cancelled.
    pub slices: u64,
    /// How many evaluations can go on at once ([`Budget::with_parallel`]); one by default. It changes the result.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parallel: Option<usize>,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            time: None,
            evaluations: None,
            hits: None,
            patience: None,
            slices: 1,
            parallel: None,
        }
    }
}

fn one() -> usize {
    1
}

fn to_seconds<S: Serializer>(time: &Option<Duration>, serializer: S) -> Result<S::Ok, S::Error> {
    time.map(|time| time.as_secs_f64()).serialize(serializer)
}

fn from_seconds<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Duration>, D::Error> {
    let seconds = Option::<f64>::deserialize(deserializer)?;
    let time = seconds.map(Duration::try_from_secs_f64).transpose();
    time.map_err(serde::de::Error::custom)
}

impl RunSpec {
    /// One slice of an engine with its default parameters and without a limit, seed 0, one thread.
    #[must_use]
    pub fn new(engine: &str) -> Self {
        Self {
            problem: String::new(),
            problem_parameters: Settings::default(),
            engine: engine.to_owned(),
            engine_parameters: Settings::default(),
            seed: 0,
            budget: Limits::default(),
            probes: None,
            islands: 1,
            threads: 1,
        }
    }

    /// Sets a parameter of the engine, as on the command line.
    #[must_use]
    pub fn set(mut self, name: &str, text: &str) -> Self {
        self.engine_parameters.set(name, text);
        self
    }

    /// Sets the seed.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Limits the evaluations of each slice.
    #[must_use]
    pub fn evaluations(mut self, evaluations: u64) -> Self {
        self.budget.evaluations = Some(evaluations);
        self
    }

    /// Limits the wall time of each slice.
    #[must_use]
    pub fn time(mut self, time: Duration) -> Self {
        self.budget.time = Some(time);
        self
    }

    /// Ends the run at this number of distinct hits.
    #[must_use]
    pub fn hits(mut self, hits: u64) -> Self {
        self.budget.hits = Some(hits);
        self
    }

    /// Sets the number of slices.
    #[must_use]
    pub fn slices(mut self, slices: u64) -> Self {
        self.budget.slices = slices;
        self
    }

    /// The same run with every parameter of its engine, typed.
    ///
    /// # Errors
    /// [`Error::Search`] for an unknown engine or parameter, with the nearest known name, or a value out of range;
    /// [`Error::NoSlices`].
    pub fn complete(mut self) -> Result<Self, Error> {
        if self.budget.slices == 0 {
            return Err(Error::NoSlices);
        }
        if method::find(&self.engine).is_some() {
            // An exact method has no parameters, so every name is unknown.
            let texts = self.engine_parameters.texts();
            satisfice::catalogue::Params::with(&[], &self.engine, pairs(&texts))?;
        } else {
            let built = self.configured_engine::<f64>()?;
            self.engine_parameters = built.parameters().into_iter().collect();
            self.engine = built.name().to_owned();
        }
        Ok(self)
    }

    /// The engine of this run with its parameters.
    pub(crate) fn configured_engine<S: Real>(&self) -> Result<engine::ConfiguredEngine<S>, satisfice::Error> {
        let texts = self.engine_parameters.texts();
        engine::find(&self.engine)?.configure(pairs(&texts))
    }

    /// The budget of one slice, which `cancel` ends as well.
    #[must_use]
    pub fn slice_budget(&self, cancel: &Cancel) -> Budget {
        Budget {
            time: self.budget.time,
            evaluations: self.budget.evaluations,
            hits: self.budget.hits,
            patience: self.budget.patience,
            parallel: self.budget.parallel,
            ..Budget::until(cancel)
        }
    }
}

fn pairs(texts: &[(String, String)]) -> impl Iterator<Item = (&str, &str)> + Clone {
    texts.iter().map(|(name, text)| (name.as_str(), text.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_specification_comes_back_from_json_but_for_its_threads() {
        let mut spec = RunSpec::new("random")
            .set("batch", "7")
            .time(Duration::from_millis(100))
            .hits(3)
            .slices(2)
            .complete()
            .unwrap();
        spec.threads = 8;
        let json = serde_json::to_value(&spec).unwrap();
        assert_eq!(json["budget"]["time_seconds"], 0.1);
        assert_eq!(json["engine_parameters"]["batch"], 7);
        let back: RunSpec = serde_json::from_value(json).unwrap();
        assert_eq!(back, RunSpec { threads: 1, ..spec });
        let complete = back.clone().complete().unwrap();
        assert_eq!(complete, back, "a complete specification is complete");
    }

    #[test]
    fn a_negative_time_is_refused() {
        let text = serde_json::to_string(&RunSpec::new("random").time(Duration::from_secs(1))).unwrap();
        let text = text.replace("1.0", "-1.0");
        assert!(serde_json::from_str::<RunSpec>(&text).is_err());
    }
}

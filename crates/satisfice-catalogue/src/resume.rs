//! Runs that are saved while they go on, and resumed.

use core::time::Duration;

use satisfice::{Budget, Cancel, Checkpoint, Report};
use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::run::Request;
use crate::settings::Settings;

/// What takes checkpoints.
pub type Save<'a> = dyn FnMut(&[u8]) + 'a;

/// Where a run comes from and where its checkpoints go; by default from its beginning and nowhere.
#[derive(Default)]
pub struct Keeping<'a> {
    /// A checkpoint to go on from.
    pub resume: Option<&'a [u8]>,
    /// Takes checkpoints: one at the beginning of each slice, about one in `every`, one when the run is cancelled, and one at
    /// the end.
    pub save: Option<&'a mut Save<'a>>,
    /// How often.
    pub every: Duration,
}

/// What was asked for when a run was saved: all of [`Request`] but the number of threads and the cancellation.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Saved {
    /// Name of the problem.
    pub problem: String,
    /// All its parameters.
    pub problem_parameters: Settings,
    /// Name of the engine.
    pub engine: String,
    /// The parameters of the engine that were set.
    pub engine_settings: Vec<(String, String)>,
    /// The seed.
    pub seed: u64,
    /// The share of probes, where one was given.
    pub probes: Option<f64>,
    /// The budget of each slice.
    pub budget: Budget,
    /// How many slices.
    pub slices: u64,
}

/// A checkpoint of a run: the slices that have ended, and the search.
#[derive(Serialize, Deserialize)]
#[serde(bound(
    serialize = "T: Serialize",
    deserialize = "T: serde::de::DeserializeOwned + satisfice::Identity"
))]
pub(crate) struct SavedRun<T> {
    #[serde(flatten)]
    pub(crate) asked: Saved,
    pub(crate) reports: Vec<Report<T>>,
    pub(crate) search: Checkpoint<T>,
}

impl Saved {
    pub(crate) fn new(problem: &str, parameters: &Settings, request: &Request) -> Self {
        Self {
            problem: problem.to_owned(),
            problem_parameters: parameters.clone(),
            engine: request.engine.clone(),
            engine_settings: request.engine_settings.clone(),
            seed: request.seed,
            probes: request.probes,
            budget: request.budget.clone(),
            slices: request.slices,
        }
    }

    /// Reads what was asked for from a checkpoint.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] where it is none.
    pub fn read(checkpoint: &[u8]) -> Result<Self, Error> {
        serde_json::from_slice(checkpoint).map_err(|error| Error::Checkpoint(error.to_string()))
    }

    /// The request that goes on with it.
    #[must_use]
    pub fn request(self, threads: usize, cancel: &Cancel) -> Request {
        Request {
            engine: self.engine,
            engine_settings: self.engine_settings,
            seed: self.seed,
            threads,
            islands: 1, // of which no checkpoints are kept
            probes: self.probes,
            budget: self.budget.and_until(cancel),
            slices: self.slices,
        }
    }

    /// # Errors
    /// [`Error::Other`] for the first thing that differs.
    pub(crate) fn agrees(&self, now: &Self) -> Result<(), Error> {
        let parts = |of: &Self| {
            [
                ("problem", of.problem.clone()),
                (
                    "set of problem parameters",
                    format!("{:?}", of.problem_parameters.texts()),
                ),
                ("engine", of.engine.clone()),
                ("set of engine parameters", format!("{:?}", of.engine_settings)),
                ("seed", of.seed.to_string()),
                ("share of probes", format!("{:?}", of.probes)),
                ("time", format!("{:?}", of.budget.time)),
                ("number of evaluations", format!("{:?}", of.budget.evaluations)),
                ("number of hits", format!("{:?}", of.budget.hits)),
                ("number of slices", of.slices.to_string()),
            ]
        };
        for ((what, saved), (_, now)) in parts(self).into_iter().zip(parts(now)) {
            if saved != now {
                return Err(Error::Other { what, saved, now });
            }
        }
        Ok(())
    }
}

//! Checkpoints of runs.

use satisfice::{Checkpoint, Report};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::error::Error;
use crate::sealed::{self, Broken};
use crate::spec::RunSpec;

/// A checkpoint of a run: its specification, the reports of the slices that have ended, and the state of the search.
#[derive(Serialize, Deserialize)]
#[serde(bound = "T: Serialize + DeserializeOwned + satisfice::Identity")]
pub(crate) struct SavedRun<T> {
    #[serde(flatten)]
    pub(crate) spec: RunSpec,
    pub(crate) reports: Vec<Report<T>>,
    pub(crate) search: Checkpoint<T>,
}

/// The same, written from where its parts are.
#[derive(Serialize)]
#[serde(bound(serialize = "T: Serialize + DeserializeOwned + satisfice::Identity"))]
pub(crate) struct Saved<'a, T> {
    #[serde(flatten)]
    pub(crate) spec: &'a RunSpec,
    pub(crate) reports: &'a [Report<T>],
    pub(crate) search: &'a Checkpoint<T>,
}

/// The bytes of a checkpoint.
pub(crate) fn write<T: Serialize + DeserializeOwned + satisfice::Identity>(
    saved: &Saved<'_, T>,
) -> serde_json::Result<Vec<u8>> {
    Ok(sealed::seal(&serde_json::to_string(saved)?).into_bytes())
}

/// What the bytes of a checkpoint say.
///
/// # Errors
/// [`Error::Checkpoint`] for bytes that are not a checkpoint, or a damaged one.
pub(crate) fn read<T: DeserializeOwned>(checkpoint: &[u8]) -> Result<T, Error> {
    let object = sealed::open(checkpoint).map_err(|broken| {
        Error::Checkpoint(match broken {
            Broken::Unsealed => "it does not begin with a checksum".to_owned(),
            Broken::Damaged => "the checkpoint is damaged".to_owned(),
        })
    })?;
    serde_json::from_str(&object).map_err(|error| Error::Checkpoint(error.to_string()))
}

/// The specification of the run that a checkpoint belongs to.
///
/// # Errors
/// [`Error::Checkpoint`] for bytes that are not a checkpoint, or a damaged one.
pub fn spec(checkpoint: &[u8]) -> Result<RunSpec, Error> {
    read(checkpoint)
}

/// Checks that a checkpoint of `saved` can continue as `now`.
///
/// # Errors
/// [`Error::Differs`] for the first part that differs.
pub fn check_same(saved: &RunSpec, now: &RunSpec) -> Result<(), Error> {
    let [saved, now] = [saved, now].map(serde_json::to_value);
    difference("", &saved?, &now?).map_or(Ok(()), Err)
}

/// The first place at which two values differ.
fn difference(place: &str, saved: &Value, now: &Value) -> Option<Error> {
    if let (Value::Object(old), Value::Object(new)) = (saved, now) {
        let names = old.keys().chain(new.keys());
        return names.into_iter().find_map(|name| {
            let dot = if place.is_empty() { "" } else { "." };
            let [old, new] = [old, new].map(|map| map.get(name).unwrap_or(&Value::Null));
            difference(&format!("{place}{dot}{name}"), old, new)
        });
    }
    (saved != now).then(|| Error::Differs {
        what: place.to_owned(),
        saved: saved.to_string(),
        now: now.to_string(),
    })
}

//! Studies: measurements that a grid of engines and problems cannot express, such as a moving scene. A suite names them.

mod cloth_frames;

use satisfice::Cancel;

use crate::error::Error;
use crate::finding::Finding;

/// The function that runs a study.
pub type Run = fn(u64, &Cancel, &mut dyn FnMut(&str)) -> Result<Option<Finding>, Error>;

/// A study.
#[derive(Debug, Clone, Copy)]
pub struct Study {
    /// Its name.
    pub name: &'static str,
    /// Runs it; `None` once it is cancelled. Its arguments are the number of seeds, the cancellation, and a function that shows progress.
    pub run: Run,
}

/// All of them.
pub static STUDIES: &[Study] = &[
    Study {
        name: "cloth-frames",
        run: cloth_frames::run,
    },
    Study {
        name: "cloth-frames-smoke",
        run: cloth_frames::smoke,
    },
];

/// The study with this name.
///
/// # Errors
/// [`Error::Run`] with the nearest name.
pub fn find(name: &str) -> Result<&'static Study, Error> {
    let unknown = || satisfice::Error::unknown("study", name, STUDIES.iter().map(|study| study.name));
    STUDIES
        .iter()
        .find(|study| study.name == name)
        .ok_or_else(|| unknown().into())
}

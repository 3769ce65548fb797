//! `satisfice collide`: pairs of mesh features that are closer than a threshold.

mod exact;
mod report;
mod scene;
mod search;

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::{Context, bail};
use satisfice::engine;
use satisfice_bench::{Mismatch, json};

use crate::arguments::CollideArguments;
use crate::{interrupt, output, reference, summary};
use report::Report;
use scene::Scene;

/// The problem's name in a report.
pub(crate) const PROBLEM: &str = "collide";
/// The method that needs no engine.
const EXACT: &str = "exact";

pub(crate) fn collide(arguments: &CollideArguments) -> anyhow::Result<ExitCode> {
    let methods = || std::iter::once(EXACT).chain(engine::all().iter().map(|entry| entry.name));
    if !methods().any(|method| method == arguments.method) {
        return Err(satisfice::Error::unknown("method", &arguments.method, methods()).into());
    }
    let scene = Arc::new(Scene::read(
        &arguments.meshes,
        arguments.threshold,
        arguments.within,
    )?);
    let (record, mut files) = if arguments.method == EXACT {
        if arguments.search.is_for_a_search() {
            bail!(
                "--method exact finds every pair and takes no budget and no engine parameters: leave them out or choose an engine"
            );
        }
        let files = Files::open(arguments)?;
        (exact::find(&scene), files)
    } else {
        let cancel = interrupt::listen()?;
        let request = arguments.search.request(&arguments.method, &cancel)?;
        let files = Files::open(arguments)?;
        let mut record = search::find(&scene, &request)?;
        if scene.is_small() {
            let counted = Arc::clone(&scene);
            record.set_reference(reference::wait_for("the scene", &cancel, move || {
                Some(counted.reference_hits())
            }));
        }
        (record, files)
    };
    files.finish(&Report::new(record, &scene)?)
}

/// Where the results go.
struct Files {
    json: Option<output::Output>,
    csv: Option<output::Output>,
    summary: bool,
}

impl Files {
    fn open(arguments: &CollideArguments) -> anyhow::Result<Self> {
        let stdout = Some(Path::new("-"));
        Ok(Self {
            json: output::open(arguments.json.as_ref())?,
            csv: output::open(arguments.out.as_ref())?,
            summary: arguments.json.as_deref() != stdout && arguments.out.as_deref() != stdout,
        })
    }

    fn finish(&mut self, report: &Report) -> anyhow::Result<ExitCode> {
        if let Some(file) = &mut self.json {
            file.write(&json::to_vec(report)?)?;
        }
        if let Some(file) = &mut self.csv {
            file.write(report.csv().as_bytes())?;
        }
        if self.summary {
            output::print(report.summary().as_bytes())?;
        }
        Ok(summary::exit_code(&report.record))
    }
}

/// Reads the meshes of a report again and measures its pairs anew.
pub(crate) fn verify(text: &[u8]) -> anyhow::Result<Vec<Mismatch>> {
    let report: Report = serde_json::from_slice(text).context("the report is none of `collide --json`")?;
    let scene = Scene::of_report(&report.record).context("the scene of the report cannot be built")?;
    Ok(report.verify(&scene))
}

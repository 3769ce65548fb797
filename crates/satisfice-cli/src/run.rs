//! `satisfice run`: an engine on a problem of the catalogue.

use std::process::ExitCode;
use std::sync::Arc;

use satisfice_bench::{Instance, Record, catalogue, json, plot};

use crate::arguments::RunArguments;
use crate::output::{self, Output};
use crate::progress::Bar;
use crate::{interrupt, reference, summary};

pub(crate) fn run(arguments: &RunArguments) -> anyhow::Result<ExitCode> {
    let settings = arguments
        .set
        .iter()
        .map(|(name, value)| (name.as_str(), value.as_str()));
    let problem: Arc<dyn Instance> = catalogue::find(&arguments.problem)?.build(settings)?.into();
    let cancel = interrupt::listen()?;
    let mut request = arguments.search.request(&arguments.engine, &cancel)?;
    request.slices = arguments.slices;
    let mut report = output::open(arguments.json.as_ref())?;
    let mut figure = match &arguments.plot {
        Some(path) => Some((plot::Format::of(path)?, Output::open(path)?)),
        None => None,
    };

    let bar = Bar::new();
    let mut record = problem.run(&request, &mut |progress| {
        bar.show(progress, progress.slice, request.slices);
    })?;
    drop(bar);
    let counted = Arc::clone(&problem);
    record.set_reference(reference::wait_for(problem.name(), &cancel, move || {
        counted.reference_hits()
    }));

    if let Some(report) = &mut report {
        report.write(&json::to_vec(&record)?)?;
    }
    if let Some((format, figure)) = &mut figure {
        figure.write(&plot::draw(&plot::chart(&record), *format)?)?;
    }
    show(&record, arguments.json.as_deref())
}

/// The summary, unless stdout has the report itself.
fn show(record: &Record, json: Option<&std::path::Path>) -> anyhow::Result<ExitCode> {
    if json != Some(std::path::Path::new("-")) {
        output::print(summary::summary(record).as_bytes())?;
    }
    Ok(summary::exit_code(record))
}

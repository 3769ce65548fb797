//! `satisfice run`: an engine on a problem of the catalogue.

use std::process::ExitCode;
use std::sync::Arc;

use satisfice_catalogue::{Instance, Keeping, Progress, Record, catalogue, json};
use satisfice_draw::plot;

use crate::arguments::{DEFAULT_ENGINE, RunArguments};
use crate::output::{self, Output};
use crate::progress::Bar;
use crate::{checkpoint, interrupt, reference, summary};

pub(crate) fn run(arguments: &RunArguments) -> anyhow::Result<ExitCode> {
    let begun = arguments.resume.as_deref().map(checkpoint::read).transpose()?;
    let set = match &begun {
        Some((_, saved)) if arguments.set.is_empty() => saved.problem_parameters.texts(),
        _ => arguments.set.clone(),
    };
    let settings = set.iter().map(|(name, value)| (name.as_str(), value.as_str()));
    let entry = catalogue::find(&arguments.problem)?;
    if let Some((_, saved)) = &begun {
        checkpoint::is_of(saved, &arguments.problem)?;
    }
    let problem: Arc<dyn Instance> = entry.build(settings)?.into();
    let cancel = interrupt::listen()?;
    let request = match &begun {
        Some((_, saved)) => checkpoint::request(saved, arguments, &cancel),
        None => {
            let engine = arguments.engine.as_deref().unwrap_or(DEFAULT_ENGINE);
            let mut request = arguments.search.request(engine, &cancel)?;
            request.slices = arguments.slices.unwrap_or(1);
            request.islands = arguments.islands;
            request
        }
    };
    let mut keeper = arguments
        .checkpoint
        .as_deref()
        .map(checkpoint::Keeper::new)
        .transpose()?;
    let mut report = output::open(arguments.json.as_ref())?;
    let mut figure = match &arguments.plot {
        Some(path) => Some((plot::Format::of(path)?, Output::open(path)?)),
        None => None,
    };

    let bar = Bar::new();
    let mut watch = |progress: &Progress| bar.show(progress, progress.slice, request.slices);
    let mut record = if begun.is_none() && keeper.is_none() {
        problem.run(&request, &mut watch)?
    } else {
        let mut save = keeper.as_mut().map(|keeper| |bytes: &[u8]| keeper.save(bytes));
        let keeping = Keeping {
            resume: begun.as_ref().map(|(bytes, _)| bytes.as_slice()),
            save: save.as_mut().map(|save| save as &mut dyn FnMut(&[u8])),
            every: checkpoint::EVERY,
        };
        problem.run_keeping(&request, &mut watch, keeping)?
    };
    drop(bar);
    let counted = Arc::clone(&problem);
    record.set_reference(reference::wait_for(problem.name(), &cancel, move || {
        counted.reference_hits()
    }));

    if let Some(report) = &mut report {
        report.write(&json::to_vec(&record)?)?;
    }
    if let Some((format, figure)) = &mut figure {
        figure.write(&plot::draw(&crate::plot::chart(&record), *format)?)?;
    }
    let shown = show(&record, arguments.json.as_deref())?;
    keeper.map_or(Ok(()), checkpoint::Keeper::finish)?;
    Ok(shown)
}

/// The summary, unless stdout has the report itself.
fn show(record: &Record, json: Option<&std::path::Path>) -> anyhow::Result<ExitCode> {
    if json != Some(std::path::Path::new("-")) {
        output::print(summary::summary(record).as_bytes())?;
    }
    Ok(summary::exit_code(record))
}

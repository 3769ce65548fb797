//! `satisfice run`: an engine on a problem of the catalogue.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::anyhow;
use satisfice::engine;
use satisfice_catalogue::{Catalogue, Instance, ProblemSpec, Progress, RunControl, RunSpec, json};
use satisfice_draw::plot::{self, Format};

use crate::arguments::{DEFAULT_ENGINE, RunArguments, check_once};
use crate::checkpoint::{self, Keeper};
use crate::output::{self, Output, Steps};
use crate::places::{self, Places};
use crate::plot::chart;
use crate::progress::Bar;
use crate::{interrupt, message, page, program, reference, summary};

pub(crate) fn run(arguments: &RunArguments, catalogue: &Catalogue) -> anyhow::Result<ExitCode> {
    if arguments.program.is_given() {
        return program::run(arguments);
    }
    page::check(arguments.page.as_deref())?;
    check_once("--set", &arguments.set)?;
    arguments.search.check()?;
    let named = arguments.problem.as_deref();
    let known = named.map(|name| problem(catalogue, name)).transpose()?;
    let resume = arguments.resume.as_deref();
    let resumed = resume.map(|path| checkpoint::read(path, named)).transpose()?;
    let known = match (known, &resumed) {
        (Some(known), _) => known,
        (None, Some((_, saved))) => catalogue.find(&saved.problem)?,
        (None, None) => anyhow::bail!(
            "no problem is named: `satisfice list` shows them all; or give --program, --worker or --resume"
        ),
    };
    arguments.program.check_unused(known.parameters)?;
    let set = match &resumed {
        Some((_, saved)) if arguments.set.is_empty() => saved.problem_parameters.texts(),
        _ => arguments.set.clone(),
    };
    let settings = set.iter().map(|(name, value)| (name.as_str(), value.as_str()));
    let problem: Arc<dyn Instance> = known.build(settings)?.into();
    places(arguments).reads(problem.files()).check()?;
    let spec = spec(arguments, resumed.as_ref().map(|(_, saved)| saved))?;

    let cancel = interrupt::listen()?;
    let mut keeper = arguments.checkpoint.as_deref().map(Keeper::new).transpose()?;
    let mut json_file = output::open(arguments.json.as_ref())?;
    let mut page_file = output::open(arguments.page.as_ref())?;
    let mut figure = match &arguments.plot {
        Some(path) => Some((Format::of(path)?, Output::open(path)?)),
        None => None,
    };

    let bar = Bar::new();
    let mut watch = |progress: &Progress| bar.show(progress, progress.slice, spec.budget.slices);
    let mut save = keeper.as_mut().map(|keeper| |bytes: &[u8]| keeper.save(bytes));
    let mut remark = |text: &str| message::say(format_args!("note: {text}"));
    let control = RunControl {
        cancel: cancel.clone(),
        watch: Some(&mut watch),
        resume: resumed.as_ref().map(|(bytes, _)| bytes.as_slice()),
        save: save.as_mut().map(|save| save as &mut dyn FnMut(&[u8])),
        every: arguments.checkpoint_every,
        remark: Some(&mut remark),
    };
    let mut report = problem.run(&spec, control)?;
    drop(bar);
    let counted = Arc::clone(&problem);
    let to_stdout = [&arguments.json, &arguments.page]
        .into_iter()
        .flatten()
        .any(|path| path == Path::new("-"));
    let mut steps = Steps::default();
    let mut shown_before = false;
    let hits = reference::wait_for(
        problem.name(),
        arguments.search.patience(report.elapsed_seconds),
        &cancel,
        || {
            if !to_stdout {
                steps.step(output::print(summary::before_the_count(&report).as_bytes()));
                shown_before = true;
            }
        },
        move || counted.reference_hits(),
    );
    report.set_reference(hits);

    if let Some(file) = &mut json_file {
        steps.step(
            json::to_vec(&report)
                .map_err(Into::into)
                .and_then(|json| file.write(&json)),
        );
    }
    if let Some((format, figure)) = &mut figure {
        let drawn = plot::draw(&chart(&report), *format);
        steps.step(drawn.map_err(Into::into).and_then(|drawn| figure.write(&drawn)));
    }
    if let Some(file) = &mut page_file {
        steps.step(page::html(&report).and_then(|page| file.write(page.as_bytes())));
    }
    if shown_before {
        steps.step(output::print(summary::count(&report).as_bytes()));
    } else if !to_stdout {
        steps.step(output::print(summary::summary(&report).as_bytes()));
    }
    steps.step(keeper.map_or(Ok(()), Keeper::finish));
    steps.outcome()?;
    Ok(summary::exit_code(&report))
}

/// The problem of this name.
fn problem<'a>(catalogue: &'a Catalogue, name: &str) -> anyhow::Result<&'a ProblemSpec> {
    catalogue.find(name).map_err(|error| match engine::find(name) {
        Ok(_) => anyhow!("`{name}` is an engine: run PROBLEM --engine {name}"),
        Err(_) => error.into(),
    })
}

/// The files that the arguments name.
fn places(arguments: &RunArguments) -> Places {
    let checkpoint = arguments.checkpoint.as_ref();
    // A run may go on with its own checkpoint; all others are kept.
    let is_own = |resume: &PathBuf| checkpoint.is_some_and(|path| places::is_same(path, resume));
    Places::default()
        .reads(arguments.resume.iter().filter(|resume| !is_own(resume)).cloned())
        .writes("--json", arguments.json.as_ref())
        .writes("--checkpoint", checkpoint)
        .writes("--plot", arguments.plot.as_ref())
        .writes("--page", arguments.page.as_ref())
}

/// What to run: the arguments, and for a resumed run what its checkpoint says where they say nothing.
fn spec(arguments: &RunArguments, saved: Option<&RunSpec>) -> anyhow::Result<RunSpec> {
    let Some(saved) = saved else {
        let engine = arguments.engine.as_deref().unwrap_or(DEFAULT_ENGINE);
        let mut spec = arguments.search.spec(engine)?;
        arguments.slices.enter(&mut spec);
        return Ok(spec);
    };
    let mut spec = saved.clone();
    if let Some(engine) = arguments
        .engine
        .as_ref()
        .filter(|engine| **engine != saved.engine)
    {
        spec.engine.clone_from(engine);
        spec.engine_parameters = satisfice_catalogue::Settings::default();
    }
    arguments.search.enter(&mut spec);
    arguments.slices.enter(&mut spec);
    Ok(spec)
}

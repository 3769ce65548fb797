//! `satisfice completions`: a script that completes the command in a shell, including the names of problems and engines.

use std::process::ExitCode;

use clap::CommandFactory;
use clap::builder::PossibleValuesParser;
use satisfice::engine;
use satisfice_catalogue::Catalogue;

use crate::arguments::{CompletionsArguments, Satisfice};
use crate::output;

pub(crate) fn completions(
    arguments: &CompletionsArguments,
    catalogue: &Catalogue,
) -> anyhow::Result<ExitCode> {
    let engines = || engine::all().iter().map(|entry| entry.name);
    let names: Vec<&'static str> = catalogue.problems().iter().map(|problem| problem.name).collect();
    let listed: Vec<&'static str> = engines().chain(names.iter().copied()).collect();
    let mut command = Satisfice::command()
        .mut_subcommand("list", |list| {
            list.mut_arg("names", |arg| arg.value_parser(PossibleValuesParser::new(listed)))
        })
        .mut_subcommand("run", |run| {
            run.mut_arg("problem", |arg| {
                arg.value_parser(PossibleValuesParser::new(names))
            })
            .mut_arg("engine", |arg| {
                arg.value_parser(PossibleValuesParser::new(engines()))
            })
        })
        .mut_subcommand("collide", |collide| {
            collide.mut_arg("method", |arg| {
                arg.value_parser(PossibleValuesParser::new(
                    std::iter::once("exact").chain(engines()),
                ))
            })
        });
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command, "satisfice", &mut script);
    output::print(&script)?;
    Ok(ExitCode::SUCCESS)
}

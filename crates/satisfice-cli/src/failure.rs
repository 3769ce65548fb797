//! How errors are reported: one line on stderr that says what is wrong and how to fix it, exit code 2.

use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

use clap::CommandFactory;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use satisfice::engine;

use crate::arguments::Satisfice;
use crate::message;

/// Exit code of every error.
pub(crate) const ERROR: u8 = 2;

/// Reports an error.
pub(crate) fn report(error: &anyhow::Error) -> ExitCode {
    let mut said = String::new();
    for cause in error.chain().map(ToString::to_string) {
        // Some errors repeat their cause in their own words.
        if !said.contains(&cause) {
            if !said.is_empty() {
                said.push_str(": ");
            }
            said.push_str(&cause);
        }
    }
    tell(&said)
}

/// Reports a mistake in the command line, which is given; help and version, which arrive here as well, go to stdout.
pub(crate) fn usage(error: &clap::Error, line: &[OsString]) -> ExitCode {
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        let printed = error.print().and_then(|()| std::io::stdout().flush());
        return match printed {
            // A closed pipe is not an error of the reader.
            Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
                tell(&format!("cannot write to stdout: {error}"))
            }
            _ => ExitCode::SUCCESS,
        };
    }
    tell(&one_line(error, line))
}

/// The message, the tips and the way to the help; the usage in between is in the help as well.
fn one_line(error: &clap::Error, line: &[OsString]) -> String {
    let text = error.to_string();
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let subcommands = || {
        let command = Satisfice::command();
        let names: Vec<_> = command.get_subcommands().map(clap::Command::get_name).collect();
        format!("known: {}; see --help", names.join(", "))
    };
    if error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        return format!("no subcommand is given; {}", subcommands());
    }
    let mut said = lines
        .next()
        .unwrap_or_default()
        .trim_start_matches("error: ")
        .to_owned();
    if is_below_zero(error) {
        return format!(
            "{said}; a value that begins with - is joined to its option, as in --from=-1s; see --help"
        );
    }
    if let Some(unknown) = as_unknown(error) {
        return unknown.to_string();
    }
    if let Some(name) = as_engine(error, line) {
        return name;
    }
    if let Some(assignment) = as_parameter(error, line) {
        return format!(
            "{said}; --set {assignment} sets a parameter of the problem, --engine-set one of the engine; see --help"
        );
    }
    for line in lines {
        let known = line.strip_prefix("tip: ").or_else(|| {
            // Lists such as the possible values, and the names of what is missing.
            (!line.starts_with("Usage:") && !line.starts_with("For more information")).then_some(line)
        });
        if let Some(line) = known {
            said.push_str(if said.ends_with(':') { " " } else { "; " });
            said.push_str(line);
        }
    }
    said.push_str("; ");
    said.push_str(&if error.kind() == ErrorKind::InvalidSubcommand {
        subcommands()
    } else {
        "see --help".to_owned()
    });
    said
}

/// Whether a number below 0 was taken for an option.
fn is_below_zero(error: &clap::Error) -> bool {
    let argument = error.get(ContextKind::InvalidArg).map(ToString::to_string);
    let digits = argument
        .as_deref()
        .and_then(|argument| argument.strip_prefix('-'));
    error.kind() == ErrorKind::UnknownArgument
        && digits.is_some_and(|digits| digits.starts_with(|c: char| c.is_ascii_digit()))
}

/// A word that is none of those which an argument takes.
fn as_unknown(error: &clap::Error) -> Option<satisfice::Error> {
    let text = |kind| match error.get(kind)? {
        ContextValue::String(text) => Some(text.as_str()),
        _ => None,
    };
    let argument = text(ContextKind::InvalidArg)?;
    // Without a value there is nothing to compare.
    let value = text(ContextKind::InvalidValue).filter(|value| !value.is_empty())?;
    let Some(ContextValue::Strings(known)) = error.get(ContextKind::ValidValue) else {
        return None;
    };
    let what = match argument.strip_prefix('<') {
        Some(place) => place.trim_end_matches('>').to_lowercase(),
        None => format!("value of `{}`", argument.split(' ').next()?),
    };
    let known = known.iter().map(String::as_str);
    Some(satisfice::Error::unknown(&what, value, known))
}

/// How an engine is chosen, if an unknown argument names one or would choose one elsewhere.
fn as_engine(error: &clap::Error, line: &[OsString]) -> Option<String> {
    let is_new = error.kind() == ErrorKind::UnknownArgument;
    let argument = error.get(ContextKind::InvalidArg).filter(|_| is_new)?.to_string();
    if takes(line, "engine") && engine::find(&argument).is_ok() {
        return Some(format!("`{argument}` is an engine: --engine {argument}"));
    }
    if argument != "--engine" || !takes(line, "method") {
        return None;
    }
    let mut words = line.iter().filter_map(|word| word.to_str());
    let name = words.find_map(|word| {
        word.strip_prefix("--engine=")
            .or((word == "--engine").then_some(""))
    });
    let name = name
        .filter(|name| !name.is_empty())
        .or(words.next())
        .unwrap_or("NAME");
    Some(format!("collide chooses an engine by --method: --method {name}"))
}

/// Whether the subcommand that was called has this argument.
fn takes(line: &[OsString], id: &str) -> bool {
    let command = Satisfice::command();
    let subcommand = line.get(1).and_then(|name| command.find_subcommand(name));
    subcommand.is_some_and(|subcommand| subcommand.get_arguments().any(|known| known.get_id() == id))
}

/// What was meant, if an unknown argument may be a parameter: `NAME=VALUE`.
fn as_parameter(error: &clap::Error, line: &[OsString]) -> Option<String> {
    let is_new = error.kind() == ErrorKind::UnknownArgument && error.get(ContextKind::SuggestedArg).is_none();
    let argument = error.get(ContextKind::InvalidArg).filter(|_| is_new)?.to_string();
    if !takes(line, "set") {
        return None;
    }
    if argument.contains('=') && !argument.starts_with('-') {
        return Some(argument);
    }
    let name = argument.strip_prefix("--").filter(|name| name.len() > 1)?;
    Some(if name.contains('=') {
        name.to_owned()
    } else {
        format!("{name}=VALUE")
    })
}

fn tell(message: &str) -> ExitCode {
    let line = message.split_whitespace().collect::<Vec<_>>().join(" ");
    // Where stderr is closed, the message cannot be shown.
    drop(writeln!(std::io::stderr(), "error: {}", message::plain(&line)));
    ExitCode::from(ERROR)
}

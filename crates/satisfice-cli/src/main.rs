//! The command `satisfice`.

mod arguments;
mod bench;
mod checkpoint;
mod collide;
mod completions;
mod failure;
mod interrupt;
mod list;
mod output;
mod plot;
mod progress;
mod quantity;
mod reference;
mod run;
mod summary;
mod verify;

use std::process::ExitCode;

use arguments::Command;

fn main() -> ExitCode {
    let command = match arguments::parse() {
        Ok(command) => command,
        Err(error) => return failure::usage(&error),
    };
    let outcome = match command {
        Command::List(arguments) => list::list(&arguments),
        Command::Run(arguments) => run::run(&arguments),
        Command::Collide(arguments) => collide::collide(&arguments),
        Command::Bench(arguments) => bench::bench(&arguments),
        Command::Verify(arguments) => verify::verify(&arguments),
        Command::Completions(arguments) => completions::completions(&arguments),
    };
    outcome.unwrap_or_else(|error| failure::report(&error))
}

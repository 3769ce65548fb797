//! The command `satisfice` with the bundled problems.

use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: satisfice_cli::Allocator = satisfice_cli::Allocator;

fn main() -> ExitCode {
    satisfice_cli::Command::new().main()
}

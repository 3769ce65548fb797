//! The command `satisfice` with the bundled problems.

use std::process::ExitCode;

fn main() -> ExitCode {
    satisfice_cli::Command::new().main()
}

//! Ctrl-C: the first one ends the search and keeps its hits, the second one ends the program.

use anyhow::Context;
use satisfice::Cancel;

/// The exit code that shells use for a program ended by Ctrl-C.
const INTERRUPTED: i32 = 130;

/// Listens for Ctrl-C and SIGTERM.
pub(crate) fn listen() -> anyhow::Result<Cancel> {
    let cancel = Cancel::new();
    let flag = cancel.clone();
    ctrlc::set_handler(move || {
        if flag.is_cancelled() {
            std::process::exit(INTERRUPTED);
        }
        flag.cancel();
    })
    .context("cannot listen for Ctrl-C")?;
    Ok(cancel)
}

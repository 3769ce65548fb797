//! Messages on stderr: progress, warnings, hints. A result never depends on whether they can be written.

use std::fmt::Display;
use std::io::Write;

/// Writes a line to stderr and ignores a stderr that is closed or full.
pub(crate) fn say(line: impl Display) {
    drop(writeln!(std::io::stderr(), "{line}"));
}

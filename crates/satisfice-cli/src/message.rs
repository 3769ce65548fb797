//! Messages on stderr: progress, warnings, hints. A result never depends on whether they can be written.

use std::fmt::Display;
use std::io::Write;

/// The most of a message that is shown: names and values of the user may be long.
const LONGEST: usize = 1800;

/// Writes a line to stderr and ignores a stderr that is closed or full.
pub(crate) fn say(line: impl Display) {
    drop(writeln!(std::io::stderr(), "{}", plain(&line.to_string())));
}

/// A message without control characters, which could steer the terminal, and of bounded length: names and values of the user
/// are quoted in it.
pub(crate) fn plain(message: &str) -> String {
    let mut text = String::with_capacity(message.len().min(LONGEST));
    for c in message.chars() {
        if text.len() > LONGEST {
            text.push_str("...");
            break;
        }
        match c {
            c if c.is_control() => text.extend(c.escape_default()),
            c => text.push(c),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_plain_and_of_bounded_length() {
        assert_eq!(
            plain("a\u{1b}[31m\u{9b}b\n\u{e4}"),
            "a\\u{1b}[31m\\u{9b}b\\n\u{e4}"
        );
        let cut = plain(&"ü".repeat(100_000));
        assert!(cut.len() < LONGEST + 10 && cut.ends_with("..."));
    }
}

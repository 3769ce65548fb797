//! Values in a line for /bin/sh, quoted where it would read them as anything else.

/// What surrounds a place of a line.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Inside {
    /// Parentheses, also those of `$(...)`: words, as outside of everything.
    Parentheses,
    /// Single quotes.
    Single,
    /// Double quotes.
    Double,
}

/// A line with values in their places. `find` says of the rest of a line how long the place at its beginning is, if it is one, and which
/// values belong there; several become several words.
pub(super) fn fill<'a>(line: &str, find: impl Fn(&str) -> Option<(usize, &'a [String])>) -> String {
    let (mut filled, mut rest, mut around) = (String::new(), line, Vec::new());
    while let Some(c) = rest.chars().next() {
        let inside = around.last().copied();
        if let Some((length, values)) = find(rest) {
            let quoted: Vec<String> = values.iter().map(|value| quote(value, inside)).collect();
            filled.push_str(&quoted.join(" "));
            rest = &rest[length..];
            continue;
        }
        let is_plain = matches!(inside, None | Some(Inside::Parentheses));
        let mut taken = c.len_utf8();
        match (c, inside) {
            ('\\', Some(Inside::Double | Inside::Parentheses) | None) => {
                taken = rest.char_indices().nth(2).map_or(rest.len(), |(next, _)| next);
            }
            ('\'', Some(Inside::Single)) | ('"', Some(Inside::Double)) | (')', Some(Inside::Parentheses)) => {
                around.pop();
            }
            ('\'', _) if is_plain => around.push(Inside::Single),
            ('"', _) if is_plain => around.push(Inside::Double),
            ('(', _) if is_plain || filled.ends_with('$') && inside == Some(Inside::Double) => {
                around.push(Inside::Parentheses);
            }
            _ => {}
        }
        filled.push_str(&rest[..taken]);
        rest = &rest[taken..];
    }
    filled
}

/// A value as the shell takes it literally there. Numbers and words stay as they are.
fn quote(value: &str, inside: Option<Inside>) -> String {
    let is_word = |c: char| c.is_ascii_alphanumeric() || "+-._/:,@%".contains(c);
    if !value.is_empty() && value.chars().all(is_word) {
        return value.to_owned();
    }
    match inside {
        None | Some(Inside::Parentheses) => format!("'{}'", value.replace('\'', r"'\''")),
        Some(Inside::Single) => value.replace('\'', r"'\''"),
        Some(Inside::Double) => {
            let escaped = |c: char| "\\\"$`".contains(c).then_some('\\');
            value
                .chars()
                .flat_map(|c| escaped(c).into_iter().chain([c]))
                .collect()
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    use std::process::Command;

    use super::*;

    /// The shell itself says what it reads.
    #[test]
    fn the_shell_reads_values_as_they_are() {
        let values = [
            "it's", "a b", "", "x\"y", "$HOME", "`date`", "a\\b", "*", "; exit 3", "-1.5e-3", "~", "ü #",
            "{b}",
        ];
        for value in values {
            let both = [value.to_owned(), "2".to_owned()];
            for line in [
                "printf %s {a}",
                "printf %s '{a}'",
                "printf %s \"{a}\"",
                "printf %s \"$(printf %s {a})\"",
                "printf %s \"$(printf %s \"{a}\")\"",
                "(printf %s {a})",
                "printf %s \"\\\"\" >&2; printf %s {a}",
                "printf %s \\' >&2; printf %s {a}",
            ] {
                let filled = fill(line, |rest| rest.starts_with("{a}").then_some((3, &both[..1])));
                let shell = Command::new("/bin/sh").args(["-c", &filled]).output().unwrap();
                let said = String::from_utf8(shell.stdout).unwrap();
                assert_eq!(
                    (said.as_str(), shell.status.code()),
                    (value, Some(0)),
                    "{line}: {filled}"
                );
            }
            let line = "printf '<%s>' {x}";
            let filled = fill(line, |rest| rest.starts_with("{x}").then_some((3, &both[..])));
            let shell = Command::new("/bin/sh").args(["-c", &filled]).output().unwrap();
            assert_eq!(
                String::from_utf8(shell.stdout).unwrap(),
                format!("<{value}><2>"),
                "{filled}"
            );
        }
    }
}

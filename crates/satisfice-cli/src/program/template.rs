//! The command line of a program, with places for coordinates: `{x}` for all, `{NAME}` for those of an axis or permutation.

use std::ops::Range;

use anyhow::bail;

use super::shell;
use super::space::SpaceFile;

/// Words with places for coordinates, or one text for a shell.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Template {
    words: Vec<String>,
    is_shell: bool,
}

/// The place for all coordinates.
const ALL: &str = "{x}";

impl Template {
    /// Reads a template: words as a shell would split them, unless `shell` is to do that.
    pub(crate) fn new(text: &str, shell: bool, space: &SpaceFile) -> anyhow::Result<Self> {
        let words = if shell {
            vec![text.to_owned()]
        } else {
            split(text)?
        };
        if words.first().is_none_or(|program| program.trim().is_empty()) {
            bail!("no program is named: give one, such as './simulate {{x}}'");
        }
        let template = Self {
            words,
            is_shell: shell,
        };
        template.check(space)?;
        Ok(template)
    }

    /// Checks that some coordinate is asked for, and none that there is not.
    fn check(&self, space: &SpaceFile) -> anyhow::Result<()> {
        let known: Vec<String> = space.places().map(|(name, _)| format!("{{{name}}}")).collect();
        let mut any = false;
        for word in &self.words {
            any |= word.contains(ALL) || known.iter().any(|place| word.contains(place));
            let mut rest = word.as_str();
            while let Some(start) = rest.find('{') {
                let Some(length) = rest[start..].find('}') else {
                    break;
                };
                let place = &rest[start..=start + length];
                let is_name = place[1..length]
                    .chars()
                    .all(|c| c.is_alphanumeric() || c == '_' || c == '-')
                    && length > 1;
                if is_name && place != ALL && !known.iter().any(|name| name == place) {
                    bail!(
                        "{place} names no axis: use {{x}} for all coordinates, or {}",
                        known.join(", ")
                    );
                }
                rest = &rest[start + length + 1..];
            }
        }
        if !any {
            bail!(
                "the program is given no coordinate: write {{x}} where they belong, or {}",
                known.join(", ")
            );
        }
        Ok(())
    }

    /// The program and its arguments for one point.
    pub(crate) fn words(&self, point: &[f64], space: &SpaceFile) -> Vec<String> {
        let texts = space.texts(point);
        let places: Vec<(String, Range<usize>)> = space
            .places()
            .map(|(name, range)| (format!("{{{name}}}"), range))
            .chain([(ALL.to_owned(), 0..texts.len())])
            .collect();
        let find = |text: &str| places.iter().find(|(place, _)| text.starts_with(place));
        if self.is_shell {
            let line = shell::fill(&self.words[0], |text| {
                let (place, range) = find(text)?;
                Some((place.len(), &texts[range.clone()]))
            });
            return vec!["/bin/sh".to_owned(), "-c".to_owned(), line];
        }
        let mut words = Vec::new();
        for word in &self.words {
            match places.iter().find(|(place, _)| place == word) {
                Some((_, range)) => words.extend_from_slice(&texts[range.clone()]), // an argument each
                None => words.push(fill(word, |rest| {
                    let (place, range) = find(rest)?;
                    Some((place.len(), texts[range.clone()].join(",")))
                })),
            }
        }
        words
    }
}

/// A word with texts in its places. `find` says of the rest of the word how long the place at its beginning is, if it is one, and what belongs
/// there. A text is not read again: a category may be named as a place is.
fn fill(word: &str, find: impl Fn(&str) -> Option<(usize, String)>) -> String {
    let (mut filled, mut rest) = (String::new(), word);
    while let Some(c) = rest.chars().next() {
        let (taken, text) = find(rest).unwrap_or_else(|| (c.len_utf8(), c.to_string()));
        filled.push_str(&text);
        rest = &rest[taken..];
    }
    filled
}

/// Splits a text at blanks; quotes and backslashes keep blanks, as in a shell. Nothing is expanded.
pub(crate) fn split(text: &str) -> anyhow::Result<Vec<String>> {
    let (mut words, mut word) = (Vec::new(), None::<String>);
    let mut characters = text.chars();
    while let Some(c) = characters.next() {
        match c {
            ' ' | '\t' | '\n' => words.extend(word.take()),
            '\'' | '"' => {
                let inside = word.get_or_insert_default();
                loop {
                    match characters.next() {
                        Some(end) if end == c => break,
                        Some('\\') if c == '"' => inside.extend(characters.next()),
                        Some(other) => inside.push(other),
                        None => bail!("a quote in `{text}` is not closed"),
                    }
                }
            }
            '\\' => word.get_or_insert_default().extend(characters.next()),
            other => word.get_or_insert_default().push(other),
        }
    }
    words.extend(word);
    Ok(words)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn space() -> SpaceFile {
        let axis = |name: &str| {
            let line = format!("[[axis]]\nname = \"{name}\"\nlower = 0\nupper = 9\n");
            toml::from_str::<SpaceFile>(&line).unwrap().axes.remove(0)
        };
        SpaceFile {
            separation: None,
            axes: vec![axis("a"), axis("b")],
        }
    }

    #[test]
    fn places_are_filled() {
        for (text, words) in [
            ("./run {x}", vec!["./run", "1.5", "2"]),
            ("./run --x={x}", vec!["./run", "--x=1.5,2"]),
            ("./run -b {b} 'a is {a}'", vec!["./run", "-b", "2", "a is 1.5"]),
            (
                r#""my program" a\ b "{a}\"" {b}"#,
                vec!["my program", "a b", "1.5\"", "2"],
            ),
        ] {
            let template = Template::new(text, false, &space()).unwrap();
            assert_eq!(template.words(&[1.5, 2.0], &space()), words, "{text}");
        }
        let shell = Template::new("echo {x} | bc", true, &space()).unwrap();
        assert_eq!(
            shell.words(&[1.0, 2.0], &space()),
            ["/bin/sh", "-c", "echo 1 2 | bc"]
        );
        let shell = Template::new("echo {a} '{b}' ${a}{x}", true, &space()).unwrap();
        assert_eq!(shell.words(&[1.0, 2.0], &space())[2], "echo 1 '2' $11 2");
    }

    /// Nor is what stands in a place read as one.
    #[test]
    fn a_category_may_be_named_as_a_place() {
        let file = "[[axis]]\nname = \"a\"\ncategories = [\"{b}\", \"{x}\"]\n[[axis]]\nname = \"b\"\nlower = 0\nupper = 9\n";
        let space = SpaceFile {
            separation: None,
            axes: toml::from_str::<SpaceFile>(file).unwrap().axes,
        };
        let template = Template::new("./run --a={a} --all=ü{x} {b}", false, &space).unwrap();
        let words = |a: f64| template.words(&[a, 2.0], &space);
        assert_eq!(words(0.0), ["./run", "--a={b}", "--all=ü{b},2", "2"]);
        assert_eq!(words(1.0), ["./run", "--a={x}", "--all=ü{x},2", "2"]);
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (text, says) in [
            ("", "no program"),
            ("./run", "no coordinate"),
            ("./run {c}", "{c} names no axis"),
            ("./run '{x}", "not closed"),
        ] {
            let error = Template::new(text, false, &space()).unwrap_err().to_string();
            assert!(error.contains(says), "{text}: {error}");
        }
        assert!(
            Template::new("awk '{print $1}' {x}", false, &space()).is_ok(),
            "braces of other languages"
        );
    }
}

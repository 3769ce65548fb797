//! Engines and problems with their parameters, as data: the output of `list --json`.

use satisfice::catalogue::ParamKind;
use satisfice::catalogue::Parameter;
use satisfice::engine;
use serde::Serialize;

use crate::catalogue::Catalogue;

/// Everything that has a name.
#[derive(Debug, Clone, Serialize)]
pub struct Listing {
    /// The engines.
    pub engines: Vec<Item>,
    /// The parameters that every engine takes in addition to its own.
    pub common_engine_parameters: Vec<Row>,
    /// The problems.
    pub problems: Vec<Item>,
}

/// An engine or a problem.
#[derive(Debug, Clone, Serialize)]
pub struct Item {
    /// Its name.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// Its source.
    pub reference: &'static str,
    /// Its parameters.
    pub parameters: Vec<Row>,
}

/// A parameter.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    /// Its name.
    pub name: &'static str,
    /// A summary.
    pub summary: String,
    /// Its values.
    #[serde(flatten)]
    pub values: Range,
}

/// The values of a parameter, and its default.
#[derive(Debug, Clone, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Range {
    /// A whole number.
    Integer {
        /// Default.
        default: i64,
        /// Least.
        min: i64,
        /// Greatest.
        max: i64,
    },
    /// A real number.
    Real {
        /// Default.
        default: f64,
        /// Least.
        min: f64,
        /// Greatest.
        max: f64,
    },
    /// A whole number or `auto`.
    #[serde(rename = "optional-integer")]
    OptionalInteger {
        /// Default.
        default: &'static str,
        /// Least.
        min: i64,
        /// Greatest.
        max: i64,
    },
    /// A real number or `auto`.
    #[serde(rename = "optional-real")]
    OptionalReal {
        /// Default.
        default: &'static str,
        /// Least.
        min: f64,
        /// Greatest.
        max: f64,
    },
    /// One of these words.
    Choice {
        /// Default.
        default: &'static str,
        /// The words.
        of: &'static [&'static str],
    },
    /// Any text.
    Text {
        /// Default.
        default: &'static str,
    },
}

impl From<&Parameter> for Row {
    fn from(parameter: &Parameter) -> Self {
        let values = match parameter.kind {
            ParamKind::Integer { min, max, default } => Range::Integer { default, min, max },
            ParamKind::Real { min, max, default } => Range::Real { default, min, max },
            ParamKind::OptionalInteger { min, max } => Range::OptionalInteger {
                default: Parameter::AUTO,
                min,
                max,
            },
            ParamKind::OptionalReal { min, max } => Range::OptionalReal {
                default: Parameter::AUTO,
                min,
                max,
            },
            ParamKind::Choice { of, default } => Range::Choice { default, of },
            ParamKind::Text { default } => Range::Text { default },
        };
        Self {
            name: parameter.name,
            summary: without_links(parameter.summary),
            values,
        }
    }
}

/// A text of the documentation without its links, which lead nowhere on a terminal: `[the budget](crate::Budget)` is "the budget".
fn without_links(text: &str) -> String {
    let (mut plain, mut rest) = (String::with_capacity(text.len()), text);
    while let Some((before, label, after)) = first_link(rest) {
        plain.push_str(before);
        plain.push_str(label);
        rest = after;
    }
    plain + rest
}

/// What is before a link, its label, and what is after it.
fn first_link(text: &str) -> Option<(&str, &str, &str)> {
    let middle = text.find("](")?;
    let begin = text[..middle].rfind('[')?;
    let end = middle + text[middle..].find(')')?;
    Some((&text[..begin], &text[begin + 1..middle], &text[end + 1..]))
}

/// All engines, and the problems of a catalogue.
#[must_use]
pub fn listing(catalogue: &Catalogue) -> Listing {
    let rows = |parameters: &[Parameter]| parameters.iter().map(Row::from).collect();
    Listing {
        engines: engine::all()
            .iter()
            .map(|entry| Item {
                name: entry.name,
                summary: entry.summary,
                reference: entry.citation,
                parameters: rows(entry.parameters()),
            })
            .collect(),
        common_engine_parameters: rows(engine::COMMON_PARAMETERS),
        problems: catalogue
            .problems()
            .iter()
            .map(|entry| Item {
                name: entry.name,
                summary: entry.summary,
                reference: entry.source,
                parameters: rows(entry.parameters),
            })
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_of_the_documentation_are_left_out() {
        for (text, plain) in [
            (
                "as many as [the budget](crate::Budget::with_parallel) says",
                "as many as the budget says",
            ),
            ("[a](b) [0, 1] and [`c`](d).", "a [0, 1] and `c`."),
            ("a share (of [0, 1])", "a share (of [0, 1])"),
        ] {
            assert_eq!(without_links(text), plain);
        }
        let listing = serde_json::to_string(&listing(&Catalogue::bundled())).unwrap();
        assert!(!listing.contains("]("), "{listing}");
    }
}

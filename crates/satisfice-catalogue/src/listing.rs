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
    pub summary: &'static str,
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
            summary: parameter.summary,
            values,
        }
    }
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

//! One parameter: name, summary, allowed values and default.

use super::value::ParamValue;
use crate::error::Error;

/// The values that a parameter takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ParamKind {
    /// A whole number in `min..=max`.
    Integer {
        /// Least.
        min: i64,
        /// Greatest.
        max: i64,
        /// Default.
        default: i64,
    },
    /// A finite real number in `[min, max]`.
    Real {
        /// Least.
        min: f64,
        /// Greatest.
        max: f64,
        /// Default.
        default: f64,
    },
    /// A whole number in `[min, max]`, or `auto`, which is the default.
    OptionalInteger {
        /// Least.
        min: i64,
        /// Greatest.
        max: i64,
    },
    /// A finite real number in `[min, max]`, or `auto`, which is the default.
    OptionalReal {
        /// Least.
        min: f64,
        /// Greatest.
        max: f64,
    },
    /// One of these words.
    Choice {
        /// The words.
        of: &'static [&'static str],
        /// Default.
        default: &'static str,
    },
    /// Any text, such as a path.
    Text {
        /// Default.
        default: &'static str,
    },
}

/// One row of a table of parameters.
///
/// ```
/// use satisfice::catalogue::Parameter;
/// const TABLE: &[Parameter] = &[
///     Parameter::integer("cells", "cells of each axis", 1000, 1, 1_000_000),
///     Parameter::real("threshold", "delta", 0.1, 0.0, 10.0),
/// ];
/// assert_eq!(TABLE[1].allowed(), "a number from 0 to 10");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Its name on the command line, in lower case with hyphens.
    pub name: &'static str,
    /// What it does, with symbol and unit.
    pub summary: &'static str,
    /// Values and default.
    pub kind: ParamKind,
}

impl Parameter {
    /// The text that leaves an optional parameter to the engine or problem.
    pub const AUTO: &'static str = "auto";

    /// A whole number in `min..=max`.
    #[must_use]
    pub const fn integer(
        name: &'static str,
        summary: &'static str,
        default: i64,
        min: i64,
        max: i64,
    ) -> Self {
        Self {
            name,
            summary,
            kind: ParamKind::Integer { min, max, default },
        }
    }
    /// A finite real in `[min, max]`.
    #[must_use]
    pub const fn real(name: &'static str, summary: &'static str, default: f64, min: f64, max: f64) -> Self {
        Self {
            name,
            summary,
            kind: ParamKind::Real { min, max, default },
        }
    }
    /// A finite real in `[min, max]`, or [`auto`](Parameter::AUTO), which is the default.
    #[must_use]
    pub const fn optional_real(name: &'static str, summary: &'static str, min: f64, max: f64) -> Self {
        Self {
            name,
            summary,
            kind: ParamKind::OptionalReal { min, max },
        }
    }
    /// One of a list of words.
    #[must_use]
    pub const fn choice(
        name: &'static str,
        summary: &'static str,
        default: &'static str,
        of: &'static [&'static str],
    ) -> Self {
        Self {
            name,
            summary,
            kind: ParamKind::Choice { of, default },
        }
    }
    /// Any text.
    #[must_use]
    pub const fn text(name: &'static str, summary: &'static str, default: &'static str) -> Self {
        Self {
            name,
            summary,
            kind: ParamKind::Text { default },
        }
    }

    /// The default as text.
    #[must_use]
    pub fn default_text(&self) -> String {
        match self.kind {
            ParamKind::Integer { default, .. } => default.to_string(),
            ParamKind::Real { default, .. } => default.to_string(),
            ParamKind::OptionalInteger { .. } | ParamKind::OptionalReal { .. } => Self::AUTO.to_owned(),
            ParamKind::Choice { default, .. } | ParamKind::Text { default } => default.to_owned(),
        }
    }

    /// The allowed values in words, for help and error messages.
    #[must_use]
    pub fn allowed(&self) -> String {
        match self.kind {
            ParamKind::Integer { min, max, .. } => format!("a whole number from {min} to {max}"),
            ParamKind::Real { min, max, .. } => format!("a number from {min} to {max}"),
            ParamKind::OptionalInteger { min, max } => {
                format!("{} or a whole number from {min} to {max}", Self::AUTO)
            }
            ParamKind::OptionalReal { min, max } => format!("{} or a number from {min} to {max}", Self::AUTO),
            ParamKind::Choice { of, .. } => format!("one of {}", of.join(", ")),
            ParamKind::Text { .. } => "any text".to_owned(),
        }
    }

    /// Checks a value given as text.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a text that is not a number or out of range, [`Error::Unknown`] for a word that is not in
    /// the list, with the nearest.
    pub fn check(&self, text: &str) -> Result<(), Error> {
        self.parse(text).map(|_| ())
    }

    /// Parses and checks a value.
    pub(crate) fn parse(&self, text: &str) -> Result<ParamValue, Error> {
        let bad = || Error::parameter(self.name, text, self.allowed());
        match self.kind {
            ParamKind::OptionalInteger { .. } | ParamKind::OptionalReal { .. } if text == Self::AUTO => {
                Ok(ParamValue::Text(text.to_owned()))
            }
            ParamKind::Integer { min, max, .. } | ParamKind::OptionalInteger { min, max } => {
                let value = text.parse::<i64>().ok().or_else(|| whole(text)).ok_or_else(bad)?;
                if (min..=max).contains(&value) {
                    Ok(ParamValue::Integer(value))
                } else {
                    Err(bad())
                }
            }
            ParamKind::Real { min, max, .. } | ParamKind::OptionalReal { min, max } => {
                let value = text.parse::<f64>().map_err(|_| bad())?;
                // NaN is in no range.
                if (min..=max).contains(&value) {
                    Ok(ParamValue::Real(value))
                } else {
                    Err(bad())
                }
            }
            ParamKind::Choice { of, .. } => of
                .iter()
                .find(|&&word| word == text)
                .map(|word| ParamValue::Text((*word).to_owned()))
                .ok_or_else(|| {
                    Error::unknown(&format!("value of `{}`", self.name), text, of.iter().copied())
                }),
            ParamKind::Text { .. } => Ok(ParamValue::Text(text.to_owned())),
        }
    }
}

/// `1e6` as a whole number.
#[expect(
    clippy::cast_possible_truncation,
    reason = "checked to be whole and below 2^53"
)]
fn whole(text: &str) -> Option<i64> {
    let value = text.parse::<f64>().ok()?;
    (value.fract() == 0.0 && value.abs() < 9e15).then_some(value as i64)
}

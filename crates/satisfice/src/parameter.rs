//! Tables of parameters: what can be set by name, with defaults and ranges, for engines and problems alike.

use crate::error::Error;

/// What values a parameter takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
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
    /// One of these words.
    Choice {
        /// The words.
        of: &'static [&'static str],
        /// Default.
        default: &'static str,
    },
    /// Any text, such as a path; empty where nothing is given.
    Text {
        /// Default.
        default: &'static str,
    },
}

/// One row of a table of parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Its name on the command line, in lower case with hyphens.
    pub name: &'static str,
    /// What it does, with symbol and unit.
    pub summary: &'static str,
    /// Values and default.
    pub kind: Kind,
}

impl Parameter {
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
            kind: Kind::Integer { min, max, default },
        }
    }
    /// A finite real in `[min, max]`.
    #[must_use]
    pub const fn real(name: &'static str, summary: &'static str, default: f64, min: f64, max: f64) -> Self {
        Self {
            name,
            summary,
            kind: Kind::Real { min, max, default },
        }
    }
    /// One of some words.
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
            kind: Kind::Choice { of, default },
        }
    }
    /// Any text.
    #[must_use]
    pub const fn text(name: &'static str, summary: &'static str, default: &'static str) -> Self {
        Self {
            name,
            summary,
            kind: Kind::Text { default },
        }
    }

    /// The default as text.
    #[must_use]
    pub fn default_text(&self) -> String {
        match self.kind {
            Kind::Integer { default, .. } => default.to_string(),
            Kind::Real { default, .. } => default.to_string(),
            Kind::Choice { default, .. } | Kind::Text { default } => default.to_owned(),
        }
    }

    /// What is allowed, for help and errors.
    #[must_use]
    pub fn allowed(&self) -> String {
        match self.kind {
            Kind::Integer { min, max, .. } => format!("a whole number from {min} to {max}"),
            Kind::Real { min, max, .. } => format!("a number from {min} to {max}"),
            Kind::Choice { of, .. } => format!("one of {}", of.join(", ")),
            Kind::Text { .. } => "any text".to_owned(),
        }
    }

    fn parse(&self, text: &str) -> Result<Value, Error> {
        let bad = || Error::parameter(self.name, text, self.allowed());
        match self.kind {
            Kind::Integer { min, max, .. } => {
                let value = text.parse::<i64>().ok().or_else(|| whole(text)).ok_or_else(bad)?;
                if (min..=max).contains(&value) {
                    Ok(Value::Integer(value))
                } else {
                    Err(bad())
                }
            }
            Kind::Real { min, max, .. } => {
                let value = text.parse::<f64>().map_err(|_| bad())?;
                // NaN is in no range.
                if (min..=max).contains(&value) {
                    Ok(Value::Real(value))
                } else {
                    Err(bad())
                }
            }
            Kind::Choice { of, .. } => of
                .iter()
                .find(|&&word| word == text)
                .map(|word| Value::Text((*word).to_owned()))
                .ok_or_else(|| {
                    Error::unknown(&format!("value of `{}`", self.name), text, of.iter().copied())
                }),
            Kind::Text { .. } => Ok(Value::Text(text.to_owned())),
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

#[derive(Debug, Clone, PartialEq)]
enum Value {
    Integer(i64),
    Real(f64),
    Text(String),
}

impl core::fmt::Display for Value {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Integer(value) => write!(f, "{value}"),
            Self::Real(value) => write!(f, "{value}"),
            Self::Text(value) => write!(f, "{value}"),
        }
    }
}

/// A value for every row of a table, each within its range.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    table: &'static [Parameter],
    values: Vec<Value>,
}

impl Values {
    /// The defaults of a table.
    ///
    /// # Errors
    /// [`Error::Parameter`] where the table's own default is out of its range.
    pub fn defaults(table: &'static [Parameter]) -> Result<Self, Error> {
        let values = table
            .iter()
            .map(|row| row.parse(&row.default_text()))
            .collect::<Result<_, _>>()?;
        Ok(Self { table, values })
    }

    /// The defaults with some rows set, as `(name, text)`; the last of several for one row counts.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a name that is not in the table, with the nearest; [`Error::Parameter`] for a text that is
    /// no number or out of range.
    pub fn with<'a>(
        table: &'static [Parameter],
        owner: &str,
        settings: impl IntoIterator<Item = (&'a str, &'a str)>,
    ) -> Result<Self, Error> {
        let mut all = Self::defaults(table)?;
        for (name, text) in settings {
            let index = table.iter().position(|row| row.name == name).ok_or_else(|| {
                Error::unknown(
                    &format!("parameter of `{owner}`"),
                    name,
                    table.iter().map(|row| row.name),
                )
            })?;
            all.values[index] = table[index].parse(text)?;
        }
        Ok(all)
    }

    /// Every row as text, in the order of the table.
    #[must_use]
    pub fn texts(&self) -> Vec<(String, String)> {
        self.table
            .iter()
            .zip(&self.values)
            .map(|(row, value)| (row.name.to_owned(), value.to_string()))
            .collect()
    }

    fn value(&self, name: &str) -> &Value {
        // Names are written beside their table by whoever reads them: a wrong one is a slip in the program, and every
        // table's builder is called by a test.
        let index = self.table.iter().position(|row| row.name == name);
        &self.values[index.unwrap_or_else(|| panic!("the table has no row `{name}`"))]
    }

    /// A whole number.
    ///
    /// # Panics
    /// If the table has no such row of whole numbers: a slip in the program that no input brings about.
    #[must_use]
    pub fn integer(&self, name: &str) -> i64 {
        match self.value(name) {
            Value::Integer(value) => *value,
            other => panic!("`{name}` is no whole number: {other}"),
        }
    }

    /// A whole number whose range has no negative ones.
    ///
    /// # Panics
    /// As [`Values::integer`]; also if the table allows a negative number.
    #[must_use]
    pub fn count(&self, name: &str) -> usize {
        usize::try_from(self.integer(name)).unwrap_or_else(|_| panic!("`{name}` may be negative"))
    }

    /// A real number.
    ///
    /// # Panics
    /// As [`Values::integer`].
    #[must_use]
    pub fn real(&self, name: &str) -> f64 {
        match self.value(name) {
            Value::Real(value) => *value,
            other => panic!("`{name}` is no real number: {other}"),
        }
    }

    /// A word or text.
    ///
    /// # Panics
    /// As [`Values::integer`].
    #[must_use]
    pub fn text(&self, name: &str) -> &str {
        match self.value(name) {
            Value::Text(value) => value,
            other => panic!("`{name}` is no text: {other}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &[Parameter] = &[
        Parameter::integer("n", "particles, N", 30, 1, 10_000),
        Parameter::real("alpha", "contraction-expansion", 1.0, 0.0, 10.0),
        Parameter::choice("attractor", "who attracts", "best", &["best", "latest-hit"]),
    ];

    #[test]
    fn defaults_and_settings() {
        let values = Values::with(TABLE, "pso", [("n", "1e3"), ("alpha", "0.75")]).unwrap();
        assert_eq!(
            (values.count("n"), values.real("alpha"), values.text("attractor")),
            (1000, 0.75, "best")
        );
        assert_eq!(values.texts()[0], ("n".to_owned(), "1000".to_owned()));
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (name, text, says) in [
            ("n", "0", "n = 0 is not allowed: a whole number from 1 to 10000"),
            ("n", "2.5", "n = 2.5 is not allowed"),
            (
                "alpha",
                "NaN",
                "alpha = NaN is not allowed: a number from 0 to 10",
            ),
            ("alpha", "inf", "alpha = inf is not allowed"),
            (
                "alhpa",
                "1",
                "unknown parameter of `pso` `alhpa`, did you mean `alpha`?",
            ),
            ("attractor", "bets", "did you mean `best`?"),
        ] {
            let error = Values::with(TABLE, "pso", [(name, text)])
                .unwrap_err()
                .to_string();
            assert!(error.contains(says), "{error}");
        }
    }
}

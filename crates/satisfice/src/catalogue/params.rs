//! Parameters of one problem: a value for each row of its table.

use super::parameter::Parameter;
use super::value::ParamValue;
use crate::error::Error;

/// A value for every row of a table, each within its range.
///
/// ```
/// use satisfice::catalogue::{Parameter, Params};
/// const TABLE: &[Parameter] = &[Parameter::integer("n", "board size", 8, 1, 100)];
/// let params = Params::with(TABLE, "queens", [("n", "12")])?;
/// assert_eq!(params.count("n"), 12);
/// assert!(Params::with(TABLE, "queens", [("m", "12")]).is_err());
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Params {
    table: &'static [Parameter],
    values: Vec<ParamValue>,
}

impl Params {
    /// The defaults of a table.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the table's own default is out of its range.
    pub fn defaults(table: &'static [Parameter]) -> Result<Self, Error> {
        let values = table
            .iter()
            .map(|row| row.parse(&row.default_text()))
            .collect::<Result<_, _>>()?;
        Ok(Self { table, values })
    }

    /// The defaults with the rows in `settings` replaced. A setting is `(name, text)`; of several for one row, the last
    /// counts. `owner` is the problem or engine that errors name.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a name that is not in the table, with the nearest name; [`Error::Parameter`] for a text that
    /// is not a number or out of range.
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

    fn value(&self, name: &str) -> &ParamValue {
        // The code that reads a value stands beside its table: a wrong name is a mistake in the program, and a test builds
        // every registered table.
        let index = self.table.iter().position(|row| row.name == name);
        &self.values[index.unwrap_or_else(|| panic!("the table has no row `{name}`"))]
    }

    /// A whole number.
    ///
    /// # Panics
    /// If the table has no such row of whole numbers: a mistake in the program, which no input causes.
    #[must_use]
    pub fn integer(&self, name: &str) -> i64 {
        match self.value(name) {
            ParamValue::Integer(value) => *value,
            other => panic!("`{name}` is no whole number: {other}"),
        }
    }

    /// A whole number whose range has no negative ones.
    ///
    /// # Panics
    /// As [`Params::integer`]; also if the table allows a negative number.
    #[must_use]
    pub fn count(&self, name: &str) -> usize {
        usize::try_from(self.integer(name)).unwrap_or_else(|_| panic!("`{name}` may be negative"))
    }

    /// A real number.
    ///
    /// # Panics
    /// As [`Params::integer`].
    #[must_use]
    pub fn real(&self, name: &str) -> f64 {
        match self.value(name) {
            ParamValue::Real(value) => *value,
            other => panic!("`{name}` is no real number: {other}"),
        }
    }

    /// A real number where one is given, `None` for `auto`.
    ///
    /// # Panics
    /// As [`Params::integer`].
    #[must_use]
    pub fn optional_real(&self, name: &str) -> Option<f64> {
        match self.value(name) {
            ParamValue::Real(value) => Some(*value),
            ParamValue::Text(text) if text == Parameter::AUTO => None,
            other => panic!("`{name}` is no optional number: {other}"),
        }
    }

    /// A word or text.
    ///
    /// # Panics
    /// As [`Params::integer`].
    #[must_use]
    pub fn text(&self, name: &str) -> &str {
        match self.value(name) {
            ParamValue::Text(value) => value,
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
        let values = Params::with(TABLE, "pso", [("n", "1e3"), ("alpha", "0.75")]).unwrap();
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
            let error = Params::with(TABLE, "pso", [(name, text)])
                .unwrap_err()
                .to_string();
            assert!(error.contains(says), "{error}");
        }
    }
}

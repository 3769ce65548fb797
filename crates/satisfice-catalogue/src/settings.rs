//! Parameters as a report keeps them: names with typed values, in the order of their table.

use indexmap::IndexMap;
use satisfice::catalogue::{ParamKind, Parameter};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Names with values, in a fixed order; a map in JSON, with numbers as numbers.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Settings(IndexMap<String, Value>);

impl Settings {
    /// From texts, typed by the rows of `table` with the same names; a name without a row stays text.
    #[must_use]
    pub fn typed(texts: &[(String, String)], table: &[Parameter]) -> Self {
        let typed = |(name, text): &(String, String)| {
            let row = table.iter().find(|row| row.name == name);
            let value = match row.map(|row| row.kind) {
                Some(ParamKind::Integer { .. }) => text.parse::<i64>().ok().map(Value::from),
                Some(ParamKind::Real { .. } | ParamKind::OptionalReal { .. }) => {
                    text.parse::<f64>().ok().map(Value::from)
                }
                Some(ParamKind::Choice { .. } | ParamKind::Text { .. }) | None => None,
            };
            (name.clone(), value.unwrap_or_else(|| Value::String(text.clone())))
        };
        Self(texts.iter().map(typed).collect())
    }

    /// Names and values, in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (&str, &Value)> {
        self.0.iter().map(|(name, value)| (name.as_str(), value))
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The value of this name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.0.get(name)
    }

    /// Sets a value, at the end if the name is new.
    pub fn set(&mut self, name: &str, value: impl Into<Value>) {
        self.0.insert(name.to_owned(), value.into());
    }

    /// The texts from which a table of parameters reads them again.
    #[must_use]
    pub fn texts(&self) -> Vec<(String, String)> {
        let text = |value: &Value| match value {
            Value::String(text) => text.clone(),
            other => other.to_string(),
        };
        self.0
            .iter()
            .map(|(name, value)| (name.clone(), text(value)))
            .collect()
    }
}

impl FromIterator<(String, String)> for Settings {
    fn from_iter<I: IntoIterator<Item = (String, String)>>(texts: I) -> Self {
        Self(
            texts
                .into_iter()
                .map(|(name, text)| (name, Value::String(text)))
                .collect(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &[Parameter] = &[
        Parameter::integer("n", "queens", 8, 4, 20),
        Parameter::real("delta", "threshold", 1e-9, 0.0, 1.0),
        Parameter::text("mesh", "a file", ""),
    ];

    #[test]
    fn numbers_are_numbers_and_come_back() {
        let texts = [("n", "6"), ("delta", "0.1"), ("mesh", "7")].map(|(n, t)| (n.to_owned(), t.to_owned()));
        let settings = Settings::typed(&texts, TABLE);
        let json = serde_json::to_string(&settings).unwrap();
        assert_eq!(json, r#"{"n":6,"delta":0.1,"mesh":"7"}"#);
        let back: Settings = serde_json::from_str(&json).unwrap();
        assert_eq!(back, settings);
        assert_eq!(back.texts(), texts);
    }
}

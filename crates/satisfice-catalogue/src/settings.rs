//! Parameters as a report keeps them: names with typed values, in the order of their table.

use indexmap::IndexMap;
use satisfice::catalogue::ParamValue;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Names with values, in a fixed order; a map in JSON, with numbers as numbers.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Settings(IndexMap<String, Value>);

impl Settings {
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

/// From texts; those that are numbers become numbers.
impl FromIterator<(String, String)> for Settings {
    fn from_iter<I: IntoIterator<Item = (String, String)>>(texts: I) -> Self {
        let typed = |text: &str| match ParamValue::of(text) {
            ParamValue::Integer(value) => Value::from(value),
            ParamValue::Real(value) => Value::from(value),
            ParamValue::Text(text) => Value::String(text),
        };
        let typed = |(name, text): (String, String)| (name, typed(&text));
        Self(texts.into_iter().map(typed).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_numbers_and_come_back() {
        let texts = [("n", "6"), ("delta", "0.1"), ("mesh", "07")].map(|(n, t)| (n.to_owned(), t.to_owned()));
        let settings: Settings = texts.iter().cloned().collect();
        let json = serde_json::to_string(&settings).unwrap();
        assert_eq!(json, r#"{"n":6,"delta":0.1,"mesh":"07"}"#);
        let back: Settings = serde_json::from_str(&json).unwrap();
        assert_eq!(back, settings);
        assert_eq!(back.texts(), texts);
    }
}

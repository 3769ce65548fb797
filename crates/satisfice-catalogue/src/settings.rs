//! Parameters as a record keeps them: names with typed values, in the order of their table.

use core::fmt;

use satisfice::catalogue::ParamKind;
use satisfice::catalogue::Parameter;
use serde::de::{MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;

/// Names with values, in a fixed order; a map in JSON, numbers as numbers.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Settings(Vec<(String, Value)>);

impl Settings {
    /// From texts, typed by the rows of `table` of the same names; a name without a row stays text.
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

    /// The value of this name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.iter()
            .find_map(|(known, value)| (known == name).then_some(value))
    }

    /// Sets a value, at the end if the name is new.
    pub fn set(&mut self, name: &str, value: impl Into<Value>) {
        match self.0.iter_mut().find(|(known, _)| known == name) {
            Some((_, old)) => *old = value.into(),
            None => self.0.push((name.to_owned(), value.into())),
        }
    }

    /// The texts from which a table of parameters reads them again.
    #[must_use]
    pub fn texts(&self) -> Vec<(String, String)> {
        self.0
            .iter()
            .map(|(name, value)| {
                let text = match value {
                    Value::String(text) => text.clone(),
                    other => other.to_string(),
                };
                (name.clone(), text)
            })
            .collect()
    }
}

impl Serialize for Settings {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, value) in &self.0 {
            map.serialize_entry(name, value)?;
        }
        map.end()
    }
}

impl<'de> Deserialize<'de> for Settings {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct InOrder;
        impl<'de> Visitor<'de> for InOrder {
            type Value = Settings;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a map from parameter names to values")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Settings, A::Error> {
                let mut settings = Settings::default();
                while let Some((name, value)) = map.next_entry()? {
                    settings.0.push((name, value));
                }
                Ok(settings)
            }
        }
        deserializer.deserialize_map(InOrder)
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

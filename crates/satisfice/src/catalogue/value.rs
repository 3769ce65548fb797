//! The value of a parameter: a number or a text.

use serde::{Deserialize, Serialize};

/// The value of a parameter. In JSON a number or a string.
///
/// ```
/// use satisfice::catalogue::ParamValue;
/// assert_eq!(ParamValue::of("60"), ParamValue::Integer(60));
/// assert_eq!(ParamValue::of("0.75"), ParamValue::Real(0.75));
/// assert_eq!(ParamValue::of("auto"), ParamValue::Text("auto".to_owned()));
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ParamValue {
    /// A whole number.
    Integer(i64),
    /// A finite real number.
    Real(f64),
    /// Anything else.
    Text(String),
}

impl ParamValue {
    /// The value that a text stands for: a number if the number prints as this text again, otherwise the text.
    #[must_use]
    pub fn of(text: &str) -> Self {
        let integer = text.parse().ok().map(Self::Integer);
        let real = || {
            text.parse()
                .ok()
                .filter(|real: &f64| real.is_finite())
                .map(Self::Real)
        };
        integer
            .or_else(real)
            .filter(|value| value.to_string() == text)
            .unwrap_or_else(|| Self::Text(text.to_owned()))
    }
}

impl core::fmt::Display for ParamValue {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Integer(value) => write!(f, "{value}"),
            Self::Real(value) => write!(f, "{value}"),
            Self::Text(value) => write!(f, "{value}"),
        }
    }
}

pub(crate) mod as_map {
    //! Names with values as texts, written as a map with numbers as numbers.

    use core::fmt;

    use serde::de::{Deserializer, MapAccess, Visitor};
    use serde::ser::Serializer;

    use super::ParamValue;

    pub(crate) fn serialize<S: Serializer>(texts: &[(String, String)], to: S) -> Result<S::Ok, S::Error> {
        to.collect_map(texts.iter().map(|(name, text)| (name, ParamValue::of(text))))
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<(String, String)>, D::Error> {
        struct Texts;
        impl<'de> Visitor<'de> for Texts {
            type Value = Vec<(String, String)>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a map from names to numbers and strings")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut texts = Vec::new();
                while let Some((name, value)) = map.next_entry::<String, ParamValue>()? {
                    texts.push((name, value.to_string()));
                }
                Ok(texts)
            }
        }
        from.deserialize_map(Texts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_that_is_not_how_a_number_prints_stays_a_text() {
        for text in ["", "07", "+7", "1e5", "NaN", "inf", "1.0", "data/7"] {
            assert_eq!(ParamValue::of(text), ParamValue::Text(text.to_owned()));
        }
        for text in ["0", "-3", "0.000000001", "12345678901234567890", "auto", "07"] {
            assert_eq!(ParamValue::of(text).to_string(), text);
        }
    }
}

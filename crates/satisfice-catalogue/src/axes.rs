//! Axes as plain data: what a file or another language says of a space.

use std::collections::BTreeSet;
use std::ops::Range;

use satisfice::{Axis, Error, Space};
use serde::{Deserialize, Serialize};

use crate::quantity::shown::exact;

/// Integers beyond this are not exact.
const MOST: f64 = 9_007_199_254_740_992.0;
/// The longest permutation.
const LONGEST: u32 = 65_536;

/// One axis, or the places of one permutation.
///
/// ```
/// use satisfice_catalogue::axes::{self, AxisEntry};
/// let entries: Vec<AxisEntry> = serde_json::from_str(
///     r#"[{"name": "ohms", "lower": 10, "upper": 1e6, "logarithmic": true}, {"categories": ["steel", "brass"]}, {"permutation": 3}]"#,
/// )?;
/// let space = axes::space(&entries)?;
/// assert_eq!(space.dimension(), 5);
/// assert!(space.axes()[0].is_logarithmic());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisEntry {
    /// Its name; `x0`, `x1`, … by default, with the number of its first coordinate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Least value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lower: Option<f64>,
    /// Greatest value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub upper: Option<f64>,
    /// Whether its values are whole numbers.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub integer: bool,
    /// Whether it is searched by the logarithm, for several orders of magnitude. `lower` has to be above 0.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub logarithmic: bool,
    /// Whether it is a circle, such as an angle: what leaves at one end enters at the other.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub periodic: bool,
    /// Words instead of numbers, each another one, without an order. Their coordinate is the index.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub categories: Vec<String>,
    /// That many coordinates, which are an order of the integers from 0 on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub permutation: Option<u32>,
}

impl AxisEntry {
    /// How many coordinates it has: 1, but for a permutation.
    #[must_use]
    pub fn len(&self) -> usize {
        self.permutation.map_or(1, |count| count as usize)
    }

    /// Whether it has no coordinate, which [`space`] refuses.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The axes of its coordinates.
    fn axes(&self) -> Result<Vec<Axis<f64>>, String> {
        let numbers =
            self.lower.is_some() || self.upper.is_some() || self.integer || self.logarithmic || self.periodic;
        if let Some(count) = self.permutation {
            if numbers || !self.categories.is_empty() {
                return Err("a permutation has nothing else, but a name".into());
            }
            if !(1..=LONGEST).contains(&count) {
                return Err(format!(
                    "permutation = {count}: a number of places from 1 to {LONGEST}"
                ));
            }
            return Ok(Axis::permutation(count).collect());
        }
        if !self.categories.is_empty() {
            if numbers {
                return Err(
                    "an axis of categories has neither lower, upper, integer, logarithmic nor periodic"
                        .into(),
                );
            }
            let mut known = BTreeSet::new();
            if let Some(word) = self.categories.iter().find(|word| !known.insert(*word)) {
                return Err(format!(
                    "two categories are called `{word}`: choose different names"
                ));
            }
            let count = u32::try_from(self.categories.len()).map_err(|_| "too many categories")?;
            return Ok(vec![Axis::categorical(count)]);
        }
        let (Some(lower), Some(upper)) = (self.lower, self.upper) else {
            return Err("give lower and upper, or categories, or permutation".into());
        };
        let mut axis = if self.integer {
            if [lower, upper]
                .iter()
                .any(|end| end.fract() != 0.0 || end.abs() >= MOST)
            {
                let [lower, upper] = [lower, upper].map(exact);
                return Err(format!(
                    "lower = {lower} and upper = {upper}: the ends of an integer axis are whole numbers below 2^53"
                ));
            }
            #[expect(clippy::cast_possible_truncation, reason = "whole and below 2^53")]
            Axis::integer(lower as i64, upper as i64)
        } else {
            Axis::continuous(lower, upper)
        };
        if self.logarithmic {
            axis = axis.logarithmic();
        }
        Ok(vec![if self.periodic { axis.periodic() } else { axis }])
    }
}

/// The name of each entry and its coordinates, in order.
pub fn places(entries: &[AxisEntry]) -> impl Iterator<Item = (String, Range<usize>)> + '_ {
    entries.iter().scan(0, |next, entry| {
        let start = *next;
        *next += entry.len();
        let name = entry.name.clone().unwrap_or_else(|| format!("x{start}"));
        Some((name, start..*next))
    })
}

/// The space of these axes.
///
/// # Errors
///
/// The name of an axis, and what is wrong with it.
pub fn space(entries: &[AxisEntry]) -> Result<Space<f64>, String> {
    let mut axes = Vec::new();
    for (entry, (name, _)) in entries.iter().zip(places(entries)) {
        axes.extend(entry.axes().map_err(|what| format!("axis {name}: {what}"))?);
    }
    Space::new(axes).map_err(|error| {
        let said = error.to_string();
        let Error::Bounds { axis, .. } = error else {
            return said;
        };
        // By its name, as in the errors above.
        let name = places(entries).find_map(|(name, place)| place.contains(&axis).then_some(name));
        let what = said.strip_prefix(&format!("axis {axis}: "));
        match (name, what) {
            (Some(name), Some(what)) => format!("axis {name}: {what}"),
            _ => said,
        }
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    fn entries(json: &str) -> Vec<AxisEntry> {
        serde_json::from_str(json).unwrap()
    }

    #[test]
    fn every_kind_of_axis_is_described() {
        let entries = entries(
            r#"[{"lower": -1, "upper": 1, "periodic": true}, {"name": "n", "lower": 2, "upper": 5, "integer": true},
                {"name": "order", "permutation": 3}, {"categories": ["a", "b"]}, {"lower": 1e-3, "upper": 1e3, "logarithmic": true}]"#,
        );
        let space = space(&entries).unwrap();
        let axes = [
            Axis::continuous(-1.0, 1.0).periodic(),
            Axis::integer(2, 5),
            Axis::categorical(2),
            Axis::continuous(1e-3, 1e3).logarithmic(),
        ];
        assert_eq!([0, 1, 5, 6].map(|axis| space.axes()[axis]), axes);
        assert_eq!(space.axes()[2..5], Axis::permutation(3).collect::<Vec<_>>());
        let names: Vec<_> = places(&entries).collect();
        assert_eq!(names[2], ("order".to_owned(), 2..5));
        assert_eq!(names[3], ("x5".to_owned(), 5..6));
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (json, says) in [
            ("[]", "no axis"),
            (r#"[{"lower": 0}]"#, "give lower and upper"),
            (r#"[{"lower": 1, "upper": 0}]"#, "above the upper"),
            (
                r#"[{"lower": 0.5, "upper": 1, "integer": true}]"#,
                "whole numbers",
            ),
            (r#"[{"lower": 0, "categories": ["a"]}]"#, "neither lower"),
            (
                r#"[{"categories": ["a", "b", "a"]}]"#,
                "axis x0: two categories are called `a`: choose different names",
            ),
            (
                r#"[{"lower": 0, "upper": 1, "logarithmic": true}]"#,
                "axis x0: bounds [0, 1] are not usable",
            ),
            (
                r#"[{"permutation": 3}, {"name": "n", "lower": 2, "upper": 1}]"#,
                "axis n: bounds [2, 1]",
            ),
            (
                r#"[{"lower": 0, "upper": 1e300, "integer": true}]"#,
                "axis x0: lower = 0 and upper = 1e300: the ends",
            ),
            (
                r#"[{"lower": 1, "upper": 9, "logarithmic": true, "integer": true}]"#,
                "continuous",
            ),
            (
                r#"[{"lower": 1, "upper": 9, "logarithmic": true, "periodic": true}]"#,
                "axis x0",
            ),
            (r#"[{"permutation": 0}]"#, "from 1 to"),
            (r#"[{"permutation": 3, "integer": true}]"#, "nothing else"),
        ] {
            let error = space(&entries(json)).unwrap_err();
            assert!(error.contains(says), "{json}: {error}");
        }
    }
}

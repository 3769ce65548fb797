//! The space of a program, as a TOML file describes it.

use std::path::Path;

use anyhow::{Context, bail};
use satisfice::{Axis, Space};
use serde::{Deserialize, Serialize};

/// A space and when two of its points are one answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SpaceFile {
    /// Within which distance hits are one answer: a number, or one for each axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) separation: Option<Widths>,
    /// The axes in the order of the coordinates.
    #[serde(rename = "axis")]
    pub(crate) axes: Vec<AxisEntry>,
}

/// One number, or one for each axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub(crate) enum Widths {
    /// The same for all axes.
    Same(f64),
    /// One for each axis.
    PerAxis(Vec<f64>),
}

/// An axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct AxisEntry {
    /// Its name, for `{name}` in the template of a program; `x0`, `x1`, … by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) name: Option<String>,
    /// Least value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) lower: Option<f64>,
    /// Greatest value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) upper: Option<f64>,
    /// Whether its values are whole numbers.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) integer: bool,
    /// Words instead of numbers. Their coordinate is the index.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) categories: Vec<String>,
}

/// Integers beyond this are not exact.
const MOST: f64 = 9_007_199_254_740_992.0;

impl SpaceFile {
    /// Reads a file.
    pub(crate) fn read(path: &Path) -> anyhow::Result<Self> {
        let shown = path.display();
        let text = satisfice_catalogue::input::read_to_string(path)
            .with_context(|| format!("cannot read {shown}"))?;
        Self::parse(&text).with_context(|| format!("{shown} does not describe a space"))
    }

    fn parse(text: &str) -> anyhow::Result<Self> {
        let read: Self = toml::from_str(text)?;
        read.space()?;
        let names: Vec<String> = (0..read.axes.len()).map(|axis| read.name(axis)).collect();
        for (axis, name) in names.iter().enumerate() {
            if name.is_empty() || name == "x" || name.contains(['{', '}', ' ']) {
                bail!("`{name}` is no name of an axis: choose a word that is not `x`");
            }
            if names[..axis].contains(name) {
                bail!("two axes are called `{name}`: choose different names");
            }
        }
        Ok(read)
    }

    /// The name of an axis.
    pub(crate) fn name(&self, axis: usize) -> String {
        self.axes[axis].name.clone().unwrap_or_else(|| format!("x{axis}"))
    }

    /// The space that it describes.
    pub(crate) fn space(&self) -> anyhow::Result<Space<f64>> {
        let axes = self.axes.iter().enumerate();
        let axes: Vec<Axis<f64>> = axes
            .map(|(number, axis)| axis.axis().with_context(|| format!("axis {}", self.name(number))))
            .collect::<anyhow::Result<_>>()?;
        Ok(Space::new(axes)?)
    }

    /// A coordinate as a program is given it: a number, or the word of a category.
    pub(crate) fn text(&self, axis: usize, value: f64) -> String {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a value of an axis from 0 to the number of its words"
        )]
        let word = self.axes[axis].categories.get(value as usize);
        word.cloned().unwrap_or_else(|| value.to_string())
    }
}

impl AxisEntry {
    #[expect(clippy::cast_possible_truncation, reason = "whole and below 2^53")]
    fn axis(&self) -> anyhow::Result<Axis<f64>> {
        if !self.categories.is_empty() {
            if self.lower.is_some() || self.upper.is_some() || self.integer {
                bail!("an axis of categories has neither lower, upper nor integer");
            }
            let last = i64::try_from(self.categories.len() - 1)?;
            return Ok(Axis::integer(0, last));
        }
        let (Some(lower), Some(upper)) = (self.lower, self.upper) else {
            bail!("give lower and upper, or categories");
        };
        if !self.integer {
            return Ok(Axis::continuous(lower, upper));
        }
        if [lower, upper]
            .iter()
            .any(|end| end.fract() != 0.0 || end.abs() >= MOST)
        {
            bail!(
                "lower = {lower} and upper = {upper}: the ends of an integer axis are whole numbers below 2^53"
            );
        }
        Ok(Axis::integer(lower as i64, upper as i64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_space_is_read() {
        let text = "separation = 0.1\n[[axis]]\nname = \"angle\"\nlower = -1\nupper = 1\n[[axis]]\ninteger = true\nlower = 2\nupper = 5\n\
                    [[axis]]\nname = \"metal\"\ncategories = [\"steel\", \"brass\"]\n";
        let file = SpaceFile::parse(text).unwrap();
        let space = file.space().unwrap();
        assert_eq!(space.dimension(), 3);
        assert_eq!((space.axes()[1].lower(), space.axes()[2].upper()), (2.0, 1.0));
        assert_eq!([file.name(0), file.name(1)], ["angle", "x1"]);
        assert_eq!(
            [file.text(0, 0.5), file.text(1, 3.0), file.text(2, 1.0)],
            ["0.5", "3", "brass"]
        );
        assert_eq!(file.separation, Some(Widths::Same(0.1)));
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (text, says) in [
            ("", "missing field `axis`"),
            ("axis = []", "no axis"),
            ("[[axis]]\nlower = 0", "give lower and upper"),
            ("[[axis]]\nlower = 1\nupper = 0", "above the upper"),
            (
                "[[axis]]\nlower = 0.5\nupper = 1\ninteger = true",
                "whole numbers",
            ),
            ("[[axis]]\nlower = 0\nupper = 1\nintger = true", "intger"),
            ("[[axis]]\nlower = 0\ncategories = [\"a\"]", "neither lower"),
            ("[[axis]]\nname = \"x\"\nlower = 0\nupper = 1", "not `x`"),
            (
                "[[axis]]\nname = \"a\"\nlower = 0\nupper = 1\n[[axis]]\nname = \"a\"\nlower = 0\nupper = 1",
                "two axes",
            ),
        ] {
            let error = format!("{:#}", SpaceFile::parse(text).unwrap_err());
            assert!(error.contains(says), "{text}: {error}");
        }
    }
}

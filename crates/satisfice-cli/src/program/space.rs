//! The space of a program, as a TOML file describes it.

use std::ops::Range;
use std::path::Path;

use anyhow::{Context, anyhow, bail};
use clap::CommandFactory;
use satisfice::Space;
use satisfice_catalogue::axes::{self, AxisEntry};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::arguments::Satisfice;

/// A space and when two of its points are one answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SpaceFile {
    /// Within which distance hits are one answer: a number, or one for each axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) separation: Option<Widths>,
    /// The axes, and permutations, in the order of the coordinates.
    #[serde(rename = "axis")]
    pub(crate) axes: Vec<AxisEntry>,
}

/// One number, or one for each axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "separation is a number, or a list of one for each axis"
)]
pub(crate) enum Widths {
    /// The same for all axes.
    Same(f64),
    /// One for each axis; for a permutation one in all.
    PerAxis(Vec<f64>),
}

impl SpaceFile {
    /// Reads a file.
    pub(crate) fn read(path: &Path) -> anyhow::Result<Self> {
        let shown = path.display();
        let text = satisfice_catalogue::input::read_to_string(path)
            .with_context(|| format!("cannot read {shown}"))?;
        Self::parse(&text).with_context(|| format!("{shown} does not describe a space"))
    }

    fn parse(text: &str) -> anyhow::Result<Self> {
        let read: Self = toml::from_str(text).map_err(|error| match option(error.message()) {
            Some(name) => anyhow!("`{name}` stands on the command line, not in this file: --{name}"),
            None => error.into(),
        })?;
        read.space()?;
        let names: Vec<String> = read.places().map(|(name, _)| name).collect();
        for (axis, name) in names.iter().enumerate() {
            if name == "x" {
                bail!("no axis can be called `x`: in a program's command {{x}} stands for all coordinates");
            }
            if name.is_empty() || name.contains(['{', '}', ' ']) {
                bail!("`{name}` is no name of an axis: choose a word");
            }
            if names[..axis].contains(name) {
                bail!("two axes are called `{name}`: choose different names");
            }
        }
        Ok(read)
    }

    /// The names of the axes and permutations, and the coordinates of each.
    pub(crate) fn places(&self) -> impl Iterator<Item = (String, Range<usize>)> + '_ {
        axes::places(&self.axes)
    }

    /// The space that it describes.
    pub(crate) fn space(&self) -> anyhow::Result<Space<f64>> {
        axes::space(&self.axes).map_err(|error| anyhow!(error))
    }

    /// The radius on each coordinate within which hits are one answer, if there is any.
    pub(crate) fn radii(&self) -> anyhow::Result<Option<Vec<f64>>> {
        let each = match &self.separation {
            None => return Ok(None),
            Some(Widths::Same(radius)) => vec![*radius; self.axes.len()],
            Some(Widths::PerAxis(radii)) if radii.len() == self.axes.len() => radii.clone(),
            Some(Widths::PerAxis(radii)) => bail!(
                "separation has {} radii for {} axes: give one for each, or one number",
                radii.len(),
                self.axes.len()
            ),
        };
        let of_each = self.axes.iter().zip(each);
        Ok(Some(
            of_each
                .flat_map(|(axis, radius)| vec![radius; axis.len()])
                .collect(),
        ))
    }

    /// Whether hits on continuous axes are different ones, however near they are, because nothing else was said.
    pub(crate) fn tells_all_apart(&self) -> bool {
        let is_continuous = |space: Space<f64>| space.axes().iter().any(|axis| !axis.is_integer());
        self.separation.is_none() && self.space().is_ok_and(is_continuous)
    }

    /// A solution of a report by the names of the axes, for a person: `r = 33.5, metal = brass`.
    pub(crate) fn described(&self, solution: &Value) -> String {
        let coordinates = solution.get("coordinates").and_then(Value::as_array);
        let point = coordinates.map(|all| all.iter().filter_map(Value::as_f64).collect::<Vec<_>>());
        let Some(point) = point.filter(|point| self.places().all(|(_, range)| range.end <= point.len()))
        else {
            return solution.to_string();
        };
        let texts = self.texts(&point);
        let named = self
            .places()
            .map(|(name, range)| format!("{name} = {}", texts[range].join(" ")));
        named.collect::<Vec<_>>().join(", ")
    }

    /// The coordinates of a point as a program is given them: numbers, or the words of categories.
    pub(crate) fn texts(&self, point: &[f64]) -> Vec<String> {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a value of an axis from 0 to the number of its words"
        )]
        let text = |axis: &AxisEntry, value: &f64| {
            let word = axis.categories.get(*value as usize);
            word.cloned().unwrap_or_else(|| value.to_string())
        };
        let coordinates = self.axes.iter().zip(self.places());
        coordinates
            .flat_map(|(axis, (_, range))| point[range].iter().map(move |value| text(axis, value)))
            .collect()
    }
}

/// The key that an error calls unknown, if it is an option of the command.
fn option(message: &str) -> Option<&str> {
    let (key, _) = message.strip_prefix("unknown field `")?.split_once('`')?;
    let command = Satisfice::command();
    let run = command.find_subcommand("run")?;
    let is_option = run.get_arguments().any(|known| known.get_long() == Some(key));
    is_option.then_some(key)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_space_is_read() {
        let text = "separation = 0.1\n[[axis]]\nname = \"angle\"\nlower = -1\nupper = 1\nperiodic = true\n[[axis]]\ninteger = true\n\
                    lower = 2\nupper = 5\n[[axis]]\nname = \"metal\"\ncategories = [\"steel\", \"brass\"]\n[[axis]]\nname = \"order\"\n\
                    permutation = 2\n";
        let file = SpaceFile::parse(text).unwrap();
        assert_eq!(file.space().unwrap().dimension(), 5);
        let names: Vec<String> = file.places().map(|(name, _)| name).collect();
        assert_eq!(names, ["angle", "x1", "metal", "order"]);
        assert_eq!(
            file.texts(&[0.5, 3.0, 1.0, 1.0, 0.0]),
            ["0.5", "3", "brass", "1", "0"]
        );
        let solution = serde_json::json!({"coordinates": [0.5, 3.0, 1.0, 1.0, 0.0], "separation": 0.1});
        assert_eq!(
            file.described(&solution),
            "angle = 0.5, x1 = 3, metal = brass, order = 1 0"
        );
        assert_eq!(file.separation, Some(Widths::Same(0.1)));
        assert_eq!(file.radii().unwrap().unwrap(), [0.1; 5]);
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (text, says) in [
            ("", "missing field `axis`"),
            ("axis = []", "no axis"),
            (
                "threshold = 1\n[[axis]]\nlower = 0\nupper = 1",
                "`threshold` stands on the command line, not in this file: --threshold",
            ),
            ("sepration = 1\n[[axis]]\nlower = 0\nupper = 1", "unknown field"),
            (
                "separation = \"wide\"\n[[axis]]\nlower = 0\nupper = 1",
                "separation is a number, or a list of one for each axis",
            ),
            (
                "[[axis]]\nname = \"metal\"\ncategories = [\"a\", \"b\", \"a\"]",
                "axis metal: two categories are called `a`",
            ),
            (
                "[[axis]]\nlower = 1\nupper = 0",
                "axis x0: bounds [1, 0] are not usable",
            ),
            ("[[axis]]\nlower = 0", "axis x0: give lower and upper"),
            ("[[axis]]\nlower = 0\nupper = 1\nintger = true", "intger"),
            ("[[axis]]\nname = \"x\"\nlower = 0\nupper = 1", "stands for all"),
            (
                "[[axis]]\nname = \"a\"\nlower = 0\nupper = 1\n[[axis]]\nname = \"a\"\nlower = 0\nupper = 1",
                "two axes",
            ),
        ] {
            let error = format!("{:#}", SpaceFile::parse(text).unwrap_err());
            assert!(error.contains(says), "{text}: {error}");
        }
        let file =
            SpaceFile::parse("separation = [1.0]\n[[axis]]\nlower = 0\nupper = 1\n[[axis]]\npermutation = 4")
                .unwrap();
        assert!(
            file.radii()
                .unwrap_err()
                .to_string()
                .contains("1 radii for 2 axes")
        );
    }
}

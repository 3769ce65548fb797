//! What to sweep over, as a TOML file says it.

use std::ops::Range;
use std::path::Path;
use std::time::Duration;

use indexmap::IndexMap;
use satisfice_catalogue::options::{self, OPTIONS};
use satisfice_catalogue::{RunSpec, input, quantity};
use serde::Deserialize;
use serde::de::{Error as _, MapAccess, Visitor, value::MapAccessDeserializer};
use serde_path_to_error::Segment;
use toml::{Table, Value};

use crate::error::Error;

/// A set of parts, each a grid of engines x problems x parameters x budgets x seeds.
///
/// ```toml
/// title = "My comparison"
/// seeds = "0..8"                                  # 8 is excluded
///
/// [[part]]
/// name = "small swarms"
/// engines = ["random", { name = "latest-hit-qpso", particles = [10, 30] }]   # all values of a list are run
/// problems = [{ name = "rastrigin", dimension = [2, 3] }, "queens"]
/// evaluations = 100_000                           # and / or: time = "100ms", hits, patience, slices, probes, islands, parallel; lists as well
/// at-evaluations = [1000, 10_000]                 # where hits are counted; at-times = ["10ms"]
/// against = "random"                              # the engine that the others are compared with, seed by seed
/// beside = { queens = "backtracking: all 92 in 2,057 nodes" }   # printed beside the figures of a problem
/// ```
///
/// `engines`, `problems` and `beside` before the first part are those of every part without its own. With a table `[regret]`, one engine is
/// compared with the best of the others ([`super::regret`]).
#[derive(Debug, Clone, PartialEq)]
pub struct Suite {
    /// Its name: that of the file, without folder and extension.
    pub name: String,
    /// Heading of its report.
    pub title: String,
    /// A description, one paragraph.
    pub about: String,
    /// The text it was read from.
    pub text: String,
    /// Its parts, at least one.
    pub parts: Vec<Part>,
    /// Names of [studies](crate::studies) that follow its parts.
    pub studies: Vec<String>,
    /// Which engine is compared with the best of the others, on every problem and budget.
    pub regret: Option<Regret>,
}

/// The comparison of one engine with the best of the others; see [`super::regret`].
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Regret {
    /// The engine: a name or a label.
    pub engine: String,
    /// Labels of the problems that tuning does not look at: name and the parameters that the suite sets.
    #[serde(default)]
    pub held_back: Vec<String>,
}

/// One grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Its name, unlike that of any other part.
    pub name: String,
    /// The engines, with values of their parameters.
    pub engines: Vec<Choice>,
    /// The problems, with values of their parameters.
    pub problems: Vec<Choice>,
    /// The seeds.
    pub seeds: Range<u64>,
    /// Options of a run with the values to try, by the names of [`OPTIONS`].
    pub options: Vec<(String, Vec<String>)>,
    /// Evaluations at which hits are counted.
    pub at_evaluations: Vec<u64>,
    /// Times at which hits are counted.
    pub at_times: Vec<Duration>,
    /// The engine that all others are compared with: a name or a label; the first one by default.
    pub against: Option<String>,
    /// Text printed with a problem's figures, by the problem's label: its name and the parameters that the suite sets.
    pub beside: IndexMap<String, String>,
}

impl Part {
    /// How errors call it: its number, from 1, and the name that it was given.
    pub(super) fn place(&self, at: usize) -> String {
        place(at, (self.name != unnamed(at)).then_some(&self.name))
    }
}

fn place(at: usize, name: Option<&String>) -> String {
    name.map_or_else(|| unnamed(at), |name| format!("{} `{name}`", unnamed(at)))
}

/// The name of a part that has none.
fn unnamed(at: usize) -> String {
    format!("part {}", at + 1)
}

/// A name with parameters, each with the values to try.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Name of an engine or a problem.
    pub name: String,
    /// Parameters as `(name, values)`.
    pub settings: Vec<(String, Vec<String>)>,
}

static NAMED: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/suites.rs"));

/// Names of the suites that come with the program.
pub fn names() -> impl ExactSizeIterator<Item = &'static str> {
    NAMED.iter().map(|(name, _)| *name)
}

impl Suite {
    /// A suite by its name, or from a file: what ends with `.toml` or has a folder in it is a file.
    ///
    /// # Errors
    /// [`Error::Run`] for an unknown name, with the nearest; [`Error::File`] for a file that cannot be read;
    /// [`Error::Suite`] for a file that is not a suite.
    pub fn open(name_or_file: &str) -> Result<Self, Error> {
        let path = Path::new(name_or_file);
        if path.extension().is_some_and(|extension| extension == "toml") || path.components().count() > 1 {
            let text = input::read_to_string(path).map_err(|error| Error::File {
                path: path.to_owned(),
                what: format!("cannot read this suite: {error}"),
            })?;
            return Self::parse(name_or_file, &text);
        }
        let found = NAMED.iter().find(|(name, _)| *name == name_or_file);
        let unknown = || satisfice::Error::unknown("suite (or file.toml)", name_or_file, names());
        let (name, text) = found.ok_or_else(unknown)?;
        Self::parse(name, text)
    }

    /// A suite from its text. Names of engines, problems and parameters are looked up later, by [`super::Plan::new`].
    ///
    /// # Errors
    /// [`Error::Suite`], which says where and what.
    pub fn parse(name: &str, text: &str) -> Result<Self, Error> {
        let table: Table = text.parse().map_err(|error: toml::de::Error| {
            let before = error.span().map_or(0, |span| span.start);
            let line = 1 + text.bytes().take(before).filter(|&byte| byte == b'\n').count();
            wrong(format!("{name}, line {line}"), error.message())
        })?;
        let mut file: SuiteFile =
            serde_path_to_error::deserialize(table).map_err(|error| located(name, &error))?;
        let mut parts: Vec<Part> = Vec::new();
        for (index, part) in file.parts().into_iter().enumerate() {
            let place = format!("{name}, {}", place(index, part.name.as_ref()));
            let part = part
                .finish(index, file.seeds.as_ref())
                .map_err(|what| wrong(place.clone(), what))?;
            if parts.iter().any(|known| known.name == part.name) {
                let what = format!("there are two parts named `{}`: name them apart", part.name);
                return Err(wrong(place, what));
            }
            parts.push(part);
        }
        if parts.is_empty() {
            let what = "there is no [[part]]: give at least one, with engines and problems";
            return Err(wrong(name.to_owned(), what));
        }
        let stem = Path::new(name).file_stem();
        let stem = stem.map_or_else(|| name.to_owned(), |stem| stem.to_string_lossy().into_owned());
        Ok(Self {
            title: file.title.unwrap_or_else(|| stem.clone()),
            name: stem,
            about: file.about,
            text: text.to_owned(),
            parts,
            studies: file.studies,
            regret: file.regret,
        })
    }
}

/// Seeds as `A..B`, B excluded.
///
/// # Errors
/// Any other text, and a range without a seed.
pub fn seeds(text: &str) -> Result<Range<u64>, String> {
    let hint = || {
        format!(
            "seeds = {text} is not allowed: write A..B with A < B, such as 0..16 for the 16 seeds from 0 to 15"
        )
    };
    let (first, end) = text.split_once("..").ok_or_else(hint)?;
    let range = first.trim().parse().map_err(|_| hint())?..end.trim().parse().map_err(|_| hint())?;
    if range.is_empty() {
        return Err(hint());
    }
    Ok(range)
}

/// The file as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SuiteFile {
    title: Option<String>,
    #[serde(default)]
    about: String,
    seeds: Option<Seeds>,
    #[serde(default)]
    studies: Vec<String>,
    regret: Option<Regret>,
    #[serde(default)]
    engines: Vec<Choice>,
    #[serde(default)]
    problems: Vec<Choice>,
    #[serde(default)]
    beside: IndexMap<String, String>,
    #[serde(default)]
    part: Vec<PartFile>,
}

impl SuiteFile {
    /// Takes the parts out, each with the lists of the suite where it has none of its own.
    fn parts(&mut self) -> Vec<PartFile> {
        let mut parts = std::mem::take(&mut self.part);
        for part in &mut parts {
            if part.engines.is_empty() {
                part.engines.clone_from(&self.engines);
            }
            if part.problems.is_empty() {
                part.problems.clone_from(&self.problems);
            }
            if part.beside.is_empty() {
                part.beside.clone_from(&self.beside);
            }
        }
        parts
    }
}

/// A part as it is written; what it does not name is an option of a run, or a mistake.
#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
struct PartFile {
    name: Option<String>,
    #[serde(default)]
    engines: Vec<Choice>,
    #[serde(default)]
    problems: Vec<Choice>,
    seeds: Option<Seeds>,
    at_evaluations: Option<Value>,
    at_times: Option<Value>,
    against: Option<String>,
    #[serde(default)]
    beside: IndexMap<String, String>,
    #[serde(flatten)]
    options: Table,
}

/// The keys of a part that are not options.
const KEYS: [&str; 8] = [
    "name",
    "engines",
    "problems",
    "seeds",
    "at-evaluations",
    "at-times",
    "against",
    "beside",
];

#[derive(Deserialize, Clone)]
#[serde(try_from = "String")]
struct Seeds(Range<u64>);

impl TryFrom<String> for Seeds {
    type Error = String;
    fn try_from(text: String) -> Result<Self, String> {
        seeds(&text).map(Self)
    }
}

impl PartFile {
    fn finish(self, index: usize, seeds: Option<&Seeds>) -> Result<Part, String> {
        let mut options = Vec::new();
        for (name, value) in &self.options {
            // A suite has a range of seeds instead.
            let known = OPTIONS
                .iter()
                .map(|option| option.name)
                .filter(|name| *name != "seed");
            let Some(option) = options::find(name).filter(|option| option.name != "seed") else {
                let known = KEYS.into_iter().chain(known);
                return Err(satisfice::Error::unknown("key of a part", name, known).to_string());
            };
            let values = values(name, value)?;
            let try_set = |text: &str| option.set(&mut RunSpec::new(""), text);
            quantities(name, &values, try_set)?;
            options.push((name.clone(), values));
        }
        let list =
            |key: &str, value: Option<&Value>| value.map_or(Ok(Vec::new()), |value| values(key, value));
        let evaluations = list("at-evaluations", self.at_evaluations.as_ref())?;
        let times = list("at-times", self.at_times.as_ref())?;
        let given = |name: &str| self.options.contains_key(name);
        if !given("time") && !given("evaluations") {
            return Err("no budget: give evaluations = 100_000, time = \"100ms\", or both".to_owned());
        }
        for (key, choices) in [("engines", &self.engines), ("problems", &self.problems)] {
            if choices.is_empty() {
                let hint = format!("write {key} = [\"NAME\", {{ name = \"NAME\", parameter = 1 }}]");
                return Err(format!("{key} are missing: {hint}"));
            }
        }
        let seeds = self.seeds.as_ref().or(seeds);
        Ok(Part {
            name: self.name.unwrap_or_else(|| unnamed(index)),
            engines: self.engines,
            problems: self.problems,
            seeds: seeds
                .map(|seeds| seeds.0.clone())
                .ok_or("seeds are missing: write for instance seeds = \"0..16\"")?,
            options,
            at_evaluations: quantities("at-evaluations", &evaluations, quantity::count)?,
            at_times: quantities("at-times", &times, quantity::time)?,
            against: self.against,
            beside: self.beside,
        })
    }
}

/// Parses every value of a key.
fn quantities<T>(
    key: &str,
    texts: &[String],
    mut parse: impl FnMut(&str) -> Result<T, String>,
) -> Result<Vec<T>, String> {
    let parsed = texts
        .iter()
        .map(|text| parse(text).map_err(|what| format!("{key} = {text} is not allowed: {what}")));
    parsed.collect()
}

/// A value, or all values of a list, as texts.
fn values(key: &str, value: &Value) -> Result<Vec<String>, String> {
    let text = |value: &Value| match value {
        Value::String(text) => Ok(text.clone()),
        Value::Integer(number) => Ok(number.to_string()),
        Value::Float(number) => Ok(number.to_string()),
        other => Err(format!(
            "{key} = {other} is not allowed: give a number, a text in quotes, or a list of those"
        )),
    };
    match value {
        Value::Array(list) if list.is_empty() => Err(format!("{key} is an empty list: give a value")),
        Value::Array(list) => list.iter().map(text).collect(),
        value => text(value).map(|text| vec![text]),
    }
}

impl<'de> Deserialize<'de> for Choice {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        struct Named {
            name: String,
            #[serde(flatten)]
            settings: Table,
        }
        struct NameOrTable;
        impl<'de> Visitor<'de> for NameOrTable {
            type Value = Choice;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("\"NAME\" or { name = \"NAME\", parameter = 1 }")
            }
            fn visit_str<E>(self, name: &str) -> Result<Choice, E> {
                Ok(Choice {
                    name: name.to_owned(),
                    settings: Vec::new(),
                })
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Choice, A::Error> {
                let Named { name, settings } = Named::deserialize(MapAccessDeserializer::new(map))?;
                let settings = settings.iter().map(|(key, value)| {
                    let values = values(key, value).map_err(|what| format!("{name}: {what}"));
                    Ok((key.clone(), values.map_err(A::Error::custom)?))
                });
                Ok(Choice {
                    settings: settings.collect::<Result<_, A::Error>>()?,
                    name,
                })
            }
        }
        deserializer.deserialize_any(NameOrTable)
    }
}

fn wrong(place: String, what: impl Into<String>) -> Error {
    Error::Suite {
        place,
        what: what.into(),
    }
}

/// The place of a mistake as a user counts: parts from 1, then the key.
fn located(name: &str, error: &serde_path_to_error::Error<toml::de::Error>) -> Error {
    let mut place = name.to_owned();
    let mut keys = Vec::new();
    for segment in error.path() {
        match segment {
            Segment::Map { key } if key == "part" && keys.is_empty() => {}
            Segment::Seq { index } if keys.is_empty() => place.push_str(&format!(", part {}", index + 1)),
            Segment::Map { key } => keys.push(key.clone()),
            Segment::Seq { index } => keys.push(format!("entry {}", index + 1)),
            Segment::Enum { .. } | Segment::Unknown => {}
        }
    }
    let message = error.inner().message();
    // serde names the unknown field first, then those that it knows.
    if message.starts_with("unknown field") {
        let mut names = message.split('`').skip(1).step_by(2);
        let unknown = names.next().unwrap_or_default();
        let error = satisfice::Error::unknown("key of a suite", unknown, names);
        return wrong(place, error.to_string());
    }
    let key = if keys.is_empty() {
        String::new()
    } else {
        format!("{}: ", keys.join(", "))
    };
    wrong(place, format!("{key}{message}"))
}

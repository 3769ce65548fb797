//! What to sweep over, as a TOML file says it.

use std::ops::Range;
use std::path::Path;
use std::time::Duration;

use satisfice::Error as SearchError;
use toml::{Table, Value};

use crate::error::Error;
use satisfice_catalogue::quantity;

/// A set of parts, each a grid of engines x problems x parameters x seeds under one budget.
///
/// ```toml
/// title = "My comparison"
/// seeds = "0..8"                                  # 8 is excluded
///
/// [[part]]
/// name = "small swarms"
/// engines = ["random", { name = "latest-hit-qpso", particles = [10, 30] }]   # a list is swept over
/// problems = [{ name = "rastrigin", dimension = [2, 3] }, "queens"]
/// evaluations = 100_000                           # and / or: time = "100ms", hits, slices, probes
/// at-evaluations = [1000, 10_000]                 # where hits are noted; at-times = ["10ms"]
/// against = "random"                              # with whom all others are compared seed by seed
/// beside = { queens = "backtracking: all 92 in 2,057 nodes" }   # said beside the figures of a problem
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Suite {
    /// Its name: that of the file, without folder and extension.
    pub name: String,
    /// Heading of its report.
    pub title: String,
    /// What it shows, a paragraph.
    pub about: String,
    /// The text it was read from.
    pub text: String,
    /// Its parts, at least one.
    pub parts: Vec<Part>,
    /// Names of [studies](crate::studies) that follow its parts.
    pub studies: Vec<String>,
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
    /// Wall time a slice.
    pub time: Option<Duration>,
    /// Evaluations a slice.
    pub evaluations: Option<u64>,
    /// Hits at which a run ends.
    pub hits: Option<u64>,
    /// Slices.
    pub slices: u64,
    /// Share of uniform probes.
    pub probes: Option<f64>,
    /// Evaluations at which hits are noted.
    pub at_evaluations: Vec<u64>,
    /// Times at which hits are noted.
    pub at_times: Vec<Duration>,
    /// The engine all others are compared with: a name or a label; the first one by default.
    pub against: Option<String>,
    /// What is said beside a problem's figures, by the problem's label: its name and the parameters that the suite names.
    pub beside: Vec<(String, String)>,
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
    /// [`Error::Search`] for an unknown name, with the nearest; [`Error::File`] for a file that cannot be read;
    /// [`Error::Suite`] for one that is no suite.
    pub fn open(name_or_file: &str) -> Result<Self, Error> {
        let path = Path::new(name_or_file);
        if path.extension().is_some_and(|extension| extension == "toml") || path.components().count() > 1 {
            let text = std::fs::read_to_string(path).map_err(|error| Error::File {
                path: path.to_owned(),
                what: format!("cannot read this suite: {error}"),
            })?;
            return Self::parse(name_or_file, &text);
        }
        let found = NAMED.iter().find(|(name, _)| *name == name_or_file);
        let (name, text) =
            found.ok_or_else(|| SearchError::unknown("suite (or file.toml)", name_or_file, names()))?;
        Self::parse(name, text)
    }

    /// A suite from its text. Names of engines, problems and parameters are looked up later, by [`super::Plan::new`].
    ///
    /// # Errors
    /// [`Error::Suite`], which says where and what.
    pub fn parse(name: &str, text: &str) -> Result<Self, Error> {
        let at = |place: String| {
            move |what: String| Error::Suite {
                place: place.clone(),
                what,
            }
        };
        let table: Table = text.parse().map_err(|error: toml::de::Error| {
            let begin = error.span().map_or(0, |span| span.start).min(text.len());
            let line = text[..begin].matches('\n').count() + 1;
            at(format!("{name}, line {line}"))(error.message().to_owned())
        })?;
        let whole = at(name.to_owned());
        let suite = Fields { table: &table };
        suite
            .know("key of a suite", &["title", "about", "seeds", "studies", "part"])
            .map_err(&whole)?;
        let seeds = suite
            .text("seeds")
            .and_then(|text| text.map(seeds).transpose())
            .map_err(&whole)?;
        let stem = Path::new(name)
            .file_stem()
            .map_or_else(|| name.into(), |stem| stem.to_string_lossy());
        let title = suite.text("title").map_err(&whole)?.unwrap_or(&stem).to_owned();
        let about = suite
            .text("about")
            .map_err(&whole)?
            .unwrap_or_default()
            .to_owned();
        let studies = table
            .get("studies")
            .map(values)
            .transpose()
            .map_err(&whole)?
            .unwrap_or_default();
        let tables = match table.get("part") {
            Some(Value::Array(tables)) if !tables.is_empty() => tables.as_slice(),
            _ => {
                return Err(whole(
                    "there is no [[part]]: give at least one, with engines and problems".into(),
                ));
            }
        };
        let mut parts: Vec<Part> = Vec::new();
        for (index, value) in tables.iter().enumerate() {
            let at = at(format!("{name}, part {}", index + 1));
            let Value::Table(table) = value else {
                return Err(at("a part is a table: write [[part]]".into()));
            };
            let part = part(&Fields { table }, index, seeds.clone()).map_err(&at)?;
            if parts.iter().any(|known| known.name == part.name) {
                return Err(at(format!(
                    "there are two parts named `{}`: name them apart",
                    part.name
                )));
            }
            parts.push(part);
        }
        Ok(Self {
            name: stem.into_owned(),
            title,
            about,
            text: text.to_owned(),
            parts,
            studies,
        })
    }

    /// The same suite with other seeds in every part.
    #[must_use]
    pub fn with_seeds(mut self, seeds: &Range<u64>) -> Self {
        self.parts.iter_mut().for_each(|part| part.seeds = seeds.clone());
        self
    }

    /// The same suite with these engines alone. Where a part names one, with its parameters there; else at their defaults.
    #[must_use]
    pub fn with_engines(mut self, names: &[String]) -> Self {
        for part in &mut self.parts {
            let known = std::mem::take(&mut part.engines);
            for name in names {
                let mut listed = known.iter().filter(|choice| choice.name == *name).peekable();
                if listed.peek().is_none() {
                    part.engines.push(Choice {
                        name: name.clone(),
                        settings: Vec::new(),
                    });
                }
                part.engines.extend(listed.cloned());
            }
            part.against = part.against.take().filter(|against| names.contains(against));
        }
        self
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

const KEYS: [&str; 13] = [
    "name",
    "engines",
    "problems",
    "seeds",
    "time",
    "evaluations",
    "hits",
    "slices",
    "probes",
    "at-evaluations",
    "at-times",
    "against",
    "beside",
];

fn part(fields: &Fields<'_>, index: usize, seeds_of_suite: Option<Range<u64>>) -> Result<Part, String> {
    fields.know("key of a part", &KEYS)?;
    let own_seeds = fields.text("seeds")?.map(seeds).transpose()?;
    let count = |key: &str| {
        fields
            .quantities(key, quantity::count)
            .map(|all| all.first().copied())
    };
    let part = Part {
        name: fields
            .text("name")?
            .map_or_else(|| format!("part {}", index + 1), str::to_owned),
        engines: fields.choices("engines")?,
        problems: fields.choices("problems")?,
        seeds: own_seeds
            .or(seeds_of_suite)
            .ok_or("seeds are missing: write for instance seeds = \"0..16\"")?,
        time: fields.quantities("time", quantity::time)?.first().copied(),
        evaluations: count("evaluations")?,
        hits: count("hits")?,
        slices: count("slices")?.unwrap_or(1),
        probes: fields.quantities("probes", quantity::share)?.first().copied(),
        at_evaluations: fields.quantities("at-evaluations", quantity::count)?,
        at_times: fields.quantities("at-times", quantity::time)?,
        against: fields.text("against")?.map(str::to_owned),
        beside: fields.texts("beside")?,
    };
    if part.time.is_none() && part.evaluations.is_none() {
        return Err("no budget: give evaluations = 100_000, time = \"100ms\", or both".to_owned());
    }
    Ok(part)
}

/// Reads a table, key by key.
struct Fields<'a> {
    table: &'a Table,
}

impl<'a> Fields<'a> {
    fn know(&self, what: &str, known: &[&str]) -> Result<(), String> {
        match self.table.keys().find(|key| !known.contains(&key.as_str())) {
            Some(key) => Err(SearchError::unknown(what, key, known.iter().copied()).to_string()),
            None => Ok(()),
        }
    }

    fn text(&self, key: &str) -> Result<Option<&'a str>, String> {
        match self.table.get(key) {
            None => Ok(None),
            Some(Value::String(text)) => Ok(Some(text)),
            Some(other) => Err(format!("{key} = {other} is not allowed: a text in quotes")),
        }
    }

    /// A table of texts.
    fn texts(&self, key: &str) -> Result<Vec<(String, String)>, String> {
        let hint =
            |found: &Value| format!("{key} = {found} is not allowed: write {{ \"PROBLEM\" = \"TEXT\" }}");
        match self.table.get(key) {
            None => Ok(Vec::new()),
            Some(Value::Table(table)) => table
                .iter()
                .map(|(name, value)| match value {
                    Value::String(text) => Ok((name.clone(), text.clone())),
                    other => Err(hint(other)),
                })
                .collect(),
            Some(other) => Err(hint(other)),
        }
    }

    /// One quantity or a list of them.
    fn quantities<T>(&self, key: &str, parse: impl Fn(&str) -> Result<T, String>) -> Result<Vec<T>, String> {
        let values = self.table.get(key).map(values).transpose()?.unwrap_or_default();
        values
            .iter()
            .map(|text| parse(text).map_err(|what| format!("{key} = {text} is not allowed: {what}")))
            .collect()
    }

    fn choices(&self, key: &str) -> Result<Vec<Choice>, String> {
        let hint =
            || format!("{key} are missing: write {key} = [\"NAME\", {{ name = \"NAME\", parameter = 1 }}]");
        let Some(Value::Array(list)) = self.table.get(key) else {
            return Err(hint());
        };
        if list.is_empty() {
            return Err(hint());
        }
        list.iter()
            .map(|value| choice(value).unwrap_or_else(|| Err(hint())))
            .collect()
    }
}

fn choice(value: &Value) -> Option<Result<Choice, String>> {
    match value {
        Value::String(name) => Some(Ok(Choice {
            name: name.clone(),
            settings: Vec::new(),
        })),
        Value::Table(table) => {
            let Some(Value::String(name)) = table.get("name") else {
                return None;
            };
            let settings = table.iter().filter(|(key, _)| *key != "name");
            let settings = settings
                .map(|(key, value)| match values(value)? {
                    none if none.is_empty() => Err(format!("{key} of {name} is an empty list: give a value")),
                    some => Ok((key.clone(), some)),
                })
                .collect::<Result<_, String>>();
            Some(settings.map(|settings| Choice {
                name: name.clone(),
                settings,
            }))
        }
        _ => None,
    }
}

/// A value, or a list of values, as texts.
fn values(value: &Value) -> Result<Vec<String>, String> {
    let one = |value: &Value| match value {
        Value::String(text) => Ok(text.clone()),
        Value::Integer(number) => Ok(number.to_string()),
        Value::Float(number) => Ok(number.to_string()),
        other => Err(format!(
            "{other} is not allowed: a number, a text in quotes, or a list of those"
        )),
    };
    match value {
        Value::Array(list) => list.iter().map(one).collect(),
        value => one(value).map(|text| vec![text]),
    }
}

impl Choice {
    /// Every combination of its values: the settings, and a label that repeats what was written.
    #[must_use]
    pub fn grid(&self) -> Vec<(Vec<(String, String)>, String)> {
        let mut grid = vec![(Vec::new(), self.name.clone())];
        for (name, values) in &self.settings {
            grid = grid
                .iter()
                .flat_map(|(settings, label)| {
                    values.iter().map(move |value| {
                        let mut settings: Vec<(String, String)> = settings.clone();
                        settings.push((name.clone(), value.clone()));
                        (settings, format!("{label} {name}={value}"))
                    })
                })
                .collect();
        }
        grid
    }
}

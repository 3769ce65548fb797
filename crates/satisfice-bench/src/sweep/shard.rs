//! A sweep in shards: each machine runs its part of the runs, and the parts are put together.
//!
//! Run number r of a plan belongs to shard r mod n, so every shard has runs of every engine and problem.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use satisfice_catalogue::Catalogue;
use serde::{Deserialize, Serialize};

use super::files;
use super::plan::{Plan, Planned};
use super::results::Results;
use super::row::Row;
use super::selection::Selection;
use super::suite::Suite;
use crate::error::Error;

/// The file that says which part of which sweep a folder has.
const FILE: &str = "shard.json";

/// One of several parts of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Shard {
    /// From 1.
    number: u64,
    of: u64,
}

impl Shard {
    /// Part `number`, from 1, of `of`.
    ///
    /// # Errors
    /// A message for a number that is not from 1 to `of`.
    pub fn new(number: u64, of: u64) -> Result<Self, String> {
        if (1..=of).contains(&number) {
            Ok(Self { number, of })
        } else {
            Err(format!(
                "{number}/{of} is no shard: the first of {of} is 1/{of}, the last {of}/{of}"
            ))
        }
    }

    /// Whether a run is part of it.
    #[must_use]
    pub fn has(&self, run: &Planned<'_>) -> bool {
        run.number() % self.of == self.number - 1
    }

    /// How many parts there are.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.of
    }
}

/// `3/16`: the third of sixteen.
impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text
            .split_once('/')
            .and_then(|(number, of)| Some((number.trim().parse().ok()?, of.trim().parse().ok()?)));
        let (number, of) = numbers.ok_or("a shard is NUMBER/COUNT, such as 3/16")?;
        Self::new(number, of)
    }
}

impl TryFrom<String> for Shard {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Shard> for String {
    fn from(shard: Shard) -> Self {
        shard.to_string()
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

/// The part of a sweep that a folder holds. Shards of one sweep differ in `shard` only.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShardOf {
    /// The part.
    pub shard: Shard,
    /// Name of the suite.
    pub suite: String,
    /// Its text.
    pub text: String,
    /// What is run of it.
    pub selection: Selection,
    /// Version of the program: another one may give other results.
    pub version: String,
}

impl ShardOf {
    /// A part of a suite as it was read, of which this is then selected.
    #[must_use]
    pub fn new(shard: Shard, suite: &Suite, selection: &Selection) -> Self {
        Self {
            shard,
            suite: suite.name.clone(),
            text: suite.text.clone(),
            selection: selection.clone(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }

    /// Writes it to a folder, unless another part is there.
    ///
    /// # Errors
    /// [`Error::File`] if the folder has another part, or cannot be written.
    pub fn claim(&self, folder: &Path) -> Result<(), Error> {
        let path = folder.join(FILE);
        if path.exists() {
            let there = Self::read(folder)?;
            if there != *self {
                let what = format!(
                    "it is of shard {} of `{}` with its own selection of seeds, engines, problems and budgets: choose another folder",
                    there.shard, there.suite
                );
                return Err(Error::File { path, what });
            }
        }
        files::write(&path, &satisfice_catalogue::json::to_vec(self)?)
    }

    /// Reads it from a folder.
    ///
    /// # Errors
    /// [`Error::File`] if the folder was not written with a shard.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        let path = folder.join(FILE);
        let failed = |what: String| Error::File {
            path: path.clone(),
            what,
        };
        let text = std::fs::read(&path).map_err(|error| {
            failed(format!(
                "cannot read it: {error}; name folders that `bench --shard` wrote"
            ))
        })?;
        serde_json::from_slice(&text)
            .map_err(|error| failed(format!("it does not describe a shard: {error}")))
    }

    /// What is run of the suite.
    ///
    /// # Errors
    /// [`Error::Suite`] for a text that is not a suite, and those of [`Selection::apply`].
    pub fn suite(&self) -> Result<Suite, Error> {
        self.selection.apply(Suite::parse(&self.suite, &self.text)?)
    }
}

/// Puts the shards in these folders together: the plan, and the rows of all of its runs in its order.
///
/// # Errors
/// [`Error::File`] for a folder of another sweep, for a run that is in two folders, for a shard that is missing, and for one
/// that is not finished: each by name.
pub fn merge(folders: &[PathBuf], catalogue: &Catalogue) -> Result<(Plan, Vec<Row>), Error> {
    let Some(first) = folders.first() else {
        return Err(Error::Suite {
            place: "bench merge".to_owned(),
            what: "no folder is given: name those that `bench --shard` wrote".to_owned(),
        });
    };
    let sweep = ShardOf::read(first)?;
    let plan = Plan::new(sweep.suite()?, catalogue)?;
    let mut by_shard: BTreeMap<u64, &PathBuf> = BTreeMap::new();
    let mut rows: BTreeMap<u64, Row> = BTreeMap::new();
    for folder in folders {
        let refused = |what: String| Error::File {
            path: folder.clone(),
            what,
        };
        let part = ShardOf::read(folder)?;
        let same = ShardOf {
            shard: Shard {
                number: sweep.shard.number,
                ..part.shard
            },
            ..part.clone()
        };
        if same != sweep {
            return Err(refused(format!(
                "{}: leave it out",
                differs(&part, &sweep, first)
            )));
        }
        if let Some(other) = by_shard.insert(part.shard.number, folder) {
            let what = format!(
                "it has shard {}, and so has {}: leave one out",
                part.shard,
                other.display()
            );
            return Err(refused(what));
        }
        let (_lock, found) = Results::open(folder)?;
        for row in found {
            let Some(run) = plan.find(&row) else {
                return Err(refused(format!(
                    "{} is no run of this sweep: remove it from results.jsonl",
                    name_of(&row)
                )));
            };
            if !part.shard.has(&run) {
                let what = format!(
                    "{} does not belong to shard {}: remove it from results.jsonl",
                    name_of(&row),
                    part.shard
                );
                return Err(refused(what));
            }
            rows.insert(run.number(), row);
        }
    }
    let missing: Vec<String> = (1..=sweep.shard.of)
        .filter(|number| !by_shard.contains_key(number))
        .map(|number| {
            Shard {
                number,
                of: sweep.shard.of,
            }
            .to_string()
        })
        .collect();
    if !missing.is_empty() {
        return Err(Error::Suite {
            place: sweep.suite.clone(),
            what: format!("missing shards: {}; name their folders, too", missing.join(", ")),
        });
    }
    for (number, folder) in by_shard {
        let shard = Shard {
            number,
            of: sweep.shard.of,
        };
        let lacks = |run: &Planned<'_>| shard.has(run) && !rows.contains_key(&run.number());
        let mut gaps = plan.runs().filter(lacks);
        if let Some(run) = gaps.next() {
            let (engine, problem) = (&run.cell.engine_label, &run.cell.problem_label);
            let more = match gaps.count() {
                0 => String::new(),
                more => format!(" and {more} others"),
            };
            return Err(Error::File {
                path: folder.clone(),
                what: format!(
                    "shard {shard} lacks {engine} on {problem}, seed {}{more}: run the same command again to finish it",
                    run.seed
                ),
            });
        }
    }
    let in_order: Vec<Row> = plan.runs().filter_map(|run| rows.remove(&run.number())).collect();
    Ok((plan, in_order))
}

fn name_of(row: &Row) -> String {
    format!(
        "{} on {}, seed {}",
        row.engine_label, row.problem_label, row.report.spec.seed
    )
}

/// The difference that makes two shards parts of different sweeps.
fn differs(part: &ShardOf, sweep: &ShardOf, first: &Path) -> String {
    let first = first.display();
    if part.shard.of != sweep.shard.of {
        format!("it is shard {}, and {first} is shard {}", part.shard, sweep.shard)
    } else if part.suite != sweep.suite || part.text != sweep.text {
        format!(
            "its suite is `{}`, with another text than that of {first}",
            part.suite
        )
    } else if part.version != sweep.version {
        format!(
            "it was made by version {}, and {first} by {}",
            part.version, sweep.version
        )
    } else {
        format!("its seeds, engines, problems or budgets are not those of {first}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shard_is_read_and_shown() {
        let shard: Shard = "3/16".parse().unwrap();
        assert_eq!((shard.to_string(), shard.count()), ("3/16".to_owned(), 16));
        for text in ["0/4", "5/4", "1/0", "3", "a/b", "-1/4", ""] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}

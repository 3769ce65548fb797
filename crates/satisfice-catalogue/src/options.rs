//! The options of a run that users set by name: flags of the command line, keys of suites.

use crate::quantity;
use crate::spec::RunSpec;

/// An option of a run. Adding one means adding a field to [`RunSpec`] and a row here.
pub struct RunOption {
    /// Its name: `--NAME` on the command line, `NAME = VALUE` in a suite.
    pub name: &'static str,
    /// The kind of its value, for help: `TIME`, `N`.
    pub value: &'static str,
    /// A summary, for help.
    pub help: &'static str,
    /// Whether it is an option of every search, or of `run` and suites only.
    pub every_search: bool,
    /// Enters a value.
    set: fn(&mut RunSpec, &str) -> Result<(), String>,
    /// Takes the value from another specification.
    copy: fn(&mut RunSpec, &RunSpec),
    /// The value as JSON, where it is not what a run has by default.
    shown: fn(&RunSpec) -> Option<String>,
}

impl RunOption {
    /// Enters a value, as a user writes it.
    ///
    /// # Errors
    /// What would be allowed instead.
    pub fn set(&self, spec: &mut RunSpec, text: &str) -> Result<(), String> {
        (self.set)(spec, text)
    }

    /// Takes the value from another specification.
    pub fn copy(&self, to: &mut RunSpec, from: &RunSpec) {
        (self.copy)(to, from);
    }

    /// The value, for people, where it is not what a run has by default.
    #[must_use]
    pub fn shown(&self, spec: &RunSpec) -> Option<String> {
        (self.shown)(spec)
    }
}

impl core::fmt::Debug for RunOption {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.name)
    }
}

/// A row of the table: the parser of [`quantity`], and the field.
macro_rules! option {
    ($name:literal, $value:literal, $every:literal, $parse:ident => $($field:ident).+, $help:literal) => {
        RunOption {
            name: $name,
            value: $value,
            help: $help,
            every_search: $every,
            set: |spec, text| {
                spec.$($field).+ = quantity::$parse(text)?.into();
                Ok(())
            },
            copy: |to, from| to.$($field).+ = from.$($field).+,
            shown: |spec| {
                let value = &spec.$($field).+;
                (*value != RunSpec::new("").$($field).+).then(|| serde_json::json!(value).to_string())
            },
        }
    };
}

/// All of them, in the order of the help.
pub static OPTIONS: &[RunOption] = &[
    option!("time", "TIME", true, time => budget.time,
        "Limit the wall time of a slice, with its unit: 100us, 100ms, 1.5s, 3min, 1h [default: 1s for an engine, unless \
         --evaluations or --patience is given]"),
    option!("evaluations", "N", true, count => budget.evaluations,
        "Limit the evaluations of a slice, such as 5000 or 1e6; repeated solutions count as well"),
    option!("hits", "N", true, count => budget.hits, "Stop at this number of distinct hits"),
    option!("patience", "N", true, count => budget.patience,
        "Stop after this number of evaluations in succession without a new hit"),
    option!("seed", "N", true, seed => seed, "Set the seed of the random numbers, 0 to 2^64 - 1 [default: 0]"),
    option!("probes", "SHARE", true, share => probes,
        "Spend this share of the evaluations, 0 to 0.5, on uniform probes, from which the number of hits not seen is estimated \
         [default: the engine's own, which is 0 for most]"),
    option!("slices", "K", false, count => budget.slices,
        "Run this number of time slices, each with the whole budget and warm from the hits of the previous one; 1 for programs \
         [default: 1]"),
    option!("islands", "N", false, islands => islands,
        "Run this number of engines side by side, each with its share of the budget, which share their hits: for a fitness so \
         cheap that one engine cannot keep several threads busy. The number of islands changes the result; the number of \
         threads does not [default: 1]"),
    option!("parallel", "N", false, parallel => budget.parallel,
        "Let the engine propose at least this number of points at a time, so that as many threads or workers have something to \
         evaluate. Engines with batches of their own (walk, descent, the swarms and others) do not follow it; a note on stderr then says so. \
         It changes the result, like a seed; the number of threads does not [default: 1, or the number of workers \
         unless --ordered is given]"),
];

/// The option with this name.
#[must_use]
pub fn find(name: &str) -> Option<&'static RunOption> {
    OPTIONS.iter().find(|option| option.name == name)
}

//! The command line: subcommands, options, help.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand, ValueHint};
use satisfice::{Budget, Cancel};
use satisfice_catalogue::{Request, Saved};

pub(crate) use crate::collide::arguments::CollideArguments;
use crate::quantity;

/// The engine where none is named.
pub(crate) const DEFAULT_ENGINE: &str = "portfolio";
/// The time a search has where neither a time nor a number of evaluations is given.
const DEFAULT_TIME: Duration = Duration::from_secs(1);

/// Parses the command line.
pub(crate) fn parse() -> Result<Command, clap::Error> {
    Satisfice::try_parse().map(|satisfice| satisfice.command)
}

/// Find as many good-enough answers as you can before the deadline, and say honestly how complete the answer is.
#[derive(Debug, Parser)]
#[command(
    name = "satisfice",
    version,
    propagate_version = true,
    after_help = "\
Examples:
  satisfice list                                           what there is
  satisfice run teapots --time 100ms                       what the default engine finds in a tenth of a second
  satisfice run queens --set n=6 --evaluations 1e5 --json report.json
  satisfice verify report.json                             is that report true?
  satisfice collide a.obj b.ply --threshold 0.01           which vertices are closer than 0.01?
  satisfice bench mine.toml --seeds 0..16 --out results    engines compared on problems, over seeds

Exit codes: 0 at least one hit (or nothing to complain of), 1 no hit (or a report that is false), 2 an error."
)]
pub(crate) struct Satisfice {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    List(ListArguments),
    Run(RunArguments),
    Collide(CollideArguments),
    Bench(BenchArguments),
    Verify(VerifyArguments),
    Completions(CompletionsArguments),
}

/// List every engine and problem with its parameters, their defaults and ranges.
#[derive(Debug, Args)]
pub(crate) struct ListArguments {
    /// As JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Search a problem of the catalogue for all solutions with F < delta.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  satisfice run teapots
      A second of the default engine on two colliding teapots.
  satisfice run queens --set n=6 --engine random --evaluations 200000 --json -
      A report as JSON on stdout. Under a budget of evaluations the same command gives the same report, but for times, on any
      machine and any number of threads.
  satisfice run rastrigin --set dimension=2 --engine latest-hit-qpso --engine-set particles=60 --time 2s --plot hits.svg
      Parameters of the problem and of the engine, and the curve of hits against evaluations and time.
  satisfice run shell --time 50ms --slices 10 --threads 0
      Ten time slices of 50 ms, each warm from the hits of the one before, on all cores.
  satisfice run falsification --islands 8 --threads 0 --time 5s
      Eight engines that share their hits, on all cores.
  satisfice run arm --time 1h --checkpoint arm.json
  satisfice run arm --resume arm.json --checkpoint arm.json
      A long run that Ctrl-C or a power cut does not lose: resumed, it finds what it would have found without interruption.

Ctrl-C ends the search and keeps what it found.")]
pub(crate) struct RunArguments {
    /// Name of the problem; `satisfice list` shows them all.
    #[arg(value_name = "PROBLEM")]
    pub(crate) problem: String,

    /// Set a parameter of the problem; may be repeated.
    #[arg(long, value_name = "NAME=VALUE", value_parser = quantity::setting)]
    pub(crate) set: Vec<(String, String)>,

    /// Name of the engine; `satisfice list` shows them all [default: portfolio].
    #[arg(long, value_name = "NAME")]
    pub(crate) engine: Option<String>,

    #[command(flatten)]
    pub(crate) search: SearchArguments,

    /// Number of time slices, each with the whole budget and warm from the hits of the one before [default: 1].
    #[arg(long, value_name = "K", value_parser = quantity::count, allow_hyphen_values = true)]
    pub(crate) slices: Option<u64>,

    /// Engines side by side, each with its share of the budget, which share their hits: for a fitness so cheap that one engine
    /// cannot keep several threads busy. The number of islands is part of the search; that of threads is not.
    #[arg(long, value_name = "N", default_value = "1", value_parser = quantity::islands, allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["checkpoint", "resume"])]
    pub(crate) islands: usize,

    /// Keep a checkpoint of the run in this file: at the beginning, every few seconds, at Ctrl-C and at the end.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) checkpoint: Option<PathBuf>,

    /// Go on with the run that this checkpoint is of. Arguments that are not given are taken from it; others have to agree.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) resume: Option<PathBuf>,

    /// Write the report as JSON; `-` is stdout and replaces the summary.
    #[arg(long, value_name = "FILE|-", value_hint = ValueHint::FilePath)]
    pub(crate) json: Option<PathBuf>,

    /// Draw hits against evaluations and time, as .svg or .png.
    #[arg(long, value_name = "FILE.svg|.png", value_hint = ValueHint::FilePath)]
    pub(crate) plot: Option<PathBuf>,
}

/// What every search takes.
#[derive(Debug, Args)]
pub(crate) struct SearchArguments {
    /// Set a parameter of the engine; may be repeated.
    #[arg(long, value_name = "NAME=VALUE", value_parser = quantity::setting)]
    engine_set: Vec<(String, String)>,

    /// Wall time, with its unit: 100us, 100ms, 1.5s, 3min, 1h [default: 1s for an engine, unless --evaluations is given].
    #[arg(long, value_name = "TIME", value_parser = quantity::time, allow_hyphen_values = true)]
    time: Option<Duration>,

    /// Number of evaluations, such as 5000 or 1e6; repeated solutions count, too.
    #[arg(long, value_name = "N", value_parser = quantity::count, allow_hyphen_values = true)]
    evaluations: Option<u64>,

    /// Stop at this number of distinct hits.
    #[arg(long, value_name = "N", value_parser = quantity::count, allow_hyphen_values = true)]
    hits: Option<u64>,

    /// Seed of the random numbers, 0 to 2^64 - 1 [default: 0].
    #[arg(long, value_name = "N", value_parser = quantity::seed, allow_hyphen_values = true)]
    seed: Option<u64>,

    /// Share of the evaluations spent on uniform probes, 0 to 0.5, from which the hits not seen are estimated [default: the
    /// engine's own, which is 0 for most].
    #[arg(long, value_name = "SHARE", value_parser = quantity::share, allow_hyphen_values = true)]
    probes: Option<f64>,

    /// Threads that evaluate; 0 takes all cores.
    #[arg(long, value_name = "T", default_value = "1", value_parser = quantity::threads, allow_hyphen_values = true)]
    threads: usize,
}

impl SearchArguments {
    /// The request, of one slice, that `cancel` ends.
    pub(crate) fn request(&self, engine: &str, cancel: &Cancel) -> anyhow::Result<Request> {
        let time = match (self.time, self.evaluations) {
            (None, None) => Some(DEFAULT_TIME),
            (time, _) => time,
        };
        let budget = Budget {
            time,
            evaluations: self.evaluations,
            hits: self.hits,
            ..Budget::until(cancel)
        };
        let mut request = Request::new(engine, budget).seed(self.seed.unwrap_or_default());
        request.engine_settings.clone_from(&self.engine_set);
        request.threads = self.threads;
        request.probes = self.probes;
        // What is wrong with the engine is said before anything is made.
        let settings = self
            .engine_set
            .iter()
            .map(|(name, value)| (name.as_str(), value.as_str()));
        satisfice::engine::find(engine)?.configure::<f64>(settings)?;
        Ok(request)
    }

    /// What was asked for when a run was saved, with what is given here in its place.
    pub(crate) fn over(&self, saved: &mut Saved) {
        if !self.engine_set.is_empty() {
            saved.engine_settings.clone_from(&self.engine_set);
        }
        saved.seed = self.seed.unwrap_or(saved.seed);
        saved.probes = self.probes.or(saved.probes);
        saved.budget.time = self.time.or(saved.budget.time);
        saved.budget.evaluations = self.evaluations.or(saved.budget.evaluations);
        saved.budget.hits = self.hits.or(saved.budget.hits);
    }

    /// Threads to evaluate on.
    pub(crate) fn threads(&self) -> usize {
        self.threads
    }

    /// The options given that only an engine makes use of.
    pub(crate) fn for_an_engine(&self) -> Vec<&'static str> {
        [
            ("--engine-set", !self.engine_set.is_empty()),
            ("--evaluations", self.evaluations.is_some()),
            ("--seed", self.seed.is_some()),
            ("--probes", self.probes.is_some()),
        ]
        .into_iter()
        .filter_map(|(name, given)| given.then_some(name))
        .collect()
    }

    /// The limits that an exact method makes use of, too: time and hits.
    pub(crate) fn limits(&self) -> (Option<Duration>, Option<u64>) {
        (self.time, self.hits)
    }
}

/// Compare engines on problems over seeds: a suite that comes with the program, or a TOML file.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  satisfice bench experiment-one-smoke --out results
      The suite of this name, in the folder results: report.html and its figures, results.jsonl (a line a run), summary.json, and
      ioh, which IOHanalyzer reads.
  satisfice bench mine.toml --seeds 0..16 --engines portfolio,random
      Two engines and 16 seeds in the place of those of the file.

A suite is such a file; a list of values is swept over:
  seeds = \"0..8\"
  [[part]]
  engines = [\"random\", { name = \"latest-hit-qpso\", particles = [10, 30] }]
  problems = [{ name = \"rastrigin\", dimension = [2, 3] }, \"queens\"]
  evaluations = 100_000            # and / or time = \"100ms\", hits, slices, probes
  at-evaluations = [1000, 10_000]  # and / or at-times = [\"10ms\"]: where hits are noted
  against = \"random\"             # with whom the others are compared, seed by seed

Runs limited by evaluations share the cores; runs limited by a time come last, one at a time. The same command goes on where
it was interrupted: runs that are in results.jsonl are not run again. Ctrl-C keeps the runs that have ended.")]
pub(crate) struct BenchArguments {
    /// Name of a suite, or a TOML file; a name that is none gets a list of them.
    #[arg(value_name = "SUITE|FILE.toml", value_hint = ValueHint::FilePath)]
    pub(crate) suite: String,

    /// Only these engines, separated by commas.
    #[arg(long, value_name = "NAME,NAME", value_delimiter = ',')]
    pub(crate) engines: Vec<String>,

    /// Seeds A to B - 1 in the place of those of the suite.
    #[arg(long, value_name = "A..B", value_parser = satisfice_bench::sweep::seeds, allow_hyphen_values = true)]
    pub(crate) seeds: Option<std::ops::Range<u64>>,

    /// Folder for the results [default: bench-SUITE].
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) out: Option<PathBuf>,

    /// How many runs limited by evaluations go on at a time; 0 for as many as there are cores.
    #[arg(long, value_name = "N", default_value = "0", value_parser = quantity::threads, allow_hyphen_values = true)]
    pub(crate) jobs: usize,
}

/// Evaluate every solution of a report anew and check its counts; says what does not fit.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  satisfice run queens --json report.json && satisfice verify report.json

Exit code 0: the report is true; 1: it is false; 2: it cannot be read.")]
pub(crate) struct VerifyArguments {
    /// A report that `run --json` or `collide --json` has written; `-` is stdin.
    #[arg(value_name = "REPORT.json", value_hint = ValueHint::FilePath)]
    pub(crate) report: PathBuf,
}

/// Print a script that completes this command in a shell.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  satisfice completions bash > ~/.local/share/bash-completion/completions/satisfice")]
pub(crate) struct CompletionsArguments {
    /// The shell.
    pub(crate) shell: clap_complete::Shell,
}

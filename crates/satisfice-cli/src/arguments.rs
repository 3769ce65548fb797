//! The command line: subcommands, options, help.

use std::path::PathBuf;
use std::time::Duration;

use anyhow::bail;
use clap::{Arg, ArgMatches, Args, FromArgMatches, Parser, Subcommand, ValueHint};
use satisfice_catalogue::options::OPTIONS;
use satisfice_catalogue::{RunOption, RunSpec};

pub(crate) use crate::collide::arguments::CollideArguments;
pub(crate) use crate::program::arguments::ProgramArguments;
use crate::quantity;
use crate::reference::Patience;

/// The default engine.
pub(crate) const DEFAULT_ENGINE: &str = "portfolio";
/// The wall time of a search without `--time` and `--evaluations`.
pub(crate) const DEFAULT_TIME: Duration = Duration::from_secs(1);

/// Parses the command line, the name of the program included.
pub(crate) fn parse(arguments: &[std::ffi::OsString]) -> Result<Subcommands, clap::Error> {
    let asks_for_help = |word: &std::ffi::OsString| word == "--help" || word == "-h";
    let arguments = match arguments {
        // The subcommand `help` takes names only.
        [program, help, rest @ ..] if help == "help" && rest.iter().all(asks_for_help) => {
            vec![program.clone(), "--help".into()]
        }
        others => others.to_vec(),
    };
    Satisfice::try_parse_from(arguments).map(|satisfice| satisfice.command)
}

/// Find as many good-enough answers as possible before a deadline, and report how complete they are.
#[derive(Debug, Parser)]
#[command(
    name = "satisfice",
    version,
    propagate_version = true,
    after_help = "\
Examples:
  satisfice list                                           all engines and problems
  satisfice run teapots --time 100ms                       a tenth of a second of search
  satisfice run queens --set n=6 --evaluations 1e5 --json report.json
  satisfice verify report.json                             check that report
  satisfice collide a.obj b.ply --threshold 0.01           all pairs of vertices closer than 0.01
  satisfice bench mine.toml --seeds 0..16 --out results    compare engines on problems, over seeds

Exit codes: 0 at least one hit (or success), 1 no hit until then (or a report that is wrong), 2 an error."
)]
pub(crate) struct Satisfice {
    #[command(subcommand)]
    command: Subcommands,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Subcommands {
    List(ListArguments),
    Run(RunArguments),
    Collide(CollideArguments),
    Bench(BenchArguments),
    Verify(VerifyArguments),
    Completions(CompletionsArguments),
}

/// List every engine and problem with its parameters, their defaults and ranges.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  satisfice list
  satisfice list queens portfolio
      Only this problem and this engine.")]
pub(crate) struct ListArguments {
    /// Names of engines and problems: list only these.
    #[arg(value_name = "NAME")]
    pub(crate) names: Vec<String>,

    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Search a problem of the catalogue, or the values of a program, for all solutions with F < delta.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  satisfice run teapots
      Run the default engine for a second on two colliding teapots.
  satisfice run queens --set n=6 --engine random --evaluations 200000 --json -
      Write a report as JSON to stdout. Under a budget of evaluations the same command gives the same report, apart from times, on any number of threads; on another platform the last bit of `exp` or `sin` may change it.
  satisfice run rastrigin --set dimension=2 --engine latest-hit-qpso \\
          --engine-set particles=60 --time 2s --plot hits.svg
      Set parameters of the problem and of the engine, and draw hits against evaluations and time.
  satisfice run shell --time 50ms --slices 10 --threads 0
      Run ten time slices of 50 ms, each warm from the hits of the previous one, on all cores.
  satisfice run falsification --islands 8 --threads 0 --time 5s
      Run eight engines that share their hits, on all cores.
  satisfice run arm --time 1h --checkpoint arm.json
  satisfice run --resume arm.json --checkpoint arm.json
      Run for an hour without losing hits to Ctrl-C or a power cut: a resumed run finds what an uninterrupted one finds.
  satisfice run --program './simulate {x}' --space space.toml \\
          --threshold 0.1 --evaluations 500 --workers 4
      Start ./simulate with the coordinates as arguments, four at a time; the last line that it writes is the value.
  satisfice run --worker './simulator --serve' --space space.toml \\
          --threshold 0.1 --time 8h --workers 4 --timeout 10min \\
          --json night.json
      Start the simulator four times. It reads a line {\"ticket\": 7, \"x\": [0.5, 2.0]} and answers {\"ticket\": 7, \"value\": 0.3}, or {\"ticket\": 7, \"error\": \"why not\"}, line by line. space.toml has a table [[axis]] for each coordinate, with lower and upper (and integer, logarithmic or periodic = true), or categories = [\"a\", \"b\"], or permutation = 5 for an order of five, and a name; separation = 0.1 makes nearer hits one.
      --program gets a whole number as 15, a category by its name, and an order as its places: {order} by itself is an argument for each of them, --x={order} is --x=1,0,2, and with --shell there are blanks between them. --worker gets numbers: 15.0, the number of a category from 0, and the places of an order one by one.
      --set, --slices, --threads, --reference, --plot and --page are for problems of the catalogue only. There are no checkpoints of programs: the report is written at the end, also after Ctrl-C or SIGTERM, which keep what was found.

Ctrl-C ends the search and keeps its hits.")]
pub(crate) struct RunArguments {
    /// Name of the problem; `satisfice list` shows them all. Left out with --program and --worker; --resume knows it.
    #[arg(value_name = "PROBLEM", conflicts_with_all = ["program", "worker"])]
    pub(crate) problem: Option<String>,

    #[command(flatten)]
    pub(crate) program: ProgramArguments,

    /// Set a parameter of the problem; may be repeated. Not for programs.
    #[arg(long, value_name = "NAME=VALUE", value_parser = quantity::setting)]
    pub(crate) set: Vec<(String, String)>,

    /// Name of the engine; `satisfice list` shows them all [default: portfolio].
    #[arg(long, value_name = "NAME")]
    pub(crate) engine: Option<String>,

    #[command(flatten)]
    pub(crate) search: SearchArguments,

    #[command(flatten)]
    pub(crate) slices: Options<false>,

    /// Keep a checkpoint of the run in this file: at the beginning, after a second, then every `--checkpoint-every`, at Ctrl-C
    /// and at the end. If a run is killed or out of memory, only a checkpoint has its hits. Neither this nor --resume is for `--program` and
    /// `--worker`: give --json, which they write at the end, also after Ctrl-C or SIGTERM.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) checkpoint: Option<PathBuf>,

    /// Time between two checkpoints; longer if a checkpoint takes more than a tenth of it.
    #[arg(long, value_name = "TIME", default_value = "5s", value_parser = quantity::time, requires = "checkpoint")]
    pub(crate) checkpoint_every: Duration,

    /// Continue the run of this checkpoint. Arguments that are not given are taken from it; others must agree with it.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) resume: Option<PathBuf>,

    /// Write the report as JSON; `-` is stdout and replaces the summary.
    #[arg(long, value_name = "FILE|-", value_hint = ValueHint::FilePath)]
    pub(crate) json: Option<PathBuf>,

    /// Draw hits against evaluations and time, as .svg or .png. Not for programs.
    #[arg(long, value_name = "FILE.svg|.png", value_hint = ValueHint::FilePath)]
    pub(crate) plot: Option<PathBuf>,

    /// Write a page to look into: hits over any axes, how they came in, a table; one file that works offline. Not for programs.
    #[arg(long, value_name = "FILE.html", value_hint = ValueHint::FilePath)]
    pub(crate) page: Option<PathBuf>,
}

/// Refuses two values for one parameter: which of them is meant cannot be known.
pub(crate) fn check_once(option: &str, settings: &[(String, String)]) -> anyhow::Result<()> {
    for (place, (name, value)) in settings.iter().enumerate() {
        if let Some((_, first)) = settings[..place].iter().find(|(known, _)| known == name) {
            bail!("{option} {name}={value}: {name} is set to {first} before: set it once");
        }
    }
    Ok(())
}

/// Options of every search.
#[derive(Debug, Args)]
pub(crate) struct SearchArguments {
    /// Set a parameter of the engine; may be repeated.
    #[arg(long, value_name = "NAME=VALUE", value_parser = quantity::setting)]
    engine_set: Vec<(String, String)>,

    #[command(flatten)]
    options: Options<true>,

    /// Threads that evaluate; 0 uses all cores.
    #[arg(long, value_name = "T", default_value = "1", value_parser = quantity::threads, allow_hyphen_values = true)]
    threads: usize,

    /// Count all hits for the recall, even if that takes longer than the search. Without it, it may take as long as the search,
    /// or 2 s if longer.
    #[arg(long)]
    pub(crate) reference: bool,
}

impl SearchArguments {
    /// A run of one slice by this engine, checked.
    pub(crate) fn spec(&self, engine: &str) -> anyhow::Result<RunSpec> {
        self.check()?;
        let mut spec = RunSpec::new(engine);
        self.enter(&mut spec);
        if !self.is_limited() {
            spec.budget.time = Some(DEFAULT_TIME);
        }
        // A wrong engine or parameter is an error before any file is opened.
        satisfice::engine::find(engine)?;
        Ok(spec.complete()?)
    }

    /// Whether a limit is given that ends every slice; if not, there is one of [`DEFAULT_TIME`].
    pub(crate) fn is_limited(&self) -> bool {
        let names = ["time", "evaluations", "patience"];
        self.options
            .0
            .iter()
            .any(|(option, _)| names.contains(&option.name))
    }

    /// Refuses two values for one parameter of the engine.
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        check_once("--engine-set", &self.engine_set)
    }

    /// Enters what is given.
    pub(crate) fn enter(&self, spec: &mut RunSpec) {
        for (name, value) in &self.engine_set {
            spec.engine_parameters.set(name, value.as_str());
        }
        self.options.enter(spec);
        spec.threads = self.threads;
    }

    /// The number of threads that evaluate.
    pub(crate) fn threads(&self) -> usize {
        self.threads
    }

    /// The options given that only an engine uses.
    pub(crate) fn for_an_engine(&self) -> Vec<String> {
        let set = (!self.engine_set.is_empty()).then(|| "--engine-set".to_owned());
        let reference = self.reference.then(|| "--reference".to_owned());
        let names = self.options.0.iter().map(|(option, _)| option.name);
        let others = names.filter(|name| !["time", "hits"].contains(name));
        set.into_iter()
            .chain(reference)
            .chain(others.map(|name| format!("--{name}")))
            .collect()
    }

    /// How long the count of all hits may take after a search of so many seconds.
    pub(crate) fn patience(&self, seconds: f64) -> Patience {
        if self.reference {
            Patience::Unlimited
        } else {
            Patience::AsTheRun(Duration::try_from_secs_f64(seconds).unwrap_or_default())
        }
    }

    /// The limits that an exact method uses as well: time and hits.
    pub(crate) fn limits(&self) -> (Option<Duration>, Option<u64>) {
        let mut spec = RunSpec::new("");
        self.options.enter(&mut spec);
        (spec.budget.time, spec.budget.hits)
    }
}

/// The given options of a run: those of every search, or the others.
#[derive(Debug, Clone, Default)]
pub(crate) struct Options<const EVERY_SEARCH: bool>(Vec<(&'static RunOption, RunSpec)>);

impl<const EVERY_SEARCH: bool> Options<EVERY_SEARCH> {
    fn all() -> impl Iterator<Item = &'static RunOption> {
        OPTIONS
            .iter()
            .filter(|option| option.every_search == EVERY_SEARCH)
    }

    /// Enters what is given.
    pub(crate) fn enter(&self, spec: &mut RunSpec) {
        for (option, given) in &self.0 {
            option.copy(spec, given);
        }
    }
}

impl<const EVERY_SEARCH: bool> FromArgMatches for Options<EVERY_SEARCH> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let given = |option: &'static RunOption| {
            let spec = matches.get_one::<RunSpec>(option.name)?;
            Some((option, spec.clone()))
        };
        Ok(Self(Self::all().filter_map(given).collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl<const EVERY_SEARCH: bool> Args for Options<EVERY_SEARCH> {
    fn augment_args(command: clap::Command) -> clap::Command {
        Self::all().fold(command, |command, option| {
            let parse = |text: &str| {
                let mut spec = RunSpec::new("");
                option.set(&mut spec, text).map(|()| spec)
            };
            command.arg(
                Arg::new(option.name)
                    .long(option.name)
                    .value_name(option.value)
                    .help(option.help)
                    .allow_hyphen_values(true)
                    .value_parser(parse),
            )
        })
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        Self::augment_args(command)
    }
}

/// Compare engines on problems over seeds: a suite that comes with the program, or a TOML file.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  satisfice bench experiment-one-smoke --out results
      Run the suite of this name. The folder results gets report.html and its figures, compare.html to look into, results.jsonl (one line per run), summary.json, suite.toml (what was run), and ioh, which IOHanalyzer reads.
  satisfice bench mine.toml --seeds 0..16 --engines portfolio,random
      Run two engines and 16 seeds instead of those of the file.
  satisfice bench regret --seeds 0..2 --budgets 50,200 --out regret
      Compare the default engine with the best of all others at two of the suite's budgets; regret/regret.md has the tables.

A suite is a file such as this; all values of a list are run:
  seeds = \"0..8\"                   # a part may have its own, and a name
  [[part]]
  engines = [\"random\", { name = \"latest-hit-qpso\", particles = [10, 30] }]
  problems = [{ name = \"rastrigin\", dimension = [2, 3] }, \"queens\"]
  evaluations = 100_000            # and / or time = \"100ms\", hits, patience, slices, probes, ...
  at-evaluations = [1000, 10_000]  # and / or at-times = [\"10ms\"]: where hits are counted
  against = \"random\"               # the engine that the others are compared with, seed by seed
  beside = { queens = \"backtracking: all 92\" }   # printed beside the figures of a problem

Runs limited by evaluations share the cores; runs limited by a time come last, one at a time. The same command continues an interrupted sweep: runs that are in results.jsonl are not run again. Ctrl-C keeps the runs that have ended.

Several machines share a sweep, each with a folder of its own:
  satisfice bench mine.toml --shard 1/4 --out part-1       and so on to 4/4, in any order
  satisfice bench merge part-1 part-2 part-3 part-4 --out results")]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct BenchArguments {
    /// Put shards together.
    #[command(subcommand)]
    pub(crate) merge: Option<BenchSubcommands>,

    /// Name of a suite, or a TOML file; an unknown name prints a list of the suites.
    #[arg(value_name = "SUITE|FILE.toml", value_hint = ValueHint::FilePath, required = true)]
    pub(crate) suite: Option<String>,

    /// Run this shard of the runs only: 3/16 is the third of sixteen. `bench merge` joins the shards.
    #[arg(long, value_name = "NUMBER/COUNT")]
    pub(crate) shard: Option<satisfice_bench::sweep::Shard>,

    /// Run only these engines, separated by commas.
    #[arg(long, value_name = "NAME,NAME", value_delimiter = ',')]
    pub(crate) engines: Vec<String>,

    /// Run only these problems of the suite, separated by commas.
    #[arg(long, value_name = "NAME,NAME", value_delimiter = ',')]
    pub(crate) problems: Vec<String>,

    /// Run only these budgets of the suite, evaluations or times, such as 200,1000,10ms.
    #[arg(long, value_name = "BUDGET,BUDGET", value_delimiter = ',')]
    pub(crate) budgets: Vec<String>,

    /// Use the seeds A to B - 1 instead of those of the suite.
    #[arg(long, value_name = "A..B", value_parser = satisfice_bench::sweep::seeds, allow_hyphen_values = true)]
    pub(crate) seeds: Option<std::ops::Range<u64>>,

    /// Folder for the results [default: bench- and the name of the suite, and of the shard, such as bench-mine-1-of-4].
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) out: Option<PathBuf>,

    /// Number of runs limited by evaluations that run at a time; 0 for one per core.
    #[arg(long, value_name = "N", default_value = "0", value_parser = quantity::threads, allow_hyphen_values = true)]
    pub(crate) jobs: usize,
}

#[derive(Debug, Subcommand)]
pub(crate) enum BenchSubcommands {
    Merge(MergeArguments),
}

/// Put the shards of a sweep together: the results are those of a sweep on one machine, except for times. A run that is
/// missing or present twice is an error that names it.
#[derive(Debug, Args)]
pub(crate) struct MergeArguments {
    /// The folders that `bench --shard` wrote, one for each shard.
    #[arg(value_name = "DIR", value_hint = ValueHint::DirPath, required = true)]
    pub(crate) folders: Vec<PathBuf>,

    /// Folder for the results [default: bench- and the name of the suite].
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) out: Option<PathBuf>,
}

/// Evaluate every solution of a report again, check its counts, and print every mismatch.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  satisfice run queens --json report.json && satisfice verify report.json

Exit code 0: the report is correct; 1: it is wrong; 2: it cannot be read.")]
pub(crate) struct VerifyArguments {
    /// A report that `run --json` or `collide --json` wrote; `-` is stdin.
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

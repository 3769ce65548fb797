//! Two ways to do the same, round by round in turn: what a machine shared with others does to one, it does to the other.
#![expect(clippy::disallowed_methods, reason = "a bench asks the time")]

use std::fmt::Write as _;
use std::hint::black_box;
use std::time::{Duration, Instant};

use satisfice::{Budget, SatisficingProblem, Search, Space, engine, from_fn};

use crate::loops::{latest_hit_loop, random_loop};
use crate::peers::{self, argmin_swarm, our_swarm};
use crate::problems::{Lattice, Slow, Wide};
use crate::{search, teapots};

const EVALUATIONS: usize = 20_000;

/// Nanoseconds an evaluation: the median of the rounds, and the least.
struct Cost {
    median: f64,
    least: f64,
}

impl Cost {
    fn of(mut rounds: Vec<f64>) -> Self {
        rounds.sort_by(f64::total_cmp);
        Self {
            median: rounds[rounds.len() / 2],
            least: rounds[0],
        }
    }
}

/// The table of ratios, as it is printed and written.
struct Table {
    rounds: usize,
    text: String,
}

impl Table {
    fn line(&mut self, line: &str) {
        println!("{line}");
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn begin(&mut self, heading: &str, ratio: &str) {
        self.line(&format!("\n## {heading}\n"));
        self.line(&format!(
            "| | ns an evaluation, median (least) | beside | ns an evaluation, median (least) | {ratio}, by medians (by least) |"
        ));
        self.line("|---|---|---|---|---|");
    }

    /// Measures both in turn and adds a row; the ratios are those of the medians and of the least times, ours to theirs where `we_cost`,
    /// theirs to ours where not.
    fn row(&mut self, evaluations: usize, [ours, theirs]: [(&str, &mut dyn FnMut()); 2], we_cost: bool) {
        let mut times = [Vec::new(), Vec::new()];
        let (our_name, our_run) = ours;
        let (their_name, their_run) = theirs;
        let mut runs = [our_run, their_run];
        for _ in 0..self.rounds {
            for (run, times) in runs.iter_mut().zip(&mut times) {
                let start = Instant::now();
                run();
                times.push(start.elapsed().as_nanos() as f64 / evaluations as f64);
            }
        }
        let [ours, theirs] = times.map(Cost::of);
        let ratio = |ours: f64, theirs: f64| {
            if we_cost { ours / theirs } else { theirs / ours }
        };
        self.line(&format!(
            "| {our_name} | {:.1} ({:.1}) | {their_name} | {:.1} ({:.1}) | {:.2} ({:.2}) |",
            ours.median,
            ours.least,
            theirs.median,
            theirs.least,
            ratio(ours.median, theirs.median),
            ratio(ours.least, theirs.least)
        ));
    }
}

/// Runs all comparisons; a full run takes about half a minute and writes its page, another is a test and does neither.
pub(crate) fn run(full: bool) {
    let mut table = Table {
        rounds: if full { 201 } else { 1 },
        text: String::new(),
    };
    table.line("# What an evaluation costs, beside what else could be done\n");
    let facts = satisfice_catalogue::machine()
        .into_iter()
        .fold(String::new(), |mut text, (what, value)| {
            let _ = write!(text, "{what}: {value}; ");
            text
        });
    table.line(facts.trim_end_matches([';', ' ']));
    table.line(
        "\nBoth columns of a row come from rounds in turn, one of each, in one process. Written by \
         `cargo bench --bench engine -- ratios`.",
    );

    table.begin(
        "The framework and a loop written by hand",
        "cost of the framework",
    );
    by_hand(&mut table, "a free fitness on a lattice", &Lattice::new());
    by_hand(&mut table, "the teapots", &teapots());

    table.begin(
        "Particle swarms in two variables, Himmelblau's function",
        "we are faster by",
    );
    for (name, batch) in [("`pso`", "1"), ("`pso`, a sweep at once", "40")] {
        table.row(
            peers::EVALUATIONS,
            [
                (name, &mut || {
                    black_box(our_swarm(batch));
                }),
                ("argmin's particle swarm", &mut || {
                    black_box(argmin_swarm());
                }),
            ],
            false,
        );
    }

    table.begin(
        "Solutions as `from_fn` makes them and as bytes, half of all points hits",
        "coordinates cost",
    );
    for axes in [2, 10, 30, 100] {
        let (located, bytes) = (Wide::located(axes), Wide::new(axes));
        table.row(
            EVALUATIONS,
            [
                (&format!("coordinates, {axes} axes"), &mut || many_hits(&located)),
                ("`Vec<u8>`", &mut || many_hits(&bytes)),
            ],
            true,
        );
    }

    table.begin(
        "One thread and two, a fitness of ten microseconds",
        "two are faster by",
    );
    table.rounds = if full { 25 } else { 1 };
    let slow = Slow::new();
    for (engine, settings) in [
        ("random", &[("batch", "64")][..]),
        ("qpso", &[("particles", "64"), ("batch", "64")]),
        ("portfolio", &[("batch", "64")]),
        ("portfolio", &[("batch", "256")]),
    ] {
        let mut name = format!("`{engine}`");
        for (parameter, value) in settings {
            let _ = write!(name, " {parameter}={value}");
        }
        let (one, two) = (format!("{name}, 1 thread"), format!("{name}, 2 threads"));
        table.row(
            4 * 4096,
            [
                (&two, &mut || on_threads(&slow, engine, settings, 2)),
                (&one, &mut || on_threads(&slow, engine, settings, 1)),
            ],
            false,
        );
    }
    overshoots(&mut table, full);
    if full {
        crate::page::save("engine.md", &table.text);
    }
}

/// Two engines and the loops that do the same; the hits are compared first.
fn by_hand<P>(table: &mut Table, on: &str, problem: &P)
where
    P: SatisficingProblem<Scalar = f64, Solution = (u32, u32)>,
{
    type Loop<P> = fn(&P, usize, u64) -> usize;
    let loops: [(&str, Loop<P>); 2] = [("latest-hit-qpso", latest_hit_loop), ("random", random_loop)];
    for (engine, by_hand) in loops {
        assert_eq!(
            search(problem, engine, EVALUATIONS, 7),
            by_hand(problem, EVALUATIONS, 7),
            "the loop does not do what the engine does"
        );
        table.row(
            EVALUATIONS,
            [
                (&format!("`{engine}`, {on}"), &mut || {
                    black_box(search(black_box(problem), engine, EVALUATIONS, 7));
                }),
                ("the loop", &mut || {
                    black_box(by_hand(black_box(problem), EVALUATIONS, 7));
                }),
            ],
            true,
        );
    }
}

/// By how much a limit of 100 ms is overrun: with a fitness of some nanoseconds, and with one of five milliseconds.
fn overshoots(table: &mut Table, full: bool) {
    let time = Duration::from_millis(if full { 100 } else { 10 });
    let runs = if full { 20 } else { 1 };
    table.line(&format!(
        "\n## How late a limit of {} ms is kept\n",
        time.as_millis()
    ));
    table.line("| | ms late, median of 20 runs | most |");
    table.line("|---|---|---|");
    let free = |x: &[f64]| 1.0 + x[0].abs();
    let slow = |x: &[f64]| {
        let end = Instant::now() + Duration::from_millis(5);
        while Instant::now() < end {}
        1.0 + x[0].abs()
    };
    type Fitness<'f> = &'f (dyn Fn(&[f64]) -> f64 + Sync);
    let fitness: [(&str, Fitness<'_>); 2] = [("some nanoseconds", &free), ("5 ms", &slow)];
    for ((cost, fitness), engine, batch, threads) in [
        (fitness[0], "latest-hit-qpso", "1", 1),
        (fitness[0], "random", "64", 1),
        (fitness[0], "portfolio", "32", 1),
        (fitness[1], "latest-hit-qpso", "1", 1),
        (fitness[1], "random", "64", 2),
    ] {
        let space = Space::cube(3, -1.0, 1.0).unwrap();
        let problem = from_fn(space, 0.5, fitness);
        let late = |seed: u64| {
            let engine = engine::find(engine)
                .unwrap()
                .configure([("batch", batch)])
                .unwrap();
            let mut search = Search::with(engine).seed(seed).threads(threads);
            let report = search.run(&problem, &Budget::time(time)).unwrap();
            report.overshoot.as_secs_f64() * 1e3
        };
        let mut late: Vec<f64> = (0..runs).map(late).collect();
        late.sort_by(f64::total_cmp);
        table.line(&format!(
            "| `{engine}`, a fitness of {cost}, threads: {threads} | {:.2} | {:.2} |",
            late[late.len() / 2],
            late[late.len() - 1]
        ));
    }
}

/// Uniform points, of which half become hits in the archive.
fn many_hits<P: SatisficingProblem<Scalar = f64>>(problem: &P) {
    let mut search = Search::named("random").unwrap().seed(7);
    let budget = Budget::evaluations(EVALUATIONS as u64);
    black_box(search.run(black_box(problem), &budget).unwrap().hit_count());
}

fn on_threads(slow: &Slow, name: &str, settings: &[(&str, &str)], threads: usize) {
    let engine = engine::find(name)
        .unwrap()
        .configure(settings.iter().copied())
        .unwrap();
    let mut search = Search::with(engine).seed(7).threads(threads);
    let budget = Budget::evaluations(4 * 4096);
    black_box(search.run(slow, &budget).unwrap().hit_count());
}

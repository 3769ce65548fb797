//! The CEC2013 niching suite: peak ratios within the competition's evaluations, by place, at 1e-4 and 1e-5; and a race against
//! the clock on Vincent's function.
//!
//! ```text
//! cargo run --release -p satisfice-problems --example cec2013 -- data=DIR [runs=50] [first=0] [problems=1-20] [engine=portfolio] [race=8]
//! ```
//!
//! `DIR` is the folder `data` of <https://github.com/mikeagn/CEC2013>; without it, problems 11 to 20 are left out. Each run searches
//! once, for delta = 1e-5, and what it found is scored at both accuracies; `first` is the first run's seed. The race has three
//! entrants on problems 7 and 9: the engine, `restarted-cma-es`, and a plain multistart of compass search with a hashed radius test,
//! which stops a search as soon as it is near a known maximum. Each runs until it has all maxima, or for 30 s.

#![expect(clippy::disallowed_methods, reason = "the race is against the clock")]

use std::error::Error;
use std::ops::Range;
use std::time::{Duration, Instant};

use hashbrown::HashMap;
use satisfice::{Budget, SatisficingProblem, Search, SearchRng};
use satisfice_problems::{Cec2013, Score, peak_ratio};

const ACCURACIES: [f64; 2] = [1e-4, 1e-5];
/// The engine for the many optima of a function of a few continuous coordinates, in the race beside the one named.
const SPECIALIST: &str = "restarted-cma-es";
/// A race ends here at the latest.
const LIMIT: Duration = Duration::from_secs(30);

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let known = ["data", "runs", "first", "problems", "engine", "race"];
    for argument in &arguments {
        let name = argument.split('=').next().unwrap_or_default();
        if !argument.contains('=') || !known.contains(&name) {
            return Err(format!(
                "`{argument}`: write NAME=VALUE with a NAME of {}",
                known.join(", ")
            )
            .into());
        }
    }
    let value = |name: &str, default: &str| {
        let prefix = format!("{name}=");
        let found = arguments
            .iter()
            .find_map(|argument| argument.strip_prefix(&prefix));
        found.unwrap_or(default).to_owned()
    };
    let quick = std::env::var_os("SATISFICE_QUICK").is_some();
    let data = value("data", "");
    let runs: u64 = value("runs", if quick { "2" } else { "50" }).parse()?;
    let races: u64 = value("race", if quick { "1" } else { "8" }).parse()?;
    let first: u64 = value("first", "0").parse()?;
    let engine = value("engine", "portfolio");
    let problems = range(&value("problems", if data.is_empty() { "1-10" } else { "1-20" }))?;
    if runs == 0 {
        return Err("`runs=0`: at least one run".into());
    }
    let seeds = first..first.saturating_add(runs);

    println!(
        "engine {engine}, seeds {first} to {}, delta 1e-5\n",
        seeds.end - 1
    );
    println!(
        "| problem | optima | evaluations | peak ratio 1e-4 | 1e-5 | submitted | last new one at | seconds a run |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let mut sums = [0.0; 2];
    for &number in &problems {
        let row = row(
            &Cec2013::new(number, ACCURACIES[1], &data)?,
            number,
            &seeds,
            &engine,
        )?;
        for (sum, ratio) in sums.iter_mut().zip(row) {
            *sum += ratio;
        }
    }
    let means = sums.map(|sum| sum / problems.len() as f64);
    println!(
        "\nmean of {} problems: {:.4} at 1e-4, {:.4} at 1e-5 (of all 20, NMMSO has .8255, RS-CMSA-ESII .9081)",
        problems.len(),
        means[0],
        means[1]
    );
    if races > 0 {
        let mut engines = vec![engine.as_str(), SPECIALIST];
        engines.dedup();
        println!("\nseconds until all maxima are found, medians of {races} seeds\n");
        print!("| problem | maxima | multistart of compass search |");
        for engine in &engines {
            print!(" {engine} | times as fast |");
        }
        println!("\n|---|---|---|{}", "---|---|".repeat(engines.len()));
        for number in [7, 9] {
            race(
                &Cec2013::new(number, ACCURACIES[0], "")?,
                number,
                first..first.saturating_add(races),
                &engines,
            )?;
        }
    }
    Ok(())
}

/// `1-10`, or `7,9`.
fn range(text: &str) -> Result<Vec<usize>, Box<dyn Error>> {
    if let Some((first, last)) = text.split_once('-') {
        return Ok((first.parse()?..=last.parse()?).collect());
    }
    text.split(',').map(|word| Ok(word.parse()?)).collect()
}

/// Runs one problem, prints its row and returns its peak ratios.
fn row(
    problem: &Cec2013,
    number: usize,
    seeds: &Range<u64>,
    engine: &str,
) -> Result<[f64; 2], Box<dyn Error>> {
    let start = Instant::now();
    let mut scores: [Vec<Score>; 2] = [Vec::new(), Vec::new()];
    let (mut submitted, mut last) = (0, 0);
    let runs = seeds.end - seeds.start;
    for seed in seeds.clone() {
        let mut search = Search::named(engine)?.seed(seed);
        let report = search.run(problem, &Budget::evaluations(problem.max_evaluations()))?;
        let points: Vec<_> = report
            .hits()
            .map(|hit| hit.solution.coordinates.clone())
            .collect();
        submitted += points.len();
        last += report.hits().map(|hit| hit.evaluation).max().unwrap_or(0);
        for (scores, accuracy) in scores.iter_mut().zip(ACCURACIES) {
            scores.push(problem.score(&points, accuracy));
        }
    }
    let ratios = [peak_ratio(&scores[0]), peak_ratio(&scores[1])];
    println!(
        "| {number} | {} | {} | {:.3} | {:.3} | {:.1} | {} | {:.2} |",
        problem.optima().len(),
        problem.max_evaluations(),
        ratios[0],
        ratios[1],
        submitted as f64 / runs as f64,
        last / runs,
        start.elapsed().as_secs_f64() / runs as f64
    );
    Ok(ratios)
}

/// Lets the engines race against the multistart and prints a row; who starts takes turns.
fn race(problem: &Cec2013, number: usize, seeds: Range<u64>, engines: &[&str]) -> Result<(), Box<dyn Error>> {
    let maxima = problem.optima().len();
    let mut times = vec![Vec::new(); engines.len() + 1];
    for seed in seeds {
        for turn in 0..times.len() {
            let entrant = (turn + seed as usize) % times.len();
            // The reader of the clock is the same for all.
            let start = Instant::now();
            let points: Vec<Vec<f64>> = if let Some(engine) = engines.get(entrant) {
                let mut search = Search::named(engine)?.seed(seed).probes(0.0);
                let report = search.run(problem, &Budget::time(LIMIT).and_hits(maxima as u64))?;
                report
                    .hits()
                    .map(|hit| hit.solution.coordinates.clone())
                    .collect()
            } else {
                multistart(problem, maxima, seed)
            };
            let seconds = start.elapsed().as_secs_f64();
            let found = problem.score(&points, ACCURACIES[0]).by_place;
            times[entrant].push(if found == maxima { seconds } else { f64::INFINITY });
        }
    }
    let medians: Vec<f64> = times
        .iter_mut()
        .map(|times| {
            times.sort_by(f64::total_cmp);
            times[times.len() / 2]
        })
        .collect();
    let rival = medians[engines.len()];
    print!("| {number} | {maxima} | {rival:.4} |");
    for ours in &medians[..engines.len()] {
        print!(" {ours:.4} | {:.1} |", rival / ours);
    }
    println!();
    Ok(())
}

/// From uniform points: steps along the axes, halved when none is better, until the maximum is within delta. Whether a known one is
/// near is looked up whenever the step is halved, in a hash map of cells as wide as the radius.
fn multistart(problem: &Cec2013, maxima: usize, seed: u64) -> Vec<Vec<f64>> {
    let (mut rng, start) = (SearchRng::new(seed), Instant::now());
    let axes = problem.space().axes();
    let goal = problem.peak() - problem.threshold();
    let mut known = Known {
        radius: problem.radius(),
        cells: HashMap::default(),
        found: Vec::new(),
    };
    while known.found.len() < maxima && start.elapsed() < LIMIT {
        let mut x: Vec<f64> = axes.iter().map(|axis| axis.at(rng.uniform())).collect();
        let (mut height, mut step) = (problem.height(&x), 0.02);
        let mut ends = known.has(&x);
        while !ends && height <= goal && step > 1e-9 {
            let mut better = false;
            for (j, axis) in axes.iter().enumerate() {
                for sign in [1.0, -1.0] {
                    let before = x[j];
                    x[j] = (before + sign * step * axis.width()).clamp(axis.lower(), axis.upper());
                    let there = problem.height(&x);
                    if there > height {
                        height = there;
                        better = true;
                        break;
                    }
                    x[j] = before;
                }
            }
            if !better {
                step *= 0.5;
                ends = known.has(&x);
            }
        }
        if height > goal && !known.has(&x) {
            known.add(x);
        }
    }
    known.found
}

/// Known maxima by their cell.
struct Known {
    radius: f64,
    cells: HashMap<[i32; 3], Vec<usize>, foldhash::fast::FixedState>,
    found: Vec<Vec<f64>>,
}

impl Known {
    fn cell(&self, x: &[f64]) -> [i32; 3] {
        std::array::from_fn(|j| x.get(j).map_or(0, |x| (x / self.radius).floor() as i32))
    }

    fn add(&mut self, x: Vec<f64>) {
        self.cells
            .entry(self.cell(&x))
            .or_default()
            .push(self.found.len());
        self.found.push(x);
    }

    /// Whether a known maximum is within the radius: it is in the same cell or in one that touches it.
    fn has(&self, x: &[f64]) -> bool {
        let home = self.cell(x);
        let near = |&index: &usize| {
            let square: f64 = self.found[index]
                .iter()
                .zip(x)
                .map(|(a, b)| (a - b) * (a - b))
                .sum();
            square <= self.radius * self.radius
        };
        (0..3_i32.pow(x.len() as u32)).any(|code| {
            let cell = [
                home[0] + code % 3 - 1,
                home[1] + code / 3 % 3 - 1,
                home[2] + (code / 9 + 2) % 3 - 1,
            ];
            let cell = if x.len() < 3 {
                [cell[0], cell[1], home[2]]
            } else {
                cell
            };
            self.cells.get(&cell).is_some_and(|list| list.iter().any(near))
        })
    }
}

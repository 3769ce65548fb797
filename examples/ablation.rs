//! Which parts of the default engine earn their place: each left out in turn, beside the engines that it has to beat.
//!
//! `cargo run --release --example ablation` prints the table and writes it to `docs/results/ablation.md` (or to the folder
//! `SATISFICE_OUT`). Sixteen seeds, paired; with `SATISFICE_QUICK=1` two seeds and a tenth of the evaluations.

use std::fmt::Write as _;
use std::path::PathBuf;

use rayon::prelude::*;
use satisfice::Budget;
use satisfice_bench::{Instance, Request, catalogue};

const PROBLEMS: [(&str, &[(&str, &str)]); 11] = [
    ("falsification", &[]),
    ("sallen-key", &[]),
    ("arm", &[]),
    ("arm", &[("links", "5")]),
    ("islands", &[]),
    ("rastrigin", &[]),
    ("shell", &[]),
    ("roots", &[]),
    ("queens", &[]),
    ("needles", &[]),
    ("teapots", &[]),
];
/// The geometric mean is over the ten problems before the teapots.
const MEAN_OVER: usize = 10;
/// Engines, each with a setting of its own.
const ENGINES: [(&str, &str); 16] = [
    ("latest-hit-qpso", ""),
    ("latest-hit-qpso", "exhaust=yes"),
    ("random", ""),
    ("random", "exhaust=yes"),
    ("walk", ""),
    ("descent-flood", ""),
    ("qpso-deletion", ""),
    ("pso-latest-hit", ""),
    ("portfolio", ""),
    ("portfolio", "without=swarms"),
    ("portfolio", "without=climbers"),
    ("portfolio", "without=steps"),
    ("portfolio", "without=learning"),
    ("portfolio", "without=neighbours"),
    ("portfolio", "prune=yes"),
    ("branch-and-bound", ""),
];
/// The default engine among them.
const WHOLE: usize = 8;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let quick = std::env::var_os("SATISFICE_QUICK").is_some();
    let (seeds, evaluations) = if quick { (2, 10_000) } else { (16, 100_000) };
    let mut means = vec![Vec::new(); ENGINES.len()];
    let mut names = Vec::new();
    for (problem, settings) in PROBLEMS {
        let instance = catalogue::find(problem)?.build(settings.iter().copied())?;
        let reference = instance
            .reference_hits()
            .map_or_else(|| "?".to_owned(), |hits| hits.to_string());
        let setting: String = settings
            .iter()
            .map(|(name, text)| format!(" {name}={text}"))
            .collect();
        names.push(format!("{problem}{setting} ({reference})"));
        for (engine, row) in ENGINES.iter().zip(&mut means) {
            row.push(mean_hits(instance.as_ref(), *engine, seeds, evaluations)?);
        }
        eprintln!("{problem}{setting} done");
    }
    let table = table(&names, &means, seeds, evaluations)?;
    println!("{table}");
    let folder =
        std::env::var_os("SATISFICE_OUT").map_or_else(|| PathBuf::from("docs/results"), PathBuf::from);
    let folder = if quick && std::env::var_os("SATISFICE_OUT").is_none() {
        PathBuf::from("out")
    } else {
        folder
    };
    std::fs::create_dir_all(&folder)?;
    let path = folder.join("ablation.md");
    std::fs::write(&path, &table)?;
    println!("written to {}", path.display());
    let whole = relative(&means[WHOLE], &means[0]);
    assert!(
        whole > 1.5,
        "the default engine should find far more than the literal one, not {whole:.2} times as much"
    );
    Ok(())
}

/// Mean of the distinct hits over the seeds.
fn mean_hits(
    problem: &dyn Instance,
    (engine, setting): (&str, &str),
    seeds: u64,
    evaluations: u64,
) -> Result<f64, satisfice_bench::Error> {
    // Under a budget of evaluations a busy core changes nothing.
    let hits = (0..seeds).into_par_iter().map(|seed| {
        let mut request = Request::new(engine, Budget::evaluations(evaluations)).seed(seed);
        if let Some((name, value)) = setting.split_once('=') {
            request = request.set(name, value);
        }
        Ok(problem.run(&request, &mut |_| {})?.hits)
    });
    let hits: Vec<u64> = hits.collect::<Result<_, satisfice_bench::Error>>()?;
    Ok(hits.iter().sum::<u64>() as f64 / seeds as f64)
}

/// Geometric mean of the ratios; a count of none counts as half a hit, so that the mean exists.
fn relative(means: &[f64], to: &[f64]) -> f64 {
    let logs = means
        .iter()
        .zip(to)
        .take(MEAN_OVER)
        .map(|(a, b)| (a.max(0.5) / b.max(0.5)).ln());
    (logs.sum::<f64>() / MEAN_OVER as f64).exp()
}

fn table(
    names: &[String],
    means: &[Vec<f64>],
    seeds: u64,
    evaluations: u64,
) -> Result<String, std::fmt::Error> {
    let mut text = format!(
        "# What each part of the default engine earns\n\nMean distinct hits of {seeds} seeds at {evaluations} evaluations, by \
         `cargo run --release --example ablation`; in brackets the number of all hits. The last row is the geometric mean over \
         the first {MEAN_OVER} problems of the ratio to `latest-hit-qpso`. `exhaust=yes`: the neighbourhood of every hit is \
         exhausted beside the engine. Only `prune=yes` and `branch-and-bound` use bounds, where a problem offers any; each \
         call of one counts as an evaluation.\n\n| problem |"
    );
    for (engine, setting) in ENGINES {
        write!(text, " {engine} {setting} |")?;
    }
    text.push_str("\n|---|");
    text.push_str(&"---|".repeat(ENGINES.len()));
    for (i, name) in names.iter().enumerate() {
        write!(text, "\n| {name} |")?;
        for row in means {
            write!(text, " {:.1} |", row[i])?;
        }
    }
    text.push_str("\n| **relative** |");
    for row in means {
        write!(text, " **{:.2}** |", relative(row, &means[0]))?;
    }
    text.push('\n');
    Ok(text)
}

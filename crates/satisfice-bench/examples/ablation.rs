//! What each part of the default engine contributes: each is left out in turn, and rival engines run beside it. Then the
//! teapots in every vertex order, moving teapots, and the composed functions of CEC2013 if their data are available.
//!
//! `cargo run --release -p satisfice-bench --example ablation` prints the table and writes it to `docs/results/ablation.md` (or to the folder
//! `SATISFICE_OUT`). Eight seeds, the same for every engine; with `SATISFICE_QUICK=1` one seed and fewer evaluations: a check that it works, not a measurement.
//! `SATISFICE_CEC2013=DIR` names the folder with that suite's data.

#[path = "../../../examples/moving_teapots/mod.rs"]
mod moving_teapots;

use std::fmt::Write as _;
use std::path::PathBuf;

use moving_teapots::{MovingTeapots, Way};
use rayon::prelude::*;
use satisfice::WarmStart;
use satisfice_catalogue::{Instance, RunControl, RunSpec, catalogue};
use satisfice_problems::Cec2013;

/// Designs, level sets, roots, isolated points, meshes, many optima of a smooth function, isolated postures, combinatorial designs.
const PROBLEMS: [(&str, &[(&str, &str)]); 23] = [
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
    ("cec2013", &[("problem", "6")]),
    ("cec2013", &[("problem", "7")]),
    ("cec2013", &[("problem", "8")]),
    ("puma", &[]),
    ("seven-joints", &[]),
    ("disc-packing", &[]),
    ("costas", &[]),
    ("langford", &[]),
    ("latin-square", &[]),
    ("magic-square", &[]),
    ("mixed-axes", &[]),
    ("hartmann-6", &[]),
];
/// Seeds of each engine on each problem.
const SEEDS: u64 = 8;
/// Evaluations of a run: with ten times as many, most of the problems are solved by the rest, too.
const EVALUATIONS: u64 = 10_000;
/// Engines with their settings.
const ENGINES: [(&str, &str); 24] = [
    ("portfolio", ""),
    ("portfolio", "without=swarms"),
    ("portfolio", "without=steps"),
    ("portfolio", "without=learning"),
    ("portfolio", "without=recombination"),
    ("portfolio", "without=neighbours"),
    ("portfolio", "without=descents"),
    ("portfolio", "without=cma-es"),
    ("portfolio", "without=flood-fill"),
    ("portfolio", "without=regions"),
    ("portfolio", "without=model"),
    ("portfolio", "without=quadratic-descents"),
    ("portfolio", "without=niching"),
    ("portfolio", "prune=yes"),
    ("latest-hit-qpso", ""),
    ("latest-hit-qpso", "exhaust=yes"),
    ("random", ""),
    ("random", "exhaust=yes"),
    ("walk", ""),
    ("descent-flood", ""),
    ("qpso-deletion", ""),
    ("pso-latest-hit", ""),
    ("quadratic-descent", ""),
    ("branch-and-bound", ""),
];
/// The places of the default engine and of the literal one in the list.
const WHOLE: usize = 0;
const LITERAL: usize = 14;
/// The engines compared on the teapots.
const BESIDE: [&str; 4] = ["portfolio", "descent-flood", "latest-hit-qpso", "random"];
/// The engines compared on moving teapots, slice after slice.
const WARM: [(&str, &[(&str, &str)]); 5] = [
    ("portfolio", &[]),
    ("portfolio", &[("without", "near-misses")]),
    ("descent-flood", &[]),
    ("latest-hit-qpso", &[]),
    ("random", &[]),
];
/// Composed functions of CEC2013 with the suite's evaluation limits, and the engines compared on them.
const COMPOSED: std::ops::RangeInclusive<u64> = 11..=20;
const ON_COMPOSED: [(&str, &str); 5] = [
    ("portfolio", ""),
    ("portfolio", "without=recombination"),
    ("portfolio", "without=cma-es"),
    ("portfolio", "without=niching"),
    ("descent-flood", ""),
];
/// Moving teapots: frames, sizes moved in a frame, evaluations in a frame.
const FRAMES: usize = 40;
const STEP: f64 = 0.004;
const PER_FRAME: u64 = 5_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let quick = std::env::var_os("SATISFICE_QUICK").is_some();
    let (seeds, evaluations) = if quick { (1, 60) } else { (SEEDS, EVALUATIONS) };
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
    let mut table = table(&names, &means, seeds, evaluations)?;
    table.push_str(&orders(seeds, &[evaluations, 10 * evaluations])?);
    table.push_str(&moving(seeds, if quick { 4 } else { FRAMES })?);
    table.push_str(&composed(seeds, quick)?);
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
    let literal = relative(&means[LITERAL], &means[WHOLE]);
    assert!(
        literal < 0.7,
        "the default engine should find far more than the literal one, which finds {literal:.2} times as much"
    );
    Ok(())
}

/// Mean of the distinct hits over the seeds.
fn mean_hits(
    problem: &dyn Instance,
    (engine, setting): (&str, &str),
    seeds: u64,
    evaluations: u64,
) -> Result<f64, satisfice_catalogue::Error> {
    // A busy core does not affect results under a budget of evaluations.
    let hits = (0..seeds).into_par_iter().map(|seed| {
        let mut spec = RunSpec::new(engine).evaluations(evaluations).seed(seed);
        if let Some((name, value)) = setting.split_once('=') {
            spec = spec.set(name, value);
        }
        Ok(problem.run(&spec, RunControl::default())?.hits)
    });
    let hits: Vec<u64> = hits.collect::<Result<_, satisfice_catalogue::Error>>()?;
    Ok(hits.iter().sum::<u64>() as f64 / seeds as f64)
}

/// Geometric mean of the ratios. No hits count as half a hit, so that the mean exists.
fn relative(means: &[f64], to: &[f64]) -> f64 {
    let logs = means.iter().zip(to).map(|(a, b)| (a.max(0.5) / b.max(0.5)).ln());
    (logs.sum::<f64>() / means.len() as f64).exp()
}

fn table(
    names: &[String],
    means: &[Vec<f64>],
    seeds: u64,
    evaluations: u64,
) -> Result<String, std::fmt::Error> {
    let mut text = format!(
        "# What each part of the default engine earns\n\nMean distinct hits of {seeds} seeds at {evaluations} evaluations, by \
         `cargo run --release --example ablation`; in brackets the number of all hits. The last column is the geometric mean of the ratio to \
         `portfolio`; fewer hits than half a hit a seed count as that. `exhaust=yes`: the neighbourhood of every hit is \
         exhausted beside the engine. Only `prune=yes` and `branch-and-bound` use bounds, where a problem offers any; each \
         call of one counts as an evaluation.\n\n| engine |"
    );
    for name in names {
        write!(text, " {name} |")?;
    }
    text.push_str(" **relative** |\n|---|---|");
    text.push_str(&"---|".repeat(names.len()));
    for ((engine, setting), row) in ENGINES.iter().zip(means) {
        write!(text, "\n| `{}` |", format!("{engine} {setting}").trim_end())?;
        for mean in row {
            write!(text, " {mean:.1} |")?;
        }
        write!(text, " **{:.2}** |", relative(row, &means[WHOLE]))?;
    }
    text.push('\n');
    Ok(text)
}

/// Recall on the teapots for each order of their vertices.
fn orders(seeds: u64, budgets: &[u64]) -> Result<String, Box<dyn std::error::Error>> {
    let mut text =
        format!("\n## Teapots in every vertex order\n\nMean recall of {seeds} seeds, in %.\n\n| order |");
    for evaluations in budgets {
        for engine in BESIDE {
            write!(text, " `{engine}`, {evaluations} evaluations |")?;
        }
    }
    write!(text, "\n|---|{}", "---|".repeat(budgets.len() * BESIDE.len()))?;
    for order in satisfice_collision::VertexOrder::NAMES {
        let instance = catalogue::find("teapots")?.build([("order", order)])?;
        let all = instance
            .reference_hits()
            .ok_or("the teapots have an exact count")? as f64;
        write!(text, "\n| {order} |")?;
        for &evaluations in budgets {
            for engine in BESIDE {
                let hits = mean_hits(instance.as_ref(), (engine, ""), seeds, evaluations)?;
                write!(text, " {:.1} |", 100.0 * hits / all)?;
            }
        }
    }
    text.push('\n');
    Ok(text)
}

/// Recall on moving teapots: each frame is a slice, warm from the frame before.
fn moving(seeds: u64, frames: usize) -> Result<String, Box<dyn std::error::Error>> {
    let mut text = format!(
        "\n## Teapots that move\n\n{frames} frames, the second teapot moving by {STEP} sizes a frame (delta is 0.02 sizes), \
         {PER_FRAME} evaluations a frame; mean recall of {seeds} seeds and of all frames, in %. Kept: share of a frame's hits \
         that were hits in the frame before. Verify: all of the last hits are evaluated anew before the engine goes on, which \
         takes as many evaluations as there were hits.\n\n| the teapot moves | hits a frame | kept |"
    );
    for (engine, settings) in WARM {
        let setting: String = settings
            .iter()
            .map(|(name, value)| format!(" {name}={value}"))
            .collect();
        write!(text, " `{engine}{setting}`, cold | verify |")?;
    }
    write!(text, "\n|---|---|---|{}", "---|---|".repeat(WARM.len()))?;
    for (name, way) in [("past the other", Way::Past), ("towards it", Way::Towards)] {
        let scene = MovingTeapots::new(frames, STEP, way)?;
        let hits = || (0..frames).map(|frame| scene.hits(frame));
        let kept = (1..frames).map(|frame| scene.kept(frame)).sum::<f64>() / (frames - 1) as f64;
        write!(
            text,
            "\n| {name} | {} to {} | {:.0} % |",
            hits().min().unwrap_or(0),
            hits().max().unwrap_or(0),
            100.0 * kept
        )?;
        for engine in WARM {
            for rule in [WarmStart::Cold, WarmStart::Verify] {
                let recalls = scene.recalls(engine, rule, PER_FRAME, seeds)?;
                write!(text, " {:.1} |", recalls.iter().sum::<f64>() / frames as f64)?;
            }
        }
    }
    text.push('\n');
    Ok(text)
}

/// Optima of the composed functions of CEC2013. Their shifts and rotations are read from the folder
/// `SATISFICE_CEC2013`, if it is set.
fn composed(seeds: u64, quick: bool) -> Result<String, Box<dyn std::error::Error>> {
    let mut text = format!(
        "\n## Composed functions of CEC2013\n\nMean optima of {seeds} seeds within the suite's evaluations, found at an accuracy of \
         0.0001. The suite's data come from the folder `SATISFICE_CEC2013`.\n"
    );
    let Some(data) = std::env::var_os("SATISFICE_CEC2013") else {
        text.push_str("\nNot measured: no such folder was named.\n");
        return Ok(text);
    };
    let data = data.to_string_lossy();
    text.push_str("\n| function (optima) |");
    for (engine, setting) in ON_COMPOSED {
        write!(text, " `{}` |", format!("{engine} {setting}").trim_end())?;
    }
    write!(text, "\n|---|{}", "---|".repeat(ON_COMPOSED.len()))?;
    for function in COMPOSED {
        let problem = Cec2013::new(usize::try_from(function)?, 1e-4, &data)?;
        let evaluations = if quick { 10_000 } else { problem.max_evaluations() };
        let number = function.to_string();
        let instance = catalogue::find("cec2013")?.build([("problem", number.as_str()), ("data", &data)])?;
        write!(
            text,
            "\n| {function} ({}) |",
            instance.reference_hits().unwrap_or(0)
        )?;
        for engine in ON_COMPOSED {
            write!(
                text,
                " {:.2} |",
                mean_hits(instance.as_ref(), engine, seeds, evaluations)?
            )?;
        }
        eprintln!("composed function {function} done");
    }
    text.push('\n');
    Ok(text)
}

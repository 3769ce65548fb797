//! Problems that are not in the catalogue: hits of the default and of the best other engine, the figures of
//! `docs/results/regret.md`, "Outside the catalogue".
//!
//! `cargo run --release -p satisfice-problems --example level_sets -- [list=smooth|multimodal|lattices] [evaluations=N] [seeds=N] [only=TEXT]
//! [without=ENGINE]`, smooth functions, 200 evaluations and 6 seeds by default. At 10,000 evaluations `surrogate` takes 5 s a run, a hundred times
//! as long as the others: `without=surrogate`. Where a source is named, the function is the published one; the level, its region and the turns
//! are ours.

mod lattices;
mod multimodal;
mod smooth;

use std::error::Error;

use satisfice::problem::{BoxedFn, FnProblem};
use satisfice::{Budget, SatisficingProblem, Search, engine};

type Problem = FnProblem<f64, BoxedFn<'static, f64>>;
type Named = (&'static str, Problem);

fn main() -> Result<(), Box<dyn Error>> {
    let quick = std::env::var_os("SATISFICE_QUICK").is_some();
    let (mut evaluations, mut seeds) = if quick { (60, 1) } else { (200, 6) };
    let (mut only, mut without) = (String::new(), String::new());
    let mut problems = smooth::problems()?;
    for argument in std::env::args().skip(1) {
        match argument.split_once('=') {
            Some(("evaluations", count)) => evaluations = count.parse()?,
            Some(("seeds", count)) => seeds = count.parse()?,
            Some(("only", text)) => only = text.to_owned(),
            Some(("list", "smooth")) => problems = smooth::problems()?,
            Some(("without", text)) => {
                let engine = engine::find(text).map_err(|error| error.to_string())?;
                without = engine.name.to_owned();
            }
            Some(("list", "multimodal")) => problems = multimodal::problems()?,
            Some(("list", "lattices")) => problems = lattices::problems()?,
            _ => {
                let known =
                    "list=smooth, list=multimodal, list=lattices, evaluations=, seeds=, only= or without=";
                return Err(format!("`{argument}` is not {known}").into());
            }
        }
    }
    if seeds == 0 {
        return Err("seeds=0: at least one is needed".into());
    }
    println!("{evaluations} evaluations, seeds 0 to {}\n", seeds - 1);
    println!("| problem | axes | default | best other | ratio |\n|---|---|---|---|---|");
    let mut ratios = Vec::new();
    for (name, problem) in problems.iter().filter(|(name, _)| name.contains(&only)) {
        let hits = |engine: &str| -> Result<usize, satisfice::Error> {
            (0..seeds).try_fold(0, |sum, seed| {
                let mut search = Search::named(engine)?.seed(seed);
                Ok(sum
                    + search
                        .run(problem, &Budget::evaluations(evaluations))?
                        .hit_count())
            })
        };
        let default = hits("portfolio")?;
        let mut best = (0, "none");
        let others = engine::all().iter().map(|engine| engine.name);
        for other in others.filter(|&name| name != "portfolio" && name != without) {
            let found = hits(other)?;
            if found > best.0 {
                best = (found, other);
            }
        }
        let ratio = (default as f64 + 0.5) / (best.0 as f64 + 0.5);
        let mean = |hits: usize| hits as f64 / seeds as f64;
        let axes = problem.space().dimension();
        println!(
            "| {name} | {axes} | {:.1} | {:.1} ({}) | {ratio:.2} |",
            mean(default),
            mean(best.0),
            best.1
        );
        if best.0 as u64 >= seeds {
            ratios.push(ratio.ln());
        }
    }
    let mean = (ratios.iter().sum::<f64>() / ratios.len().max(1) as f64).exp();
    println!(
        "\ngeometric mean {mean:.2} of {} where the best finds a hit a seed",
        ratios.len()
    );
    Ok(())
}

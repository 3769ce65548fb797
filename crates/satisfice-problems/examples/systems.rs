//! The nonlinear systems in the usual budgets: roots found of those that there are, and how often all of them.
//!
//! `cargo run --release -p satisfice-problems --example systems [RUNS [ENGINE]]`, 30 runs of `portfolio` by default. Budgets: 50,000
//! evaluations for two unknowns, 100,000 for three, 200,000 for four and five, 500,000 above.

use satisfice::catalogue::Catalogued;
use satisfice::{Budget, Search};
use satisfice_problems::{Himmelblau, System};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let quick = std::env::var_os("SATISFICE_QUICK").is_some();
    let runs: u64 = arguments
        .next()
        .as_deref()
        .unwrap_or(if quick { "2" } else { "30" })
        .parse()?;
    let engine = arguments.next().unwrap_or_else(|| "portfolio".to_owned());
    println!("engine {engine}, seeds 0 to {}\n", runs.saturating_sub(1));
    println!("| system | unknowns | roots | evaluations | root ratio | success rate |");
    println!("|---|---|---|---|---|---|");
    let mut ratios = Vec::new();
    ratios.push(row("himmelblau", &Himmelblau::new(1e-5, 0.01)?, runs, &engine)?);
    for name in System::names() {
        ratios.push(row(name, &System::new(name, 1e-5, 0.01)?, runs, &engine)?);
    }
    let mean = |part: fn(&(f64, f64)) -> f64| ratios.iter().map(part).sum::<f64>() / ratios.len() as f64;
    println!(
        "\nmean of {} systems: root ratio {:.4}, success rate {:.4} (published over 30 systems: RWDE-EDA .97 and .86)",
        ratios.len(),
        mean(|ratio| ratio.0),
        mean(|ratio| ratio.1)
    );
    Ok(())
}

/// Root ratio and success rate of one system.
fn row<P: Catalogued<Scalar = f64>>(
    name: &str,
    problem: &P,
    runs: u64,
    engine: &str,
) -> Result<(f64, f64), satisfice::Error> {
    let unknowns = problem.space().dimension();
    let evaluations = match unknowns {
        ..=2 => 50_000,
        3 => 100_000,
        4..=5 => 200_000,
        _ => 500_000,
    };
    let roots = problem.reference_hits().unwrap_or(0);
    let (mut found, mut complete) = (0, 0);
    for seed in 0..runs {
        let mut search = Search::named(engine)?.seed(seed);
        let hits = search
            .run(problem, &Budget::evaluations(evaluations))?
            .hit_count() as u64;
        assert!(hits <= roots, "{name}: {hits} roots of {roots}");
        found += hits;
        complete += u64::from(hits == roots);
    }
    let ratio = found as f64 / (roots * runs) as f64;
    let rate = complete as f64 / runs as f64;
    println!("| {name} | {unknowns} | {roots} | {evaluations} | {ratio:.3} | {rate:.2} |");
    Ok((ratio, rate))
}

//! Hits after 50, 200 and 400 evaluations: the figures of `docs/results/expensive.md`.
//!
//! `cargo run --release -p satisfice-problems --example few_evaluations -- [engine=NAME] [seeds=N] [only=TEXT] [out=N]`
//!
//! With `out` so many evaluations are out at a time, answered in the order in which they were given out.

#![allow(missing_docs, reason = "an example")]

use std::collections::VecDeque;
use std::error::Error;
use std::sync::Arc;

use satisfice::catalogue::{Catalogued, Params};
use satisfice::{Budget, SatisficingProblem, Search, SearchRng, Space, Tickets, from_fn};
use satisfice_problems::{Arm, Branin, Falsification, Hartmann6, SallenKey, Shell};

/// Share of the space that is a hit of the functions with a name.
const FEASIBLE: f64 = 0.01;
/// Small regions among which a search has to find all.
const REGIONS: usize = 8;
const AXES: usize = 6;

struct Settings {
    engine: String,
    seeds: u64,
    only: String,
    out: usize,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut settings = Settings {
        engine: "surrogate".to_owned(),
        seeds: 16,
        only: String::new(),
        out: 1,
    };
    for argument in std::env::args().skip(1) {
        match argument.split_once('=') {
            Some(("engine", name)) => settings.engine = name.to_owned(),
            Some(("seeds", count)) => settings.seeds = count.parse()?,
            Some(("only", text)) => settings.only = text.to_owned(),
            Some(("out", count)) => settings.out = count.parse()?,
            _ => return Err(format!("`{argument}` is not engine=, seeds=, only= or out=").into()),
        }
    }
    settings.catalogued::<Falsification>()?;
    settings.catalogued::<Shell>()?;
    settings.catalogued::<Arm>()?;
    settings.catalogued::<SallenKey>()?;
    settings.function("branin", 2, 0.01, Branin::value)?;
    settings.function("himmelblau, log1p", 2, 0.01, himmelblau)?;
    settings.function("rosenbrock, log1p", 4, 0.03, rosenbrock)?;
    settings.function("hartmann", 6, 0.05, Hartmann6::value)?;
    settings.regions("balls", |x, c| {
        x.iter().zip(c).map(|(x, c)| (x - c).powi(2)).sum::<f64>().sqrt()
    })?;
    settings.regions("boxes", |x, c| {
        x.iter().zip(c).map(|(x, c)| (x - c).abs()).fold(0.0, f64::max)
    })
}

impl Settings {
    fn catalogued<P>(&self) -> Result<(), Box<dyn Error>>
    where
        P: Catalogued + SatisficingProblem<Scalar = f64>,
    {
        let problem = Arc::new(P::from_params(&Params::defaults(P::PARAMETERS)?)?);
        self.row(P::NAME, &[50, 200], |_, seed, budget| {
            self.hits(&problem, seed, budget)
        })
    }

    /// A function of the unit cube, whose hits are the best hundredth of it.
    fn function(
        &self,
        name: &str,
        axes: usize,
        separation: f64,
        f: fn(&[f64]) -> f64,
    ) -> Result<(), Box<dyn Error>> {
        let problem = from_fn(Space::cube(axes, 0.0, 1.0)?, quantile(axes, f), f).separation(separation);
        let problem = Arc::new(problem);
        self.row(name, &[50, 200], |_, seed, budget| {
            self.hits(&problem, seed, budget)
        })
    }

    /// Small regions in the unit cube, others for each seed: F is the distance to the nearest centre.
    fn regions(&self, name: &str, distance: fn(&[f64], &[f64]) -> f64) -> Result<(), Box<dyn Error>> {
        self.row(name, &[400], |settings, seed, budget| {
            let centres = centres(seed);
            let f = |x: &[f64]| {
                let all = centres.iter().map(|c| distance(x, c));
                all.fold(f64::INFINITY, f64::min)
            };
            let problem = from_fn(Space::cube(AXES, 0.0, 1.0)?, 0.05, f).separation(0.2);
            settings.hits(&Arc::new(problem), seed, budget)
        })
    }

    /// The evaluations at which hits were found.
    fn hits<P: SatisficingProblem<Scalar = f64>>(
        &self,
        problem: &Arc<P>,
        seed: u64,
        budget: u64,
    ) -> Result<Vec<u64>, satisfice::Error> {
        let mut search = Search::named(&self.engine)?.seed(seed);
        let budget = Budget::evaluations(budget);
        let report = if self.out > 1 {
            let budget = budget.with_parallel(self.out);
            let mut tickets = Tickets::eager(search, Arc::clone(problem), &budget)?;
            let mut out = VecDeque::new();
            loop {
                out.extend(tickets.ask(self.out - out.len()));
                let Some(next) = out.pop_front() else { break };
                let value = problem.fitness(&next.solution);
                tickets.tell(next.ticket, value)?;
            }
            tickets.finish()
        } else {
            search.run(&**problem, &budget)?
        };
        Ok(report.hits().map(|hit| hit.evaluation).collect())
    }

    /// Prints the medians of distinct hits after each number of evaluations.
    fn row(
        &self,
        name: &str,
        counted: &[u64],
        run: impl Fn(&Self, u64, u64) -> Result<Vec<u64>, satisfice::Error>,
    ) -> Result<(), Box<dyn Error>> {
        if !name.contains(&self.only) {
            return Ok(());
        }
        let last = counted[counted.len() - 1];
        let runs: Vec<Vec<u64>> = (1..=self.seeds)
            .map(|seed| run(self, seed, last))
            .collect::<Result<_, _>>()?;
        print!("{name:20}");
        for &limit in counted {
            let count = |hits: &Vec<u64>| hits.iter().filter(|&&at| at <= limit).count();
            let counts: Vec<usize> = runs.iter().map(count).collect();
            let mean = counts.iter().sum::<usize>() as f64 / counts.len() as f64;
            print!("  {limit}: {:.1} (mean {mean:.1})", median(counts));
        }
        println!();
        Ok(())
    }
}

fn median(mut counts: Vec<usize>) -> f64 {
    counts.sort_unstable();
    let n = counts.len();
    (counts[(n - 1) / 2] + counts[n / 2]) as f64 / 2.0
}

/// The value below which [`FEASIBLE`] of the unit cube lies, from 100,000 uniform points.
fn quantile(axes: usize, f: fn(&[f64]) -> f64) -> f64 {
    let mut rng = SearchRng::new(7);
    let point = |rng: &mut SearchRng| -> Vec<f64> { (0..axes).map(|_| rng.uniform()).collect() };
    let mut values: Vec<f64> = (0..100_000).map(|_| f(&point(&mut rng))).collect();
    values.sort_by(f64::total_cmp);
    values[(FEASIBLE * 1e5) as usize]
}

/// Centres that are 0.4 apart.
fn centres(seed: u64) -> Vec<Vec<f64>> {
    let mut rng = SearchRng::new(1000 + seed);
    let mut centres: Vec<Vec<f64>> = Vec::new();
    while centres.len() < REGIONS {
        let centre: Vec<f64> = (0..AXES).map(|_| 0.1 + 0.8 * rng.uniform()).collect();
        let apart = |other: &Vec<f64>| {
            let squares = centre.iter().zip(other).map(|(a, b)| (a - b).powi(2));
            squares.sum::<f64>() > 0.16
        };
        if centres.iter().all(apart) {
            centres.push(centre);
        }
    }
    centres
}

fn himmelblau(u: &[f64]) -> f64 {
    let (x, y) = (10.0 * u[0] - 5.0, 10.0 * u[1] - 5.0);
    ((x * x + y - 11.0).powi(2) + (x + y * y - 7.0).powi(2)).ln_1p()
}

fn rosenbrock(u: &[f64]) -> f64 {
    let x: Vec<f64> = u.iter().map(|u| 4.0 * u - 2.0).collect();
    let terms = x
        .windows(2)
        .map(|w| 100.0 * (w[1] - w[0] * w[0]).powi(2) + (1.0 - w[0]).powi(2));
    terms.sum::<f64>().ln_1p()
}

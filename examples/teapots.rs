//! Experiment I: two teapots run into each other. How many of the vertex pairs closer than delta does each engine find?
//!
//! `cargo run --release --example teapots` writes a picture and a page to look into to `out/teapots`, or to the folder `SATISFICE_OUT`.
//! `satisfice bench experiment-one` draws charts of such runs. `SATISFICE_QUICK=1` uses two seeds and short runs: a check that it works, not a measurement.

use std::collections::BTreeSet;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};
use std::{env, fs, thread};

use satisfice::catalogue::{Catalogued, Params};
use satisfice::{Budget, Report, SatisficingProblem, Search};
use satisfice_collision::broad::PointGrid;
use satisfice_collision::distance::Threshold;
use satisfice_collision::problem::Teapots;
use satisfice_page::{Contact, Feature, FeatureKind, ScenePage};
use satisfice_picture::{Picture, View};

type Pair = (u32, u32);
type Found = Report<Pair>;

/// The paper's engine first.
const TIMED: [&str; 6] = [
    "latest-hit-qpso",
    "qpso",
    "pso",
    "random",
    "descent-flood",
    "portfolio",
];
const COUNTED: [&str; 6] = [
    "latest-hit-qpso",
    "qpso",
    "random",
    "walk",
    "descent-flood",
    "portfolio",
];
const SLICE: Duration = Duration::from_millis(100);
/// "Size" is the longest extent of a teapot.
const SCENE: &str = "two teapots, 0.45 sizes apart, 5,000 sampled vertices each, delta 0.02 sizes";

fn main() -> Result<(), Box<dyn Error>> {
    let quick = env::var_os("SATISFICE_QUICK").is_some_and(|value| value != "0");
    let (seeds, evaluations) = if quick { (2, 100_000) } else { (16, 1_000_000) };
    let folder = env::var_os("SATISFICE_OUT").map_or_else(|| "out/teapots".into(), PathBuf::from);
    fs::create_dir_all(&folder)?;

    let hilbert = teapots("hilbert")?;
    let truth = exact(&hilbert)?;
    if quick {
        println!(
            "SATISFICE_QUICK is set: {seeds} seeds, {evaluations} evaluations. This is no measurement.\n"
        );
    }

    println!(
        "In {} ms on one thread, mean of {seeds} seeds (least..most), Hilbert order:",
        SLICE.as_millis()
    );
    println!("  engine             evaluations        |C|            recall   growth after 35 ms");
    let mut runs = Vec::new();
    for name in TIMED {
        let reports = (1..=seeds)
            .map(|seed| search(&hilbert, name, seed, &Budget::time(SLICE)))
            .collect::<Result<Vec<_>, _>>()?;
        reports.iter().for_each(|report| check(report, &truth));
        print_slice(name, &reports, truth.len());
        runs.push((name, reports));
    }
    let shown = median(&runs[0].1);
    println!(
        "  the scene with what {} found in seed {}, {} of {} pairs in vermilion, the others black:",
        TIMED[0],
        shown.seed,
        shown.hit_count(),
        truth.len()
    );
    write(&folder, "scene.png", &picture(&hilbert, shown, &truth)?)?;
    println!("  the same to look into, hit by hit, for every engine:");
    write(&folder, "scene.html", page(&hilbert, &runs, &truth)?.as_bytes())?;

    println!("\nHits at {evaluations} evaluations, mean of {seeds} seeds (least..most):");
    println!("  engine             Hilbert order            random order");
    let random = teapots("random")?;
    let mut means = Vec::new();
    for name in COUNTED {
        let budget = Budget::evaluations(evaluations);
        let [in_order, shuffled] = [&hilbert, &random].map(|problem| -> Result<_, satisfice::Error> {
            let reports = all_seeds(problem, name, seeds, &budget)?;
            reports.iter().for_each(|report| check(report, &truth));
            Ok(Spread::of(reports.iter().map(|report| report.hit_count() as f64)))
        });
        let (in_order, shuffled) = (in_order?, shuffled?);
        println!("  {name:<17}  {in_order:<22}   {shuffled}");
        means.push([in_order.mean, shuffled.mean]);
    }
    conclude(&means, quick);
    Ok(())
}

fn teapots(order: &str) -> Result<Teapots, satisfice::Error> {
    Teapots::from_params(&Params::with(
        Teapots::PARAMETERS,
        Teapots::NAME,
        [("order", order)],
    )?)
}

/// All pairs, by brute force and by a grid: the reference for the engines.
#[expect(
    clippy::disallowed_methods,
    reason = "exact methods have no budget; their time is only printed"
)]
fn exact(problem: &Teapots) -> Result<BTreeSet<Pair>, Box<dyn Error>> {
    let pairs = problem.pairs();
    let start = Instant::now();
    let truth: BTreeSet<_> = pairs.reference_pairs().into_iter().collect();
    let brute_force = start.elapsed();

    let counts = problem.space().axes().iter().map(|axis| axis.width() as u32);
    let [rows, columns]: [u32; 2] = counts
        .collect::<Vec<_>>()
        .try_into()
        .map_err(|_| "not two axes")?;
    let a: Vec<_> = (0..rows).map(|i| pairs.decode(&[f64::from(i), 0.0]).0).collect();
    let b: Vec<_> = (0..columns)
        .map(|j| pairs.decode(&[0.0, f64::from(j)]).1)
        .collect();
    let points_a: Vec<_> = a.iter().map(|&i| pairs.a().vertex(i)).collect();
    let points_b: Vec<_> = b.iter().map(|&j| pairs.b().vertex(j)).collect();
    let mut grid = PointGrid::new();
    let threshold = Threshold::new(problem.threshold())?;
    grid.between(&points_a, &points_b, threshold)?; // once, so that its memory is there
    let start = Instant::now();
    let by_grid = grid.between(&points_a, &points_b, threshold)?.to_vec();
    let with_grid = start.elapsed();
    let by_grid: BTreeSet<_> = by_grid
        .iter()
        .map(|pair| (a[pair.a as usize], b[pair.b as usize]))
        .collect();
    assert_eq!(truth, by_grid, "both are exact");
    println!(
        "{SCENE}:\n  {} of {} pairs are hits, by brute force in {:.1} ms and by a grid in {:.3} ms\n",
        truth.len(),
        u64::from(rows) * u64::from(columns),
        1e3 * brute_force.as_secs_f64(),
        1e3 * with_grid.as_secs_f64(),
    );
    Ok(truth)
}

fn search(problem: &Teapots, name: &str, seed: u64, budget: &Budget) -> Result<Found, satisfice::Error> {
    Search::named(name)?.seed(seed).run(problem, budget)
}

/// The reports of all seeds, made on all cores. Under budgets of evaluations the number of cores changes no report.
fn all_seeds(
    problem: &Teapots,
    name: &str,
    seeds: u64,
    budget: &Budget,
) -> Result<Vec<Found>, satisfice::Error> {
    let waiting = Mutex::new(1..=seeds);
    let next = || waiting.lock().ok().and_then(|mut seeds| seeds.next());
    let work = || -> Result<Vec<_>, _> {
        std::iter::from_fn(next)
            .map(|seed| search(problem, name, seed, budget))
            .collect()
    };
    let mut reports = thread::scope(|scope| {
        let cores = thread::available_parallelism().map_or(1, usize::from);
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        let done = workers
            .into_iter()
            .map(|worker| worker.join().expect("a search does not panic"));
        done.collect::<Result<Vec<_>, _>>()
    })?
    .concat();
    reports.sort_by_key(|report| report.seed);
    Ok(reports)
}

/// Every reported pair must be a true one.
fn check(report: &Found, truth: &BTreeSet<Pair>) {
    for hit in report.hits() {
        assert!(
            truth.contains(hit.solution),
            "{:?} of {} is no hit",
            hit.solution,
            report.engine.name
        );
    }
}

/// Mean, least and most.
struct Spread {
    mean: f64,
    least: f64,
    most: f64,
}

impl Spread {
    fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        Self {
            mean: values.clone().sum::<f64>() / values.clone().count().max(1) as f64,
            least: values.clone().fold(f64::INFINITY, f64::min),
            most: values.fold(0.0, f64::max),
        }
    }
}

impl std::fmt::Display for Spread {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(&format!(
            "{:6.1} ({:.0}..{:.0})",
            self.mean, self.least, self.most
        ))
    }
}

/// |C(t)|, t in milliseconds.
fn hits_by(report: &Found, milliseconds: f64) -> f64 {
    report
        .hits()
        .take_while(|hit| 1e3 * hit.seconds <= milliseconds)
        .count() as f64
}

fn print_slice(name: &str, reports: &[Found], truth: usize) {
    let hits = Spread::of(reports.iter().map(|report| report.hit_count() as f64));
    let evaluations = Spread::of(reports.iter().map(|report| report.counts.evaluations as f64));
    let early = Spread::of(reports.iter().map(|report| hits_by(report, 35.0)));
    println!(
        "  {name:<17} {:>12.0}   {hits:<20} {:5.1} %   {:+.0} %",
        evaluations.mean,
        100.0 * hits.mean / truth as f64,
        100.0 * (hits.mean / early.mean - 1.0),
    );
}

/// The run with the median number of hits.
fn median(reports: &[Found]) -> &Found {
    let mut order: Vec<_> = reports.iter().collect();
    order.sort_by_key(|report| report.hit_count());
    order[order.len() / 2]
}

fn picture(
    problem: &Teapots,
    report: &Found,
    truth: &BTreeSet<Pair>,
) -> Result<Vec<u8>, satisfice_picture::Error> {
    let pairs = problem.pairs();
    let mut picture = Picture::new(1000, 560, View::default());
    picture.body(pairs.a());
    picture.body(pairs.b());
    for pair in truth {
        let [a, b] = [pairs.a().vertex(pair.0), pairs.b().vertex(pair.1)];
        picture.pair(a, b, report.archive.contains(pair));
    }
    picture.png()
}

/// A frame for the median run of each engine: its hits in the order found, and those that it missed.
fn page(
    problem: &Teapots,
    runs: &[(&str, Vec<Found>)],
    truth: &BTreeSet<Pair>,
) -> Result<String, satisfice_page::Error> {
    let pairs = problem.pairs();
    let bodies = [pairs.a(), pairs.b()];
    let mut page = ScenePage::new("Two teapots, 100 ms");
    page.threshold(problem.threshold());
    for (name, mesh) in ["left teapot", "right teapot"].into_iter().zip(bodies) {
        page.body(name, mesh.vertices(), mesh.triangles(), mesh.lines());
    }
    let contact = |&(a, b): &Pair| {
        let points = [bodies[0].vertex(a), bodies[1].vertex(b)];
        let kind = FeatureKind::Vertex;
        let features = [(0, a), (1, b)].map(|(body, number)| Feature { body, kind, number });
        Contact::new(features, points)
    };
    for (name, reports) in runs {
        let report = median(reports);
        page.frame(*name);
        page.frame_fact("Engine", *name);
        page.frame_fact("Evaluations", report.counts.evaluations.to_string());
        page.counts(None, Some(truth.len() as u64));
        for hit in report.hits() {
            let found = contact(hit.solution).distance(hit.fitness);
            page.contact(found.found(hit.evaluation, hit.seconds));
        }
        for pair in truth.iter().filter(|pair| !report.archive.contains(pair)) {
            page.contact(contact(pair).missed());
        }
    }
    page.html()
}

fn write(folder: &Path, name: &str, bytes: &[u8]) -> std::io::Result<()> {
    let path = folder.join(name);
    fs::write(&path, bytes)?;
    println!("  {}", path.display());
    Ok(())
}

/// Checks that must hold on any machine.
fn conclude(means: &[[f64; 2]], quick: bool) {
    let of = |name: &str, order: usize| {
        let row = COUNTED.iter().position(|&engine| engine == name);
        row.map_or(f64::NAN, |row| means[row][order])
    };
    println!(
        "\nIn Hilbert order latest-hit-qpso finds {:.1} times as much as qpso (the prototype: 3.2 times). In random order it \
         finds {:.1} times\nas much as uniform sampling (the prototype: 0.8 times): the order of the serial numbers is what \
         a swarm lives on.",
        of("latest-hit-qpso", 0) / of("qpso", 0),
        of("latest-hit-qpso", 1) / of("random", 1),
    );
    let flood = of("descent-flood", 0);
    assert!(
        flood > 3.0 * of("random", 0),
        "descent-flood is no better than chance"
    );
    if !quick {
        // The standard error is about 50 of 365.
        assert!(
            of("latest-hit-qpso", 0) > 2.0 * of("random", 0),
            "latest-hit-qpso is no better than chance"
        );
        assert!(
            of("latest-hit-qpso", 1) < 0.3 * of("latest-hit-qpso", 0),
            "the order should matter"
        );
    }
}

//! Searches of 20 to 500 evaluations: what the engine `surrogate` knows of F as hits come in, and how it compares.
//!
//! `cargo run --release -p satisfice-draw --example expensive`; writes to `out/expensive`, or to the folder `SATISFICE_OUT`.

use std::error::Error;
use std::sync::Mutex;

use satisfice::engine::GaussianProcess;
use satisfice::{Budget, Search, SearchRng, Space, from_fn};
use satisfice_draw::plot::{Colour, Layer, Map, Maps, Marker, Shape, draw_maps};
use satisfice_problems::{Branin, Hartmann6};

mod gallery;

/// Engines that are compared.
const ENGINES: [&str; 5] = ["surrogate", "portfolio", "latest-hit-qpso", "walk", "random"];
/// Evaluations after which hits are counted.
const COUNTED: [u64; 3] = [50, 200, 500];
/// Share of the space that is a hit.
const FEASIBLE: f64 = 0.01;
/// Grid points along an axis of a picture.
const GRID: usize = 81;

/// A function on the unit cube, with the radius within which two of its hits are one.
struct Function {
    name: &'static str,
    axes: usize,
    separation: f64,
    f: fn(&[f64]) -> f64,
}

const FUNCTIONS: [Function; 2] = [
    Function {
        name: "Branin, 2 axes",
        axes: 2,
        separation: 0.01,
        f: Branin::value,
    },
    Function {
        name: "Hartmann, 6 axes",
        axes: 6,
        separation: 0.05,
        f: Hartmann6::value,
    },
];

fn main() -> Result<(), Box<dyn Error>> {
    for function in &FUNCTIONS {
        compare(function)?;
    }
    picture(&FUNCTIONS[0])
}

impl Function {
    /// The value of F below which [`FEASIBLE`] of the cube lies, from 100,000 uniform points.
    fn threshold(&self) -> f64 {
        let mut rng = SearchRng::new(7);
        let point = |rng: &mut SearchRng| -> Vec<f64> { (0..self.axes).map(|_| rng.uniform()).collect() };
        let mut values: Vec<f64> = (0..100_000).map(|_| (self.f)(&point(&mut rng))).collect();
        values.sort_by(f64::total_cmp);
        values[(FEASIBLE * 1e5) as usize]
    }

    /// Distinct hits of an engine after each number of evaluations, and all evaluated points in order.
    fn search(&self, engine: &str, seed: u64, counted: &[u64]) -> Result<Run, satisfice::Error> {
        let evaluated = Mutex::new(Vec::new());
        let space = Space::cube(self.axes, 0.0, 1.0)?;
        let problem = from_fn(space, self.threshold(), |x: &[f64]| {
            let value = (self.f)(x);
            if let Ok(mut list) = evaluated.lock() {
                list.push((x.to_vec(), value));
            }
            value
        })
        .separation(self.separation);
        let last = counted.iter().copied().max().unwrap_or(1);
        let mut search = Search::named(engine)?.seed(seed);
        let report = search.run(&problem, &Budget::evaluations(last))?;
        let hits = |limit: u64| report.hits().filter(|hit| hit.evaluation <= limit).count();
        let hits = counted.iter().map(|&limit| hits(limit)).collect();
        drop(problem);
        Ok(Run {
            hits,
            evaluated: evaluated.into_inner().unwrap_or_default(),
        })
    }
}

/// What a search came to.
struct Run {
    hits: Vec<usize>,
    evaluated: Vec<(Vec<f64>, f64)>,
}

/// Prints medians over seeds, and checks that no engine without a model finds more than the model does, and that the default, which has the
/// same model among its sources, finds nearly as many or more.
fn compare(function: &Function) -> Result<(), Box<dyn Error>> {
    let seeds = if gallery::is_quick() { 2 } else { 16 };
    let counted = if gallery::is_quick() {
        &COUNTED[..2]
    } else {
        &COUNTED[..]
    };
    println!(
        "{}: medians of {seeds} seeds, hits after {counted:?} evaluations",
        function.name
    );
    let mut medians = Vec::new();
    for engine in ENGINES {
        let runs: Vec<Run> = (1..=seeds)
            .map(|seed| function.search(engine, seed, counted))
            .collect::<Result<_, _>>()?;
        let row: Vec<f64> = (0..counted.len())
            .map(|k| median(runs.iter().map(|run| run.hits[k]).collect()))
            .collect();
        println!("  {engine:16} {row:?}");
        medians.push(row);
    }
    let [model, default, others @ ..] = &medians[..] else {
        return Err("too few engines".into());
    };
    assert!(
        others.iter().all(|row| row[1] <= model[1]),
        "an engine without a model found more in {} evaluations",
        counted[1]
    );
    assert!(
        default[1] >= 0.9 * model[1],
        "the default found less in {} evaluations",
        counted[1]
    );
    Ok(())
}

fn median(mut counts: Vec<usize>) -> f64 {
    counts.sort_unstable();
    let n = counts.len();
    (counts[(n - 1) / 2] + counts[n / 2]) as f64 / 2.0
}

/// Draws what the model expects after some evaluations, with the points so far.
fn picture(function: &Function) -> Result<(), Box<dyn Error>> {
    let run = function.search("surrogate", 1, &[200])?;
    let delta = function.threshold();
    let panels = [12, 40, 200].map(|count| panel(&run.evaluated[..count.min(run.evaluated.len())], delta));
    let maps = Maps {
        title: format!("{}: F - delta as modelled, hits and misses", function.name),
        size: (430.0, 430.0),
        panels: panels.into_iter().collect::<Option<_>>().ok_or("no points")?,
    };
    gallery::save("expensive", |format| draw_maps(&maps, format))
}

/// The model of these points. F is clipped as the engine does it: far above delta its height does not matter.
fn panel(evaluated: &[(Vec<f64>, f64)], delta: f64) -> Option<Map> {
    let (mut points, mut values) = (Vec::new(), Vec::new());
    for (x, f) in evaluated {
        points.extend_from_slice(x);
        values.push((f - delta).min(60.0));
    }
    let model = GaussianProcess::fit(2, &points, &values)?;
    let along: Vec<f64> = (0..GRID).map(|k| k as f64 / (GRID - 1) as f64).collect();
    let row = |y: &f64| along.iter().map(|&x| model.predict(&[x, *y]).0).collect();
    let z: Vec<Vec<f64>> = along.iter().map(row).collect();
    let of = |hits: bool| -> Vec<(f64, f64)> {
        let kind = evaluated.iter().filter(|(_, f)| (*f < delta) == hits);
        kind.map(|(x, _)| (x[0], x[1])).collect()
    };
    let (hits, misses) = (of(true), of(false));
    let marks = |label: &str, colour, size, marker, points| Layer {
        label: Some(label.to_owned()),
        colour,
        size,
        shape: Shape::Points(marker, points),
    };
    Some(Map {
        title: format!("{} evaluations, {} below delta", evaluated.len(), hits.len()),
        x_label: "x₁ (share of its range)".to_owned(),
        y_label: "x₂ (share of its range)".to_owned(),
        x_range: (0.0, 1.0),
        y_range: (0.0, 1.0),
        to_scale: true,
        layers: vec![
            Layer {
                label: Some("F - delta".to_owned()),
                colour: Colour::Black,
                size: 1.0,
                shape: Shape::Contours {
                    x: along.clone(),
                    y: along,
                    z,
                    levels: (-2..13).map(|k| 5.0 * f64::from(k)).collect(),
                },
            },
            marks("miss", Colour::Black, 3.0, Marker::Cross, misses),
            marks("hit", Colour::Vermilion, 2.6, Marker::Disc, hits),
        ],
        ..Map::default()
    })
}

//! Inputs that drive a system out of its specification: the traces that violate it, plotted.
//!
//! `cargo run --release -p satisfice-draw --example falsifying_traces`; writes to `out/falsifying_traces`, or to the folder `SATISFICE_OUT`.

use std::error::Error;

use satisfice::SatisficingProblem;
use satisfice::catalogue::Catalogued;
use satisfice_draw::plot::{Colour, Layer, Map, Maps, draw_maps};
use satisfice_problems::{Falsification, Transmission};

mod gallery;

/// Number of traces drawn; more would hide each other.
const DRAWN: usize = 60;
const LEVELS: usize = 20;
/// The largest allowed deflection of the oscillator.
const LIMIT: f64 = 2.25;

type Line = Vec<(f64, f64)>;

fn main() -> Result<(), Box<dyn Error>> {
    let panels = vec![oscillator()?, too_fast()?, no_calm_start()?];
    let maps = Maps {
        title: "Traces that falsify their specification".to_owned(),
        size: (480.0, 400.0),
        panels,
    };
    gallery::save("falsifying_traces", |format| draw_maps(&maps, format))
}

fn oscillator() -> Result<Map, Box<dyn Error>> {
    let problem = Falsification::new(LEVELS, LIMIT)?;
    let count = falsifying_inputs();
    let report = gallery::search(&problem, 500_000, count)?;
    println!("{report}");
    let mut traces: Vec<Line> = Vec::new();
    for hit in report.hits() {
        let samples = problem.trajectory(hit.solution);
        assert!(
            samples.iter().any(|x| x.abs() > LIMIT),
            "a trace within the limits"
        );
        traces.push(line(&samples, 0.08));
    }
    println!(
        "oscillator: {} of the {count} inputs that superposition counts\n",
        traces.len()
    );
    assert!(traces.len() as u64 <= count && traces.len() as u64 * 10 >= count * 9);
    let quiet: Vec<Line> = inputs()
        .filter(|cells| problem.fitness(cells) >= 0.0)
        .take(DRAWN / 2)
        .map(|cells| line(&problem.trajectory(&cells), 0.08))
        .collect();
    let along = |x: f64| vec![(0.0, x), (8.0, x)];
    Ok(map(
        &format!("oscillator, always |x| ≤ {LIMIT}: {} inputs", traces.len()),
        ("time t (dimensionless)", "position x (dimensionless)"),
        (8.0, (-3.0, 3.0)),
        &[along(LIMIT), along(-LIMIT)],
        &quiet,
        &traces,
    ))
}

/// The referee. The oscillator is linear: a trace is the sum over the five inputs of their level times the response to a unit
/// input. Levels of the last input are counted without a loop over the steps, by the bounds that each step sets.
fn falsifying_inputs() -> u64 {
    let response = |part: usize| -> Vec<f64> {
        let (mut x, mut v) = (0.0, 0.0);
        let step = |n: usize| {
            let input = if n / 20 == part { 1.0 } else { 0.0 };
            v += 0.08 * (input - x - 0.3 * v);
            x += 0.08 * v;
            x
        };
        (0..100).map(step).collect()
    };
    let responses: Vec<Vec<f64>> = (0..5).map(response).collect();
    let level = |cell: usize| (cell as f64 + 0.5) / 10.0 - 1.0;
    let mut count = 0;
    for code in 0..LEVELS.pow(4) {
        let cells: [usize; 4] = std::array::from_fn(|k| code / LEVELS.pow(k as u32) % LEVELS);
        // Without the last input: x. With it at level u: x + u r, and r is 0 in the first four parts.
        let rest = |n: usize| (0..4).map(|k| level(cells[k]) * responses[k][n]).sum::<f64>();
        if (0..80).any(|n| rest(n).abs() > LIMIT) {
            count += LEVELS as u64;
            continue;
        }
        // Levels between `low` and `high` keep every step within the limit; all others falsify it.
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for (n, r) in responses[4].iter().enumerate().skip(80) {
            let x = rest(n);
            let (a, b) = ((-LIMIT - x) / r, (LIMIT - x) / r);
            low = low.max(a.min(b));
            high = high.min(a.max(b));
        }
        count += (0..LEVELS)
            .filter(|cell| !(low..=high).contains(&level(*cell)))
            .count() as u64;
    }
    count
}

/// The car must stay below 110 km/h.
fn too_fast() -> Result<Map, Box<dyn Error>> {
    let violates = |signals: &[Vec<f64>]| signals[0].iter().any(|v| *v > 110.0);
    let (traces, quiet) = transmission("speed", violates)?;
    Ok(map(
        &format!("car, always v < 110 km/h: {} manoeuvres", traces.len()),
        ("time t (s)", "speed v (km/h)"),
        (30.0, (0.0, 140.0)),
        &[vec![(0.0, 110.0), (30.0, 110.0)]],
        &quiet,
        &traces,
    ))
}

/// If the engine stays below 3200 1/min, the car must stay below 40 km/h in the first 8 s.
fn no_calm_start() -> Result<Map, Box<dyn Error>> {
    let violates = |signals: &[Vec<f64>]| {
        signals[1].iter().all(|w| *w < 3200.0) && signals[0][..=80].iter().any(|v| *v > 40.0)
    };
    let (traces, quiet) = transmission("calm-start", violates)?;
    Ok(map(
        &format!("car, calm engine ⇒ v < 40 km/h until 8 s: {}", traces.len()),
        ("time t (s)", "speed v (km/h)"),
        (12.0, (0.0, 70.0)),
        &[vec![(0.0, 40.0), (8.0, 40.0), (8.0, 70.0)]],
        &quiet,
        &traces,
    ))
}

/// The speeds of all manoeuvres that falsify a specification, and of some that do not.
fn transmission(
    name: &str,
    violates: impl Fn(&[Vec<f64>]) -> bool,
) -> Result<(Vec<Line>, Vec<Line>), Box<dyn Error>> {
    let problem = Transmission::new(name, if gallery::is_quick() { 5 } else { 10 })?;
    let count = problem.reference_hits().ok_or("a count")?;
    let report = gallery::search(&problem, 500_000, count)?;
    println!("{report}");
    let mut traces = Vec::new();
    for hit in report.hits() {
        let trace = problem.trace(hit.solution).ok_or("a trace")?;
        assert!(
            violates(trace.signals()),
            "{:?} does not violate {name}",
            hit.solution
        );
        traces.push(line(&trace.signals()[0], 0.1));
    }
    println!(
        "car, {name}: {} of the {count} manoeuvres that an enumeration finds\n",
        traces.len()
    );
    assert_eq!(traces.len() as u64, count);
    let others = manoeuvres().filter_map(|cells| problem.trace(&cells));
    let quiet = others.filter(|trace| !violates(trace.signals())).take(DRAWN / 2);
    Ok((
        traces,
        quiet.map(|trace| line(&trace.signals()[0], 0.1)).collect(),
    ))
}

/// Inputs spread over the oscillator's space, for comparison.
fn inputs() -> impl Iterator<Item = Vec<u32>> {
    (0_u32..).map(|k| {
        (1..=5)
            .map(|axis| (k * 7 * axis + k / 3) % LEVELS as u32)
            .collect()
    })
}

/// Manoeuvres spread over the car's space, for comparison.
fn manoeuvres() -> impl Iterator<Item = Vec<u32>> {
    (0_u32..).map(|k| {
        vec![
            k % 5,
            (3 * k + 1) % 5,
            (7 * k + k / 5) % 5,
            (9 * k + k / 3) % 5,
            k % 5 / 4,
            0,
        ]
    })
}

fn line(samples: &[f64], step: f64) -> Line {
    (1..)
        .map(|n| step * f64::from(n))
        .zip(samples.iter().copied())
        .collect()
}

fn map(
    title: &str,
    (x_label, y_label): (&str, &str),
    (seconds, y_range): (f64, (f64, f64)),
    limits: &[Line],
    quiet: &[Line],
    traces: &[Line],
) -> Map {
    let shown = |lines: &mut dyn Iterator<Item = &Line>| -> Vec<Line> {
        let cut = |line: &Line| line.iter().copied().filter(|(t, _)| *t <= seconds).collect();
        lines.map(cut).collect()
    };
    let greatest = |line: &&Line| line.iter().fold(0.0_f64, |m, (_, x)| m.max(x.abs()));
    let worst = traces.iter().max_by(|a, b| greatest(a).total_cmp(&greatest(b)));
    let mut some = traces.iter().step_by((traces.len() / DRAWN).max(1)).take(DRAWN);
    Map {
        title: title.to_owned(),
        x_label: x_label.to_owned(),
        y_label: y_label.to_owned(),
        x_range: (0.0, seconds),
        y_range,
        layers: vec![
            Layer::lines(Colour::Grey, 0.8, shown(&mut quiet.iter())).named("satisfies it"),
            Layer::lines(Colour::Sky, 0.8, shown(&mut some))
                .named(format!("falsifies it (at most {DRAWN} drawn)")),
            Layer::lines(Colour::Blue, 2.2, shown(&mut worst.into_iter())).named("of these, the farthest"),
            Layer::dashes(Colour::Vermilion, 1.8, limits.to_vec()).named("limit"),
        ],
        ..Map::default()
    }
}

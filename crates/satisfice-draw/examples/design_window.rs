//! All Sallen-Key low-pass filters from standard parts inside a design window: a plot of the feasible designs and a table.
//!
//! `cargo run --release -p satisfice-draw --example design_window`; writes to `out/design_window`, or to the folder `SATISFICE_OUT`.

use std::error::Error;
use std::f64::consts::TAU;

use satisfice::SatisficingProblem;
use satisfice_draw::plot::{Colour, Layer, Map, Maps, Marker, draw_maps};
use satisfice_problems::{Parts, SallenKey, Window};

mod gallery;

fn main() -> Result<(), Box<dyn Error>> {
    let window = Window::default();
    let problem = SallenKey::new(window)?;
    let all = every_design();
    let inside: Vec<&Parts> = all
        .iter()
        .filter(|parts| is_inside(parts, &window, 1.0))
        .collect();
    let report = gallery::search(&problem, 1_000_000, inside.len() as u64)?;
    println!("{report}");

    let found: Vec<Parts> = report
        .hits()
        .filter_map(|hit| problem.parts(hit.solution))
        .collect();
    for hit in report.hits() {
        assert!(problem.fitness(hit.solution) < 1.0);
    }
    for parts in &found {
        assert!(
            inside.iter().any(|other| same(parts, other)),
            "{parts:?} is not inside the window"
        );
    }
    let missed: Vec<&Parts> = inside
        .iter()
        .copied()
        .filter(|parts| !found.iter().any(|other| same(parts, other)))
        .collect();
    println!(
        "{} of the {} designs that an enumeration of all {} finds",
        found.len(),
        inside.len(),
        72 * 72 * 36 * 36
    );
    assert_eq!(found.len() + missed.len(), inside.len());
    assert!(found.len() * 10 >= inside.len() * 7, "fewer than 7 of 10 designs");

    println!(
        "\nthe ten whose four parts are nearest to each other in size\n\n    R1       R2       C1       C2       f0        Q"
    );
    let mut table = found.clone();
    table.sort_by(|a, b| spread(a).total_cmp(&spread(b)));
    for parts in table.iter().take(10) {
        let [r1, r2] = parts.resistances.map(|r| format!("{:.1} kΩ", 1e-3 * r));
        let [c1, c2] = parts.capacitances.map(|c| format!("{:.1} nF", 1e9 * c));
        println!(
            "{r1:>8} {r2:>8} {c1:>8} {c2:>8} {:>6.1} Hz  {:.4}",
            parts.frequency(),
            parts.quality()
        );
    }
    println!();
    let near: Vec<&Parts> = all
        .iter()
        .filter(|parts| !is_inside(parts, &window, 1.0))
        .collect();
    let maps = Maps {
        title: format!(
            "Sallen-Key low-pass filters, 1 kHz within 1 %, Q 0.7071 within 2 %: {} of all {}",
            found.len(),
            inside.len()
        ),
        size: (620.0, 440.0),
        panels: vec![response(&window, &found, &missed, &near), parts(&found)],
    };
    gallery::save("design_window", |format| draw_maps(&maps, format))
}

/// Every design within four times the window, part by part: R1, R2 of E24, C1, C2 of E12, over three decades.
fn every_design() -> Vec<Parts> {
    const E24: [u32; 24] = [
        10, 11, 12, 13, 15, 16, 18, 20, 22, 24, 27, 30, 33, 36, 39, 43, 47, 51, 56, 62, 68, 75, 82, 91,
    ];
    const E12: [u32; 12] = [10, 12, 15, 18, 22, 27, 33, 39, 47, 56, 68, 82];
    let series = |values: &[u32], unit: f64| -> Vec<f64> {
        let decade = |ten: f64| values.iter().map(move |value| f64::from(*value) * ten * unit);
        [1.0, 10.0, 100.0].into_iter().flat_map(decade).collect()
    };
    let (resistors, capacitors) = (series(&E24, 100.0), series(&E12, 1e-10));
    let wide = Window {
        frequency_tolerance: 0.04,
        quality_tolerance: 0.08,
        ..Window::default()
    };
    let mut designs = Vec::new();
    for &r1 in &resistors {
        for &r2 in &resistors {
            for &c1 in &capacitors {
                for &c2 in &capacitors {
                    let parts = Parts {
                        resistances: [r1, r2],
                        capacitances: [c1, c2],
                    };
                    if is_inside(&parts, &wide, 1.0) {
                        designs.push(parts);
                    }
                }
            }
        }
    }
    designs
}

/// From the coefficients of the transfer function 1 / (1 + a s + b s^2): a = C2 (R1 + R2), b = R1 R2 C1 C2; f0 = 1 / (2 pi sqrt b),
/// Q = sqrt b / a.
fn is_inside(parts: &Parts, window: &Window, share: f64) -> bool {
    let ([r1, r2], [c1, c2]) = (parts.resistances, parts.capacitances);
    let (a, b) = (c2 * r1 + c2 * r2, r1 * c1 * (r2 * c2));
    let between = |value: f64, goal: f64, tolerance: f64| {
        let factor = (share * tolerance).exp();
        goal / factor < value && value < goal * factor
    };
    between(
        b.sqrt(),
        1.0 / (TAU * window.frequency),
        window.frequency_tolerance,
    ) && between(b.sqrt() / a, window.quality, window.quality_tolerance)
}

fn same(a: &Parts, b: &Parts) -> bool {
    let values = |parts: &Parts| [parts.resistances, parts.capacitances].concat();
    values(a)
        .iter()
        .zip(values(b))
        .all(|(a, b)| (a / b - 1.0).abs() < 1e-9)
}

/// The ratio of the largest to the smallest part of a kind, as a logarithm.
fn spread(parts: &Parts) -> f64 {
    let apart = |[a, b]: [f64; 2]| (a / b).ln().abs();
    apart(parts.resistances) + apart(parts.capacitances)
}

/// The designs by behaviour.
fn response(window: &Window, found: &[Parts], missed: &[&Parts], near: &[&Parts]) -> Map {
    let place = |parts: &Parts| (parts.frequency(), parts.quality());
    let corner = |x: f64, y: f64| {
        (
            window.frequency * (x * window.frequency_tolerance).exp(),
            window.quality * (y * window.quality_tolerance).exp(),
        )
    };
    let border = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let (low, high) = (corner(-3.0, -3.0), corner(3.0, 3.0));
    let shown = |parts: &&&Parts| {
        let (x, y) = place(parts);
        (low.0..high.0).contains(&x) && (low.1..high.1).contains(&y)
    };
    let mut layers = vec![
        Layer::points(
            Colour::Grey,
            2.0,
            near.iter().filter(shown).map(|parts| place(parts)).collect(),
        )
        .named("outside the window"),
        Layer::lines(
            Colour::Black,
            1.6,
            vec![border.map(|(x, y)| corner(x, y)).to_vec()],
        )
        .named("window"),
        Layer::points(Colour::Blue, 3.0, found.iter().map(place).collect()).named("feasible, found"),
    ];
    if !missed.is_empty() {
        layers.push(
            Layer::marks(
                Colour::Vermilion,
                4.0,
                Marker::Cross,
                missed.iter().map(|parts| place(parts)).collect(),
            )
            .named("feasible, missed"),
        );
    }
    Map {
        title: "Behaviour (exchanged resistors coincide)".to_owned(),
        x_label: "corner frequency f0 (Hz)".to_owned(),
        y_label: "quality Q".to_owned(),
        x_range: (low.0, high.0),
        y_range: (low.1, high.1),
        layers,
        ..Map::default()
    }
}

/// The designs by parts.
fn parts(found: &[Parts]) -> Map {
    let decades = [
        (1e-9, Colour::Blue, Marker::Disc, "C2 from 1 to 8.2 nF"),
        (1e-8, Colour::Vermilion, Marker::Triangle, "C2 from 10 to 82 nF"),
        (1e-7, Colour::Green, Marker::Square, "C2 from 100 to 820 nF"),
    ];
    let layers = decades.into_iter().filter_map(|(least, colour, marker, name)| {
        let of_decade = found
            .iter()
            .filter(|parts| (0.99 * least..9.9 * least).contains(&parts.capacitances[1]));
        let points: Vec<_> = of_decade
            .map(|parts| (1e-3 * parts.resistances[0], 1e-3 * parts.resistances[1]))
            .collect();
        (!points.is_empty()).then(|| Layer::marks(colour, 3.5, marker, points).named(name))
    });
    Map {
        title: "What they are made of".to_owned(),
        x_label: "R1 (kΩ)".to_owned(),
        y_label: "R2 (kΩ)".to_owned(),
        x_range: (1.0, 300.0),
        y_range: (1.0, 300.0),
        logarithmic: true,
        layers: layers.collect(),
        ..Map::default()
    }
}

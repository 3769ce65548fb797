//! All roots of three systems of equations over contours of the sum of squares, checked against a complete list by
//! interval branch and bound.
//!
//! `cargo run --release -p satisfice-draw --example roots_contour`; writes to `out/roots_contour`, or to the folder `SATISFICE_OUT`.

use std::error::Error;

use satisfice::{Located, SatisficingProblem};
use satisfice_draw::plot::{Colour, Layer, Map, Maps, Shape, draw_maps};
use satisfice_problems::System;

mod gallery;

/// Grid points along an axis.
const GRID: usize = 161;

fn main() -> Result<(), Box<dyn Error>> {
    let systems = [
        ("merlet", "Merlet"),
        ("crossed-sines", "crossed sines"),
        ("waves", "crossing waves"),
    ];
    let mut maps = Maps {
        title: "All roots of three systems of two equations (dots), over contours of F = e₁² + e₂²"
            .to_owned(),
        size: (470.0, 440.0),
        panels: Vec::new(),
    };
    for (name, title) in systems {
        let problem = System::new(name, 1e-5, 0.01)?;
        let count = satisfice::catalogue::Catalogued::reference_hits(&problem).ok_or("a count")?;
        let report = gallery::search(&problem, 1_500_000, count)?;
        let roots: Vec<Vec<f64>> = report
            .hits()
            .map(|hit| hit.solution.coordinates.clone())
            .collect();
        print!(
            "{name}: {} of {count} roots after {} evaluations",
            roots.len(),
            report.counts.evaluations
        );
        check(&problem, &roots);
        let proved = problem.certify(200_000).ok_or("too many boxes")?;
        assert_eq!(proved.len() as u64, count);
        let near = |root: &Vec<f64>| proved.iter().any(|other| distance(root, other) < 1e-6);
        assert!(roots.iter().all(near), "a root that interval arithmetic excludes");
        println!(
            ", each among the {} that interval branch and bound proves to be all",
            proved.len()
        );
        assert_eq!(roots.len() as u64, count, "a root of {name} is missing");
        maps.panels
            .push(map(&problem, format!("{title}: {count} roots"), &roots));
    }
    gallery::save("roots_contour", |format| draw_maps(&maps, format))
}

/// F is tiny at each root, and the roots are distinct.
fn check(problem: &System, roots: &[Vec<f64>]) {
    for (index, root) in roots.iter().enumerate() {
        let f = problem.fitness(&Located::new(root, 0.01));
        assert!(f < 1e-12, "F = {f} at {root:?}");
        assert!(roots[..index].iter().all(|other| distance(root, other) > 0.01));
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b) * (a - b))
        .sum::<f64>()
        .sqrt()
}

fn map(problem: &System, title: String, roots: &[Vec<f64>]) -> Map {
    let axes = problem.space().axes();
    let along = |axis: usize| -> Vec<f64> {
        (0..GRID)
            .map(|k| axes[axis].at(k as f64 / (GRID - 1) as f64))
            .collect()
    };
    let (x, y) = (along(0), along(1));
    let height = |x: f64, y: f64| problem.fitness(&Located::new(&[x, y], 0.01)).max(1e-4).log10();
    let z: Vec<Vec<f64>> = y
        .iter()
        .map(|&y| x.iter().map(|&x| height(x, y)).collect())
        .collect();
    let greatest = z.iter().flatten().fold(f64::NEG_INFINITY, |m, z| m.max(*z));
    let levels = (-12..)
        .map(|k| 0.25 * f64::from(k))
        .take_while(|level| *level < greatest)
        .collect();
    let range = |axis: usize| (axes[axis].lower(), axes[axis].upper());
    let points: Vec<(f64, f64)> = roots.iter().map(|root| (root[0], root[1])).collect();
    let radius = if points.len() > 50 { 2.6 } else { 4.5 };
    Map {
        title,
        x_label: "x".to_owned(),
        y_label: "y".to_owned(),
        x_range: range(0),
        y_range: range(1),
        to_scale: true,
        layers: vec![
            Layer {
                label: Some("log₁₀ F".to_owned()),
                colour: Colour::Black,
                size: 1.0,
                shape: Shape::Contours { x, y, z, levels },
            },
            Layer::points(Colour::White, radius + 1.4, points.clone()),
            Layer::points(Colour::Vermilion, radius, points),
        ],
        ..Map::default()
    }
}

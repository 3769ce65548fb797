//! Motion between two frames: a bullet that passes through a sheet, which neither frame shows, and a pleated cloth that is
//! squeezed. All pairs that touch, the first impact between proved bounds, what a tenth of the time knows, and a picture and
//! a page with the impacts coloured by their time.
//!
//! `cargo run --release --example continuous`

use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;
use std::{env, fs};

use satisfice_collision::continuous::{Moving, MovingContact, Separation, Step, impact};
use satisfice_collision::distance::{PairKind, Threshold, edge_edge};
use satisfice_collision::{Mesh, Placement, generate};
use satisfice_page::{Contact, Feature, FeatureKind, ScenePage};

/// The page shows the step at so many equal parts of it.
const PARTS: u32 = 20;
/// Half the sheet's width, in pixels.
const HALF: f64 = 400.0;

fn main() -> Result<(), Box<dyn Error>> {
    bullet()?;
    cloth()
}

/// A ball that starts above the sheet and ends below it.
fn bullet() -> Result<(), Box<dyn Error>> {
    let sheet = generate::cloth(2.0, 2.0, 41, 41)?;
    let ball = generate::icosphere(0.3, 2)?;
    let place = |z: f64| Placement::from_translation([0.1, -0.2, z])?.place(&ball);
    let (above, below) = (place(1.0)?, place(-1.5)?);
    let mut step = Step::new();
    step.add_rigid(&above, below.vertices())?;
    step.add_rigid(&sheet, sheet.vertices())?;

    let edges = |mesh: &Mesh| -> Vec<_> { mesh.edges().iter().map(|e| e.map(|v| mesh.vertex(v))).collect() };
    let near = Threshold::new(0.1)?;
    for frame in [&above, &below] {
        let (of_ball, of_sheet) = (edges(frame), edges(&sheet));
        let meets = of_ball
            .iter()
            .any(|a| of_sheet.iter().any(|b| edge_edge::within(a, b, near)));
        assert!(!meets, "neither frame shows the collision");
    }
    let first = step.earliest(Separation::TOUCHING, 1e-9)?;
    assert!(first.is_proved && first.time[1] - first.time[0] <= 1e-9);
    println!(
        "bullet: first impact between {:.9} and {:.9} of the step",
        first.time[0], first.time[1]
    );
    println!(
        "        {:.9} of the step is free",
        step.free_step(Separation::TOUCHING)?
    );

    let hits = step.hits(PairKind::EdgeEdge, Separation::TOUCHING)?;
    assert!(!hits.pairs.is_empty() && hits.undecided == 0);
    println!(
        "        {} pairs of edges touch, of {} candidates",
        hits.pairs.len(),
        hits.candidates
    );
    let mut page = ScenePage::new("A bullet through a sheet");
    for (name, mesh) in [("ball", &above), ("sheet", &sheet)] {
        page.body(name, mesh.vertices(), mesh.triangles(), mesh.lines());
    }
    let (mut impacts, mut contacts) = (Vec::new(), Vec::new());
    for MovingContact { a, b } in hits.pairs {
        let ends = |mesh: &Mesh, e: u32| mesh.edges()[e as usize].map(|v| mesh.vertex(v));
        let moving = Moving::new(ends(&above, a.index), ends(&below, a.index));
        let still = Moving::at_rest(ends(&sheet, b.index));
        let impact =
            impact(&moving, &still, Separation::TOUCHING, 1e-6)?.ok_or("a pair that touches has a time")?;
        assert!(
            impact.time[1] >= first.time[0],
            "no pair is before the first impact"
        );
        impacts.push((impact.time[0], impact.point_b));
        let kind = FeatureKind::Edge;
        let features = [(0, a.index), (1, b.index)].map(|(body, number)| Feature { body, kind, number });
        let contact = Contact::new(features, [impact.point_a, impact.point_b]).impact(impact.time[0]);
        contacts.push((impact.time[0], contact));
    }
    for part in 0..=PARTS {
        let time = f64::from(part) / f64::from(PARTS);
        page.frame(format!("{time:.2} of the step"));
        let ends = above.vertices().iter().zip(below.vertices());
        let now = ends.map(|(from, to)| std::array::from_fn(|k| from[k] + time * (to[k] - from[k])));
        page.move_body(0, &now.collect::<Vec<_>>())?;
        let so_far = contacts.iter().filter(|(impact, _)| *impact <= time);
        so_far.for_each(|(_, contact)| page.contact(*contact));
        page.counts(None, Some(contacts.len() as u64));
    }
    write("continuous.html", &page.html()?)?;
    write("continuous.svg", &picture(&sheet, &impacts)?)
}

/// One step of a cloth with itself, whole and in a tenth of the time.
#[expect(clippy::disallowed_methods, reason = "an example that shows times")]
fn cloth() -> Result<(), Box<dyn Error>> {
    let quick = env::var_os("SATISFICE_QUICK").is_some_and(|value| value != "0");
    let (columns, rows) = if quick { (61, 11) } else { (241, 41) };
    let from = generate::pleats(columns, rows, 5, 0.05, 0.0)?;
    // Squeezed to a third of its height, each layer with a wave of its own, so that layers pass through each other.
    let squeezed = |&[x, y, z]: &[f64; 3]| [x, y, 0.3 * z + 0.03 * (7.0 * x + 40.0 * z).sin()];
    let to: Vec<_> = from.vertices().iter().map(squeezed).collect();
    let mut step = Step::new();
    step.add_deforming(&from, &to)?;
    let start = Instant::now();
    for kind in [PairKind::VertexTriangle, PairKind::EdgeEdge] {
        let hits = step.hits(kind, Separation::TOUCHING)?;
        println!(
            "cloth:  {kind}: {} pairs touch, of {} candidates; integers decided {}",
            hits.pairs.len(),
            hits.candidates,
            hits.by_integers
        );
    }
    println!("        in {:.1} ms", start.elapsed().as_secs_f64() * 1e3);
    let start = Instant::now();
    let whole = step.earliest(Separation::TOUCHING, 1e-6)?;
    let all = start.elapsed();
    let start = Instant::now();
    let hurried = step.earliest_until(Separation::TOUCHING, 1e-6, &mut || start.elapsed() > all / 10)?;
    println!(
        "        first impact in {:?}, found in {:.1} ms",
        whole.time,
        all.as_secs_f64() * 1e3
    );
    println!(
        "        in a tenth of that it is known to lie in {:?}",
        hurried.time
    );
    assert!(whole.is_proved && whole.first.is_some());
    assert!(hurried.time[0] <= whole.time[1] && whole.time[0] <= hurried.time[1]);
    Ok(())
}

/// The sheet from above; an impact is a dot from blue (the first) to red (the last).
fn picture(sheet: &Mesh, impacts: &[(f64, [f64; 3])]) -> Result<String, Box<dyn Error>> {
    let pixel = |x: f64| HALF * (1.0 + x);
    let size = 2.0 * HALF;
    let mut svg = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size} {size}"><rect width="{size}" height="{size}" fill="white"/>"##
    );
    for &[a, b] in sheet.edges() {
        let ([x, y, _], [u, v, _]) = (sheet.vertex(a), sheet.vertex(b));
        write!(
            svg,
            r##"<line x1="{:.1}" y1="{:.1}" x2="{:.1}" y2="{:.1}" stroke="#ddd"/>"##,
            pixel(x),
            pixel(-y),
            pixel(u),
            pixel(-v)
        )?;
    }
    let times = impacts.iter().map(|(time, _)| *time);
    let (first, last) = times.fold((1.0_f64, 0.0_f64), |(low, high), t| (low.min(t), high.max(t)));
    for (time, [x, y, _]) in impacts {
        let share = (time - first) / (last - first).max(f64::MIN_POSITIVE);
        let (red, blue) = ((255.0 * share) as u8, (255.0 * (1.0 - share)) as u8);
        write!(
            svg,
            r#"<circle cx="{:.1}" cy="{:.1}" r="2.5" fill="rgb({red},40,{blue})"/>"#,
            pixel(*x),
            pixel(-y)
        )?;
    }
    svg.push_str("</svg>\n");
    Ok(svg)
}

/// Writes into `out/continuous`, or the folder in `SATISFICE_OUT`.
fn write(name: &str, text: &str) -> Result<(), Box<dyn Error>> {
    let folder = env::var_os("SATISFICE_OUT").map_or_else(|| PathBuf::from("out/continuous"), PathBuf::from);
    fs::create_dir_all(&folder)?;
    let path = folder.join(name);
    fs::write(&path, text)?;
    println!("        wrote {}", path.display());
    Ok(())
}

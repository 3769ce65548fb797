//! Postures that bring an arm's hand to its goal, drawn: all postures of a planar arm of three links, and many of an arm with seven joints.
//!
//! `cargo run --release -p satisfice-draw --example arm_configurations`; writes to `out/arm_configurations`, or to the folder `SATISFICE_OUT`.

use std::error::Error;
use std::f64::consts::TAU;

use satisfice::SatisficingProblem;
use satisfice::catalogue::Catalogued;
use satisfice_draw::plot::{Colour, Layer, Map, Maps, Marker, draw_maps};
use satisfice_problems::{Arm, SevenJoints};

mod gallery;

/// Cells for each angle of the planar arm, and the largest distance of its tip from the goal, in arm lengths.
const CELLS: usize = 100;
const NEAR: f64 = 0.01;
/// Number of seven-joint postures that are drawn; more would hide each other.
const DRAWN: usize = 40;
const GOAL: [f64; 3] = [0.45, 0.2, 0.5];

type Line = Vec<(f64, f64)>;

fn main() -> Result<(), Box<dyn Error>> {
    let arm = Arm::new(3, CELLS, NEAR)?;
    let count = postures_of_three_links(arm.goal());
    let report = gallery::search(&arm, 500_000, count)?;
    println!("{report}");
    let postures: Vec<Vec<[f64; 2]>> = report.hits().map(|hit| arm.joints(hit.solution)).collect();
    for posture in &postures {
        let [x, y] = posture[posture.len() - 1];
        assert!(
            (x - arm.goal()[0]).hypot(y - arm.goal()[1]) < NEAR,
            "a tip away from its goal"
        );
    }
    println!(
        "three links: {} of the {count} postures that an enumeration finds\n",
        postures.len()
    );
    assert_eq!(postures.len() as u64, count);

    let seven = SevenJoints::from_params(&satisfice::catalogue::Params::defaults(SevenJoints::PARAMETERS)?)?;
    let known = seven.reference_hits().ok_or("a count")?;
    let report = gallery::search(&seven, 500_000, known)?;
    println!("{report}");
    let bodies: Vec<Vec<[f64; 3]>> = report
        .hits()
        .map(|hit| {
            assert!(seven.fitness(hit.solution) < seven.threshold());
            [vec![[0.0; 3]], seven.joints(hit.solution)].concat()
        })
        .collect();
    for body in &bodies {
        let tool = body[body.len() - 1];
        let square: f64 = tool.iter().zip(GOAL).map(|(a, b)| (a - b) * (a - b)).sum();
        assert!(square.sqrt() < 0.03, "a tool away from its goal");
    }
    println!(
        "seven joints: {} of the {known} postures that an enumeration finds\n",
        bodies.len()
    );
    assert!(bodies.len() as u64 <= known && bodies.len() >= DRAWN);

    let maps = Maps {
        title: "Postures of arms whose hand is at its goal".to_owned(),
        size: (560.0, 440.0),
        panels: vec![
            planar(&arm, &postures),
            spatial(&bodies, 2, "from the side", "z (m)"),
            spatial(&bodies, 1, "from above", "y (m)"),
        ],
    };
    gallery::save("arm_configurations", |format| draw_maps(&maps, format))
}

/// The referee: for each pair of the first two angles, the third angle follows from the direction to the goal; cells
/// beside it are checked too.
fn postures_of_three_links(goal: [f64; 2]) -> u64 {
    let centre = |cell: usize| TAU * (cell as f64 + 0.5) / CELLS as f64 - 0.5 * TAU;
    let mut count = 0;
    for first in 0..CELLS {
        for second in 0..CELLS {
            let (a, b) = (centre(first), centre(first) + centre(second));
            let left = [
                3.0 * goal[0] - a.cos() - b.cos(),
                3.0 * goal[1] - a.sin() - b.sin(),
            ];
            // A link of length 1 reaches the goal to within 3 NEAR or not at all.
            if (left[0].hypot(left[1]) - 1.0).abs() >= 3.0 * NEAR {
                continue;
            }
            let wanted = left[1].atan2(left[0]);
            let misses = |third: &usize| {
                let c = b + centre(*third);
                // The chord of the angle between the link and the direction to the goal.
                let chord = 2.0 * (0.5 * (c - wanted)).sin();
                let length = left[0].hypot(left[1]);
                // Law of cosines, from lengths 1 and `length`.
                ((length - 1.0) * (length - 1.0) + length * chord * chord).sqrt() >= 3.0 * NEAR
            };
            count += (0..CELLS).filter(|third| !misses(third)).count() as u64;
        }
    }
    count
}

fn planar(arm: &Arm, postures: &[Vec<[f64; 2]>]) -> Map {
    let line = |posture: &Vec<[f64; 2]>| -> Line { posture.iter().map(|&[x, y]| (x, y)).collect() };
    // The second joint bends to one side or the other.
    let side = |posture: &Vec<[f64; 2]>| {
        let [_, a, b, ..] = posture[..] else { return false };
        a[0] * (b[1] - a[1]) - a[1] * (b[0] - a[0]) > 0.0
    };
    let (left, right): (Vec<_>, Vec<_>) = postures.iter().partition(|posture| side(posture));
    let joints = |postures: &[&Vec<[f64; 2]>]| -> Line {
        postures
            .iter()
            .flat_map(|posture| posture[1..3].iter().map(|&[x, y]| (x, y)))
            .collect()
    };
    let [x, y] = arm.goal();
    let lines = |postures: &[&Vec<[f64; 2]>]| postures.iter().map(|posture| line(posture)).collect();
    Map {
        title: format!("planar, 3 links: all {} postures", postures.len()),
        x_label: "x (arm lengths)".to_owned(),
        y_label: "y (arm lengths)".to_owned(),
        x_range: (-0.4, 0.8),
        y_range: (-0.5, 0.7),
        to_scale: true,
        layers: vec![
            Layer::lines(Colour::Sky, 0.7, lines(&left)).named("elbow to the left"),
            Layer::lines(Colour::Orange, 0.7, lines(&right)).named("elbow to the right"),
            Layer::points(Colour::Blue, 1.8, joints(&left)),
            Layer::points(Colour::Vermilion, 1.8, joints(&right)),
            Layer::marks(Colour::Black, 6.0, Marker::Square, vec![(0.0, 0.0)]).named("base"),
            Layer::points(Colour::Black, 6.0, vec![(x, y)]).named("goal"),
        ],
        ..Map::default()
    }
}

/// The seven-joint arms: x to the right, the axis of this number upwards.
fn spatial(bodies: &[Vec<[f64; 3]>], up: usize, from: &str, y_label: &str) -> Map {
    let step = bodies.len() / DRAWN;
    let drawn: Vec<&Vec<[f64; 3]>> = bodies.iter().step_by(step.max(1)).take(DRAWN).collect();
    let flat = |place: &[f64; 3]| (place[0], place[up]);
    let joints = |number: usize| drawn.iter().map(|body| flat(&body[number])).collect::<Line>();
    let part = |from: usize, to: usize| -> Vec<Line> {
        drawn
            .iter()
            .map(|body| body[from..=to].iter().map(flat).collect())
            .collect()
    };
    Map {
        title: format!("seven joints {from}: {DRAWN} of {} postures drawn", bodies.len()),
        x_label: "x (m)".to_owned(),
        y_label: y_label.to_owned(),
        x_range: (-0.4, 0.8),
        y_range: if up == 2 { (-0.1, 1.1) } else { (-0.6, 0.6) },
        to_scale: true,
        layers: vec![
            Layer::lines(Colour::Sky, 1.0, part(1, 2)).named("upper arm"),
            Layer::lines(Colour::Orange, 1.0, part(2, 3)).named("forearm"),
            Layer::lines(Colour::Green, 1.0, part(3, 5)).named("hand and tool"),
            Layer::lines(Colour::Black, 2.0, part(0, 1)[..1].to_vec()).named("base"),
            Layer::points(Colour::Blue, 2.4, joints(2)).named("elbow"),
            Layer::points(Colour::Vermilion, 2.4, joints(3)).named("wrist"),
            Layer::points(Colour::Black, 6.0, vec![flat(&GOAL)]).named("goal"),
        ],
        ..Map::default()
    }
}

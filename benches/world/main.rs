//! Worlds of many bodies: time a frame and memory, against parry3d's `Bvh` over the boxes of the bodies and rapier3d's broad phase.
//!
//! `cargo bench --bench world` runs everything and writes `docs/results/worlds.md`; started as a test it runs 300 bodies for three
//! frames and writes nothing. A word after `--` runs the scenes whose names contain it, a number those of that many bodies, `first`
//! the first frames, and writes nothing.

mod first;
#[path = "../machine.rs"]
mod machine;
mod measure;
#[path = "../page.rs"]
mod page;
mod peers;
mod rapier;
mod scenes;

use first::{FirstRow, first_frame};
use measure::{Row, measure};
use scenes::Scene;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let full = arguments.iter().any(|argument| argument == "--bench");
    let words: Vec<&String> = arguments
        .iter()
        .filter(|argument| !argument.starts_with("--"))
        .collect();
    let sizes: &[usize] = if full { &[1_000, 10_000, 100_000] } else { &[300] };
    let mut report = Report::default();
    report.line("# Worlds of many bodies");
    report.line("");
    report.line(&machine::line());
    report.line("");
    report.line(INTRODUCTION);
    for &bodies in sizes {
        report.line("");
        report.line(&format!("## {bodies} bodies"));
        report.line("");
        report.line(Row::HEADING);
        for scene in Scene::all(bodies) {
            let is_wanted = |word: &&String| match word.parse::<usize>() {
                Ok(number) => bodies == number,
                Err(_) => scene.name.contains(word.as_str()),
            };
            if words.iter().all(is_wanted) {
                let frames = if full { scenes::frames(bodies) } else { 3 };
                report.line(&measure(&scene, frames).to_string());
            }
        }
    }
    if words.is_empty() || words == ["first"] {
        let bodies = if full { 10_000 } else { 300 };
        report.line("");
        report.line(&format!("## First frame of {bodies} bodies"));
        report.line("");
        report.line(FIRST);
        report.line("");
        report.line(FirstRow::HEADING);
        // the lattices differ in what moves later
        for scene in Scene::all(bodies).iter().filter(|scene| scene.triangles) {
            let is_again = scene.name.starts_with("lattice") && scene.every > 0;
            if !is_again {
                report.line(&first_frame(scene).to_string());
            }
        }
    }
    if full && words.is_empty() {
        report.save();
    }
}

const INTRODUCTION: &str = "Spheres of 80 triangles and radius 0.4 that share one mesh; pairs of triangles within 0.01; one thread, \
    release build. Every moving body has a step of up to 0.005 along each axis; directions turn every eight frames. All methods \
    follow the same motion in one run, one after the other in every frame; times are medians over the frames, in milliseconds of processor time, less what two readings of the clock take.

- *bodies ms*: placing what moves and finding the pairs of bodies whose boxes meet (`World::place`, or `World::translate` where nothing turns, and a query of an empty region).
- *worst*: the slowest of these frames, divided by *new*, the time of a world made anew (adding all bodies and finding the pairs).
- *triangles ms*: the contacts of these pairs (`World::update` after that).
- *parry kept*: what rapier3d's broad phase does. `Bvh::insert_or_update_partially` with a margin of 0.02 for what moves, \
`optimize_incremental`, `refit`, `traverse_bvtt_single_tree` with change detection into a table of pairs, from which those are \
taken whose boxes are apart now, so that it is known, as in a world, which pairs there are, begin and end. Nothing is called in a frame in which nothing moves. *parry new*: `Bvh::from_iter` (binned) and a traversal. Boxes are `f32` and are \
given; ours are computed from the placement in `f64`. *ratio*: the faster one, divided by *bodies ms*.
- *parry boxes*: what it takes to compute the boxes that parry is given: `Aabb::transform_by` of the box of the mesh by a `Pose` in `f32`, as a collider with a mesh \
has it, for what moves. *ratio with them*: *parry boxes* and the faster one of parry, divided by *bodies ms*.
- *rapier*: rapier3d's own broad phase, `BroadPhaseBvh::update` with its defaults, after `Collider::set_position` of what moves; colliders \
without bodies, boxes of the size of the meshes, prediction distance .01. It computes the boxes that it needs. Nothing is called in a frame in which nothing moves. *ratio to it*: *rapier* divided by *bodies ms*.
- *bytes a body*: `World::bytes` beside meshes, of a scene of the same motion without pairs where there are many; *a pair*: what is \
left, divided by the kept pairs.

Written by `cargo bench --bench world`.";

const FIRST: &str = "Everything from bodies to contacts: `World::add` of all and `World::update`, beside the boxes, `Bvh::from_iter` and its pairs, \
and for each pair `Bvh::leaf_pairs` of two trees over the triangles and `query::distance` of those whose boxes meet, in `f32`. Trees over triangles are built \
within the time, one a mesh. *ratio*: parry divided by world. Alone: `cargo bench --bench world -- first`.";

/// What is printed, and kept for the file.
#[derive(Default)]
struct Report {
    text: String,
}

impl Report {
    fn line(&mut self, line: &str) {
        println!("{line}");
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn save(&self) {
        page::save("worlds.md", &self.text);
    }
}

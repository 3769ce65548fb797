//! Time against error of every way to find what is within a threshold, ours and theirs, in one run on one machine.
//!
//! `cargo bench --bench collision` runs everything and writes `docs/results/collision.md`; started as a test it runs small
//! sizes once and writes nothing. `SATISFICE_DATA` may name a folder with `cloth_ball92.ply`, `cloth_ball93.ply` and
//! `bunny.obj`; without it those scenes are replaced or skipped, and the output says so. A word after `--` runs the groups of
//! that name only (points, kept, deforming, triangles, budget, deadline) and writes nothing.

mod budget;
mod deadline;
mod deforming;
#[path = "../machine.rs"]
mod machine;
#[path = "../page.rs"]
mod page;
mod peers;
mod plain_grid;
mod points;
mod scenes;
mod table;
mod triangles;

use table::Report;

fn main() {
    // rayon's own pool is this thread alone, so that nobody uses more by the way; "all threads" brings its own pool
    rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build_global()
        .expect("the first pool");
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let full = arguments.iter().any(|argument| argument == "--bench");
    let only = arguments.iter().find(|argument| !argument.starts_with("--"));
    let mut report = Report::new(full);
    let wanted = |name: &str| only.is_none_or(|only| name.contains(only.as_str()));
    if wanted("points") {
        points::fresh(&mut report);
    }
    if wanted("kept") {
        points::kept(&mut report);
    }
    if wanted("deforming") {
        deforming::run(&mut report);
    }
    if wanted("triangles") {
        triangles::run(&mut report);
    }
    if wanted("budget") {
        budget::run(&mut report);
    }
    if wanted("deadline") {
        deadline::run(&mut report);
    }
    if full && only.is_none() {
        report.save();
    }
}

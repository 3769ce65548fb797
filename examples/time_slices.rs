//! Time slices: a teapot moves through another, and every frame is searched for a fixed number of evaluations. How much do
//! the hits of the last frame help?
//!
//! `cargo run --release --example time_slices`

mod moving_teapots;

use std::env;
use std::error::Error;

use moving_teapots::{MovingTeapots, Way};
use satisfice::WarmStart;

const EVALUATIONS: u64 = 20_000;
const FRAMES: usize = 10;
/// Motion a frame, in sizes; delta is 0.02.
const STEP: f64 = 0.004;
const RULES: [(WarmStart, &str); 3] = [
    (WarmStart::Cold, "cold"),
    (WarmStart::Engine, "engine's rule"),
    (WarmStart::Verify, "verify"),
];

fn main() -> Result<(), Box<dyn Error>> {
    let quick = env::var_os("SATISFICE_QUICK").is_some_and(|value| value != "0");
    let seeds: u64 = if quick { 1 } else { 8 };
    let scene = MovingTeapots::new(FRAMES, STEP, Way::Towards)?;
    println!(
        "{FRAMES} frames, {EVALUATIONS} evaluations each, recall in %, mean of {seeds} seeds; the second teapot moves by {STEP} sizes a \
         frame.\n`kept`: share of a frame's hits that were hits in the frame before.\n\
         cold: nothing is kept. engine's rule: what the engine itself does with the last hits (the swarm starts from them).\n\
         verify: all of the last hits are evaluated anew before the engine goes on.\n"
    );
    for name in ["latest-hit-qpso", "descent-flood", "portfolio"] {
        let mut recalls = Vec::new();
        for (rule, _) in RULES {
            recalls.push(scene.recalls((name, &[]), rule, EVALUATIONS, seeds)?);
        }
        println!(
            "{name}\n  frame   hits   kept {:>10} {:>15} {:>10}",
            RULES[0].1, RULES[1].1, RULES[2].1
        );
        for (frame, cold) in recalls[0].iter().enumerate() {
            println!(
                "  {frame:>5} {:>6} {:>5.0}% {:>10.1} {:>15.1} {:>10.1}",
                scene.hits(frame),
                100.0 * scene.kept(frame),
                cold,
                recalls[1][frame],
                recalls[2][frame],
            );
        }
        let means: Vec<f64> = recalls
            .iter()
            .map(|rule| rule[1..].iter().sum::<f64>() / (FRAMES - 1) as f64)
            .collect();
        println!(
            "   mean from frame 1 {:>10.1} {:>15.1} {:>10.1}\n",
            means[0], means[1], means[2]
        );
        // All rules do the same in the first frame, which has no predecessor.
        assert!(
            recalls.iter().all(|rule| rule[0] == recalls[0][0]),
            "{name}: frame 0 differs between rules"
        );
        if name == "latest-hit-qpso" {
            assert!(
                means[2] > means[0],
                "{name}: the last hits were of no use, {} and {}",
                means[2],
                means[0]
            );
        }
    }
    Ok(())
}

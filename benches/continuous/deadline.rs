//! What a deadline leaves of the pairs that hit.
#![expect(clippy::disallowed_methods, reason = "a bench asks the time")]

use std::time::{Duration, Instant};

use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use satisfice::{Budget, Search};
use satisfice_collision::continuous::{Moving, MovingPairs, Separation, Step, touches};
use satisfice_collision::distance::PairKind;

use crate::Report;
use crate::frames::{self, Scene};

const DEADLINES: [u64; 3] = [1, 10, 100];

/// The pairs of edges whose swept boxes meet, by index, as a broad phase lists them.
fn candidates(scene: &Scene) -> Vec<(u32, u32)> {
    let (mesh, to, _) = scene.mesh();
    let from = mesh.vertices();
    let swept = mesh.edges().iter().map(|edge| {
        let points = edge.map(|v| [from[v as usize], to[v as usize]]).concat();
        let least = |k: usize| points.iter().fold(f64::INFINITY, |least, p| least.min(p[k])) as f32;
        let most = |k: usize| points.iter().fold(f64::NEG_INFINITY, |most, p| most.max(p[k])) as f32;
        let lower: [f32; 3] = std::array::from_fn(|k| least(k).next_down());
        let upper: [f32; 3] = std::array::from_fn(|k| most(k).next_up());
        Aabb::new(
            Vector::new(lower[0], lower[1], lower[2]),
            Vector::new(upper[0], upper[1], upper[2]),
        )
    });
    let tree = Bvh::from_iter(BvhBuildStrategy::Binned, swept.enumerate());
    let mut pairs = Vec::new();
    tree.traverse_bvtt_single_tree::<false>(&mut BvhWorkspace::default(), &mut |a, b| {
        let [p, q] = [a, b].map(|e| mesh.edges()[e as usize]);
        if !p.iter().any(|v| q.contains(v)) {
            pairs.push((a.min(b), a.max(b)));
        }
    });
    pairs.sort_unstable();
    pairs
}

/// One by one, in the order of their indices; the list is there when the clock starts.
fn by_index(scene: &Scene, candidates: &[(u32, u32)], time: Duration) -> usize {
    let (mesh, to, _) = scene.mesh();
    let from = mesh.vertices();
    let edge = |e: u32| {
        let corners = mesh.edges()[e as usize];
        Moving::new(corners.map(|v| from[v as usize]), corners.map(|v| to[v as usize]))
    };
    let end = Instant::now() + time;
    let mut found = 0;
    for few in candidates.chunks(64) {
        found += few.iter().filter(|&&(a, b)| touches(&edge(a), &edge(b))).count();
        if Instant::now() >= end {
            break;
        }
    }
    found
}

/// The frame's own search, trees ready.
fn by_frame(step: &Step, time: Duration) -> usize {
    let end = Instant::now() + time;
    let mut found = 0;
    step.each_hit(
        PairKind::EdgeEdge,
        Separation::TOUCHING,
        &mut || Instant::now() >= end,
        &mut |_| found += 1,
    )
    .expect("a kind in motion");
    found
}

/// An engine on all pairs as a problem.
fn by_engine(problem: &MovingPairs<'_>, name: Option<&str>, time: Duration) -> usize {
    let mut search = name.map_or_else(Search::new, |name| Search::named(name).expect("an engine"));
    let report = search.run(problem, &Budget::time(time)).expect("a search");
    report.hits().len()
}

pub(crate) fn run(report: &mut Report) {
    report.heading("Pairs of edges that touch, under a deadline");
    let scene = frames::cloth_ball().filter(|_| report.full);
    let scene = scene.unwrap_or_else(|| frames::pleats(report.full));
    let candidates = candidates(&scene);
    let step = scene.step();
    let all = step
        .hits(PairKind::EdgeEdge, Separation::TOUCHING)
        .expect("a kind in motion")
        .pairs
        .len();
    report.line(&format!(
        "{}: {all} of {} pairs of edges whose swept boxes meet. Index order asks about them one by one, the list known beforehand; the \
         frame's search knows no list, its trees are ready; engines see all pairs as a problem. Share found in %, median of runs in \
         turns.\n",
        scene.name,
        candidates.len()
    ));
    report.line(
        "| deadline | index order | frame's search | times index order | branch-and-bound | default engine |",
    );
    report.line("|---|---|---|---|---|---|");
    let problem = MovingPairs::new(&step, PairKind::EdgeEdge, Separation::TOUCHING).expect("edges");
    let rounds = if report.full { 7 } else { 1 };
    for ms in DEADLINES {
        let time = Duration::from_millis(ms);
        let mut found: [Vec<usize>; 4] = Default::default();
        for round in 0..rounds {
            found[0].push(by_index(&scene, &candidates, time));
            found[1].push(by_frame(&step, time));
            if round < 3 {
                found[2].push(by_engine(&problem, Some("branch-and-bound"), time));
                found[3].push(by_engine(&problem, None, time));
            }
        }
        let [index, frame, bounds, default] = found.map(|mut counts| {
            counts.sort_unstable();
            counts[counts.len() / 2] as f64 / all.max(1) as f64 * 100.0
        });
        let ratio = if index > 0.0 {
            format!("{:.1}", frame / index)
        } else {
            "-".to_owned()
        };
        report.line(&format!(
            "| {ms} ms | {index:.2} | {frame:.2} | {ratio} | {bounds:.2} | {default:.2} |"
        ));
    }
}

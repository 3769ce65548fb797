//! Self-pairs of a deforming body, frame by frame.
use satisfice_collision::FeatureKind;
use satisfice_collision::broad::{FeatureTree, PointGrid, TreeJoin};
use satisfice_collision::distance::Threshold;

use crate::points::plain;
use crate::table::{Frame, Method, Report, all_threads, least};
use crate::{peers, plain_grid, scenes};

/// The structure is built on the first frame; timed is the step to the second.
pub(crate) fn run(report: &mut Report) {
    report.heading("Self-pairs of a deforming body");
    let frames = (scenes::data("cloth_ball92.ply"), scenes::data("cloth_ball93.ply"));
    let (name, first, second, deltas) = if let (true, (Some(first), Some(second))) = (report.full, frames) {
        ("cloth-ball, frame 92 to 93", first, second, vec![0.05, 0.1])
    } else {
        report.line("The cloth-ball is not at hand (SATISFICE_DATA); a folded sheet stands in for it.");
        report.line("");
        let side = if report.full { 215 } else { 24 };
        let deltas = if report.full { vec![0.05, 0.1] } else { vec![0.4] };
        (
            "folded sheet",
            scenes::sheet(side, 0.0),
            scenes::sheet(side, 0.3),
            deltas,
        )
    };
    let pool = all_threads();
    for delta in deltas {
        let threshold = Threshold::new(delta).expect("a positive threshold");
        let next = second.vertices();
        let (mut one, mut many) = (PointGrid::new(), pool.install(PointGrid::parallel));
        let truth = plain(one.within(next, threshold).expect("finite points"));
        let mut tree = FeatureTree::new(&first, FeatureKind::Vertex);
        let mut join = TreeJoin::new();
        tree.refit(next).expect("finite points");
        assert!(
            plain(join.within(&tree, threshold, None)) == truth,
            "the tree agrees with the grid"
        );
        let (before, after, r) = (peers::single(first.vertices()), peers::single(next), delta as f32);
        let mut parry = peers::parry_tree(&before, r / 2.0);
        // only the step to the second frame is timed: the frames differ in what they cost
        let of = |frame| usize::from(frame == Frame::Before);
        let frames = [next, first.vertices()];
        let single = [&after, &before];
        let methods = vec![
            Method::moving("ours: grid, rebuilt", |frame| {
                plain(one.within(frames[of(frame)], threshold).expect("finite points"))
            }),
            Method::moving("ours: grid, rebuilt, all threads", |frame| {
                plain(pool.install(|| many.within(frames[of(frame)], threshold).expect("finite points")))
            }),
            Method::moving("ours: tree, refitted", |frame| {
                tree.refit(frames[of(frame)]).expect("finite points");
                plain(join.within(&tree, threshold, None))
            }),
            Method::moving("plain grid f32, rebuilt", |frame| {
                plain_grid::within(single[of(frame)], r)
            }),
            Method::moving("parry f32: update, refit, traverse", |frame| {
                peers::parry_refit(&mut parry, single[of(frame)], r)
            }),
        ];
        let scene = format!("{name}, {} vertices, r = {delta}", next.len());
        let times = report.compare(&scene, &truth, methods);
        let ours = if times[0].warm < times[2].warm {
            times[0]
        } else {
            times[2]
        };
        report.line(&format!(
            "Better of parry and plain grid / better of ours {}; one thread / all threads {:.2}.",
            least(times[3].ratios(ours), times[4].ratios(ours)),
            times[0].warm / times[1].warm
        ));
        report.line("");
    }
}

//! Pairs of points of two bodies: structure built each frame, and structure kept.
use std::sync::Mutex;

use satisfice_collision::FeatureKind;
use satisfice_collision::broad::{FeatureTree, Pair, PointGrid, TreeJoin};
use satisfice_collision::distance::Threshold;
use satisfice_collision::{Mesh, Placement};

use crate::table::{Method, Pairs, Report, all_threads, least, time};
use crate::{peers, plain_grid, scenes};

pub(crate) fn plain(pairs: &[Pair]) -> Pairs {
    pairs.iter().map(|pair| (pair.a, pair.b)).collect()
}

pub(crate) fn point_tree(points: &[[f64; 3]]) -> FeatureTree {
    FeatureTree::new(
        &Mesh::new(points.to_vec(), vec![], vec![]).expect("finite points"),
        FeatureKind::Vertex,
    )
}

fn brute(a: &[[f32; 3]], b: &[[f32; 3]], r: f32) -> Pairs {
    let mut pairs = Pairs::new();
    for (i, p) in a.iter().enumerate() {
        for (j, q) in b.iter().enumerate() {
            if (0..3).map(|k| (p[k] - q[k]) * (p[k] - q[k])).sum::<f32>() < r * r {
                pairs.push((i as u32, j as u32));
            }
        }
    }
    pairs
}

/// The grid and the trees have to agree before anything is timed.
fn truth(scene: &scenes::Pair, trees: &[FeatureTree; 2], threshold: Threshold) -> Pairs {
    let rest = &Placement::IDENTITY;
    let mut join = TreeJoin::new();
    let by_tree = join
        .between((&trees[0], rest), (&trees[1], rest), threshold, None)
        .expect("finite points");
    let mut grid = PointGrid::new();
    let by_grid = grid
        .between(&scene.a, &scene.b, threshold)
        .expect("finite points");
    assert!(by_tree == by_grid, "{}", scene.name);
    plain(by_grid)
}

/// What no method can do without: reading the coordinates once, and how much faster that is on all threads.
fn reading(report: &mut Report, pool: &rayon::ThreadPool, bodies: [&[[f64; 3]]; 2]) {
    fn sum(points: &[[f64; 3]]) -> f64 {
        let (chunks, rest) = points.as_flattened().as_chunks::<32>();
        let mut sums = [0.0; 32];
        for chunk in chunks {
            sums.iter_mut().zip(chunk).for_each(|(sum, c)| *sum += c);
        }
        sums.iter().chain(rest).sum()
    }
    let rounds = if report.full { 31 } else { 1 };
    let mut times = [const { Vec::new() }; 2];
    for _ in 0..rounds {
        let (one, _) = time(|| std::hint::black_box(bodies.map(sum)));
        let (all, _) = time(|| {
            pool.install(|| {
                use rayon::prelude::*;
                let parts = bodies.par_iter().flat_map(|body| body.par_chunks(1 << 16));
                std::hint::black_box(parts.map(sum).sum::<f64>())
            })
        });
        times[0].push(one);
        times[1].push(all);
    }
    let [one, all] = times.map(median);
    report.line(&format!(
        "Reading the coordinates alone: {:.2} ms, by all threads {:.2}; one thread / all threads {:.2} (least {:.2}).",
        one.0,
        all.0,
        one.0 / all.0,
        one.1 / all.1
    ));
    report.line("");
}

/// One thread, all of them together, and all of them at once, each for itself on points of its own: these share the memory
/// only, so that this is what threads can gain at most on this machine. Without other methods in between, during which the
/// other cores fall asleep.
fn threads_alone(report: &mut Report, pool: &rayon::ThreadPool, scene: &scenes::Pair, threshold: Threshold) {
    let threads = pool.current_num_threads();
    let own: Vec<_> = (0..threads)
        .map(|_| Mutex::new((PointGrid::new(), scene.a.clone(), scene.b.clone())))
        .collect();
    let work = |thread: usize| {
        let (grid, a, b) = &mut *own[thread].lock().expect("nobody panics");
        grid.between(a, b, threshold).expect("finite points").len()
    };
    let mut together = pool.install(PointGrid::parallel);
    let mut share = || {
        let pairs = together.between(&scene.a, &scene.b, threshold);
        pairs.expect("finite points").len()
    };
    let rounds = if report.full { 25 } else { 1 };
    let mut times = [const { Vec::new() }; 3];
    for _ in 0..rounds {
        times[0].push(time(|| work(0)).0);
        times[1].push(time(|| pool.install(&mut share)).0);
        times[2].push(time(|| pool.broadcast(|context| work(context.index()))).0);
    }
    let [one, all, each] = times.map(median);
    let most = [one.0 / each.0, one.1 / each.1].map(|ratio| threads as f64 * ratio);
    report.line(&format!(
        "Without other methods in between: one thread {:.2} ms, {threads} together {:.2}, which is {:.2} times as fast (least {:.2}); \
         {threads} at once, each for itself, {:.2}, so that this machine does at most {:.2} times the work of one thread (least {:.2}).",
        one.0,
        all.0,
        one.0 / all.0,
        one.1 / all.1,
        each.0,
        most[0],
        most[1]
    ));
    report.line("");
}

/// The median of some times, and the least.
fn median(mut times: Vec<f64>) -> (f64, f64) {
    times.sort_by(f64::total_cmp);
    (times[times.len() / 2], times[0])
}

/// Structure built each frame.
pub(crate) fn fresh(report: &mut Report) {
    report.heading("Pairs of points, structure built each frame");
    let pool = all_threads();
    for scene in scenes::points(report.full) {
        let scenes::Pair {
            name,
            a,
            b,
            delta,
            small,
        } = &scene;
        let threshold = Threshold::new(*delta).expect("a positive threshold");
        let truth = truth(&scene, &[point_tree(a), point_tree(b)], threshold);
        let (fa, fb, r) = (peers::single(a), peers::single(b), *delta as f32);
        let (mut one, mut many) = (PointGrid::new(), pool.install(PointGrid::parallel));
        let mut rounded = [const { Vec::new() }; 2];
        let mut methods = vec![
            Method::new("ours: grid", || {
                plain(one.between(a, b, threshold).expect("finite points"))
            }),
            Method::new("ours: grid, all threads", || {
                plain(pool.install(|| many.between(a, b, threshold).expect("finite points")))
            }),
            Method::new("plain grid f32", || plain_grid::between(&fa, &fb, r)),
            Method::new("kiddo f32: build one, query all", || peers::kiddo(&fa, &fb, r)),
            Method::new("parry f32: build both, leaf pairs", || {
                peers::parry_pairs(
                    &peers::parry_tree(&fa, r),
                    &peers::parry_tree(&fb, 0.0),
                    &fa,
                    &fb,
                    r,
                )
            }),
            // from the coordinates that ours is given, in memory that is there already
            Method::new("plain grid f32, rounding first", || {
                for (points, rounded) in [a, b].into_iter().zip(&mut rounded) {
                    peers::round(points, rounded);
                }
                plain_grid::between(&rounded[0], &rounded[1], r)
            }),
        ];
        if *small {
            methods.push(Method::new("brute force f32", || brute(&fa, &fb, r)));
        }
        if truth.is_empty() {
            methods.push(Method::new("the two boxes alone", || {
                let bounds = |points: &[[f64; 3]]| {
                    let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
                    for p in points {
                        for k in 0..3 {
                            min[k] = if p[k] < min[k] { p[k] } else { min[k] };
                            max[k] = if p[k] > max[k] { p[k] } else { max[k] };
                        }
                    }
                    (min, max)
                };
                std::hint::black_box((bounds(a), bounds(b)));
                Pairs::new()
            }));
        }
        let times = report.compare(name, &truth, methods);
        report.line(&format!(
            "Fastest rival / ours {}; plain grid / ours {}, rounding first {}; kiddo / plain grid {}; one thread / all threads {:.2} (least {:.2}).",
            least(times[3].ratios(times[0]), times[4].ratios(times[0])),
            times[2].ratios(times[0]),
            times[5].ratios(times[0]),
            times[3].ratios(times[2]),
            times[0].warm / times[1].warm,
            times[0].least / times[1].least,
        ));
        report.line("");
        if !small {
            reading(report, &pool, [a, b]);
            threads_alone(report, &pool, &scene, threshold);
        }
    }
}

/// Rigid bodies whose structure is kept.
pub(crate) fn kept(report: &mut Report) {
    report.heading("Pairs of points of rigid bodies, structure kept");
    let pool = all_threads();
    for scene in scenes::points(report.full) {
        let scenes::Pair {
            name, a, b, delta, ..
        } = &scene;
        let threshold = Threshold::new(*delta).expect("a positive threshold");
        let trees = [point_tree(a), point_tree(b)];
        let truth = truth(&scene, &trees, threshold);
        let rest = &Placement::IDENTITY;
        // the same scene, each body turned in its own coordinates and turned back by its placement
        let back = Placement::from_axis_angle([0.3, 0.2, 1.0], 0.7).expect("an axis");
        let there = Placement::from_axis_angle([0.3, 0.2, 1.0], -0.7).expect("an axis");
        let own: Vec<_> = a.iter().map(|&p| there.apply(p)).collect();
        let turned = point_tree(&own);
        let posed: Vec<_> = own.iter().map(|&p| back.apply(p)).collect();
        let mut grid = PointGrid::new();
        let posed_truth = plain(grid.between(&posed, b, threshold).expect("finite points"));
        let (fa, fb, r) = (peers::single(a), peers::single(b), *delta as f32);
        let (parry_a, parry_b) = (peers::parry_tree(&fa, r), peers::parry_tree(&fb, 0.0));
        let (mut one, mut many, mut far) =
            (TreeJoin::new(), pool.install(TreeJoin::parallel), TreeJoin::new());
        let found = far
            .between((&turned, &back), (&trees[1], rest), threshold, None)
            .expect("finite points");
        assert!(plain(found) == posed_truth, "{name}, turned");
        let methods = vec![
            Method::new("ours: tree", || {
                plain(
                    one.between((&trees[0], rest), (&trees[1], rest), threshold, None)
                        .expect("finite points"),
                )
            }),
            Method::new("ours: tree, all threads", || {
                let (a, b) = ((&trees[0], rest), (&trees[1], rest));
                plain(pool.install(|| many.between(a, b, threshold, None).expect("finite points")))
            }),
            Method::new("parry f32: leaf pairs", || {
                peers::parry_pairs(&parry_a, &parry_b, &fa, &fb, r)
            }),
            // another body in the last bits of its coordinates, so its errors are those of rounding the scene
            Method::new("tree, one body turned", || {
                plain(
                    far.between((&turned, &back), (&trees[1], rest), threshold, None)
                        .expect("finite points"),
                )
            }),
        ];
        let times = report.compare(name, &truth, methods);
        report.line(&format!(
            "parry / ours {}; one thread / all threads {:.2}.",
            times[2].ratios(times[0]),
            times[0].warm / times[1].warm
        ));
        report.line("");
    }
}

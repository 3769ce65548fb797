//! Pairs of triangles within a threshold: trees built, candidates, exact decision.
use satisfice_collision::FeatureKind;
use satisfice_collision::broad::{FeatureTree, TreeJoin};
use satisfice_collision::distance::Threshold;
use satisfice_collision::{Mesh, Placement, generate};

use crate::points::plain;
use crate::table::{Method, Pairs, Report, all_threads};
use crate::{peers, scenes};

fn ours(join: &mut TreeJoin, a: &Mesh, b: Option<&Mesh>, threshold: Threshold) -> Pairs {
    let tree = FeatureTree::new(a, FeatureKind::Triangle);
    let rest = &Placement::IDENTITY;
    if let Some(b) = b {
        let other = FeatureTree::new(b, FeatureKind::Triangle);
        return plain(
            join.between((&tree, rest), (&other, rest), threshold, None)
                .expect("finite points"),
        );
    }
    let corners = a.triangles();
    let apart = |i: u32, j: u32| {
        !corners[i as usize]
            .iter()
            .any(|v| corners[j as usize].contains(v))
    };
    plain(join.within(&tree, threshold, Some(&apart)))
}

/// The lower and the upper corner of a box.
type Boxed = ([f64; 3], [f64; 3]);

/// All candidates, sorted: pairs whose boxes are within delta and, inside one mesh, share no vertex; by a plain sweep.
pub(crate) fn culled(a: &Mesh, b: Option<&Mesh>, delta: f64) -> Pairs {
    let boxes = |mesh: &Mesh| -> Vec<Boxed> {
        let bounds = |t: [[f64; 3]; 3]| {
            let min = std::array::from_fn(|k| t[0][k].min(t[1][k]).min(t[2][k]));
            let max = std::array::from_fn(|k| t[0][k].max(t[1][k]).max(t[2][k]));
            (min, max)
        };
        (0..mesh.triangles().len())
            .map(|t| bounds(mesh.triangle(t)))
            .collect()
    };
    let (of_a, of_b) = (boxes(a), boxes(b.unwrap_or(a)));
    // sorted along x, so that a sweep leaves most pairs out
    let mut order: Vec<usize> = (0..of_b.len()).collect();
    order.sort_by(|&i, &j| of_b[i].0[0].total_cmp(&of_b[j].0[0]));
    let widest = of_b.iter().map(|b| b.1[0] - b.0[0]).fold(0.0, f64::max);
    let mut pairs = Pairs::new();
    for (i, (min, max)) in of_a.iter().enumerate() {
        let from = order.partition_point(|&j| of_b[j].0[0] < min[0] - widest - 2.0 * delta);
        for &j in order[from..]
            .iter()
            .take_while(|&&j| of_b[j].0[0] <= max[0] + 2.0 * delta)
        {
            let (lower, upper) = &of_b[j];
            let shares =
                b.is_none() && (j <= i || a.triangles()[i].iter().any(|v| a.triangles()[j].contains(v)));
            let near =
                (0..3).all(|k| lower[k] <= max[k] + 1.001 * delta && min[k] <= upper[k] + 1.001 * delta);
            if !shares && near {
                pairs.push((i as u32, j as u32));
            }
        }
    }
    pairs.sort_unstable();
    pairs
}

/// Decides all candidates: the truth, slowly.
fn truth(a: &Mesh, b: Option<&Mesh>, delta: f64) -> Pairs {
    let threshold = Threshold::new(delta).expect("a positive threshold");
    let (of_a, of_b) = (a, b.unwrap_or(a));
    let mut pairs = culled(a, b, delta);
    pairs.retain(|&(i, j)| {
        let (p, q) = (of_a.triangle(i as usize), of_b.triangle(j as usize));
        satisfice_collision::distance::triangle_triangle::within(&p, &q, threshold)
    });
    pairs
}

pub(crate) fn run(report: &mut Report) {
    report.heading("Pairs of triangles, trees built each time");
    let mut cases: Vec<(String, Mesh, Option<Mesh>, f64)> = Vec::new();
    let pot = scenes::teapot(if report.full { 13 } else { 4 });
    let unit = pot.size();
    for (name, offset) in [("touching", scenes::TOUCHING), ("crossing", scenes::CROSSING)] {
        let other = scenes::moved(&pot, offset);
        cases.push((
            format!("teapots {name}, r = .01 of the size"),
            pot.clone(),
            Some(other),
            0.01 * unit,
        ));
    }
    let other = scenes::moved(&pot, scenes::CROSSING);
    cases.push((
        "teapots crossing, r = .001 of the size".into(),
        pot.clone(),
        Some(other),
        0.001 * unit,
    ));
    match scenes::data("bunny.obj").filter(|_| report.full) {
        Some(bunny) => {
            let size = bunny.size();
            let other = Placement::from_axis_angle([0.0, 1.0, 0.0], 0.5)
                .and_then(|turn| turn.moved([0.3 * size, 0.0, 0.0]))
                .and_then(|pose| pose.place(&bunny))
                .expect("finite vertices");
            cases.push((
                "two bunnies, r = .01 of the size".into(),
                bunny,
                Some(other),
                0.01 * size,
            ));
        }
        None => report.line("The bunny is not at hand (SATISFICE_DATA)."),
    }
    match scenes::data("cloth_ball92.ply").filter(|_| report.full) {
        Some(cloth) => cases.push((
            "cloth-ball frame 92 with itself, r = .01".into(),
            cloth,
            None,
            0.01,
        )),
        None => {
            report.line("The cloth-ball is not at hand (SATISFICE_DATA); a folded sheet stands in for it.");
            let side = if report.full { 120 } else { 12 };
            cases.push((
                "folded sheet with itself".into(),
                scenes::sheet(side, 0.0),
                None,
                0.02,
            ));
        }
    }
    let ball = generate::icosphere(1.0, 2).expect("few subdivisions");
    let other = scenes::moved(&ball, [1.9, 0.1, 0.2]);
    cases.push(("two balls".into(), ball, Some(other), 0.05));
    report.line("");
    let pool = all_threads();
    for (name, a, b, delta) in cases {
        let b = b.as_ref();
        let threshold = Threshold::new(delta).expect("a positive threshold");
        let truth = truth(&a, b, delta);
        let (mut one, mut many) = (TreeJoin::new(), pool.install(TreeJoin::parallel));
        let methods = vec![
            Method::new("ours: trees", || ours(&mut one, &a, b, threshold)),
            Method::new("ours: trees, all threads", || {
                pool.install(|| ours(&mut many, &a, b, threshold))
            }),
            Method::new("parry f64", || peers::parry_triangles_f64(&a, b, delta)),
            Method::new("parry f32", || peers::parry_triangles_f32(&a, b, delta)),
        ];
        let times = report.compare(&name, &truth, methods);
        report.line(&format!(
            "parry f64 / ours {}; one thread / all threads {:.2}.",
            times[2].ratios(times[0]),
            times[0].warm / times[1].warm
        ));
        report.line("");
    }
}

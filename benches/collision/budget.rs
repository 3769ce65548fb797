//! A frame that may take a tenth of the time of the complete answer, given by the fastest exact enumeration.
use satisfice_collision::FeatureKind;
use satisfice_collision::broad::{FeatureTree, PointGrid, TreeJoin};
use satisfice_collision::distance::{PairKind, Threshold};
use satisfice_collision::scene::{Body, BodyId, Completeness, World};
use satisfice_collision::{Mesh, Placement};

use crate::scenes;
use crate::table::{Report, deadline, time};

/// The frame under the budget. The contacts of the one before are known, and two more tell how the bodies move.
const LAST: usize = 3;

type Step = Box<dyn Fn(&mut World, usize)>;

/// A scene and what moves it to frame `t`.
struct Film {
    name: &'static str,
    kind: PairKind,
    delta: f64,
    bodies: Vec<Body>,
    step: Step,
    /// The exact enumeration of the last frame by itself, in the ways that could be fastest: kept trees for rigid bodies; a refitted
    /// tree and a new grid for a cloth.
    exact: Vec<Box<dyn FnMut()>>,
}

/// Where the second teapot is at frame `t`, moving steadily by less than delta / 2 a frame.
fn course(t: usize) -> Placement {
    Placement::from_translation([4.5 - 0.012 * t as f64, 0.008 * t as f64, 0.0]).expect("finite")
}

/// The same, but it turns back after frame 2.
fn turning(t: usize) -> Placement {
    course(if t < LAST { t } else { 2 * LAST - 2 - t })
}

fn by_trees(pot: &Mesh, kind: PairKind, there: Placement, threshold: Threshold) -> Box<dyn FnMut()> {
    let (feature, _) = kind.features();
    let (tree, mut join) = (FeatureTree::new(pot, feature), TreeJoin::new());
    Box::new(move || {
        let here = (&tree, &Placement::IDENTITY);
        join.between(here, (&tree, &there), threshold, None)
            .expect("finite points");
    })
}

/// Both ways of a deforming body; the tree goes to the frame before and back, so that every other of its turns is the last frame.
fn of_a_cloth(before: &Mesh, frame: &Mesh, threshold: Threshold) -> Vec<Box<dyn FnMut()>> {
    let (vertices, mut grid) = (frame.vertices().to_vec(), PointGrid::new());
    let frames = [frame.vertices().to_vec(), before.vertices().to_vec()];
    let (mut tree, mut join, mut turn) = (FeatureTree::new(before, FeatureKind::Vertex), TreeJoin::new(), 0);
    vec![
        Box::new(move || {
            grid.within(&vertices, threshold).expect("finite points");
        }),
        Box::new(move || {
            tree.refit(&frames[turn]).expect("finite points");
            turn = 1 - turn;
            join.within(&tree, threshold, None);
        }),
    ]
}

fn films(full: bool) -> Vec<Film> {
    let mut films = Vec::new();
    let pot = scenes::teapot(if full { 40 } else { 6 });
    let delta = 0.05;
    let threshold = Threshold::new(delta).expect("positive");
    let (points, triangles) = (PairKind::VertexVertex, PairKind::TriangleTriangle);
    for (name, kind, course) in [
        ("moving teapots", points, course as fn(usize) -> Placement),
        ("teapots turning back", points, turning),
        ("moving teapots", triangles, course),
        ("teapots turning back", triangles, turning),
    ] {
        let bodies = vec![Body::fixed(pot.clone()), Body::rigid(pot.clone())];
        let step =
            move |scene: &mut World, t: usize| scene.place(BodyId::nth(1), course(t)).expect("a rigid body");
        films.push(Film {
            name,
            kind,
            delta,
            bodies,
            step: Box::new(step),
            exact: vec![by_trees(&pot, kind, course(LAST), threshold)],
        });
    }
    let side = if full { 215 } else { 30 };
    let frames: Vec<Mesh> = (0..=LAST).map(|t| scenes::sheet(side, 0.02 * t as f64)).collect();
    let bodies = vec![Body::deforming(frames[0].clone())];
    let exact = of_a_cloth(
        &frames[LAST - 1],
        &frames[LAST],
        Threshold::new(0.1).expect("positive"),
    );
    let step = move |scene: &mut World, t: usize| {
        scene
            .deform(BodyId::nth(0), frames[t].vertices())
            .expect("finite points");
    };
    let (name, kind) = ("slow folded sheet", PairKind::VertexVertex);
    films.push(Film {
        name,
        kind,
        delta: 0.1,
        bodies,
        step: Box::new(step),
        exact,
    });
    if let (true, Some(first), Some(second)) = (
        full,
        scenes::data("cloth_ball92.ply"),
        scenes::data("cloth_ball93.ply"),
    ) {
        for delta in [0.05, 0.1] {
            let bodies = vec![Body::deforming(first.clone())];
            let exact = of_a_cloth(&first, &second, Threshold::new(delta).expect("positive"));
            let frames = [first.vertices().to_vec(), second.vertices().to_vec()];
            let step = move |scene: &mut World, t: usize| {
                scene
                    .deform(BodyId::nth(0), &frames[t / LAST])
                    .expect("finite points");
            };
            let (name, kind) = ("cloth-ball 92 to 93", PairKind::VertexVertex);
            films.push(Film {
                name,
                kind,
                delta,
                bodies,
                step: Box::new(step),
                exact,
            });
        }
    }
    films
}

pub(crate) fn run(report: &mut Report) {
    report.heading("A tenth of the time");
    report.line(
        "Exact is the median time of enumerating the frame by itself, by kept trees (rigid) or by the faster of a refitted \
         tree and a new grid (deforming); the budget is a tenth of it. Handing over the new coordinates and, between the \
         frames, measuring the distances of the last contacts are outside both. Three frames come before, of the last of \
         which the contacts are known.",
    );
    report.line("");
    report.line("| scene | pairs | contacts before | contacts | exact ms | budget ms | found | share |");
    report.line("|---|---|---|---|---|---|---|---|");
    for film in films(report.full) {
        let threshold = Threshold::new(film.delta).expect("a positive threshold");
        let scene = |bodies: Vec<Body>| {
            let mut scene = World::new(film.kind, threshold);
            bodies.into_iter().for_each(|body| {
                scene.add(body).expect("a finite mesh");
            });
            scene
        };
        let mut exact = scene(film.bodies);
        let mut answers: Vec<_> = (0..=LAST)
            .map(|t| {
                (film.step)(&mut exact, t);
                exact.frame().expect("finite points")
            })
            .collect();
        let (answer, before) = (answers.remove(LAST), answers.remove(LAST - 1));
        let runs = if report.full { 21 } else { 1 };
        let full_time = film
            .exact
            .into_iter()
            .map(|mut enumerate| {
                let mut times: Vec<f64> = (0..runs).map(|_| time(&mut enumerate).0).collect();
                times.sort_by(f64::total_cmp);
                times[times.len() / 2]
            })
            .fold(f64::INFINITY, f64::min);
        let budget = full_time / 10.0;
        // the median of several tries, for a deadline in wall time suffers from whatever else runs
        let mut counts: Vec<usize> = (0..runs.min(9))
            .map(|_| {
                for t in 0..LAST {
                    (film.step)(&mut exact, t);
                    let known = exact.frame().expect("finite points").contacts;
                    assert!(t < LAST - 1 || known == before.contacts);
                }
                exact.measure_contacts();
                (film.step)(&mut exact, LAST);
                let mut stop = deadline(budget);
                let mut pass = exact.pass();
                let state = exact.advance(&mut pass, &mut stop).expect("the present frame");
                let cut = exact.finish(pass);
                let known = |contact| answer.contacts.binary_search(contact).is_ok();
                assert!(cut.contacts.iter().all(known), "a budget never invents contacts");
                assert!(state == Completeness::Unknown || cut.contacts.len() == answer.contacts.len());
                cut.contacts.len()
            })
            .collect();
        counts.sort_unstable();
        let found = counts[counts.len() / 2];
        report.line(&format!(
            "| {}, r = {} | {} | {} | {} | {full_time:.3} | {budget:.3} | {} | {:.0} % |",
            film.name,
            film.delta,
            film.kind,
            before.contacts.len(),
            answer.contacts.len(),
            found,
            100.0 * found as f64 / answer.contacts.len().max(1) as f64
        ));
    }
    report.line("");
}

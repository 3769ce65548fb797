//! A frame that may take a tenth of the time of the complete answer, given by the fastest exact enumeration.
use satisfice_collision::broad::{FeatureKind, FeatureTree, PointGrid, TreeJoin};
use satisfice_collision::distance::{PairKind, Threshold};
use satisfice_collision::scene::{Body, Completeness, Scene};
use satisfice_collision::{Mesh, Placement};

use crate::scenes;
use crate::table::{Report, deadline, time};

type Step = Box<dyn Fn(&mut Scene, usize)>;

/// A scene and what moves it to frame `t`.
struct Film {
    name: &'static str,
    kind: PairKind,
    delta: f64,
    bodies: Vec<Body>,
    step: Step,
    /// The exact enumeration of frame 1 by itself: kept trees for rigid bodies, a new grid for a cloth.
    exact: Box<dyn FnMut()>,
}

/// Where the second teapot is at frame `t`; it moves by less than delta / 2 a frame.
fn course(t: usize) -> Placement {
    Placement::from_translation([4.5 - 0.012 * t as f64, 0.008 * t as f64, 0.0]).expect("finite")
}

fn by_trees(pot: &Mesh, kind: PairKind, threshold: Threshold) -> Box<dyn FnMut()> {
    let (feature, _) = FeatureKind::of_pair(kind);
    let (tree, mut join) = (FeatureTree::new(pot, feature), TreeJoin::new());
    Box::new(move || {
        let there = (&tree, &course(1));
        join.between((&tree, &Placement::IDENTITY), there, threshold, None)
            .expect("finite points");
    })
}

fn by_grid(frame: &Mesh, threshold: Threshold) -> Box<dyn FnMut()> {
    let (vertices, mut grid) = (frame.vertices().to_vec(), PointGrid::new());
    Box::new(move || {
        grid.within(&vertices, threshold).expect("finite points");
    })
}

fn films(full: bool) -> Vec<Film> {
    let mut films = Vec::new();
    let pot = scenes::teapot(if full { 40 } else { 6 });
    let delta = 0.05;
    for kind in [PairKind::VertexVertex, PairKind::TriangleTriangle] {
        let bodies = vec![Body::fixed(pot.clone()), Body::rigid(pot.clone())];
        let step = |scene: &mut Scene, t: usize| scene.place(1, course(t)).expect("a rigid body");
        let exact = by_trees(&pot, kind, Threshold::new(delta).expect("positive"));
        films.push(Film {
            name: "moving teapots",
            kind,
            delta,
            bodies,
            step: Box::new(step),
            exact,
        });
    }
    let side = if full { 215 } else { 30 };
    let frames: Vec<Mesh> = (0..6).map(|t| scenes::sheet(side, 0.02 * t as f64)).collect();
    let bodies = vec![Body::deforming(frames[0].clone())];
    let exact = by_grid(&frames[1], Threshold::new(0.1).expect("positive"));
    let step = move |scene: &mut Scene, t: usize| {
        scene
            .deform(0, frames[t % frames.len()].vertices())
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
            let exact = by_grid(&second, Threshold::new(delta).expect("positive"));
            let frames = [first.vertices().to_vec(), second.vertices().to_vec()];
            let step = move |scene: &mut Scene, t: usize| {
                scene.deform(0, &frames[t.min(1)]).expect("finite points");
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
        "Exact is the median time of enumerating the frame by itself, by kept trees (rigid) or a new grid (deforming); the \
         budget is a tenth of it. Handing over the new coordinates and, between the frames, measuring the distances of the \
         last contacts are outside both.",
    );
    report.line("");
    report.line("| scene | pairs | contacts before | contacts | exact ms | budget ms | found | share |");
    report.line("|---|---|---|---|---|---|---|---|");
    for film in films(report.full) {
        let threshold = Threshold::new(film.delta).expect("a positive threshold");
        let scene = |bodies: Vec<Body>| {
            let mut scene = Scene::new(film.kind, threshold);
            bodies.into_iter().for_each(|body| {
                scene.add(body);
            });
            scene
        };
        let mut exact = scene(film.bodies);
        (film.step)(&mut exact, 0);
        let before = exact.contacts().expect("finite points").contacts;
        (film.step)(&mut exact, 1);
        let answer = exact.contacts().expect("finite points");
        let mut enumerate = film.exact;
        let runs = if report.full { 21 } else { 1 };
        let mut times: Vec<f64> = (0..runs).map(|_| time(&mut enumerate).0).collect();
        times.sort_by(f64::total_cmp);
        let full_time = times[times.len() / 2];
        let budget = full_time / 10.0;
        // the median of several tries, for a deadline in wall time suffers from whatever else runs
        let mut counts: Vec<usize> = (0..runs.min(9))
            .map(|_| {
                (film.step)(&mut exact, 0);
                assert_eq!(exact.contacts().expect("finite points").contacts, before);
                exact.measure_contacts();
                (film.step)(&mut exact, 1);
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
            before.len(),
            answer.contacts.len(),
            found,
            100.0 * found as f64 / answer.contacts.len().max(1) as f64
        ));
    }
    report.line("");
}

//! One scene, all methods frame by frame.

use std::fmt;
use std::sync::LazyLock;

use cpu_time::ThreadTime;
use satisfice_collision::distance::{PairKind, Threshold};
use satisfice_collision::scene::{Body, BodyId, SharedMesh, World};
use satisfice_collision::{Aabb, Placement, generate};

use crate::peers::{self, Kept};
use crate::rapier::Rapier;
use crate::scenes::{Course, RADIUS, Scene};

/// A row of the table.
pub(crate) struct Row {
    name: String,
    moved: usize,
    bodies_ms: f64,
    worst: f64,
    new_ms: f64,
    triangles_ms: Option<f64>,
    parry_kept: f64,
    parry_new: f64,
    parry_boxes: f64,
    rapier: f64,
    contacts: usize,
    kept: usize,
    bytes: [f64; 2],
}

impl Row {
    pub(crate) const HEADING: &'static str = "| scene | moved | bodies ms | worst / new | new ms | triangles ms | parry kept | \
        parry new | ratio | parry boxes | ratio with them | rapier | ratio to it | contacts | kept pairs | bytes a body | a pair |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|";
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ms = |ms: f64| {
            if ms < 0.001 {
                "< 0.001".to_owned()
            } else {
                format!("{ms:.3}")
            }
        };
        let fastest = self.parry_kept.min(self.parry_new);
        let ratio = |theirs: f64| match self.moved {
            0 => "-".to_owned(),
            _ => format!("{:.2}", theirs / self.bodies_ms),
        };
        let [body, pair] = self.bytes;
        write!(
            f,
            "| {} | {} | {} | {:.2} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {body:.0} | {} |",
            self.name,
            self.moved,
            ms(self.bodies_ms),
            self.worst / self.new_ms,
            ms(self.new_ms),
            self.triangles_ms.map_or("-".to_owned(), ms),
            ms(self.parry_kept),
            ms(self.parry_new),
            ratio(fastest),
            ms(self.parry_boxes),
            ratio(fastest + self.parry_boxes),
            ms(self.rapier),
            ratio(self.rapier),
            self.contacts,
            self.kept,
            if pair > 0.0 {
                format!("{pair:.0}")
            } else {
                "-".to_owned()
            },
        )
    }
}

/// Processor time of this thread in milliseconds, without that of reading the clock: other work on the machine does not count.
pub(crate) fn time<R>(run: impl FnOnce() -> R) -> (f64, R) {
    static CLOCK: LazyLock<f64> = LazyLock::new(|| {
        let mut empty: Vec<f64> = (0..1_001).map(|_| with_clock(|| ()).0).collect();
        median(&mut empty)
    });
    let (ms, result) = with_clock(run);
    ((ms - *CLOCK).max(0.0), result)
}

fn with_clock<R>(run: impl FnOnce() -> R) -> (f64, R) {
    let start = ThreadTime::now();
    let result = run();
    (start.elapsed().as_secs_f64() * 1e3, result)
}

pub(crate) fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Finds the pairs of bodies, and no contacts: by a query of a region in which there is nothing.
fn find_pairs(world: &mut World) {
    let nowhere = Aabb::point([-1e9; 3]);
    assert!(world.bodies_in(&nowhere).expect("a box").is_empty());
}

pub(crate) struct Meshes {
    ball: SharedMesh,
    huge: SharedMesh,
}

impl Meshes {
    pub(crate) fn new(scene: &Scene) -> Self {
        let ball = |radius| generate::icosphere(radius, 1).expect("a sphere");
        Self {
            ball: ball(RADIUS).into(),
            huge: ball(scene.huge.unwrap_or(1.0)).into(),
        }
    }
}

/// A world of the bodies of a scene, before its first frame.
pub(crate) fn add(scene: &Scene, meshes: &Meshes) -> (World, Vec<BodyId>) {
    let mut world = World::new(
        PairKind::TriangleTriangle,
        Threshold::new(0.01).expect("positive"),
    );
    let bodies = scene.centres.iter().enumerate().map(|(body, &centre)| {
        let mesh = if scene.radius(body) > RADIUS {
            &meshes.huge
        } else {
            &meshes.ball
        };
        let at = Placement::from_translation(centre).expect("finite");
        world.add(Body::rigid(mesh.clone()).at(at)).expect("a body")
    });
    let bodies = bodies.collect();
    (world, bodies)
}

fn build(scene: &Scene, meshes: &Meshes) -> (World, Vec<BodyId>) {
    let (mut world, bodies) = add(scene, meshes);
    find_pairs(&mut world);
    (world, bodies)
}

/// The boxes that parry3d is given.
pub(crate) fn boxes_of(scene: &Scene, centres: &[[f64; 3]]) -> Vec<parry3d::bounding_volume::Aabb> {
    let numbered = centres.iter().enumerate();
    numbered
        .map(|(body, &centre)| peers::bounds(centre, scene.radius(body)))
        .collect()
}

pub(crate) fn measure(scene: &Scene, frames: usize) -> Row {
    let meshes = Meshes::new(scene);
    let mut centres = scene.centres.clone();
    let mut boxes = boxes_of(scene, &centres);
    let mut new: Vec<f64> = (0..3).map(|_| time(|| build(scene, &meshes)).0).collect();
    let (mut world, bodies) = build(scene, &meshes);
    if scene.triangles {
        world.update().expect("a frame");
    }
    let mut kept = Kept::new(&boxes);
    let mut course = Course::new(centres.len());
    let mut moved = Vec::new();
    let mut poses: Vec<_> = centres.iter().map(|&centre| peers::pose(centre, 0.0)).collect();
    let locals = [0, 1].map(|body| peers::local(scene.radius(body)));
    let places = scene.centres.iter().enumerate();
    let mut rapier = Rapier::new(places.map(|(body, &centre)| (scene.radius(body), centre)));
    let mut times: [Vec<f64>; 6] = [const { Vec::new() }; 6];
    for frame in 0..frames {
        course.step(scene, &mut centres, &mut moved);
        let angle = |body: usize| scene.turn * (frame as f64 + body as f64);
        for &body in &moved {
            poses[body] = peers::pose(centres[body], angle(body));
        }
        let turning = moved.iter().filter(|_| scene.turn != 0.0);
        let placements: Vec<Placement> = turning
            .map(|&body| {
                let turned = Placement::from_axis_angle([0.0, 0.0, 1.0], angle(body)).expect("finite");
                turned.moved(centres[body]).expect("finite")
            })
            .collect();
        let ours = time(|| {
            for (at, &body) in moved.iter().enumerate() {
                match placements.get(at) {
                    Some(placement) => world.place(bodies[body], *placement),
                    None => world.translate(bodies[body], centres[body]),
                }
                .expect("a body");
            }
            find_pairs(&mut world);
        });
        let triangles = time(|| scene.triangles.then(|| world.update().expect("a frame")));
        let posed = time(|| peers::posed(|body| locals[body.min(1)], &poses, &moved, &mut boxes));
        let parry = time(|| kept.follow(&boxes, &moved));
        let (rapier_ms, rapier_pairs) = time(|| rapier.follow(&poses, &moved));
        // the first frames fill rooms that later ones reuse
        if frame >= frames / 8 {
            times[0].push(ours.0);
            times[1].push(triangles.0);
            times[2].push(parry.0);
            times[4].push(posed.0);
            times[5].push(rapier_ms);
            if frame.is_multiple_of(4) || frames < 8 {
                let (ms, meeting) = time(|| peers::anew(&boxes));
                times[3].push(ms);
                assert!(
                    rapier_pairs >= meeting,
                    "{rapier_pairs} of rapier, {meeting} of parry"
                );
            }
        }
    }
    let worst = times[0].iter().copied().fold(0.0, f64::max);
    let [
        bodies_ms,
        triangles_ms,
        parry_kept,
        parry_new,
        parry_boxes,
        rapier,
    ] = times.map(|mut times| median(&mut times));
    let (kept, bytes) = (world.kept_pairs(), world.bytes() as f64);
    let count = centres.len() as f64;
    let a_body = if kept > centres.len() / 2 {
        without_pairs(scene, &meshes, frames)
    } else {
        bytes / count
    };
    Row {
        name: scene.name.clone(),
        moved: moved.len(),
        bodies_ms,
        worst,
        new_ms: median(&mut new),
        triangles_ms: scene.triangles.then_some(triangles_ms),
        parry_kept,
        parry_new,
        parry_boxes,
        rapier,
        contacts: world.contacts().count(),
        kept,
        bytes: [a_body, (bytes - a_body * count) / kept.max(1) as f64],
    }
}

/// Bytes a body where as many move, and no boxes meet.
fn without_pairs(scene: &Scene, meshes: &Meshes, frames: usize) -> f64 {
    let apart = Scene {
        name: String::new(),
        centres: (0..scene.centres.len())
            .map(|n| [3.0 * n as f64, 0.0, 0.0])
            .collect(),
        huge: None,
        ..*scene
    };
    let (mut world, bodies) = build(&apart, meshes);
    let (mut centres, mut moved) = (apart.centres.clone(), Vec::new());
    let mut course = Course::new(centres.len());
    for frame in 0..frames {
        course.step(&apart, &mut centres, &mut moved);
        for &body in &moved {
            let angle = scene.turn * (frame as f64 + body as f64);
            let turned = Placement::from_axis_angle([0.0, 0.0, 1.0], angle).expect("finite");
            let to = turned.moved(centres[body]).expect("finite");
            world.place(bodies[body], to).expect("a body");
        }
        find_pairs(&mut world);
    }
    world.bytes() as f64 / centres.len() as f64
}

//! Ten thousand balls, of which some are thrown at the others: a world in which a frame costs what moves and touches. The balls
//! bounce by the contacts that begin (`World::body_changes`). For each frame: bodies, how many moved, pairs whose boxes meet, pairs
//! that were decided, contacts, time, memory; at the end a check against the distances of all pairs of centres, a few queries,
//! a picture of a slice, and a page on which the balls of the middle layer can be followed.
//!
//! `cargo run --release --example world`
#![expect(clippy::disallowed_methods, reason = "an example asks the time")]

use std::env;
use std::error::Error;
use std::fs;
use std::io::{IsTerminal as _, Write as _};
use std::path::PathBuf;
use std::time::Instant;

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use satisfice_collision::distance::{PairKind, Threshold};
use satisfice_collision::scene::{Body, BodyId, ChangeKind, SharedMesh, World};
use satisfice_collision::{Aabb, Mesh, Placement, generate};
use satisfice_page::{Contact, Feature, FeatureKind, ScenePage};
use satisfice_picture::{Picture, Up, View};

const RADIUS: f64 = 0.4;
const DELTA: f64 = 0.02;
/// Balls slower than this stop.
const SLOWEST: f64 = 0.003;
/// The page lists so many contacts of a frame, evenly chosen.
const LISTED: usize = 400;

fn main() -> Result<(), Box<dyn Error>> {
    let quick = env::var_os("SATISFICE_QUICK").is_some_and(|value| value != "0");
    let (side, frames) = if quick { (8, 24) } else { (22, 120) };
    let bodies = if quick { 500 } else { 10_000 };
    let mesh = generate::icosphere(RADIUS, 1)?;
    let mut balls = Balls::new(bodies, side);
    let mut world = World::new(PairKind::TriangleTriangle, Threshold::new(DELTA)?);
    let shared = SharedMesh::from(mesh.clone());
    for &centre in &balls.centres {
        world.add(Body::rigid(shared.clone()).at(Placement::from_translation(centre)?))?;
    }
    let clock = Instant::now();
    world.update()?;
    println!(
        "{bodies} balls of {} triangles, one mesh; contacts within {DELTA}; first frame {:.1} ms\n",
        mesh.triangles().len(),
        1e3 * clock.elapsed().as_secs_f64()
    );
    println!("frame  bodies   moved  box pairs  decided  contacts      ms  memory kB");
    let progress = std::io::stderr().is_terminal();
    let mut film = Film::new(&balls, &mesh, side);
    let mut most_moved = 0;
    for frame in 0..frames {
        let moved = balls.step();
        let clock = Instant::now();
        for &body in &moved {
            let to = Placement::from_translation(balls.centres[body])?;
            world.place(BodyId::nth(body as u32), to)?;
        }
        let update = world.update()?;
        let milliseconds = 1e3 * clock.elapsed().as_secs_f64();
        for change in world.body_changes() {
            if change.kind != ChangeKind::Ended {
                balls.bounce(change.body_a.index(), change.body_b.index());
            }
        }
        most_moved = most_moved.max(moved.len());
        if progress {
            eprint!("\rframe {} of {frames}", frame + 1);
            std::io::stderr().flush()?;
        }
        if frame % (frames / 12) == 0 || frame + 1 == frames {
            println!(
                "{frame:>5} {:>7} {:>7} {:>10} {:>8} {:>9} {milliseconds:>7.2} {:>10}",
                world.len(),
                moved.len(),
                world.kept_pairs(),
                update.recomputed,
                world.contacts().count(),
                world.bytes() / 1000
            );
            film.add_frame(&world, frame, &balls)?;
        }
    }
    if progress {
        eprintln!();
    }
    assert!(most_moved > bodies / 50, "the thrown balls set others in motion");
    let touching = world.touching()?;
    balls.check(&touching);
    println!(
        "\n{} pairs of balls touch: as many as the distances of all centres allow",
        touching.len()
    );
    questions(&mut world, side)?;
    picture(&mut world, &mesh, side, &balls.ways)?;
    write("world.html", film.page.html()?.as_bytes())
}

/// The balls that begin in the middle layer, frame by frame.
struct Film<'m> {
    page: ScenePage,
    mesh: &'m Mesh,
    /// Which balls these are, and where each was last.
    balls: Vec<(usize, [f64; 3])>,
    /// The body of the page that shows a ball.
    shown: Vec<Option<usize>>,
}

impl<'m> Film<'m> {
    fn new(balls: &Balls, mesh: &'m Mesh, side: usize) -> Self {
        let mut page = ScenePage::new("The middle layer of a world of balls");
        page.threshold(DELTA);
        let (mut layer, mut shown) = (Vec::new(), vec![None; balls.centres.len()]);
        for (ball, &centre) in balls.centres.iter().enumerate() {
            if ball / side / side == (balls.centres.len() / side / side) / 2 {
                shown[ball] = Some(layer.len());
                layer.push((ball, centre));
                let vertices = Self::around(mesh, centre);
                page.body(format!("ball {ball}"), &vertices, mesh.triangles(), mesh.lines());
            }
        }
        Self {
            page,
            mesh,
            balls: layer,
            shown,
        }
    }

    fn around(mesh: &Mesh, centre: [f64; 3]) -> Vec<[f64; 3]> {
        let vertices = mesh.vertices().iter();
        vertices
            .map(|vertex| std::array::from_fn(|k| vertex[k] + centre[k]))
            .collect()
    }

    fn add_frame(&mut self, world: &World, frame: usize, balls: &Balls) -> Result<(), Box<dyn Error>> {
        self.page.frame(format!("frame {frame}"));
        for (body, (ball, last)) in self.balls.iter_mut().enumerate() {
            let centre = balls.centres[*ball];
            if centre != *last {
                self.page.move_body(body, &Self::around(self.mesh, centre))?;
                *last = centre;
            }
        }
        let shown = |body: BodyId| self.shown[body.index()];
        let among: Vec<_> = world
            .contacts()
            .filter_map(|contact| Some((contact, [shown(contact.body_a)?, shown(contact.body_b)?])))
            .collect();
        for (contact, bodies) in among.iter().step_by(among.len().div_ceil(LISTED).max(1)) {
            let near = world.proximity(*contact)?;
            let kind = FeatureKind::Triangle;
            let [a, b] = [(bodies[0], contact.a), (bodies[1], contact.b)];
            let features = [a, b].map(|(body, number)| Feature { body, kind, number });
            let listed = Contact::new(features, [near.point_a, near.point_b]);
            self.page.contact(listed.distance(near.distance));
        }
        self.page.counts(Some(among.len() as u64), None);
        Ok(())
    }
}

/// What can be asked of a world without a list of contacts.
fn questions(world: &mut World, side: usize) -> Result<(), Box<dyn Error>> {
    let far = side as f64;
    let clock = Instant::now();
    let hit = world.cast_ray([far / 2.0, -far, far / 2.0], [far / 2.0, 2.0 * far, far / 2.0])?;
    let nearest = world
        .nearest_to_point([far / 2.0, -far, far / 2.0])?
        .ok_or("no bodies")?;
    let milliseconds = 1e3 * clock.elapsed().as_secs_f64();
    match hit {
        Some(hit) => println!(
            "a ray through the middle meets body {} at {:.2?}",
            hit.body, hit.point
        ),
        None => println!("a ray through the middle meets nothing"),
    }
    println!(
        "the body nearest to the start of the ray is {}, {:.3} away; both questions {milliseconds:.2} ms",
        nearest.body, nearest.proximity.distance
    );
    assert!(hit.is_none_or(|hit| hit.part * 3.0 * far >= nearest.proximity.distance));
    Ok(())
}

/// Where the balls are and how they move.
struct Balls {
    centres: Vec<[f64; 3]>,
    ways: Vec<[f64; 3]>,
    /// The box in which they stay.
    room: f64,
}

impl Balls {
    /// A lattice at rest, on which those of the front are thrown.
    fn new(bodies: usize, side: usize) -> Self {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(4);
        let mut unit = || (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        let centres: Vec<_> = (0..bodies)
            .map(|n| [n % side, n / side % side, n / side / side].map(|c| c as f64))
            .collect();
        let ways = centres
            .iter()
            .map(|&[_, y, _]| match y < 0.5 {
                true => [0.02 * (unit() - 0.5), 0.06 * unit(), 0.02 * (unit() - 0.5)],
                false => [0.0; 3],
            })
            .collect();
        Self {
            centres,
            ways,
            room: side as f64,
        }
    }

    /// Moves the balls; those that do.
    fn step(&mut self) -> Vec<usize> {
        let mut moved = Vec::new();
        for (body, (centre, way)) in self.centres.iter_mut().zip(&mut self.ways).enumerate() {
            if way.iter().all(|w| w.abs() < SLOWEST) {
                *way = [0.0; 3];
                continue;
            }
            for k in 0..3 {
                if (centre[k] < -0.5 && way[k] < 0.0) || (centre[k] > self.room - 0.5 && way[k] > 0.0) {
                    way[k] = -way[k];
                }
                centre[k] += way[k];
            }
            moved.push(body);
        }
        moved
    }

    /// Two equal balls exchange what they have of speed towards each other.
    fn bounce(&mut self, a: usize, b: usize) {
        let along: [f64; 3] = std::array::from_fn(|k| self.centres[b][k] - self.centres[a][k]);
        let square: f64 = along.iter().map(|c| c * c).sum();
        let closing: f64 = (0..3)
            .map(|k| (self.ways[a][k] - self.ways[b][k]) * along[k])
            .sum();
        if closing > 0.0 {
            for (k, along) in along.iter().enumerate() {
                self.ways[a][k] -= closing / square * along;
                self.ways[b][k] += closing / square * along;
            }
        }
    }

    /// Balls whose inner spheres meet touch, and balls whose outer spheres are further apart than the threshold do not.
    fn check(&self, touching: &[(BodyId, BodyId)]) {
        let inner = 0.9 * RADIUS;
        let mut near = 0;
        for (a, one) in self.centres.iter().enumerate() {
            for (b, two) in self.centres.iter().enumerate().skip(a + 1) {
                let distance = (0..3).map(|k| (one[k] - two[k]).powi(2)).sum::<f64>().sqrt();
                if distance < 2.0 * RADIUS + DELTA {
                    let pair = (BodyId::nth(a as u32), BodyId::nth(b as u32));
                    let touch = touching.binary_search(&pair).is_ok();
                    assert!(touch || distance > 2.0 * inner, "{a} and {b}, {distance} apart");
                    near += usize::from(touch);
                }
            }
        }
        assert_eq!(touching.len(), near, "pairs touch that are not near");
    }
}

/// A slice through the middle: balls that move in one colour, others in another, triangles in contact in orange.
fn picture(world: &mut World, mesh: &Mesh, side: usize, ways: &[[f64; 3]]) -> Result<(), Box<dyn Error>> {
    let middle = (side / 2) as f64;
    let slice = world.bodies_in(&Aabb {
        min: [-2.0, -2.0, middle - 0.3],
        max: [side as f64 + 2.0, side as f64 + 2.0, middle + 0.3],
    })?;
    let moves = |body: &BodyId| ways[body.index()].iter().any(|&w| w != 0.0);
    let mut meshes = Vec::new();
    let mut first = vec![None; ways.len()];
    for group in [true, false] {
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for body in slice.iter().filter(|body| moves(body) == group) {
            let place = world.placement(*body)?;
            let offset = vertices.len() as u32;
            first[body.index()] = Some((meshes.len(), triangles.len() as u32));
            vertices.extend(mesh.vertices().iter().map(|&p| place.apply(p)));
            triangles.extend(mesh.triangles().iter().map(|t| t.map(|v| v + offset)));
        }
        if !vertices.is_empty() {
            meshes.push(Mesh::new(vertices, Vec::new(), triangles)?);
        }
    }
    let view = View {
        azimuth: -90.0,
        elevation: 75.0,
        up: Up::Z,
    };
    let mut picture = Picture::new(900, 800, view);
    meshes.iter().for_each(|mesh| picture.body(mesh));
    for contact in world.contacts() {
        for (body, triangle) in [(contact.body_a, contact.a), (contact.body_b, contact.b)] {
            if let Some((group, offset)) = first[body.index()] {
                picture.highlight(group, offset + triangle);
            }
        }
    }
    write("world.png", &picture.png()?)
}

fn write(name: &str, content: &[u8]) -> Result<(), Box<dyn Error>> {
    let folder = env::var_os("SATISFICE_OUT").map_or_else(|| PathBuf::from("out/world"), PathBuf::from);
    fs::create_dir_all(&folder)?;
    fs::write(folder.join(name), content)?;
    println!("written: {}", folder.join(name).display());
    Ok(())
}

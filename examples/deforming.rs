//! A deforming scene frame by frame: a pleated cloth with travelling waves, a ball that passes down through it, a table that
//! stays. For each frame: the contacts, the time, what was skipped, and how much a tenth of the time finds; a picture, and a page with all frames.
//!
//! `cargo run --release --example deforming`

use std::env;
use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use satisfice_collision::broad::Method;
use satisfice_collision::distance::{PairKind, Threshold};
use satisfice_collision::scene::{Body, BodyId, Completeness, Contact, Skips, World};
use satisfice_collision::{Mesh, Placement, generate};
use satisfice_page::{Feature, FeatureKind, ScenePage};
use satisfice_picture::{Picture, View};

const KIND: PairKind = PairKind::TriangleTriangle;
/// The flat cloth is 3 long and 1 wide.
const DELTA: f64 = 0.012;
const GAP: f64 = 0.05;
const LAYERS: usize = 5;
const FRAMES: usize = 20;
/// The cloth rests from this frame on, the ball from three frames later.
const REST: usize = 12;
/// The frame compared with brute force.
const SAMPLED: usize = 7;
/// The page lists so many pairs of a frame, evenly chosen.
const LISTED: usize = 800;
/// The frame drawn.
const DRAWN: usize = 11;

const TABLE: BodyId = BodyId::nth(0);
const BALL: BodyId = BodyId::nth(1);
const CLOTH: BodyId = BodyId::nth(2);

fn main() -> Result<(), Box<dyn Error>> {
    let quick = env::var_os("SATISFICE_QUICK").is_some_and(|value| value != "0");
    let film = Film::new(if quick { (61, 17, 1) } else { (121, 41, 3) })?;
    let mut scene = film.scene(Method::Auto)?;
    let mut hurried = film.scene(Method::Auto)?;
    println!(
        "{} triangles of the cloth, {} of the ball, {} of the table; pairs within {DELTA}.\n\
         `kept`: share of a frame's pairs that the frame before had. `tenth`: share of them found in a tenth of the time by a scene\n\
         that knows the frame before.\n",
        film.cloth(0)?.triangles().len(),
        film.ball.triangles().len(),
        film.table.triangles().len()
    );
    println!("frame      ms    pairs   kept  tenth  skipped");
    let mut csv = "frame,milliseconds,pairs,kept,found_in_a_tenth,skipped\n".to_owned();
    let (mut before, mut shares, mut rested) = (Vec::new(), Vec::new(), false);
    let mut page = film.page()?;
    for frame in 0..FRAMES {
        film.go_to(&mut scene, frame)?;
        let (answer, milliseconds) = timed(|| scene.frame())?;
        assert_eq!(answer.completeness, Completeness::Proved);
        let contacts = answer.contacts;

        // The second scene knows all of the last frame and has a tenth of the time for this one; if everything rests,
        // it needs no limit.
        film.go_to(&mut hurried, frame)?;
        let resting = frame > REST + 3;
        let limit = if resting {
            f64::INFINITY
        } else {
            milliseconds / 10.0
        };
        let found = within(&mut hurried, limit)?;
        if resting {
            assert_eq!(
                found, contacts,
                "frame {frame}: contacts of bodies at rest are known"
            );
        }
        assert!(
            found
                .iter()
                .all(|contact| contacts.binary_search(contact).is_ok()),
            "frame {frame}: a budget never invents contacts"
        );
        assert_eq!(
            hurried.frame()?.contacts,
            contacts,
            "frame {frame}: an interrupted frame can be completed"
        );
        hurried.measure_contacts();

        if frame == SAMPLED {
            let (expected, brute) = timed(|| film.brute_force(frame))?;
            assert_eq!(contacts, expected, "frame {frame} differs from brute force");
            assert!(contacts.len() > 100);
            println!(
                "       the {} pairs of frame {frame} are those of brute force, which took {brute:.0} ms",
                expected.len()
            );
        }
        let kept = share(count_in(&contacts, &before), contacts.len());
        let tenth = share(found.len(), contacts.len());
        if frame > 0 && frame < REST {
            shares.push(tenth);
        }
        rested |= resting && answer.skips.unmoved_bodies >= 2;
        let skips = shown(&answer.skips);
        println!(
            "{frame:>5} {milliseconds:>7.2} {:>8} {:>5.0}% {:>6}  {skips}",
            contacts.len(),
            100.0 * kept,
            if resting {
                "rest".to_owned()
            } else {
                format!("{:.0}%", 100.0 * tenth)
            }
        );
        writeln!(
            csv,
            "{frame},{milliseconds},{},{kept},{tenth},{skips}",
            contacts.len()
        )?;
        film.add_frame(&mut page, &scene, frame, &contacts, &found)?;
        if frame == DRAWN {
            write("deforming.png", &film.picture(&scene, frame, &contacts)?)?;
        }
        before = contacts;
    }
    write("deforming.csv", csv.as_bytes())?;
    write("deforming.html", page.html()?.as_bytes())?;
    println!(
        "\nin a tenth of the time {:.0} % of the pairs of a moving frame on the mean",
        100.0 * shares.iter().sum::<f64>() / shares.len() as f64
    );
    assert!(rested, "bodies at rest are not visited");
    Ok(())
}

/// The bodies and how they move.
struct Film {
    /// Columns and rows of the cloth.
    size: (usize, usize),
    ball: Mesh,
    table: Mesh,
}

impl Film {
    fn new((columns, rows, fineness): (usize, usize, u32)) -> Result<Self, Box<dyn Error>> {
        let flat = generate::cloth(1.2, 1.4, 7, 7)?;
        let lower = Placement::from_translation([0.0, 0.0, -1.45 * GAP])?;
        Ok(Self {
            size: (columns, rows),
            ball: generate::icosphere(0.12, fineness)?,
            table: lower.place(&flat)?,
        })
    }

    /// The cloth at a frame: its waves move by 0.003 turns a frame, then rest.
    fn cloth(&self, frame: usize) -> Result<Mesh, Box<dyn Error>> {
        let phase = 0.003 * frame.min(REST) as f64;
        Ok(generate::pleats(self.size.0, self.size.1, LAYERS, GAP, phase)?)
    }

    /// The ball at a frame: it descends from above the cloth.
    fn course(frame: usize) -> Result<Placement, Box<dyn Error>> {
        let height = LAYERS as f64 * GAP + 0.1 - 0.008 * frame.min(REST + 3) as f64;
        Ok(Placement::from_translation([0.05, 0.1, height])?)
    }

    fn scene(&self, method: Method) -> Result<World, Box<dyn Error>> {
        let mut scene = World::new(KIND, Threshold::new(DELTA)?).with_method(method);
        assert_eq!(scene.add(Body::fixed(self.table.clone()))?, TABLE);
        assert_eq!(scene.add(Body::rigid(self.ball.clone()))?, BALL);
        assert_eq!(scene.add(Body::deforming(self.cloth(0)?))?, CLOTH);
        Ok(scene)
    }

    fn go_to(&self, scene: &mut World, frame: usize) -> Result<(), Box<dyn Error>> {
        scene.place(BALL, Self::course(frame)?)?;
        scene.deform(CLOTH, self.cloth(frame)?.vertices())?;
        Ok(())
    }

    /// The same frame by a new scene that decides every pair.
    fn brute_force(&self, frame: usize) -> Result<Vec<Contact>, Box<dyn Error>> {
        let mut scene = self.scene(Method::BruteForce)?;
        self.go_to(&mut scene, frame)?;
        Ok(scene.frame()?.contacts)
    }

    /// A page with the bodies as they begin.
    fn page(&self) -> Result<ScenePage, Box<dyn Error>> {
        let mut page = ScenePage::new("A cloth, a ball and a table");
        page.threshold(DELTA);
        page.method("a tenth of the time of the whole frame");
        let (ball, cloth) = (Self::course(0)?.place(&self.ball)?, self.cloth(0)?);
        for (name, mesh) in [("table", &self.table), ("ball", &ball), ("cloth", &cloth)] {
            page.body(name, mesh.vertices(), mesh.triangles(), mesh.lines());
        }
        Ok(page)
    }

    /// A frame of the page: pairs found in a tenth of the time, and those missed.
    fn add_frame(
        &self,
        page: &mut ScenePage,
        scene: &World,
        frame: usize,
        contacts: &[Contact],
        found: &[Contact],
    ) -> Result<(), Box<dyn Error>> {
        page.frame(format!("frame {frame}"));
        page.move_body(BALL.index(), Self::course(frame)?.place(&self.ball)?.vertices())?;
        page.move_body(CLOTH.index(), self.cloth(frame)?.vertices())?;
        page.counts(Some(found.len() as u64), Some(contacts.len() as u64));
        for contact in contacts.iter().step_by(contacts.len().div_ceil(LISTED).max(1)) {
            let near = scene.proximity(*contact)?;
            let side = |body: BodyId, number| Feature {
                body: body.index(),
                kind: FeatureKind::Triangle,
                number,
            };
            let features = [side(contact.body_a, contact.a), side(contact.body_b, contact.b)];
            let listed = satisfice_page::Contact::new(features, [near.point_a, near.point_b]);
            let listed = listed.distance(near.distance);
            page.contact(match found.binary_search(contact) {
                Ok(_) => listed,
                Err(_) => listed.missed(),
            });
        }
        Ok(())
    }

    fn picture(&self, scene: &World, frame: usize, contacts: &[Contact]) -> Result<Vec<u8>, Box<dyn Error>> {
        let (ball, cloth) = (Self::course(frame)?.place(&self.ball)?, self.cloth(frame)?);
        let view = View {
            azimuth: -62.0,
            elevation: 22.0,
            ..View::default()
        };
        let mut picture = Picture::new(1200, 760, view);
        for body in [&self.table, &ball, &cloth] {
            picture.body(body);
        }
        for contact in contacts {
            picture.highlight(contact.body_a.index(), contact.a);
            picture.highlight(contact.body_b.index(), contact.b);
            // Contacts of the cloth with itself would hide it.
            if contact.body_a != contact.body_b {
                let nearest = scene.proximity(*contact)?;
                picture.pair(nearest.point_a, nearest.point_b, true);
            }
        }
        Ok(picture.png()?)
    }
}

/// The contacts that a scene finds before a deadline, in milliseconds from now.
#[expect(clippy::disallowed_methods, reason = "an example that shows times")]
fn within(scene: &mut World, milliseconds: f64) -> Result<Vec<Contact>, Box<dyn Error>> {
    let start = Instant::now();
    let mut pass = scene.pass();
    scene.advance(&mut pass, &mut |_| {
        start.elapsed().as_secs_f64() * 1e3 > milliseconds
    })?;
    Ok(scene.finish(pass).contacts)
}

/// A result and its time in milliseconds.
#[expect(clippy::disallowed_methods, reason = "an example that shows times")]
fn timed<T, E>(work: impl FnOnce() -> Result<T, E>) -> Result<(T, f64), E> {
    let start = Instant::now();
    Ok((work()?, start.elapsed().as_secs_f64() * 1e3))
}

fn shown(skips: &Skips) -> String {
    let reasons = skips.by_reason().into_iter().filter(|(_, count)| *count > 0);
    let shown: Vec<_> = reasons
        .map(|(reason, count)| format!("{count} {reason}"))
        .collect();
    shown.join("; ")
}

fn count_in(contacts: &[Contact], others: &[Contact]) -> usize {
    let known = |contact: &&Contact| others.binary_search(contact).is_ok();
    contacts.iter().filter(known).count()
}

fn share(part: usize, whole: usize) -> f64 {
    if whole == 0 {
        1.0
    } else {
        part as f64 / whole as f64
    }
}

/// Writes into `out/deforming`, or the folder in `SATISFICE_OUT`.
fn write(name: &str, bytes: &[u8]) -> Result<(), Box<dyn Error>> {
    let folder = env::var_os("SATISFICE_OUT").map_or_else(|| PathBuf::from("out/deforming"), PathBuf::from);
    fs::create_dir_all(&folder)?;
    let path = folder.join(name);
    fs::write(&path, bytes)?;
    println!("       wrote {}", path.display());
    Ok(())
}

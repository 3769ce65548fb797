//! Experiment II: a cloth falls on a sphere. Which particles are in contact, and what happens if contacts do not push back?
//!
//! `cargo run --release --example cloth`; writes its pictures to `out/cloth`, or to the folder `SATISFICE_OUT`.
//! `SATISFICE_QUICK=1` uses a coarse cloth.

use std::error::Error;
use std::path::PathBuf;
use std::{env, fs};

use satisfice_cloth::{Response, Settings, Simulation};
use satisfice_picture::{Picture, View, strip};

const FRAMES: usize = 66;
/// Frames between two pictures.
const EVERY: usize = 11;

fn main() -> Result<(), Box<dyn Error>> {
    let quick = env::var_os("SATISFICE_QUICK").is_some_and(|value| value != "0");
    let folder = env::var_os("SATISFICE_OUT").map_or_else(|| "out/cloth".into(), PathBuf::from);
    fs::create_dir_all(&folder)?;
    let settings = Settings {
        columns: if quick { 32 } else { 128 },
        ..Settings::default()
    };
    let mut firm = Simulation::new(&settings)?;
    let mut loose = Simulation::new(&Settings {
        response: Response::Sphere,
        ..settings
    })?;
    println!(
        "A cloth of {0} x {0} particles, {1} m wide, falls on a sphere of {2} m. Contacts are pairs closer than {3:.1} mm.\n",
        settings.columns,
        settings.width,
        settings.radius,
        1e3 * settings.delta()
    );
    println!("                contacts          pairs of crossing triangles    particles");
    println!("  time    itself    sphere      with contacts      without     in the sphere");
    let (mut pictures, mut crossed) = ([Vec::new(), Vec::new()], [0, 0]);
    for frame in 1..=FRAMES {
        firm.frame()?;
        loose.frame()?;
        if frame % EVERY != 0 {
            continue;
        }
        firm.detect()?;
        loose.detect()?;
        let (with, without) = (firm.crossings()?, loose.crossings()?);
        println!(
            "{:>5.2} s  {:>8}  {:>8}  {:>15}  {:>11}  {:>16}",
            frame as f64 / 60.0,
            firm.contacts().within.len(),
            firm.contacts().sphere.len(),
            with.triangles,
            without.triangles,
            with.inside
        );
        crossed[0] += with.triangles;
        crossed[1] += without.triangles;
        assert_eq!(with.inside, 0, "no particle is inside the sphere");
        for (cloth, pictures) in [&firm, &loose].into_iter().zip(&mut pictures) {
            pictures.push(picture(cloth)?);
        }
    }
    for (pictures, name) in pictures.iter().zip(["cloth.png", "cloth-without-contacts.png"]) {
        fs::write(folder.join(name), strip(pictures, 3)?)?;
        println!("\nlook at {}", folder.join(name).display());
    }
    assert!(
        quick || 10 * crossed[0] <= crossed[1],
        "contacts that push back leave at most a tenth of the crossings: {crossed:?}"
    );
    Ok(())
}

/// The cloth over the sphere, its contacts with itself in vermilion.
fn picture(cloth: &Simulation) -> Result<Vec<u8>, Box<dyn Error>> {
    let mesh = cloth.mesh()?;
    let view = View {
        azimuth: -50.0,
        elevation: 18.0,
        ..View::default()
    };
    let mut picture = Picture::new(520, 420, view);
    picture.body(&mesh);
    picture.body(cloth.sphere());
    for &(i, j) in &cloth.contacts().within {
        picture.pair(mesh.vertex(i), mesh.vertex(j), true);
    }
    Ok(picture.png()?)
}

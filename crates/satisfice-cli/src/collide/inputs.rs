//! The bodies named on the command line: files, scenes, standard input, their placements, and welding.

use std::collections::{BTreeMap, BTreeSet};
use std::io::StdinLock;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use satisfice_catalogue::quantity::shown;
use satisfice_collision::io::{AnimatedScene, Format, PlacedMesh};
use satisfice_collision::{Error, Placement};
use serde::{Deserialize, Serialize};

use super::body::{Meshes, NamedBody};
use super::names::Names;
use super::weld::{self, Welds};
use crate::message;

/// What a mesh from standard input is called.
const STDIN: &str = "stdin";

/// Where the bodies come from.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Inputs {
    pub(super) paths: Vec<PathBuf>,
    /// The format of standard input.
    pub(super) format: Option<String>,
    pub(super) at: Vec<At>,
    /// Vertices of a body that are equal or closer than this become one.
    pub(super) weld: Option<f64>,
}

/// A placement of `--at`: `BODY:x,y,z[,rx,ry,rz[,scale]]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct At {
    /// Number or name of the body.
    body: String,
    to: [f64; 3],
    /// Degrees about x, then y, then z.
    turn: [f64; 3],
    scale: f64,
}

/// Reads the value of `--at`.
pub(crate) fn at(text: &str) -> Result<At, String> {
    const FORM: &str = "write BODY:x,y,z[,rx,ry,rz[,scale]], e.g. 1:0,0,2.5 or arm:1,0,0,0,0,90";
    let (body, numbers) = text.rsplit_once(':').ok_or(FORM)?;
    let number = |word: &str| match word.trim().parse() {
        Ok(x) if f64::is_finite(x) => Ok(x),
        Ok(_) => Err(format!("{FORM}; {} is not finite", word.trim())),
        Err(_) => Err(format!("{FORM}; `{}` is no number", word.trim())),
    };
    let numbers: Vec<f64> = numbers.split(',').map(number).collect::<Result<_, _>>()?;
    let [x, y, z, ref rest @ ..] = numbers[..] else {
        return Err(FORM.to_owned());
    };
    let (turn, scale) = match *rest {
        [] => ([0.0; 3], 1.0),
        [a, b, c] => ([a, b, c], 1.0),
        [a, b, c, scale] if scale != 0.0 => ([a, b, c], scale),
        _ => return Err(FORM.to_owned()),
    };
    Ok(At {
        body: body.to_owned(),
        to: [x, y, z],
        turn,
        scale,
    })
}

impl Inputs {
    /// Whether a path is standard input.
    fn is_stdin(path: &Path) -> bool {
        path == Path::new("-")
    }

    /// Whether standard input is among them.
    pub(super) fn reads_stdin(&self) -> bool {
        self.paths.iter().any(|path| Self::is_stdin(path))
    }

    /// Reads all bodies, in the order of the command line and of their files; also returns every file that was read.
    pub(super) fn read(&self) -> anyhow::Result<(Vec<NamedBody>, Vec<PathBuf>)> {
        let scenes = self.each(
            |path| AnimatedScene::read_resting(path),
            |stream, format| AnimatedScene::read_resting_from(stream, format, STDIN, "."),
        )?;
        let files = files(&scenes);
        let at_rest = |(path, scene): (PathBuf, AnimatedScene)| {
            let bodies = scene.at_rest().with_context(|| path.display().to_string())?;
            Ok((path, bodies))
        };
        let bodies = scenes.into_iter().map(at_rest).collect::<anyhow::Result<_>>()?;
        Ok((self.bodies(bodies)?, files))
    }

    /// Reads the files with the animations of these names; all without a name.
    pub(super) fn scenes(&self, animations: &[&str]) -> anyhow::Result<Vec<(PathBuf, AnimatedScene)>> {
        self.each(
            |path| AnimatedScene::read(path, animations),
            |stream, format| AnimatedScene::read_from(stream, format, STDIN, ".", animations),
        )
    }

    /// All bodies of the scenes at a time.
    pub(super) fn at_time(
        &self,
        scenes: &[(PathBuf, AnimatedScene)],
        seconds: f64,
    ) -> anyhow::Result<Vec<NamedBody>> {
        let bodies = |(path, scene): &(PathBuf, AnimatedScene)| {
            let bodies = scene.at(seconds).with_context(|| path.display().to_string())?;
            Ok((path.clone(), bodies))
        };
        self.bodies(scenes.iter().map(bodies).collect::<anyhow::Result<_>>()?)
    }

    /// What is read of each path, or of standard input.
    fn each(
        &self,
        file: impl Fn(&Path) -> Result<AnimatedScene, Error>,
        stdin: impl Fn(StdinLock<'static>, Format) -> Result<AnimatedScene, Error>,
    ) -> anyhow::Result<Vec<(PathBuf, AnimatedScene)>> {
        self.check()?;
        let mut files = Vec::new();
        for path in &self.paths {
            let read = if Self::is_stdin(path) {
                let format = Format::named(self.format.as_deref().unwrap_or_default())?;
                stdin(std::io::stdin().lock(), format)?
            } else {
                file(path)?
            };
            files.push((path.clone(), read));
        }
        warn_of_uncut_faces(&files);
        Ok(files)
    }

    /// The bodies of all files in their places.
    fn bodies(&self, files: Vec<(PathBuf, Vec<PlacedMesh>)>) -> anyhow::Result<Vec<NamedBody>> {
        if let Some((path, _)) = files.iter().find(|(_, bodies)| bodies.is_empty()) {
            bail!(
                "{}: the file has no body: leave it out, or name the file that was meant",
                path.display()
            );
        }
        let mut files: Vec<(PathBuf, PlacedMesh)> = files
            .into_iter()
            .flat_map(|(path, bodies)| bodies.into_iter().map(move |body| (path.clone(), body)))
            .collect();
        let names = Names::of(&files);
        let mut placed = BTreeSet::new();
        for at in &self.at {
            let number = names.find(&at.body)?;
            if !placed.insert(number) {
                bail!("--at {}: this body is placed before: place it once", at.body);
            }
            let body = &mut files[number].1;
            *body = body.moved(at.to, at.turn, at.scale)?;
        }
        let (mut meshes, mut welds) = (Meshes::default(), Welds::default());
        let bodies = files
            .into_iter()
            .zip(names.into_vec())
            .map(|((file, body), name)| {
                let PlacedMesh { mesh, placement, .. } = body;
                let body = NamedBody {
                    name,
                    file,
                    mesh: meshes.shared(mesh),
                    placement,
                };
                // A place beyond all numbers is refused here.
                let placed = body.placed().with_context(|| body.name.clone())?;
                let Some(distance) = self.weld else {
                    drop(placed);
                    return Ok(body);
                };
                let welded = weld::welded(&placed, distance)?;
                welds.note(&body.name, &placed, &welded);
                drop(placed);
                Ok(NamedBody {
                    mesh: welded.into(),
                    placement: Placement::IDENTITY,
                    ..body
                })
            })
            .collect();
        if let Some(distance) = self.weld {
            welds.say(distance);
        }
        bodies
    }

    fn check(&self) -> anyhow::Result<()> {
        let stdin = self.paths.iter().filter(|path| Self::is_stdin(path)).count();
        match (stdin, &self.format) {
            (2.., _) => bail!("standard input can be read once only: name files for the other meshes"),
            (1, None) => {
                bail!("standard input has no extension: name its format by --format, e.g. --format ply")
            }
            (0, Some(_)) => bail!("--format is for standard input: name it as `-`"),
            _ => Ok(()),
        }
    }
}

/// Every file that was read for these scenes.
pub(super) fn files(scenes: &[(PathBuf, AnimatedScene)]) -> Vec<PathBuf> {
    scenes
        .iter()
        .flat_map(|(_, scene)| scene.files())
        .cloned()
        .collect()
}

/// Says once of each file which of its faces stay fans that do not cover them.
fn warn_of_uncut_faces(scenes: &[(PathBuf, AnimatedScene)]) {
    let all = scenes.iter().flat_map(|(_, scene)| scene.uncut_faces());
    let files: BTreeMap<&Path, usize> = all.map(|uncut| (&*uncut.file, uncut.faces)).collect();
    for (file, faces) in files {
        let (faces, they) = match faces {
            1 => ("1 face that crosses itself".to_owned(), "it stays a fan"),
            many => (
                format!("{} faces that cross themselves", shown::count(many as u64)),
                "they stay fans",
            ),
        };
        message::say(format_args!(
            "warning: {} has {faces}, seen along the normal, or so many corners that cutting takes too long: {they} of triangles \
             about the first corner, whose pairs may not be those of the face",
            file.display()
        ));
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn placements_have_three_six_or_seven_numbers() {
        let full = at("C:arm:1,2,-3, 0,0,90,2").unwrap();
        assert_eq!(
            (full.body.as_str(), full.to, full.turn, full.scale),
            ("C:arm", [1.0, 2.0, -3.0], [0.0, 0.0, 90.0], 2.0)
        );
        assert_eq!(at("0:1,2,3").unwrap().scale, 1.0);
        for text in [
            "",
            "0",
            "0:",
            "0:1,2",
            "0:1,2,3,4",
            "0:1,2,x",
            "0:1,2,inf",
            "0:1,2,3,0,0,0,0",
            "0:1,2,3,4,5,6,7,8",
        ] {
            assert!(at(text).unwrap_err().starts_with("write BODY:"), "{text}");
        }
        for (text, fault) in [
            ("tri:0,0,nan", "; nan is not finite"),
            ("0:1,2,x", "; `x` is no number"),
        ] {
            assert!(at(text).unwrap_err().ends_with(fault), "{text}");
        }
    }
}

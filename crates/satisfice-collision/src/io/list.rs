//! Lists of mesh files with placements, in JSON or TOML.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::Deserialize;

use super::animated::{AnimatedScene, Frames, Play};
use super::format::{Format, Reader};
use super::scene::PlacedMesh;
use super::source::Folder;
use super::text::without_mark;
use super::transform::Instances;
use crate::error::Error;

const NAME: &str = "list of meshes";
const SUMMARY: &str =
    "A list `bodies` of { mesh, name, at = [x, y, z], rotate = [degrees about x, then y, then z], scale }";

pub(super) const JSON: Format = Format {
    name: "json",
    extensions: &["json"],
    summary: SUMMARY,
    reader: Reader::Scene(json),
};

pub(super) const TOML: Format = Format {
    name: "toml",
    extensions: &["toml"],
    summary: SUMMARY,
    reader: Reader::Scene(toml),
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MeshList {
    bodies: Vec<ListedMesh>,
}

/// A mesh and its place: first scaled about its origin, then turned, then moved.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ListedMesh {
    /// A file, relative to the folder of the list.
    mesh: String,
    name: Option<String>,
    #[serde(default)]
    at: [f64; 3],
    #[serde(default)]
    rotate: [f64; 3],
    #[serde(default = "one")]
    scale: f64,
}

fn one() -> f64 {
    1.0
}

fn json(bytes: &[u8], folder: &Folder, play: Play<'_>) -> Result<Box<dyn Frames>, Error> {
    let list = serde_json::from_slice(without_mark(NAME, bytes)?);
    files(list.map_err(|error| Error::malformed(NAME, error))?, folder, play)
}

fn toml(bytes: &[u8], folder: &Folder, play: Play<'_>) -> Result<Box<dyn Frames>, Error> {
    let text = std::str::from_utf8(without_mark(NAME, bytes)?);
    let text = text.map_err(|error| Error::malformed(NAME, error))?;
    let list = ::toml::from_str(text).map_err(|error| {
        let before = error.span().map_or(0, |span| span.start);
        let line = 1 + text.bytes().take(before).filter(|&byte| byte == b'\n').count();
        Error::malformed(NAME, error.message()).at_line(line)
    })?;
    files(list, folder, play)
}

fn files(list: MeshList, folder: &Folder, play: Play<'_>) -> Result<Box<dyn Frames>, Error> {
    let mut files: Vec<(PathBuf, AnimatedScene)> = Vec::new();
    let mut known: BTreeMap<PathBuf, usize> = BTreeMap::new();
    let mut entries = Vec::new();
    for entry in list.bodies {
        let path = folder.join(&entry.mesh);
        let file = match known.get(&path) {
            Some(&file) => file,
            None => {
                let scene = scene(&path, play)?;
                folder.note(scene.files().iter().cloned());
                folder.note_uncut(scene.uncut_faces().iter().cloned());
                known.insert(path.clone(), files.len());
                files.push((path, scene));
                files.len() - 1
            }
        };
        entries.push((entry, file));
    }
    Ok(Box::new(Listed { entries, files }))
}

/// The files of a list, and where its entries place them.
struct Listed {
    /// With the number of the file.
    entries: Vec<(ListedMesh, usize)>,
    files: Vec<(PathBuf, AnimatedScene)>,
}

impl Frames for Listed {
    fn animations(&self) -> Vec<String> {
        self.files
            .iter()
            .flat_map(|(_, scene)| scene.animations())
            .collect()
    }

    fn end(&self) -> Option<f64> {
        self.files
            .iter()
            .filter_map(|(_, scene)| scene.end())
            .reduce(f64::max)
    }

    fn at(&self, seconds: Option<f64>) -> Result<Vec<PlacedMesh>, Error> {
        let parts = |(path, scene): &(PathBuf, AnimatedScene)| {
            let parts = seconds.map_or_else(|| scene.at_rest(), |seconds| scene.at(seconds));
            parts.map_err(|error| error.in_file(path))
        };
        let files: Vec<Vec<PlacedMesh>> = self.files.iter().map(parts).collect::<Result<_, _>>()?;
        let mut instances = Instances::default();
        let mut bodies = Vec::new();
        for (index, (entry, file)) in self.entries.iter().enumerate() {
            let parts = &files[*file];
            if parts.is_empty() {
                let error =
                    Error::unsupported(NAME, format!("body {index} has no mesh: its file has no body"));
                return Err(error.in_file(&self.files[*file].0));
            }
            for part in parts {
                let body = entry.place(part, parts.len() == 1, &mut instances);
                bodies.push(body.map_err(|error| error.in_body(format!("body {index}")))?);
            }
        }
        Ok(bodies)
    }
}

impl ListedMesh {
    /// A body of the file of this entry, in its place.
    fn place(
        &self,
        part: &PlacedMesh,
        is_alone: bool,
        instances: &mut Instances,
    ) -> Result<PlacedMesh, Error> {
        let placed = part.moved_among(self.at, self.rotate, self.scale, instances)?;
        Ok(match &self.name {
            None => placed,
            // The bodies of a scene keep their own names behind the given one.
            Some(name) if is_alone => PlacedMesh {
                name: name.clone(),
                ..placed
            },
            Some(name) => PlacedMesh {
                name: format!("{name}/{}", part.name),
                ..placed
            },
        })
    }
}

/// One file of the list, which is not a list itself.
fn scene(path: &std::path::Path, play: Play<'_>) -> Result<AnimatedScene, Error> {
    let format = Format::of_path(path)?;
    if format == JSON || format == TOML {
        return Err(Error::unsupported(NAME, "a list within a list is not supported").in_file(path));
    }
    AnimatedScene::playing(path, play)
}

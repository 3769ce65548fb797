//! Lists of mesh files with placements, in JSON or TOML.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::Deserialize;

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

fn json(bytes: &[u8], folder: &Folder) -> Result<Vec<PlacedMesh>, Error> {
    let list = serde_json::from_slice(without_mark(NAME, bytes)?);
    bodies(&list.map_err(|error| Error::malformed(NAME, error))?, folder)
}

fn toml(bytes: &[u8], folder: &Folder) -> Result<Vec<PlacedMesh>, Error> {
    let text = std::str::from_utf8(without_mark(NAME, bytes)?);
    let text = text.map_err(|error| Error::malformed(NAME, error))?;
    let list = ::toml::from_str(text).map_err(|error| {
        let before = error.span().map_or(0, |span| span.start);
        let line = 1 + text.bytes().take(before).filter(|&byte| byte == b'\n').count();
        Error::malformed(NAME, error.message()).at_line(line)
    })?;
    bodies(&list, folder)
}

fn bodies(list: &MeshList, folder: &Folder) -> Result<Vec<PlacedMesh>, Error> {
    let mut files: BTreeMap<PathBuf, Vec<PlacedMesh>> = BTreeMap::new();
    let mut instances = Instances::default();
    let mut bodies = Vec::new();
    for (index, entry) in list.bodies.iter().enumerate() {
        let path = folder.join(&entry.mesh);
        if !files.contains_key(&path) {
            files.insert(path.clone(), parts(&path)?);
        }
        let parts = &files[&path];
        for part in parts {
            let body = entry.place(part, parts.len() == 1, &mut instances);
            bodies.push(body.map_err(|error| error.in_body(format!("body {index}")))?);
        }
    }
    Ok(bodies)
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

/// The bodies of one file of the list, which is not a list itself.
fn parts(path: &std::path::Path) -> Result<Vec<PlacedMesh>, Error> {
    let format = Format::of_path(path)?;
    if format == JSON || format == TOML {
        return Err(Error::unsupported(NAME, "a list within a list is not supported").in_file(path));
    }
    super::read_scene(path)
}

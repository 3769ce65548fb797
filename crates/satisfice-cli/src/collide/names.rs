//! What bodies are called in messages and reports, and which one a name means.

use std::path::{Path, PathBuf};

use anyhow::bail;
use satisfice_collision::io::{Format, PlacedMesh};

/// The names of all bodies, each of which names one body only.
pub(super) struct Names {
    /// As short as they can be without naming two.
    names: Vec<String>,
    /// Other ways to name the same body: the file with its folders, its name without them, and that without its extension.
    also: Vec<[String; 3]>,
}

impl Names {
    /// A mesh is called like its file, a body of a scene as the scene calls it. Files of one name in two folders are called with
    /// their folders, and bodies that still have one name are numbered.
    pub(super) fn of(bodies: &[(PathBuf, PlacedMesh)]) -> Self {
        let also: Vec<[String; 3]> = bodies
            .iter()
            .map(|(path, body)| {
                let [full, file] = match is_mesh(path) {
                    true => [path.display().to_string(), file_name(path)],
                    false => [body.name.clone(), body.name.clone()],
                };
                [full, file, body.name.clone()]
            })
            .collect();
        let mut names: Vec<String> = also.iter().map(|[_, file, _]| file.clone()).collect();
        for same in repeated(&names) {
            // Folders tell files apart; a file that is there twice is not told from itself by them.
            if same.iter().any(|&number| also[number][0] != also[same[0]][0]) {
                same.iter()
                    .for_each(|&number| names[number].clone_from(&also[number][0]));
            }
        }
        for number in repeated(&names).into_iter().flatten() {
            names[number] = format!("{}#{number}", names[number]);
        }
        Self { names, also }
    }

    /// The number of the body that is meant by a name or number.
    ///
    /// # Errors
    ///
    /// If no body or more than one is called so.
    pub(super) fn find(&self, name: &str) -> anyhow::Result<usize> {
        if let Some(number) = self.names.iter().position(|known| known == name) {
            return Ok(number);
        }
        let called: Vec<usize> = (0..self.names.len())
            .filter(|&number| self.also[number].iter().any(|known| known == name))
            .collect();
        match called[..] {
            [number] => Ok(number),
            [first, second, ..] => bail!(
                "--at {name}: bodies {first} and {second} are called so; name one by its number, or as `{}`",
                self.names[first]
            ),
            [] => match name.parse() {
                Ok(number) if number < self.names.len() => Ok(number),
                _ => bail!(
                    "--at {name}: there is no such body: give a number from 0 to {}, or a name such as {}",
                    self.names.len().saturating_sub(1),
                    self.example()
                ),
            },
        }
    }

    /// A name of the first body that is of no other one, the shortest such.
    fn example(&self) -> &str {
        let short = self.also.first().map(|[_, _, short]| short.as_str());
        let is_own = |short: &&str| {
            self.also
                .iter()
                .filter(|also| also.iter().any(|name| name == short))
                .count()
                == 1
        };
        let long = || self.names.first().map_or("", String::as_str);
        short.filter(is_own).unwrap_or_else(long)
    }

    /// All names, in the order of the bodies.
    pub(super) fn into_vec(self) -> Vec<String> {
        self.names
    }
}

/// Whether the file is a mesh and not a scene, which has names for its bodies.
fn is_mesh(path: &Path) -> bool {
    Format::of_path(path).is_ok_and(|format| !format.is_scene())
}

fn file_name(path: &Path) -> String {
    path.file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}

/// The places of each name that stands there more than once.
fn repeated(names: &[String]) -> Vec<Vec<usize>> {
    let mut places: Vec<usize> = (0..names.len()).collect();
    places.sort_by_key(|&place| &names[place]);
    let same = places.chunk_by(|&a, &b| names[a] == names[b]);
    same.filter(|same| same.len() > 1)
        .map(<[usize]>::to_vec)
        .collect()
}

//! Scenes whose bodies move with time.

use std::fmt;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::faces::UncutFaces;
use super::scene::{PlacedMesh, make_names_unique};
use super::source::{self, Folder};
use super::{Format, frames};
use crate::error::Error;

/// A scene file with its animations, read once and asked for any number of times.
///
/// Animations of glTF nodes are played: translation, rotation and scale, linear, in steps or along cubic splines. Bodies
/// without one rest, as do those of all other formats. A list of meshes plays the animations of its files.
///
/// Animations that move different things are played together, since many programs write one for each object. Two that set the
/// same property of a node are an error: choose one of them by its name. An animation without a name is called by its
/// number, from 0.
///
/// ```no_run
/// use satisfice_collision::io::AnimatedScene;
/// let robot = AnimatedScene::read("robot.glb", &["wave"])?;
/// let (from, to) = (robot.at(0.5)?, robot.at(0.6)?);
/// assert_eq!(from[0].name, to[0].name);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
pub struct AnimatedScene {
    frames: Box<dyn Frames>,
    files: Vec<PathBuf>,
    uncut: Vec<UncutFaces>,
}

/// The bodies of a file at any time.
pub(super) trait Frames: Send + Sync {
    /// The names of all animations of the file.
    fn animations(&self) -> Vec<String>;

    /// When the last of those that are played ends, in seconds.
    fn end(&self) -> Option<f64>;

    /// The bodies at a time in seconds; without one, as the file places them.
    fn at(&self, seconds: Option<f64>) -> Result<Vec<PlacedMesh>, Error>;
}

/// Which animations of a file are read.
#[derive(Clone, Copy)]
pub(super) enum Play<'a> {
    Nothing,
    All,
    Named(&'a [&'a str]),
}

impl Play<'_> {
    pub(super) fn has(self, name: &str) -> bool {
        match self {
            Self::Nothing => false,
            Self::All => true,
            Self::Named(names) => names.contains(&name),
        }
    }
}

impl AnimatedScene {
    /// Reads a scene and the animations of these names; all without a name. Names that the file does not have are passed
    /// over, so that several files can be asked for the same names; [`AnimatedScene::animations`] tells which it has.
    ///
    /// # Errors
    /// Those of [`read_scene`](super::read_scene); [`Error::Malformed`] for an animation whose keys are missing, not finite or
    /// not in order; [`Error::Unsupported`] for morph targets, and for two animations that set the same property of a node.
    pub fn read(path: impl AsRef<Path>, animations: &[&str]) -> Result<Self, Error> {
        Self::playing(path.as_ref(), play(animations))
    }

    /// The same from a stream, as [`read_scene_from`](super::read_scene_from) reads one.
    ///
    /// # Errors
    /// As [`AnimatedScene::read`].
    pub fn read_from(
        stream: impl Read,
        format: Format,
        name: &str,
        folder: impl AsRef<Path>,
        animations: &[&str],
    ) -> Result<Self, Error> {
        Self::playing_from(stream, format, name, folder.as_ref(), play(animations))
    }

    /// Reads a scene without its animations, for [`AnimatedScene::at_rest`]: as [`read_scene`](super::read_scene), but it also tells
    /// its [files](AnimatedScene::files).
    ///
    /// # Errors
    /// Those of [`read_scene`](super::read_scene).
    pub fn read_resting(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::playing(path.as_ref(), Play::Nothing)
    }

    /// The same from a stream, as [`read_scene_from`](super::read_scene_from) reads one.
    ///
    /// # Errors
    /// As [`AnimatedScene::read_resting`].
    pub fn read_resting_from(
        stream: impl Read,
        format: Format,
        name: &str,
        folder: impl AsRef<Path>,
    ) -> Result<Self, Error> {
        Self::playing_from(stream, format, name, folder.as_ref(), Play::Nothing)
    }

    pub(super) fn playing(path: &Path, play: Play<'_>) -> Result<Self, Error> {
        let format = Format::of_path(path)?;
        let bytes = source::file(path)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let mut scene =
            Self::of(format, &bytes, Folder::of(path), &name, play).map_err(|error| error.in_file(path))?;
        scene.files.insert(0, path.to_owned());
        Ok(scene)
    }

    fn playing_from(
        stream: impl Read,
        format: Format,
        name: &str,
        folder: &Path,
        play: Play<'_>,
    ) -> Result<Self, Error> {
        let bytes = source::stream(stream)?;
        Self::of(format, &bytes, Folder::new(folder), name, play).map_err(|error| error.in_file("-".as_ref()))
    }

    /// The scene of a file with these contents.
    pub(super) fn of(
        format: Format,
        bytes: &[u8],
        folder: Folder,
        name: &str,
        play: Play<'_>,
    ) -> Result<Self, Error> {
        let frames = frames(format, bytes, &folder, name, play)?;
        let (files, uncut) = folder.into_notes();
        Ok(Self { frames, files, uncut })
    }

    /// Every file that was read for it: its own, unless it came from a stream, and those that it names.
    #[must_use]
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// The faces of its files that stay fans of triangles which do not cover them, where there are any.
    ///
    /// ```
    /// use satisfice_collision::io::{AnimatedScene, Format};
    /// let bow_tie = &b"v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1.5 0\nf 1 2 3 4"[..];
    /// let scene = AnimatedScene::read_resting_from(bow_tie, Format::named("obj")?, "bow", ".")?;
    /// assert_eq!(scene.uncut_faces()[0].faces, 1);
    /// # Ok::<(), satisfice_collision::Error>(())
    /// ```
    #[must_use]
    pub fn uncut_faces(&self) -> &[UncutFaces] {
        &self.uncut
    }

    /// The names of all animations of the file, those that are not played included, in the order of the file.
    #[must_use]
    pub fn animations(&self) -> Vec<String> {
        self.frames.animations()
    }

    /// The time of the last key of all animations that are played, in seconds; `None` if none is.
    #[must_use]
    pub fn end(&self) -> Option<f64> {
        self.frames.end()
    }

    /// The bodies `seconds` after the start, in the same order and with the same names at every time. Before its first key and
    /// after its last one a property keeps their values, as glTF wants it.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a time that is not finite and, in an [`Error::InBody`], for a body that an animation flattens.
    pub fn at(&self, seconds: f64) -> Result<Vec<PlacedMesh>, Error> {
        if !seconds.is_finite() {
            return Err(Error::parameter("seconds", seconds, "a finite number of seconds"));
        }
        self.bodies(Some(seconds))
    }

    /// The bodies as the file places them, whatever its animations are.
    ///
    /// # Errors
    /// [`Error::InBody`] for a body that its place flattens or moves beyond all numbers.
    pub fn at_rest(&self) -> Result<Vec<PlacedMesh>, Error> {
        self.bodies(None)
    }

    fn bodies(&self, seconds: Option<f64>) -> Result<Vec<PlacedMesh>, Error> {
        let mut bodies = self.frames.at(seconds)?;
        make_names_unique(&mut bodies);
        Ok(bodies)
    }
}

fn play<'a>(animations: &'a [&'a str]) -> Play<'a> {
    match animations.is_empty() {
        true => Play::All,
        false => Play::Named(animations),
    }
}

impl fmt::Debug for AnimatedScene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("AnimatedScene")
            .field("animations", &self.animations())
            .field("end", &self.end())
            .finish_non_exhaustive()
    }
}

/// The body of a file of one mesh rests.
impl Frames for PlacedMesh {
    fn animations(&self) -> Vec<String> {
        Vec::new()
    }

    fn end(&self) -> Option<f64> {
        None
    }

    fn at(&self, _: Option<f64>) -> Result<Vec<PlacedMesh>, Error> {
        Ok(vec![self.clone()])
    }
}

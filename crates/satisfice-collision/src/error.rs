//! The error type of this crate: data, from which the message is made.

use std::fmt;
use std::io;
use std::path::PathBuf;

use crate::distance::PairKind;

/// The element to which an index belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Element {
    /// A point element (OBJ `p`).
    Point,
    /// An explicit edge (OBJ `l`).
    Edge,
    /// A triangle.
    Triangle,
    /// A face before it is cut into triangles.
    Face,
    /// A corner of a list of corners (glTF).
    Corner,
}

impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Point => "point",
            Self::Edge => "edge",
            Self::Triangle => "triangle",
            Self::Face => "face",
            Self::Corner => "corner",
        })
    }
}

/// What can be wrong with a mesh, its file, or a parameter. Serial numbers count from 0.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A body needs at least one vertex.
    #[error("the mesh is empty: it has no vertex")]
    EmptyMesh,
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has {axis} = {value}; coordinates must be finite")]
    NonFiniteVertex {
        /// Serial number of the vertex.
        vertex: usize,
        /// `x`, `y` or `z`.
        axis: char,
        /// The offending value.
        value: f64,
    },
    /// An element names a vertex that does not exist.
    #[error("{element} {index} names vertex {}, but the mesh has {}", vertex.saturating_add_unsigned(u64::from(*first)), numbered(*vertices, *first))]
    IndexOutOfRange {
        /// The kind of the element.
        element: Element,
        /// Serial number of the element among its kind.
        index: usize,
        /// The vertex it names, counted from 0 (negative if the file resolves to one before the first).
        vertex: i64,
        /// How many vertices there are.
        vertices: usize,
        /// The number of the first vertex as the file counts, 0 or 1; the message counts likewise.
        first: u8,
    },
    /// A surface with a hole encloses nothing.
    #[error("the surface is not closed: {}, the first of them between vertices {} and {} ({}); close its holes", odd(*edges), edge[0], edge[1], counted(*triangles, "triangle"))]
    NotClosed {
        /// The vertices of the first edge at which an odd number of triangles meet.
        edge: [usize; 2],
        /// How many meet there.
        triangles: usize,
        /// How many such edges there are.
        edges: usize,
    },
    /// Vertices are numbered by `u32`.
    #[error("{vertices} vertices are too many: at most {} can be numbered", u32::MAX)]
    TooManyVertices {
        /// How many there are.
        vertices: usize,
    },
    /// A file can not be opened or read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file can not be written.
    #[error("cannot write {}: {source}", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The extension of a file names no known format.
    #[error("{}: unknown mesh format; the known extensions are {known}", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// The known extensions, separated by commas.
        known: String,
    },
    /// A file does not follow its format.
    #[error("not a valid {format} file: {reason}")]
    Malformed {
        /// The format.
        format: &'static str,
        /// What is wrong, in one line.
        reason: String,
    },
    /// A file uses a part of its format that is not read.
    #[error("{format}: {what}")]
    Unsupported {
        /// The format.
        format: &'static str,
        /// What is not supported, and what to do about it.
        what: String,
    },
    /// What is wrong with a body of a scene.
    #[error("{body}: {source}")]
    InBody {
        /// The name of the body.
        body: String,
        /// The reason.
        source: Box<Error>,
    },
    /// What is wrong with a line of a file; lines count from 1.
    #[error("line {line}: {source}")]
    AtLine {
        /// Number of the line.
        line: usize,
        /// The reason.
        source: Box<Error>,
    },
    /// What is wrong with a file.
    #[error("{}: {source}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: Box<Error>,
    },
    /// A body has none of the features that the pairs of a world are made of.
    #[error("the mesh has no {missing}: each mesh needs {needed} for {pairs} pairs")]
    NoFeature {
        /// What it has not.
        missing: &'static str,
        /// What it needs.
        needed: &'static str,
        /// The kind of the pairs.
        pairs: PairKind,
    },
    /// A parameter lies outside what is allowed.
    #[error("{parameter} = {value} is not allowed: {allowed}")]
    Parameter {
        /// Name of the parameter.
        parameter: &'static str,
        /// The value given, printed.
        value: String,
        /// What is allowed, in words.
        allowed: &'static str,
    },
}

fn counted(count: usize, what: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {what}{plural}")
}

/// So many vertices, and their numbers.
fn numbered(vertices: usize, first: u8) -> String {
    let first = usize::from(first);
    match vertices {
        0 => "no vertex".to_owned(),
        1 => format!("1 vertex ({first})"),
        many => format!("{many} vertices ({first} to {})", many - 1 + first),
    }
}

/// Edges at which an odd number of triangles meet.
fn odd(edges: usize) -> String {
    let verb = if edges == 1 { "has" } else { "have" };
    format!("{} {verb} an odd number of triangles", counted(edges, "edge"))
}

impl Error {
    /// The error itself, without the file, the body and the line in which it was found.
    #[must_use]
    pub fn root(&self) -> &Self {
        match self {
            Self::AtLine { source, .. } | Self::InFile { source, .. } | Self::InBody { source, .. } => {
                source.root()
            }
            other => other,
        }
    }

    pub(crate) fn at_line(self, line: usize) -> Self {
        Self::AtLine {
            line,
            source: Box::new(self),
        }
    }

    pub(crate) fn in_body(self, body: String) -> Self {
        Self::InBody {
            body,
            source: Box::new(self),
        }
    }

    pub(crate) fn in_file(self, path: &std::path::Path) -> Self {
        if matches!(&self, Self::InFile { path: known, .. } if known == path) {
            return self;
        }
        Self::InFile {
            path: path.to_owned(),
            source: Box::new(self),
        }
    }

    pub(crate) fn unsupported(format: &'static str, what: impl Into<String>) -> Self {
        Self::Unsupported {
            format,
            what: what.into(),
        }
    }

    /// [`Error::Malformed`] with the reason in one short line, also if a library gives several.
    pub(crate) fn malformed(format: &'static str, reason: impl fmt::Display) -> Self {
        const LONGEST: usize = 160;
        let words: Vec<String> = reason
            .to_string()
            .split(|c: char| c.is_whitespace() || c.is_control())
            .filter(|word| !word.is_empty())
            .map(str::to_owned)
            .collect();
        let mut reason = words.join(" ");
        if let Some((end, _)) = reason.char_indices().nth(LONGEST) {
            reason.truncate(end);
            reason.push_str(" ...");
        }
        Self::Malformed { format, reason }
    }

    /// [`Error::Parameter`] from anything printable.
    pub(crate) fn parameter(
        parameter: &'static str,
        value: impl fmt::Display,
        allowed: &'static str,
    ) -> Self {
        Self::Parameter {
            parameter,
            value: value.to_string(),
            allowed,
        }
    }
}

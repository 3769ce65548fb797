//! PLY: elements `vertex`, `face` and `edge`; the others are checked and passed over.
//!
//! The reader is our own: the kept one takes several times as long, knows neither `nan` nor `.5` in text, and overwrites
//! an element that appears twice.

mod at_once;
mod header;
mod numbers;

use at_once::{PointShape, TriangleShape};
use header::{Definition, Encoding, Header, Kind, Number};
use numbers::{Ascii, Binary, Numbers};

use super::faces::{Faces, ReadMesh, checked_index};
use super::format::{Format, Reader};
use super::text::without_mark;
use crate::error::{Element, Error};
use crate::mesh::finite;

const NAME: &str = "PLY";
const AXES: [&str; 3] = ["x", "y", "z"];
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];
const ENDS: [&str; 2] = ["vertex1", "vertex2"];

pub(super) const FORMAT: Format = Format {
    name: "ply",
    extensions: &["ply"],
    summary: "Stanford polygons, ASCII or binary in either byte order: elements vertex, face and edge; polygons are cut into triangles",
    reader: Reader::Mesh(parse),
};

fn parse(bytes: &[u8]) -> Result<ReadMesh, Error> {
    let (header, body) = header::parse(without_mark(NAME, bytes)?)?;
    let elements = elements(&header)?;
    match header.encoding {
        Encoding::Ascii => read(&elements, Ascii::new(header.lines, body)),
        Encoding::LittleEndian => read(&elements, Binary::<false> { rest: body }),
        Encoding::BigEndian => read(&elements, Binary::<true> { rest: body }),
    }
}

/// An element, and which of its numbers are wanted.
struct ElementPlan<'a> {
    definition: &'a Definition,
    role: Role,
    steps: Vec<PropertyStep>,
    shape: Option<UsualShape>,
}

/// What many files have in common: their members are read many at a time.
enum UsualShape {
    Points(PointShape),
    Triangles(TriangleShape),
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Role {
    Vertex,
    Face,
    Edge,
    Other,
}

/// What is done with a property.
#[derive(Clone, Copy)]
enum PropertyStep {
    /// Read as coordinate `axis`.
    Coordinate {
        axis: usize,
        number: Number,
    },
    /// Read as one of the two ends of an edge.
    End {
        which: usize,
        number: Number,
    },
    /// Read as the corners of a face.
    Corners {
        count: Number,
        item: Number,
    },
    Pass(Kind),
}

/// What is to be done with each element.
///
/// # Errors
/// [`Error::Malformed`] if a property that is needed is missing or of another type.
fn elements(header: &Header) -> Result<Vec<ElementPlan<'_>>, Error> {
    header.elements.iter().map(plan).collect()
}

fn plan(definition: &Definition) -> Result<ElementPlan<'_>, Error> {
    let steps: Vec<PropertyStep> = definition
        .properties
        .iter()
        .map(|property| step(&definition.name, &property.name, property.kind))
        .collect();
    let count = |wanted: fn(&PropertyStep) -> bool| steps.iter().filter(|step| wanted(step)).count();
    let refuse = |reason: String| Err(Error::malformed(NAME, reason));
    let role = match definition.name.as_str() {
        "vertex" => {
            for (axis, name) in AXES.into_iter().enumerate() {
                let is_axis = |step: &PropertyStep| matches!(step, PropertyStep::Coordinate { axis: a, .. } if *a == axis);
                if !steps.iter().any(is_axis) {
                    return refuse(format!("its vertices have no number {name}"));
                }
            }
            Role::Vertex
        }
        "face" => match count(|step| matches!(step, PropertyStep::Corners { .. })) {
            0 => return refuse("its faces have no list vertex_indices of whole numbers".to_owned()),
            1 => Role::Face,
            _ => return refuse("its faces have two lists of vertices".to_owned()),
        },
        "edge" if count(|step| matches!(step, PropertyStep::End { .. })) < 2 => {
            return refuse("its edges have no whole numbers vertex1 and vertex2".to_owned());
        }
        "edge" => Role::Edge,
        "tristrips" => {
            return Err(Error::unsupported(
                NAME,
                "triangle strips are not supported; export the mesh as faces",
            ));
        }
        _ => Role::Other,
    };
    let shape = match (role, &steps[..]) {
        (Role::Vertex, steps) => PointShape::of(steps).map(UsualShape::Points),
        (Role::Face, &[PropertyStep::Corners { count, item }]) => {
            TriangleShape::of(count, item).map(UsualShape::Triangles)
        }
        _ => None,
    };
    Ok(ElementPlan {
        definition,
        role,
        steps,
        shape,
    })
}

fn step(element: &str, name: &str, kind: Kind) -> PropertyStep {
    match (element, kind) {
        ("vertex", Kind::Scalar(number)) => {
            AXES.iter()
                .position(|axis| *axis == name)
                .map_or(PropertyStep::Pass(kind), |axis| PropertyStep::Coordinate {
                    axis,
                    number,
                })
        }
        ("face", Kind::List { count, item }) if CORNERS.contains(&name) && item.is_whole() => {
            PropertyStep::Corners { count, item }
        }
        ("edge", Kind::Scalar(number)) if number.is_whole() => ENDS
            .iter()
            .position(|end| *end == name)
            .map_or(PropertyStep::Pass(kind), |which| PropertyStep::End {
                which,
                number,
            }),
        _ => PropertyStep::Pass(kind),
    }
}

fn read(elements: &[ElementPlan<'_>], numbers: impl Numbers) -> Result<ReadMesh, Error> {
    let mut body = MeshContents {
        numbers,
        vertex_count: elements
            .iter()
            .find(|plan| plan.role == Role::Vertex)
            .map_or(0, |plan| {
                usize::try_from(plan.definition.count).unwrap_or(usize::MAX)
            }),
        vertices: Vec::new(),
        faces: Faces::default(),
        polygons: 0,
        edges: 0,
        corners: Vec::new(),
    };
    for plan in elements {
        body.element(plan)?;
    }
    body.numbers.finish()?;
    body.faces.mesh(body.vertices)
}

struct MeshContents<N> {
    numbers: N,
    /// How many vertices the header announces.
    vertex_count: usize,
    vertices: Vec<[f64; 3]>,
    faces: Faces,
    polygons: usize,
    edges: usize,
    corners: Vec<u32>,
}

impl<N: Numbers> MeshContents<N> {
    fn element(&mut self, plan: &ElementPlan<'_>) -> Result<(), Error> {
        let Definition {
            name,
            count,
            properties,
        } = plan.definition;
        // Without properties there is nothing to read, whatever the count.
        if properties.is_empty() {
            return Ok(());
        }
        let count = *count;
        let reserved = usize::try_from(count)
            .unwrap_or(usize::MAX)
            .min(self.numbers.at_most(properties.len()));
        match plan.role {
            Role::Vertex => self.vertices.reserve_exact(reserved),
            Role::Face => self.faces.triangles.reserve(reserved),
            Role::Edge => self.faces.lines.reserve(reserved),
            Role::Other => {}
        }
        let mut member = 0;
        loop {
            member += self.at_once(plan, count - member);
            if member == count {
                return Ok(());
            }
            if !self.numbers.begin() {
                let reason = format!("it ends after {member} of {count} members of the element {name:?}");
                return Err(Error::malformed(NAME, reason));
            }
            self.member(plan)
                .map_err(|error| self.numbers.locate(in_member(error, name, member)))?;
            member += 1;
        }
    }

    /// Reads members of a usual shape, at most so many; how many these are.
    fn at_once(&mut self, plan: &ElementPlan<'_>, most: u64) -> u64 {
        match plan.shape {
            Some(UsualShape::Points(ref shape)) => self.numbers.points(shape, most, &mut self.vertices),
            Some(UsualShape::Triangles(ref shape)) => {
                let triangles = &mut self.faces.triangles;
                let read = self.numbers.triangles(shape, most, self.vertex_count, triangles);
                self.polygons += read as usize;
                read
            }
            None => 0,
        }
    }

    fn member(&mut self, plan: &ElementPlan<'_>) -> Result<(), Error> {
        let mut point = [0.0; 3];
        let mut ends = [0; 2];
        for step in &plan.steps {
            match *step {
                PropertyStep::Coordinate { axis, number } => point[axis] = self.numbers.real(number)?,
                PropertyStep::End { which, number } => {
                    let vertex = self.numbers.whole(number)?;
                    ends[which] = checked_index(Element::Edge, self.edges, vertex, self.vertex_count)?;
                }
                PropertyStep::Corners { count, item } => self.corners(count, item)?,
                PropertyStep::Pass(Kind::Scalar(number)) => {
                    self.numbers.real(number)?;
                }
                PropertyStep::Pass(Kind::List { count, item }) => {
                    for _ in 0..self.length(count)? {
                        self.numbers.real(item)?;
                    }
                }
            }
        }
        match plan.role {
            Role::Vertex => self.vertices.push(finite(self.vertices.len(), point)?),
            Role::Face => {
                self.faces.add(&self.corners);
                self.polygons += 1;
            }
            Role::Edge => {
                self.faces.add(&ends);
                self.edges += 1;
            }
            Role::Other => {}
        }
        self.numbers.end()
    }

    fn corners(&mut self, count: Number, item: Number) -> Result<(), Error> {
        self.corners.clear();
        for _ in 0..self.length(count)? {
            let vertex = self.numbers.whole(item)?;
            let corner = checked_index(Element::Face, self.polygons, vertex, self.vertex_count)?;
            self.corners.push(corner);
        }
        Ok(())
    }

    fn length(&mut self, count: Number) -> Result<u64, Error> {
        let length = self.numbers.whole(count)?;
        u64::try_from(length).map_err(|_| Error::malformed(NAME, format!("a list of {length} members")))
    }
}

/// Says which member of which element is malformed; the other errors name the vertex or element themselves.
fn in_member(error: Error, element: &str, member: u64) -> Error {
    match error {
        Error::Malformed { reason, .. } => Error::malformed(NAME, format!("{element} {member}: {reason}")),
        other => other,
    }
}

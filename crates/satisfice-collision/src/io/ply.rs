//! PLY, by way of `ply-rs-bw`.
//!
//! Its ascii grammar knows neither `nan` nor `.5` nor `5.`, and an element without properties may announce 2^64
//! members; so ascii numbers are made plain first, elements are read one by one, and those that are not wanted are
//! passed over.

use std::io::BufRead;

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType,
};

use super::{Faces, checked_index};
use crate::error::{Element, Error};
use crate::mesh::Mesh;

const FORMAT: &str = "PLY";
const AXES: [&str; 3] = ["x", "y", "z"];
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];
const ENDS: [&str; 2] = ["vertex1", "vertex2"];

pub(super) fn parse(bytes: &[u8]) -> Result<Mesh, Error> {
    let mut reader = Reader::new(bytes);
    let header = Parser::<Ignored>::new()
        .read_header(&mut reader)
        .map_err(|error| malformed(&error, 0))?;
    check_header(&header)?;

    let mut vertices: Vec<[f64; 3]> = Vec::new();
    let mut polygons: Vec<Polygon> = Vec::new();
    let mut edges: Vec<Ends> = Vec::new();
    let mut body = Body {
        lines_read: reader.line().saturating_sub(1),
        reader,
        header: &header,
    };
    for (name, element) in &header.elements {
        match name.as_str() {
            "vertex" => vertices = body.read::<Position>(element)?.into_iter().map(|p| p.0).collect(),
            "face" => polygons = body.read(element)?,
            "edge" => edges = body.read(element)?,
            _ => body.pass_over(element)?,
        }
    }

    let mut faces = Faces::default();
    for (index, Ends(ends)) in edges.into_iter().enumerate() {
        let mut corners = [0; 2];
        for (corner, vertex) in corners.iter_mut().zip(ends) {
            *corner = checked_index(Element::Edge, index, vertex, vertices.len())?;
        }
        faces.add(&corners);
    }
    let mut corners = Vec::new();
    for (index, Polygon(polygon)) in polygons.into_iter().enumerate() {
        corners.clear();
        for vertex in polygon {
            corners.push(checked_index(Element::Face, index, vertex, vertices.len())?);
        }
        faces.add(&corners);
    }
    Mesh::new(vertices, faces.lines, faces.triangles)
}

/// Whether the properties that are needed are there.
fn check_header(header: &Header) -> Result<(), Error> {
    let needs = |element: &str, property: &str, list: bool| match header.elements.get(element) {
        Some(def) => def
            .properties
            .get(property)
            .is_some_and(|p| matches!(p.data_type, PropertyType::List(..)) == list),
        None => true,
    };
    for axis in AXES {
        if !needs("vertex", axis, false) {
            return Err(Error::malformed(
                FORMAT,
                format!("its vertices have no number {axis}"),
            ));
        }
    }
    if !CORNERS.iter().any(|list| needs("face", list, true)) {
        return Err(Error::malformed(FORMAT, "its faces have no list vertex_indices"));
    }
    if !ENDS.iter().all(|end| needs("edge", end, false)) {
        return Err(Error::malformed(
            FORMAT,
            "its edges have no numbers vertex1 and vertex2",
        ));
    }
    if header.elements.contains_key("tristrips") {
        return Err(Error::malformed(
            FORMAT,
            "triangle strips are not supported, only faces",
        ));
    }
    Ok(())
}

/// What follows the header.
struct Body<'a> {
    reader: Reader<&'a [u8]>,
    header: &'a Header,
    /// Lines before the next one, for messages about ascii files.
    lines_read: usize,
}

impl Body<'_> {
    fn read<E: PropertyAccess>(&mut self, element: &ElementDef) -> Result<Vec<E>, Error> {
        if element.count == 0 {
            return Ok(Vec::new());
        }
        if self.header.encoding != Encoding::Ascii {
            return Parser::<E>::new()
                .read_payload_for_element(&mut self.reader, element, self.header)
                // Lines mean nothing in a binary file.
                .map_err(|error| Error::malformed(FORMAT, strip_line(&error)));
        }
        let before = self.lines_read;
        let text = self.plain_ascii(element)?;
        Parser::<E>::new()
            .read_payload_for_element(&mut Reader::new(text.as_bytes()), element, self.header)
            .map_err(|error| malformed(&error, before))
    }

    fn pass_over(&mut self, element: &ElementDef) -> Result<(), Error> {
        // Without properties there is nothing to read, whatever the count.
        if element.properties.is_empty() || element.count == 0 {
            return Ok(());
        }
        if self.header.encoding == Encoding::Ascii {
            for member in 0..element.count {
                self.next_line(element, member)?;
            }
            return Ok(());
        }
        self.read::<Ignored>(element).map(|_| ())
    }

    /// The lines of an element with every number in a form that the library's grammar knows, and numbers that are not
    /// finite named if they are coordinates, else 0.
    fn plain_ascii(&mut self, element: &ElementDef) -> Result<String, Error> {
        let mut plain = String::new();
        for member in 0..element.count {
            let line = self.next_line(element, member)?;
            let mut words = line.split_whitespace();
            for (name, property) in &element.properties {
                let mut left = 1;
                let mut is_count = matches!(property.data_type, PropertyType::List(..));
                while left > 0 {
                    let Some(word) = words.next() else { break };
                    left -= 1;
                    if is_count {
                        is_count = false;
                        left = word.parse().unwrap_or(0);
                    }
                    match plain_number(word) {
                        Ok(number) => plain.push_str(&number),
                        Err(value) => match AXES.iter().position(|axis| axis == name) {
                            Some(k) if element.name == "vertex" => {
                                let axis = ['x', 'y', 'z'][k];
                                let error = Error::NonFiniteVertex {
                                    vertex: member,
                                    axis,
                                    value,
                                };
                                return Err(error.at_line(self.lines_read));
                            }
                            _ => plain.push('0'),
                        },
                    }
                    plain.push(' ');
                }
            }
            plain.push('\n');
        }
        Ok(plain)
    }

    /// The next line that is not blank.
    fn next_line(&mut self, element: &ElementDef, member: usize) -> Result<String, Error> {
        let mut bytes = Vec::new();
        loop {
            bytes.clear();
            let read = self.reader.get_mut().read_until(b'\n', &mut bytes);
            if !matches!(read, Ok(count) if count > 0) {
                let ElementDef { name, count, .. } = element;
                let reason = format!("it ends after {member} of {count} members of the element {name:?}");
                return Err(Error::malformed(FORMAT, reason));
            }
            self.lines_read += 1;
            if !bytes.trim_ascii().is_empty() {
                return Ok(String::from_utf8_lossy(&bytes).into_owned());
            }
        }
    }
}

/// A number with digits on both sides of its point, changed in nothing else (its type decides how it is rounded); the
/// value if it is not finite. What is no number stays as it is, for the library to refuse.
fn plain_number(word: &str) -> Result<String, f64> {
    match word.parse::<f64>() {
        Err(_) => return Ok(word.to_owned()),
        Ok(value) if !value.is_finite() => return Err(value),
        Ok(_) => {}
    }
    let (mantissa, exponent) = word.find(['e', 'E']).map_or((word, ""), |k| word.split_at(k));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let zero = if whole.ends_with(|c: char| c.is_ascii_digit()) {
        ""
    } else {
        "0"
    };
    let point = if fraction.is_empty() { "" } else { "." };
    Ok([whole, zero, point, fraction, exponent].concat())
}

fn malformed(error: &ParseError, lines_before: usize) -> Error {
    let plain = Error::malformed(FORMAT, strip_line(error));
    match error.line() {
        Some(line) => plain.at_line(lines_before + line),
        None => plain,
    }
}

/// The library's message without the number of the line, which we place and count ourselves.
fn strip_line(error: &ParseError) -> String {
    let text = error.to_string();
    match (error.line(), text.split_once(": ")) {
        (Some(_), Some((_, rest))) => rest.to_owned(),
        _ => text,
    }
}

/// Passes over whatever an element holds.
struct Ignored;

impl PropertyAccess for Ignored {
    fn new() -> Self {
        Self
    }
}

/// Coordinates of any numeric type.
struct Position([f64; 3]);

impl PropertyAccess for Position {
    fn new() -> Self {
        Self([0.0; 3])
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let Some(k) = AXES.iter().position(|axis| *axis == name) else {
            return PropertyAccessResult::Ignored;
        };
        self.0[k] = match value {
            Property::Char(v) => f64::from(v),
            Property::UChar(v) => f64::from(v),
            Property::Short(v) => f64::from(v),
            Property::UShort(v) => f64::from(v),
            Property::Int(v) => f64::from(v),
            Property::UInt(v) => f64::from(v),
            Property::Float(v) => f64::from(v),
            Property::Double(v) => v,
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

/// The corners of a face, of any integer type.
struct Polygon(Vec<i64>);

impl PropertyAccess for Polygon {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if !CORNERS.contains(&name) {
            return PropertyAccessResult::Ignored;
        }
        self.0 = match value {
            Property::ListChar(v) => v.into_iter().map(i64::from).collect(),
            Property::ListUChar(v) => v.into_iter().map(i64::from).collect(),
            Property::ListShort(v) => v.into_iter().map(i64::from).collect(),
            Property::ListUShort(v) => v.into_iter().map(i64::from).collect(),
            Property::ListInt(v) => v.into_iter().map(i64::from).collect(),
            Property::ListUInt(v) => v.into_iter().map(i64::from).collect(),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

/// The ends of an edge, of any integer type.
struct Ends([i64; 2]);

impl PropertyAccess for Ends {
    fn new() -> Self {
        Self([0; 2])
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let Some(k) = ENDS.iter().position(|end| *end == name) else {
            return PropertyAccessResult::Ignored;
        };
        self.0[k] = match value {
            Property::Char(v) => i64::from(v),
            Property::UChar(v) => i64::from(v),
            Property::Short(v) => i64::from(v),
            Property::UShort(v) => i64::from(v),
            Property::Int(v) => i64::from(v),
            Property::UInt(v) => i64::from(v),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

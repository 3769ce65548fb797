//! The header of a PLY file: its encoding, its elements and their properties.

use super::NAME;
use crate::error::Error;
use crate::io::text::{Words, quoted};

pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Definition>,
    /// How many lines it has.
    pub(super) lines: usize,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// An element as the header defines it.
pub(super) struct Definition {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

#[derive(Clone, Copy)]
pub(super) enum Kind {
    Scalar(Number),
    List { count: Number, item: Number },
}

/// The types of numbers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Number {
    fn of(word: &[u8]) -> Result<Self, Error> {
        Ok(match word {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return Err(malformed(format!("unknown type {}", quoted(word)))),
        })
    }

    /// How many bytes one takes in a binary file.
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub(super) fn is_whole(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// The least and the greatest whole number of this type.
    pub(super) fn range(self) -> (i64, i64) {
        match self {
            Self::I8 => (i8::MIN.into(), i8::MAX.into()),
            Self::U8 => (0, u8::MAX.into()),
            Self::I16 => (i16::MIN.into(), i16::MAX.into()),
            Self::U16 => (0, u16::MAX.into()),
            Self::I32 => (i32::MIN.into(), i32::MAX.into()),
            Self::U32 => (0, u32::MAX.into()),
            Self::F32 | Self::F64 => (i64::MIN, i64::MAX),
        }
    }
}

fn malformed(reason: impl std::fmt::Display) -> Error {
    Error::malformed(NAME, reason)
}

/// Splits a file into its header and what follows.
pub(super) fn parse(bytes: &[u8]) -> Result<(Header, &[u8]), Error> {
    // Binary data may follow the last line, so the end of line must be known: CR alone only if the first line has it.
    let first_end = bytes.iter().position(|b| matches!(b, b'\n' | b'\r'));
    let only_cr =
        first_end.is_some_and(|k| bytes[k..].starts_with(b"\r") && !bytes[k..].starts_with(b"\r\n"));
    let end_of_line = if only_cr { b'\r' } else { b'\n' };

    let mut draft = Draft::default();
    let mut rest = bytes;
    let mut number = 0;
    loop {
        number += 1;
        let Some(end) = memchr::memchr(end_of_line, rest) else {
            let reason = if number == 1 {
                "it does not begin with a line \"ply\""
            } else {
                "the header has no end"
            };
            return Err(malformed(reason).at_line(number));
        };
        let is_last = draft
            .line(number, Words(&rest[..end]))
            .map_err(|error| error.at_line(number))?;
        rest = &rest[end + 1..];
        if is_last {
            let header = draft.header(number).map_err(|error| error.at_line(number))?;
            return Ok((header, rest));
        }
    }
}

#[derive(Default)]
struct Draft {
    encoding: Option<Encoding>,
    elements: Vec<Definition>,
}

impl Draft {
    /// Takes a line; whether it was the last one.
    fn line(&mut self, number: usize, mut words: Words<'_>) -> Result<bool, Error> {
        let keyword = words.next().unwrap_or_default();
        if number == 1 {
            return match (keyword, words.next()) {
                (b"ply", None) => Ok(false),
                _ => Err(malformed("it does not begin with a line \"ply\"")),
            };
        }
        match keyword {
            b"comment" | b"obj_info" | b"" => return Ok(false),
            b"end_header" => return Ok(true),
            b"format" => self.format(&mut words)?,
            b"element" => self.element(&mut words)?,
            b"property" => self.property(&mut words)?,
            _ => {
                return Err(malformed(format!(
                    "unknown keyword {} in the header",
                    quoted(keyword)
                )));
            }
        }
        match words.next() {
            None => Ok(false),
            Some(word) => Err(malformed(format!("{} is one word too many", quoted(word)))),
        }
    }

    fn format(&mut self, words: &mut Words<'_>) -> Result<(), Error> {
        let encoding = match words.next().unwrap_or_default() {
            b"ascii" => Encoding::Ascii,
            b"binary_little_endian" => Encoding::LittleEndian,
            b"binary_big_endian" => Encoding::BigEndian,
            other => return Err(malformed(format!("unknown encoding {}", quoted(other)))),
        };
        match words.next() {
            Some(b"1.0") => {}
            other => {
                return Err(malformed(format!(
                    "unknown version {}",
                    quoted(other.unwrap_or_default())
                )));
            }
        }
        match self.encoding.replace(encoding) {
            None => Ok(()),
            Some(_) => Err(malformed("a second line \"format\"")),
        }
    }

    fn element(&mut self, words: &mut Words<'_>) -> Result<(), Error> {
        let name = name(words)?;
        if self.elements.iter().any(|element| element.name == name) {
            return Err(malformed(format!("a second element {name:?}")));
        }
        let word = words.next().unwrap_or_default();
        let count = std::str::from_utf8(word)
            .ok()
            .and_then(|word| word.parse().ok())
            .ok_or_else(|| malformed(format!("the element {name:?} has the count {}", quoted(word))))?;
        self.elements.push(Definition {
            name,
            count,
            properties: Vec::new(),
        });
        Ok(())
    }

    fn property(&mut self, words: &mut Words<'_>) -> Result<(), Error> {
        let kind = match words.next().unwrap_or_default() {
            b"list" => Kind::List {
                count: Number::of(words.next().unwrap_or_default())?,
                item: Number::of(words.next().unwrap_or_default())?,
            },
            word => Kind::Scalar(Number::of(word)?),
        };
        let name = name(words)?;
        if matches!(kind, Kind::List { count, .. } if !count.is_whole()) {
            return Err(malformed(format!(
                "the list {name:?} is counted by no whole numbers"
            )));
        }
        let element = self
            .elements
            .last_mut()
            .ok_or_else(|| malformed("a property before the first element"))?;
        if element.properties.iter().any(|property| property.name == name) {
            let element = &element.name;
            return Err(malformed(format!(
                "a second property {name:?} of the element {element:?}"
            )));
        }
        element.properties.push(Property { name, kind });
        Ok(())
    }

    fn header(self, lines: usize) -> Result<Header, Error> {
        Ok(Header {
            encoding: self
                .encoding
                .ok_or_else(|| malformed("the header has no line \"format\""))?,
            elements: self.elements,
            lines,
        })
    }
}

fn name(words: &mut Words<'_>) -> Result<String, Error> {
    let word = words.next().ok_or_else(|| malformed("a name is missing"))?;
    Ok(String::from_utf8_lossy(word).into_owned())
}

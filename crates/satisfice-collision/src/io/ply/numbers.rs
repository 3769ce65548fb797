//! The numbers of a PLY file, one after another: as words of a line or as bytes of either order.

use super::NAME;
use super::at_once::{PointShape, TriangleShape};
use super::header::Number;
use crate::error::Error;
use crate::io::text::{Lines, Words, quoted, real, whole};

/// What follows the header, number by number.
pub(super) trait Numbers {
    /// Begins the next member of an element; `false` if there is none.
    fn begin(&mut self) -> bool;
    /// A number of any type. The text of an ASCII file is rounded to the type of the property.
    fn real(&mut self, kind: Number) -> Result<f64, Error>;
    /// A number of a whole type.
    fn whole(&mut self, kind: Number) -> Result<i64, Error>;
    /// Reads at most so many whole points of this shape; how many.
    fn points(&mut self, _shape: &PointShape, _most: u64, _points: &mut Vec<[f64; 3]>) -> u64 {
        0
    }
    /// Reads at most so many whole triangles of this shape between so many vertices; how many.
    fn triangles(
        &mut self,
        _shape: &TriangleShape,
        _most: u64,
        _vertices: usize,
        _triangles: &mut Vec<[u32; 3]>,
    ) -> u64 {
        0
    }
    /// Ends a member.
    fn end(&mut self) -> Result<(), Error>;
    /// Refuses what is left after the last member.
    fn finish(&mut self) -> Result<(), Error>;
    /// An upper bound on how many members of so many numbers can follow, for reserving memory.
    fn at_most(&self, numbers: usize) -> usize;
    /// Says where in the file an error is.
    fn locate(&self, error: Error) -> Error;
}

fn malformed(reason: impl std::fmt::Display) -> Error {
    Error::malformed(NAME, reason)
}

/// A member stands on a line of its own; blank lines are skipped.
pub(super) struct Ascii<'a> {
    pub(super) lines: Lines<'a>,
    pub(super) words: Words<'a>,
    pub(super) bytes: usize,
}

impl<'a> Ascii<'a> {
    pub(super) fn new(lines_before: usize, text: &'a [u8]) -> Self {
        Self {
            lines: Lines::after(lines_before, text),
            words: Words(b""),
            bytes: text.len(),
        }
    }

    fn next_word(&mut self) -> Result<&'a [u8], Error> {
        self.words
            .next()
            .ok_or_else(|| malformed("the line has fewer numbers than the header says"))
    }
}

impl Numbers for Ascii<'_> {
    fn begin(&mut self) -> bool {
        for line in self.lines.by_ref() {
            if !line.trim_ascii().is_empty() {
                self.words = Words(line);
                return true;
            }
        }
        false
    }

    fn real(&mut self, kind: Number) -> Result<f64, Error> {
        if kind.is_whole() {
            return self.whole(kind).map(|value| value as f64);
        }
        let word = self.next_word()?;
        let value = match kind {
            Number::F32 => real::<f32>(word).map(f64::from),
            _ => real::<f64>(word),
        };
        value.ok_or_else(|| malformed(format!("{} is not a number", quoted(word))))
    }

    fn whole(&mut self, kind: Number) -> Result<i64, Error> {
        let word = self.next_word()?;
        let (least, greatest) = kind.range();
        whole(word)
            .filter(|value| (least..=greatest).contains(value))
            .ok_or_else(|| {
                malformed(format!(
                    "{} is not a whole number from {least} to {greatest}",
                    quoted(word)
                ))
            })
    }

    fn end(&mut self) -> Result<(), Error> {
        match self.words.next() {
            None => Ok(()),
            Some(_) => Err(malformed("the line has more numbers than the header says")),
        }
    }

    fn finish(&mut self) -> Result<(), Error> {
        if self.begin() {
            let error = malformed("a line follows the last element that the header announces");
            return Err(self.locate(error));
        }
        Ok(())
    }

    fn at_most(&self, numbers: usize) -> usize {
        self.bytes / (2 * numbers).max(1)
    }

    fn locate(&self, error: Error) -> Error {
        error.at_line(self.lines.number())
    }
}

pub(super) struct Binary<'a, const BIG_ENDIAN: bool> {
    pub(super) rest: &'a [u8],
}

impl<const BIG_ENDIAN: bool> Binary<'_, BIG_ENDIAN> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], Error> {
        let (bytes, rest) = self
            .rest
            .split_first_chunk::<N>()
            .ok_or_else(|| malformed("the file ends too early"))?;
        self.rest = rest;
        let mut bytes = *bytes;
        if BIG_ENDIAN {
            bytes.reverse();
        }
        Ok(bytes)
    }
}

impl<const BIG_ENDIAN: bool> Numbers for Binary<'_, BIG_ENDIAN> {
    fn begin(&mut self) -> bool {
        !self.rest.is_empty()
    }

    fn real(&mut self, kind: Number) -> Result<f64, Error> {
        Ok(match kind {
            Number::F32 => f32::from_le_bytes(self.take()?).into(),
            Number::F64 => f64::from_le_bytes(self.take()?),
            _ => self.whole(kind)? as f64,
        })
    }

    fn whole(&mut self, kind: Number) -> Result<i64, Error> {
        Ok(match kind {
            Number::I8 => i8::from_le_bytes(self.take()?).into(),
            Number::U8 => u8::from_le_bytes(self.take()?).into(),
            Number::I16 => i16::from_le_bytes(self.take()?).into(),
            Number::U16 => u16::from_le_bytes(self.take()?).into(),
            Number::I32 => i32::from_le_bytes(self.take()?).into(),
            Number::U32 => u32::from_le_bytes(self.take()?).into(),
            Number::F32 | Number::F64 => self.real(kind)? as i64,
        })
    }

    fn points(&mut self, shape: &PointShape, most: u64, points: &mut Vec<[f64; 3]>) -> u64 {
        let (bytes, count) = shape.read::<BIG_ENDIAN>(self.rest, most, points);
        self.rest = &self.rest[bytes..];
        count
    }

    fn triangles(
        &mut self,
        shape: &TriangleShape,
        most: u64,
        vertices: usize,
        triangles: &mut Vec<[u32; 3]>,
    ) -> u64 {
        let (bytes, count) = shape.read::<BIG_ENDIAN>(self.rest, most, vertices, triangles);
        self.rest = &self.rest[bytes..];
        count
    }

    fn end(&mut self) -> Result<(), Error> {
        Ok(())
    }

    fn finish(&mut self) -> Result<(), Error> {
        if self.rest.trim_ascii().is_empty() {
            return Ok(());
        }
        let bytes = self.rest.len();
        Err(malformed(format!(
            "{bytes} bytes follow the last element that the header announces"
        )))
    }

    fn at_most(&self, numbers: usize) -> usize {
        self.rest.len() / numbers.max(1)
    }

    fn locate(&self, error: Error) -> Error {
        error
    }
}

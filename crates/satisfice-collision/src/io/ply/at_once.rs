//! Binary members of the usual shapes, without a look at the type of each number: points at fixed places, and triangles.
//!
//! Whatever is not usual ends a run and is left to the general reader, errors included.

use super::PropertyStep;
use super::header::{Kind, Number};

/// Where the coordinates of a vertex stand.
#[derive(Debug, PartialEq)]
pub(super) struct PointShape {
    /// Bytes of a vertex.
    stride: usize,
    /// The first byte of each coordinate.
    places: [usize; 3],
    /// The type of all three.
    number: Number,
}

impl PointShape {
    /// `None` if vertices have lists, or coordinates of whole numbers or of several types.
    pub(super) fn of(steps: &[PropertyStep]) -> Option<Self> {
        let mut stride = 0;
        let mut places = [0; 3];
        let mut types = [Number::U8; 3];
        for step in steps {
            let number = match *step {
                PropertyStep::Coordinate { axis, number } => {
                    places[axis] = stride;
                    types[axis] = number;
                    number
                }
                PropertyStep::Pass(Kind::Scalar(number)) => number,
                _ => return None,
            };
            stride += number.bytes();
        }
        let [number, ..] = types;
        (!number.is_whole() && types == [number; 3]).then_some(Self {
            stride,
            places,
            number,
        })
    }

    /// Reads at most so many points, and returns how many bytes they take and how many they are.
    pub(super) fn read<const BIG_ENDIAN: bool>(
        &self,
        bytes: &[u8],
        most: u64,
        points: &mut Vec<[f64; 3]>,
    ) -> (usize, u64) {
        let single = |bytes| {
            f64::from(if BIG_ENDIAN {
                f32::from_be_bytes(bytes)
            } else {
                f32::from_le_bytes(bytes)
            })
        };
        let double = |bytes| {
            if BIG_ENDIAN {
                f64::from_be_bytes(bytes)
            } else {
                f64::from_le_bytes(bytes)
            }
        };
        let before = points.len();
        match self.number {
            Number::F32 => self.collect(bytes, most, single, points),
            _ => self.collect(bytes, most, double, points),
        }
        let read = points.len() - before;
        (read * self.stride, read as u64)
    }

    fn collect<const N: usize>(
        &self,
        bytes: &[u8],
        most: u64,
        real: impl Fn([u8; N]) -> f64,
        points: &mut Vec<[f64; 3]>,
    ) {
        let members = bytes
            .chunks_exact(self.stride)
            .take(usize::try_from(most).unwrap_or(usize::MAX));
        let read = members.map(|member| {
            self.places
                .map(|at| member[at..].first_chunk().map_or(f64::NAN, |bytes| real(*bytes)))
        });
        points.extend(read.take_while(|point| point.iter().all(|c| c.is_finite())));
    }
}

/// How the corners of a triangle stand: a count of so many bytes and three numbers of four bytes.
#[derive(Debug, PartialEq)]
pub(super) struct TriangleShape {
    count: usize,
    /// Vertex numbers of this type are below.
    limit: usize,
}

impl TriangleShape {
    /// `None` for types that are rare.
    pub(super) fn of(count: Number, item: Number) -> Option<Self> {
        Some(Self {
            count: match count.bytes() {
                bytes @ (1 | 4) if count.is_whole() => bytes,
                _ => return None,
            },
            limit: match item {
                Number::I32 => 1 << 31,
                Number::U32 => usize::MAX,
                _ => return None,
            },
        })
    }

    /// Reads at most so many triangles of so many vertices, and returns how many bytes they take and how many they are.
    pub(super) fn read<const BIG_ENDIAN: bool>(
        &self,
        bytes: &[u8],
        most: u64,
        vertices: usize,
        triangles: &mut Vec<[u32; 3]>,
    ) -> (usize, u64) {
        let before = triangles.len();
        let limit = vertices.min(self.limit);
        let size = match self.count {
            1 => collect::<13, BIG_ENDIAN>(bytes, most, limit, triangles),
            _ => collect::<16, BIG_ENDIAN>(bytes, most, limit, triangles),
        };
        let read = triangles.len() - before;
        (read * size, read as u64)
    }
}

/// Reads members of `SIZE` bytes, and returns that.
fn collect<const SIZE: usize, const BIG_ENDIAN: bool>(
    bytes: &[u8],
    most: u64,
    limit: usize,
    triangles: &mut Vec<[u32; 3]>,
) -> usize {
    let whole = |bytes: &[u8]| {
        let bytes = bytes.first_chunk().copied().unwrap_or([u8::MAX; 4]);
        if BIG_ENDIAN {
            u32::from_be_bytes(bytes)
        } else {
            u32::from_le_bytes(bytes)
        }
    };
    let (members, _) = bytes.as_chunks::<SIZE>();
    let most = usize::try_from(most).unwrap_or(usize::MAX);
    let first = SIZE - 12;
    let read = members.iter().take(most).map_while(|member| {
        let count = if first == 1 {
            u32::from(member[0])
        } else {
            whole(member)
        };
        let corners = [0, 4, 8].map(|at| whole(&member[first + at..]));
        let is_usual = count == 3 && corners.iter().all(|&v| (v as usize) < limit);
        is_usual.then_some(corners)
    });
    triangles.extend(read);
    SIZE
}

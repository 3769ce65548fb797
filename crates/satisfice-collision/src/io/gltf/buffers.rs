//! Buffers of a glTF document, and the numbers that its accessors name in them.

use std::borrow::Cow;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::document::{Accessor, Document, Sparse};
use super::malformed;
use crate::error::Error;
use crate::io::source::Folder;

/// The buffers of a document, each loaded when it is first used.
pub(super) struct Buffers<'a> {
    document: &'a Document,
    folder: &'a Folder,
    /// The binary part of a `.glb` file, which is its first buffer.
    binary: Option<&'a [u8]>,
    loaded: Vec<Option<Cow<'a, [u8]>>>,
}

/// Where elements are: in a view from an offset on.
#[derive(Clone, Copy)]
struct Range {
    view: usize,
    offset: usize,
    count: usize,
    element: usize,
}

impl<'a> Buffers<'a> {
    pub(super) fn new(document: &'a Document, folder: &'a Folder, binary: Option<&'a [u8]>) -> Self {
        Self {
            document,
            folder,
            binary,
            loaded: document.buffers.iter().map(|_| None).collect(),
        }
    }

    /// The vectors that accessor `index` holds: positions, or times (of length 1) and values of keys.
    pub(super) fn vectors<const N: usize>(&mut self, index: usize) -> Result<Vec<[f64; N]>, Error> {
        let accessor = self.accessor(index, ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1])?;
        let component = Component::of(accessor.component_type)?;
        if component == Component::U32 {
            return Err(malformed(format!(
                "accessor {index}: numbers of type 5125 are no positions and no keys"
            )));
        }
        let bytes = self.elements(accessor, N * component.size())?;
        let coordinates = bytes
            .chunks_exact(component.size())
            .map(|bytes| component.real(bytes, accessor.normalized));
        let coordinates: Vec<f64> = coordinates.collect();
        Ok(coordinates.as_chunks().0.to_vec())
    }

    /// The vertex numbers that accessor `index` holds.
    pub(super) fn indices(&mut self, index: usize) -> Result<Vec<u32>, Error> {
        let accessor = self.accessor(index, "SCALAR")?;
        let component = Component::of(accessor.component_type)?;
        let bytes = self.elements(accessor, component.size())?;
        component.indices(&bytes)
    }

    fn accessor(&self, index: usize, kind: &str) -> Result<&'a Accessor, Error> {
        let accessor = self.document.accessors.get(index);
        let accessor = accessor.ok_or_else(|| malformed(format!("there is no accessor {index}")))?;
        if accessor.kind != kind {
            let found = &accessor.kind;
            return Err(malformed(format!(
                "accessor {index} is of type {found:?}, not {kind}"
            )));
        }
        Ok(accessor)
    }

    /// The elements of an accessor, one after another without gaps.
    fn elements(&mut self, accessor: &Accessor, element: usize) -> Result<Vec<u8>, Error> {
        let view = accessor.buffer_view.ok_or_else(|| {
            Error::unsupported(super::NAME, "accessors without a buffer view are not supported")
        })?;
        let mut elements = self.range(Range {
            view,
            offset: accessor.byte_offset,
            count: accessor.count,
            element,
        })?;
        if let Some(sparse) = &accessor.sparse {
            self.replace(sparse, element, &mut elements)?;
        }
        Ok(elements)
    }

    fn replace(&mut self, sparse: &Sparse, element: usize, elements: &mut [u8]) -> Result<(), Error> {
        let component = Component::of(sparse.indices.component_type)?;
        let indices = self.range(Range {
            view: sparse.indices.buffer_view,
            offset: sparse.indices.byte_offset,
            count: sparse.count,
            element: component.size(),
        })?;
        let values = self.range(Range {
            view: sparse.values.buffer_view,
            offset: sparse.values.byte_offset,
            count: sparse.count,
            element,
        })?;
        for (index, value) in component
            .indices(&indices)?
            .into_iter()
            .zip(values.chunks_exact(element))
        {
            let place = elements.chunks_exact_mut(element).nth(index as usize);
            place
                .ok_or_else(|| {
                    malformed(format!(
                        "a sparse accessor replaces element {index}, which it does not have"
                    ))
                })?
                .copy_from_slice(value);
        }
        Ok(())
    }

    fn range(&mut self, range: Range) -> Result<Vec<u8>, Error> {
        let document = self.document;
        let view = document.buffer_views.get(range.view);
        let view = view.ok_or_else(|| malformed(format!("there is no buffer view {}", range.view)))?;
        let buffer = self.buffer(view.buffer)?;
        let bytes = view
            .byte_offset
            .checked_add(view.byte_length)
            .and_then(|end| buffer.get(view.byte_offset..end))
            .ok_or_else(|| malformed(format!("buffer view {} ends beyond its buffer", range.view)))?;
        let too_long = || malformed(format!("an accessor ends beyond buffer view {}", range.view));
        let stride = view.byte_stride.unwrap_or(range.element);
        if stride < range.element {
            let (view, element) = (range.view, range.element);
            return Err(malformed(format!(
                "buffer view {view} has a stride of {stride} bytes for elements of {element}"
            )));
        }
        if range.count == 0 {
            return Ok(Vec::new());
        }
        let length = (range.count - 1)
            .checked_mul(stride)
            .and_then(|length| length.checked_add(range.element))
            .ok_or_else(too_long)?;
        let end = range.offset.checked_add(length).ok_or_else(too_long)?;
        let bytes = bytes.get(range.offset..end).ok_or_else(too_long)?;
        if stride == range.element {
            return Ok(bytes.to_vec());
        }
        Ok(bytes
            .chunks(stride)
            .flat_map(|chunk| &chunk[..range.element])
            .copied()
            .collect())
    }

    fn buffer(&mut self, index: usize) -> Result<&[u8], Error> {
        let slot = self.loaded.get(index);
        let slot = slot.ok_or_else(|| malformed(format!("there is no buffer {index}")))?;
        if slot.is_none() {
            self.loaded[index] = Some(self.load(index)?);
        }
        Ok(self.loaded[index].as_deref().unwrap_or_default())
    }

    fn load(&self, index: usize) -> Result<Cow<'a, [u8]>, Error> {
        let buffer = &self.document.buffers[index];
        let bytes = match (&buffer.uri, self.binary) {
            (Some(uri), _) => Cow::Owned(self.resolve(uri, index)?),
            (None, Some(binary)) if index == 0 => Cow::Borrowed(binary),
            (None, _) => return Err(malformed(format!("buffer {index} is missing: it names no file"))),
        };
        if bytes.len() < buffer.byte_length {
            let (has, announced) = (bytes.len(), buffer.byte_length);
            return Err(malformed(format!(
                "buffer {index} has {has} bytes of the {announced} that it announces"
            )));
        }
        Ok(bytes)
    }

    /// The bytes of a `data:` address or of a file beside the document.
    fn resolve(&self, uri: &str, index: usize) -> Result<Vec<u8>, Error> {
        if let Some(data) = uri.strip_prefix("data:") {
            let (_, text) = data
                .split_once(";base64,")
                .ok_or_else(|| malformed(format!("buffer {index} is not encoded in base64")))?;
            return STANDARD
                .decode(text)
                .map_err(|error| malformed(format!("buffer {index}: {error}")));
        }
        if uri.contains("://") {
            let what = format!("buffer {index} is at a network address; save it beside the file");
            return Err(Error::unsupported(super::NAME, what));
        }
        let name = percent_encoding::percent_decode_str(uri).decode_utf8_lossy();
        self.folder.file(&name)
    }
}

/// The types of components.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(code: u64) -> Result<Self, Error> {
        Ok(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return Err(malformed(format!("unknown component type {code}"))),
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The value of a coordinate. Normalised whole numbers stand for -1 to 1 or 0 to 1.
    fn real(self, bytes: &[u8], normalized: bool) -> f64 {
        let word = word(bytes);
        let (value, greatest) = match self {
            Self::I8 => (f64::from(word as i8), 127.0),
            Self::U8 => (f64::from(word as u8), 255.0),
            Self::I16 => (f64::from(word as i16), 32_767.0),
            Self::U16 => (f64::from(word as u16), 65_535.0),
            Self::U32 => return f64::from(word),
            Self::F32 => return f64::from(f32::from_bits(word)),
        };
        if normalized {
            (value / greatest).max(-1.0)
        } else {
            value
        }
    }

    fn indices(self, bytes: &[u8]) -> Result<Vec<u32>, Error> {
        match self {
            Self::U8 | Self::U16 | Self::U32 => Ok(bytes.chunks_exact(self.size()).map(word).collect()),
            _ => Err(malformed("vertex numbers that are not unsigned whole numbers")),
        }
    }
}

/// Up to four bytes, the lowest first.
fn word(bytes: &[u8]) -> u32 {
    bytes
        .iter()
        .rev()
        .fold(0, |word, byte| word << 8 | u32::from(*byte))
}

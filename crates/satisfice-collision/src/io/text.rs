//! Text files as lines, words and numbers: what the readers of text formats share.

use memchr::memchr2;

use crate::error::Error;
use crate::mesh::AXES;

/// The text without a byte order mark.
///
/// # Errors
/// [`Error::Unsupported`] for UTF-16, which no mesh format uses.
pub(super) fn without_mark<'a>(format: &'static str, bytes: &'a [u8]) -> Result<&'a [u8], Error> {
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err(Error::unsupported(
            format,
            "UTF-16 is not supported; save the file as UTF-8",
        ));
    }
    Ok(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes))
}

/// The lines of a text, without their ends: LF, CR LF or CR, also mixed.
#[derive(Clone)]
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Lines<'a> {
    /// The first line gets the number `before + 1`.
    pub(super) fn after(before: usize, text: &'a [u8]) -> Self {
        Self {
            rest: text,
            number: before,
        }
    }

    /// The number of the line returned last; the first is 1.
    pub(super) fn number(&self) -> usize {
        self.number
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let Some(end) = memchr2(b'\n', b'\r', self.rest) else {
            return Some(std::mem::take(&mut self.rest));
        };
        let (line, tail) = self.rest.split_at(end);
        let end_length = if tail.starts_with(b"\r\n") { 2 } else { 1 };
        self.rest = &tail[end_length..];
        Some(line)
    }
}

/// The words of a line, separated by ASCII white space.
#[derive(Clone)]
pub(super) struct Words<'a>(pub(super) &'a [u8]);

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let start = self.0.iter().position(|b| !is_space(*b))?;
        let tail = &self.0[start..];
        let end = tail.iter().position(|b| is_space(*b)).unwrap_or(tail.len());
        let (word, rest) = tail.split_at(end);
        self.0 = rest;
        Some(word)
    }
}

fn is_space(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == b'\x0b'
}

/// The line up to a comment that begins with `#`.
pub(super) fn without_comment(line: &[u8]) -> &[u8] {
    memchr::memchr(b'#', line).map_or(line, |end| &line[..end])
}

/// A number in decimal notation, correctly rounded; also `inf` and `nan`, for the caller to refuse by name.
pub(super) fn real<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A whole number in decimal notation that fits an `i64`.
pub(super) fn whole(word: &[u8]) -> Option<i64> {
    let (negative, digits) = match word {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] | digits => (false, digits),
    };
    if digits.is_empty() {
        return None;
    }
    let mut value = 0_i64;
    for &digit in digits {
        if !digit.is_ascii_digit() {
            return None;
        }
        let digit = i64::from(digit - b'0');
        let signed = if negative { -digit } else { digit };
        value = value.checked_mul(10)?.checked_add(signed)?;
    }
    Some(value)
}

/// The error of a coordinate that is not finite because the file has too large a number for it: with this number. `words` are
/// those of the vertex.
pub(super) fn as_written<'a>(
    format: &'static str,
    error: Error,
    mut words: impl Iterator<Item = &'a [u8]>,
) -> Error {
    let Error::NonFiniteVertex { vertex, axis, .. } = error else {
        return error;
    };
    let place = AXES.iter().position(|known| *known == axis);
    match place.and_then(|place| words.nth(place)) {
        Some(word) if word.iter().any(u8::is_ascii_digit) => Error::malformed(
            format,
            format!(
                "vertex {vertex} has {axis} = {}, which is too large",
                quoted(word)
            ),
        ),
        _ => error,
    }
}

/// A word for a message: quoted, shortened, without control characters.
pub(super) fn quoted(word: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text = String::from_utf8_lossy(word);
    let mut short: String = text.chars().take(LONGEST).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    format!("{short:?}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_with_lf_cr_lf_or_cr() {
        let mut lines = Lines::after(0, b"a\nb\r\nc\rd\r\r\ne");
        let all: Vec<&[u8]> = lines.by_ref().collect();
        assert_eq!(all, [&b"a"[..], b"b", b"c", b"d", b"", b"e"]);
        assert_eq!(lines.number(), 6);
        assert_eq!(Lines::after(0, b"").count(), 0);
    }

    #[test]
    fn whole_numbers_are_those_of_the_standard_library() {
        for word in [
            "0",
            "-0",
            "+7",
            "007",
            "9223372036854775807",
            "9223372036854775808",
            "-9223372036854775808",
            "-9223372036854775809",
            "",
            "-",
            "+",
            "1.0",
            "1e3",
            " 1",
            "0x1",
            "--1",
        ] {
            assert_eq!(whole(word.as_bytes()), word.parse().ok(), "{word:?}");
        }
    }

    #[test]
    fn quotations_are_short_and_printable() {
        assert_eq!(quoted(b"a\x1b\xff"), "\"a\\u{1b}\u{fffd}\"");
        assert!(quoted(&[b'x'; 1000]).chars().count() < 50);
    }
}

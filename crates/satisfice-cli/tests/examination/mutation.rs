//! Damaged copies of files, from a seed.

use satisfice::SearchRng;

/// Tokens that break readers.
const HOSTILE: &[&str] = &[
    "nan",
    "NaN",
    "inf",
    "-inf",
    "1e999",
    "-1e999",
    "1e-400",
    "-1",
    "0",
    "-0",
    "4294967295",
    "4294967296",
    "2147483648",
    "18446744073709551615",
    "18446744073709551616",
    "9223372036854775807",
    "1e18",
    "99999999999999999999999999999",
    "",
    " ",
    "\r",
    "\t",
    "\u{feff}",
    "\u{1b}[31m",
    "é",
    "\"",
    "'",
    "[",
    "]",
    "{",
    "}",
    "#",
    "null",
    "true",
    "v",
    "f",
    "end_header",
];

/// One to four damages of different kinds.
pub(crate) fn mutate(original: &[u8], rng: &mut SearchRng) -> Vec<u8> {
    let mut bytes = original.to_vec();
    for _ in 0..=rng.below(4) {
        damage(&mut bytes, rng);
    }
    bytes
}

fn damage(bytes: &mut Vec<u8>, rng: &mut SearchRng) {
    if bytes.is_empty() {
        bytes.extend_from_slice(HOSTILE[rng.below(HOSTILE.len())].as_bytes());
        return;
    }
    let at = rng.below(bytes.len());
    match rng.below(8) {
        0 => bytes[at] ^= 1 << rng.below(8),
        1 => bytes[at] = u8::try_from(rng.below(256)).unwrap(),
        2 => bytes.truncate(at),
        3 => {
            let end = (at + 1 + rng.below(40)).min(bytes.len());
            bytes.drain(at..end);
        }
        4 => {
            let end = (at + 1 + rng.below(200)).min(bytes.len());
            let copy = bytes[at..end].to_vec();
            let to = rng.below(bytes.len());
            bytes.splice(to..to, copy);
        }
        5 => {
            let hostile = HOSTILE[rng.below(HOSTILE.len())];
            bytes.splice(at..at, hostile.bytes());
        }
        // A whole token is replaced: what readers of text get wrong.
        _ => {
            let (from, to) = token(bytes, at);
            let hostile = HOSTILE[rng.below(HOSTILE.len())];
            bytes.splice(from..to, hostile.bytes());
        }
    }
}

/// The bounds of the word around a place.
fn token(bytes: &[u8], at: usize) -> (usize, usize) {
    let is_end = |byte: &u8| byte.is_ascii_whitespace() || b",:[]{}=\"".contains(byte);
    let from = bytes[..at]
        .iter()
        .rposition(is_end)
        .map_or(0, |before| before + 1);
    let to = bytes[at..]
        .iter()
        .position(is_end)
        .map_or(bytes.len(), |after| at + after);
    (from, to.max(from))
}

//! JSON objects whose first key is the checksum of the others: damage is found before anything is read.

use satisfice::checksum::Checksum;

const KEY: &str = "{\"checksum\":\"";

/// What a sealed object is not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Broken {
    /// It does not begin with a checksum: it is something else, or was cut.
    Unsealed,
    /// It is not what was written.
    Damaged,
}

/// Puts the checksum before the keys of a JSON object, which must have some.
#[must_use]
pub fn seal(object: &str) -> String {
    format!("{KEY}{:016x}\",{}", checksum(object.as_bytes()), &object[1..])
}

/// The object without its checksum.
///
/// # Errors
/// [`Broken`], if it was not written by [`seal`].
pub fn open(sealed: &[u8]) -> Result<String, Broken> {
    let text = std::str::from_utf8(sealed).map_err(|_| Broken::Damaged)?;
    let (digits, rest) = text
        .strip_prefix(KEY)
        .and_then(|text| text.split_once("\","))
        .ok_or(Broken::Unsealed)?;
    let object = format!("{{{rest}");
    if digits == format!("{:016x}", checksum(object.as_bytes())) {
        Ok(object)
    } else {
        Err(Broken::Damaged)
    }
}

/// The checksum of some bytes.
#[must_use]
pub fn checksum(bytes: &[u8]) -> u64 {
    Checksum::of(bytes).value()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_sealed_is_opened_and_every_flipped_bit_is_found() {
        let object = "{\"a\":1,\"b\":[2.5,\"c\"]}";
        let sealed = seal(object);
        assert_eq!(open(sealed.as_bytes()).as_deref(), Ok(object));
        for bit in 0..8 * sealed.len() {
            let mut bytes = sealed.clone().into_bytes();
            bytes[bit / 8] ^= 1 << (bit % 8);
            assert!(open(&bytes).is_err(), "bit {bit}");
        }
        assert_eq!(open(object.as_bytes()), Err(Broken::Unsealed));
    }
}

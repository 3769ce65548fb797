//! The data of a page: a header of JSON and arrays of numbers, compressed, as Base64.
//!
//! An array is stored byte plane by byte plane (all lowest bytes, then all second bytes, and so on), which lets gzip see the
//! runs of zeros in the high bytes of small numbers. `read.js` undoes it.

use std::io::Write;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::{Value, json};

/// Arrays by name.
#[derive(Debug, Default)]
pub(crate) struct Pack {
    /// Name, kind and length of each array.
    sections: Vec<Value>,
    bytes: Vec<u8>,
}

impl Pack {
    /// Whole numbers.
    pub(crate) fn u32s(&mut self, name: &str, values: &[u32]) {
        self.planes(
            name,
            "u32",
            &values.iter().map(|value| value.to_le_bytes()).collect::<Vec<_>>(),
        );
    }

    /// Floats to about eight significant digits, of any exponent: the three lowest bytes are zero and cost nothing.
    pub(crate) fn floats(&mut self, name: &str, values: &[f64]) {
        let near: Vec<f64> = values.iter().map(|&value| rounded(value)).collect();
        self.exact(name, &near);
    }

    /// Floats bit by bit.
    pub(crate) fn exact(&mut self, name: &str, values: &[f64]) {
        self.planes(
            name,
            "f64",
            &values.iter().map(|value| value.to_le_bytes()).collect::<Vec<_>>(),
        );
    }

    fn planes<const N: usize>(&mut self, name: &str, kind: &str, values: &[[u8; N]]) {
        self.sections.push(json!([name, kind, values.len()]));
        for plane in 0..N {
            self.bytes.extend(values.iter().map(|value| value[plane]));
        }
    }

    /// Everything: the length of the header, the header with the list of arrays, the arrays.
    pub(crate) fn finish(self, mut header: Value) -> std::io::Result<String> {
        header["sections"] = Value::Array(self.sections);
        let header = header.to_string();
        // Large pages are written in a third of the time, a few percent larger.
        let level = if self.bytes.len() > 8 << 20 { 5 } else { 9 };
        let mut packed = GzEncoder::new(Vec::new(), Compression::new(level));
        packed.write_all(&u32::try_from(header.len()).unwrap_or(u32::MAX).to_le_bytes())?;
        packed.write_all(header.as_bytes())?;
        packed.write_all(&self.bytes)?;
        Ok(STANDARD.encode(packed.finish()?))
    }
}

/// The nearest number with 28 bits of mantissa.
fn rounded(value: f64) -> f64 {
    let near = f64::from_bits((value.to_bits().wrapping_add(1 << 23)) & !((1 << 24) - 1));
    if near.is_finite() { near } else { value }
}

/// Differences from the value `stride` places before, small ones near 0 whatever their sign.
pub(crate) fn differences(values: &[u32], stride: usize) -> Vec<u32> {
    let before = |k: usize| k.checked_sub(stride).map_or(0, |k| values[k]);
    values
        .iter()
        .enumerate()
        .map(|(k, value)| zigzag(value.wrapping_sub(before(k))))
        .collect()
}

/// A difference modulo 2^32 as twice its magnitude, less one if it is negative.
pub(crate) fn zigzag(difference: u32) -> u32 {
    (difference << 1) ^ 0_u32.wrapping_sub(difference >> 31)
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

    #[test]
    fn arrays_come_back() {
        let mut pack = Pack::default();
        let numbers = [7_u32, 5, 1 << 31, 0, u32::MAX];
        pack.u32s("n", &differences(&numbers, 2));
        pack.floats("x", &[0.1, -1e300, f64::NAN]);
        let text = pack.finish(json!({"title": "</script>"})).unwrap();
        assert!(!text.contains('<'));
        let mut bytes = Vec::new();
        flate2::read::GzDecoder::new(&STANDARD.decode(text).unwrap()[..])
            .read_to_end(&mut bytes)
            .unwrap();
        let length = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
        let header: Value = serde_json::from_slice(&bytes[4..4 + length]).unwrap();
        assert_eq!(header["sections"], json!([["n", "u32", 5], ["x", "f64", 3]]));
        let arrays = &bytes[4 + length..];
        let number = |k: usize| u32::from_le_bytes(std::array::from_fn(|plane| arrays[plane * 5 + k]));
        let mut back: Vec<u32> = Vec::new();
        for k in 0..5 {
            let z = number(k);
            let difference = (z >> 1) ^ 0_u32.wrapping_sub(z & 1);
            back.push(if k < 2 { 0 } else { back[k - 2] }.wrapping_add(difference));
        }
        assert_eq!(back, numbers);
        let float = |k: usize| f64::from_le_bytes(std::array::from_fn(|plane| arrays[20 + plane * 3 + k]));
        assert!((float(0) - 0.1).abs() < 1e-9 && (float(1) / -1e300 - 1.0).abs() < 1e-8 && float(2).is_nan());
    }
}

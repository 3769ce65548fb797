//! The checksum of what is kept on disk.

/// FNV-1a (Fowler, Noll, Vo 1991) of bytes, in 64 bits: it detects damage, not malice. Every change of one byte changes it.
///
/// ```
/// use satisfice::checksum::Checksum;
/// // The published value for the letter a.
/// assert_eq!(Checksum::of(b"a").value(), 0xaf63_dc4c_8601_ec8c);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Checksum(u64);

impl Default for Checksum {
    /// That of no bytes.
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Checksum {
    /// That of these bytes.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Self {
        let mut checksum = Self::default();
        for &byte in bytes {
            checksum.push(byte);
        }
        checksum
    }

    /// Goes on with another byte.
    pub fn push(&mut self, byte: u8) {
        self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    }

    /// The 64 bits.
    #[must_use]
    pub fn value(self) -> u64 {
        self.0
    }
}

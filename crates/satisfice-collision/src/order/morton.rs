//! The Morton (Z) curve in three dimensions.

/// The position of a grid cell on the Morton curve: bit b of x, y and z goes to bit 3b + 2, 3b + 1 and 3b.
///
/// `bits` is the number of bits per axis, at most 21; higher bits of the cell are ignored.
///
/// Source: G. M. Morton, "A Computer Oriented Geodetic Data Base", IBM, 1966.
#[must_use]
pub fn morton_key(cell: [u32; 3], bits: u32) -> u64 {
    let mask = (1_u64 << bits.min(21)) - 1;
    let [x, y, z] = cell.map(|c| spread(u64::from(c) & mask));
    x << 2 | y << 1 | z
}

/// Inserts two zero bits before each of the 21 low bits.
fn spread(mut v: u64) -> u64 {
    v = (v | v << 32) & 0x001f_0000_0000_ffff;
    v = (v | v << 16) & 0x001f_0000_ff00_00ff;
    v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
    v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
    (v | v << 2) & 0x1249_2492_4924_9249
}

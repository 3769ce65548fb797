//! The Hilbert curve in three dimensions.

use super::morton_key;

/// The position of a grid cell on the Hilbert curve through a grid of `2^bits` cells per axis. `bits` is at most 21; higher
/// bits of the cell are ignored. Consecutive cells on the curve share a face.
///
/// Source: J. Skilling, "Programming the Hilbert curve", AIP Conf. Proc. 707 (2004) 381, doi 10.1063/1.1751381: the
/// coordinates become the transposed index in place, which is then interleaved. O(bits).
#[must_use]
pub fn hilbert_key(cell: [u32; 3], bits: u32) -> u64 {
    let bits = bits.min(21);
    if bits == 0 {
        return 0;
    }
    let mut x = cell.map(|c| c & ((1 << bits) - 1));
    // From the coarsest bit down: undo the reflection or exchange that this bit of each axis requires.
    for bit in (1..bits).rev() {
        let low = (1 << bit) - 1;
        for k in 0..3 {
            if x[k] >> bit & 1 == 1 {
                x[0] ^= low;
            } else {
                let exchange = (x[0] ^ x[k]) & low;
                x[0] ^= exchange;
                x[k] ^= exchange;
            }
        }
    }
    // Gray decoding along the axes, then along the bits.
    x[1] ^= x[0];
    x[2] ^= x[1];
    let flips = (1..bits)
        .filter(|&bit| x[2] >> bit & 1 == 1)
        .fold(0, |t, bit| t ^ ((1 << bit) - 1));
    morton_key(x.map(|c| c ^ flips), bits)
}

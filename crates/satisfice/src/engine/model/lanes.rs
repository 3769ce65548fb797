//! Sixteen numbers side by side: the unit in which candidates are modelled.
//!
//! Every lane is computed by the same operations in the same order, without fused multiplication, so that the bits do not
//! depend on the width of the machine's vectors.

use pulp::NullaryFnOnce;

/// Numbers in a block. Two vector registers of 512 bits, eight of 128 bits.
pub(super) const LANES: usize = 16;

/// One number for each candidate of a block.
pub(super) type Lanes = [f64; LANES];

/// Does a piece of work, compiled for AVX2 where the machine has it. Its `call` is `#[inline(always)]`, and so is what takes its time: the
/// rest is compiled once for all machines.
#[inline(always)]
pub(super) fn on_wide_vectors<W: NullaryFnOnce>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(unit) = pulp::x86::V3::try_new() {
        return unit.vectorize(work);
    }
    work.call()
}

/// `exp(-x)` for `x >= 0`, within a few units in the last place; arguments above 700 count as 700.
///
/// `-x = n ln 2 + r` with `|r| <= ln 2 / 2`, then the Taylor series of `exp(r)`. The system's `exp` is a call for each lane,
/// and its last bit differs between machines. One loop for each stage, so that the compiler uses vectors.
#[inline(always)]
pub(super) fn exp_of_minus(x: &Lanes) -> Lanes {
    /// 1.5 * 2^52: added to a number, it leaves the nearest integer in the low bits.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    const LN_2_HIGH: f64 = 6.931_471_803_691_238e-1;
    const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;
    const INVERSE_FACTORIALS: [f64; 13] = [
        1.0 / 479_001_600.0,
        1.0 / 39_916_800.0,
        1.0 / 3_628_800.0,
        1.0 / 362_880.0,
        1.0 / 40_320.0,
        1.0 / 5_040.0,
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
        1.0,
    ];
    let (mut shifted, mut rest) = ([0.0; LANES], [0.0; LANES]);
    for lane in 0..LANES {
        let x = -x[lane].min(700.0);
        shifted[lane] = x * core::f64::consts::LOG2_E + ROUND;
        let n = shifted[lane] - ROUND;
        rest[lane] = (x - n * LN_2_HIGH) - n * LN_2_LOW;
    }
    let mut sum = [1.0 / 6_227_020_800.0; LANES];
    for c in INVERSE_FACTORIALS {
        for lane in 0..LANES {
            sum[lane] = sum[lane] * rest[lane] + c;
        }
    }
    for lane in 0..LANES {
        // n, in two's complement in the low bits, becomes the exponent.
        sum[lane] *= f64::from_bits((shifted[lane].to_bits() << 52).wrapping_add(1023 << 52));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_agrees_with_the_library() {
        for i in 0..=140_000 {
            let x = f64::from(i) * 0.005;
            approx::assert_relative_eq!(exp_of_minus(&[x; LANES])[3], (-x).exp(), max_relative = 1e-14);
        }
        assert_eq!(exp_of_minus(&[0.0; LANES]), [1.0; LANES]);
        assert_eq!(
            exp_of_minus(&[f64::INFINITY; LANES]),
            exp_of_minus(&[700.0; LANES])
        );
    }
}

//! The floating-point type a search runs in: `f32` or `f64`.

use core::fmt::{Debug, Display, LowerExp};

use num_traits::{Float, FloatConst};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// `f32` or `f64`, over [`num_traits::Float`].
///
/// Sealed: state is saved bit by bit and the registry builds every engine for exactly these two types.
pub trait Real:
    Float
    + FloatConst
    + serde::Serialize
    + serde::de::DeserializeOwned
    + Default
    + Debug
    + Display
    + LowerExp
    + Send
    + Sync
    + sealed::Sealed
    + 'static
{
    /// The name of the type, `"f32"` or `"f64"`.
    const NAME: &'static str;
    /// The largest `n` such that every whole number of magnitude up to `n` is representable: 2^24 or 2^53.
    const MAX_INTEGER: i64;

    /// The nearest value of this type; overflow gives an infinity.
    #[must_use]
    fn of(value: f64) -> Self;
    /// The same value as `f64`, exactly.
    #[must_use]
    fn f64(self) -> f64;
    /// The bits, widened to 64; [`Real::from_word`] is its inverse.
    #[must_use]
    fn to_word(self) -> u64;
    /// The value with these bits, the upper half ignored for `f32`.
    #[must_use]
    fn from_word(word: u64) -> Self;
    /// The next value below.
    #[must_use]
    fn below(self) -> Self;
    /// 3/4 of the first power of two above which every value is whole: added and taken away again, it rounds any value of
    /// less than a third of its magnitude to a whole number.
    #[doc(hidden)]
    const ROUNDER: Self;
}

/// The floor. Not every machine has an instruction for it, and a call of the library's costs as much as a cheap fitness: two
/// additions round, a third corrects.
#[inline]
pub(crate) fn floor<S: Real>(x: S) -> S {
    // Below a third of it the sum stays between powers of two whose values are the whole numbers.
    if x.abs() * S::of(4.0) < S::ROUNDER {
        let whole = (x + S::ROUNDER) - S::ROUNDER;
        // Half of all values are rounded up: a branch would be guessed wrong half of the time.
        whole - S::of(f64::from(u8::from(whole > x)))
    } else {
        x.floor()
    }
}

impl Real for f32 {
    const NAME: &'static str = "f32";
    const MAX_INTEGER: i64 = 1 << 24;
    const ROUNDER: Self = 12_582_912.0; // 1.5 * 2^23

    #[inline]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "rounding to f32 is what is asked for"
    )]
    fn of(value: f64) -> Self {
        value as Self
    }
    #[inline]
    fn f64(self) -> f64 {
        f64::from(self)
    }
    #[inline]
    fn to_word(self) -> u64 {
        u64::from(self.to_bits())
    }
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "the upper half is not used")]
    fn from_word(word: u64) -> Self {
        Self::from_bits(word as u32)
    }
    #[inline]
    fn below(self) -> Self {
        self.next_down()
    }
}

impl Real for f64 {
    const NAME: &'static str = "f64";
    const MAX_INTEGER: i64 = 1 << 53;
    const ROUNDER: Self = 6_755_399_441_055_744.0; // 1.5 * 2^52

    #[inline]
    fn of(value: f64) -> Self {
        value
    }
    #[inline]
    fn f64(self) -> f64 {
        self
    }
    #[inline]
    fn to_word(self) -> u64 {
        self.to_bits()
    }
    #[inline]
    fn from_word(word: u64) -> Self {
        Self::from_bits(word)
    }
    #[inline]
    fn below(self) -> Self {
        self.next_down()
    }
}

/// Copies a row of coordinates onto one of the same length. Short ones number by number: a call of the library's costs more
/// than that.
#[inline]
pub(crate) fn copy_row<S: Copy>(to: &mut [S], from: &[S]) {
    match (to, from) {
        ([a, b], [x, y]) => (*a, *b) = (*x, *y),
        ([a, b, c], [x, y, z]) => (*a, *b, *c) = (*x, *y, *z),
        (to, from) => to.copy_from_slice(from),
    }
}

/// Bits that are ordered as the numbers are.
pub(crate) fn ordered(x: f64) -> u64 {
    let bits = x.to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_ordered_as_numbers_are() {
        let numbers = [
            f64::NEG_INFINITY,
            -2.5,
            -1e-300,
            0.0,
            1e-300,
            1.0,
            7.0,
            f64::INFINITY,
        ];
        assert!(numbers.is_sorted_by(|&a, &b| ordered(a) < ordered(b)));
    }
}

//! Randomness: one named, portable generator per run, seeded by the caller.

use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, Exp1, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::scalar::Real;

/// The generator of a run: xoshiro256++ (Blackman, Vigna 2021, doi 10.1145/3460772), seeded through `SplitMix64`.
///
/// The same seed gives the same numbers on every platform. Numbers are drawn in `Engine::ask` only, in order, so threads
/// change nothing. Implements [`rand::Rng`], so all of `rand_distr` works on it.
///
/// ```
/// use satisfice::SearchRng;
/// let (mut one, mut two) = (SearchRng::new(42), SearchRng::new(42));
/// assert_eq!(one.uniform(), two.uniform());
/// assert!(one.below(6) < 6);
/// assert_ne!(SearchRng::stream(42, 1), SearchRng::stream(42, 2)); // independent
/// ```
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct SearchRng(Xoshiro256PlusPlus);

impl SearchRng {
    /// The generator for `seed`.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// An independent generator for `(seed, stream)`: islands, slices, work units.
    #[must_use]
    pub fn stream(seed: u64, stream: u64) -> Self {
        // Any injective mix does; the constant is 2^64 / golden ratio, so that small streams differ in many bits.
        Self::new(seed ^ stream.wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(32))
    }

    /// Uniform in `[0, 1)`, 53 bits.
    #[inline]
    pub fn uniform(&mut self) -> f64 {
        unit(self.0.next_u64())
    }

    /// Uniform in `[0, 1)` and a fair sign, from one draw of 64 bits.
    #[inline]
    pub fn uniform_and_sign(&mut self) -> (f64, bool) {
        let bits = self.0.next_u64();
        (unit(bits), bits & 1 == 1) // the 53 upper bits and the lowest one are disjoint
    }

    /// Uniform in `0..n`; 0 for `n` = 0.
    #[inline]
    pub fn below(&mut self, n: usize) -> usize {
        // Lemire's multiplication (doi 10.1145/3230636) without rejection: the bias is below n / 2^64.
        ((u128::from(self.0.next_u64()) * n as u128) >> 64) as usize
    }

    /// Exponential with mean 1: ln(1/u) with u in (0, 1], never infinite.
    #[inline]
    pub fn exponential(&mut self) -> f64 {
        Exp1.sample(&mut self.0)
    }

    /// Normal with mean 0 and deviation 1.
    #[inline]
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// A uniform position of a space.
    #[inline]
    pub fn position<S: Real>(&mut self, space: &crate::space::Space<S>, position: &mut [S]) {
        for (axis, x) in space.axes().iter().zip(position) {
            *x = axis.at(self.uniform());
        }
    }
}

#[inline]
#[expect(clippy::cast_precision_loss, reason = "53 bits are exact")]
fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
}

impl rand::TryRng for SearchRng {
    type Error = core::convert::Infallible;
    fn try_next_u32(&mut self) -> Result<u32, Self::Error> {
        self.0.try_next_u32()
    }
    fn try_next_u64(&mut self) -> Result<u64, Self::Error> {
        self.0.try_next_u64()
    }
    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Self::Error> {
        self.0.try_fill_bytes(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::{Reader, Saved, State};

    /// Reference values of the algorithm, from its authors' C code seeded by SplitMix64: guards every recorded seed.
    #[test]
    fn the_first_numbers_of_seed_42_never_change() {
        let mut rng = SearchRng::new(42);
        let first: Vec<u64> = (0..3).map(|_| rng.next_u64()).collect();
        assert_eq!(
            first,
            [15021278609987233951, 5881210131331364753, 18149643915985481100]
        );
    }

    #[test]
    fn a_restored_generator_goes_on() {
        let mut rng = SearchRng::stream(1, 2);
        rng.uniform();
        let mut state = State::default();
        rng.save(&mut state);
        let mut restored = SearchRng::restore(&mut Reader::new(&state)).unwrap();
        assert_eq!(restored.next_u64(), rng.next_u64());
    }

    #[test]
    fn draws_have_their_moments() {
        let mut rng = SearchRng::new(5);
        let n = 200_000;
        let (mut below, mut signs, mut exponential) = ([0_u32; 7], 0, 0.0);
        for _ in 0..n {
            below[rng.below(7)] += 1;
            signs += u32::from(rng.uniform_and_sign().1);
            exponential += rng.exponential();
        }
        // Five standard deviations.
        assert!(
            below
                .iter()
                .all(|&count| (f64::from(count) - n as f64 / 7.0).abs() < 5.0 * 156.5)
        );
        assert!((f64::from(signs) - n as f64 / 2.0).abs() < 5.0 * 223.6);
        assert!((exponential / n as f64 - 1.0).abs() < 5.0 / (n as f64).sqrt());
    }
}

//! Decisions for many triangle pairs, eight at a time on the vector unit.
//!
//! The first filter runs in single precision, in coordinates local to each pair and scaled by a power of two so that delta is
//! between 1 and 2. It leaves open only the few pairs that are very close to delta. Pairs that are too large or too small for
//! it go through the same filter in double precision. Pairs that remain open are decided one by one.

use super::kernel::{Kernel, KernelLimits, LaneVector, Verdicts};
use super::vector::{exponent, ldexp};
use super::{DecidedBy, Decision, Threshold, Triangle, triangle_triangle};
use crate::simd::{Floats as _, Lanes, Work, dispatch};

/// Lanes of a batch.
const LANES: usize = 8;

/// The greatest binary exponent of a scale in one factor, so that neither it nor its inverse is denormal.
const LARGEST_SHIFT: i32 = 1000;

/// Collects triangle pairs and decides eight at a time whether they are within a threshold.
///
/// Answers come in the order of the pairs, each with the tag of its pair; call [`finish`](Self::finish) after the last pair.
/// They are within the threshold exactly if [`triangle_triangle::decide`] says so.
///
/// ```
/// use satisfice_collision::distance::{Threshold, TriangleBatch};
/// let floor = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mut hits = Vec::new();
/// let mut batch = TriangleBatch::new(Threshold::new(0.35)?);
/// for k in 0..10 {
///     let above = floor.map(|[x, y, _]| [x, y, 0.1 * f64::from(k)]);
///     batch.push(&floor, &above, k, |k, decision| hits.extend(decision.within.then_some(k)));
/// }
/// batch.finish(|k, decision| hits.extend(decision.within.then_some(k)));
/// assert_eq!(hits, [0, 1, 2, 3]);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct TriangleBatch<T> {
    threshold: Threshold,
    single: Scaled,
    a: [Triangle; LANES],
    b: [Triangle; LANES],
    tags: [T; LANES],
    len: usize,
}

impl<T: Copy + Default> TriangleBatch<T> {
    /// An empty batch.
    pub fn new(threshold: Threshold) -> Self {
        let none = [[[0.0; 3]; 3]; LANES];
        Self {
            threshold,
            single: Scaled::new(threshold),
            a: none,
            b: none,
            tags: [T::default(); LANES],
            len: 0,
        }
    }

    /// Adds a pair. Every eighth call passes the answers of eight pairs to `answer`.
    #[inline]
    pub fn push(&mut self, a: &Triangle, b: &Triangle, tag: T, answer: impl FnMut(T, Decision)) {
        let lane = self.len;
        self.a[lane] = *a;
        self.b[lane] = *b;
        self.tags[lane] = tag;
        self.len += 1;
        if self.len == LANES {
            self.finish(answer);
        }
    }

    /// Passes the answers of the remaining pairs to `answer` and empties the batch.
    pub fn finish(&mut self, mut answer: impl FnMut(T, Decision)) {
        if self.len == 0 {
            return;
        }
        let Verdicts { within, apart, .. } = self.filter();
        for lane in 0..self.len {
            let decision = if within >> lane & 1 == 1 {
                Decision {
                    within: true,
                    by: DecidedBy::Filter,
                }
            } else if apart >> lane & 1 == 1 {
                Decision {
                    within: false,
                    by: DecidedBy::Filter,
                }
            } else {
                triangle_triangle::decide(&self.a[lane], &self.b[lane], self.threshold)
            };
            answer(self.tags[lane], decision);
        }
        self.len = 0;
    }

    fn filter(&self) -> Verdicts {
        let (a, b) = (&self.a, &self.b);
        let scaled = self.single;
        let mut verdicts = if scaled.first == 1.0 {
            dispatch(InSingle { a, b, scaled })
        } else {
            let (a, b) = (&scaled.prepared(a), &scaled.prepared(b));
            dispatch(InSingle { a, b, scaled })
        };
        let all = (1 << self.len) - 1;
        if verdicts.in_range & all != all {
            let double = dispatch(InDouble {
                a,
                b,
                threshold: self.threshold,
            });
            verdicts.within |= double.within;
            verdicts.apart |= double.apart;
        }
        verdicts
    }
}

/// How single precision sees a threshold: times a power of two, between 1 and 2.
#[derive(Debug, Clone, Copy)]
struct Scaled {
    /// The power of two is `first * scale`; `first` is 1 unless no single factor is enough.
    first: f64,
    scale: f64,
    limits: KernelLimits,
}

impl Scaled {
    fn new(threshold: Threshold) -> Self {
        let wanted = -exponent(threshold.get());
        let second = wanted.clamp(-LARGEST_SHIFT, LARGEST_SHIFT);
        let (first, scale) = (ldexp(1.0, wanted - second), ldexp(1.0, second));
        let delta = threshold.get() * first * scale;
        let limits = KernelLimits {
            below: f64::from((delta as f32).next_down()),
            squared_above: f64::from(((delta * delta).next_up() as f32).next_up()),
        };
        Self { first, scale, limits }
    }

    /// Pairs multiplied by `first`, where that is not 1. Growing is exact unless it overflows, and what overflows is out of
    /// range. What shrinking rounds off is less than 2^-1000 of delta.
    fn prepared(&self, triangles: &[Triangle; LANES]) -> [Triangle; LANES] {
        triangles.map(|triangle| triangle.map(|p| p.map(|x| x * self.first)))
    }
}

/// The filter in single precision, all pairs at once.
struct InSingle<'p> {
    a: &'p [Triangle; LANES],
    b: &'p [Triangle; LANES],
    scaled: Scaled,
}

impl Work for InSingle<'_> {
    type Output = Verdicts;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Verdicts {
        let unit = lanes.single();
        let Scaled { scale, limits, .. } = self.scaled;
        // [triangle][vertex][axis][pair]
        let mut local = [[[[0.0_f32; LANES]; 3]; 3]; 2];
        for (lane, (a, b)) in self.a.iter().zip(self.b).enumerate() {
            for vertex in 0..3 {
                for axis in 0..3 {
                    local[0][vertex][axis][lane] = ((a[vertex][axis] - a[0][axis]) * scale) as f32;
                    local[1][vertex][axis][lane] = ((b[vertex][axis] - a[0][axis]) * scale) as f32;
                }
            }
        }
        let point = |of: &[[f32; LANES]; 3]| -> LaneVector<L::Single> {
            [unit.load(&of[0]), unit.load(&of[1]), unit.load(&of[2])]
        };
        let triangle = |of: &[[[f32; LANES]; 3]; 3]| [point(&of[0]), point(&of[1]), point(&of[2])];
        Kernel { unit }.filter(triangle(&local[0]), triangle(&local[1]), limits)
    }
}

/// The filter in double precision, half of the pairs at a time.
struct InDouble<'p> {
    a: &'p [Triangle; LANES],
    b: &'p [Triangle; LANES],
    threshold: Threshold,
}

impl Work for InDouble<'_> {
    type Output = Verdicts;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Verdicts {
        let unit = lanes.double();
        let mut all = Verdicts::default();
        let limits = KernelLimits {
            below: self.threshold.get(),
            squared_above: self.threshold.squared_above(),
        };
        for half in 0..LANES / 4 {
            let kernel = Kernel { unit };
            let load = |of: &[Triangle; LANES], vertex: usize| -> LaneVector<L::Double> {
                let axis = |axis: usize| {
                    let lane = |lane: usize| of[4 * half + lane][vertex][axis];
                    unit.load(&[lane(0), lane(1), lane(2), lane(3)])
                };
                [axis(0), axis(1), axis(2)]
            };
            let origin = load(self.a, 0);
            let local = |of, vertex| kernel.sub(load(of, vertex), origin);
            let a = [local(self.a, 0), local(self.a, 1), local(self.a, 2)];
            let b = [local(self.b, 0), local(self.b, 1), local(self.b, 2)];
            let verdicts = kernel.filter(a, b, limits);
            all.within |= verdicts.within << (4 * half);
            all.apart |= verdicts.apart << (4 * half);
            all.in_range |= verdicts.in_range << (4 * half);
        }
        all
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::simd::Portable;

    /// Machines with and without AVX2 give the same bits, and no answer in single precision contradicts double precision.
    #[test]
    fn neither_the_vector_unit_nor_the_precision_changes_an_answer() {
        let (mut a, mut b) = ([[[0.0; 3]; 3]; LANES], [[[0.0; 3]; 3]; LANES]);
        let mut state = 1_u64;
        let (mut open, mut single_open) = (0, 0);
        for round in 0..500 {
            for x in a.iter_mut().chain(&mut b).flatten().flatten() {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                *x = if round % 50 == 0 && state >> 60 == 0 {
                    f64::NAN
                } else {
                    (state >> 40) as f64 / 16_777_216.0
                };
            }
            let threshold = Threshold::new(0.02 + 0.0005 * f64::from(round)).unwrap();
            let (a, b) = (&a, &b);
            let double = || InDouble { a, b, threshold };
            let scaled = Scaled::new(threshold);
            let single = || InSingle { a, b, scaled };
            let in_double = dispatch(double());
            assert_eq!(in_double, double().run(Portable));
            let in_single = dispatch(single());
            assert_eq!(in_single, single().run(Portable));
            assert_eq!(in_single.in_range, in_double.in_range);
            for verdicts in [in_single, in_double] {
                assert_eq!(verdicts.within & verdicts.apart, 0);
                assert_eq!((verdicts.within | verdicts.apart) & !verdicts.in_range, 0);
            }
            assert_eq!(in_single.within & in_double.apart, 0);
            assert_eq!(in_single.apart & in_double.within, 0);
            let left = |verdicts: Verdicts| (!(verdicts.within | verdicts.apart) & 0xff).count_ones();
            open += left(in_double);
            single_open += left(in_single);
        }
        assert!(
            open < 800 && single_open < 800,
            "{open} and {single_open} of 4000 left open"
        );
    }
}

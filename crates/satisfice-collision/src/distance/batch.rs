//! Decisions for many pairs of one kind, eight at a time on the vector unit.
//!
//! The first filter runs in single precision, in coordinates local to each pair and scaled by a power of two so that delta is
//! between 1 and 2. It leaves open only the few pairs that are very close to delta. Pairs that are too large or too small for
//! it go through the same filter in double precision. Pairs that remain open are decided one by one.

use std::marker::PhantomData;

use super::edge_edge::{self, EdgeEdge};
use super::kernel::{Kernel, KernelLimits, LaneVector, Verdicts};
use super::precision::Precision;
use super::triangle_triangle::TriangleTriangle;
use super::vector::{exponent, ldexp};
use super::vertex_triangle::{self, VertexTriangle};
use super::{DecidedBy, Decision, Point, Threshold, Triangle, triangle_triangle};
use crate::simd::{Floats, Lanes, Work, dispatch};

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
pub struct TriangleBatch<T>(Batch<TriangleTriangle, 3, 3, T>);

impl<T: Copy + Default> TriangleBatch<T> {
    /// An empty batch.
    pub fn new(threshold: Threshold) -> Self {
        Self(Batch::new(threshold))
    }

    /// Adds a pair. Every eighth call passes the answers of eight pairs to `answer`.
    #[inline]
    pub fn push(&mut self, a: &Triangle, b: &Triangle, tag: T, answer: impl FnMut(T, Decision)) {
        self.0.push(a, b, tag, answer);
    }

    /// Passes the answers of the remaining pairs to `answer` and empties the batch.
    pub fn finish(&mut self, answer: impl FnMut(T, Decision)) {
        self.0.finish(answer);
    }
}

/// Pairs of edges in a batch.
pub(crate) type EdgeBatch<T> = Batch<EdgeEdge, 2, 2, T>;

/// Pairs of a vertex and a triangle in a batch.
pub(crate) type VertexBatch<T> = Batch<VertexTriangle, 1, 3, T>;

/// A kind of pair that is decided in batches.
pub(super) trait Batched<const M: usize, const N: usize> {
    /// The filter. Local coordinates: the first point of `a` is 0.
    fn filter<U: Floats<Scalar: Precision>>(
        kernel: &Kernel<U>,
        a: [LaneVector<U>; M],
        b: [LaneVector<U>; N],
        limits: KernelLimits,
    ) -> Verdicts;

    /// One pair.
    fn decide(a: &[Point; M], b: &[Point; N], threshold: Threshold) -> Decision;
}

impl Batched<3, 3> for TriangleTriangle {
    #[inline(always)]
    fn filter<U: Floats<Scalar: Precision>>(
        kernel: &Kernel<U>,
        a: [LaneVector<U>; 3],
        b: [LaneVector<U>; 3],
        limits: KernelLimits,
    ) -> Verdicts {
        kernel.two_triangles(a, b, limits)
    }

    fn decide(a: &[Point; 3], b: &[Point; 3], threshold: Threshold) -> Decision {
        triangle_triangle::decide(a, b, threshold)
    }
}

impl Batched<2, 2> for EdgeEdge {
    #[inline(always)]
    fn filter<U: Floats<Scalar: Precision>>(
        kernel: &Kernel<U>,
        a: [LaneVector<U>; 2],
        b: [LaneVector<U>; 2],
        limits: KernelLimits,
    ) -> Verdicts {
        kernel.two_edges(a, b, limits)
    }

    fn decide(a: &[Point; 2], b: &[Point; 2], threshold: Threshold) -> Decision {
        edge_edge::decide(a, b, threshold)
    }
}

impl Batched<1, 3> for VertexTriangle {
    #[inline(always)]
    fn filter<U: Floats<Scalar: Precision>>(
        kernel: &Kernel<U>,
        _: [LaneVector<U>; 1],
        b: [LaneVector<U>; 3],
        limits: KernelLimits,
    ) -> Verdicts {
        kernel.vertex_and_triangle(b, limits)
    }

    fn decide([a]: &[Point; 1], b: &[Point; 3], threshold: Threshold) -> Decision {
        vertex_triangle::decide(a, b, threshold)
    }
}

/// Hulls of `K` points, a lane each: `[point][axis][lane]`.
type HullLanes<const K: usize> = [[[f64; LANES]; 3]; K];

/// The hull in a lane.
fn hull<const K: usize>(of: &HullLanes<K>, lane: usize) -> [Point; K] {
    of.map(|point| point.map(|lanes| lanes[lane]))
}

#[inline(always)]
fn set<const K: usize>(of: &mut HullLanes<K>, lane: usize, hull: &[Point; K]) {
    for (point, from) in of.iter_mut().zip(hull) {
        for axis in 0..3 {
            point[axis][lane] = from[axis];
        }
    }
}

/// Pairs of hulls of `M` and `N` points, as [`TriangleBatch`].
#[derive(Debug, Clone)]
pub(crate) struct Batch<P, const M: usize, const N: usize, T> {
    threshold: Threshold,
    single: Scaled,
    a: HullLanes<M>,
    b: HullLanes<N>,
    tags: [T; LANES],
    len: usize,
    pair: PhantomData<P>,
}

#[expect(private_bounds, reason = "the kinds are known here only")]
impl<P: Batched<M, N>, const M: usize, const N: usize, T: Copy + Default> Batch<P, M, N, T> {
    pub(crate) fn new(threshold: Threshold) -> Self {
        Self {
            threshold,
            single: Scaled::new(threshold),
            a: [[[0.0; LANES]; 3]; M],
            b: [[[0.0; LANES]; 3]; N],
            tags: [T::default(); LANES],
            len: 0,
            pair: PhantomData,
        }
    }

    #[inline]
    pub(crate) fn push(&mut self, a: &[Point; M], b: &[Point; N], tag: T, answer: impl FnMut(T, Decision)) {
        let lane = self.len;
        set(&mut self.a, lane, a);
        set(&mut self.b, lane, b);
        self.tags[lane] = tag;
        self.len += 1;
        if self.len == LANES {
            self.finish(answer);
        }
    }

    pub(crate) fn finish(&mut self, mut answer: impl FnMut(T, Decision)) {
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
                P::decide(&hull(&self.a, lane), &hull(&self.b, lane), self.threshold)
            };
            answer(self.tags[lane], decision);
        }
        self.len = 0;
    }

    fn filter(&self) -> Verdicts {
        let (a, b, pair) = (&self.a, &self.b, self.pair);
        let scaled = self.single;
        let mut verdicts = if scaled.first == 1.0 {
            dispatch(InSingle { a, b, scaled, pair })
        } else {
            let (a, b) = (&scaled.prepared(a), &scaled.prepared(b));
            dispatch(InSingle { a, b, scaled, pair })
        };
        let all = (1 << self.len) - 1;
        if verdicts.in_range & all != all {
            let double = dispatch(InDouble {
                a,
                b,
                threshold: self.threshold,
                pair,
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
    fn prepared<const K: usize>(&self, hulls: &HullLanes<K>) -> HullLanes<K> {
        hulls.map(|point| point.map(|axis| axis.map(|x| x * self.first)))
    }
}

/// The filter in single precision, all pairs at once.
struct InSingle<'p, P, const M: usize, const N: usize> {
    a: &'p HullLanes<M>,
    b: &'p HullLanes<N>,
    scaled: Scaled,
    pair: PhantomData<P>,
}

impl<P: Batched<M, N>, const M: usize, const N: usize> Work for InSingle<'_, P, M, N> {
    type Output = Verdicts;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Verdicts {
        let unit = lanes.single();
        let Scaled { scale, limits, .. } = self.scaled;
        let origin = &self.a[0];
        let mut local_a = [[[0.0_f32; LANES]; 3]; M];
        let mut local_b = [[[0.0_f32; LANES]; 3]; N];
        let of_a = self.a.iter().zip(&mut local_a);
        for (point, local) in of_a.chain(self.b.iter().zip(&mut local_b)) {
            for axis in 0..3 {
                for lane in 0..LANES {
                    local[axis][lane] = ((point[axis][lane] - origin[axis][lane]) * scale) as f32;
                }
            }
        }
        let mut a = [[unit.splat(0.0); 3]; M];
        let mut b = [[unit.splat(0.0); 3]; N];
        for axis in 0..3 {
            for vertex in 0..M {
                a[vertex][axis] = unit.load(&local_a[vertex][axis]);
            }
            for vertex in 0..N {
                b[vertex][axis] = unit.load(&local_b[vertex][axis]);
            }
        }
        P::filter(&Kernel { unit }, a, b, limits)
    }
}

/// The filter in double precision, half of the pairs at a time.
struct InDouble<'p, P, const M: usize, const N: usize> {
    a: &'p HullLanes<M>,
    b: &'p HullLanes<N>,
    threshold: Threshold,
    pair: PhantomData<P>,
}

impl<P: Batched<M, N>, const M: usize, const N: usize> Work for InDouble<'_, P, M, N> {
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
            let mut a = [[unit.splat(0.0); 3]; M];
            let mut b = [[unit.splat(0.0); 3]; N];
            for axis in 0..3 {
                let origin = unit.load(&self.a[0][axis].as_chunks::<4>().0[half]);
                for (point, lanes) in a.iter_mut().zip(self.a) {
                    point[axis] = unit.sub(unit.load(&lanes[axis].as_chunks::<4>().0[half]), origin);
                }
                for (point, lanes) in b.iter_mut().zip(self.b) {
                    point[axis] = unit.sub(unit.load(&lanes[axis].as_chunks::<4>().0[half]), origin);
                }
            }
            let verdicts = P::filter(&Kernel { unit }, a, b, limits);
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

    /// Machines with and without AVX2 give the same bits, and no answer in single precision contradicts double precision, nor that of one
    /// pair. Returns how many pairs each precision leaves open.
    fn answers_of<P: Batched<M, N>, const M: usize, const N: usize>() -> [u32; 2] {
        let (mut a, mut b) = ([[[0.0; LANES]; 3]; M], [[[0.0; LANES]; 3]; N]);
        let mut state = 1_u64;
        let (mut open, mut single_open) = (0, 0);
        for round in 0..500 {
            for x in a.iter_mut().flatten().chain(b.iter_mut().flatten()).flatten() {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                *x = if round % 50 == 0 && state >> 60 == 0 {
                    f64::NAN
                } else if round % 7 == 0 {
                    // degenerate and parallel features
                    (state >> 62) as f64 / 4.0
                } else {
                    (state >> 40) as f64 / 16_777_216.0
                };
            }
            let threshold = Threshold::new(0.02 + 0.0005 * f64::from(round)).unwrap();
            let (a, b, pair) = (&a, &b, PhantomData::<P>);
            let double = || InDouble {
                a,
                b,
                threshold,
                pair,
            };
            let scaled = Scaled::new(threshold);
            let single = || InSingle { a, b, scaled, pair };
            let in_double = dispatch(double());
            assert_eq!(in_double, double().run(Portable));
            let in_single = dispatch(single());
            assert_eq!(in_single, single().run(Portable));
            for verdicts in [in_single, in_double] {
                assert_eq!(verdicts.within & verdicts.apart, 0);
                assert_eq!((verdicts.within | verdicts.apart) & !verdicts.in_range, 0);
                for lane in 0..LANES {
                    let (one, two) = (hull(a, lane), hull(b, lane));
                    let decision = P::decide(&one, &two, threshold);
                    assert!(!decision.within || verdicts.apart >> lane & 1 == 0);
                    assert!(decision.within || verdicts.within >> lane & 1 == 0);
                    let has_nan = one.iter().chain(&two).flatten().any(|x| x.is_nan());
                    assert!(!has_nan || verdicts.in_range >> lane & 1 == 0);
                }
            }
            assert_eq!(in_single.within & in_double.apart, 0);
            assert_eq!(in_single.apart & in_double.within, 0);
            let left = |verdicts: Verdicts| (!(verdicts.within | verdicts.apart) & 0xff).count_ones();
            open += left(in_double);
            single_open += left(in_single);
        }
        [open, single_open]
    }

    #[test]
    fn neither_the_vector_unit_nor_the_precision_changes_an_answer() {
        for open in [
            answers_of::<TriangleTriangle, 3, 3>(),
            answers_of::<EdgeEdge, 2, 2>(),
            answers_of::<VertexTriangle, 1, 3>(),
        ] {
            assert!(open.iter().all(|&open| open < 800), "{open:?} of 4000 left open");
        }
    }
}

//! Vector units: four `f64` lanes or eight `f32` lanes of AVX2 where the machine has it, plain arrays elsewhere, chosen when the
//! program runs.
//!
//! With and without AVX2 the bits are the same: only operations that IEEE 754 defines are used, none of them fused.

use super::frame::{ABOVE_ONE, GAP_ERROR, GREATEST_RHO, LEAST_GAP, LEAST_RHO, SPAN_ERROR};

/// What the proofs in `frame` need to know of a precision, with its unit roundoff u.
pub(super) struct Bounds {
    /// 1 + 8u.
    pub(super) above_one: f64,
    /// 16u: the error of a gap in units of `rho |v|_1`.
    pub(super) gap_error: f64,
    /// 64u: the error of an upper bound in units of `rho`.
    pub(super) span_error: f64,
    /// The least gap that is believed.
    pub(super) least_gap: f64,
    /// The range of `rho` for which this holds.
    pub(super) least_rho: f64,
    pub(super) greatest_rho: f64,
}

/// The bounds of `frame`.
const DOUBLE: Bounds = Bounds {
    above_one: ABOVE_ONE,
    gap_error: GAP_ERROR,
    span_error: SPAN_ERROR,
    least_gap: LEAST_GAP,
    least_rho: LEAST_RHO,
    greatest_rho: GREATEST_RHO,
};

const U_SINGLE: f64 = 1.0 / (1_u64 << 24) as f64;

/// Of single precision, u = 2^-24. The proofs in `frame` hold word for word, but for these ranges of what vanishes and
/// overflows: a coordinate, a difference in double precision times a power of two, rounded, is wrong by less than
/// `(1 + 2^-28) u rho + 2^-150`, and `u rho >= 2^-44`. A gap of at least 2^-40 gives `|v|_1 >= 2^-54`, hence `v.v >= 2^-110` is
/// normal, and the slack `3.9 u rho |v|_1 >= 2^-97` dwarfs every 2^-149. With `rho <= 2^12` a normal is below 2^28 and a gap
/// along it below 2^43, so that no square overflows. Underflow in `v^.v^` moves `|v^|` by less than 2^-73; the slack, `13 u rho`
/// where `kernel` has used up 51 of 64, is at least 2^-41. Delta is between 1 and 2.
const SINGLE: Bounds = Bounds {
    above_one: 1.0 + 8.0 * U_SINGLE,
    gap_error: 16.0 * U_SINGLE,
    span_error: 64.0 * U_SINGLE,
    least_gap: 1.0 / (1_u64 << 40) as f64,
    least_rho: 1.0 / (1_u64 << 20) as f64,
    greatest_rho: (1_u64 << 12) as f64,
};

/// A vector unit. Masks are bits, lane `i` in bit `i`.
pub(super) trait Unit: Copy {
    /// As many numbers side by side as there are lanes.
    type Lanes;
    /// The same in registers.
    type Number: Copy;
    const BOUNDS: Bounds;
    fn load(self, x: &Self::Lanes) -> Self::Number;
    /// `x`, rounded to the precision of the unit where that does not hold it, as 1/3.
    fn splat(self, x: f64) -> Self::Number;
    fn add(self, x: Self::Number, y: Self::Number) -> Self::Number;
    fn sub(self, x: Self::Number, y: Self::Number) -> Self::Number;
    fn mul(self, x: Self::Number, y: Self::Number) -> Self::Number;
    fn div(self, x: Self::Number, y: Self::Number) -> Self::Number;
    /// `x < y ? x : y`.
    fn least(self, x: Self::Number, y: Self::Number) -> Self::Number;
    /// `x > y ? x : y`.
    fn greatest(self, x: Self::Number, y: Self::Number) -> Self::Number;
    fn abs(self, x: Self::Number) -> Self::Number;
    /// `x == y ? then : other`.
    fn if_equal(
        self,
        x: Self::Number,
        y: Self::Number,
        then: Self::Number,
        other: Self::Number,
    ) -> Self::Number;
    /// Lanes with `x < y`.
    fn below(self, x: Self::Number, y: Self::Number) -> u32;
    /// Lanes with `x <= y`.
    fn at_most(self, x: Self::Number, y: Self::Number) -> u32;
}

/// A piece of work that runs inside a function compiled for the vector unit found.
pub(super) trait Work<L> {
    type Output;
    /// Has to be `#[inline(always)]` to be compiled for the unit.
    fn run<U: Unit<Lanes = L>>(self, unit: U) -> Self::Output;
}

/// Runs `work` in double precision on the best unit of this machine.
#[inline(always)]
pub(super) fn dispatch<W: Work<[f64; 4]>>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(unit) = pulp::x86::V3::try_new() {
        return unit.vectorize(avx2::Double(unit, work));
    }
    work.run(Portable)
}

/// The same in single precision.
#[inline(always)]
pub(super) fn dispatch_single<W: Work<[f32; 8]>>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(unit) = pulp::x86::V3::try_new() {
        return unit.vectorize(avx2::OfSingle(unit, work));
    }
    work.run(Single(Portable))
}

/// Plain arrays.
#[derive(Clone, Copy)]
pub(super) struct Portable;

/// A unit in single precision.
#[derive(Clone, Copy)]
pub(super) struct Single<U>(pub(super) U);

macro_rules! plain {
    ($unit:ty, $real:ty, $lanes:literal, $bounds:expr) => {
        impl Unit for $unit {
            type Lanes = [$real; $lanes];
            type Number = [$real; $lanes];
            const BOUNDS: Bounds = $bounds;

            #[inline(always)]
            fn load(self, x: &Self::Lanes) -> Self::Number {
                *x
            }
            #[inline(always)]
            fn splat(self, x: f64) -> Self::Number {
                [x as $real; $lanes]
            }
            #[inline(always)]
            fn add(self, x: Self::Number, y: Self::Number) -> Self::Number {
                std::array::from_fn(|k| x[k] + y[k])
            }
            #[inline(always)]
            fn sub(self, x: Self::Number, y: Self::Number) -> Self::Number {
                std::array::from_fn(|k| x[k] - y[k])
            }
            #[inline(always)]
            fn mul(self, x: Self::Number, y: Self::Number) -> Self::Number {
                std::array::from_fn(|k| x[k] * y[k])
            }
            #[inline(always)]
            fn div(self, x: Self::Number, y: Self::Number) -> Self::Number {
                std::array::from_fn(|k| x[k] / y[k])
            }
            #[inline(always)]
            fn least(self, x: Self::Number, y: Self::Number) -> Self::Number {
                std::array::from_fn(|k| if x[k] < y[k] { x[k] } else { y[k] })
            }
            #[inline(always)]
            fn greatest(self, x: Self::Number, y: Self::Number) -> Self::Number {
                std::array::from_fn(|k| if x[k] > y[k] { x[k] } else { y[k] })
            }
            #[inline(always)]
            fn abs(self, x: Self::Number) -> Self::Number {
                std::array::from_fn(|k| x[k].abs())
            }
            #[inline(always)]
            fn if_equal(
                self,
                x: Self::Number,
                y: Self::Number,
                then: Self::Number,
                other: Self::Number,
            ) -> Self::Number {
                std::array::from_fn(|k| if x[k] == y[k] { then[k] } else { other[k] })
            }
            #[inline(always)]
            fn below(self, x: Self::Number, y: Self::Number) -> u32 {
                (0..$lanes).fold(0, |bits, k| bits | u32::from(x[k] < y[k]) << k)
            }
            #[inline(always)]
            fn at_most(self, x: Self::Number, y: Self::Number) -> u32 {
                (0..$lanes).fold(0, |bits, k| bits | u32::from(x[k] <= y[k]) << k)
            }
        }
    };
}

plain!(Portable, f64, 4, DOUBLE);
plain!(Single<Portable>, f32, 8, SINGLE);

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::{__m256, __m256d, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ};

    use pulp::NullaryFnOnce;
    use pulp::x86::V3;

    use super::{Bounds, DOUBLE, SINGLE, Single, Unit, Work};

    pub(super) struct Double<W>(pub(super) V3, pub(super) W);

    impl<W: Work<[f64; 4]>> NullaryFnOnce for Double<W> {
        type Output = W::Output;

        #[inline(always)]
        fn call(self) -> W::Output {
            self.1.run(self.0)
        }
    }

    pub(super) struct OfSingle<W>(pub(super) V3, pub(super) W);

    impl<W: Work<[f32; 8]>> NullaryFnOnce for OfSingle<W> {
        type Output = W::Output;

        #[inline(always)]
        fn call(self) -> W::Output {
            self.1.run(Single(self.0))
        }
    }

    /// A unit: how to reach its instructions, the types, the bounds, and the names of the instructions in its precision.
    macro_rules! unit {
        (
            $unit:ty, |$this:ident| $avx:expr, [$real:ident; $lanes:literal], $number:ident, $bounds:ident,
            $set:ident $add:ident $sub:ident $mul:ident $div:ident $min:ident $max:ident $andnot:ident $blend:ident $mask:ident
            $compare:ident
        ) => {
            impl Unit for $unit {
                type Lanes = [$real; $lanes];
                type Number = $number;
                const BOUNDS: Bounds = $bounds;

                #[inline(always)]
                fn load(self, x: &[$real; $lanes]) -> $number {
                    pulp::cast(*x)
                }
                #[inline(always)]
                fn splat(self, x: f64) -> $number {
                    let $this = self;
                    $avx.$set(x as $real)
                }
                #[inline(always)]
                fn add(self, x: $number, y: $number) -> $number {
                    let $this = self;
                    $avx.$add(x, y)
                }
                #[inline(always)]
                fn sub(self, x: $number, y: $number) -> $number {
                    let $this = self;
                    $avx.$sub(x, y)
                }
                #[inline(always)]
                fn mul(self, x: $number, y: $number) -> $number {
                    let $this = self;
                    $avx.$mul(x, y)
                }
                #[inline(always)]
                fn div(self, x: $number, y: $number) -> $number {
                    let $this = self;
                    $avx.$div(x, y)
                }
                #[inline(always)]
                fn least(self, x: $number, y: $number) -> $number {
                    let $this = self;
                    $avx.$min(x, y)
                }
                #[inline(always)]
                fn greatest(self, x: $number, y: $number) -> $number {
                    let $this = self;
                    $avx.$max(x, y)
                }
                #[inline(always)]
                fn abs(self, x: $number) -> $number {
                    let $this = self;
                    $avx.$andnot($avx.$set(-0.0), x)
                }
                #[inline(always)]
                fn if_equal(self, x: $number, y: $number, then: $number, other: $number) -> $number {
                    let $this = self;
                    $avx.$blend(other, then, $avx.$compare::<_CMP_EQ_OQ>(x, y))
                }
                #[inline(always)]
                fn below(self, x: $number, y: $number) -> u32 {
                    let $this = self;
                    $avx.$mask($avx.$compare::<_CMP_LT_OQ>(x, y)) as u32
                }
                #[inline(always)]
                fn at_most(self, x: $number, y: $number) -> u32 {
                    let $this = self;
                    $avx.$mask($avx.$compare::<_CMP_LE_OQ>(x, y)) as u32
                }
            }
        };
    }

    unit!(
        V3, |unit| unit.avx, [f64; 4], __m256d, DOUBLE,
        _mm256_set1_pd _mm256_add_pd _mm256_sub_pd _mm256_mul_pd _mm256_div_pd _mm256_min_pd _mm256_max_pd
        _mm256_andnot_pd _mm256_blendv_pd _mm256_movemask_pd _mm256_cmp_pd
    );
    unit!(
        Single<V3>, |unit| unit.0.avx, [f32; 8], __m256, SINGLE,
        _mm256_set1_ps _mm256_add_ps _mm256_sub_ps _mm256_mul_ps _mm256_div_ps _mm256_min_ps _mm256_max_ps
        _mm256_andnot_ps _mm256_blendv_ps _mm256_movemask_ps _mm256_cmp_ps
    );
}

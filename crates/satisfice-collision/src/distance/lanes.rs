//! Four `f64` lanes: AVX2 where the machine has it, plain arrays elsewhere, chosen when the program runs.
//!
//! Both compute the same bits: only operations that IEEE 754 defines are used, none of them fused.

/// Four numbers side by side.
pub(super) type Four = [f64; 4];

/// A vector unit. Masks are bits, lane `i` in bit `i`.
pub(super) trait Unit: Copy {
    /// Four numbers in registers.
    type Number: Copy;
    fn load(self, x: &Four) -> Self::Number;
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
pub(super) trait Work {
    type Output;
    /// Has to be `#[inline(always)]` to be compiled for the unit.
    fn run<U: Unit>(self, unit: U) -> Self::Output;
}

/// Runs `work` on the best unit of this machine.
#[inline(always)]
pub(super) fn dispatch<W: Work>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(unit) = pulp::x86::V3::try_new() {
        return unit.vectorize(avx2::OnAvx2(unit, work));
    }
    work.run(Portable)
}

/// Plain arrays.
#[derive(Clone, Copy)]
pub(super) struct Portable;

macro_rules! each {
    ($k:ident, $value:expr) => {{
        let mut lanes = [0.0; 4];
        for ($k, lane) in lanes.iter_mut().enumerate() {
            *lane = $value;
        }
        lanes
    }};
}

impl Unit for Portable {
    type Number = Four;

    #[inline(always)]
    fn load(self, x: &Four) -> Four {
        *x
    }
    #[inline(always)]
    fn splat(self, x: f64) -> Four {
        [x; 4]
    }
    #[inline(always)]
    fn add(self, x: Four, y: Four) -> Four {
        each!(k, x[k] + y[k])
    }
    #[inline(always)]
    fn sub(self, x: Four, y: Four) -> Four {
        each!(k, x[k] - y[k])
    }
    #[inline(always)]
    fn mul(self, x: Four, y: Four) -> Four {
        each!(k, x[k] * y[k])
    }
    #[inline(always)]
    fn div(self, x: Four, y: Four) -> Four {
        each!(k, x[k] / y[k])
    }
    #[inline(always)]
    fn least(self, x: Four, y: Four) -> Four {
        each!(k, if x[k] < y[k] { x[k] } else { y[k] })
    }
    #[inline(always)]
    fn greatest(self, x: Four, y: Four) -> Four {
        each!(k, if x[k] > y[k] { x[k] } else { y[k] })
    }
    #[inline(always)]
    fn abs(self, x: Four) -> Four {
        each!(k, x[k].abs())
    }
    #[inline(always)]
    fn if_equal(self, x: Four, y: Four, then: Four, other: Four) -> Four {
        each!(k, if x[k] == y[k] { then[k] } else { other[k] })
    }
    #[inline(always)]
    fn below(self, x: Four, y: Four) -> u32 {
        (0..4).fold(0, |bits, k| bits | u32::from(x[k] < y[k]) << k)
    }
    #[inline(always)]
    fn at_most(self, x: Four, y: Four) -> u32 {
        (0..4).fold(0, |bits, k| bits | u32::from(x[k] <= y[k]) << k)
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::{__m256d, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ};

    use pulp::NullaryFnOnce;
    use pulp::x86::V3;

    use super::{Four, Unit, Work};

    pub(super) struct OnAvx2<W>(pub(super) V3, pub(super) W);

    impl<W: Work> NullaryFnOnce for OnAvx2<W> {
        type Output = W::Output;

        #[inline(always)]
        fn call(self) -> W::Output {
            self.1.run(self.0)
        }
    }

    impl Unit for V3 {
        type Number = __m256d;

        #[inline(always)]
        fn load(self, x: &Four) -> __m256d {
            pulp::cast(*x)
        }
        #[inline(always)]
        fn splat(self, x: f64) -> __m256d {
            self.avx._mm256_set1_pd(x)
        }
        #[inline(always)]
        fn add(self, x: __m256d, y: __m256d) -> __m256d {
            self.avx._mm256_add_pd(x, y)
        }
        #[inline(always)]
        fn sub(self, x: __m256d, y: __m256d) -> __m256d {
            self.avx._mm256_sub_pd(x, y)
        }
        #[inline(always)]
        fn mul(self, x: __m256d, y: __m256d) -> __m256d {
            self.avx._mm256_mul_pd(x, y)
        }
        #[inline(always)]
        fn div(self, x: __m256d, y: __m256d) -> __m256d {
            self.avx._mm256_div_pd(x, y)
        }
        #[inline(always)]
        fn least(self, x: __m256d, y: __m256d) -> __m256d {
            self.avx._mm256_min_pd(x, y)
        }
        #[inline(always)]
        fn greatest(self, x: __m256d, y: __m256d) -> __m256d {
            self.avx._mm256_max_pd(x, y)
        }
        #[inline(always)]
        fn abs(self, x: __m256d) -> __m256d {
            self.avx._mm256_andnot_pd(self.avx._mm256_set1_pd(-0.0), x)
        }
        #[inline(always)]
        fn if_equal(self, x: __m256d, y: __m256d, then: __m256d, other: __m256d) -> __m256d {
            self.avx
                ._mm256_blendv_pd(other, then, self.avx._mm256_cmp_pd::<_CMP_EQ_OQ>(x, y))
        }
        #[inline(always)]
        fn below(self, x: __m256d, y: __m256d) -> u32 {
            self.avx
                ._mm256_movemask_pd(self.avx._mm256_cmp_pd::<_CMP_LT_OQ>(x, y)) as u32
        }
        #[inline(always)]
        fn at_most(self, x: __m256d, y: __m256d) -> u32 {
            self.avx
                ._mm256_movemask_pd(self.avx._mm256_cmp_pd::<_CMP_LE_OQ>(x, y)) as u32
        }
    }
}

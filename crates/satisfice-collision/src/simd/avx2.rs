//! The unit of x86-64 machines with AVX2 and FMA, without unsafe code: `pulp` proves that the machine has it.

use std::arch::x86_64::{__m256, __m256d, __m256i, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ};

use pulp::NullaryFnOnce;
use pulp::x86::V3;

use super::{Eight, Floats, Lanes, Work};

/// Work to be compiled for this unit.
pub(super) struct OnAvx2<W>(pub(super) V3, pub(super) W);

impl<W: Work> NullaryFnOnce for OnAvx2<W> {
    type Output = W::Output;

    #[inline(always)]
    fn call(self) -> W::Output {
        self.1.run(self.0)
    }
}

/// Eight `f32`.
#[derive(Clone, Copy)]
pub(crate) struct Single(V3);

/// Four `f64`.
#[derive(Clone, Copy)]
pub(crate) struct Double(V3);

/// The elementary operations, by the names of the instructions of a precision.
macro_rules! floats {
    (
        $unit:ty, [$real:ident; $lanes:literal], $number:ident,
        $set:ident $add:ident $sub:ident $mul:ident $div:ident $fmadd:ident $min:ident $max:ident
        $and:ident $andnot:ident $blend:ident $mask:ident $compare:ident
    ) => {
        impl Floats for $unit {
            type Scalar = $real;
            type Array = [$real; $lanes];
            type Number = $number;
            type Mask = $number;

            #[inline(always)]
            fn load(self, x: &Self::Array) -> $number {
                pulp::cast(*x)
            }
            #[inline(always)]
            fn store(self, x: $number) -> Self::Array {
                pulp::cast(x)
            }
            #[inline(always)]
            fn splat(self, x: $real) -> $number {
                self.0.avx.$set(x)
            }
            #[inline(always)]
            fn add(self, x: $number, y: $number) -> $number {
                self.0.avx.$add(x, y)
            }
            #[inline(always)]
            fn sub(self, x: $number, y: $number) -> $number {
                self.0.avx.$sub(x, y)
            }
            #[inline(always)]
            fn mul(self, x: $number, y: $number) -> $number {
                self.0.avx.$mul(x, y)
            }
            #[inline(always)]
            fn div(self, x: $number, y: $number) -> $number {
                self.0.avx.$div(x, y)
            }
            #[inline(always)]
            fn mul_add(self, x: $number, y: $number, z: $number) -> $number {
                self.0.fma.$fmadd(x, y, z)
            }
            #[inline(always)]
            fn min(self, x: $number, y: $number) -> $number {
                self.0.avx.$min(x, y)
            }
            #[inline(always)]
            fn max(self, x: $number, y: $number) -> $number {
                self.0.avx.$max(x, y)
            }
            #[inline(always)]
            fn abs(self, x: $number) -> $number {
                self.0.avx.$andnot(self.0.avx.$set(-0.0), x)
            }
            #[inline(always)]
            fn if_equal(self, x: $number, y: $number, then: $number, other: $number) -> $number {
                let equal = self.0.avx.$compare::<_CMP_EQ_OQ>(x, y);
                self.0.avx.$blend(other, then, equal)
            }
            #[inline(always)]
            fn select(self, mask: $number, then: $number, other: $number) -> $number {
                self.0.avx.$blend(other, then, mask)
            }
            #[inline(always)]
            fn less(self, x: $number, y: $number) -> $number {
                self.0.avx.$compare::<_CMP_LT_OQ>(x, y)
            }
            #[inline(always)]
            fn at_most(self, x: $number, y: $number) -> $number {
                self.0.avx.$compare::<_CMP_LE_OQ>(x, y)
            }
            #[inline(always)]
            fn both(self, x: $number, y: $number) -> $number {
                self.0.avx.$and(x, y)
            }
            #[inline(always)]
            fn bits(self, mask: $number) -> u32 {
                self.0.avx.$mask(mask) as u32
            }
        }
    };
}

floats!(
    Single, [f32; 8], __m256,
    _mm256_set1_ps _mm256_add_ps _mm256_sub_ps _mm256_mul_ps _mm256_div_ps _mm256_fmadd_ps _mm256_min_ps _mm256_max_ps
    _mm256_and_ps _mm256_andnot_ps _mm256_blendv_ps _mm256_movemask_ps _mm256_cmp_ps
);
floats!(
    Double, [f64; 4], __m256d,
    _mm256_set1_pd _mm256_add_pd _mm256_sub_pd _mm256_mul_pd _mm256_div_pd _mm256_fmadd_pd _mm256_min_pd _mm256_max_pd
    _mm256_and_pd _mm256_andnot_pd _mm256_blendv_pd _mm256_movemask_pd _mm256_cmp_pd
);

/// For each mask the numbers of its lanes, in order.
static ORDER: [[u32; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut at) = (0, 0);
        while lane < 8 {
            if mask >> lane & 1 == 1 {
                table[mask][at] = lane;
                at += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

#[inline(always)]
fn order(mask: u32) -> __m256i {
    pulp::cast(ORDER[mask as usize & 255])
}

impl Lanes for V3 {
    type Single = Single;
    type Double = Double;

    #[inline(always)]
    fn single(self) -> Single {
        Single(self)
    }

    #[inline(always)]
    fn double(self) -> Double {
        Double(self)
    }

    #[inline(always)]
    #[expect(clippy::cast_sign_loss, reason = "masks of 32 bits")]
    fn rows(self, masks: [__m256; 8]) -> u64 {
        let avx2 = self.avx2;
        // Packing works within halves: the first halves of the four rows lie before the second ones.
        let in_order = pulp::cast([0_u32, 4, 1, 5, 2, 6, 3, 7]);
        let mut both = [0; 2];
        for half in 0..2 {
            let [a, b, c, d]: [__m256i; 4] = pulp::cast([
                masks[4 * half],
                masks[4 * half + 1],
                masks[4 * half + 2],
                masks[4 * half + 3],
            ]);
            let four = avx2._mm256_packs_epi16(avx2._mm256_packs_epi32(a, b), avx2._mm256_packs_epi32(c, d));
            let four = avx2._mm256_permutevar8x32_epi32(four, in_order);
            both[half] = avx2._mm256_movemask_epi8(four) as u32;
        }
        u64::from(both[0]) | u64::from(both[1]) << 32
    }

    #[inline(always)]
    fn columns(self, rows: &[[f32; 4]; 8]) -> [Eight; 3] {
        let avx = self.avx;
        // Rows i and i + 4 side by side: the columns of four such pairs are whole columns of eight.
        let pair: [__m256; 4] = [
            pulp::cast([rows[0], rows[4]]),
            pulp::cast([rows[1], rows[5]]),
            pulp::cast([rows[2], rows[6]]),
            pulp::cast([rows[3], rows[7]]),
        ];
        let (low, high) = (
            avx._mm256_unpacklo_ps(pair[0], pair[1]),
            avx._mm256_unpacklo_ps(pair[2], pair[3]),
        );
        let (low_z, high_z) = (
            avx._mm256_unpackhi_ps(pair[0], pair[1]),
            avx._mm256_unpackhi_ps(pair[2], pair[3]),
        );
        [
            pulp::cast(avx._mm256_shuffle_ps::<0x44>(low, high)),
            pulp::cast(avx._mm256_shuffle_ps::<0xee>(low, high)),
            pulp::cast(avx._mm256_shuffle_ps::<0x44>(low_z, high_z)),
        ]
    }

    #[inline(always)]
    fn compact(self, from: &Eight, mask: u32, to: &mut Eight) {
        *to = pulp::cast(self.avx2._mm256_permutevar8x32_ps(pulp::cast(*from), order(mask)));
    }

    #[inline(always)]
    fn compact_ids(self, from: &[u32; 8], mask: u32, to: &mut [u32; 8]) {
        *to = pulp::cast(
            self.avx2
                ._mm256_permutevar8x32_epi32(pulp::cast(*from), order(mask)),
        );
    }

    #[inline(always)]
    #[expect(clippy::cast_sign_loss, clippy::cast_possible_wrap, reason = "bits")]
    fn equal_ids(self, ids: &[u32; 8], id: u32) -> u32 {
        let id = self.avx._mm256_set1_epi32(id as i32);
        let equal = self.avx2._mm256_cmpeq_epi32(pulp::cast(*ids), id);
        self.avx._mm256_movemask_ps(pulp::cast(equal)) as u32
    }

    #[inline(always)]
    fn place(self, point: &[f64; 4], origin: &[f64; 4], scale: f64, axes: [u32; 4]) -> [f32; 4] {
        let avx = self.avx;
        let from = avx._mm256_sub_pd(pulp::cast(*point), pulp::cast(*origin));
        let scaled = avx._mm256_mul_pd(from, avx._mm256_set1_pd(scale));
        let placed = avx._mm256_cvtpd_ps(scaled);
        pulp::cast(avx._mm_permutevar_ps(placed, pulp::cast(axes)))
    }

    #[inline(always)]
    fn widen(self, [min, max]: &mut [[f32; 4]; 2], point: [f32; 4]) {
        let point = pulp::cast(point);
        *min = pulp::cast(self.sse._mm_min_ps(point, pulp::cast(*min)));
        *max = pulp::cast(self.sse._mm_max_ps(point, pulp::cast(*max)));
    }
}

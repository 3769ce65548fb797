//! Eight `f32` lanes: AVX2 where the machine has it, plain arrays elsewhere, chosen when the program runs.

/// Eight numbers side by side.
pub(crate) type Eight = [f32; 8];

/// What the broad phases ask of a vector unit. Bit `i` of a returned mask speaks of lane `i`.
pub(crate) trait Lanes: Copy + Send + Sync {
    /// Lanes whose squared distance from `p` is below `limit`. NaN and infinity are never below.
    fn closer(self, c: [&Eight; 3], p: [f32; 3], limit: f32) -> u32;
    /// Lanes inside the closed box `min..=max`.
    fn inside(self, c: [&Eight; 3], min: [f32; 3], max: [f32; 3]) -> u32;
    /// Lanes (boxes) whose squared distance from the box `min..=max` is at most `limit`.
    fn boxes_within(
        self,
        lower: [&Eight; 3],
        upper: [&Eight; 3],
        min: [f32; 3],
        max: [f32; 3],
        limit: f32,
    ) -> u32;
    /// The lanes of `mask` moved to the front of `to`, in order; what follows them is unspecified.
    fn compact(self, from: &Eight, mask: u32, to: &mut Eight);
    /// The same for serial numbers.
    fn compact_ids(self, from: &[u32; 8], mask: u32, to: &mut [u32; 8]);
    /// The least and the greatest of each of twelve columns, and whether all are finite.
    fn extremes(self, rows: &[[f64; 12]]) -> ([[f64; 12]; 2], bool);
    /// Whether each of the first three numbers lies between the bounds, which are included.
    fn is_inside(self, point: &[f64; 4], min: &[f64; 4], max: &[f64; 4]) -> bool;
    /// `((point - origin) * scale) as f32`, with the numbers then taken in the order of `axes`.
    fn place(self, point: &[f64; 4], origin: &[f64; 4], scale: f64, axes: [u32; 4]) -> [f32; 4];
    /// The lesser and the greater of each two numbers.
    fn widen(self, extremes: &mut [[f32; 4]; 2], point: [f32; 4]);
}

/// A piece of work that runs inside a function compiled for the vector unit found.
pub(crate) trait Work {
    /// What it returns.
    type Output;
    /// Runs; has to be `#[inline(always)]` to be compiled for the unit.
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// Runs `work` on the best unit of this machine. The result does not depend on the unit.
pub(crate) fn dispatch<W: Work>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(unit) = pulp::x86::V3::try_new() {
        return unit.vectorize(OnAvx2(unit, work));
    }
    work.run(Portable)
}

/// Plain arrays; the compiler vectorises as far as the build target allows.
#[derive(Clone, Copy)]
pub(crate) struct Portable;

#[inline(always)]
fn mask(of: impl Fn(usize) -> bool) -> u32 {
    (0..8).fold(0, |bits, i| bits | (u32::from(of(i)) << i))
}

/// Distance of two intervals, 0 if they meet.
#[inline(always)]
fn gap(lower: f32, upper: f32, min: f32, max: f32) -> f32 {
    (lower - max).max(min - upper).max(0.0)
}

impl Lanes for Portable {
    #[inline(always)]
    fn closer(self, c: [&Eight; 3], p: [f32; 3], limit: f32) -> u32 {
        mask(|i| {
            let (x, y, z) = (c[0][i] - p[0], c[1][i] - p[1], c[2][i] - p[2]);
            x * x + y * y + z * z < limit
        })
    }

    #[inline(always)]
    fn inside(self, c: [&Eight; 3], min: [f32; 3], max: [f32; 3]) -> u32 {
        mask(|i| (0..3).all(|k| min[k] <= c[k][i] && c[k][i] <= max[k]))
    }

    #[inline(always)]
    fn boxes_within(
        self,
        lower: [&Eight; 3],
        upper: [&Eight; 3],
        min: [f32; 3],
        max: [f32; 3],
        limit: f32,
    ) -> u32 {
        mask(|i| {
            let x = gap(lower[0][i], upper[0][i], min[0], max[0]);
            let y = gap(lower[1][i], upper[1][i], min[1], max[1]);
            let z = gap(lower[2][i], upper[2][i], min[2], max[2]);
            x * x + y * y + z * z <= limit
        })
    }

    #[inline(always)]
    fn compact(self, from: &Eight, mut mask: u32, to: &mut Eight) {
        let mut at = 0;
        while mask != 0 {
            to[at] = from[mask.trailing_zeros() as usize & 7];
            at += 1;
            mask &= mask - 1;
        }
    }

    #[inline(always)]
    fn compact_ids(self, from: &[u32; 8], mut mask: u32, to: &mut [u32; 8]) {
        let mut at = 0;
        while mask != 0 {
            to[at] = from[mask.trailing_zeros() as usize & 7];
            at += 1;
            mask &= mask - 1;
        }
    }

    #[inline(always)]
    fn extremes(self, rows: &[[f64; 12]]) -> ([[f64; 12]; 2], bool) {
        let (mut min, mut max, mut zero) = ([f64::INFINITY; 12], [f64::NEG_INFINITY; 12], [0.0; 12]);
        for row in rows {
            for k in 0..12 {
                min[k] = if row[k] < min[k] { row[k] } else { min[k] };
                max[k] = if row[k] > max[k] { row[k] } else { max[k] };
                zero[k] += row[k] * 0.0;
            }
        }
        ([min, max], zero.iter().all(|&zero| zero == 0.0))
    }

    #[inline(always)]
    fn is_inside(self, point: &[f64; 4], min: &[f64; 4], max: &[f64; 4]) -> bool {
        (0..3).fold(true, |inside, k| {
            inside & (min[k] <= point[k]) & (point[k] <= max[k])
        })
    }

    #[inline(always)]
    fn place(self, point: &[f64; 4], origin: &[f64; 4], scale: f64, axes: [u32; 4]) -> [f32; 4] {
        axes.map(|axis| {
            let axis = axis as usize & 3;
            ((point[axis] - origin[axis]) * scale) as f32
        })
    }

    #[inline(always)]
    fn widen(self, [min, max]: &mut [[f32; 4]; 2], point: [f32; 4]) {
        for k in 0..4 {
            min[k] = if point[k] < min[k] { point[k] } else { min[k] };
            max[k] = if point[k] > max[k] { point[k] } else { max[k] };
        }
    }
}

#[cfg(target_arch = "x86_64")]
use avx2::OnAvx2;

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::{__m256, __m256d, __m256i, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ};

    use pulp::NullaryFnOnce;
    use pulp::x86::V3;

    use super::{Eight, Lanes, Work};

    pub(super) struct OnAvx2<W>(pub(super) V3, pub(super) W);

    impl<W: Work> NullaryFnOnce for OnAvx2<W> {
        type Output = W::Output;

        #[inline(always)]
        fn call(self) -> W::Output {
            self.1.run(self.0)
        }
    }

    /// For each mask the lanes it names, in order.
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
    fn load(eight: &Eight) -> __m256 {
        pulp::cast(*eight)
    }

    #[inline(always)]
    fn order(mask: u32) -> __m256i {
        pulp::cast(ORDER[mask as usize & 255])
    }

    #[inline(always)]
    #[expect(clippy::cast_sign_loss, reason = "a mask of eight bits")]
    fn bits(unit: V3, of: __m256) -> u32 {
        unit.avx._mm256_movemask_ps(of) as u32
    }

    #[inline(always)]
    fn three(row: &[f64; 12]) -> [__m256d; 3] {
        pulp::cast(*row)
    }

    impl Lanes for V3 {
        #[inline(always)]
        fn closer(self, c: [&Eight; 3], p: [f32; 3], limit: f32) -> u32 {
            let avx = self.avx;
            let x = avx._mm256_sub_ps(load(c[0]), avx._mm256_set1_ps(p[0]));
            let y = avx._mm256_sub_ps(load(c[1]), avx._mm256_set1_ps(p[1]));
            let z = avx._mm256_sub_ps(load(c[2]), avx._mm256_set1_ps(p[2]));
            let d = avx._mm256_mul_ps(x, x);
            let d = self.fma._mm256_fmadd_ps(y, y, d);
            let d = self.fma._mm256_fmadd_ps(z, z, d);
            bits(
                self,
                avx._mm256_cmp_ps::<_CMP_LT_OQ>(d, avx._mm256_set1_ps(limit)),
            )
        }

        #[inline(always)]
        fn inside(self, c: [&Eight; 3], min: [f32; 3], max: [f32; 3]) -> u32 {
            let avx = self.avx;
            let axis = |k: usize| {
                let v = load(c[k]);
                avx._mm256_and_ps(
                    avx._mm256_cmp_ps::<_CMP_LE_OQ>(avx._mm256_set1_ps(min[k]), v),
                    avx._mm256_cmp_ps::<_CMP_LE_OQ>(v, avx._mm256_set1_ps(max[k])),
                )
            };
            bits(
                self,
                avx._mm256_and_ps(avx._mm256_and_ps(axis(0), axis(1)), axis(2)),
            )
        }

        #[inline(always)]
        fn boxes_within(
            self,
            lower: [&Eight; 3],
            upper: [&Eight; 3],
            min: [f32; 3],
            max: [f32; 3],
            limit: f32,
        ) -> u32 {
            let avx = self.avx;
            let axis = |k: usize| {
                let below = avx._mm256_sub_ps(load(lower[k]), avx._mm256_set1_ps(max[k]));
                let above = avx._mm256_sub_ps(avx._mm256_set1_ps(min[k]), load(upper[k]));
                avx._mm256_max_ps(avx._mm256_max_ps(below, above), avx._mm256_set1_ps(0.0))
            };
            let (x, y, z) = (axis(0), axis(1), axis(2));
            let d = avx._mm256_mul_ps(x, x);
            let d = self.fma._mm256_fmadd_ps(y, y, d);
            let d = self.fma._mm256_fmadd_ps(z, z, d);
            bits(
                self,
                avx._mm256_cmp_ps::<_CMP_LE_OQ>(d, avx._mm256_set1_ps(limit)),
            )
        }

        #[inline(always)]
        fn compact(self, from: &Eight, mask: u32, to: &mut Eight) {
            *to = pulp::cast(self.avx2._mm256_permutevar8x32_ps(load(from), order(mask)));
        }

        #[inline(always)]
        fn compact_ids(self, from: &[u32; 8], mask: u32, to: &mut [u32; 8]) {
            *to = pulp::cast(
                self.avx2
                    ._mm256_permutevar8x32_epi32(pulp::cast(*from), order(mask)),
            );
        }

        #[inline(always)]
        fn extremes(self, rows: &[[f64; 12]]) -> ([[f64; 12]; 2], bool) {
            let avx = self.avx;
            let mut min = [avx._mm256_set1_pd(f64::INFINITY); 3];
            let mut max = [avx._mm256_set1_pd(f64::NEG_INFINITY); 3];
            let mut zero = [avx._mm256_set1_pd(0.0); 3];
            let nothing = zero[0];
            for row in rows {
                let row = three(row);
                for k in 0..3 {
                    min[k] = avx._mm256_min_pd(row[k], min[k]);
                    max[k] = avx._mm256_max_pd(row[k], max[k]);
                    // not a number from here on, if one is not finite
                    zero[k] = self.fma._mm256_fmadd_pd(row[k], nothing, zero[k]);
                }
            }
            let zero = avx._mm256_add_pd(avx._mm256_add_pd(zero[0], zero[1]), zero[2]);
            let is_zero = avx._mm256_cmp_pd::<_CMP_EQ_OQ>(zero, nothing);
            (
                [pulp::cast(min), pulp::cast(max)],
                avx._mm256_movemask_pd(is_zero) == 0xf,
            )
        }

        #[inline(always)]
        fn is_inside(self, point: &[f64; 4], min: &[f64; 4], max: &[f64; 4]) -> bool {
            let avx = self.avx;
            let point = pulp::cast(*point);
            let above = avx._mm256_cmp_pd::<_CMP_LE_OQ>(pulp::cast(*min), point);
            let below = avx._mm256_cmp_pd::<_CMP_LE_OQ>(point, pulp::cast(*max));
            avx._mm256_movemask_pd(avx._mm256_and_pd(above, below)) & 7 == 7
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
}

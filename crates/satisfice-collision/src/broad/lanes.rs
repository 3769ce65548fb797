//! Eight `f32` lanes: AVX2 where the machine has it, plain arrays elsewhere, chosen when the program runs.

/// Eight numbers side by side.
pub(crate) type Eight = [f32; 8];

/// What the broad phases ask of a vector unit. Bit `i` of a returned mask speaks of lane `i`.
pub(crate) trait Lanes: Copy + Send + Sync {
    /// Lanes whose squared distance from `p` is below `limit`. NaN and infinity are never below.
    fn closer(self, c: [&Eight; 3], p: [f32; 3], limit: f32) -> u32;
    /// Lanes in which two points are closer than the root of `limit`.
    fn each_closer(self, a: &[Eight; 3], b: &[Eight; 3], limit: f32) -> u32;
    /// Lanes inside the closed box `min..=max`.
    fn inside(self, c: [&Eight; 3], min: [f32; 3], max: [f32; 3]) -> u32;
    /// `closer` for each of eight points: bit `8 i + j` speaks of point `i` and lane `j`.
    fn all_closer(self, c: [&Eight; 3], points: &[Eight; 3], limit: f32) -> u64;
    /// Lanes (boxes) whose squared distance from each of eight boxes `min..=max` is at most `limit`: bit `8 i + j` speaks of
    /// box `i` and lane `j`.
    fn boxes_within(
        self,
        lower: [&Eight; 3],
        upper: [&Eight; 3],
        min: &[Eight; 3],
        max: &[Eight; 3],
        limit: f32,
    ) -> u64;
    /// The first three columns of eight rows.
    fn columns(self, rows: &[[f32; 4]; 8]) -> [Eight; 3];
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

/// Eight masks as one.
#[inline(always)]
fn rows(of: impl Fn(usize) -> u32) -> u64 {
    (0..8).fold(0, |bits, i| bits | (u64::from(of(i)) << (8 * i)))
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
    fn each_closer(self, a: &[Eight; 3], b: &[Eight; 3], limit: f32) -> u32 {
        mask(|i| {
            let (x, y, z) = (a[0][i] - b[0][i], a[1][i] - b[1][i], a[2][i] - b[2][i]);
            x * x + y * y + z * z < limit
        })
    }

    #[inline(always)]
    fn inside(self, c: [&Eight; 3], min: [f32; 3], max: [f32; 3]) -> u32 {
        mask(|i| (0..3).all(|k| min[k] <= c[k][i] && c[k][i] <= max[k]))
    }

    #[inline(always)]
    fn all_closer(self, c: [&Eight; 3], points: &[Eight; 3], limit: f32) -> u64 {
        rows(|i| self.closer(c, points.map(|axis| axis[i]), limit))
    }

    #[inline(always)]
    fn boxes_within(
        self,
        lower: [&Eight; 3],
        upper: [&Eight; 3],
        min: &[Eight; 3],
        max: &[Eight; 3],
        limit: f32,
    ) -> u64 {
        rows(|i| {
            mask(|j| {
                let [x, y, z] = std::array::from_fn(|k| gap(lower[k][j], upper[k][j], min[k][i], max[k][i]));
                x * x + y * y + z * z <= limit
            })
        })
    }

    #[inline(always)]
    fn columns(self, rows: &[[f32; 4]; 8]) -> [Eight; 3] {
        std::array::from_fn(|k| rows.map(|row| row[k]))
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
    fn square(unit: V3, x: __m256, y: __m256, z: __m256) -> __m256 {
        let d = unit.avx._mm256_mul_ps(x, x);
        let d = unit.fma._mm256_fmadd_ps(y, y, d);
        unit.fma._mm256_fmadd_ps(z, z, d)
    }

    /// The results of eight comparisons as one mask.
    #[inline(always)]
    #[expect(clippy::cast_sign_loss, reason = "masks of 32 bits")]
    fn rows(unit: V3, row: [__m256; 8]) -> u64 {
        let avx2 = unit.avx2;
        // packing works within halves: the first halves of the four rows lie before the second ones
        let in_order = pulp::cast([0_u32, 4, 1, 5, 2, 6, 3, 7]);
        let mut both = [0; 2];
        for half in 0..2 {
            let [a, b, c, d]: [__m256i; 4] = pulp::cast([
                row[4 * half],
                row[4 * half + 1],
                row[4 * half + 2],
                row[4 * half + 3],
            ]);
            let four = avx2._mm256_packs_epi16(avx2._mm256_packs_epi32(a, b), avx2._mm256_packs_epi32(c, d));
            let four = avx2._mm256_permutevar8x32_epi32(four, in_order);
            both[half] = avx2._mm256_movemask_epi8(four) as u32;
        }
        u64::from(both[0]) | u64::from(both[1]) << 32
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
            let d = square(self, x, y, z);
            bits(
                self,
                avx._mm256_cmp_ps::<_CMP_LT_OQ>(d, avx._mm256_set1_ps(limit)),
            )
        }

        #[inline(always)]
        fn each_closer(self, a: &[Eight; 3], b: &[Eight; 3], limit: f32) -> u32 {
            let avx = self.avx;
            let x = avx._mm256_sub_ps(load(&a[0]), load(&b[0]));
            let y = avx._mm256_sub_ps(load(&a[1]), load(&b[1]));
            let z = avx._mm256_sub_ps(load(&a[2]), load(&b[2]));
            let limit = avx._mm256_set1_ps(limit);
            bits(
                self,
                avx._mm256_cmp_ps::<_CMP_LT_OQ>(square(self, x, y, z), limit),
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
        fn all_closer(self, c: [&Eight; 3], points: &[Eight; 3], limit: f32) -> u64 {
            let avx = self.avx;
            let (x, y, z) = (load(c[0]), load(c[1]), load(c[2]));
            let limit = avx._mm256_set1_ps(limit);
            let mut row = [limit; 8];
            for i in 0..8 {
                let x = avx._mm256_sub_ps(x, avx._mm256_set1_ps(points[0][i]));
                let y = avx._mm256_sub_ps(y, avx._mm256_set1_ps(points[1][i]));
                let z = avx._mm256_sub_ps(z, avx._mm256_set1_ps(points[2][i]));
                row[i] = avx._mm256_cmp_ps::<_CMP_LT_OQ>(square(self, x, y, z), limit);
            }
            rows(self, row)
        }

        #[inline(always)]
        fn boxes_within(
            self,
            lower: [&Eight; 3],
            upper: [&Eight; 3],
            min: &[Eight; 3],
            max: &[Eight; 3],
            limit: f32,
        ) -> u64 {
            let avx = self.avx;
            let lower = [load(lower[0]), load(lower[1]), load(lower[2])];
            let upper = [load(upper[0]), load(upper[1]), load(upper[2])];
            let (limit, nothing) = (avx._mm256_set1_ps(limit), avx._mm256_set1_ps(0.0));
            let mut row = [limit; 8];
            for i in 0..8 {
                let mut gap = [nothing; 3];
                for k in 0..3 {
                    let below = avx._mm256_sub_ps(lower[k], avx._mm256_set1_ps(max[k][i]));
                    let above = avx._mm256_sub_ps(avx._mm256_set1_ps(min[k][i]), upper[k]);
                    gap[k] = avx._mm256_max_ps(avx._mm256_max_ps(below, above), nothing);
                }
                let [x, y, z] = gap;
                row[i] = avx._mm256_cmp_ps::<_CMP_LE_OQ>(square(self, x, y, z), limit);
            }
            rows(self, row)
        }

        #[inline(always)]
        fn columns(self, rows: &[[f32; 4]; 8]) -> [Eight; 3] {
            let avx = self.avx;
            // rows i and i + 4 side by side: the columns of four such pairs are whole columns of eight
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

#[cfg(test)]
mod tests {
    use super::{Eight, Lanes, Portable, Work, dispatch};

    /// Numbers between -1 and 1 that look random.
    fn numbers(seed: u64) -> impl FnMut() -> f32 {
        let mut state = seed;
        move || {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(1);
            (state >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
        }
    }

    fn three(mut number: impl FnMut() -> f32) -> [Eight; 3] {
        std::array::from_fn(|_| std::array::from_fn(|_| number()))
    }

    struct AllAtOnce {
        a: [Eight; 3],
        b: [Eight; 3],
    }

    impl Work for AllAtOnce {
        type Output = (u64, u64, [Eight; 3], u32, u32, u32);

        #[inline(always)]
        fn run<L: Lanes>(self, lanes: L) -> Self::Output {
            let Self { a, b } = self;
            let of = |c: &[Eight; 3], pick: fn(f32) -> f32| c.map(|axis| axis.map(pick));
            let (lower, upper) = (of(&b, |c| c - 0.1), of(&b, |c| c + 0.2));
            let (min, max) = (of(&a, |c| c - 0.2), of(&a, |c| c + 0.1));
            let rows = std::array::from_fn(|i| [a[0][i], a[1][i], a[2][i], b[0][i]]);
            (
                lanes.all_closer([&b[0], &b[1], &b[2]], &a, 0.5),
                lanes.boxes_within(
                    [&lower[0], &lower[1], &lower[2]],
                    [&upper[0], &upper[1], &upper[2]],
                    &min,
                    &max,
                    0.2,
                ),
                lanes.columns(&rows),
                lanes.closer([&b[0], &b[1], &b[2]], [0.1, 0.2, 0.3], 0.5),
                lanes.inside([&b[0], &b[1], &b[2]], [-0.7; 3], [0.6; 3]),
                lanes.each_closer(&a, &b, 0.5),
            )
        }
    }

    #[test]
    fn every_unit_says_what_plain_arithmetic_says() {
        let mut number = numbers(7);
        let point = |c: &[Eight; 3], lane: usize| c.map(|axis| f64::from(axis[lane]));
        let (mut near, mut boxes_near) = (0, 0);
        for _ in 0..500 {
            let (a, b) = (three(&mut number), three(&mut number));
            let all = dispatch(AllAtOnce { a, b });
            assert_eq!(all, AllAtOnce { a, b }.run(Portable));
            let (points, boxes, columns, ..) = all;
            assert_eq!(columns, a);
            let diagonal = (0..8).map(|i| (points >> (9 * i) & 1) << i).sum::<u64>();
            assert_eq!(diagonal, u64::from(all.5));
            for i in 0..8 {
                for j in 0..8 {
                    let (p, q) = (point(&a, i), point(&b, j));
                    let way: [f64; 3] = std::array::from_fn(|k| p[k] - q[k]);
                    let square: f64 = way.iter().map(|d| d * d).sum();
                    // a's box ends .2 below and .1 above its point, b's .1 below and .2 above
                    let reach = |d: &f64| if *d > 0.0 { d - 0.4 } else { -d - 0.2 };
                    let gap: f64 = way.iter().map(|d| reach(d).max(0.0).powi(2)).sum();
                    let bit = |mask: u64| mask >> (8 * i + j) & 1 == 1;
                    assert!((square - 0.5).abs() < 1e-5 || bit(points) == (square < 0.5));
                    assert!((gap - 0.2).abs() < 1e-5 || bit(boxes) == (gap <= 0.2));
                    near += u32::from(bit(points));
                    boxes_near += u32::from(bit(boxes));
                }
            }
        }
        assert!(
            (1000..31_000).contains(&near) && (1000..31_000).contains(&boxes_near),
            "both answers occur"
        );
    }
}

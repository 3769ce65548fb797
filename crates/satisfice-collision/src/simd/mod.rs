//! The vector unit: AVX2 where the machine has it, plain arrays elsewhere, chosen when the program runs.
//!
//! [`Floats`] are the elementary operations of one precision: eight `f32` or four `f64` side by side. [`Lanes`] is a
//! whole unit with both precisions and the compound operations of the broad phases.
//!
//! Elementary operations are those of IEEE 754, so their results have the same bits on every unit; the proofs in
//! [`distance`](crate::distance) depend on that. The one exception is [`Floats::mul_add`], which may round once or
//! twice. Only tests of the broad phases use it, and their thresholds include that error.
//!
//! Code that runs on a unit avoids closures passed to the standard library, such as `array::map`: those are not compiled
//! for the unit, and every operation in them becomes a function call.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod portable;
#[cfg(test)]
mod tests;

pub(crate) use portable::Portable;

/// Eight numbers side by side.
pub(crate) type Eight = [f32; 8];

/// The elementary operations of a vector unit in one precision.
pub(crate) trait Floats: Copy {
    /// `f32` or `f64`.
    type Scalar;
    /// As many numbers in memory as there are lanes.
    type Array;
    /// The same numbers in registers.
    type Number: Copy;
    /// The result of a comparison, one truth value per lane.
    type Mask: Copy;

    fn load(self, x: &Self::Array) -> Self::Number;
    fn store(self, x: Self::Number) -> Self::Array;
    /// The same number in every lane.
    fn splat(self, x: Self::Scalar) -> Self::Number;
    fn add(self, x: Self::Number, y: Self::Number) -> Self::Number;
    fn sub(self, x: Self::Number, y: Self::Number) -> Self::Number;
    fn mul(self, x: Self::Number, y: Self::Number) -> Self::Number;
    fn div(self, x: Self::Number, y: Self::Number) -> Self::Number;
    /// `x * y + z`, rounded once where the unit can do that at no cost and twice elsewhere.
    fn mul_add(self, x: Self::Number, y: Self::Number, z: Self::Number) -> Self::Number;
    /// `x < y ? x : y`.
    fn min(self, x: Self::Number, y: Self::Number) -> Self::Number;
    /// `x > y ? x : y`.
    fn max(self, x: Self::Number, y: Self::Number) -> Self::Number;
    fn abs(self, x: Self::Number) -> Self::Number;
    /// `x == y ? then : other`.
    fn if_equal(
        self,
        x: Self::Number,
        y: Self::Number,
        then: Self::Number,
        other: Self::Number,
    ) -> Self::Number;
    /// `then` in the lanes of the mask, `other` elsewhere.
    fn select(self, mask: Self::Mask, then: Self::Number, other: Self::Number) -> Self::Number;
    /// `x < y`; false for NaN.
    fn less(self, x: Self::Number, y: Self::Number) -> Self::Mask;
    /// `x <= y`; false for NaN.
    fn at_most(self, x: Self::Number, y: Self::Number) -> Self::Mask;
    /// Lanes in which both are true.
    fn both(self, x: Self::Mask, y: Self::Mask) -> Self::Mask;
    /// A mask as bits, lane `i` in bit `i`.
    fn bits(self, mask: Self::Mask) -> u32;

    /// `x^2 + y^2 + z^2` by [`mul_add`](Self::mul_add).
    #[inline(always)]
    fn square(self, [x, y, z]: [Self::Number; 3]) -> Self::Number {
        self.mul_add(z, z, self.mul_add(y, y, self.mul(x, x)))
    }
}

/// A vector unit: both precisions and what the broad phases need beyond elementary operations.
pub(crate) trait Lanes: Copy + Send + Sync {
    /// Eight lanes in single precision.
    type Single: Floats<Scalar = f32, Array = Eight>;
    /// Four lanes in double precision.
    type Double: Floats<Scalar = f64, Array = [f64; 4]>;

    fn single(self) -> Self::Single;
    fn double(self) -> Self::Double;

    /// Eight masks as one number: bit `8 i + j` is lane `j` of mask `i`.
    fn rows(self, masks: [Mask<Self>; 8]) -> u64;
    /// The first three columns of eight rows.
    fn columns(self, rows: &[[f32; 4]; 8]) -> [Eight; 3];
    /// Moves the lanes of `mask` to the front of `to`, in order; what follows them is unspecified.
    fn compact(self, from: &Eight, mask: u32, to: &mut Eight);
    /// The same for feature numbers.
    fn compact_ids(self, from: &[u32; 8], mask: u32, to: &mut [u32; 8]);
    /// The lanes of `ids` that are `id`, a bit each.
    fn equal_ids(self, ids: &[u32; 8], id: u32) -> u32;
    /// `((point - origin) * scale) as f32`, with the components then taken in the order of `axes`.
    fn place(self, point: &[f64; 4], origin: &[f64; 4], scale: f64, axes: [u32; 4]) -> [f32; 4];
    /// Extends the bounds `[min, max]` to `point`.
    fn widen(self, bounds: &mut [[f32; 4]; 2], point: [f32; 4]);

    /// Lanes whose squared distance from `p` is below `limit`. NaN and infinity are never below.
    #[inline(always)]
    fn closer(self, c: [&Eight; 3], p: [f32; 3], limit: f32) -> u32 {
        let s = self.single();
        let way = |k: usize| s.sub(s.load(c[k]), s.splat(p[k]));
        s.bits(s.less(s.square([way(0), way(1), way(2)]), s.splat(limit)))
    }

    /// Lanes inside the closed box `min..=max`.
    #[inline(always)]
    fn inside(self, c: [&Eight; 3], min: [f32; 3], max: [f32; 3]) -> u32 {
        let s = self.single();
        let inside = |k: usize| {
            let at = s.load(c[k]);
            s.both(s.at_most(s.splat(min[k]), at), s.at_most(at, s.splat(max[k])))
        };
        s.bits(s.both(s.both(inside(0), inside(1)), inside(2)))
    }

    /// [`closer`](Self::closer) for each of eight points: bit `8 i + j` is about point `i` and lane `j`.
    #[inline(always)]
    fn all_closer(self, c: [&Eight; 3], points: &[Eight; 3], limit: f32) -> u64 {
        let s = self.single();
        let c = [s.load(c[0]), s.load(c[1]), s.load(c[2])];
        let limit = s.splat(limit);
        let mut masks = [s.less(limit, limit); 8];
        for (i, mask) in masks.iter_mut().enumerate() {
            let way = |k: usize| s.sub(c[k], s.splat(points[k][i]));
            *mask = s.less(s.square([way(0), way(1), way(2)]), limit);
        }
        self.rows(masks)
    }

    /// Lanes (boxes) whose squared distance from each of eight boxes `min..=max` is at most `limit`: bit `8 i + j` is
    /// about box `i` and lane `j`.
    #[inline(always)]
    fn boxes_within(
        self,
        lower: [&Eight; 3],
        upper: [&Eight; 3],
        min: &[Eight; 3],
        max: &[Eight; 3],
        limit: f32,
    ) -> u64 {
        let s = self.single();
        let lower = [s.load(lower[0]), s.load(lower[1]), s.load(lower[2])];
        let upper = [s.load(upper[0]), s.load(upper[1]), s.load(upper[2])];
        let (limit, zero) = (s.splat(limit), s.splat(0.0));
        let mut masks = [s.less(limit, limit); 8];
        for (i, mask) in masks.iter_mut().enumerate() {
            let gap = |k: usize| {
                let above = s.sub(lower[k], s.splat(max[k][i]));
                let below = s.sub(s.splat(min[k][i]), upper[k]);
                s.max(s.max(above, below), zero)
            };
            *mask = s.at_most(s.square([gap(0), gap(1), gap(2)]), limit);
        }
        self.rows(masks)
    }

    /// The minimum and the maximum of each of twelve columns, and whether all numbers are finite.
    #[inline(always)]
    fn extremes(self, rows: &[[f64; 12]]) -> ([[f64; 12]; 2], bool) {
        let d = self.double();
        let nothing = d.splat(0.0);
        let mut min = [d.splat(f64::INFINITY); 3];
        let mut max = [d.splat(f64::NEG_INFINITY); 3];
        // NaN from the first number that is not finite
        let mut zero = [nothing; 3];
        for row in rows {
            let (fours, _) = row.as_chunks::<4>();
            for k in 0..3 {
                let x = d.load(&fours[k]);
                min[k] = d.min(x, min[k]);
                max[k] = d.max(x, max[k]);
                zero[k] = d.mul_add(x, nothing, zero[k]);
            }
        }
        let zero = d.add(d.add(zero[0], zero[1]), zero[2]);
        let all_finite = d.bits(d.at_most(zero, nothing)) == 0xf;
        let twelve = |x: [DoubleNumber<Self>; 3]| {
            let (p, q, r) = (d.store(x[0]), d.store(x[1]), d.store(x[2]));
            [
                p[0], p[1], p[2], p[3], q[0], q[1], q[2], q[3], r[0], r[1], r[2], r[3],
            ]
        };
        ([twelve(min), twelve(max)], all_finite)
    }

    /// Whether each of the first three components lies between the bounds, which are included.
    #[inline(always)]
    fn is_inside(self, point: &[f64; 4], min: &[f64; 4], max: &[f64; 4]) -> bool {
        let d = self.double();
        let point = d.load(point);
        let above = d.at_most(d.load(min), point);
        let below = d.at_most(point, d.load(max));
        d.bits(d.both(above, below)) & 7 == 7
    }
}

/// A comparison of eight `f32`.
pub(crate) type Mask<L> = <<L as Lanes>::Single as Floats>::Mask;
/// Four `f64` in registers.
pub(crate) type DoubleNumber<L> = <<L as Lanes>::Double as Floats>::Number;

/// A piece of work that runs inside a function compiled for the vector unit found.
pub(crate) trait Work {
    /// The result.
    type Output;
    /// Runs the work. Implementations are `#[inline(always)]`, or they are not compiled for the unit.
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// Runs `work` on the best unit of this machine.
#[inline(always)]
pub(crate) fn dispatch<W: Work>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(unit) = pulp::x86::V3::try_new() {
        return unit.vectorize(avx2::OnAvx2(unit, work));
    }
    work.run(Portable)
}

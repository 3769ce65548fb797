//! Arithmetic on `[f64; 3]`, in the plain order the error bounds of `frame` assume (no fused operations).

use super::Point;

#[inline(always)]
pub(crate) fn sub(p: Point, q: Point) -> Point {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

#[inline(always)]
pub(super) fn add(p: Point, q: Point) -> Point {
    [p[0] + q[0], p[1] + q[1], p[2] + q[2]]
}

#[inline(always)]
pub(super) fn scale(p: Point, s: f64) -> Point {
    [p[0] * s, p[1] * s, p[2] * s]
}

#[inline(always)]
pub(crate) fn dot(p: Point, q: Point) -> f64 {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

#[inline(always)]
pub(crate) fn cross(p: Point, q: Point) -> Point {
    [
        p[1] * q[2] - p[2] * q[1],
        p[2] * q[0] - p[0] * q[2],
        p[0] * q[1] - p[1] * q[0],
    ]
}

/// The convex combination of `points` with `weights`.
#[inline(always)]
pub(super) fn combine<const N: usize>(points: &[Point; N], weights: &[f64; N]) -> Point {
    let mut sum = scale(points[0], weights[0]);
    for k in 1..N {
        sum = add(sum, scale(points[k], weights[k]));
    }
    sum
}

/// `x * 2^exponent`; exact unless the result leaves the normal range.
pub(super) fn ldexp(x: f64, exponent: i32) -> f64 {
    // Three factors reach from the least denormal to the largest number; each is a power of two in the normal range.
    let first = exponent.clamp(-1000, 1000);
    let second = (exponent - first).clamp(-1000, 1000);
    let third = (exponent - first - second).clamp(-1000, 1000);
    x * power_of_two(first) * power_of_two(second) * power_of_two(third)
}

/// `2^exponent` for an exponent of the normal range, -1022 to 1023.
pub(super) const fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// The exponent `e` with `2^e <= |x| < 2^(e+1)`, for finite `x` other than 0.
pub(super) fn exponent(x: f64) -> i32 {
    let field = (x.to_bits() >> 52 & 0x7ff) as i32;
    if field == 0 {
        -1011 - x.abs().to_bits().leading_zeros() as i32
    } else {
        field - 1023
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_and_scaling_at_the_ends_of_the_range() {
        assert_eq!(exponent(1.0), 0);
        assert_eq!(exponent(-1.999), 0);
        assert_eq!(exponent(f64::MAX), 1023);
        assert_eq!(exponent(f64::MIN_POSITIVE), -1022);
        assert_eq!(exponent(f64::from_bits(1)), -1074);
        assert_eq!(ldexp(f64::from_bits(1), 2097), 2f64.powi(1023));
        assert_eq!(ldexp(2f64.powi(1023), -2097), f64::from_bits(1));
        assert_eq!(ldexp(3.0, -1), 1.5);
    }
}

//! The error bounds of the vectorised filter in single and in double precision.

use super::frame::{ABOVE_ONE, GAP_ERROR, GREATEST_RHO, LEAST_GAP, LEAST_RHO, SPAN_ERROR};

/// The constants of the certificates in one precision with unit roundoff u.
pub(super) struct ErrorBounds {
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

/// A precision with proved bounds.
pub(super) trait Precision: Copy {
    const BOUNDS: ErrorBounds;
    /// `x`, rounded where this precision does not hold it, for example 1/3.
    fn round(x: f64) -> Self;
}

/// The bounds of `frame`.
impl Precision for f64 {
    const BOUNDS: ErrorBounds = ErrorBounds {
        above_one: ABOVE_ONE,
        gap_error: GAP_ERROR,
        span_error: SPAN_ERROR,
        least_gap: LEAST_GAP,
        least_rho: LEAST_RHO,
        greatest_rho: GREATEST_RHO,
    };
    #[inline(always)]
    fn round(x: f64) -> Self {
        x
    }
}

const U_SINGLE: f64 = 1.0 / (1_u64 << 24) as f64;

/// Of single precision, u = 2^-24. The proofs in `frame` hold word for word, but for these ranges of what vanishes and
/// overflows: a coordinate, a difference in double precision times a power of two, rounded, is wrong by less than
/// `(1 + 2^-28) u rho + 2^-150`, and `u rho >= 2^-44`. A gap of at least 2^-40 gives `|v|_1 >= 2^-54`, hence `v.v >= 2^-110` is
/// normal, and the slack `3.9 u rho |v|_1 >= 2^-97` dwarfs every 2^-149. With `rho <= 2^12` a normal is below 2^28 and a gap
/// along it below 2^43, so that no square overflows. Underflow in `v^.v^` moves `|v^|` by less than 2^-73; the slack, `13 u rho`
/// where `kernel` has used up 51 of 64, is at least 2^-41. Delta is between 1 and 2.
impl Precision for f32 {
    const BOUNDS: ErrorBounds = ErrorBounds {
        above_one: 1.0 + 8.0 * U_SINGLE,
        gap_error: 16.0 * U_SINGLE,
        span_error: 64.0 * U_SINGLE,
        least_gap: 1.0 / (1_u64 << 40) as f64,
        least_rho: 1.0 / (1_u64 << 20) as f64,
        greatest_rho: (1_u64 << 12) as f64,
    };
    #[inline(always)]
    fn round(x: f64) -> Self {
        x as Self
    }
}

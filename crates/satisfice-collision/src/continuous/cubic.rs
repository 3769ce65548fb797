//! The volume of a moving tetrahedron as a cubic of the time, in floating point: its sign, and where it changes.

/// Coefficients in Bernstein's form over a part of the step, each wrong by at most `error`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Volumes {
    pub(super) coefficients: [f64; 4],
    pub(super) error: f64,
}

impl Volumes {
    /// Whether the volume provably is above 0, or below 0, all the time.
    #[inline(always)]
    pub(super) fn have_one_sign(&self) -> bool {
        self.coefficients.iter().all(|&c| c > self.error)
            || self.coefficients.iter().all(|&c| c < -self.error)
    }

    /// The parts between 0, the extrema and 1 in which the computed cubic changes its sign, in ascending order.
    pub(super) fn sign_changes(&self) -> [Option<[f64; 2]>; 3] {
        let [b0, b1, b2, b3] = self.coefficients;
        // The derivative, a t^2 + 2 h t + c, up to the factor 3.
        let (a, h, c) = (b3 - 3.0 * b2 + 3.0 * b1 - b0, b2 - 2.0 * b1 + b0, b1 - b0);
        let discriminant = h * h - a * c;
        let mut times = [0.0, 1.0, 1.0, 1.0];
        if discriminant > 0.0 {
            let q = -(h + discriminant.sqrt().copysign(h));
            let (r, s) = (inside(q / a), inside(c / q));
            times = [0.0, r.min(s), r.max(s), 1.0];
        }
        std::array::from_fn(|k| {
            let [from, to] = [times[k], times[k + 1]];
            (from < to && (self.at(from) > 0.0) != (self.at(to) > 0.0)).then_some([from, to])
        })
    }

    /// The root between two times with different signs, as near as it is computed.
    pub(super) fn root(&self, [mut low, mut high]: [f64; 2]) -> f64 {
        let rises = self.at(high) > 0.0;
        // Bisection until the digits are used up.
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if (self.at(middle) > 0.0) == rises {
                high = middle;
            } else {
                low = middle;
            }
        }
        0.5 * (low + high)
    }

    fn at(&self, t: f64) -> f64 {
        let s = 1.0 - t;
        let [b0, b1, b2, b3] = self.coefficients;
        s * s * (s * b0 + 3.0 * t * b1) + t * t * (3.0 * s * b2 + t * b3)
    }
}

/// A time, or 1 if it is none inside the part.
fn inside(t: f64) -> f64 {
    if t > 0.0 && t < 1.0 { t } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_roots_are_found_in_order() {
        // (t - 1/8) (t - 1/2) (t - 3/4) in Bernstein's form.
        let power = [-0.046_875, 0.531_25, -1.375, 1.0];
        let [p0, p1, p2, p3] = power;
        let volumes = Volumes {
            coefficients: [
                p0,
                p0 + p1 / 3.0,
                p0 + 2.0 * p1 / 3.0 + p2 / 3.0,
                p0 + p1 + p2 + p3,
            ],
            error: 0.0,
        };
        let roots: Vec<f64> = volumes
            .sign_changes()
            .into_iter()
            .flatten()
            .map(|part| volumes.root(part))
            .collect();
        assert_eq!(roots.len(), 3);
        for (found, expected) in roots.iter().zip([0.125, 0.5, 0.75]) {
            assert!((found - expected).abs() < 1e-14, "{roots:?}");
        }
        assert!(!volumes.have_one_sign());
    }
}

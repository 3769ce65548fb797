//! The referee: squared distances of convex hulls as exact fractions, by a method and a library that the judged code
//! does not use.
//!
//! The judged code enumerates pairs of parts (vertex, edge, face) of the two features. Here the problem is the point
//! of least norm of the hull of all differences `w = a_i - b_j`: for every affinely independent subset of at most four of them
//! (Caratheodory) the normal equations are solved by Cramer's rule, and the solution is taken only if it satisfies the
//! conditions of Kuhn and Tucker over *all* differences, `v.w >= v.v`, which prove it optimal.

use num_bigint::{BigInt, BigUint, Sign};

use super::Point;

type Vector = [BigInt; 3];

/// A squared distance `numerator / denominator * 4^unit`.
#[derive(Debug, Clone)]
pub struct Squared {
    numerator: BigInt,
    denominator: BigInt,
    unit: i32,
}

/// The squared distance of two hulls.
pub fn squared_distance(a: &[Point], b: &[Point]) -> Squared {
    let unit = a.iter().chain(b).flatten().map(|&x| decode(x).1).min().unwrap();
    let differences: Vec<Vector> = a
        .iter()
        .flat_map(|p| {
            b.iter()
                .map(move |q| [0, 1, 2].map(|k| integer(p[k], unit) - integer(q[k], unit)))
        })
        .collect();
    for size in 1..=4 {
        if let Some((numerator, denominator)) = search(&differences, size, 0, &mut Vec::new()) {
            return Squared {
                numerator,
                denominator,
                unit,
            };
        }
    }
    unreachable!("some subset of at most four differences is optimal");
}

impl Squared {
    pub fn is_zero(&self) -> bool {
        self.numerator.sign() == Sign::NoSign
    }

    /// Whether the distance is strictly below `delta`.
    pub fn is_below(&self, delta: f64) -> bool {
        let (mantissa, exponent) = decode(delta);
        let mut left = self.numerator.clone();
        let mut right = &mantissa * &mantissa * &self.denominator;
        let shift = 2 * (exponent - self.unit);
        if shift >= 0 {
            right <<= shift as usize;
        } else {
            left <<= (-shift) as usize;
        }
        left < right
    }

    /// The distance rounded down to double precision (possibly by more than one step among denormals).
    pub fn approximate(&self) -> f64 {
        let (root, exponent) = self.root();
        let excess = (root.bits() as i32 - 53).max(0);
        let top: u64 = (&root >> excess as usize).try_into().unwrap();
        times_power_of_two(top as f64, exponent + excess)
    }

    /// How far `computed` is from the distance, in units in the last place of `computed`.
    pub fn error_in_ulp(&self, computed: f64) -> f64 {
        assert!(computed >= 0.0, "{computed}");
        if computed == f64::INFINITY {
            // Right if the distance exceeds all finite numbers.
            return if self.is_below(f64::MAX) {
                f64::INFINITY
            } else {
                0.0
            };
        }
        if self.is_zero() || computed == 0.0 {
            return if self.is_zero() && computed == 0.0 {
                0.0
            } else if !self.is_zero() && self.is_below(f64::from_bits(1)) {
                0.5
            } else {
                f64::INFINITY
            };
        }
        let (root, exponent) = self.root();
        let (mantissa, unit) = decode(computed);
        let ulp = ((computed.to_bits() >> 52) as i32).max(1) - 1075;
        // Everything in units of 2^low; the root is wrong by less than 2^-64 of itself.
        let low = exponent.min(unit).min(ulp - 20);
        let true_value = BigInt::from(root) << (exponent - low) as usize;
        let given = mantissa << (unit - low) as usize;
        let error = (true_value - given).magnitude().clone();
        let scaled: BigUint = (error << 20usize) >> (ulp - low) as usize;
        let steps: u64 = scaled.try_into().unwrap_or(u64::MAX);
        steps as f64 / f64::from(1 << 20)
    }

    /// The distance as `root * 2^exponent`, rounded down to 64 bits or more.
    fn root(&self) -> (BigUint, i32) {
        let (numerator, denominator) = (self.numerator.magnitude(), self.denominator.magnitude());
        let mut shift = 140 + denominator.bits() as i32 - numerator.bits() as i32;
        shift += shift.rem_euclid(2);
        let quotient = if shift >= 0 {
            (numerator << shift as usize) / denominator
        } else {
            numerator / (denominator << (-shift) as usize)
        };
        (quotient.sqrt(), self.unit - shift / 2)
    }
}

/// Tries every subset of `size` differences that extends `chosen`.
fn search(w: &[Vector], size: usize, from: usize, chosen: &mut Vec<usize>) -> Option<(BigInt, BigInt)> {
    if chosen.len() == size {
        return optimum(w, chosen);
    }
    (from..w.len()).find_map(|k| {
        chosen.push(k);
        let found = search(w, size, k + 1, chosen);
        chosen.pop();
        found
    })
}

/// The squared norm of the least point of the affine hull of the subset, if it is optimal for the whole hull.
fn optimum(w: &[Vector], subset: &[usize]) -> Option<(BigInt, BigInt)> {
    let base = &w[subset[0]];
    let directions: Vec<Vector> = subset[1..]
        .iter()
        .map(|&k| [0, 1, 2].map(|c| &w[k][c] - &base[c]))
        .collect();
    let gram: Vec<Vec<BigInt>> = directions
        .iter()
        .map(|d| directions.iter().map(|e| dot(d, e)).collect())
        .collect();
    let right: Vec<BigInt> = directions.iter().map(|d| -dot(d, base)).collect();
    let det = determinant(&gram);
    if det.sign() == Sign::NoSign {
        return None;
    }
    let mut rest = det.clone();
    let mut v = [0, 1, 2].map(|c| &base[c] * &det);
    for (k, direction) in directions.iter().enumerate() {
        let mut replaced = gram.clone();
        for (row, value) in replaced.iter_mut().zip(&right) {
            row[k] = value.clone();
        }
        let weight = determinant(&replaced);
        if weight.sign() == Sign::Minus {
            return None;
        }
        rest -= &weight;
        for c in 0..3 {
            v[c] += &weight * &direction[c];
        }
    }
    if rest.sign() == Sign::Minus {
        return None;
    }
    // v is det times the least point; it is optimal if every difference lies beyond it.
    let squared = dot(&v, &v);
    w.iter()
        .all(|w| &det * dot(&v, w) >= squared)
        .then(|| (squared, &det * &det))
}

fn determinant(m: &[Vec<BigInt>]) -> BigInt {
    let minor = |r: usize, s: usize, k: usize, l: usize| &m[r][k] * &m[s][l] - &m[r][l] * &m[s][k];
    match m.len() {
        0 => BigInt::from(1),
        1 => m[0][0].clone(),
        2 => minor(0, 1, 0, 1),
        _ => &m[0][0] * minor(1, 2, 1, 2) - &m[0][1] * minor(1, 2, 0, 2) + &m[0][2] * minor(1, 2, 0, 1),
    }
}

fn dot(p: &Vector, q: &Vector) -> BigInt {
    &p[0] * &q[0] + &p[1] * &q[1] + &p[2] * &q[2]
}

/// `x = mantissa * 2^exponent`, by the layout of IEEE 754. Trailing zeros are dropped; 0 has exponent 0.
fn decode(x: f64) -> (BigInt, i32) {
    let bits = x.to_bits();
    let field = (bits >> 52 & 0x7ff) as i32;
    assert_ne!(field, 0x7ff, "not finite");
    let fraction = bits & 0xf_ffff_ffff_ffff;
    let (mut mantissa, mut exponent) = if field == 0 {
        (fraction, -1074)
    } else {
        (fraction | 1 << 52, field - 1075)
    };
    if mantissa == 0 {
        return (BigInt::from(0), 0);
    }
    exponent += mantissa.trailing_zeros() as i32;
    mantissa >>= mantissa.trailing_zeros();
    let signed = BigInt::from(mantissa);
    (if x < 0.0 { -signed } else { signed }, exponent)
}

fn integer(x: f64, unit: i32) -> BigInt {
    let (mantissa, exponent) = decode(x);
    if mantissa.sign() == Sign::NoSign {
        mantissa
    } else {
        mantissa << (exponent - unit) as usize
    }
}

fn times_power_of_two(mut x: f64, mut exponent: i32) -> f64 {
    while exponent != 0 {
        let step = exponent.clamp(-1000, 1000);
        x *= 2f64.powi(step);
        exponent -= step;
    }
    x
}

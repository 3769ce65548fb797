//! The number of roots, proved: interval branch and bound with Krawczyk's operator.

use satisfice::interval::{Interval, IntervalOps};

use super::equations::{Equations, UNKNOWNS};
use crate::number::Dual;

type Box<const N: usize = UNKNOWNS> = [Interval; N];

/// Boxes are inflated a little before a test, so that a root on a face is inside one of them.
const INFLATION: f64 = 0.05;
/// The whole space is searched with this margin, relative to its widths, because roots may lie on its border.
const MARGIN: f64 = 1e-3;
/// Roots this far outside, relative to the widths, count as on the border: bounds such as 2 pi are rounded.
const BORDER: f64 = 1e-9;

fn interval(lower: f64, upper: f64) -> Interval {
    <Interval as IntervalOps>::new(lower, upper)
}
fn middle(x: Interval) -> f64 {
    0.5 * x.inf() + 0.5 * x.sup()
}
fn width(x: Interval) -> f64 {
    x.sup() - x.inf()
}
fn contains_zero(x: Interval) -> bool {
    x.inf() <= 0.0 && 0.0 <= x.sup()
}
/// `None` if they have no point in common.
fn common(a: Interval, b: Interval) -> Option<Interval> {
    let (lower, upper) = (a.inf().max(b.inf()), a.sup().min(b.sup()));
    (lower <= upper).then(|| interval(lower, upper))
}

/// Enclosures of all roots in the space, each of exactly one root, or `None` after `limit` boxes.
///
/// Every box is discarded with a proof: an equation has no zero in it, or Krawczyk's operator K(X) does not meet it, or K maps
/// its inflation into itself, which proves one root there and no other (Krawczyk 1969, doi 10.1007/BF02234767).
pub(super) fn certify(equations: &Equations, limit: usize) -> Option<Vec<Vec<f64>>> {
    let n = equations.space.dimension();
    let mut start = [interval(0.0, 0.0); UNKNOWNS];
    for (x, axis) in start.iter_mut().zip(equations.space.axes()) {
        let margin = MARGIN * axis.width();
        *x = interval(axis.lower() - margin, axis.upper() + margin);
    }
    let mut stack = vec![start];
    // Each with the inflated box in which it is the only one.
    let mut roots: Vec<(Box, Box)> = Vec::new();
    let mut seen = 0;
    while let Some(mut x) = stack.pop() {
        seen += 1;
        if seen > limit {
            return None;
        }
        // Enclosures proved so far.
        let inside_known = |(_, only): &(Box, Box)| {
            x[..n]
                .iter()
                .zip(only)
                .all(|(x, only)| only.inf() <= x.inf() && x.sup() <= only.sup())
        };
        if roots.iter().any(inside_known) {
            continue;
        }
        let mut residuals = x;
        (equations.functions.interval)(&x[..n], &mut residuals[..n]);
        if !residuals[..n].iter().all(|e| contains_zero(*e)) {
            continue;
        }
        let mut larger = x;
        for x in &mut larger[..n] {
            let margin = INFLATION * width(*x) + f64::MIN_POSITIVE;
            *x = interval(x.inf() - margin, x.sup() + margin);
        }
        if let Some(mut image) = krawczyk(equations, &larger) {
            let pairs = || image[..n].iter().zip(&larger);
            if pairs().all(|(image, x)| x.inf() < image.inf() && image.sup() < x.sup()) {
                let same = |(root, only): &(Box, Box)| {
                    let meets =
                        |a: &Box, b: &Box| a[..n].iter().zip(b).all(|(a, b)| common(*a, *b).is_some());
                    let inside = |a: &Box, b: &Box| {
                        a[..n]
                            .iter()
                            .zip(b)
                            .all(|(a, b)| b.inf() <= a.inf() && a.sup() <= b.sup())
                    };
                    meets(root, &image) && (inside(&image, only) || inside(root, &larger))
                };
                if !roots.iter().any(same) {
                    sharpen(equations, &mut image);
                    roots.push((image, larger));
                }
                continue;
            }
            // Every root in the box is in the image, too.
            let mut emptied = false;
            for (x, image) in x[..n].iter_mut().zip(&image) {
                match common(*x, *image) {
                    Some(less) => *x = less,
                    None => emptied = true,
                }
            }
            if emptied {
                continue;
            }
        }
        let widest = (0..n).max_by(|&a, &b| width(x[a]).total_cmp(&width(x[b])))?;
        let at = middle(x[widest]);
        let (mut left, mut right) = (x, x);
        left[widest] = interval(x[widest].inf(), at);
        right[widest] = interval(at, x[widest].sup());
        stack.extend([right, left]);
    }
    let inside = |(root, _): &(Box, Box)| {
        root.iter().zip(equations.space.axes()).all(|(x, axis)| {
            let border = BORDER * axis.width();
            axis.lower() - border <= middle(*x) && middle(*x) <= axis.upper() + border
        })
    };
    let middles = |(root, _): &(Box, Box)| root[..n].iter().map(|x| middle(*x)).collect();
    Some(roots.iter().filter(|root| inside(root)).map(middles).collect())
}

/// Makes the enclosure of a root as narrow as rounding allows.
fn sharpen(equations: &Equations, x: &mut Box) {
    for _ in 0..100 {
        let Some(image) = krawczyk(equations, x) else {
            return;
        };
        let mut narrower = false;
        for (x, image) in x.iter_mut().zip(image).take(equations.space.dimension()) {
            if let Some(less) = common(*x, image) {
                narrower |= width(less) < 0.99 * width(*x);
                *x = less;
            }
        }
        if !narrower {
            return;
        }
    }
}

/// K(X) = m - C f(m) + (1 - C J(X)) (X - m), with C near J(m)^-1; `None` if J(m) is singular.
#[expect(clippy::needless_range_loop, reason = "matrix indices as in the formula")]
fn krawczyk(equations: &Equations, x: &Box) -> Option<Box> {
    let n = equations.space.dimension();
    let zero = interval(0.0, 0.0);
    let mut jacobian = [[zero; UNKNOWNS]; UNKNOWNS];
    let mut input = x.map(|value| Dual { value, slope: zero });
    let mut output = input;
    for column in 0..n {
        input[column].slope = interval(1.0, 1.0);
        (equations.functions.dual_interval)(&input[..n], &mut output[..n]);
        input[column].slope = zero;
        for (row, output) in jacobian.iter_mut().zip(&output[..n]) {
            row[column] = output.slope;
        }
    }
    let mut centre = [[0.0; UNKNOWNS]; UNKNOWNS];
    for (centre, row) in centre.iter_mut().zip(&jacobian[..n]) {
        for (centre, entry) in centre.iter_mut().zip(&row[..n]) {
            *centre = middle(*entry);
        }
    }
    let inverse = inverse(centre, n)?;
    let point = x.map(|x| interval(middle(x), middle(x)));
    let mut residuals = point;
    (equations.functions.interval)(&point[..n], &mut residuals[..n]);
    let mut image = point;
    for row in 0..n {
        let factor = |k: usize| interval(inverse[row][k], inverse[row][k]);
        for k in 0..n {
            image[row] -= factor(k) * residuals[k];
        }
        for column in 0..n {
            let mut entry = interval(
                f64::from(u8::from(row == column)),
                f64::from(u8::from(row == column)),
            );
            for k in 0..n {
                entry -= factor(k) * jacobian[k][column];
            }
            image[row] += entry * (x[column] - point[column]);
        }
    }
    Some(image)
}

/// By Gauss-Jordan elimination with partial pivoting.
fn inverse(mut a: [[f64; UNKNOWNS]; UNKNOWNS], n: usize) -> Option<[[f64; UNKNOWNS]; UNKNOWNS]> {
    let mut inverse = [[0.0; UNKNOWNS]; UNKNOWNS];
    for (k, row) in inverse.iter_mut().enumerate() {
        row[k] = 1.0;
    }
    for column in 0..n {
        let pivot = (column..n).max_by(|&i, &j| a[i][column].abs().total_cmp(&a[j][column].abs()))?;
        a.swap(column, pivot);
        inverse.swap(column, pivot);
        let divisor = a[column][column];
        if divisor == 0.0 || !divisor.is_finite() {
            return None;
        }
        for k in 0..n {
            a[column][k] /= divisor;
            inverse[column][k] /= divisor;
        }
        for row in (0..n).filter(|row| *row != column) {
            let factor = a[row][column];
            for k in 0..n {
                a[row][k] -= factor * a[column][k];
                inverse[row][k] -= factor * inverse[column][k];
            }
        }
    }
    Some(inverse)
}

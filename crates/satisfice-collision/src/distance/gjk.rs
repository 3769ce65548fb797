//! The fast filter of hulls with up to nine differences: GJK (Gilbert, Johnson, Keerthi 1988, doi:10.1109/56.2083), which
//! stops as soon as a certificate of `frame` holds, usually long before it converges.
//!
//! It searches the hull of all differences `a_i - b_j` for the point closest to 0. Rounding or degenerate input may mislead a
//! step: then no certificate holds, and the slower stages decide.

use super::candidates::Guess;
use super::frame::{self, Limits, PairFrame, Verdict};
use super::vector::{add, cross, dot, scale, sub};
use super::{Point, closest};

/// The most steps. Most pairs need about two; those in the band around delta never end.
const STEPS: usize = 12;

#[inline(always)]
pub(super) fn filter<const M: usize, const N: usize>(frame: &PairFrame<M, N>, limits: &Limits) -> Verdict {
    // Start: the difference of the centroids.
    let mut v = frame.difference(&[1.0 / M as f64; M], &[1.0 / N as f64; N]);
    let mut squared = dot(v, v);
    if limits.is_within(squared) {
        return Verdict::Within;
    }
    let mut simplex = Simplex { w: [v; 4], len: 1 };
    for _ in 0..STEPS {
        let (gap, w) = support(frame, v);
        if frame.is_apart(gap, v, squared, limits) {
            return Verdict::Apart;
        }
        if simplex.w[..simplex.len].contains(&w) {
            return Verdict::Unknown;
        }
        simplex.w[simplex.len] = w;
        simplex.len += 1;
        v = simplex.reduce();
        squared = dot(v, v);
        if limits.is_within(squared) {
            return Verdict::Within;
        }
        if simplex.len == 4 {
            return Verdict::Unknown;
        }
    }
    Verdict::Unknown
}

/// The distance in the frame's unit, wrong by at most `accuracy` of itself: the upper bound `|v| + E` and the lower bound
/// `gap / |v|` agree that far. `None` if they never do.
pub(super) fn distance<const M: usize, const N: usize>(
    frame: &PairFrame<M, N>,
    accuracy: f64,
) -> Option<f64> {
    let (squared, _) = converge(frame, accuracy)?;
    let distance = squared.sqrt();
    (frame::SPAN_ERROR * frame.rho <= accuracy * distance).then_some(distance)
}

/// The vertices whose hulls contain the closest points of two disjoint features, each with an arbitrary positive weight.
/// `None` if the iteration does not find them.
pub(super) fn parts<const M: usize, const N: usize>(frame: &PairFrame<M, N>) -> Option<Guess> {
    // So close that further steps would rarely change the parts; `extended` proves whether they are right.
    const NEAR: f64 = 1e-12;
    let (_, simplex) = converge(frame, NEAR)?;
    let (mut a, mut b) = ([0.0; 3], [0.0; 3]);
    for w in &simplex.w[..simplex.len] {
        let mut all = (0..M).flat_map(|i| (0..N).map(move |j| (i, j)));
        let (i, j) = all.find(|&(i, j)| sub(frame.a[i], frame.b[j]) == *w)?;
        (a[i], b[j]) = (1.0, 1.0);
    }
    Some(Guess::of_parts(a, b))
}

/// The difference nearest to 0, squared, and the differences whose hull it lies in.
#[inline(always)]
fn converge<const M: usize, const N: usize>(
    frame: &PairFrame<M, N>,
    accuracy: f64,
) -> Option<(f64, Simplex)> {
    let mut v = frame.difference(&[1.0 / M as f64; M], &[1.0 / N as f64; N]);
    let mut squared = dot(v, v);
    let mut simplex = Simplex { w: [v; 4], len: 1 };
    for _ in 0..2 * STEPS {
        let (gap, w) = support(frame, v);
        let safe = gap - frame::GAP_ERROR * frame.rho * (v[0].abs() + v[1].abs() + v[2].abs());
        // (gap / |v|)^2 >= |v|^2 (1 - accuracy)^2, roundings being far below any accuracy asked for
        if safe > frame::LEAST_GAP && safe >= squared * (1.0 - accuracy) {
            return Some((squared, simplex));
        }
        if simplex.w[..simplex.len].contains(&w) {
            return None;
        }
        simplex.w[simplex.len] = w;
        simplex.len += 1;
        v = simplex.reduce();
        squared = dot(v, v);
        if simplex.len == 4 {
            return None;
        }
    }
    None
}

/// The gap in direction `v` and the difference `a_i - b_j` that is lowest in it.
#[inline(always)]
fn support<const M: usize, const N: usize>(frame: &PairFrame<M, N>, v: Point) -> (f64, Point) {
    let (mut a, mut height_a) = (frame.a[0], dot(v, frame.a[0]));
    for &p in &frame.a[1..] {
        let height = dot(v, p);
        if height < height_a {
            (a, height_a) = (p, height);
        }
    }
    let (mut b, mut height_b) = (frame.b[0], dot(v, frame.b[0]));
    for &q in &frame.b[1..] {
        let height = dot(v, q);
        if height > height_b {
            (b, height_b) = (q, height);
        }
    }
    (height_a - height_b, sub(a, b))
}

/// Up to four differences.
struct Simplex {
    w: [Point; 4],
    len: usize,
}

impl Simplex {
    /// Keeps the vertices whose hull holds the point nearest to 0 and returns that point, approximately.
    #[inline(always)]
    fn reduce(&mut self) -> Point {
        match self.len {
            1 => self.w[0],
            2 => self.segment(),
            3 => {
                let (v, kept, len) = triangle(self.w[0], self.w[1], self.w[2]);
                self.w[..3].copy_from_slice(&kept);
                self.len = len;
                v
            }
            _ => self.tetrahedron(),
        }
    }

    #[inline(always)]
    fn segment(&mut self) -> Point {
        let [p, q, ..] = self.w;
        let e = sub(q, p);
        let t = -dot(p, e) / dot(e, e);
        if t < 1.0 && t > 0.0 {
            add(scale(p, 1.0 - t), scale(q, t))
        } else {
            self.w[0] = if t >= 1.0 { q } else { p };
            self.len = 1;
            self.w[0]
        }
    }

    #[inline(never)]
    fn tetrahedron(&mut self) -> Point {
        let w = self.w;
        let mut best: Option<(f64, Point, [Point; 3], usize)> = None;
        let mut inside = [0.0; 4];
        for skipped in 0..4 {
            let [p, q, r] = [1, 2, 3].map(|k| w[(skipped + k) % 4]);
            let n = cross(sub(q, p), sub(r, p));
            let (apex, origin) = (dot(n, sub(w[skipped], p)), -dot(n, p));
            inside[skipped] = origin / apex;
            // Is 0 on the other side of this face than the fourth vertex? A flat tetrahedron (infinite or NaN) mostly says yes.
            let encloses = inside[skipped] > 0.0;
            if !encloses {
                let (v, kept, len) = triangle(p, q, r);
                let squared = dot(v, v);
                if best.is_none_or(|(least, ..)| squared < least) {
                    best = Some((squared, v, kept, len));
                }
            }
        }
        if let Some((_, v, kept, len)) = best {
            self.w[..3].copy_from_slice(&kept);
            self.len = len;
            v
        } else {
            // The hulls meet: the weights of 0 itself, made to sum to 1.
            let sum = inside[0] + inside[1] + inside[2] + inside[3];
            let mut v = scale(w[0], inside[0] / sum);
            for k in 1..4 {
                v = add(v, scale(w[k], inside[k] / sum));
            }
            v
        }
    }
}

/// The point of triangle `p q r` nearest to 0 and the vertices it needs.
#[inline(always)]
fn triangle(p: Point, q: Point, r: Point) -> (Point, [Point; 3], usize) {
    let weights = closest::on_triangle([0.0; 3], &[p, q, r]);
    let mut kept = [[0.0; 3]; 3];
    let mut len = 0;
    let mut v = [0.0; 3];
    for (vertex, weight) in [p, q, r].into_iter().zip(weights) {
        if weight > 0.0 {
            v = add(v, scale(vertex, weight));
            kept[len] = vertex;
            len += 1;
        }
    }
    (v, kept, len)
}

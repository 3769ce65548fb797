//! The stages of a decision (filter, extended precision, integers), and a proximity from what they proved.

use super::candidates::{self, edges};
use super::extended::PointPair;
use super::frame::{self, Limits, NoFrame, PairFrame, Verdict};
use super::vector::{add, ldexp, scale, sub};
use super::{DecidedBy, Decision, Feature, Point, Proximity, Threshold, exact, gjk};

/// A kind of pair as convex hulls of `M` and `N` points, with its own fast filter.
pub(super) trait Hulls<const M: usize, const N: usize> {
    fn filter(frame: &PairFrame<M, N>, limits: &Limits) -> Verdict;
}

#[inline(always)]
pub(super) fn decide<H: Hulls<M, N>, const M: usize, const N: usize>(
    a: &[Point; M],
    b: &[Point; N],
    threshold: Threshold,
) -> Decision {
    let frame = match PairFrame::new(a, b) {
        Ok(frame) => frame,
        Err(NoFrame::Coincident) => {
            return Decision {
                within: true,
                by: DecidedBy::Filter,
            };
        }
        Err(NoFrame::NotFinite) => {
            return Decision {
                within: false,
                by: DecidedBy::NotFinite,
            };
        }
    };
    let limits = frame.limits(threshold);
    match H::filter(&frame, &limits) {
        Verdict::Within => Decision {
            within: true,
            by: DecidedBy::Filter,
        },
        Verdict::Apart => Decision {
            within: false,
            by: DecidedBy::Filter,
        },
        Verdict::Unknown => decide_in_band(a, b, &frame, &limits, threshold),
    }
}

#[cold]
#[inline(never)]
fn decide_in_band<const M: usize, const N: usize>(
    a: &[Point; M],
    b: &[Point; N],
    frame: &PairFrame<M, N>,
    limits: &Limits,
    threshold: Threshold,
) -> Decision {
    if frame.has_nan() {
        return Decision {
            within: false,
            by: DecidedBy::NotFinite,
        };
    }
    if pierced(frame).is_some() {
        return Decision {
            within: true,
            by: DecidedBy::Filter,
        };
    }
    let guess = candidates::nearest(&frame.a, &frame.b);
    let verdict = PointPair::new(a, b, frame, &guess).map_or(Verdict::Unknown, |pair| pair.judge(limits));
    match verdict {
        Verdict::Within => Decision {
            within: true,
            by: DecidedBy::Extended,
        },
        Verdict::Apart => Decision {
            within: false,
            by: DecidedBy::Extended,
        },
        Verdict::Unknown => Decision {
            within: exact::is_within(a, b, threshold.get()),
            by: DecidedBy::Exact,
        },
    }
}

/// The frame of a pair; `None` if all points coincide or one is not finite.
pub(super) fn frame<const M: usize, const N: usize>(
    a: &[Point; M],
    b: &[Point; N],
) -> Option<PairFrame<M, N>> {
    PairFrame::new(a, b).ok()
}

pub(super) fn proximity<const M: usize, const N: usize>(a: &[Point; M], b: &[Point; N]) -> Proximity {
    let frame = match PairFrame::new(a, b) {
        Ok(frame) if frame.has_nan() => Err(NoFrame::NotFinite),
        other => other,
    };
    let frame = match frame {
        Ok(frame) => frame,
        Err(NoFrame::Coincident) => {
            return assemble(a, b, 0.0, [1.0, 0.0, 0.0], [1.0, 0.0, 0.0], DecidedBy::Filter);
        }
        Err(NoFrame::NotFinite) => {
            return assemble(
                a,
                b,
                f64::NAN,
                [1.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                DecidedBy::NotFinite,
            );
        }
    };
    // The cheap guess is right for nearly all disjoint features.
    if let Some(guess) = gjk::parts(&frame)
        && let Some(proximity) = proved(a, b, &frame, &guess)
    {
        return proximity;
    }
    if let Some((weights_a, weights_b)) = pierced(&frame) {
        return assemble(a, b, 0.0, weights_a, weights_b, DecidedBy::Filter);
    }
    let guess = candidates::nearest(&frame.a, &frame.b);
    if let Some(proximity) = proved(a, b, &frame, &guess) {
        return proximity;
    }
    let nearest = exact::nearest(a, b);
    assemble(
        a,
        b,
        nearest.distance,
        nearest.weights_a,
        nearest.weights_b,
        DecidedBy::Exact,
    )
}

/// The proximity of a guess, if it is proved to be the closest pair.
fn proved<const M: usize, const N: usize>(
    a: &[Point; M],
    b: &[Point; N],
    frame: &PairFrame<M, N>,
    guess: &candidates::Guess,
) -> Option<Proximity> {
    let pair = PointPair::new(a, b, frame, guess)?;
    let distance = ldexp(pair.distance()?, frame.exponent);
    let (weights_a, weights_b) = (pair.weights_a, pair.weights_b);
    Some(assemble(
        a,
        b,
        distance,
        weights_a,
        weights_b,
        DecidedBy::Extended,
    ))
}

/// Weights of a common point, if an edge of one provably passes through the face of the other.
fn pierced<const M: usize, const N: usize>(frame: &PairFrame<M, N>) -> Option<([f64; 3], [f64; 3])> {
    if let Ok(face) = <&[Point; 3]>::try_from(&frame.b[..])
        && let Some([i, k]) = frame::piercing(&frame.a, edges(M), face, frame.rho)
    {
        let (t, weights) = frame::crossing(frame.a[i], frame.a[k], face);
        return Some((on_edge(i, k, t), weights));
    }
    if let Ok(face) = <&[Point; 3]>::try_from(&frame.a[..])
        && let Some([j, k]) = frame::piercing(&frame.b, edges(N), face, frame.rho)
    {
        let (t, weights) = frame::crossing(frame.b[j], frame.b[k], face);
        return Some((weights, on_edge(j, k, t)));
    }
    None
}

fn on_edge(from: usize, to: usize, t: f64) -> [f64; 3] {
    let mut weights = [0.0; 3];
    weights[from] = 1.0 - t;
    weights[to] = t;
    weights
}

fn assemble<const M: usize, const N: usize>(
    a: &[Point; M],
    b: &[Point; N],
    distance: f64,
    weights_a: [f64; 3],
    weights_b: [f64; 3],
    by: DecidedBy,
) -> Proximity {
    Proximity {
        distance,
        point_a: point(a, weights_a),
        point_b: point(b, weights_b),
        weights_a,
        weights_b,
        feature_a: feature(weights_a, M),
        feature_b: feature(weights_b, N),
        by,
    }
}

/// The weighted point, computed relative to the vertex with the largest weight, so that a vertex is returned unchanged and an
/// offset costs no precision.
fn point(points: &[Point], weights: [f64; 3]) -> Point {
    let heaviest = (0..points.len()).fold(0, |best, k| if weights[k] > weights[best] { k } else { best });
    let base = points[heaviest];
    let mut sum = [0.0; 3];
    for (k, &p) in points.iter().enumerate() {
        if k != heaviest && weights[k] != 0.0 {
            // Halves keep the difference of two huge coordinates finite.
            sum = add(sum, scale(sub(scale(p, 0.5), scale(base, 0.5)), weights[k]));
        }
    }
    [0, 1, 2].map(|k| base[k] + 2.0 * sum[k])
}

fn feature(weights: [f64; 3], vertices: usize) -> Feature {
    let used = [0, 1, 2].map(|k: usize| k < vertices && weights[k] > 0.0);
    match used {
        [true, true, true] => Feature::Face,
        [true, true, false] => Feature::Edge(0),
        [false, true, true] => Feature::Edge(1),
        [true, false, true] => Feature::Edge(2),
        [false, true, false] => Feature::Vertex(1),
        [false, false, true] => Feature::Vertex(2),
        [_, false, false] => Feature::Vertex(0),
    }
}

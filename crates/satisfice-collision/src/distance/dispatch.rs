//! The distance question for two shapes of any kinds: the one place that maps a pair of kinds to its test.

use super::{
    Decision, EdgeEdge, EdgeTriangle, FeaturePair, Proximity, Threshold, TriangleTriangle, VertexEdge,
    VertexTriangle, VertexVertex,
};
use crate::mesh::Shape;

/// A question that every kind of pair answers.
trait ShapeQuestion {
    type Answer;
    fn ask<P: FeaturePair>(self, a: &P::A, b: &P::B) -> Self::Answer;
}

/// The answer for two shapes, and whether it is about `(b, a)` instead of `(a, b)`.
#[inline(always)]
fn ask<Q: ShapeQuestion>(question: Q, a: &Shape, b: &Shape) -> (Q::Answer, bool) {
    match (a, b) {
        (Shape::Vertex(p), Shape::Vertex(q)) => (question.ask::<VertexVertex>(p, q), false),
        (Shape::Vertex(p), Shape::Edge(e)) => (question.ask::<VertexEdge>(p, e), false),
        (Shape::Edge(e), Shape::Vertex(p)) => (question.ask::<VertexEdge>(p, e), true),
        (Shape::Vertex(p), Shape::Triangle(t)) => (question.ask::<VertexTriangle>(p, t), false),
        (Shape::Triangle(t), Shape::Vertex(p)) => (question.ask::<VertexTriangle>(p, t), true),
        (Shape::Edge(e), Shape::Edge(f)) => (question.ask::<EdgeEdge>(e, f), false),
        (Shape::Edge(e), Shape::Triangle(t)) => (question.ask::<EdgeTriangle>(e, t), false),
        (Shape::Triangle(t), Shape::Edge(e)) => (question.ask::<EdgeTriangle>(e, t), true),
        (Shape::Triangle(t), Shape::Triangle(s)) => (question.ask::<TriangleTriangle>(t, s), false),
    }
}

struct Decide(Threshold);

impl ShapeQuestion for Decide {
    type Answer = Decision;

    #[inline(always)]
    fn ask<P: FeaturePair>(self, a: &P::A, b: &P::B) -> Decision {
        P::decide(a, b, self.0)
    }
}

struct FindProximity;

impl ShapeQuestion for FindProximity {
    type Answer = Proximity;

    #[inline(always)]
    fn ask<P: FeaturePair>(self, a: &P::A, b: &P::B) -> Proximity {
        P::proximity(a, b)
    }
}

struct FindDistance;

impl ShapeQuestion for FindDistance {
    type Answer = f64;

    #[inline(always)]
    fn ask<P: FeaturePair>(self, a: &P::A, b: &P::B) -> f64 {
        P::distance(a, b)
    }
}

struct Measure;

impl ShapeQuestion for Measure {
    type Answer = f64;

    #[inline(always)]
    fn ask<P: FeaturePair>(self, a: &P::A, b: &P::B) -> f64 {
        P::measure(a, b)
    }
}

/// Whether the distance of two features is below delta, and the stage that proved it.
#[inline]
#[must_use]
pub fn decide(a: &Shape, b: &Shape, threshold: Threshold) -> Decision {
    ask(Decide(threshold), a, b).0
}

/// Whether the distance of two features is below delta; `false` if a coordinate is not finite.
///
/// ```
/// use satisfice_collision::{Shape, distance::{self, Threshold}};
/// let vertex = Shape::Vertex([0.2, 0.2, 0.5]);
/// let triangle = Shape::Triangle([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
/// assert!(!distance::within(&vertex, &triangle, Threshold::new(0.5)?));
/// assert!(distance::within(&vertex, &triangle, Threshold::new(0.6)?));
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[inline]
#[must_use]
pub fn within(a: &Shape, b: &Shape, threshold: Threshold) -> bool {
    decide(a, b, threshold).within
}

/// Distance and closest points of two features.
#[must_use]
pub fn proximity(a: &Shape, b: &Shape) -> Proximity {
    let (proximity, swapped) = ask(FindProximity, a, b);
    if swapped { proximity.swapped() } else { proximity }
}

/// The distance of two features: that of their [`proximity`], without the closest points.
///
/// ```
/// use satisfice_collision::{Shape, distance};
/// let (vertex, edge) = (Shape::Vertex([0.0, 3.0, 4.0]), Shape::Edge([[0.0; 3], [1.0, 0.0, 0.0]]));
/// assert_eq!(distance::distance(&vertex, &edge), 5.0);
/// ```
#[inline]
#[must_use]
pub fn distance(a: &Shape, b: &Shape) -> f64 {
    ask(FindDistance, a, b).0
}

/// The distance of two features within a relative error of [`ACCURACY`](super::ACCURACY), faster than a proximity; 0 exactly
/// if they meet; NaN if a coordinate is not finite.
///
/// A convergent iteration (GJK) stops between two proved bounds; where they stay apart the answer is that of
/// [`proximity`].
#[inline]
#[must_use]
pub fn measure(a: &Shape, b: &Shape) -> f64 {
    ask(Measure, a, b).0
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::mesh::FeatureKind;

    #[test]
    fn the_answer_does_not_depend_on_the_order_of_the_features() {
        let a = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.2, 1.0, 0.3]];
        let b = [[0.1, 0.2, 0.9], [1.1, 0.4, 1.5], [0.3, 1.2, 1.1]];
        for kind in FeatureKind::ALL {
            for other in FeatureKind::ALL {
                let (one, two) = (Shape::new(kind, |k| a[k]), Shape::new(other, |k| b[k]));
                let (there, back) = (proximity(&one, &two), proximity(&two, &one));
                assert_eq!(there.distance, back.distance);
                // Points of `one` are low, points of `two` are high.
                assert!(there.point_a[2] < 0.5 && there.point_b[2] > 0.5);
                assert!(back.point_b[2] < 0.5 && back.point_a[2] > 0.5);
                for (delta, expected) in [(there.distance * 1.01, true), (there.distance * 0.99, false)] {
                    let threshold = Threshold::new(delta).unwrap();
                    assert_eq!(within(&one, &two, threshold), expected);
                    assert_eq!(within(&two, &one, threshold), expected);
                }
                let relative = (measure(&one, &two) - there.distance).abs() / there.distance;
                assert!(relative <= super::super::ACCURACY);
            }
        }
    }
}

//! The pairs of an answer in little memory, and how each is written.

use satisfice_collision::FeatureKind;
use satisfice_collision::distance::{Feature, Proximity};
use serde::ser::SerializeSeq;
use serde::{Deserialize, Serialize, Serializer};

use super::scene::{Feature as BodyFeature, Pair, World};

/// The pairs found, in order. Distances that were not measured any more are NaN.
#[derive(Debug, Default)]
pub(super) struct Pairs {
    pub(super) pairs: Vec<Pair>,
    pub(super) distances: Vec<f64>,
    /// Closest points, where they are asked for.
    pub(super) witnesses: Option<Vec<Option<Proximity>>>,
    /// Of a search: the evaluation that found the pair, and when.
    pub(super) found: Option<Vec<(u64, f64)>>,
}

/// A pair as a report has it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Line {
    pub(super) a: Side,
    pub(super) b: Side,
    /// `null` if the time ended before it was measured.
    pub(super) distance: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) witness: Option<Witness>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) evaluation: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) seconds: Option<f64>,
}

/// A feature, with its ends if it is an edge: files do not number edges.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Side {
    pub(super) body: usize,
    pub(super) feature: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) vertices: Option<[u32; 2]>,
}

/// Where two features are closest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Witness {
    pub(super) point_a: [f64; 3],
    pub(super) point_b: [f64; 3],
    /// The unit vector from the first point to the second; `null` where they meet.
    pub(super) normal: Option<[f64; 3]>,
    /// The part of the first feature that the point is on: `vertex K` and `edge K` count within the feature, the edge
    /// from its corner K to the next.
    pub(super) part_a: String,
    pub(super) part_b: String,
}

impl Witness {
    fn new(near: &Proximity) -> Self {
        Self {
            point_a: near.point_a,
            point_b: near.point_b,
            // Where they meet, the points differ by their rounding only.
            normal: (near.distance > 0.0)
                .then(|| direction(near.point_a, near.point_b))
                .flatten(),
            part_a: part(near.feature_a),
            part_b: part(near.feature_b),
        }
    }
}

fn part(feature: Feature) -> String {
    match feature {
        Feature::Vertex(k) => format!("vertex {k}"),
        Feature::Edge(k) => format!("edge {k}"),
        Feature::Face => "face".to_owned(),
    }
}

/// The unit vector from the first point to the second; `None` if they are the same.
pub(super) fn direction(a: [f64; 3], b: [f64; 3]) -> Option<[f64; 3]> {
    let step: [f64; 3] = std::array::from_fn(|k| b[k] - a[k]);
    // Scaled first, so that no square is 0 or infinite.
    let most = step.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
    let step = step.map(|c| c / most);
    let length = step.iter().map(|c| c * c).sum::<f64>().sqrt();
    (most > 0.0 && length.is_finite()).then(|| step.map(|c| c / length))
}

impl Side {
    fn new(BodyFeature { body, feature }: BodyFeature, kind: FeatureKind, world: &World) -> Self {
        let body = body as usize;
        let ends = || {
            world
                .bodies
                .get(body)?
                .unplaced()
                .edges()
                .get(feature as usize)
                .copied()
        };
        Self {
            body,
            feature,
            vertices: if kind == FeatureKind::Edge { ends() } else { None },
        }
    }
}

impl Pairs {
    pub(super) fn len(&self) -> usize {
        self.pairs.len()
    }

    /// The distance of a pair, if it was measured.
    pub(super) fn distance(&self, index: usize) -> Option<f64> {
        self.distances
            .get(index)
            .copied()
            .filter(|distance| !distance.is_nan())
    }

    /// How many pairs have no distance.
    pub(super) fn unmeasured(&self) -> usize {
        let measured = self
            .distances
            .iter()
            .filter(|distance| !distance.is_nan())
            .count();
        self.len() - measured
    }

    /// The least and the greatest distance.
    pub(super) fn range(&self) -> Option<(f64, f64)> {
        let measured = || {
            self.distances
                .iter()
                .copied()
                .filter(|distance| !distance.is_nan())
        };
        measured().reduce(f64::min).zip(measured().reduce(f64::max))
    }

    pub(super) fn line(&self, index: usize, world: &World) -> Line {
        let (kind_a, kind_b) = world.kinds();
        let Pair { a, b } = self.pairs[index];
        let found = self.found.as_ref().map(|found| found[index]);
        let distance = self.distance(index);
        let witness = self.witnesses.as_ref().and_then(|all| all.get(index)?.as_ref());
        Line {
            a: Side::new(a, kind_a, world),
            b: Side::new(b, kind_b, world),
            distance,
            witness: witness.map(Witness::new),
            evaluation: found.map(|(evaluation, _)| evaluation),
            seconds: found.map(|(_, seconds)| seconds),
        }
    }

    /// The pairs one after another, none kept in memory.
    pub(super) fn serialize<S: Serializer>(&self, world: &World, serializer: S) -> Result<S::Ok, S::Error> {
        let mut list = serializer.serialize_seq(Some(self.len()))?;
        for index in 0..self.len() {
            list.serialize_element(&self.line(index, world))?;
        }
        list.end()
    }
}

impl Line {
    pub(super) fn pair(&self) -> Pair {
        let side = |side: &Side| BodyFeature {
            body: u32::try_from(side.body).unwrap_or(u32::MAX),
            feature: side.feature,
        };
        Pair {
            a: side(&self.a),
            b: side(&self.b),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn normals_have_length_one_whatever_the_scale() {
        for scale in [1e-320, 1e-200, 1.0, 1e300] {
            let [x, y, z] = direction([0.0; 3], [3.0 * scale, 0.0, 4.0 * scale]).unwrap();
            assert!(
                (x - 0.6).abs() < 1e-3 && y == 0.0 && (z - 0.8).abs() < 1e-3,
                "{scale}"
            );
        }
        assert_eq!(direction([1.0; 3], [1.0; 3]), None);
    }
}

//! The problem of any kind of feature pair: which edges, triangles and vertices are closer than delta?

use std::sync::Arc;

use satisfice::catalogue::Description;
use satisfice::{Axis, Region, SatisficingProblem, Space};
use satisfice::{Bounds, Encoding, Neighbourhood};

use super::metric::{PointMetric, far};
use super::ordered_features::OrderedFeatures;
use super::ranges;
use super::side::Side;
use crate::broad::{FeatureTree, TreeJoin};
use crate::distance::{self, PairKind, Threshold};
use crate::error::Error;
use crate::mesh::{Adjacency, Mesh, Shape};
use crate::placement::Placement;

/// The problem of all pairs `(i, j)` of features with F(i, j) < delta, between two bodies or within one. F is their distance,
/// and 0 if they meet. It generalises Eq. 1 of Chen et al. 2012 from vertices to all features.
///
/// A solution is a pair of feature numbers: vertices and triangles as in the mesh, edges as in [`Mesh::edges`]. The space has
/// two integer axes, the positions of the features' middles along a Hilbert curve.
///
/// * `F < delta` is exact for the coordinates as they are. F itself has a relative error of at most 1e-10
///   ([`distance::ACCURACY`]); for pairs of vertices it is within a few units in the last place.
/// * Within one body, features that share a vertex, or whose vertices are within the excluded ring, are not pairs: their F is
///   finite, at least delta and at least every distance within the body. For features of one kind, `(i, j)` and `(j, i)` are
///   one solution with `i < j`.
/// * Neighbours: one of the two features is replaced by one that shares a vertex with it (a vertex: an edge). If delta is below
///   the median edge length of a body, also both at once, by the closest of those: triangles that share an edge, edges of one
///   triangle. All combinations would be too many moves to help an engine.
/// * Lower bounds: the distance of the boxes around the two ranges of features, O(log features). With them `branch-and-bound`
///   proves the count, and other engines can avoid regions without pairs (Li 2010).
///
/// ```
/// use satisfice::{Budget, Search, engine};
/// use satisfice_collision::{distance::PairKind, generate, problem::FeaturePairs, Placement};
/// let ball = generate::icosphere(1.0, 2)?;
/// let other = Placement::from_translation([1.9, 0.0, 0.0])?.place(&ball)?;
/// let problem = FeaturePairs::between(PairKind::TriangleTriangle, &ball, &other, 0.02)?;
/// let report = Search::with(engine::BranchAndBound::default()).run(&problem, &Budget::evaluations(1_000_000))?;
/// assert_eq!(report.hit_count(), problem.exact_pairs().len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct FeaturePairs {
    kind: PairKind,
    pub(super) a: Arc<Side>,
    /// `None` if both features are of one body and of one kind.
    pub(super) b: Option<Arc<Side>>,
    pub(super) own: Option<Own>,
    pub(super) threshold: Threshold,
    pub(super) points: PointMetric,
    joint_moves: bool,
    space: Space<f64>,
}

/// The pairs excluded within one body, and their F.
#[derive(Debug, Clone)]
pub(super) struct Own {
    pub(super) rings: Adjacency,
    pub(super) far: f64,
}

impl FeaturePairs {
    /// Pairs closer than `delta` of a feature of `a` and a feature of `b`, of the first and the second kind in `kind`. `delta` is
    /// in the unit of the meshes.
    ///
    /// # Errors
    /// [`Error::Parameter`] unless `delta` is finite and above 0, and for a body without such a feature.
    pub fn between(kind: PairKind, a: &Mesh, b: &Mesh, delta: f64) -> Result<Self, Error> {
        let (kind_a, kind_b) = kind.features();
        let a = OrderedFeatures::new(a, kind_a)?;
        let b = OrderedFeatures::new(b, kind_b)?;
        Self::between_ordered(kind, &a, &b, delta)
    }

    /// [`FeaturePairs::between`] of features that are in order already, which costs no time for features. A body that is part of
    /// several problems is ordered once for all of them.
    ///
    /// ```
    /// use satisfice_collision::distance::PairKind;
    /// use satisfice_collision::problem::OrderedFeatures;
    /// use satisfice_collision::{FeatureKind, FeaturePairs, Placement, generate};
    /// let ball = generate::icosphere(1.0, 2)?;
    /// let features = OrderedFeatures::new(&ball, FeatureKind::Triangle)?;
    /// for x in [1.8, 1.9] {
    ///     let other = Placement::from_translation([x, 0.0, 0.0])?.place(&ball)?;
    ///     let other = OrderedFeatures::new(&other, FeatureKind::Triangle)?;
    ///     let problem = FeaturePairs::between_ordered(PairKind::TriangleTriangle, &features, &other, 0.1)?;
    ///     assert!(!problem.exact_pairs().is_empty());
    /// }
    /// # Ok::<(), satisfice_collision::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Parameter`] unless `delta` is finite and above 0, and for features that are not of the two kinds.
    pub fn between_ordered(
        kind: PairKind,
        a: &OrderedFeatures,
        b: &OrderedFeatures,
        delta: f64,
    ) -> Result<Self, Error> {
        Self::new(kind, [a, b], None, Threshold::new(delta)?)
    }

    /// Pairs of features of one body closer than `delta`, except those that share a vertex or have two vertices at most
    /// `ring_width` edges apart.
    ///
    /// # Errors
    /// As [`FeaturePairs::between`].
    pub fn within(kind: PairKind, mesh: &Mesh, delta: f64, ring_width: usize) -> Result<Self, Error> {
        let (kind_a, kind_b) = kind.features();
        let a = OrderedFeatures::new(mesh, kind_a)?;
        let b = (kind_a != kind_b).then(|| OrderedFeatures::new(mesh, kind_b));
        let b = b.transpose()?;
        Self::within_ordered(kind, &a, b.as_ref().unwrap_or(&a), delta, ring_width)
    }

    /// [`FeaturePairs::within`] of features that are in order already; twice the same ones if they are of one kind.
    ///
    /// # Errors
    /// As [`FeaturePairs::between_ordered`], and for features of two bodies.
    pub fn within_ordered(
        kind: PairKind,
        a: &OrderedFeatures,
        b: &OrderedFeatures,
        delta: f64,
        ring_width: usize,
    ) -> Result<Self, Error> {
        let (mesh, other) = (a.mesh(), b.mesh());
        if !mesh.same_body(other) || mesh.vertices() != other.vertices() {
            return Err(Error::parameter("bodies", 2, "both features of one body"));
        }
        let own = Own {
            rings: mesh.adjacency().rings(ring_width),
            far: far(mesh, delta),
        };
        Self::new(kind, [a, b], Some(own), Threshold::new(delta)?)
    }

    fn new(
        kind: PairKind,
        [a, b]: [&OrderedFeatures; 2],
        own: Option<Own>,
        threshold: Threshold,
    ) -> Result<Self, Error> {
        let kinds = (a.kind(), b.kind());
        if kinds != kind.features() {
            let given = format!("{} and {}", kinds.0.plural(), kinds.1.plural());
            return Err(Error::parameter(
                "features",
                given,
                "of the two kinds of the pairs",
            ));
        }
        let is_symmetric = own.is_some() && kinds.0 == kinds.1;
        Ok(Self {
            joint_moves: threshold.get() < a.spacing().max(b.spacing()),
            space: space(a.side(), b.side())?,
            kind,
            own,
            threshold,
            points: PointMetric::new(threshold),
            a: Arc::clone(a.side()),
            b: (!is_symmetric).then(|| Arc::clone(b.side())),
        })
    }

    /// Replaces the features on the axes, or their order.
    pub(super) fn rearrange(
        &mut self,
        a: impl FnOnce(&mut Side) -> Result<(), Error>,
        b: impl FnOnce(&mut Side) -> Result<(), Error>,
    ) -> Result<(), Error> {
        a(Arc::make_mut(&mut self.a))?;
        self.b.as_mut().map(Arc::make_mut).map_or(Ok(()), b)?;
        self.space = space(&self.a, self.second())?;
        Ok(())
    }

    /// The kinds of the two features.
    #[must_use]
    pub fn kind(&self) -> PairKind {
        self.kind
    }

    /// Whether the neighbours of a pair are also those with both features moved.
    #[must_use]
    pub fn with_joint_moves(mut self, joint_moves: bool) -> Self {
        self.joint_moves = joint_moves;
        self
    }

    /// Whether the neighbours of a pair are also those with both features moved.
    #[must_use]
    pub fn joint_moves(&self) -> bool {
        self.joint_moves
    }

    /// The first body.
    #[must_use]
    pub fn a(&self) -> &Mesh {
        &self.a.mesh
    }

    /// The second body; the first one again if there is only one.
    #[must_use]
    pub fn b(&self) -> &Mesh {
        &self.second().mesh
    }

    /// Replaces the first body by its next frame, in which it moved or deformed. The orders stay, so that the solutions of the
    /// previous frame keep their positions in the space. Cost: O(features).
    ///
    /// # Errors
    /// [`Error::Parameter`] if edges or triangles differ.
    pub fn move_a(&mut self, mesh: &Mesh) -> Result<(), Error> {
        Arc::make_mut(&mut self.a).go_to(mesh)?;
        if let Some(own) = &mut self.own {
            own.far = far(mesh, self.threshold.get());
            if let Some(b) = &mut self.b {
                Arc::make_mut(b).go_to(mesh)?;
            }
        }
        Ok(())
    }

    /// Replaces the second body by its next frame; the same as [`FeaturePairs::move_a`] if there is only one body.
    ///
    /// # Errors
    /// As [`FeaturePairs::move_a`].
    pub fn move_b(&mut self, mesh: &Mesh) -> Result<(), Error> {
        match &mut self.b {
            Some(b) if self.own.is_none() => Arc::make_mut(b).go_to(mesh),
            _ => self.move_a(mesh),
        }
    }

    /// Whether [`FeaturePairs::within`] has any pair, at whatever distance: all pairs of a small body may be within the excluded
    /// ring. Cost: one ring and a look at the features where there is a pair of the first feature, which is usual.
    #[must_use]
    pub fn has_pairs_within(kind: PairKind, mesh: &Mesh, ring_width: usize) -> bool {
        let (kind_a, kind_b) = kind.features();
        let (features, others) = (mesh.features(kind_a), mesh.features(kind_b));
        (0..kind_a.count(mesh) as u32).any(|i| {
            let mut near = Vec::new();
            for v in features.corners(i) {
                near.push(v);
                near.extend(mesh.adjacency().ring(v, ring_width));
            }
            near.sort_unstable();
            let is_near = |v: &u32| near.binary_search(v).is_ok();
            (0..kind_b.count(mesh) as u32).any(|j| !others.corners(j).iter().any(is_near))
        })
    }

    /// All solutions, sorted, by a box tree and exact decisions: the reference for engines.
    #[must_use]
    pub fn exact_pairs(&self) -> Vec<(u32, u32)> {
        let keep = |i: u32, j: u32| !self.no_pair(i, j);
        let (kind_a, kind_b) = self.kind.features();
        let a = FeatureTree::new(&self.a.mesh, kind_a);
        let mut join = TreeJoin::new();
        let pairs = match &self.b {
            None => join.within(&a, self.threshold, Some(&keep)),
            Some(b) => {
                let b = FeatureTree::new(&b.mesh, kind_b);
                let here = &Placement::IDENTITY;
                // A mesh without a placement is in range.
                join.between((&a, here), (&b, here), self.threshold, Some(&keep))
                    .unwrap_or_default()
            }
        };
        pairs.iter().map(|pair| (pair.a, pair.b)).collect()
    }

    /// All solutions, sorted, by the exact decision of every pair: the reference for faster methods. Cost: O(|a| |b|).
    #[must_use]
    pub fn reference_pairs(&self) -> Vec<(u32, u32)> {
        let mut pairs = Vec::new();
        for i in 0..self.a.len() as u32 {
            let first = if self.is_symmetric() { i + 1 } else { 0 };
            for j in first..self.second().len() as u32 {
                if !self.no_pair(i, j) && self.is_within(i, j) {
                    pairs.push((i, j));
                }
            }
        }
        pairs
    }

    #[inline]
    pub(super) fn second(&self) -> &Side {
        self.b.as_ref().unwrap_or(&self.a)
    }

    #[inline]
    fn is_symmetric(&self) -> bool {
        self.b.is_none()
    }

    /// The exact decision; the features exist.
    fn is_within(&self, i: u32, j: u32) -> bool {
        distance::within(&self.a.shape(i), &self.second().shape(j), self.threshold)
    }

    #[inline]
    pub(super) fn no_pair(&self, i: u32, j: u32) -> bool {
        let Some(own) = &self.own else { return false };
        if self.kind == PairKind::VertexVertex {
            return i == j || own.rings.contains(i, j);
        }
        let (corners, others) = (self.a.corners(i), self.second().corners(j));
        corners
            .iter()
            .any(|&v| others.iter().any(|&w| v == w || own.rings.contains(v, w)))
    }

    #[inline]
    fn ordered(&self, i: u32, j: u32) -> (u32, u32) {
        if self.is_symmetric() {
            (i.min(j), i.max(j))
        } else {
            (i, j)
        }
    }
}

fn space(a: &Side, b: &Side) -> Result<Space<f64>, Error> {
    let axes = [a, b].map(|side| Axis::integer(0, side.len() as i64 - 1));
    Space::new(axes).map_err(|error| Error::parameter("number of features", error, "at least one per body"))
}

impl SatisficingProblem for FeaturePairs {
    type Scalar = f64;
    type Solution = (u32, u32);

    fn space(&self) -> &Space<f64> {
        &self.space
    }

    #[inline]
    fn decode(&self, values: &[f64]) -> (u32, u32) {
        self.ordered(self.a.feature(values[0]), self.second().feature(values[1]))
    }

    /// NaN, which is never a hit, for numbers without a feature.
    #[inline]
    fn fitness(&self, &(i, j): &(u32, u32)) -> f64 {
        if !self.a.has(i) || !self.second().has(j) {
            return f64::NAN;
        }
        if let Some(own) = &self.own
            && self.no_pair(i, j)
        {
            return own.far;
        }
        let (one, two) = (self.a.shape(i), self.second().shape(j));
        if let (Shape::Vertex(p), Shape::Vertex(q)) = (&one, &two) {
            return self.points.distance(p, q);
        }
        // A rounded distance can be on the wrong side of delta only this close to it.
        const BAND: f64 = 4.0 * distance::ACCURACY;
        let (distance, delta) = (distance::measure(&one, &two).min(f64::MAX), self.threshold.get());
        if (distance - delta).abs() > BAND * delta {
            distance
        } else if self.is_within(i, j) {
            distance.min(delta.next_down())
        } else {
            distance.max(delta)
        }
    }

    fn threshold(&self) -> f64 {
        self.threshold.get()
    }

    fn canonical(&self, &hit: &(u32, u32)) -> Option<(u32, u32)> {
        let ordered = self.ordered(hit.0, hit.1);
        (ordered != hit).then_some(ordered)
    }

    fn description(&self) -> Description {
        let own = if self.own.is_some() { "self-" } else { "" };
        Description {
            name: format!("{}-{own}pairs", self.kind),
            parameters: vec![
                ("delta".to_owned(), self.threshold.get().to_string()),
                ("features-a".to_owned(), self.a.len().to_string()),
                ("features-b".to_owned(), self.second().len().to_string()),
                ("order".to_owned(), self.a.order.to_string()),
            ],
        }
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, (u32, u32)>> {
        Some(self)
    }
    fn neighbourhood(&self) -> Option<&dyn Neighbourhood<(u32, u32)>> {
        let has_some = !(self.a.neighbours.has_none() && self.second().neighbours.has_none());
        has_some.then_some(self as _)
    }
    fn bounds(&self) -> Option<&dyn Bounds<f64>> {
        Some(self)
    }
}

impl Encoding<f64, (u32, u32)> for FeaturePairs {
    fn encode(&self, &(i, j): &(u32, u32), values: &mut [f64]) -> bool {
        let (Some(p), Some(q)) = (self.a.position(i), self.second().position(j)) else {
            return false;
        };
        values[0] = p;
        values[1] = q;
        true
    }
}

impl Neighbourhood<(u32, u32)> for FeaturePairs {
    fn count(&self, &(i, j): &(u32, u32)) -> usize {
        if !self.a.has(i) || !self.second().has(j) {
            return 0;
        }
        let joint = if self.joint_moves {
            self.a.close().neighbours(i).len() * self.second().close().neighbours(j).len()
        } else {
            0
        };
        self.a.neighbours.neighbours(i).len() + self.second().neighbours.neighbours(j).len() + joint
    }

    /// The first feature moves, then the second, then both.
    fn neighbour(&self, &(i, j): &(u32, u32), index: usize) -> Option<(u32, u32)> {
        if !self.a.has(i) || !self.second().has(j) {
            return None;
        }
        let around_i = self.a.neighbours.neighbours(i);
        let around_j = self.second().neighbours.neighbours(j);
        let (k, l) = if let Some(&k) = around_i.get(index) {
            (k, j)
        } else if let Some(&l) = around_j.get(index - around_i.len()) {
            (i, l)
        } else if self.joint_moves {
            let index = index - around_i.len() - around_j.len();
            let close_j = self.second().close().neighbours(j);
            let k = self
                .a
                .close()
                .neighbours(i)
                .get(index.checked_div(close_j.len())?)?;
            (*k, close_j[index % close_j.len()])
        } else {
            return None;
        };
        (!self.no_pair(k, l)).then(|| self.ordered(k, l))
    }
}

impl Bounds<f64> for FeaturePairs {
    fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
        let a = self.a.around(region.lower[0], region.upper[0]);
        let b = self.second().around(region.lower[1], region.upper[1]);
        let bound = ranges::bound(&a, &b);
        // Except for vertices, F is only within its accuracy.
        Some(match self.kind {
            PairKind::VertexVertex => bound,
            _ => bound * (1.0 - distance::ACCURACY),
        })
    }
}

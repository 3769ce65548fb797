//! The vertex-vertex problem of Eq. 1: which pairs of vertices are closer than delta?

use std::sync::Arc;

use satisfice::{Bounds, Encoding, Neighbourhood};
use satisfice::{SatisficingProblem, Space};

use super::FeaturePairs;
use super::side::Side;
use crate::distance::PairKind;
use crate::error::Error;
use crate::mesh::{Adjacency, Mesh};
use crate::oracle;
use crate::order::VertexOrder;

/// The problem of all pairs of vertices with F(i, j) = |a_i - b_j| < delta, between two bodies or within one (Eq. 1).
///
/// A solution is a pair of vertex numbers `(i, j)` of the meshes. The space has two integer axes, the positions of the
/// vertices in their [`VertexOrder`] (Hilbert by default), so that close points of the space are close pairs.
///
/// Within one body, `(i, j)` and `(j, i)` are one solution with `i < j`. A vertex with itself, and vertices at most a ring
/// width of mesh edges apart, are not pairs: their F is finite, at least delta and at least every distance within the body.
///
/// `F < delta` is exact for the coordinates as they are; F itself is within a few units in the last place. An evaluation
/// does not allocate.
///
/// The neighbours of a pair are those with one of the two vertices moved along a mesh edge. If delta is below the median edge
/// length of a body, they include those with both vertices moved, since one step alone then exceeds delta.
/// The lower bound of a region is the distance of the boxes around its two ranges of vertices.
///
/// Source of the problem: Chen, Ye, An, Wang 2012, doi 10.3923/itj.2012.536.539.
///
/// ```
/// use satisfice::{Budget, Search, engine};
/// use satisfice_collision::{Placement, VertexPairs, generate};
/// let ball = generate::icosphere(1.0, 2)?;
/// let other = Placement::from_translation([1.9, 0.0, 0.0])?.place(&ball)?;
/// let problem = VertexPairs::between(&ball, &other, 0.2)?;
/// let report = Search::with(engine::Random::default()).seed(1).run(&problem, &Budget::evaluations(200_000))?;
/// assert!(report.hit_count() <= problem.reference_pairs().len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct VertexPairs {
    /// The same problem for features, which has F and everything that a choice of vertices changes.
    pairs: FeaturePairs,
}

impl VertexPairs {
    /// Pairs of a vertex of `a` and a vertex of `b` closer than `delta`, all vertices, in Hilbert order.
    ///
    /// # Errors
    /// [`Error::Parameter`] unless `delta` is finite and above 0.
    pub fn between(a: &Mesh, b: &Mesh, delta: f64) -> Result<Self, Error> {
        let pairs = FeaturePairs::between(PairKind::VertexVertex, a, b, delta)?;
        Ok(Self { pairs })
    }

    /// Pairs of vertices of one body closer than `delta`, in Hilbert order, except those at most `ring_width` mesh
    /// edges apart (1 excludes mesh neighbours, 0 only `i = j`).
    ///
    /// # Errors
    /// [`Error::Parameter`] unless `delta` is finite and above 0.
    pub fn within(mesh: &Mesh, delta: f64, ring_width: usize) -> Result<Self, Error> {
        let pairs = FeaturePairs::within(PairKind::VertexVertex, mesh, delta, ring_width)?;
        Ok(Self { pairs })
    }

    /// The same problem for a choice of vertices; duplicates count once. Within one body, `b` is ignored.
    ///
    /// # Errors
    /// [`Error::Parameter`] if none is given or a number is not a vertex.
    pub fn with_vertices(mut self, a: &[u32], b: &[u32]) -> Result<Self, Error> {
        self.pairs
            .rearrange(|side| side.choose(a), |side| side.choose(b))?;
        Ok(self)
    }

    /// The same problem with other vertex orders. Within one body, `b` is ignored.
    #[must_use]
    pub fn with_orders(mut self, a: VertexOrder, b: VertexOrder) -> Self {
        Arc::make_mut(&mut self.pairs.a).reorder(a);
        if let Some(side) = &mut self.pairs.b {
            Arc::make_mut(side).reorder(b);
        }
        self
    }

    /// Whether the neighbours of a pair are also those with both vertices moved.
    #[must_use]
    pub fn with_joint_moves(self, joint_moves: bool) -> Self {
        Self {
            pairs: self.pairs.with_joint_moves(joint_moves),
        }
    }

    /// Whether the neighbours of a pair are also those with both vertices moved.
    #[must_use]
    pub fn joint_moves(&self) -> bool {
        self.pairs.joint_moves()
    }

    /// The first body.
    #[must_use]
    pub fn a(&self) -> &Mesh {
        self.pairs.a()
    }

    /// The second body; the first one again if there is only one.
    #[must_use]
    pub fn b(&self) -> &Mesh {
        self.pairs.b()
    }

    /// Replaces the first body by its next frame, in which it moved or deformed. Orders, choice and rings stay, so that the
    /// solutions of the previous frame keep their positions in the space.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the number of vertices differs.
    pub fn move_a(&mut self, mesh: &Mesh) -> Result<(), Error> {
        self.pairs.move_a(mesh)
    }

    /// Replaces the second body by its next frame; the same as [`VertexPairs::move_a`] if there is only one body.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the number of vertices differs.
    pub fn move_b(&mut self, mesh: &Mesh) -> Result<(), Error> {
        self.pairs.move_b(mesh)
    }

    /// All solutions by brute force ([`oracle`]), sorted. Cost: O(|a| |b|).
    #[must_use]
    pub fn reference_pairs(&self) -> Vec<(u32, u32)> {
        let FeaturePairs {
            a, b, own, threshold, ..
        } = &self.pairs;
        let chosen = |side: &Side| {
            let numbers = side.chosen();
            let points: Vec<[f64; 3]> = numbers.iter().map(|&v| side.mesh.vertex(v)).collect();
            (numbers, points)
        };
        let (numbers, points) = chosen(a);
        if let Some(b) = b {
            let (numbers_b, points_b) = chosen(b);
            return oracle::pairs_between(&points, &points_b, *threshold)
                .into_iter()
                .map(|[i, j]| (numbers[i as usize], numbers_b[j as usize]))
                .collect();
        }
        let excluded = |&(i, j): &(u32, u32)| own.as_ref().is_some_and(|own| own.rings.contains(i, j));
        oracle::pairs_within(&points, &Adjacency::none(points.len()), *threshold)
            .into_iter()
            .map(|[i, j]| (numbers[i as usize], numbers[j as usize]))
            .filter(|pair| !excluded(pair))
            .collect()
    }
}

impl SatisficingProblem for VertexPairs {
    type Scalar = f64;
    type Solution = (u32, u32);

    fn space(&self) -> &Space<f64> {
        self.pairs.space()
    }

    #[inline]
    fn decode(&self, values: &[f64]) -> (u32, u32) {
        self.pairs.decode(values)
    }

    /// NaN, which is never a hit, for numbers without a vertex.
    #[inline]
    fn fitness(&self, &(i, j): &(u32, u32)) -> f64 {
        let pairs = &self.pairs;
        let (Some(p), Some(q)) = (pairs.a.point(i), pairs.second().point(j)) else {
            return f64::NAN;
        };
        match &pairs.own {
            Some(own) if pairs.no_pair(i, j) => own.far,
            _ => pairs.points.distance(p, q),
        }
    }

    /// Evaluates eight pairs at a time: all are fetched, then measured together.
    fn fitness_all(&self, solutions: &[(u32, u32)], fitness: &mut [f64]) {
        const LANES: usize = 8;
        let pairs = &self.pairs;
        let second = pairs.second();
        let mut rest = (solutions, fitness);
        while let Some((eight, more)) = rest.0.split_first_chunk::<LANES>() {
            let (mut d, mut known) = ([[0.0; LANES]; 3], true);
            for (lane, &(i, j)) in eight.iter().enumerate() {
                if let (Some(p), Some(q)) = (pairs.a.point(i), second.point(j))
                    && !pairs.no_pair(i, j)
                {
                    (0..3).for_each(|k| d[k][lane] = p[k] - q[k]);
                } else {
                    known = false;
                }
            }
            let (now, later) = rest.1.split_at_mut(LANES);
            if !known || !pairs.points.distances(&d, now) {
                for (solution, f) in eight.iter().zip(now) {
                    *f = self.fitness(solution);
                }
            }
            rest = (more, later);
        }
        for (solution, f) in rest.0.iter().zip(rest.1) {
            *f = self.fitness(solution);
        }
    }

    fn threshold(&self) -> f64 {
        self.pairs.threshold()
    }

    fn canonical(&self, hit: &(u32, u32)) -> Option<(u32, u32)> {
        self.pairs.canonical(hit)
    }

    fn description(&self) -> satisfice::catalogue::Description {
        let side = |name: &str, side: &Side| {
            [
                (format!("vertices-{name}"), side.len().to_string()),
                (format!("order-{name}"), side.order.to_string()),
            ]
        };
        let mut parameters = vec![("delta".to_owned(), self.threshold().to_string())];
        parameters.extend(side("a", &self.pairs.a));
        if let Some(b) = &self.pairs.b {
            parameters.extend(side("b", b));
        }
        let name = match self.pairs.b {
            Some(_) => "vertex-pairs",
            None => "vertex-self-pairs",
        };
        satisfice::catalogue::Description {
            name: name.to_owned(),
            parameters,
        }
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, (u32, u32)>> {
        self.pairs.encoding()
    }
    fn neighbourhood(&self) -> Option<&dyn Neighbourhood<(u32, u32)>> {
        self.pairs.neighbourhood()
    }
    fn bounds(&self) -> Option<&dyn Bounds<f64>> {
        self.pairs.bounds()
    }
}

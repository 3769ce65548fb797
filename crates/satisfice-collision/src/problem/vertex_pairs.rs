//! The vertex-vertex problem of Eq. 1: which pairs of vertices are closer than delta?

use satisfice::{Region, SatisficingProblem, Space};

use super::metric::{PointMetric, far};
use super::ranges;
use super::side::Side;
use crate::distance::Threshold;
use crate::error::Error;
use crate::mesh::{Adjacency, Mesh};
use crate::oracle;
use crate::order::VertexOrder;

/// All pairs of vertices with F(i, j) = |a_i - b_j| < delta, of two bodies or of one with itself (Eq. 1).
///
/// A solution is a pair of vertex numbers `(i, j)` of the meshes. The space has two integer axes, the positions of the
/// vertices in their [`VertexOrder`] (Hilbert by default), so that near points of the space are near pairs.
///
/// Of one body with itself, `(i, j)` and `(j, i)` are one solution with `i < j`; a vertex with itself, and vertices at
/// most a ring width of mesh edges apart, are no pairs: their F is finite, at least delta and at least every distance of
/// the body.
///
/// `F < delta` holds exactly where it holds for the coordinates as they are, rounding notwithstanding; F itself is within
/// a few units in the last place. An evaluation allocates nothing.
///
/// The neighbours of a pair are those with one of the two vertices moved along a mesh edge; where delta is below the
/// typical (median) edge length of a body also those with both moved, since one step alone then leads out of reach.
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
/// let report = Search::new(engine::build("random")?).seed(1).run(&problem, &Budget::evaluations(200_000))?;
/// assert!(report.hit_count() <= problem.reference_pairs().len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct VertexPairs {
    a: Side,
    bodies: Bodies,
    threshold: Threshold,
    points: PointMetric,
    joint_moves: bool,
    space: Space<f64>,
}

#[derive(Debug, Clone)]
enum Bodies {
    Two(Side),
    /// One with itself: what is excluded, and F there.
    One {
        excluded: Adjacency,
        far: f64,
    },
}

impl VertexPairs {
    /// Pairs of a vertex of `a` and a vertex of `b` closer than `delta`, all vertices, in Hilbert order.
    ///
    /// # Errors
    /// [`Error::Parameter`] unless `delta` is finite and above 0.
    pub fn between(a: &Mesh, b: &Mesh, delta: f64) -> Result<Self, Error> {
        Self::new(Side::all(a), Bodies::Two(Side::all(b)), Threshold::new(delta)?)
    }

    /// Pairs of vertices of one body closer than `delta`, in Hilbert order, leaving out those at most `ring_width` mesh
    /// edges apart (1 leaves out the mesh neighbours, 0 nothing but `i = j`).
    ///
    /// # Errors
    /// [`Error::Parameter`] unless `delta` is finite and above 0.
    pub fn within(mesh: &Mesh, delta: f64, ring_width: usize) -> Result<Self, Error> {
        let threshold = Threshold::new(delta)?;
        let excluded = mesh.adjacency().rings(ring_width);
        Self::new(
            Side::all(mesh),
            Bodies::One {
                excluded,
                far: far(mesh, delta),
            },
            threshold,
        )
    }

    fn new(a: Side, bodies: Bodies, threshold: Threshold) -> Result<Self, Error> {
        let spacing = match &bodies {
            Bodies::Two(b) => a.spacing().max(b.spacing()),
            Bodies::One { .. } => a.spacing(),
        };
        Ok(Self {
            space: space(&a, &bodies)?,
            joint_moves: threshold.get() < spacing,
            points: PointMetric::new(threshold),
            a,
            bodies,
            threshold,
        })
    }

    /// The same problem over some vertices only; the same ones twice count once. Of one body with itself, `b` is not
    /// looked at.
    ///
    /// # Errors
    /// [`Error::Parameter`] if none is given or a number is not a vertex.
    pub fn with_vertices(mut self, a: &[u32], b: &[u32]) -> Result<Self, Error> {
        self.a = self.a.choose(a)?;
        if let Bodies::Two(side) = &mut self.bodies {
            *side = side.choose(b)?;
        }
        self.space = space(&self.a, &self.bodies)?;
        Ok(self)
    }

    /// The same problem with other vertex orders. Of one body with itself, `b` is not looked at.
    #[must_use]
    pub fn with_orders(mut self, a: VertexOrder, b: VertexOrder) -> Self {
        self.a = Side::new(&self.a.mesh, a, &self.a.chosen());
        if let Bodies::Two(side) = &mut self.bodies {
            *side = Side::new(&side.mesh, b, &side.chosen());
        }
        self
    }

    /// Whether the neighbours of a pair are also those with both vertices moved.
    #[must_use]
    pub fn with_joint_moves(mut self, joint_moves: bool) -> Self {
        self.joint_moves = joint_moves;
        self
    }

    /// Whether the neighbours of a pair are also those with both vertices moved.
    #[must_use]
    pub fn joint_moves(&self) -> bool {
        self.joint_moves
    }

    /// The first body.
    #[must_use]
    pub fn a(&self) -> &Mesh {
        &self.a.mesh
    }

    /// The second body; the first one again, of one body with itself.
    #[must_use]
    pub fn b(&self) -> &Mesh {
        match &self.bodies {
            Bodies::Two(b) => &b.mesh,
            Bodies::One { .. } => &self.a.mesh,
        }
    }

    /// The first body has moved or changed its shape: its next frame. Orders, choice and rings stay, so the solutions of
    /// the frame before keep their places in the space.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the number of vertices differs.
    pub fn move_a(&mut self, mesh: &Mesh) -> Result<(), Error> {
        self.a.go_to(frame(&self.a.mesh, mesh)?);
        if let Bodies::One { far: f, .. } = &mut self.bodies {
            *f = far(mesh, self.threshold.get());
        }
        Ok(())
    }

    /// The second body has moved or changed its shape; of one body with itself the same as [`VertexPairs::move_a`].
    ///
    /// # Errors
    /// [`Error::Parameter`] if the number of vertices differs.
    pub fn move_b(&mut self, mesh: &Mesh) -> Result<(), Error> {
        match &mut self.bodies {
            Bodies::Two(b) => b.go_to(frame(&b.mesh, mesh)?),
            Bodies::One { .. } => self.move_a(mesh)?,
        }
        Ok(())
    }

    /// All solutions by brute force ([`oracle`]), sorted. O(|a| |b|).
    #[must_use]
    pub fn reference_pairs(&self) -> Vec<(u32, u32)> {
        let (numbers, points) = self.a.chosen_points();
        match &self.bodies {
            Bodies::Two(b) => {
                let (numbers_b, points_b) = b.chosen_points();
                oracle::pairs_between(&points, &points_b, self.threshold)
                    .into_iter()
                    .map(|[i, j]| (numbers[i as usize], numbers_b[j as usize]))
                    .collect()
            }
            Bodies::One { excluded, .. } => {
                oracle::pairs_within(&points, &Adjacency::none(points.len()), self.threshold)
                    .into_iter()
                    .map(|[i, j]| (numbers[i as usize], numbers[j as usize]))
                    .filter(|&(i, j)| !excluded.contains(i, j))
                    .collect()
            }
        }
    }

    #[inline]
    fn no_pair(&self, i: u32, j: u32) -> bool {
        match &self.bodies {
            Bodies::Two(_) => false,
            Bodies::One { excluded, .. } => i == j || excluded.contains(i, j),
        }
    }

    #[inline]
    fn ordered(&self, i: u32, j: u32) -> (u32, u32) {
        match self.bodies {
            Bodies::Two(_) => (i, j),
            Bodies::One { .. } => (i.min(j), i.max(j)),
        }
    }

    #[inline]
    fn second(&self) -> &Side {
        match &self.bodies {
            Bodies::Two(b) => b,
            Bodies::One { .. } => &self.a,
        }
    }
}

fn space(a: &Side, bodies: &Bodies) -> Result<Space<f64>, Error> {
    let b = if let Bodies::Two(b) = bodies { b } else { a };
    let axes = [a, b].map(|side| satisfice::Axis::integer(0, side.vertex_at.len() as i64 - 1));
    Space::new(axes).map_err(|error| Error::parameter("number of vertices", error, "at least one a body"))
}

fn frame(before: &Mesh, now: &Mesh) -> Result<Mesh, Error> {
    if before.vertices().len() == now.vertices().len() {
        Ok(now.clone())
    } else {
        Err(Error::parameter(
            "number of vertices",
            now.vertices().len(),
            "as many as in the frame before",
        ))
    }
}

impl SatisficingProblem for VertexPairs {
    type Scalar = f64;
    type Solution = (u32, u32);

    fn space(&self) -> &Space<f64> {
        &self.space
    }

    #[inline]
    fn decode(&self, values: &[f64]) -> (u32, u32) {
        self.ordered(self.a.vertex(values[0]), self.second().vertex(values[1]))
    }

    /// NaN, which is never a hit, for numbers that are no vertices.
    #[inline]
    fn fitness(&self, &(i, j): &(u32, u32)) -> f64 {
        let (Some(p), Some(q)) = (self.a.point(i), self.second().point(j)) else {
            return f64::NAN;
        };
        if let Bodies::One { far, .. } = self.bodies
            && self.no_pair(i, j)
        {
            return far;
        }
        self.points.distance(p, q)
    }

    /// Eight at a time: all are fetched, then measured together.
    fn fitness_all(&self, solutions: &[(u32, u32)], fitness: &mut [f64]) {
        const LANES: usize = 8;
        let second = self.second();
        let mut rest = (solutions, fitness);
        while let Some((pairs, more)) = rest.0.split_first_chunk::<LANES>() {
            let (mut d, mut known) = ([[0.0; LANES]; 3], true);
            for (lane, &(i, j)) in pairs.iter().enumerate() {
                if let (Some(p), Some(q)) = (self.a.point(i), second.point(j))
                    && !self.no_pair(i, j)
                {
                    (0..3).for_each(|k| d[k][lane] = p[k] - q[k]);
                } else {
                    known = false;
                }
            }
            let (now, later) = rest.1.split_at_mut(LANES);
            if !known || !self.points.distances(&d, now) {
                for (solution, f) in pairs.iter().zip(now) {
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
        self.threshold.get()
    }

    fn encode(&self, &(i, j): &(u32, u32), values: &mut [f64]) -> bool {
        let (Some(p), Some(q)) = (self.a.position(i), self.second().position(j)) else {
            return false;
        };
        values[0] = p;
        values[1] = q;
        true
    }

    fn neighbours(&self, &(i, j): &(u32, u32), visit: &mut dyn FnMut((u32, u32))) -> bool {
        if self.a.neighbours.has_none() && self.second().neighbours.has_none() {
            return false;
        }
        let (around_i, around_j) = (
            self.a.neighbours.neighbours(i),
            self.second().neighbours.neighbours(j),
        );
        let mut go = |i: u32, j: u32| {
            if !self.no_pair(i, j) {
                visit(self.ordered(i, j));
            }
        };
        for &k in around_i {
            go(k, j);
        }
        for &l in around_j {
            go(i, l);
        }
        if self.joint_moves {
            for &k in around_i {
                for &l in around_j {
                    go(k, l);
                }
            }
        }
        true
    }

    /// The distance of the boxes around the two ranges of vertices. O(log vertices).
    fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
        let a = self.a.around(region.lower[0], region.upper[0]);
        let b = self.second().around(region.lower[1], region.upper[1]);
        Some(ranges::bound(&a, &b))
    }

    fn canonical(&self, (i, j): (u32, u32)) -> (u32, u32) {
        self.ordered(i, j)
    }

    fn description(&self) -> satisfice::Description {
        let name = match self.bodies {
            Bodies::Two(_) => "vertex-pairs",
            Bodies::One { .. } => "vertex-self-pairs",
        };
        let side = |name: &str, side: &Side| {
            [
                (format!("vertices-{name}"), side.vertex_at.len().to_string()),
                (format!("order-{name}"), side.order.to_string()),
            ]
        };
        let mut parameters = vec![("delta".to_owned(), self.threshold.get().to_string())];
        parameters.extend(side("a", &self.a));
        if let Bodies::Two(b) = &self.bodies {
            parameters.extend(side("b", b));
        }
        satisfice::Description {
            name: name.to_owned(),
            parameters,
        }
    }
}

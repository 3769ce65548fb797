//! Closed meshes as solids: which points lie inside, and how deep two solids overlap.
//!
//! Everywhere else a body is a surface: a ball within a larger ball touches nothing. Here a body is its surface and all that this
//! encloses: the points from which a ray crosses the surface an odd number of times. Which way triangles are turned does not
//! matter, and a shell within a shell is a hollow.
//!
//! ```
//! use satisfice_collision::scene::Completeness;
//! use satisfice_collision::solid::{Relation, Solid, overlap};
//! use satisfice_collision::{Placement, generate};
//! let large = Solid::new(&generate::icosphere(2.0, 3)?)?;
//! let small = generate::icosphere(0.5, 3)?;
//! let small = Solid::new(&Placement::from_translation([1.0, 0.0, 0.0])?.place(&small)?)?;
//! assert!(large.contains([1.9, 0.0, 0.0]) && !large.contains([2.1, 0.0, 0.0]));
//! let (overlap, completeness) = overlap(&large, &small, &|| false);
//! let overlap = overlap.expect("one lies within the other");
//! assert_eq!(completeness, Completeness::Proved);
//! assert_eq!(overlap.relation, Relation::SecondInsideFirst);
//! // The shortest way out is 0.5 to the surface and the diameter of the small ball.
//! assert!((overlap.depth.at_most - 1.5).abs() < 0.02);
//! # Ok::<(), satisfice_collision::Error>(())
//! ```

mod convex;
mod depth;
mod hull;
mod parity;
mod unit;

use crate::broad::{Closest, Dirty, FeatureTree, PairQuery, Watch, find_closest};
use crate::distance::orientation::side_of_line;
use crate::distance::{Point, Threshold};
use crate::mesh::weld;
use crate::scene::Completeness;
use crate::{Aabb, Error, FeatureKind, Mesh, Placement};
pub use depth::Depth;

/// A closed mesh as a solid.
#[derive(Debug)]
pub struct Solid {
    mesh: Mesh,
    bounds: Aabb,
    /// Of its triangles.
    tree: FeatureTree,
    /// A vertex of each connected part of the surface.
    parts: Vec<u32>,
    is_convex: bool,
}

/// How two solids lie that overlap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// Their surfaces meet; they may just touch, see the depth.
    SurfacesMeet,
    /// All of the first lies inside the second.
    FirstInsideSecond,
    /// All of the second lies inside the first.
    SecondInsideFirst,
    /// Some connected parts of one lie inside the other.
    PartsInside,
}

/// That two solids overlap, and how deep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    /// How they lie.
    pub relation: Relation,
    /// How far one has to be moved so that no point of one lies inside the other any more.
    pub depth: Depth,
}

impl Solid {
    /// Checks that the surface is closed: that an even number of triangles meet at each edge. Vertices with equal coordinates count
    /// as one; vertices and lines that belong to no triangle do not count. A surface may be flat: its depth in others is 0.
    ///
    /// Cost: O(n log n).
    ///
    /// # Errors
    /// [`Error::NotClosed`], or [`Error::Parameter`] for a mesh without a triangle that has an area, and for one so large that depths
    /// may be out of the range of numbers.
    pub fn new(mesh: &Mesh) -> Result<Self, Error> {
        if mesh.triangles().is_empty() {
            return Err(Error::parameter(
                "number of triangles",
                0,
                "a surface to enclose something",
            ));
        }
        let (vertices, number) = weld(mesh.vertices());
        let joined = |v: u32| number[v as usize] as u32;
        let triangles: Vec<[u32; 3]> = mesh.triangles().iter().map(|t| t.map(joined)).collect();
        check_closed(mesh, &triangles, &number)?;
        let mesh = Mesh::new(vertices, Vec::new(), triangles)?;
        let parts = parts(&mesh);
        let corners = mesh.triangles().iter().flatten().map(|&v| mesh.vertex(v));
        let bounds = Aabb::of_points(corners).unwrap_or_else(|| mesh.bounds());
        check_size(&mesh, &bounds)?;
        Ok(Self {
            bounds,
            tree: FeatureTree::new(&mesh, FeatureKind::Triangle),
            is_convex: parts.len() == 1 && convex::is_convex(&mesh),
            parts,
            mesh,
        })
    }

    /// Whether a point lies inside, decided exactly; of points on the surface itself, some do and some do not. A point with a
    /// coordinate that is not finite lies outside.
    ///
    /// Cost: as that of a ray.
    #[must_use]
    pub fn contains(&self, point: Point) -> bool {
        parity::is_inside(&self.tree, &self.bounds, point)
    }

    /// Whether the solid is convex but for rounding, whichever way its triangles are turned. A surface with slivers is not recognised.
    #[must_use]
    pub fn is_convex(&self) -> bool {
        self.is_convex
    }

    /// The vertices of the triangles.
    fn corners(&self) -> impl Iterator<Item = Point> {
        let mut corners: Vec<u32> = self.mesh.triangles().as_flattened().to_vec();
        corners.sort_unstable();
        corners.dedup();
        corners.into_iter().map(|v| self.mesh.vertex(v))
    }

    /// How many connected parts of another solid lie inside, if the surfaces do not meet. Those that the watch leaves time for.
    fn parts_inside(&self, other: &Self, watch: &Watch<'_>) -> usize {
        let parts = other.parts.iter().take_while(|_| !watch.ask(0));
        parts.filter(|v| self.contains(other.mesh.vertex(**v))).count()
    }
}

/// Whether two solids overlap, and how deep; `None` if no point of one lies inside or on the other. `stop` may end the search early; if it
/// does, the answer is [`Completeness::Unknown`]: an overlap is there as it says, but the bounds of its depth may be wider, and
/// `None` says nothing.
///
/// ```
/// use satisfice_collision::generate;
/// use satisfice_collision::scene::Completeness;
/// use satisfice_collision::solid::{Solid, overlap};
/// let ball = Solid::new(&generate::icosphere(1.0, 3)?)?;
/// assert_eq!(overlap(&ball, &ball, &|| true), (None, Completeness::Unknown));
/// assert!(matches!(overlap(&ball, &ball, &|| false), (Some(_), Completeness::Proved)));
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
///
/// Whether they overlap is decided exactly. For two convex solids the bounds of the depth agree but for rounding, unless the search
/// for it was ended; otherwise see [`Depth`].
///
/// Cost: that of the closest pair of triangles, a ray for each connected part, and for the depth a few hundred passes over all vertices.
pub fn overlap(
    first: &Solid,
    second: &Solid,
    stop: &(dyn Fn() -> bool + Sync),
) -> (Option<Overlap>, Completeness) {
    let stop = |_: usize| stop();
    let watch = Watch::until(&stop);
    let overlap = relation(first, second, &watch).map(|relation| Overlap {
        relation,
        depth: depth::depth(first, second, &|| watch.ask(0)),
    });
    let completeness = match watch.stopped() {
        true => Completeness::Unknown,
        false => Completeness::Proved,
    };
    (overlap, completeness)
}

/// How two solids lie, as far as the watch lets it be found.
fn relation(first: &Solid, second: &Solid, watch: &Watch<'_>) -> Option<Relation> {
    let (a, b) = (&first.bounds, &second.bounds);
    if (0..3).any(|k| a.max[k] < b.min[k] || b.max[k] < a.min[k]) {
        return None;
    }
    if surfaces_meet(&first.tree, &second.tree, watch) {
        return Some(Relation::SurfacesMeet);
    }
    let second_parts = first.parts_inside(second, watch);
    let first_parts = second.parts_inside(first, watch);
    if watch.stopped() {
        return None;
    }
    if first_parts == first.parts.len() {
        Some(Relation::FirstInsideSecond)
    } else if second_parts == second.parts.len() {
        Some(Relation::SecondInsideFirst)
    } else {
        (first_parts + second_parts > 0).then_some(Relation::PartsInside)
    }
}

/// Visits of pairs of boxes between two questions to the watch.
const VISITS: usize = 256;

/// Whether a triangle of one tree meets one of another, as far as the watch lets it be found.
fn surfaces_meet(a: &FeatureTree, b: &FeatureTree, watch: &Watch<'_>) -> bool {
    // Closer than the least number that there is.
    let Ok(threshold) = Threshold::new(f64::from_bits(1)) else {
        return false;
    };
    let query = query(a, b, threshold);
    let (mut stack, mut found) = (Vec::new(), Vec::new());
    query.start(&mut stack);
    while !stack.is_empty() && found.is_empty() && !watch.ask(0) {
        query.step(&mut stack, VISITS, 1, &mut found);
    }
    !found.is_empty()
}

fn query<'a>(a: &'a FeatureTree, b: &'a FeatureTree, threshold: Threshold) -> PairQuery<'a> {
    PairQuery {
        a: (a, &Placement::IDENTITY),
        b: (b, &Placement::IDENTITY),
        one_body: false,
        threshold,
        keep: None,
        moved: [Dirty::All; 2],
        shares_mesh: false,
    }
}

/// The distance of two sets of features.
fn distance(a: &FeatureTree, b: &FeatureTree) -> f64 {
    let query = query(a, b, Threshold::LARGEST);
    let mut closest = Closest::any();
    find_closest(&query, &mut closest, |pair| pair, &Watch::none());
    closest.bound()
}

/// Refuses a surface in which an odd number of triangles meet at an edge; `number` says which joined vertex each vertex is.
fn check_closed(mesh: &Mesh, triangles: &[[u32; 3]], number: &[usize]) -> Result<(), Error> {
    let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut sides: Vec<[u32; 2]> = sides
        .filter(|[a, b]| a != b)
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    sides.sort_unstable();
    let mut open = sides
        .chunk_by(|one, two| one == two)
        .filter(|same| same.len() % 2 == 1);
    let Some(first) = open.next() else {
        return Ok(());
    };
    let as_given = |joined: u32| {
        let found = mesh
            .vertices()
            .iter()
            .zip(number)
            .position(|(_, &n)| n == joined as usize);
        found.unwrap_or_default()
    };
    Err(Error::NotClosed {
        edge: first[0].map(as_given),
        triangles: first.len(),
        edges: 1 + open.count(),
    })
}

/// Refuses a surface of which no triangle has an area, and one larger than a quarter of the largest number: bounds of two that overlap,
/// and the ways out of each other, have to be in the range of numbers.
fn check_size(mesh: &Mesh, bounds: &Aabb) -> Result<(), Error> {
    let has_area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.vertex(v));
        (0..3).any(|axis| side_of_line(a, b, c, axis) != 0)
    };
    if !mesh.triangles().iter().any(has_area) {
        return Err(Error::parameter(
            "number of triangles with an area",
            0,
            "the corners of each lie in one point or on one line, and enclose nothing; leave the mesh out, or scale it before it is rounded",
        ));
    }
    let size = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
    if size > f64::MAX / 4.0 {
        return Err(Error::parameter(
            "size of the surface",
            format!("{size:e}"),
            "at most 4e307, so that depths are in the range of numbers; give the mesh in a larger unit",
        ));
    }
    Ok(())
}

/// A vertex of each connected part of the surface, the least one.
fn parts(mesh: &Mesh) -> Vec<u32> {
    let mut first: Vec<u32> = (0..mesh.vertices().len() as u32).collect();
    fn root(first: &mut [u32], mut v: u32) -> u32 {
        while first[v as usize] != v {
            let above = first[first[v as usize] as usize];
            first[v as usize] = above;
            v = above;
        }
        v
    }
    for &[a, b, c] in mesh.triangles() {
        for (v, w) in [(a, b), (b, c)] {
            let (v, w) = (root(&mut first, v), root(&mut first, w));
            first[v.max(w) as usize] = v.min(w);
        }
    }
    let mut parts: Vec<u32> = mesh.triangles().iter().map(|t| root(&mut first, t[0])).collect();
    parts.sort_unstable();
    parts.dedup();
    parts
}

#[cfg(test)]
mod tests;

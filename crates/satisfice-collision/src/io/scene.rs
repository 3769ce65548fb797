//! The bodies of a scene file: meshes with names and placements.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::transform::{Instances, Transform};
use crate::error::Error;
use crate::mesh::Mesh;
use crate::placement::Placement;

/// A body as a file describes it. Instances of one mesh share it.
///
/// ```
/// use std::sync::Arc;
/// use satisfice_collision::{Placement, generate, io::PlacedMesh};
/// let body = PlacedMesh {
///     name: "left".to_owned(),
///     mesh: Arc::new(generate::teapot(2)?),
///     placement: Placement::from_translation([-2.0, 0.0, 0.0])?,
/// };
/// assert!(body.placed()?.bounds().max[0] < 2.0);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedMesh {
    /// Name of the body, unique in its scene.
    pub name: String,
    /// Its mesh, in coordinates of the body.
    pub mesh: Arc<Mesh>,
    /// Where it is in the scene.
    pub placement: Placement,
}

impl PlacedMesh {
    /// The mesh in coordinates of the scene; the mesh itself, shared, if it is not moved.
    ///
    /// # Errors
    /// [`Error::NonFiniteVertex`] if a coordinate overflows.
    pub fn placed(&self) -> Result<Arc<Mesh>, Error> {
        if self.placement == Placement::IDENTITY {
            return Ok(Arc::clone(&self.mesh));
        }
        self.placement.place(&self.mesh).map(Arc::new)
    }

    /// The body elsewhere: scaled about the origin of the scene, then turned about the x, y and z axis by `degrees`, in
    /// this order, then moved to `at`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a scale of 0 and numbers that are not finite, [`Error::NonFiniteVertex`] if a coordinate
    /// overflows.
    ///
    /// ```
    /// # use std::sync::Arc;
    /// # use satisfice_collision::{Mesh, Placement, io::PlacedMesh};
    /// let point = Arc::new(Mesh::new(vec![[1.0, 0.0, 0.0]], vec![], vec![])?);
    /// let body = PlacedMesh { name: "point".to_owned(), mesh: point, placement: Placement::IDENTITY };
    /// let [x, y, z] = body.moved([5.0, 0.0, 0.0], [0.0, 0.0, 90.0], 2.0)?.placed()?.vertex(0);
    /// assert!((x - 5.0).abs() < 1e-15 && (y - 2.0).abs() < 1e-15 && z == 0.0);
    /// # Ok::<(), satisfice_collision::Error>(())
    /// ```
    pub fn moved(&self, at: [f64; 3], degrees: [f64; 3], scale: f64) -> Result<Self, Error> {
        self.moved_among(at, degrees, scale, &mut Instances::default())
    }

    /// [`PlacedMesh::moved`], sharing scaled meshes with others.
    pub(super) fn moved_among(
        &self,
        at: [f64; 3],
        degrees: [f64; 3],
        scale: f64,
        instances: &mut Instances,
    ) -> Result<Self, Error> {
        let here = Transform::Similar {
            scale: 1.0,
            placement: self.placement,
        };
        let there = here.then(&Transform::of_degrees(at, degrees, scale)?)?;
        let (mesh, placement) = instances.instance(&self.mesh, &there)?;
        Ok(Self {
            name: self.name.clone(),
            mesh,
            placement,
        })
    }
}

/// Makes all names differ: a name that has been taken gets the suffix `.2`, `.3` and so on.
pub(super) fn make_names_unique(bodies: &mut [PlacedMesh]) {
    let mut uses: BTreeMap<String, usize> = BTreeMap::new();
    let taken: BTreeSet<String> = bodies.iter().map(|body| body.name.clone()).collect();
    for body in bodies {
        let count = uses.entry(body.name.clone()).or_default();
        *count += 1;
        if *count == 1 {
            continue;
        }
        let mut unique = format!("{}.{count}", body.name);
        while taken.contains(&unique) {
            *count += 1;
            unique = format!("{}.{count}", body.name);
        }
        body.name = unique;
    }
}

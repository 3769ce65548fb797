//! A body of the command: a mesh, which copies share, and its place.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use satisfice_collision::mesh::Point;
use satisfice_collision::scene::SharedMesh;
use satisfice_collision::{Aabb, Error, FeatureKind, Mesh, Placement, Shape};

/// A body and what it is called in messages.
#[derive(Debug, Clone)]
pub(super) struct NamedBody {
    pub(super) name: String,
    /// The file it comes from.
    pub(super) file: PathBuf,
    /// In coordinates of its own.
    pub(super) mesh: SharedMesh,
    /// Where it is in the scene.
    pub(super) placement: Placement,
}

impl NamedBody {
    /// The mesh in coordinates of its own: for what does not depend on its place.
    pub(super) fn unplaced(&self) -> &Mesh {
        self.mesh.mesh()
    }

    /// How many features of a kind it has.
    pub(super) fn count(&self, kind: FeatureKind) -> usize {
        kind.count(self.unplaced())
    }

    /// The mesh in coordinates of the scene.
    ///
    /// # Errors
    /// [`Error::NonFiniteVertex`] if a coordinate overflows.
    pub(super) fn placed(&self) -> Result<Cow<'_, Mesh>, Error> {
        Ok(match self.is_unmoved() {
            true => Cow::Borrowed(self.unplaced()),
            false => Cow::Owned(self.placement.place(self.unplaced())?),
        })
    }

    /// The vertices in coordinates of the scene.
    pub(super) fn vertices(&self) -> impl Iterator<Item = Point> {
        self.unplaced().vertices().iter().map(|&point| self.at(point))
    }

    /// A feature that there is, in coordinates of the scene.
    pub(super) fn shape(&self, kind: FeatureKind, feature: u32) -> Shape {
        let mesh = self.unplaced();
        mesh.features(kind)
            .shape(feature, |v| self.at(mesh.vertex(v)))
    }

    /// The box around the vertices in coordinates of the scene.
    pub(super) fn bounds(&self) -> Aabb {
        let mut vertices = self.vertices();
        let first = vertices.next().map_or([0.0; 3], |first| first);
        vertices.fold(Aabb::point(first), |mut bounds, vertex| {
            bounds.include(vertex);
            bounds
        })
    }

    fn is_unmoved(&self) -> bool {
        self.placement == Placement::IDENTITY
    }

    fn at(&self, point: Point) -> Point {
        match self.is_unmoved() {
            true => point,
            false => self.placement.apply(point),
        }
    }
}

/// Meshes that several bodies have, each kept once.
#[derive(Default)]
pub(super) struct Meshes(BTreeMap<usize, (Arc<Mesh>, SharedMesh)>);

impl Meshes {
    /// The mesh, shared with the other bodies that have it.
    pub(super) fn shared(&mut self, mesh: Arc<Mesh>) -> SharedMesh {
        match Arc::try_unwrap(mesh) {
            Ok(alone) => alone.into(),
            Err(mesh) => {
                // The address stays that of this mesh, which is kept beside.
                let address = Arc::as_ptr(&mesh) as usize;
                let (_, shared) = self
                    .0
                    .entry(address)
                    .or_insert_with(|| (Arc::clone(&mesh), (*mesh).clone().into()));
                shared.clone()
            }
        }
    }
}

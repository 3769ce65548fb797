//! A body of the command: a mesh, which copies share, and its place.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use satisfice_collision::mesh::Point;
use satisfice_collision::scene::{Body, SharedMesh};
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

    /// The body where it is, for a scene in which nothing moves.
    pub(super) fn fixed(&self) -> Body {
        Body::fixed(self.mesh.clone()).at(self.placement)
    }

    /// A vertex that there is, in coordinates of the scene.
    pub(super) fn vertex(&self, v: u32) -> Point {
        self.at(self.unplaced().vertex(v))
    }

    /// The vertices in coordinates of the scene.
    pub(super) fn vertices(&self) -> impl Iterator<Item = Point> {
        self.unplaced().vertices().iter().map(|&point| self.at(point))
    }

    /// A feature that there is, in coordinates of the scene.
    pub(super) fn shape(&self, kind: FeatureKind, feature: u32) -> Shape {
        let features = self.unplaced().features(kind);
        features.shape(feature, |v| self.vertex(v))
    }

    /// The box around the vertices in coordinates of the scene.
    pub(super) fn bounds(&self) -> Aabb {
        let mut vertices = self.vertices();
        // A mesh has at least one.
        let mut bounds = Aabb::point(vertices.next().unwrap_or_default());
        vertices.for_each(|vertex| bounds.include(vertex));
        bounds
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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use satisfice_collision::broad::Method;
    use satisfice_collision::distance::PairKind;
    use satisfice_collision::scene::{self, Contact};
    use satisfice_collision::{generate, io};

    use crate::collide::arguments::Find;
    use crate::collide::inputs::Inputs;
    use crate::collide::scene::{Request, World};

    /// Balls of two sizes in places that no number of few digits describes, one of them mirrored.
    const LIST: &str = r#"
        [[bodies]]
        mesh = "ball.obj"
        [[bodies]]
        mesh = "ball.obj"
        at = [1.3, 0.1, -0.2]
        rotate = [10.1, 20.2, 30.3]
        [[bodies]]
        mesh = "ball.obj"
        at = [0.1, 1.2, 0.3]
        rotate = [77.7, -5.5, 123.4]
        scale = 0.7
        [[bodies]]
        mesh = "ball.obj"
        at = [0.9, 0.8, 0.1]
        rotate = [-33.3, 44.4, 1.1]
        scale = 0.7
        [[bodies]]
        mesh = "ball.obj"
        at = [0.3, -0.9, 0.7]
        rotate = [3.3, 4.4, 5.5]
        scale = -0.7
    "#;

    /// Copies in places are decided by the coordinates of the meshes moved there, to the last bit.
    #[test]
    fn copies_that_share_a_mesh_answer_as_meshes_moved_there() {
        let folder = tempfile::tempdir().unwrap();
        let ball = generate::icosphere(1.0, 2).unwrap();
        io::save_obj(&ball, folder.path().join("ball.obj")).unwrap();
        let path = folder.path().join("list.toml");
        std::fs::write(&path, LIST).unwrap();
        let moved: Vec<_> = io::read_scene(&path).unwrap();
        let moved: Vec<_> = moved.iter().map(|body| body.placed().unwrap()).collect();
        for kind in PairKind::ALL {
            let world = World::read(Request {
                inputs: Inputs {
                    paths: vec![path.clone()],
                    ..Inputs::default()
                },
                kind,
                threshold: 0.1,
                within: false,
                ring_width: None,
                find: Find::All,
                solid: false,
            })
            .unwrap();
            let sharing = |a: usize, b: usize| world.bodies[a].mesh.is_same(&world.bodies[b].mesh);
            assert!(sharing(0, 1) && sharing(2, 3) && !sharing(1, 2) && !sharing(3, 4));
            let mut apart = scene::World::new(kind, world.threshold).with_method(Method::BruteForce);
            for (body, mesh) in world.bodies.iter().zip(&moved) {
                assert_eq!(*body.placed().unwrap(), **mesh);
                assert_eq!(body.bounds(), mesh.bounds());
                assert!(body.vertices().eq(mesh.vertices().iter().copied()));
                apart.add(scene::Body::fixed((**mesh).clone())).unwrap();
            }
            let expected: Vec<Contact> = apart.frame().unwrap().contacts;
            assert!(expected.len() > 20, "{kind}: {}", expected.len());
            for method in [Method::Auto, Method::Tree, Method::BruteForce] {
                let mut shared = world.scene(method).unwrap();
                assert_eq!(shared.frame().unwrap().contacts, expected, "{kind}");
                for &contact in &expected {
                    let [one, two] = [&shared, &apart].map(|scene| scene.proximity(contact).unwrap());
                    assert_eq!(one, two, "{kind}");
                }
            }
        }
    }
}

//! What a ray meets first.

use crate::broad::FirstHit;
use crate::distance::Point;
use crate::distance::first_point;
use crate::scene::{BodyId, World};
use crate::{Error, FeatureKind};

/// What a ray meets first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayHit {
    /// The body.
    pub body: BodyId,
    /// The triangle, by its number in the mesh of the body.
    pub triangle: u32,
    /// Where on the way: 0 at the start, 1 at the end; within one unit in the last place.
    pub part: f64,
    /// The point that is met, rounded.
    pub point: Point,
}

impl World {
    /// The first triangle that a ray meets on its way from one point to another, both ends included. Of several at once, that of the
    /// body with the lowest index, and of its triangles the one with the lowest number.
    ///
    /// Whether a triangle is met, and which one first, is decided exactly for the posed coordinates: a ray never slips through
    /// between triangles that share an edge or a vertex. Triangles count from both sides, whatever the world's pairs are made of;
    /// bodies of vertices and edges alone are not met. Cost: logarithmic in the bodies and in their triangles.
    ///
    /// ```
    /// use satisfice_collision::distance::{PairKind, Threshold};
    /// use satisfice_collision::scene::{Body, World};
    /// use satisfice_collision::{Placement, generate};
    /// let mut world = World::new(PairKind::TriangleTriangle, Threshold::new(0.01)?);
    /// let floor = world.add(Body::fixed(generate::cloth(4.0, 4.0, 8, 8)?))?;
    /// let ball = world.add(Body::rigid(generate::icosphere(0.5, 2)?))?;
    /// world.place(ball, Placement::from_translation([0.0, 0.0, 3.0])?)?;
    /// let hit = world.cast_ray([0.0, 0.0, 10.0], [0.0, 0.0, -10.0])?.expect("the ball is in the way");
    /// assert_eq!(hit.body, ball);
    /// let hit = world.cast_ray([1.5, 0.0, 10.0], [1.5, 0.0, -10.0])?.expect("the floor is below");
    /// assert_eq!((hit.body, hit.part, hit.point), (floor, 0.5, [1.5, 0.0, 0.0]));
    /// # Ok::<(), satisfice_collision::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Parameter`] if a coordinate is not finite.
    pub fn cast_ray(&mut self, from: Point, to: Point) -> Result<Option<RayHit>, Error> {
        self.cast_ray_where(from, to, |_| true)
    }

    /// The same among the bodies that satisfy a predicate.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a coordinate is not finite.
    pub fn cast_ray_where(
        &mut self,
        from: Point,
        to: Point,
        counts: impl Fn(BodyId) -> bool,
    ) -> Result<Option<RayHit>, Error> {
        for (name, end) in [("start of the ray", from), ("end of the ray", to)] {
            if end.iter().any(|c| !c.is_finite()) {
                return Err(Error::parameter(name, format!("{end:?}"), "three finite numbers"));
            }
        }
        self.settle();
        let segment = [from, to];
        let mut first = FirstHit::new(segment);
        self.with_tree(|tree, world| {
            tree.along(segment, |slot| {
                if counts(world.id(slot)) {
                    world.first_in(slot, &mut first)?;
                }
                Ok::<_, Error>(first.bound())
            })
        })?;
        Ok(first.found().map(|((slot, triangle), part)| RayHit {
            body: self.id(slot),
            triangle,
            part,
            point: first_point::along(&segment, part),
        }))
    }

    /// Adds what a ray meets of a body.
    fn first_in(&mut self, slot: u32, first: &mut FirstHit<(u32, u32)>) -> Result<(), Error> {
        if self.state(slot).mesh.mesh().triangles().is_empty() {
            return Ok(());
        }
        let parallel = self.parallel;
        self.state_mut(slot)
            .ensure_tree(FeatureKind::Triangle, parallel)?;
        let state = self.state(slot);
        if let Some(tree) = state.tree(FeatureKind::Triangle) {
            let keep = |triangle| state.counts(FeatureKind::Triangle, triangle);
            first.add((tree, &state.placement()), keep, |triangle| (slot, triangle));
        }
        Ok(())
    }
}

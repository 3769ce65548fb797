//! What is in a region of space.

use crate::scene::{BodyId, World};
use crate::{Aabb, Error};

impl World {
    /// The bodies whose boxes ([`World::bounds`]) share a point with a box, by index. Cost: logarithmic in the bodies, and linear in
    /// those that are found.
    ///
    /// ```
    /// use satisfice_collision::distance::{PairKind, Threshold};
    /// use satisfice_collision::scene::{Body, SharedMesh, World};
    /// use satisfice_collision::{Aabb, Placement, generate};
    /// let ball = SharedMesh::from(generate::icosphere(0.5, 1)?);
    /// let mut world = World::new(PairKind::TriangleTriangle, Threshold::new(0.01)?);
    /// for x in 0..10 {
    ///     world.add(Body::rigid(ball.clone()).at(Placement::from_translation([f64::from(2 * x), 0.0, 0.0])?))?;
    /// }
    /// let found = world.bodies_in(&Aabb { min: [3.0, -1.0, -1.0], max: [6.0, 1.0, 1.0] })?;
    /// assert_eq!(found.iter().map(|body| body.index()).collect::<Vec<_>>(), [2, 3]);
    /// # Ok::<(), satisfice_collision::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Parameter`] if a side of the box is no number, or below its opposite one.
    pub fn bodies_in(&mut self, region: &Aabb) -> Result<Vec<BodyId>, Error> {
        if !(0..3).all(|k| region.min[k] <= region.max[k]) {
            return Err(Error::parameter(
                "box",
                format!("{:?} to {:?}", region.min, region.max),
                "no lower side above its upper one",
            ));
        }
        self.settle();
        let (mut found, mut stack) = (Vec::new(), Vec::new());
        self.tree.overlapping(region, &mut stack, |slot| {
            let bounds = self.state(slot).bounds();
            if (0..3).all(|k| bounds.min[k] <= region.max[k] && region.min[k] <= bounds.max[k]) {
                found.push(self.id(slot));
            }
        });
        found.sort_unstable();
        Ok(found)
    }
}

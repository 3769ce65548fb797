//! How many contacts there are, without keeping them.

use super::filter::PairFilter;
use super::query::{Stop, VISITS, completeness};
use super::{Completeness, World};
use crate::Error;
use crate::broad::{Pair, Watch};

impl World {
    /// The number of contacts, in memory that does not grow with it, or how many there are at least when `stop` ended the
    /// count. `stop` is asked as in [`World::frame_until`].
    ///
    /// # Errors
    /// As [`World::update`].
    ///
    /// ```
    /// use satisfice_collision::distance::{PairKind, Threshold};
    /// use satisfice_collision::scene::{Body, Completeness, World};
    /// use satisfice_collision::{Placement, generate};
    /// let ball = generate::icosphere(1.0, 2)?;
    /// let mut world = World::new(PairKind::EdgeEdge, Threshold::new(0.1)?);
    /// world.add(Body::fixed(ball.clone()))?;
    /// world.add(Body::fixed(Placement::from_translation([1.5, 0.0, 0.0])?.place(&ball)?))?;
    /// let (count, completeness) = world.count_until(&|_| false)?;
    /// assert_eq!((count, completeness), (world.frame()?.contacts.len() as u64, Completeness::Proved));
    /// # Ok::<(), satisfice_collision::Error>(())
    /// ```
    pub fn count_until(&mut self, stop: Stop<'_>) -> Result<(u64, Completeness), Error> {
        let watch = Watch::until(stop);
        let mut count = 0;
        let mut stack = Vec::new();
        let mut found = Vec::new();
        for record in self.by_bodies() {
            if watch.stopped() {
                break;
            }
            let bodies = self.pairs[record].bodies;
            if self.boxes_apart(bodies) {
                continue;
            }
            self.ensure_trees(bodies)?;
            let (one, two) = (self.state(bodies[0]), self.state(bodies[1]));
            let filter = PairFilter::new(self.kind, one.state(), two.state(), bodies[0] == bodies[1]);
            let keep = |i: u32, j: u32| filter.keeps(Pair { a: i, b: j });
            let places = self.places(bodies);
            let Some(query) = self.pair_query(bodies, &places, self.threshold, &filter, &keep) else {
                continue;
            };
            stack.clear();
            query.start(&mut stack);
            while !stack.is_empty() && !watch.ask(0) {
                query.step(&mut stack, VISITS, usize::MAX, &mut found);
                count += found.len() as u64;
                watch.ask(found.len());
                found.clear();
            }
        }
        Ok((count, completeness(&watch)))
    }
}

//! The closest pairs of features, and distances: best first, over the tree of bodies and then over the trees of two bodies.

use super::{Stop, completeness};
use crate::broad::{Closest, Dirty, FeatureTree, Pair, PairQuery, Watch, find_closest};
use crate::distance::{self, Point, Proximity, Threshold};
use crate::scene::filter::PairFilter;
use crate::scene::{BodyId, Completeness, Contact, World};
use crate::{Aabb, Error, FeatureKind, Mesh, Placement, Shape};

/// A feature of a body that is closest to a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestFeature {
    /// The body.
    pub body: BodyId,
    /// The kind of the feature.
    pub kind: FeatureKind,
    /// Its number in the mesh of the body.
    pub feature: u32,
    /// Distance and closest points; `a` is the point, `b` the feature.
    pub proximity: Proximity,
}

/// Two bodies in the order of their features, and the features.
type Key = ([u32; 2], Pair);

impl World {
    /// The `k` closest contacts with their distances, by distance, then by number; fewer if there are fewer contacts. See
    /// [`World::nearest`] for the closest pairs at any distance.
    ///
    /// # Errors
    /// As [`World::update`].
    pub fn closest(&mut self, k: usize) -> Result<Vec<(Contact, Proximity)>, Error> {
        self.contacts_by_distance(Closest::new(k, Some(self.threshold)), true, &Watch::none())
    }

    /// The same until `stop` says so: then the closest of what was found, and [`Completeness::Unknown`].
    ///
    /// # Errors
    /// As [`World::update`].
    pub fn closest_until(
        &mut self,
        k: usize,
        stop: Stop<'_>,
    ) -> Result<(Vec<(Contact, Proximity)>, Completeness), Error> {
        let watch = Watch::until(stop);
        let closest = Closest::new(k, Some(self.threshold));
        let found = self.contacts_by_distance(closest, true, &watch)?;
        Ok((found, completeness(&watch)))
    }

    /// The `k` closest pairs of features at any distance, by distance, then by number: of what would be contacts if the threshold
    /// were infinite. Neither the threshold nor the known contacts matter.
    ///
    /// Bodies whose boxes are further apart than the best answer are not visited.
    ///
    /// ```
    /// use satisfice_collision::distance::{PairKind, Threshold};
    /// use satisfice_collision::scene::{Body, SharedMesh, World};
    /// use satisfice_collision::{Placement, generate};
    /// let ball = SharedMesh::from(generate::icosphere(0.5, 2)?);
    /// let mut world = World::new(PairKind::TriangleTriangle, Threshold::new(0.01)?);
    /// for x in [0.0, 3.0, 4.5, 9.0] {
    ///     world.add(Body::rigid(ball.clone()).at(Placement::from_translation([x, 0.0, 0.0])?))?;
    /// }
    /// let (pair, proximity) = world.nearest(1)?[0];
    /// assert_eq!((pair.body_a.index(), pair.body_b.index()), (1, 2));
    /// assert!((proximity.distance - 0.5).abs() < 1e-12);
    /// # Ok::<(), satisfice_collision::Error>(())
    /// ```
    ///
    /// Cost: linear in the number of pairs at distance 0, where many touch.
    ///
    /// # Errors
    /// As [`World::update`].
    pub fn nearest(&mut self, k: usize) -> Result<Vec<(Contact, Proximity)>, Error> {
        self.contacts_by_distance(Closest::new(k, None), true, &Watch::none())
    }

    /// The same until `stop` says so: then the closest of what was found, and [`Completeness::Unknown`].
    ///
    /// # Errors
    /// As [`World::update`].
    pub fn nearest_until(
        &mut self,
        k: usize,
        stop: Stop<'_>,
    ) -> Result<(Vec<(Contact, Proximity)>, Completeness), Error> {
        let watch = Watch::until(stop);
        let found = self.contacts_by_distance(Closest::new(k, None), true, &watch)?;
        Ok((found, completeness(&watch)))
    }

    /// The two bodies that are closest to each other, among those that may collide, with their closest features; `None` if there
    /// are no two. If several meet, any two of them: the same ones for the same world.
    ///
    /// # Errors
    /// As [`World::update`].
    pub fn closest_bodies(&mut self) -> Result<Option<(Contact, Proximity)>, Error> {
        let found = self.contacts_by_distance(Closest::any(), false, &Watch::none())?;
        Ok(found.into_iter().next())
    }

    /// The distance and the closest points of two different bodies, whether they may collide or not, between features of the
    /// world's kinds; `None` if one has no feature that counts. If the bodies meet, any features that do.
    ///
    /// ```
    /// use satisfice_collision::distance::{PairKind, Threshold};
    /// use satisfice_collision::scene::{Body, World};
    /// use satisfice_collision::{Placement, generate};
    /// let mut world = World::new(PairKind::TriangleTriangle, Threshold::new(0.01)?);
    /// let floor = world.add(Body::fixed(generate::cloth(4.0, 4.0, 8, 8)?))?;
    /// let ball = world.add(Body::rigid(generate::icosphere(0.5, 2)?))?;
    /// world.place(ball, Placement::from_translation([0.1, 0.2, 3.0])?)?;
    /// let (contact, proximity) = world.distance(floor, ball)?.expect("both have triangles");
    /// assert_eq!((contact.body_a, contact.body_b), (floor, ball));
    /// assert!((proximity.distance - 2.5).abs() < 0.02);
    /// # Ok::<(), satisfice_collision::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no such body or both are one; otherwise as [`World::update`].
    pub fn distance(&mut self, a: BodyId, b: BodyId) -> Result<Option<(Contact, Proximity)>, Error> {
        self.known(a)?;
        self.known(b)?;
        if a == b {
            return Err(Error::parameter("body", b, "another body than the first one"));
        }
        self.settle();
        let mut closest = Closest::any();
        self.closest_of([a.slot, b.slot], &mut closest, &Watch::none())?;
        Ok(self.as_contacts(closest).into_iter().next())
    }

    /// The feature of a body that is closest to a point, among the second kind of the world's pairs: triangles where pairs of
    /// triangles are looked for. `None` if no feature counts.
    ///
    /// ```
    /// use satisfice_collision::distance::{PairKind, Threshold};
    /// use satisfice_collision::scene::{Body, World};
    /// use satisfice_collision::generate;
    /// let mut world = World::new(PairKind::VertexTriangle, Threshold::new(0.01)?);
    /// let ball = world.add(Body::rigid(generate::icosphere(1.0, 3)?))?;
    /// let nearest = world.distance_to_point(ball, [0.0, 3.0, 4.0])?.expect("it has triangles");
    /// assert!((nearest.proximity.distance - 4.0).abs() < 0.01);
    /// # Ok::<(), satisfice_collision::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no such body; [`Error::NonFiniteVertex`] if a coordinate of the point is not finite.
    pub fn distance_to_point(&mut self, body: BodyId, point: Point) -> Result<Option<NearestFeature>, Error> {
        self.known(body)?;
        self.settle();
        let probe = Probe::new(point)?;
        let mut closest = Closest::any();
        self.closest_to(body.slot, &probe, &mut closest)?;
        Ok(self.as_feature(closest, point))
    }

    /// The feature of any body that is closest to a point; otherwise as [`World::distance_to_point`].
    ///
    /// # Errors
    /// [`Error::NonFiniteVertex`] if a coordinate of the point is not finite.
    pub fn nearest_to_point(&mut self, point: Point) -> Result<Option<NearestFeature>, Error> {
        self.settle();
        let probe = Probe::new(point)?;
        let mut closest = Closest::any();
        self.with_tree(|tree, world| {
            tree.nearest_to(&Aabb::point(point), |body, _| {
                world.closest_to(body, &probe, &mut closest)?;
                Ok::<_, Error>(reach(&closest))
            })
        })?;
        Ok(self.as_feature(closest, point))
    }

    fn as_feature(&self, closest: Closest<(u32, u32)>, point: Point) -> Option<NearestFeature> {
        let (_, kind) = self.feature_kinds();
        let (slot, feature) = closest.into_sorted().first()?.key;
        let point = Shape::Vertex(point);
        Some(NearestFeature {
            body: self.id(slot),
            kind,
            feature,
            proximity: distance::proximity(&point, &self.state(slot).shape(kind, feature)),
        })
    }

    /// Adds the features of a body that are closest to a point.
    fn closest_to(
        &mut self,
        slot: u32,
        probe: &Probe,
        closest: &mut Closest<(u32, u32)>,
    ) -> Result<(), Error> {
        let (_, kind) = self.feature_kinds();
        let parallel = self.parallel;
        self.state_mut(slot).ensure_tree(kind, parallel)?;
        let state = self.state(slot);
        let placement = state.placement();
        let counts = |_: u32, feature: u32| state.counts(kind, feature);
        if let Some(tree) = state.tree(kind) {
            let query = PairQuery {
                a: (&probe.tree, &Placement::IDENTITY),
                b: (tree, &placement),
                one_body: false,
                threshold: Threshold::LARGEST,
                keep: Some(&counts),
                moved: [Dirty::All; 2],
                shares_mesh: false,
            };
            find_closest(&query, closest, |pair| (slot, pair.b), &Watch::none());
        }
        Ok(())
    }

    /// The closest pairs of features; of bodies with themselves too, if `own`.
    fn contacts_by_distance(
        &mut self,
        mut closest: Closest<Key>,
        own: bool,
        watch: &Watch<'_>,
    ) -> Result<Vec<(Contact, Proximity)>, Error> {
        self.settle();
        if own {
            let records = self.pairs.iter().map(|(_, record)| record.bodies);
            let alone: Vec<u32> = records.filter(|[a, b]| a == b).map(|[a, _]| a).collect();
            for slot in alone {
                if !watch.ask(0) {
                    self.closest_in_order([slot; 2], &mut closest, watch)?;
                }
            }
        }
        self.with_tree(|tree, world| {
            tree.closest_pairs(reach(&closest), |a, b| {
                if watch.ask(0) {
                    return Ok(f64::NEG_INFINITY);
                }
                let (gap, least) = (world.gap(a, b), ([a.min(b), a.max(b)], Pair::default()));
                if world.collides(a, b) && gap <= closest.bound() && !closest.excludes(gap, least) {
                    world.closest_of([a, b], &mut closest, watch)?;
                }
                Ok::<_, Error>(reach(&closest))
            })
        })?;
        Ok(self.as_contacts(closest))
    }

    /// Adds the closest features of two different bodies.
    fn closest_of(
        &mut self,
        bodies: [u32; 2],
        closest: &mut Closest<Key>,
        watch: &Watch<'_>,
    ) -> Result<(), Error> {
        let [a, b] = bodies;
        let (kind_a, kind_b) = self.feature_kinds();
        let bodies = if kind_a == kind_b {
            [a.min(b), a.max(b)]
        } else {
            bodies
        };
        self.closest_in_order(bodies, closest, watch)?;
        if kind_a != kind_b {
            self.closest_in_order([b, a], closest, watch)?;
        }
        Ok(())
    }

    /// Of features of the first kind of the first body, and of the second kind of the second.
    fn closest_in_order(
        &mut self,
        bodies: [u32; 2],
        closest: &mut Closest<Key>,
        watch: &Watch<'_>,
    ) -> Result<(), Error> {
        self.ensure_trees(bodies)?;
        let [one, two] = bodies.map(|slot| self.state(slot));
        let filter = PairFilter::new(self.kind, one.state(), two.state(), bodies[0] == bodies[1]);
        let keep = |i: u32, j: u32| filter.keeps(Pair { a: i, b: j });
        let places = self.places(bodies);
        if let Some(query) = self.pair_query(bodies, &places, Threshold::LARGEST, &filter, &keep) {
            find_closest(&query, closest, |pair| (bodies, pair), watch);
        }
        Ok(())
    }

    fn as_contacts(&self, closest: Closest<Key>) -> Vec<(Contact, Proximity)> {
        let found = closest.into_sorted().into_iter();
        let contacts = found.map(|found| {
            let (bodies, pair) = found.key;
            let [body_a, body_b] = bodies.map(|slot| self.id(slot));
            let contact = Contact {
                body_a,
                body_b,
                a: pair.a,
                b: pair.b,
            };
            (contact, self.proximity_of(bodies, pair))
        });
        contacts.collect()
    }

    /// A lower bound of the distance of two bodies, by their boxes.
    fn gap(&self, a: u32, b: u32) -> f64 {
        let (a, b) = (self.state(a).bounds(), self.state(b).bounds());
        let side = |k: usize| (b.min[k] - a.max[k]).max(a.min[k] - b.max[k]).max(0.0);
        side(0).hypot(side(1)).hypot(side(2)) * (1.0 - 1e-12)
    }
}

/// A point as a tree of one vertex.
struct Probe {
    tree: FeatureTree,
}

impl Probe {
    fn new(point: Point) -> Result<Self, Error> {
        let mesh = Mesh::new(vec![point], Vec::new(), Vec::new())?;
        Ok(Self {
            tree: FeatureTree::new(&mesh, FeatureKind::Vertex),
        })
    }
}

/// The distance up to which results matter; negative if none do.
fn reach<T: Ord + Copy>(closest: &Closest<T>) -> f64 {
    if closest.is_settled() {
        f64::NEG_INFINITY
    } else {
        closest.bound()
    }
}

//! rapier3d's broad phase over colliders without bodies: they are moved, and it is updated.

use rapier3d::geometry::{BroadPhasePairEvent, DefaultBroadPhase};
use rapier3d::prelude::*;

use crate::peers;

/// Colliders, the broad phase and the number of pairs that its events tell.
pub(crate) struct Rapier {
    parameters: IntegrationParameters,
    colliders: ColliderSet,
    bodies: RigidBodySet,
    handles: Vec<ColliderHandle>,
    broad_phase: DefaultBroadPhase,
    moved: Vec<ColliderHandle>,
    events: Vec<BroadPhasePairEvent>,
    pairs: usize,
}

impl Rapier {
    /// Boxes of these half sides, which are those of the meshes, at these places. Pairs are kept for boxes closer than .01.
    pub(crate) fn new(bodies: impl Iterator<Item = (f64, [f64; 3])>) -> Self {
        let mut colliders = ColliderSet::new();
        // pairs of colliders without bodies are left out by default
        let collider = |(half, centre): (f64, [f64; 3])| {
            ColliderBuilder::cuboid(half as f32, half as f32, half as f32)
                .position(peers::pose(centre, 0.0))
                .active_collision_types(ActiveCollisionTypes::all())
                .sensor(true)
        };
        let handles: Vec<_> = bodies.map(|body| colliders.insert(collider(body))).collect();
        let parameters = IntegrationParameters {
            dt: 0.0,
            normalized_prediction_distance: 0.01,
            ..Default::default()
        };
        // a whole step of an empty broad phase, so that the colliders do not count as new any more
        let mut bodies = RigidBodySet::new();
        CollisionPipeline::new().step(
            0.01,
            &mut IslandManager::new(),
            &mut DefaultBroadPhase::new(),
            &mut NarrowPhase::new(),
            &mut bodies,
            &mut colliders,
            &(),
            &(),
        );
        let mut rapier = Self {
            parameters,
            colliders,
            bodies,
            moved: handles.clone(),
            handles,
            broad_phase: DefaultBroadPhase::new(),
            events: Vec::new(),
            pairs: 0,
        };
        for &handle in &rapier.handles {
            // marks the collider as moved
            if let Some(collider) = rapier.colliders.get_mut(handle) {
                collider.set_position(*collider.position());
            }
        }
        rapier.update();
        rapier
    }

    /// Moves some colliders and brings the pairs up to date. Returns how many there are.
    pub(crate) fn follow(&mut self, poses: &[Pose], moved: &[usize]) -> usize {
        if moved.is_empty() {
            return self.pairs;
        }
        self.moved.clear();
        for &body in moved {
            let handle = self.handles[body];
            if let Some(collider) = self.colliders.get_mut(handle) {
                collider.set_position(poses[body]);
            }
            self.moved.push(handle);
        }
        self.update();
        self.pairs
    }

    fn update(&mut self) {
        self.events.clear();
        self.broad_phase.update(
            &self.parameters,
            &self.colliders,
            &self.bodies,
            &self.moved,
            &[],
            &mut self.events,
        );
        for event in &self.events {
            match event {
                BroadPhasePairEvent::AddPair(_) => self.pairs += 1,
                BroadPhasePairEvent::DeletePair(_) => self.pairs -= 1,
            }
        }
    }
}

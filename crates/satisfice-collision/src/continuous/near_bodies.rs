//! Which bodies of a step come near another one: only their features can be in a pair.

use super::body_order::{InOrder, lay_out};
use super::boxes::{BoxFrame, EVERYWHERE, MovingBox};
use super::tree::MovingTree;
use crate::broad::order_by_median;

/// The boxes around the bodies of a step, and a tree over them.
#[derive(Debug)]
pub(super) struct BodyBoxes {
    boxes: Vec<MovingBox>,
    tree: MovingTree,
}

impl BodyBoxes {
    /// Around bodies whose vertices begin at these numbers. Cost: O(n) for n vertices and O(b log b) for b bodies.
    pub(super) fn new(frame: &BoxFrame, first_vertices: &[usize]) -> Self {
        let ends = first_vertices.iter().skip(1).copied();
        let boxes: Vec<MovingBox> = first_vertices
            .iter()
            .zip(ends.chain([frame.vertices()]))
            .map(|(&first, end)| frame.box_around(first..end))
            .collect();
        let corners = frame.of_corners(&boxes);
        let order = order_by_median(boxes.iter().map(MovingBox::centre), false);
        let all = InOrder {
            body: 0,
            collides_with_itself: true,
            centre: [0.0; 3],
            first: 0,
            order: &order,
        };
        let tree = MovingTree::new(&corners, |body| [2 * body, 2 * body + 1], lay_out(&[all]));
        Self { boxes, tree }
    }

    pub(super) fn of(&self, body: u32) -> &MovingBox {
        &self.boxes[body as usize]
    }

    /// The bodies whose boxes come within a margin of another body's box, and those that collide with themselves, in the order of their
    /// numbers; all bodies if the margin is [`EVERYWHERE`].
    pub(super) fn near(&self, margin: f32, collides_with_itself: impl Fn(u32) -> bool) -> Vec<u32> {
        let mut stack = Vec::new();
        let mut is_near = |&body: &u32| {
            margin >= EVERYWHERE || collides_with_itself(body) || self.meets_another(body, margin, &mut stack)
        };
        (0..self.boxes.len() as u32)
            .filter(|body| is_near(body))
            .collect()
    }

    fn meets_another(&self, body: u32, margin: f32, stack: &mut Vec<(u8, u32)>) -> bool {
        let grown = self.of(body).grown(margin);
        let mut meets = false;
        self.tree
            .visit_features(&grown, stack, &mut |other| meets |= other != body);
        meets
    }
}

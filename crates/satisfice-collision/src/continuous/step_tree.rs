//! A tree that is kept from one motion to the next.

use std::sync::Arc;

use super::body_order::{InOrder, lay_out};
use super::boxes::BoxFrame;
use super::near_bodies::BodyBoxes;
use super::tree::MovingTree;
use crate::broad::order_by_median;

/// The tree over the features of a list that can be in a pair, which are those of near bodies.
#[derive(Debug, Default)]
pub(super) struct StepTree {
    tree: Option<Arc<MovingTree>>,
    /// The margin that the tree's bodies were chosen for; `None` if that was for an earlier motion, whose boxes the tree still has.
    reach: Option<f32>,
    /// By body, those of the bodies that have been near.
    orders: Vec<Option<BodyOrder>>,
}

/// The order of a body's features, counted from its first one.
#[derive(Debug)]
struct BodyOrder {
    order: Vec<u32>,
    /// How large the boxes around groups were when the order was new.
    extent_when_new: f64,
}

/// The features of a list in a motion.
pub(super) struct ListInMotion<'s, C> {
    pub(super) frame: &'s BoxFrame,
    pub(super) boxes: &'s BodyBoxes,
    /// The first feature of each body, and the number of all features.
    pub(super) first: Vec<u32>,
    /// By body.
    pub(super) collides_with_itself: Vec<bool>,
    /// The vertices of a feature.
    pub(super) corners: C,
}

/// An order is given up once the boxes around its groups have grown by this factor.
const LOOSE: f64 = 1.5;

impl StepTree {
    /// The bodies have moved on.
    pub(super) fn move_on(&mut self) {
        self.reach = None;
    }

    /// The tree for pairs within a margin: the one that there is if it serves, fitted to the motion, or one made anew.
    pub(super) fn get<const N: usize, C>(&mut self, of: &ListInMotion<'_, C>, margin: f32) -> Arc<MovingTree>
    where
        C: Fn(u32) -> [u32; N],
    {
        if let (Some(tree), Some(reach)) = (&self.tree, self.reach)
            && reach >= margin
        {
            return Arc::clone(tree);
        }
        let near = of
            .boxes
            .near(margin, |body| of.collides_with_itself[body as usize]);
        let fits = self.reach.is_some();
        let kept = self
            .tree
            .take()
            .filter(|tree| tree.is_of(&near))
            .and_then(|tree| {
                if fits {
                    return Some(tree);
                }
                let tree = Arc::into_inner(tree)?.refitted::<N>(of.frame);
                (!tree.is_loose(of.frame, LOOSE)).then(|| Arc::new(tree))
            });
        let tree = kept.unwrap_or_else(|| Arc::new(self.build(of, &near)));
        self.reach = Some(margin);
        self.tree = Some(Arc::clone(&tree));
        tree
    }

    /// The tree over the features of these bodies. A body has the order that it had in the last tree, unless it has become loose.
    fn build<const N: usize, C>(&mut self, of: &ListInMotion<'_, C>, near: &[u32]) -> MovingTree
    where
        C: Fn(u32) -> [u32; N],
    {
        self.orders.resize_with(of.collides_with_itself.len(), || None);
        let known: Vec<u32> = near
            .iter()
            .copied()
            .filter(|&body| self.orders[body as usize].is_some())
            .collect();
        let tree = self.laid_out(of, near);
        let loose = |body: &&u32| {
            let order = self.orders[**body as usize].as_ref();
            order.is_some_and(|order| tree.extent_of(of.frame, **body) > LOOSE * order.extent_when_new)
        };
        let loose: Vec<u32> = known.iter().filter(loose).copied().collect();
        if loose.is_empty() {
            return tree;
        }
        for body in loose {
            self.orders[body as usize] = None;
        }
        self.laid_out(of, near)
    }

    /// The tree over the features of these bodies, in the orders that are known and new ones for the others.
    fn laid_out<const N: usize, C>(&mut self, of: &ListInMotion<'_, C>, near: &[u32]) -> MovingTree
    where
        C: Fn(u32) -> [u32; N],
    {
        let mut new = Vec::new();
        for &body in near {
            let order = &mut self.orders[body as usize];
            if order.is_none() {
                let middles = of
                    .features(body)
                    .map(|feature| of.frame.middle((of.corners)(feature)));
                *order = Some(BodyOrder {
                    order: order_by_median(middles, false),
                    extent_when_new: f64::INFINITY,
                });
                new.push(body);
            }
        }
        let in_order = |&body: &u32| {
            self.orders[body as usize].as_ref().map(|order| InOrder {
                body,
                collides_with_itself: of.collides_with_itself[body as usize],
                centre: of.boxes.of(body).centre(),
                first: of.features(body).start,
                order: &order.order,
            })
        };
        let bodies: Vec<InOrder<'_>> = near.iter().filter_map(in_order).collect();
        let tree = MovingTree::new(of.frame, &of.corners, lay_out(&bodies));
        for body in new {
            if let Some(order) = &mut self.orders[body as usize] {
                order.extent_when_new = tree.extent_of(of.frame, body);
            }
        }
        tree
    }
}

impl<C> ListInMotion<'_, C> {
    fn features(&self, body: u32) -> std::ops::Range<u32> {
        self.first[body as usize]..self.first[body as usize + 1]
    }
}

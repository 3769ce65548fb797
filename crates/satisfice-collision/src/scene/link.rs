//! A pair of bodies, what is known about it from the last frame, and its enumeration.

use std::sync::atomic::{AtomicU64, Ordering};

use super::body::Motion;
use super::kept::Kept;
use super::measured::Measured;
use super::state::State;
use super::{Contact, Scene, Skips};
use crate::Error;
use crate::FeatureKind;
use crate::broad::{Couple, Method, Moved, Pair, Watch, inflate, intersection};
use crate::distance::{self, PairKind, Proximity, Threshold};

/// A list is made with a margin of so many frames' motion.
const FRAMES: f64 = 6.0;
/// Up to so many pairs, deciding all of them is cheaper than any structure (2 ns to 200 ns a pair).
const FEW: usize = 256;
/// From this share of moved vertices on, a new grid beats a tree that has to be built for it.
const MOST_MOVED: f64 = 0.3;

/// A pair of bodies, or a body with itself.
pub(super) struct Link {
    pub(super) a: usize,
    pub(super) b: usize,
    /// The pairs of the frame `seen`, sorted.
    pub(super) pairs: Vec<Pair>,
    pub(super) seen: Option<u64>,
    skin: Option<Skin>,
    pub(super) kept: Kept,
    pub(super) measured: Measured,
}

/// Every pair that was within the threshold plus a margin; complete while the bodies have not used the margin up.
struct Skin {
    pairs: Vec<Pair>,
    rest: f64,
    seen: u64,
}

impl Link {
    pub(super) fn contact(&self, pair: Pair) -> Contact {
        Contact {
            body_a: self.a,
            body_b: self.b,
            a: pair.a,
            b: pair.b,
        }
    }

    /// The pairs have been set from elsewhere; they are those of the frame `seen`, or only likely ones.
    pub(super) fn forget(&mut self, seen: Option<u64>) {
        self.seen = seen;
        self.skin = None;
        self.measured.frame = None;
    }

    /// Nothing has moved up to this frame: all that is known holds.
    pub(super) fn rested(&mut self, frame: u64) {
        if self.measured.frame == self.seen {
            self.measured.frame = Some(frame);
        }
        if let Some(skin) = &mut self.skin {
            skin.seen = frame;
        }
        self.seen = Some(frame);
    }
}

impl Scene {
    /// Lists the pairs of bodies that may collide. Kinds with two different features look both ways.
    pub(super) fn link(&mut self) {
        let old = std::mem::take(&mut self.links);
        self.filtered = 0;
        self.linked = true;
        self.answers += 1;
        let (kind_a, kind_b) = self.kind.features();
        for a in 0..self.states.len() {
            for b in 0..self.states.len() {
                if a > b && kind_a == kind_b {
                    continue;
                }
                let (one, two) = (&self.states[a].body, &self.states[b].body);
                let wanted = if a == b {
                    if one.motion != Motion::Deforming {
                        continue;
                    }
                    one.ring.is_some()
                } else {
                    one.groups & two.mask != 0 && two.groups & one.mask != 0
                };
                if wanted && !self.excluded.contains(&(a.min(b), a.max(b))) {
                    self.links.push(Link {
                        a,
                        b,
                        pairs: Vec::new(),
                        seen: None,
                        skin: None,
                        kept: Kept::default(),
                        measured: Measured::default(),
                    });
                } else {
                    self.filtered += u64::from(a <= b);
                }
            }
        }
        for link in old {
            if let Some(new) = self
                .links
                .iter_mut()
                .find(|new| (new.a, new.b) == (link.a, link.b))
            {
                *new = link;
            }
        }
    }

    /// Whether the pairs that are known are those of the present frame, since nothing has moved.
    pub(super) fn is_at_rest(&self, link: &Link) -> bool {
        let unmoved = |body: usize| self.states[body].moved == Moved::None;
        let last = self.frame.checked_sub(1);
        link.seen == Some(self.frame)
            || (last.is_some() && link.seen == last && unmoved(link.a) && unmoved(link.b))
    }

    /// Brings the pairs of a link up to the present frame; some of them, if the watch stops it.
    pub(super) fn enumerate(&mut self, at: usize, skips: &mut Skips, watch: &Watch<'_>) -> Result<(), Error> {
        let frame = self.frame;
        self.answers += 1;
        let at_rest = self.is_at_rest(&self.links[at]);
        let link = &mut self.links[at];
        let (a, b) = (&self.states[link.a], &self.states[link.b]);
        let last = link.seen == frame.checked_sub(1) && frame > 0;
        if at_rest {
            skips.unmoved_bodies += 1;
            link.rested(frame);
            return Ok(());
        }
        if link.a != link.b && intersection(&a.bounds, &inflate(&b.bounds, self.threshold.get())).is_none() {
            skips.boxes_apart += 1;
            link.pairs.clear();
            link.skin = None;
            link.seen = Some(frame);
            return Ok(());
        }
        let motion = if link.a == link.b {
            2.0 * a.motion
        } else {
            a.motion + b.motion
        };
        if let Some(pairs) = self.by_what_is_kept(at, last, skips)? {
            let link = &mut self.links[at];
            (link.pairs, link.skin, link.seen) = (pairs, None, Some(frame));
            return Ok(());
        }
        let link = &mut self.links[at];
        let holds = link.skin.as_mut().is_some_and(|skin| {
            skin.rest -= motion;
            let next = skin.seen + 1 == frame;
            skin.seen = frame;
            next && skin.rest > 0.0
        });
        if holds && let Some(skin) = link.skin.take() {
            skips.skin_lists += 1;
            let link = &self.links[at];
            let pairs: Vec<Pair> = skin
                .pairs
                .iter()
                .copied()
                .filter(|&pair| self.decide(link, pair))
                .collect();
            let link = &mut self.links[at];
            (link.pairs, link.skin, link.seen) = (pairs, Some(skin), Some(frame));
            return Ok(());
        }
        // a list pays if it will hold for some frames and is not much longer than the answer
        let margin = FRAMES * motion;
        let delta = self.threshold.get();
        if last
            && motion > 0.0
            && margin <= delta / 2.0
            && let Ok(wide) = Threshold::new((delta + margin) * (1.0 + 1e-9))
        {
            let pairs = self.all_pairs(at, wide, false, skips, watch)?;
            let link = &self.links[at];
            let near: Vec<Pair> = pairs
                .iter()
                .copied()
                .filter(|&pair| self.decide(link, pair))
                .collect();
            let link = &mut self.links[at];
            link.pairs = near;
            link.skin = Some(Skin {
                pairs,
                rest: margin,
                seen: frame,
            });
        } else {
            self.links[at].skin = None;
            let pairs = self.all_pairs(at, self.threshold, last, skips, watch)?;
            self.links[at].pairs = pairs;
        }
        self.links[at].seen = Some(frame);
        if watch.stopped() {
            self.links[at].forget(None);
        }
        Ok(())
    }

    /// All pairs of a link by the cheapest method. If `last`, the link's pairs are those of the last frame, and those of which
    /// nothing moved may be kept.
    fn all_pairs(
        &mut self,
        at: usize,
        threshold: Threshold,
        last: bool,
        skips: &mut Skips,
        watch: &Watch<'_>,
    ) -> Result<Vec<Pair>, Error> {
        let (a, b) = (self.links[at].a, self.links[at].b);
        let of_one = a == b && self.method == Method::Auto;
        let method = match self.choose(at) {
            Method::Grid if of_one && self.links[at].kept.wants_tree() => {
                if self.states[a].was_shaken() {
                    self.links[at].kept.does_without_tree();
                    Method::Grid
                } else {
                    Method::Tree
                }
            }
            chosen => chosen,
        };
        let near = Near::default();
        if method == Method::Grid {
            self.states[a].pose();
            self.states[b].pose();
            let (one, two) = (&self.states[a], &self.states[b]);
            let pairs = if a == b {
                self.grid
                    .within_until(one.posed(), one.runs(), threshold, watch)?
            } else {
                self.grid
                    .between_until(one.posed(), two.posed(), threshold, watch)?
            };
            self.links[at].kept.found(pairs.len(), one.vertices.len());
            let pairs = if filters(one, two, a == b) {
                let keeps = |pair: &Pair| keeps(self.kind, one, two, a == b, *pair, &near);
                let mut kept = Vec::with_capacity(pairs.len());
                kept.extend(pairs.iter().copied().filter(keeps));
                kept
            } else {
                pairs.to_vec()
            };
            let work = self.grid.work();
            skips.outside_overlap += work.clipped;
            skips.without_partner += work.lonely;
            near.count(skips);
            return Ok(pairs);
        }
        self.ready(a, b)?;
        let (one, two) = (&self.states[a], &self.states[b]);
        let (kind_a, kind_b) = self.kind.features();
        let moved = [one.marks(kind_a), two.marks(kind_b)];
        let partial = last && method == Method::Tree && moved != [Moved::All; 2];
        let keep = |i: u32, j: u32| keeps(self.kind, one, two, a == b, Pair { a: i, b: j }, &near);
        let Some(mut couple) = couple(self.kind, one, two, a == b, threshold, &keep) else {
            return Ok(Vec::new());
        };
        if partial {
            couple.moved = moved;
        }
        let mut pairs = if method == Method::BruteForce {
            self.join.brute_force(&couple, watch).to_vec()
        } else {
            self.join.all(&couple, watch).to_vec()
        };
        if of_one && pairs.len() > one.vertices.len() {
            self.links[at].kept.found(pairs.len(), one.vertices.len());
        }
        if partial {
            let found = pairs.len();
            let at_rest = |pair: &Pair| !has_moved(one, kind_a, pair.a) && !has_moved(two, kind_b, pair.b);
            pairs.extend(self.links[at].pairs.iter().copied().filter(at_rest));
            skips.unmoved_pairs += (pairs.len() - found) as u64;
            pairs.sort_unstable();
        }
        near.count(skips);
        Ok(pairs)
    }

    /// The cost model. A grid costs 20 to 60 ns a vertex each time; a tree 200 ns a feature once, 8 to 15 ns a refit, and then only
    /// what is near. So: a grid for a first look and for vertices most of which moved, a tree for everything that stays; and for
    /// a body with itself as [`Kept::wants_tree`] says.
    pub(super) fn choose(&self, at: usize) -> Method {
        let Link { a, b, seen, .. } = self.links[at];
        let (one, two) = (&self.states[a], &self.states[b]);
        let points = self.kind == PairKind::VertexVertex;
        let (kind_a, kind_b) = self.kind.features();
        let churns = |state: &State| state.body.motion == Motion::Deforming && state.share > MOST_MOVED;
        match self.method {
            Method::Grid if !points => Method::Tree,
            Method::Auto if one.count(kind_a).saturating_mul(two.count(kind_b)) <= FEW => Method::BruteForce,
            Method::Auto if points && (seen.is_none() || churns(one) || churns(two)) => Method::Grid,
            Method::Auto => Method::Tree,
            chosen => chosen,
        }
    }

    /// Builds or refits the trees of a pair of bodies.
    pub(super) fn ready(&mut self, a: usize, b: usize) -> Result<(), Error> {
        let (kind_a, kind_b) = self.kind.features();
        self.states[a].ready(kind_a)?;
        self.states[b].ready(kind_b)
    }

    /// The links, those with most pairs first.
    pub(super) fn order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.links.len()).collect();
        order.sort_by_key(|&at| (std::cmp::Reverse(self.links[at].pairs.len()), at));
        order
    }

    /// Whether a pair of features is within the threshold now: the exact decision.
    pub(super) fn decide(&self, link: &Link, pair: Pair) -> bool {
        let (a, b) = (&self.states[link.a], &self.states[link.b]);
        let (kind_a, kind_b) = self.kind.features();
        distance::within(&a.shape(kind_a, pair.a), &b.shape(kind_b, pair.b), self.threshold)
    }

    /// Distance and closest points; the features exist.
    pub(super) fn proximity_of(&self, contact: Contact) -> Proximity {
        let (a, b) = (&self.states[contact.body_a], &self.states[contact.body_b]);
        let (kind_a, kind_b) = self.kind.features();
        distance::proximity(&a.shape(kind_a, contact.a), &b.shape(kind_b, contact.b))
    }
}

/// What is asked of two bodies whose trees are ready.
pub(super) fn couple<'a>(
    kind: PairKind,
    a: &'a State,
    b: &'a State,
    one_body: bool,
    threshold: Threshold,
    keep: &'a (dyn Fn(u32, u32) -> bool + Sync),
) -> Option<Couple<'a>> {
    let (kind_a, kind_b) = kind.features();
    Some(Couple {
        a: (a.tree(kind_a)?, &a.placement),
        b: (b.tree(kind_b)?, &b.placement),
        one_body: one_body && kind_a == kind_b,
        threshold,
        keep: filters(a, b, one_body).then_some(keep),
        moved: [Moved::All; 2],
    })
}

fn has_moved(state: &State, kind: FeatureKind, feature: u32) -> bool {
    match state.marks(kind) {
        Moved::None => false,
        Moved::All => true,
        Moved::Marked => state.tree(kind).is_none_or(|tree| tree.has_moved(feature)),
    }
}

/// Near pairs that a filter left out.
#[derive(Default)]
pub(super) struct Near {
    neighbours: AtomicU64,
    filtered: AtomicU64,
}

impl Near {
    pub(super) fn count(&self, skips: &mut Skips) {
        skips.mesh_neighbours += self.neighbours.load(Ordering::Relaxed);
        skips.filtered_vertices += self.filtered.load(Ordering::Relaxed);
    }
}

/// Whether any pair of features can be left out.
pub(super) fn filters(a: &State, b: &State, one_body: bool) -> bool {
    one_body || a.body.kept.is_some() || b.body.kept.is_some()
}

/// Whether a pair of features counts.
pub(super) fn keeps(kind: PairKind, a: &State, b: &State, one_body: bool, pair: Pair, near: &Near) -> bool {
    if kind == PairKind::VertexVertex && one_body && a.body.kept.is_none() {
        let around = a.rings.as_ref().map_or(&[][..], |rings| rings.neighbours(pair.a));
        let close = pair.a == pair.b || around.contains(&pair.b);
        near.neighbours.fetch_add(u64::from(close), Ordering::Relaxed);
        return !close;
    }
    let (kind_a, kind_b) = kind.features();
    let (corners_a, corners_b) = (a.corners_of(kind_a, pair.a), b.corners_of(kind_b, pair.b));
    let counts = |state: &State, corners: &[u32; 3]| {
        state
            .body
            .kept
            .as_ref()
            .is_none_or(|kept| corners.iter().all(|&v| kept[v as usize]))
    };
    if !counts(a, &corners_a) || !counts(b, &corners_b) {
        near.filtered.fetch_add(1, Ordering::Relaxed);
        return false;
    }
    if one_body {
        let close = |v: u32, w: u32| v == w || a.rings.as_ref().is_some_and(|rings| rings.contains(v, w));
        if corners_a.iter().any(|&v| corners_b.iter().any(|&w| close(v, w))) {
            near.neighbours.fetch_add(1, Ordering::Relaxed);
            return false;
        }
    }
    true
}

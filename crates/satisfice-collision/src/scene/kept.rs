//! Pairs of vertices of a deforming body by what is kept from frame to frame: a grid of a body that stays, a list of its own.

use super::body::Motion;
use super::link::{Near, filters, keeps};
use super::near::NearList;
use super::{Scene, Skips};
use crate::Error;
use crate::broad::{FixedGrid, Method, Pair};
use crate::distance::PairKind;

/// A list is made if in the last frame the vertices of a body moved less than this among themselves, in margins of the list:
/// about that share of them has to be looked up in every frame.
const CALM: f64 = 0.1;
/// Frames for which a list that did not pay is not tried again, at first and at last: trying costs as much as a few frames.
const PAUSES: [u32; 2] = [32, 1024];

/// What is kept of a pair of bodies.
#[derive(Default)]
pub(super) struct Kept {
    grid: Option<FixedGrid>,
    list: Option<NearList>,
    /// Frames until a list is tried again, and how long it was left alone last.
    pause: u32,
    last_pause: u32,
    /// Frames in a row that a new grid has enumerated with few pairs among many vertices, and after how many more than usual a
    /// tree is made.
    sparse: u32,
    patience: u32,
}

/// After so many frames in which a new grid found fewer pairs than there are vertices a tree is made: it takes the time of some
/// grids, and its refits half of that of a grid (cloth-ball: 1.3 against 2.7 ms). With more pairs than vertices both take as long.
const SPARSE: u32 = 3;

impl Kept {
    /// A new grid has found `pairs` among so many vertices of one body.
    pub(super) fn found(&mut self, pairs: usize, vertices: usize) {
        self.sparse = if pairs < vertices {
            self.sparse.saturating_add(1)
        } else {
            0
        };
    }

    /// Whether a tree pays that is refitted in every frame.
    pub(super) fn wants_tree(&self) -> bool {
        self.sparse >= SPARSE + self.patience
    }

    /// The tree had to be built anew again and again: it is not tried for some time, each time longer.
    pub(super) fn does_without_tree(&mut self) {
        self.sparse = 0;
        self.patience = (2 * self.patience).clamp(PAUSES[0], PAUSES[1]);
    }
}

impl Scene {
    /// The pairs of a link of vertices one of whose bodies deforms, if anything is kept that is cheaper than a new grid.
    ///
    /// # Errors
    /// As [`Scene::contacts`].
    pub(super) fn by_what_is_kept(
        &mut self,
        at: usize,
        last: bool,
        skips: &mut Skips,
    ) -> Result<Option<Vec<Pair>>, Error> {
        if self.method != Method::Auto || self.kind != PairKind::VertexVertex {
            return Ok(None);
        }
        let (a, b) = (self.links[at].a, self.links[at].b);
        match [a, b].map(|body| self.states[body].body.motion) {
            [Motion::Deforming, Motion::Deforming] if a == b => Ok(self.by_list(at, last, skips)),
            [Motion::Deforming, Motion::Fixed] => self.by_fixed_grid(at, [a, b], skips),
            [Motion::Fixed, Motion::Deforming] => self.by_fixed_grid(at, [b, a], skips),
            _ => Ok(None),
        }
    }

    fn by_fixed_grid(
        &mut self,
        at: usize,
        [mover, stayer]: [usize; 2],
        skips: &mut Skips,
    ) -> Result<Option<Vec<Pair>>, Error> {
        if self.choose(at) != Method::Grid {
            return Ok(None);
        }
        self.states[stayer].pose();
        let (one, two) = (&self.states[mover], &self.states[stayer]);
        let is_first = self.links[at].seen.is_none();
        let kept = &mut self.links[at].kept;
        if kept.grid.is_none() {
            // It costs as much as several grids of a frame, so that a scene of one frame does without.
            if is_first {
                return Ok(None);
            }
            kept.grid = FixedGrid::new(two.posed(), self.threshold)?;
        }
        let Some(grid) = &kept.grid else { return Ok(None) };
        grid.look_up(one.posed(), two.posed(), &mut self.found);
        skips.outside_overlap += self.found.clipped;
        skips.without_partner += self.found.lonely;
        let mut pairs = Vec::new();
        let found = std::iter::once(self.found.pairs.as_slice());
        self.sorter.sort(found, &mut pairs, 1);
        if filters(one, two, false) {
            let near = Near::default();
            pairs.retain(|pair| keeps(self.kind, one, two, false, *pair, &near));
            near.count(skips);
        }
        if self.links[at].a == stayer {
            pairs = pairs
                .into_iter()
                .map(|Pair { a, b }| Pair { a: b, b: a })
                .collect();
            pairs.sort_unstable();
        }
        Ok(Some(pairs))
    }

    fn by_list(&mut self, at: usize, last: bool, skips: &mut Skips) -> Option<Vec<Pair>> {
        let body = self.links[at].a;
        let mut kept = std::mem::take(&mut self.links[at].kept);
        if kept.list.is_none() {
            let moved = self.states[body].agitation / NearList::margin(self.threshold);
            let waits = kept.pause > 0;
            kept.pause = kept.pause.saturating_sub(1);
            if waits || moved > CALM || !last || self.choose(at) != Method::Grid {
                self.links[at].kept = kept;
                return None;
            }
        }
        let (state, near) = (&self.states[body], Near::default());
        let keep = |a: u32, b: u32| keeps(self.kind, state, state, true, Pair { a, b }, &near);
        let points = state.posed();
        if let Some(list) = &mut kept.list {
            if list.follow(points, &keep) {
                skips.skin_lists += 1;
            } else {
                kept.list = None;
            }
        } else {
            kept.list = NearList::new(self.threshold, points, &keep);
        }
        let pairs = kept.list.as_mut().map(|list| {
            let found = &mut self.found.pairs;
            found.clear();
            list.pairs(points, |v, w| {
                found.push(Pair {
                    a: v.min(w),
                    b: v.max(w),
                });
            });
            let mut pairs = Vec::new();
            let found = std::iter::once(found.as_slice());
            self.sorter.sort(found, &mut pairs, 1);
            pairs
        });
        if pairs.is_none() {
            kept.last_pause = (2 * kept.last_pause).clamp(PAUSES[0], PAUSES[1]);
            kept.pause = kept.last_pause;
        }
        near.count(skips);
        self.links[at].kept = kept;
        pairs
    }
}

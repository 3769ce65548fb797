//! Which pairs of features count: not those of neighbours on a mesh, nor those of excluded vertices.

use std::sync::atomic::{AtomicU64, Ordering};

use super::Skips;
use super::state::State;
use crate::Adjacency;
use crate::broad::Pair;
use crate::distance::PairKind;

/// Two bodies, or one twice, and the near pairs of their features that were left out.
pub(super) struct PairFilter<'a> {
    kind: PairKind,
    a: &'a State,
    b: &'a State,
    one_body: bool,
    rings: Option<&'a Adjacency>,
    neighbours: AtomicU64,
    filtered: AtomicU64,
}

impl<'a> PairFilter<'a> {
    pub(super) fn new(kind: PairKind, a: &'a State, b: &'a State, one_body: bool) -> Self {
        Self {
            kind,
            a,
            b,
            one_body,
            rings: a
                .deforming
                .as_ref()
                .and_then(|deforming| deforming.rings.as_ref()),
            neighbours: AtomicU64::new(0),
            filtered: AtomicU64::new(0),
        }
    }

    /// Whether the filter rejects any pair.
    pub(super) fn is_needed(&self) -> bool {
        self.one_body || self.a.counted.is_some() || self.b.counted.is_some()
    }

    /// Whether it rejects features of one mesh that share a vertex, and nothing else.
    pub(super) fn is_by_mesh(&self) -> bool {
        self.one_body && self.rings.is_none() && self.a.counted.is_none()
    }

    /// Adds the rejected pairs to the counts of a query.
    pub(super) fn count(&self, skips: &mut Skips) {
        skips.mesh_neighbours += self.neighbours.load(Ordering::Relaxed);
        skips.filtered_vertices += self.filtered.load(Ordering::Relaxed);
    }

    /// Whether a pair of features counts.
    pub(super) fn keeps(&self, pair: Pair) -> bool {
        if self.kind == PairKind::VertexVertex && self.one_body && self.a.counted.is_none() {
            let around = self.rings.map_or(&[][..], |rings| rings.neighbours(pair.a));
            let close = pair.a == pair.b || around.contains(&pair.b);
            self.neighbours.fetch_add(u64::from(close), Ordering::Relaxed);
            return !close;
        }
        let (kind_a, kind_b) = self.kind.features();
        let corners_a = self.a.corners_of(kind_a, pair.a);
        let corners_b = self.b.corners_of(kind_b, pair.b);
        if !self.a.counts(kind_a, pair.a) || !self.b.counts(kind_b, pair.b) {
            self.filtered.fetch_add(1, Ordering::Relaxed);
            return false;
        }
        if self.one_body {
            let close = |v: u32, w: u32| v == w || self.rings.is_some_and(|rings| rings.contains(v, w));
            if corners_a.iter().any(|&v| corners_b.iter().any(|&w| close(v, w))) {
                self.neighbours.fetch_add(1, Ordering::Relaxed);
                return false;
            }
        }
        true
    }
}

//! Pairs that wait for a look: one step of the advance, which proves them free up to some time.

use std::marker::PhantomData;

use super::Separation;
use super::four::{FourHulls, FourPairs, PAIRS};
use super::hull::{ParallelogramHull, PointHull, SegmentHull, TriangleHull};
use super::step::Step;
use crate::distance::PairKind;

/// Pairs of features of one kind, looked at together when there are as many as the vector unit takes.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Looks {
    /// The kind, by its number among those that the search asks for.
    pub(super) kind: u8,
    count: usize,
    pairs: [[u32; 2]; PAIRS],
    /// The times up to which they are known to be free.
    free: [f64; PAIRS],
}

impl Looks {
    pub(super) fn add(&mut self, kind: u8, pair: [u32; 2], free: f64) {
        self.kind = kind;
        self.pairs[self.count] = pair;
        self.free[self.count] = free;
        self.count += 1;
    }

    pub(super) fn is_full(&self) -> bool {
        self.count == PAIRS
    }

    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// The pairs, each with a time up to which it is proved free.
    pub(super) fn look(
        mut self,
        step: &Step,
        kind: PairKind,
        separation: Separation,
    ) -> impl Iterator<Item = ([u32; 2], f64)> {
        for lane in self.count..PAIRS {
            self.pairs[lane] = self.pairs[0];
            self.free[lane] = self.free[0];
        }
        let free = step.free_until(kind, self.pairs, separation, self.free);
        self.pairs.into_iter().zip(free).take(self.count)
    }
}

impl Step {
    /// Times up to which a look proves pairs free of hits, if they are free up to `free`; at least that.
    fn free_until(
        &self,
        kind: PairKind,
        pairs: [[u32; 2]; PAIRS],
        separation: Separation,
        free: [f64; PAIRS],
    ) -> [f64; PAIRS] {
        let [a, b] = [0, 1].map(|side| pairs.map(|pair| pair[side]));
        let vertices = |of: [u32; PAIRS]| of.map(|v| [v]);
        let edges = |of: [u32; PAIRS]| of.map(|e| self.edges[e as usize]);
        let delta = separation.get();
        let (mut until, proved) = match kind {
            PairKind::VertexVertex => self.look::<PointHull, 1, 1, 1>(vertices(a), vertices(b), delta, free),
            PairKind::VertexEdge => self.look::<SegmentHull, 1, 2, 2>(vertices(a), edges(b), delta, free),
            PairKind::VertexTriangle | PairKind::EdgeTriangle | PairKind::TriangleTriangle => {
                let triangles = b.map(|t| self.triangles[t as usize]);
                self.look::<TriangleHull, 1, 3, 3>(vertices(a), triangles, delta, free)
            }
            PairKind::EdgeEdge => self.look::<ParallelogramHull, 2, 2, 4>(edges(a), edges(b), delta, free),
        };
        for lane in 0..PAIRS {
            if proved >> lane & 1 == 0 {
                until[lane] = self.free_until_of_one(kind, a[lane], b[lane], separation, free[lane]);
            }
        }
        until
    }

    fn look<H: FourHulls<K>, const M: usize, const N: usize, const K: usize>(
        &self,
        a: [[u32; M]; PAIRS],
        b: [[u32; N]; PAIRS],
        delta: f64,
        free: [f64; PAIRS],
    ) -> ([f64; PAIRS], u32) {
        let pairs = FourPairs::<H, M, N, K> {
            points: [&self.from, &self.to],
            a,
            b,
            delta,
            free,
            hull: PhantomData,
        };
        pairs.free_until()
    }
}

#[cfg(test)]
mod tests {
    use super::super::advance::Goal;
    use super::super::query::decide_during;
    use super::super::step::FeatureList;
    use super::*;
    use crate::distance::Point;
    use crate::{Mesh, generate};

    /// A pleated cloth whose vertices all move on their own, times a power of two.
    fn crumpled(scale: f64) -> (Mesh, Vec<Point>) {
        let cloth = generate::pleats(17, 9, 3, 0.05, 0.0).expect("a cloth");
        let mut state = 1_u64;
        let mut number = || {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let at = |p: &Point, number: &mut dyn FnMut() -> f64| p.map(|x| (x + 0.1 * number()) * scale);
        let from: Vec<Point> = cloth.vertices().iter().map(|p| at(p, &mut number)).collect();
        let to = cloth.vertices().iter().map(|p| at(p, &mut number)).collect();
        (
            Mesh::new(from, Vec::new(), cloth.triangles().to_vec()).expect("finite"),
            to,
        )
    }

    #[test]
    fn four_at_a_time_prove_what_one_does() {
        let kinds = [
            PairKind::VertexVertex,
            PairKind::VertexEdge,
            PairKind::VertexTriangle,
            PairKind::EdgeEdge,
        ];
        for (scale, delta) in [
            (1.0, 0.0),
            (1.0, 0.02),
            (2.0_f64.powi(400), 0.0),
            (2.0_f64.powi(-900), 0.0),
        ] {
            let (mesh, to) = crumpled(scale);
            let mut step = Step::new();
            step.add_deforming(&mesh, &to).expect("one topology");
            let separation = Separation::new(delta).expect("finite");
            for kind in kinds {
                let lists = Step::lists(kind).expect("a kind in motion");
                let count = |list: FeatureList| match list {
                    FeatureList::Vertices => step.from.len(),
                    FeatureList::Edges => step.edges.len(),
                    FeatureList::Triangles => step.triangles.len(),
                } as u32;
                let (m, n) = (count(lists[0]), count(lists[1]));
                let mut moved_on = 0;
                for round in 0..400_u32 {
                    let pair = |lane: u32| [(round * 4 + lane) * 7 % m, (round * 5 + lane * 3) % n];
                    let pairs = [0, 1, 2, 3].map(pair);
                    let from = [0.0, 0.0, 0.25, 0.5];
                    let until = step.free_until(kind, pairs, separation, from);
                    for lane in 0..PAIRS {
                        let [a, b] = pairs[lane];
                        let alone = step.free_until_of_one(kind, a, b, separation, from[lane]);
                        assert_eq!(until[lane].to_bits(), alone.to_bits(), "{kind} {a} {b}");
                        moved_on += u32::from(until[lane] > from[lane]);
                        let goal = Goal {
                            from: from[lane],
                            until: until[lane].min(1.0),
                            ..Goal::DECISION
                        };
                        let hits = match kind {
                            PairKind::EdgeEdge => {
                                decide_during(&step.edge(a), &step.edge(b), separation, goal)
                            }
                            PairKind::VertexVertex => {
                                decide_during(&step.vertex(a), &step.vertex(b), separation, goal)
                            }
                            PairKind::VertexEdge => {
                                decide_during(&step.vertex(a), &step.edge(b), separation, goal)
                            }
                            _ => decide_during(&step.vertex(a), &step.triangle(b), separation, goal),
                        };
                        let hits = hits.expect("no deadline");
                        let ends_where_it_began = until[lane] == from[lane];
                        assert!(
                            ends_where_it_began || !hits.within,
                            "{kind} {a} {b} until {}",
                            until[lane]
                        );
                    }
                }
                // the smallest scale is left to integers
                assert_eq!(moved_on > 1000, scale > 1e-250, "{kind}: {moved_on}");
            }
        }
    }
}

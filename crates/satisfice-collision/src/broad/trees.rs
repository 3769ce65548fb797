//! All pairs of features within a threshold, by kept box trees of posed bodies.

use super::boxes::{BoxTree, Dirty};
use super::features::FeatureTree;
use super::pair::Pair;
use super::pair_query::{Keep, PairQuery, Visitor};
use super::sorting::Sorter;
use super::traverse::{TreeWork, Trees, Visit};
use super::watch::Watch;
use crate::distance::Threshold;
use crate::{Error, Placement};

/// Decisions of a row of brute force between two calls of the watch.
const LOOK: usize = 1 << 12;
/// Visits between two calls of the watch: each of two leaves may have 64 candidates.
const VISITS: usize = 1 << 9;
/// Lists of so many pairs are handed over, and not copied.
const LONG: usize = 1 << 16;

/// Finds pairs of features of kept trees. Keeps its memory from call to call.
///
/// ```
/// use satisfice_collision::broad::{FeatureTree, TreeJoin};
/// use satisfice_collision::distance::Threshold;
/// use satisfice_collision::{FeatureKind, Placement, generate};
/// let ball = FeatureTree::new(&generate::icosphere(1.0, 2)?, FeatureKind::Triangle);
/// let beside = Placement::from_translation([2.05, 0.0, 0.0])?;
/// let mut join = TreeJoin::new();
/// let near = join.between((&ball, &Placement::IDENTITY), (&ball, &beside), Threshold::new(0.1)?, None)?;
/// assert!(!near.is_empty());
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[derive(Debug, Default)]
pub struct TreeJoin {
    threads: usize,
    tasks: Vec<Task>,
    sorter: Sorter,
    pairs: Vec<Pair>,
    work: TreeWork,
}

#[derive(Debug, Default)]
struct Task {
    stack: Vec<Visit>,
    found: Vec<Pair>,
    work: TreeWork,
}

impl TreeJoin {
    /// Works on one thread.
    #[must_use]
    pub fn new() -> Self {
        Self {
            threads: 1,
            ..Self::default()
        }
    }

    /// Works on the current rayon pool. The result is the same.
    #[must_use]
    pub fn parallel() -> Self {
        Self {
            threads: rayon::current_num_threads(),
            ..Self::default()
        }
    }

    /// The work of the last call.
    #[must_use]
    pub fn work(&self) -> TreeWork {
        self.work
    }

    /// All pairs of a feature of `a`, posed, and one of `b`, posed, that are within the threshold and kept, by number.
    /// The distance is that of the posed coordinates as [`Placement::apply`] rounds them.
    ///
    /// # Errors
    /// [`Error::NonFiniteVertex`] if a pose takes a vertex out of range.
    pub fn between(
        &mut self,
        a: (&FeatureTree, &Placement),
        b: (&FeatureTree, &Placement),
        threshold: Threshold,
        keep: Keep<'_>,
    ) -> Result<&[Pair], Error> {
        let query = PairQuery {
            a,
            b,
            one_body: false,
            threshold,
            keep,
            moved: [Dirty::All; 2],
            shares_mesh: false,
        };
        query.check()?;
        self.all(&query, &Watch::none());
        Ok(&self.pairs)
    }

    /// All pairs `i < j` of features of one body at its last refit that are within the threshold and kept.
    pub fn within(&mut self, body: &FeatureTree, threshold: Threshold, keep: Keep<'_>) -> &[Pair] {
        let body = (body, &Placement::IDENTITY);
        let query = PairQuery {
            a: body,
            b: body,
            one_body: true,
            threshold,
            keep,
            moved: [Dirty::All; 2],
            shares_mesh: false,
        };
        self.all(&query, &Watch::none());
        &self.pairs
    }

    /// The answer of [`Self::all`] without a tree, for comparison or for a handful of features: every pair is decided.
    pub(crate) fn brute_force(&mut self, query: &PairQuery<'_>, watch: &Watch<'_>) -> &[Pair] {
        self.pairs.clear();
        self.work = TreeWork::default();
        let (rows, others) = (query.a.0.len() as u32, query.b.0.len() as u32);
        let decide_row = |a: u32, found: &mut Vec<Pair>| {
            let mut decisions = 0_u64;
            let first = if query.one_body { a + 1 } else { 0 };
            for block in (first..others).step_by(LOOK) {
                let told = found.len();
                for b in block..others.min(block.saturating_add(LOOK as u32)) {
                    if query.keeps(a, b) {
                        decisions += 1;
                        if query.within(a, b) {
                            found.push(Pair { a, b });
                        }
                    }
                }
                if watch.ask(found.len() - told) {
                    break;
                }
            }
            decisions
        };
        if self.threads < 2 || u64::from(rows) * u64::from(others) < 1 << 16 {
            for a in (0..rows).take_while(|_| !watch.stopped()) {
                self.work.decisions += decide_row(a, &mut self.pairs);
            }
            return &self.pairs;
        }
        use rayon::prelude::*;
        let rows = (0..rows).into_par_iter().map(|a| {
            let mut found = Vec::new();
            let decisions = if watch.stopped() {
                0
            } else {
                decide_row(a, &mut found)
            };
            (found, decisions)
        });
        // in order of rows, for any number of threads
        for (found, decisions) in rows.collect::<Vec<_>>() {
            self.pairs.extend(found);
            self.work.decisions += decisions;
        }
        &self.pairs
    }

    /// The pairs of the last call, for the caller to keep.
    pub(crate) fn take_pairs(&mut self) -> Vec<Pair> {
        let is_full = self.pairs.capacity() - self.pairs.len() <= self.pairs.len() / 8;
        if self.pairs.len() >= LONG && is_full {
            return std::mem::take(&mut self.pairs);
        }
        self.pairs.clone()
    }

    /// All pairs of a query, or those found before the watch stops it.
    pub(crate) fn all(&mut self, query: &PairQuery<'_>, watch: &Watch<'_>) -> &[Pair] {
        if query.apart() {
            self.work = TreeWork::default();
            self.pairs.clear();
        } else if query.points() {
            query.in_common_frame(|trees, flip| self.descend::<true>(trees, query, flip, watch));
        } else {
            query.in_common_frame(|trees, flip| self.descend::<false>(trees, query, flip, watch));
        }
        &self.pairs
    }

    fn descend<const POINTS: bool>(
        &mut self,
        trees: Trees<'_>,
        query: &PairQuery<'_>,
        flip: bool,
        watch: &Watch<'_>,
    ) {
        let axes = query.separating_axes(&trees, flip);
        let go = |task: &mut Task, most: usize| {
            let Task { stack, found, work } = task;
            let mut visit = Visitor::<POINTS>::new(query, flip, found, axes);
            let more = visit.descend(trees, stack, most);
            work.visits += more.visits;
            work.candidates += more.candidates;
            work.decisions += more.decisions;
            work.neighbours += more.neighbours;
        };
        let go_on = |task: &mut Task| {
            let mut told = task.found.len();
            while !task.stack.is_empty() && !watch.stopped() {
                go(task, VISITS);
                watch.ask(task.found.len() - told);
                told = task.found.len();
            }
        };
        if self.tasks.is_empty() {
            self.tasks.push(Task::default());
        }
        for task in &mut self.tasks {
            task.found.clear();
            task.stack.clear();
            task.work = TreeWork::default();
        }
        trees.start(&mut self.tasks[0].stack);
        let big = |tree: &BoxTree| tree.len() > 4096;
        if self.threads > 1 && (big(trees.a) || big(trees.b)) {
            // breadth first, until there are enough tasks to share
            let tasks = self.threads * 16;
            let mut open = std::mem::take(&mut self.tasks[0].stack);
            let mut next = Vec::new();
            while !open.is_empty() && open.len() < tasks * 4 {
                for visit in open.drain(..) {
                    self.tasks[0].stack.push(visit);
                    go(&mut self.tasks[0], 1);
                    next.append(&mut self.tasks[0].stack);
                }
                std::mem::swap(&mut open, &mut next);
            }
            self.tasks.resize_with(tasks.max(self.tasks.len()), Task::default);
            let count = self.tasks.len();
            for (at, visit) in open.into_iter().enumerate() {
                self.tasks[at % count].stack.push(visit);
            }
            use rayon::prelude::*;
            self.tasks.par_iter_mut().for_each(go_on);
        } else {
            go_on(&mut self.tasks[0]);
        }
        self.work = TreeWork::default();
        for Task { work, .. } in &self.tasks {
            self.work.visits += work.visits;
            self.work.candidates += work.candidates;
            self.work.decisions += work.decisions;
            self.work.neighbours += work.neighbours;
        }
        let found = self.tasks.iter().map(|task| task.found.as_slice());
        self.sorter.sort(found, &mut self.pairs);
    }
}

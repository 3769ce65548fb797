//! All pairs of points within a threshold, of two bodies or within one: exact and sorted.

use super::boxes::Dirty;
use super::cells::{Cells, Sorted};
use super::clip::{BlockBounds, Clip, ClippedPart, union};
use super::exact::ExactTest;
use super::features::FeatureTree;
use super::frame::{Filter, LocalFrame};
use super::join::{DenseCell, Join, Scratch};
use super::occupancy::OccupancyCull;
use super::overlap::OverlapFinder;
use super::pair::Pair;
use super::pair_query::PairQuery;
use super::sorting::Sorter;
use super::trees::TreeJoin;
use super::watch::Watch;
use crate::distance::Threshold;
use crate::simd::dispatch;
use crate::{Error, FeatureKind, Mesh, Placement};

/// From this many points on, threads share the work: waking one takes as long as hundreds of points.
const SHARED: usize = 1 << 15;

/// Runs both, in parallel if `shared`.
fn both<A: Send, B: Send>(
    shared: bool,
    one: impl FnOnce() -> A + Send,
    two: impl FnOnce() -> B + Send,
) -> (A, B) {
    if shared {
        rayon::join(one, two)
    } else {
        (one(), two())
    }
}

/// The work of an enumeration.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PointWork {
    /// Points of both bodies outside the overlap of the inflated boxes.
    pub clipped: u64,
    /// Points inside the overlap with no point of the other body nearby.
    pub isolated: u64,
    /// Squared distances computed.
    pub tests: u64,
    /// Pairs so close to the threshold that they were decided exactly.
    pub in_band: u64,
}

/// Finds all pairs of points within a threshold by a uniform grid that is clipped to the overlap of the two bodies.
/// Keeps its memory from call to call.
///
/// ```
/// use satisfice_collision::broad::{Pair, PointGrid};
/// use satisfice_collision::distance::Threshold;
/// let (a, b) = ([[0.0, 0.0, 0.0], [5.0, 0.0, 0.0]], [[0.5, 0.0, 0.0], [9.0, 0.0, 0.0]]);
/// let mut grid = PointGrid::new();
/// assert_eq!(grid.between(&a, &b, Threshold::new(1.0)?)?, [Pair { a: 0, b: 0 }]);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[derive(Debug, Default)]
pub struct PointGrid {
    threads: usize,
    runs: [BlockBounds; 2],
    overlap: OverlapFinder,
    parts: [Vec<ClippedPart>; 2],
    cull: OccupancyCull,
    sorted: [Sorted; 2],
    tasks: Vec<Scratch>,
    sorter: Sorter,
    pairs: Vec<Pair>,
    work: PointWork,
}

impl PointGrid {
    /// A grid that works on one thread.
    #[must_use]
    pub fn new() -> Self {
        Self {
            threads: 1,
            ..Self::default()
        }
    }

    /// A grid that works on the current rayon pool. The result is the same.
    #[must_use]
    pub fn parallel() -> Self {
        Self {
            threads: rayon::current_num_threads(),
            ..Self::default()
        }
    }

    /// The work of the last call.
    #[must_use]
    pub fn work(&self) -> PointWork {
        self.work
    }

    /// All pairs `(i, j)` with `|a[i] - b[j]| < threshold`, sorted by `i`, then `j`.
    ///
    /// # Errors
    /// [`Error::NonFiniteVertex`]; [`Error::TooManyVertices`].
    ///
    /// Cost: O(points + tests), the tests of a body's surface being proportional to the pairs.
    pub fn between(
        &mut self,
        a: &[[f64; 3]],
        b: &[[f64; 3]],
        threshold: Threshold,
    ) -> Result<&[Pair], Error> {
        self.between_until(a, b, threshold, &Watch::none())
    }

    /// All pairs `i < j` with `|points[i] - points[j]| < threshold`, sorted by `i`, then `j`.
    ///
    /// # Errors
    /// As [`PointGrid::between`].
    pub fn within(&mut self, points: &[[f64; 3]], threshold: Threshold) -> Result<&[Pair], Error> {
        self.within_until(points, None, threshold, &Watch::none())
    }

    /// [`PointGrid::between`], until the watch stops it.
    pub(crate) fn between_until(
        &mut self,
        a: &[[f64; 3]],
        b: &[[f64; 3]],
        threshold: Threshold,
        watch: &Watch<'_>,
    ) -> Result<&[Pair], Error> {
        self.run::<false>(a, b, None, threshold, watch)?;
        Ok(&self.pairs)
    }

    /// [`PointGrid::within`], until the watch stops it; `measured` are the bounds of the points, if known.
    pub(crate) fn within_until(
        &mut self,
        points: &[[f64; 3]],
        measured: Option<&BlockBounds>,
        threshold: Threshold,
        watch: &Watch<'_>,
    ) -> Result<&[Pair], Error> {
        self.run::<true>(points, points, measured, threshold, watch)?;
        Ok(&self.pairs)
    }

    fn run<const ONE_BODY: bool>(
        &mut self,
        a: &[[f64; 3]],
        b: &[[f64; 3]],
        measured: Option<&BlockBounds>,
        threshold: Threshold,
        watch: &Watch<'_>,
    ) -> Result<(), Error> {
        self.pairs.clear();
        self.work = PointWork::default();
        for points in [a, b] {
            if u32::try_from(points.len()).is_err() {
                return Err(Error::TooManyVertices {
                    vertices: points.len(),
                });
            }
        }
        let (threads, shared) = (self.threads, self.threads > 1 && a.len() + b.len() >= SHARED);
        let [runs_a, runs_b] = &mut self.runs;
        let (one, two) = both(
            shared && !ONE_BODY,
            || match measured {
                Some(runs) => {
                    runs_a.copy(runs);
                    Ok(())
                }
                None => runs_a.measure(a, threads),
            },
            || {
                if ONE_BODY {
                    Ok(())
                } else {
                    runs_b.measure(b, threads)
                }
            },
        );
        one.and(two)?;
        let Some(frame) = self.clip::<ONE_BODY>(a, b, threshold) else {
            self.work.clipped = if ONE_BODY { a.len() } else { a.len() + b.len() } as u64;
            return Ok(());
        };
        let kept = |parts: &[ClippedPart]| parts.iter().map(|part| part.points.len()).sum::<usize>();
        let (na, nb) = (kept(&self.parts[0]), kept(&self.parts[1]));
        self.work.clipped = if ONE_BODY {
            a.len() - na
        } else {
            a.len() + b.len() - na - nb
        } as u64
            - self.work.isolated;
        if na == 0 || (!ONE_BODY && nb == 0) {
            return Ok(());
        }
        let filter = frame.filter(threshold.get());
        let cells = Cells::fitting(&self.parts[0], filter.reach);
        let ([sorted_a, sorted_b], [parts_a, parts_b]) = (&mut self.sorted, &self.parts);
        both(
            shared && !ONE_BODY,
            || sorted_a.sort(parts_a, &cells, threads),
            || {
                if !ONE_BODY {
                    sorted_b.sort(parts_b, &cells, threads);
                }
            },
        );
        let decide = ExactTest { a, b, threshold };
        let tasks = self.join::<ONE_BODY>(&cells, &filter, &decide, watch);
        for task in 0..tasks {
            for dense in std::mem::take(&mut self.tasks[task].dense_cells) {
                if watch.stopped() {
                    break;
                }
                self.join_dense_cell::<ONE_BODY>(&decide, task, &dense, watch)?;
            }
            self.work.tests += self.tasks[task].tests;
            self.work.in_band += self.tasks[task].in_band;
        }
        let found = self.tasks[..tasks].iter().map(|task| task.found.as_slice());
        self.sorter.sort(found, &mut self.pairs);
        Ok(())
    }

    /// Places the points of both bodies that may be near the other in a common frame; `None` if there are none.
    fn clip<const ONE_BODY: bool>(
        &mut self,
        a: &[[f64; 3]],
        b: &[[f64; 3]],
        threshold: Threshold,
    ) -> Option<LocalFrame> {
        let Self {
            runs: [runs_a, runs_b],
            overlap,
            parts: [parts_a, parts_b],
            cull,
            threads,
            ..
        } = self;
        if ONE_BODY {
            let region = &runs_a.whole()?;
            let frame = &LocalFrame::for_threshold(region, threshold.get());
            let [inside, _] = &mut overlap.runs;
            runs_a.inside(region, inside);
            Clip {
                points: a,
                runs: runs_a,
                inside,
                region,
                frame,
            }
            .place(parts_a, *threads);
            return Some(*frame);
        }
        let regions = overlap.find(runs_a, runs_b, threshold.get())?;
        let [inside_a, inside_b] = &overlap.runs;
        let frame = &LocalFrame::for_threshold(&union(&regions[0], &regions[1]), threshold.get());
        let clip = |points, runs, inside, region, parts: &mut Vec<ClippedPart>| {
            Clip {
                points,
                runs,
                inside,
                region,
                frame,
            }
            .place(parts, *threads);
        };
        both(
            *threads > 1 && a.len() + b.len() >= SHARED,
            || clip(a, &*runs_a, inside_a, &regions[0], parts_a),
            || clip(b, &*runs_b, inside_b, &regions[1], parts_b),
        );
        let reach = frame.filter(threshold.get()).reach;
        self.work.isolated = cull.cull(parts_a, parts_b, reach, *threads) as u64;
        Some(*frame)
    }

    fn join<const ONE_BODY: bool>(
        &mut self,
        cells: &Cells,
        filter: &Filter,
        decide: &ExactTest<'_>,
        watch: &Watch<'_>,
    ) -> usize {
        let a = &self.sorted[0];
        let b = if ONE_BODY { a } else { &self.sorted[1] };
        let layers = cells.count()[2];
        let points = a.start[a.start.len() - 1] as usize;
        let tasks = if self.threads < 2 || points < SHARED / 8 {
            1
        } else {
            (self.threads * 8).min(layers)
        };
        self.tasks
            .resize_with(tasks.max(self.tasks.len()), Scratch::default);
        let bound = |task: usize| layers * task / tasks;
        let run = |(task, scratch): (usize, &mut Scratch)| {
            scratch.clear();
            let layers = bound(task)..bound(task + 1);
            dispatch(Join::<ONE_BODY> {
                a,
                b,
                cells,
                filter,
                decide,
                layers,
                watch,
                scratch,
            });
        };
        if tasks == 1 {
            run((0, &mut self.tasks[0]));
        } else {
            use rayon::prelude::*;
            self.tasks[..tasks]
                .par_iter_mut()
                .enumerate()
                .for_each(|(task, scratch)| run((task, scratch)));
        }
        tasks
    }

    /// Finds the pairs of a dense cell by trees.
    fn join_dense_cell<const ONE_BODY: bool>(
        &mut self,
        decide: &ExactTest<'_>,
        task: usize,
        DenseCell { a: own, b: others }: &DenseCell,
        watch: &Watch<'_>,
    ) -> Result<(), Error> {
        let tree = |ids: &[u32], points: &[[f64; 3]]| {
            let vertices = ids.iter().map(|&id| points[id as usize]).collect();
            Mesh::new(vertices, vec![], vec![]).map(|mesh| FeatureTree::new(&mesh, FeatureKind::Vertex))
        };
        let tree_a = tree(own, decide.a)?;
        let mut join = TreeJoin::new();
        let mut find = |tree_b: &FeatureTree, ids: &[u32], one_body: bool| {
            let query = PairQuery {
                a: (&tree_a, &Placement::IDENTITY),
                b: (tree_b, &Placement::IDENTITY),
                one_body,
                threshold: decide.threshold,
                keep: None,
                moved: [Dirty::All; 2],
                shares_mesh: false,
            };
            let pairs = join.all(&query, watch).iter().map(|pair| {
                let (a, b) = (own[pair.a as usize], ids[pair.b as usize]);
                if ONE_BODY && a > b {
                    Pair { a: b, b: a }
                } else {
                    Pair { a, b }
                }
            });
            self.tasks[task].found.extend(pairs);
            let work = join.work();
            // a visit compares eight points with eight
            self.work.tests += 64 * work.visits;
            self.work.in_band += work.decisions;
        };
        if ONE_BODY {
            find(&tree_a, own, true);
        }
        if !others.is_empty() {
            find(&tree(others, decide.b)?, others, false);
        }
        Ok(())
    }
}

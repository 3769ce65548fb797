//! All pairs of a step that come within delta.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc;
use std::time::Duration;

use super::advance::Goal;
use super::boxes::LANES;
use super::deadline::Deadline;
use super::meetings::{Meet, ONCE, ONCE_APART, PairBits, pairs};
use super::step::{FeatureList, MovingContact, Step};
use super::tree::{MIXED, MovingTree};
use super::{DecidedBy, Separation};
use crate::Error;
use crate::distance::PairKind;

/// The pairs that hit during a step, and how they were found.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Hits {
    /// The pairs, in ascending order.
    pub pairs: Vec<MovingContact>,
    /// Pairs whose boxes meet, all decided by their motion.
    pub candidates: u64,
    /// How many of the candidates integers decided; floating point decided the others.
    pub by_integers: u64,
    /// How many pairs of features are not decided because the run was stopped. With 0 the list is complete.
    pub undecided: u64,
}

/// The features of a kind and their trees.
struct PairSearch<'s> {
    step: &'s Step,
    kind: PairKind,
    lists: [FeatureList; 2],
    trees: [&'s MovingTree; 2],
    separation: Separation,
    margin: f32,
}

/// What a row of groups has found; features by their numbers in the common lists.
#[derive(Default)]
struct FoundPairs {
    pairs: Vec<[u32; 2]>,
    candidates: u64,
    by_integers: u64,
    /// Pairs whose decision was left because the run was stopped.
    undecided: u64,
}

/// How often the thread that has no work left asks whether to stop the others.
const LOOK: Duration = Duration::from_millis(5);

/// Groups that a thread searches at a time, between two looks at the stop condition; a multiple of eight.
const ROWS: u32 = 16;

impl Step {
    /// All pairs of a kind that come nearer than delta during the step, or touch for a delta of 0. Uses the threads of the
    /// current rayon pool.
    ///
    /// Candidates are decided one by one and never stored. Cost: about 100 ns a candidate, far more
    /// where rounding decides nothing (see [`decide`](super::decide)).
    ///
    /// # Errors
    /// [`Error::Parameter`] for the kinds edge-triangle and triangle-triangle.
    pub fn hits(&self, kind: PairKind, separation: Separation) -> Result<Hits, Error> {
        self.hits_until(kind, separation, &mut || false)
    }

    /// The same, until `stop` says so, which is asked after every few hundred features, and during decisions by integers that take long.
    ///
    /// # Errors
    /// As [`hits`](Self::hits).
    pub fn hits_until(
        &self,
        kind: PairKind,
        separation: Separation,
        stop: &mut dyn FnMut() -> bool,
    ) -> Result<Hits, Error> {
        let mut pairs = Vec::new();
        let counts = self.each_hit(kind, separation, stop, &mut |contact| pairs.push(contact))?;
        pairs.sort_unstable();
        Ok(Hits { pairs, ..counts })
    }

    /// Hands each pair that hits to `visit` and keeps none: `pairs` of the result is empty. The order of the visits is the same on any
    /// number of threads, but not that of the features. Apart from that as [`hits_until`](Self::hits_until).
    ///
    /// ```
    /// use satisfice_collision::continuous::{Separation, Step};
    /// use satisfice_collision::distance::PairKind;
    /// use satisfice_collision::generate;
    /// let ball = generate::icosphere(0.2, 1)?;
    /// let lifted: Vec<_> = ball.vertices().iter().map(|&[x, y, z]| [x, y, z + 0.5]).collect();
    /// let mut step = Step::new();
    /// step.add_rigid(&ball, ball.vertices())?;
    /// step.add_rigid(&ball, &lifted)?;
    /// let mut count = 0;
    /// step.each_hit(PairKind::EdgeEdge, Separation::TOUCHING, &mut || false, &mut |_| count += 1)?;
    /// assert_eq!(count, step.hits(PairKind::EdgeEdge, Separation::TOUCHING)?.pairs.len());
    /// # Ok::<(), satisfice_collision::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`hits`](Self::hits).
    pub fn each_hit(
        &self,
        kind: PairKind,
        separation: Separation,
        stop: &mut dyn FnMut() -> bool,
        visit: &mut dyn FnMut(MovingContact),
    ) -> Result<Hits, Error> {
        let lists = Self::lists(kind)?;
        let margin = self.margin(separation.get());
        let [a, b] = lists.map(|list| self.tree(list, margin));
        let search = PairSearch {
            step: self,
            kind,
            lists,
            trees: [a.as_ref(), b.as_ref()],
            separation,
            margin,
        };
        Ok(search.run(stop, visit))
    }
}

impl PairSearch<'_> {
    /// Hands out rows to the threads in turn, and what they find to `visit` in the order of the rows.
    fn run(&self, stop: &mut dyn FnMut() -> bool, visit: &mut dyn FnMut(MovingContact)) -> Hits {
        let rows = self.trees[0].order.len().div_ceil(LANES) as u32;
        let (next, is_stopped) = (AtomicU32::new(0), AtomicBool::new(false));
        let work = |deadline: Deadline<'_>| {
            let first = next.fetch_add(ROWS, Ordering::Relaxed);
            (first < rows).then(|| (first, self.rows(first..rows.min(first + ROWS), deadline)))
        };
        // A yes is final, and for all threads.
        let is_over = || is_stopped.load(Ordering::Relaxed);
        let stop = RefCell::new(stop);
        let asked = || {
            if !is_over() && (stop.borrow_mut())() {
                is_stopped.store(true, Ordering::Relaxed);
            }
            is_over()
        };
        let (sender, receiver) = mpsc::channel();
        let mut hits = Hits::default();
        let mut early: BTreeMap<u32, FoundPairs> = BTreeMap::new();
        let mut due = 0;
        let mut deliver = |part: (u32, FoundPairs), hits: &mut Hits| {
            early.insert(part.0, part.1);
            while let Some(found) = early.remove(&due) {
                self.take(hits, &found, visit);
                due += ROWS;
            }
            due
        };
        rayon::in_place_scope(|scope| {
            for _ in 1..rayon::current_num_threads() {
                let (sender, work, is_over) = (sender.clone(), &work, &is_over);
                scope.spawn(move |_| {
                    while !is_over()
                        && let Some(part) = work(Deadline::until(is_over))
                        && sender.send(part).is_ok()
                    {}
                });
            }
            drop(sender);
            let mut due = 0;
            while !asked() {
                let part = match work(Deadline::until(&asked)) {
                    Some(part) => part,
                    None if due >= rows => return,
                    // another thread may decide a pair that takes long
                    None => match receiver.recv_timeout(LOOK) {
                        Ok(part) => part,
                        Err(mpsc::RecvTimeoutError::Timeout) => continue,
                        Err(mpsc::RecvTimeoutError::Disconnected) => return,
                    },
                };
                due = deliver(part, &mut hits);
                for part in receiver.try_iter() {
                    due = deliver(part, &mut hits);
                }
            }
        });
        receiver.iter().for_each(|part| {
            deliver(part, &mut hits);
        });
        hits.undecided += self.pairs_from(next.into_inner().min(rows));
        hits
    }

    fn take(&self, hits: &mut Hits, found: &FoundPairs, visit: &mut dyn FnMut(MovingContact)) {
        hits.candidates += found.candidates;
        hits.by_integers += found.by_integers;
        hits.undecided += found.undecided;
        for &[a, b] in &found.pairs {
            visit(MovingContact {
                a: self.step.feature(self.lists[0], a),
                b: self.step.feature(self.lists[1], b),
            });
        }
    }

    fn is_one_list(&self) -> bool {
        self.lists[0] == self.lists[1]
    }

    /// How many pairs of features the rows from this one on have.
    fn pairs_from(&self, row: u32) -> u64 {
        let rest = self.trees[0].features_from(row as usize * LANES) as u64;
        if self.is_one_list() {
            rest * rest.saturating_sub(1) / 2
        } else {
            rest * self.trees[1].features_from(0) as u64
        }
    }

    fn rows(&self, rows: std::ops::Range<u32>, deadline: Deadline<'_>) -> FoundPairs {
        let mut found = FoundPairs::default();
        let mut stack = Vec::new();
        if self.trees.iter().all(|tree| tree.levels.len() > 1) {
            // eight rows descend together
            let lanes = LANES as u32;
            for block in rows.start / lanes..rows.end.div_ceil(lanes) {
                self.block(block, &mut stack, &mut found, deadline);
            }
            return found;
        }
        for row in rows {
            self.descend(0, row, &mut stack, &mut |group| {
                self.groups(row, group, &mut found, deadline);
            });
        }
        found
    }

    /// Visits the groups of a level of the second tree that are not apart from one of the first, each pair once.
    fn descend(&self, level: u8, of: u32, stack: &mut Vec<(u8, u32)>, visit: &mut impl FnMut(u32)) {
        let first = self.trees[0];
        let around = first.box_around(level.into(), of).grown(self.margin);
        let least = if self.is_one_list() { of } else { 0 };
        let own = first.rigid_body(level.into(), of);
        self.trees[1].visit(level, &around, least, own, stack, visit);
    }

    /// The rows below a group of level 1.
    fn block(&self, block: u32, stack: &mut Vec<(u8, u32)>, found: &mut FoundPairs, deadline: Deadline<'_>) {
        let [first, second] = self.trees;
        self.descend(1, block, stack, &mut |other| {
            let meeting = self.meet(1, block, other, ONCE);
            for [row, group] in pairs(meeting) {
                let row = block * LANES as u32 + row as u32;
                let group = other * LANES as u32 + group as u32;
                let own = first.rigid_body(0, row);
                if own == MIXED || own != second.rigid_body(0, group) {
                    self.groups(row, group, found, deadline);
                }
            }
        });
    }

    /// The pairs of boxes of two groups of a level that meet; `once` names those to ask about in a group with itself.
    fn meet(&self, level: usize, a: u32, b: u32, once: PairBits) -> PairBits {
        let [first, second] = self.trees;
        let is_same = self.is_one_list() && a == b;
        let meet = Meet {
            a: &first.levels[level][a as usize],
            b: &second.levels[level][b as usize],
            around_b: second.place_of(level, b).filter(|_| !is_same),
            margin: self.margin,
            corners: (level == 0).then(|| [first.corners(a), second.corners(b)]),
        };
        meet.pairs() & if is_same { once } else { !0 }
    }

    /// The features of a row against those of a group.
    fn groups(&self, row: u32, group: u32, found: &mut FoundPairs, deadline: Deadline<'_>) {
        let [first, second] = self.trees;
        let (own, boxes) = (&first.levels[0][row as usize], &second.levels[0][group as usize]);
        for [lane, other] in pairs(self.meet(0, row, group, ONCE_APART)) {
            let of = own.lane(lane).grown(self.margin);
            let Some(during) = boxes.lane(other).meeting(&of) else {
                continue;
            };
            let a = first.order[row as usize * LANES + lane];
            let b = second.order[group as usize * LANES + other];
            self.pair(a, b, during, found, deadline);
        }
    }

    /// Decides a pair whose boxes meet during a part of the step.
    fn pair(&self, a: u32, b: u32, [from, until]: [f64; 2], found: &mut FoundPairs, deadline: Deadline<'_>) {
        let [a, b] = if self.is_one_list() && a > b {
            [b, a]
        } else {
            [a, b]
        };
        if !self.step.may_pair_apart(self.lists, a, b) {
            return;
        }
        found.candidates += 1;
        let decided = self.step.decide(
            self.kind,
            [a, b],
            self.separation,
            Goal {
                from,
                until,
                deadline,
                ..Goal::DECISION
            },
        );
        let Ok(decided) = decided else {
            found.undecided += 1;
            return;
        };
        found.by_integers += u64::from(decided.by == DecidedBy::Exact);
        if decided.within {
            found.pairs.push([a, b]);
        }
    }
}

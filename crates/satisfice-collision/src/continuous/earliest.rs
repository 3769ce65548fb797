//! The first impact of a step, at any time: best first, between a rising lower and a falling upper bound.
//!
//! Pairs of groups of boxes wait in the order of the first time at which their boxes meet, a lower bound of the times of their
//! impacts. A pair of features is examined once, which proves it free up to some time, and waits for that time. The first
//! impact found so far is an upper bound; a pair whose turn comes is asked about the time before it only. When the least lower
//! bound is not below the upper one, the answer is proved. So that there is an upper bound early, a pair that is proved free for half as long as
//! all before it is asked about at once.

use std::cell::RefCell;
use std::collections::BinaryHeap;

use super::Separation;
use super::advance::Goal;
use super::boxes::{LANES, MovingBox};
use super::deadline::{CutShort, Deadline};
use super::looks::Looks;
use super::meetings::{FirstTimes, Meet, ONCE, ONCE_APART, PairBits, pairs};
use super::query::Impact;
use super::step::{FeatureList, MovingContact, Step};
use super::tree::{MIXED, MovingTree};
use super::waiting::{FEATURE, GroupOrFeature, Waiting};
use crate::Error;
use crate::distance::PairKind;

/// The kinds in which surfaces, wires and points first meet.
const KINDS: [PairKind; 4] = [
    PairKind::VertexTriangle,
    PairKind::EdgeEdge,
    PairKind::VertexEdge,
    PairKind::VertexVertex,
];

/// What is known about the first impact of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Earliest {
    /// A lower and an upper bound of the first time of a hit; `[1, 1]` if there is none, `[_, 1]` if none has been found.
    pub time: [f64; 2],
    /// The pair that hits first as far as known, of which kind, and where.
    pub first: Option<(PairKind, MovingContact, Impact)>,
    /// Whether the bounds are within the tolerance, or no pair hits.
    pub is_proved: bool,
    /// Pairs of groups of features, and of features, that still waited when the run was stopped.
    pub undecided: u64,
    /// Pairs of features asked about.
    pub queries: u64,
}

/// Where both features of a kind of pairs come from.
#[derive(Clone, Copy)]
struct Sides<'s> {
    lists: [FeatureList; 2],
    trees: [&'s MovingTree; 2],
}

impl Sides<'_> {
    fn is_one_list(&self) -> bool {
        self.lists[0] == self.lists[1]
    }
}

/// The state of a search.
struct Descent<'s> {
    step: &'s Step,
    /// By kind, for those that are looked for.
    sides: [Option<Sides<'s>>; KINDS.len()],
    has_rigid_bodies: bool,
    separation: Separation,
    tolerance: f64,
    deadline: Deadline<'s>,
    margin: f32,
    waiting: BinaryHeap<Waiting>,
    /// Pairs of groups no later than `now`, which need no order.
    at_once: Vec<Waiting>,
    /// Pairs of features to be looked at, no earlier than `now`.
    looks: Looks,
    /// The time of the pair that was taken last from those that wait: all others are no earlier.
    now: f64,
    /// Half of the least time up to which a look has proved a pair free.
    soon: f64,
    best: Earliest,
    /// Of the groups compared last.
    first_times: FirstTimes,
}

impl Step {
    /// The first impact of any pair of features, its time within `tolerance` (a part of the step).
    ///
    /// For a delta of 0 vertex-triangle and edge-edge pairs cover surfaces; pairs with a vertex are searched too, for points and
    /// wires that belong to no triangle.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a tolerance that is not a number of at least 1e-12.
    pub fn earliest(&self, separation: Separation, tolerance: f64) -> Result<Earliest, Error> {
        self.earliest_until(separation, tolerance, &mut || false)
    }

    /// The same, until `stop` says so, which is asked after every few pairs of groups, and during decisions by integers that take long. The
    /// bounds are proved whenever it stops.
    ///
    /// # Errors
    /// As [`earliest`](Self::earliest).
    pub fn earliest_until(
        &self,
        separation: Separation,
        tolerance: f64,
        stop: &mut dyn FnMut() -> bool,
    ) -> Result<Earliest, Error> {
        self.earliest_among(&self.kinds(), separation, tolerance, stop)
    }

    /// The same among pairs of these kinds only.
    ///
    /// # Errors
    /// As [`earliest`](Self::earliest), and [`Error::Parameter`] for the kinds edge-triangle and triangle-triangle.
    pub fn earliest_among(
        &self,
        kinds: &[PairKind],
        separation: Separation,
        tolerance: f64,
        stop: &mut dyn FnMut() -> bool,
    ) -> Result<Earliest, Error> {
        let tolerance = Goal::checked(tolerance)?;
        let margin = self.margin(separation.get());
        let mut trees = Vec::new();
        for &kind in kinds {
            let lists = Self::lists(kind)?;
            if let Some(number) = KINDS.iter().position(|known| *known == kind) {
                trees.push((number as u8, lists, lists.map(|list| self.tree(list, margin))));
            }
        }
        let stop = RefCell::new(stop);
        let asked = || (stop.borrow_mut())();
        let mut descent = Descent {
            step: self,
            sides: [None; KINDS.len()],
            has_rigid_bodies: self.has_rigid_bodies(),
            separation,
            tolerance,
            deadline: Deadline::until(&asked),
            margin,
            waiting: BinaryHeap::new(),
            at_once: Vec::new(),
            looks: Looks::default(),
            now: 0.0,
            soon: 0.5,
            best: Earliest {
                time: [1.0, 1.0],
                first: None,
                is_proved: false,
                undecided: 0,
                queries: 0,
            },
            first_times: FirstTimes::default(),
        };
        for (number, lists, [a, b]) in &trees {
            let trees = [a.as_ref(), b.as_ref()];
            descent.start(*number, Sides { lists: *lists, trees });
        }
        Ok(descent.run(&asked))
    }

    /// A time up to which the step is proved free of hits, and which is at most 1e-6 before the first one. Above 0 whenever the
    /// start is free and there is no hit before 2^-1000; 1 if the whole step is free.
    ///
    /// # Errors
    /// None for a step that has bodies; see [`earliest`](Self::earliest).
    pub fn free_step(&self, separation: Separation) -> Result<f64, Error> {
        self.free_step_until(separation, &mut || false)
    }

    /// The same, but `stop` ends it: then it is what is proved until then. It is asked about every 16 steps of the descent.
    ///
    /// # Errors
    /// As [`earliest`](Self::earliest).
    pub fn free_step_until(
        &self,
        separation: Separation,
        stop: &mut dyn FnMut() -> bool,
    ) -> Result<f64, Error> {
        Ok(self.earliest_until(separation, 1e-6, stop)?.time[0])
    }

    /// The kinds of pairs in which the bodies of this step first meet: vertex-triangle and edge-edge for surfaces, and those
    /// with a vertex also if there are points or wires that belong to no triangle.
    #[must_use]
    pub fn kinds(&self) -> Vec<PairKind> {
        let asks_for = |kind: &PairKind| match kind {
            PairKind::VertexTriangle => !self.triangles.is_empty(),
            PairKind::EdgeEdge => !self.edges.is_empty(),
            // Of closed features the nearest points of two surfaces are those of vertex and triangle or edge and edge.
            _ => self.has_loose_vertices(),
        };
        KINDS.into_iter().filter(asks_for).collect()
    }
}

impl<'s> Descent<'s> {
    fn start(&mut self, number: u8, sides: Sides<'s>) {
        self.sides[number as usize] = Some(sides);
        let [a, b] = sides.trees;
        let root = |tree: &MovingTree| GroupOrFeature {
            level: tree.levels.len() as u8 - 1,
            group: 0,
        };
        let (a, b) = (root(a), root(b));
        self.waiting.push(Waiting {
            time: 0.0,
            kind: number,
            a,
            b,
        });
    }

    fn run(mut self, stop: &dyn Fn() -> bool) -> Earliest {
        let mut rounds = 0_u32;
        while let Some(next) = self.next() {
            rounds = rounds.wrapping_add(1);
            // a pair that is not decided is counted already
            if self.best.undecided > 0 || rounds.is_multiple_of(16) && stop() {
                let waiting = self.waiting.len() + self.at_once.len() + self.looks.len();
                self.best.undecided += waiting as u64 + 1;
                self.best.time[0] = self.best.time[0].min(self.now);
                return self.best;
            }
            let Some(sides) = self.sides[next.kind as usize] else {
                continue;
            };
            match (next.a.level, next.b.level) {
                (FEATURE, _) => self.ask(
                    KINDS[next.kind as usize],
                    sides.lists,
                    [next.a.group, next.b.group],
                    next.time,
                ),
                (0, 0) => self.look(&next, &sides),
                (a, b) if a > b => self.open_first(&next, sides.trees),
                (a, b) if b > a => self.open_second(&next, sides.trees),
                _ => self.open_both(&next, &sides),
            }
        }
        self.best.is_proved = self.best.undecided == 0;
        self.best
    }

    /// The next that waits, or `None` if the answer is proved.
    fn next(&mut self) -> Option<Waiting> {
        loop {
            if self.at_once.is_empty() {
                self.look_at_all();
            }
            if let Some(next) = self.at_once.pop() {
                if self.may_be_first(next.time) {
                    return Some(next);
                }
                continue;
            }
            let next = self.waiting.pop().filter(|next| self.may_be_first(next.time))?;
            // All that wait are later than this one, which is close enough. A bound of 0 would not say that the start is free.
            if next.time > 0.0 && !self.may_be_first(next.time + self.tolerance) {
                self.best.time[0] = self.best.time[0].min(next.time);
                return None;
            }
            self.now = next.time;
            return Some(next);
        }
    }

    /// Whether a hit at this time or later can be the first. Until one is found, even at the end of the step.
    fn may_be_first(&self, time: f64) -> bool {
        self.best.first.is_none() || time < self.best.time[1]
    }

    fn wait(&mut self, kind: u8, time: f64, a: GroupOrFeature, b: GroupOrFeature) {
        if self.may_be_first(time) && !(self.has_rigid_bodies && self.is_one_rigid_body(kind, a, b)) {
            self.push(Waiting { time, kind, a, b });
        }
    }

    fn push(&mut self, waiting: Waiting) {
        if waiting.time <= self.now {
            self.at_once.push(waiting);
        } else {
            self.waiting.push(waiting);
        }
    }

    fn is_one_rigid_body(&self, kind: u8, a: GroupOrFeature, b: GroupOrFeature) -> bool {
        self.sides[kind as usize].is_some_and(
            |Sides {
                 trees: [first, second],
                 ..
             }| {
                let body = first.rigid_body(a.level as usize, a.group);
                body != MIXED && body == second.rigid_body(b.level as usize, b.group)
            },
        )
    }

    /// Replaces the first of two groups, the one of a higher level, by its groups.
    fn open_first(&mut self, of: &Waiting, trees: [&MovingTree; 2]) {
        let other = trees[1]
            .box_around(of.b.level as usize, of.b.group)
            .grown(self.margin);
        for child in meeting(trees[0], of.a, &other) {
            self.wait(of.kind, child.time, child.node, of.b);
        }
    }

    fn open_second(&mut self, of: &Waiting, trees: [&MovingTree; 2]) {
        let other = trees[0]
            .box_around(of.a.level as usize, of.a.group)
            .grown(self.margin);
        for child in meeting(trees[1], of.b, &other) {
            self.wait(of.kind, child.time, of.a, child.node);
        }
    }

    /// Replaces both groups; each pair of groups of one list once.
    fn open_both(&mut self, of: &Waiting, sides: &Sides<'s>) {
        let child = |node: GroupOrFeature, lane: usize| GroupOrFeature {
            level: node.level - 1,
            group: node.group * LANES as u32 + lane as u32,
        };
        for [lane, other] in pairs(self.meetings(of, sides, ONCE)) {
            let time = f64::from(self.first_times[lane][other]);
            self.wait(of.kind, time, child(of.a, lane), child(of.b, other));
        }
    }

    /// The pairs of boxes of two groups that meet before the first impact known; `once` names those to ask about in a group with itself.
    fn meetings(&mut self, of: &Waiting, sides: &Sides<'s>, once: PairBits) -> PairBits {
        let [first, second] = sides.trees;
        let is_same = sides.is_one_list() && of.a == of.b;
        let (level, a, b) = (of.a.level as usize, of.a.group, of.b.group);
        let meet = Meet {
            a: &first.levels[level][a as usize],
            b: &second.levels[level][b as usize],
            around_b: second.place_of(level, b).filter(|_| !is_same),
            margin: self.margin,
            corners: (level == 0).then(|| [first.corners(a), second.corners(b)]),
        };
        let until = (self.best.time[1] as f32).next_up();
        meet.until(until, &mut self.first_times) & if is_same { once } else { !0 }
    }

    /// Looks at the pairs of features of two groups.
    fn look(&mut self, of: &Waiting, sides: &Sides<'s>) {
        let Sides { lists, trees } = *sides;
        let is_one_list = sides.is_one_list();
        for [lane, other] in pairs(self.meetings(of, sides, ONCE_APART)) {
            let time = f64::from(self.first_times[lane][other]);
            let a = trees[0].order.get(of.a.group as usize * LANES + lane);
            let b = trees[1].order.get(of.b.group as usize * LANES + other);
            if let (Some(&a), Some(&b), true) = (a, b, self.may_be_first(time)) {
                let pair = if is_one_list && a > b { [b, a] } else { [a, b] };
                self.look_at(of.kind, lists, pair, time);
            }
        }
    }

    /// Looks at a pair together with others.
    fn look_at(&mut self, number: u8, lists: [FeatureList; 2], pair: [u32; 2], time: f64) {
        let [a, b] = pair;
        if !self.step.may_pair_apart(lists, a, b) {
            return;
        }
        self.best.queries += 1;
        if time >= 1.0 {
            // boxes meet at the end of the step, from where no look can go on
            self.ask(KINDS[number as usize], lists, pair, 0.0);
            return;
        }
        if self.looks.kind != number {
            self.look_at_all();
        }
        self.looks.add(number, pair, time);
        if self.looks.is_full() {
            self.look_at_all();
        }
    }

    /// Proves pairs free up to some time, and lets them wait for that.
    fn look_at_all(&mut self) {
        let looks = std::mem::take(&mut self.looks);
        let number = looks.kind;
        if let (true, Some(sides)) = (looks.len() > 0, self.sides[number as usize]) {
            for (pair, free) in looks.look(self.step, KINDS[number as usize], self.separation) {
                self.wait_until(number, sides.lists, pair, free);
            }
        }
    }

    /// Lets a pair wait for the time up to which it is free; for the whole step, the end included, if that is 1.
    fn wait_until(&mut self, number: u8, lists: [FeatureList; 2], [a, b]: [u32; 2], free: f64) {
        if free >= self.best.time[1] {
            return;
        }
        if free < self.soon {
            self.soon = 0.5 * free;
            self.ask(KINDS[number as usize], lists, [a, b], free);
            return;
        }
        let feature = |number: u32| GroupOrFeature {
            level: FEATURE,
            group: number,
        };
        self.push(Waiting {
            time: free,
            kind: number,
            a: feature(a),
            b: feature(b),
        });
    }

    /// Asks when a pair first hits, from a time on up to which it is free.
    fn ask(&mut self, kind: PairKind, lists: [FeatureList; 2], [a, b]: [u32; 2], free: f64) {
        let goal = Goal {
            from: free,
            until: self.best.time[1],
            tolerance: self.tolerance,
            deadline: self.deadline,
        };
        let impact = match self.step.impact(kind, a, b, self.separation, goal) {
            Ok(Some(impact)) => impact,
            Ok(None) => return,
            Err(CutShort) => {
                self.best.undecided += 1;
                self.best.time[0] = self.best.time[0].min(free);
                return;
            }
        };
        self.best.time[0] = self.best.time[0].min(impact.time[0]);
        if impact.time[1] <= self.best.time[1] {
            self.best.time[1] = impact.time[1];
            let contact = MovingContact {
                a: self.step.feature(lists[0], a),
                b: self.step.feature(lists[1], b),
            };
            self.best.first = Some((kind, contact, impact));
        }
    }
}

/// A group within an opened one, and when its box first meets another box.
struct Child {
    node: GroupOrFeature,
    time: f64,
}

fn meeting(tree: &MovingTree, of: GroupOrFeature, other: &MovingBox) -> impl Iterator<Item = Child> {
    let boxes = &tree.levels[of.level as usize][of.group as usize];
    let mut mask = boxes.candidates(other);
    std::iter::from_fn(move || {
        while mask != 0 {
            let lane = mask.trailing_zeros();
            mask &= mask - 1;
            if let Some([time, _]) = boxes.lane(lane as usize).meeting(other) {
                let node = GroupOrFeature {
                    level: of.level - 1,
                    group: of.group * LANES as u32 + lane,
                };
                return Some(Child { node, time });
            }
        }
        None
    })
}

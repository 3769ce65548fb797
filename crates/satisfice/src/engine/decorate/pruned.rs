//! An engine whose points in dead regions are not evaluated: those that a lower bound excludes.

use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::exact::region_tree::{Split, Splitter};
use crate::engine::{Answers, Ask, Engine, Origin, WarmStart};
use crate::error::Error;
use crate::report::SourceCount;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::{AxisKind, Region, Space};
use crate::state::{Reader, Saved, State};

/// A live leaf is split after this many evaluations in it that were no hits.
const VISITS: u32 = 6;
/// Bounds may be asked for this share of the evaluations, and for `FREE` more.
const SHARE: u64 = 8;
const FREE: u64 = 64;
/// So often an engine is asked for a batch with a live point; after that, dead points are replaced.
const ROUNDS: usize = 32;
/// Continuous axes are not split below this share of their length.
const RESOLUTION: f64 = 1e-9;

/// A node of the tree: a leaf where it has no axis.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
struct Cell<S> {
    /// The axis that is split, its number from 1.
    axis: usize,
    /// First value of the upper half.
    at: S,
    /// The lower half; the upper one comes next.
    lower: usize,
    /// Evaluations that were no hits, of a leaf.
    visits: u32,
    dead: bool,
    /// Live share of the space.
    live: f64,
}
/// An engine and the regions that it is kept out of.
pub(in crate::engine) struct Pruned<S> {
    inner: Box<dyn Engine<S>>,
    /// The tree from its root; empty if the problem offers no bounds.
    cells: Vec<Cell<S>>,
    /// Bounds asked for.
    calls: u64,
    /// The engine's proposals, dead ones included, and which are dead.
    whole: Vec<S>,
    dead: Vec<bool>,
}

impl<S: Real> Pruned<S> {
    pub(in crate::engine) fn around(engine: Box<dyn Engine<S>>) -> Self {
        Self {
            inner: engine,
            cells: Vec::new(),
            calls: 0,
            whole: Vec::new(),
            dead: Vec::new(),
        }
    }

    fn new_cell(dead: bool, live: f64) -> Cell<S> {
        Cell {
            axis: 0,
            at: S::zero(),
            lower: 0,
            visits: 0,
            dead,
            live: if dead { 0.0 } else { live },
        }
    }

    fn excludes(&mut self, context: &dyn Context<S>, region: &Region<S>) -> bool {
        self.calls += 1;
        context
            .lower_bound(region)
            .is_some_and(|bound| bound >= context.threshold())
    }

    /// The leaf of a position that is inside, noting the way where it is wanted.
    fn leaf(&self, space: &Space<S>, position: &[S], mut way: Option<&mut Vec<usize>>) -> usize {
        let mut index = 0;
        loop {
            if let Some(way) = &mut way {
                way.push(index);
            }
            let cell = &self.cells[index];
            if cell.axis == 0 {
                return index;
            }
            let j = cell.axis - 1;
            let upper = space.axes()[j].value(position[j]) >= cell.at;
            index = cell.lower + usize::from(upper);
        }
    }

    fn region(&self, space: &Space<S>, way: &[usize]) -> Region<S> {
        let mut region = space.region();
        for pair in way.windows(2) {
            let cell = &self.cells[pair[0]];
            let j = cell.axis - 1;
            if pair[1] > cell.lower {
                region.lower[j] = cell.at;
            } else if space.axes()[j].is_integer() {
                region.upper[j] = cell.at - S::one();
            } else {
                region.upper[j] = cell.at;
            }
        }
        region
    }

    /// Notes an evaluation that was no hit, and splits its leaf if there were enough of them.
    fn visit(&mut self, context: &dyn Context<S>, position: &[S]) {
        let mut way = Vec::new();
        let leaf = self.leaf(context.space(), position, Some(&mut way));
        self.cells[leaf].visits += 1;
        let may_ask =
            self.calls + 2 <= FREE + context.evaluations() / SHARE && context.evaluations_left() > 2;
        if self.cells[leaf].visits < VISITS || !may_ask {
            return;
        }
        self.cells[leaf].visits = 0;
        let space = context.space();
        // A key of a permutation does not tell which half its rank is in.
        if space.has_permutations() {
            return;
        }
        let region = self.region(space, &way);
        let splitter = Splitter {
            first: false,
            resolution: S::of(RESOLUTION),
        };
        let Split::Halves(lower, upper) = splitter.split(space, &region) else {
            return;
        };
        let differs = |&j: &usize| lower.upper[j] != region.upper[j];
        let Some(j) = (0..space.dimension()).find(differs) else {
            return;
        };
        let cell = Cell {
            axis: j + 1,
            at: upper.lower[j],
            lower: self.cells.len(),
            ..self.cells[leaf].clone()
        };
        let length = |half: &Region<S>| {
            let length = (half.upper[j] - half.lower[j]).f64();
            length + f64::from(u8::from(space.axes()[j].is_integer()))
        };
        let share = length(&lower) / (length(&lower) + length(&upper));
        let live = [cell.live * share, cell.live * (1.0 - share)];
        self.cells[leaf] = cell;
        for (half, live) in [lower, upper].iter().zip(live) {
            let dead = self.excludes(context, half);
            self.cells.push(Self::new_cell(dead, live));
        }
        for &index in way.iter().rev() {
            let lower = self.cells[index].lower;
            let (a, b) = (&self.cells[lower], &self.cells[lower + 1]);
            let (dead, live) = (a.dead && b.dead, a.live + b.live);
            let cell = &mut self.cells[index];
            (cell.dead, cell.live) = (dead, live);
        }
    }

    /// Writes a uniform position of the live part.
    fn draw(&self, space: &Space<S>, rng: &mut SearchRng, position: &mut [S]) {
        let mut way = vec![0];
        let mut cell = &self.cells[0];
        while cell.axis != 0 {
            let [a, b] = [&self.cells[cell.lower], &self.cells[cell.lower + 1]];
            let upper = b.live > 0.0 && !b.dead && (a.dead || rng.uniform() * (a.live + b.live) >= a.live);
            way.push(cell.lower + usize::from(upper));
            cell = if upper { b } else { a };
        }
        let region = self.region(space, &way);
        for (j, (axis, x)) in space.axes().iter().zip(position).enumerate() {
            let (lower, upper) = (region.lower[j], region.upper[j]);
            let share = S::of(rng.uniform());
            *x = if axis.kind() == AxisKind::Place {
                share
            } else if axis.is_integer() {
                let values = upper - lower + S::one();
                axis.position((lower + (share * values).floor()).min(upper))
            } else {
                (lower + share * (upper - lower)).min(upper)
            };
        }
    }

    /// Sorts the engine's proposals into live ones, which go to `out`, and dead ones; returns how many live ones there are.
    fn sort(&mut self, space: &Space<S>, proposals: &mut Batch<S>, out: &mut Batch<S>) -> usize {
        self.dead.clear();
        for i in 0..proposals.len() {
            let point = proposals.point_mut(i);
            space.keep_inside(point);
            let dead = self.cells[self.leaf(space, point, None)].dead;
            self.dead.push(dead);
            if !dead {
                out.push(point);
            }
        }
        out.len()
    }
}

impl<S: Real> Engine<S> for Pruned<S> {
    fn begin(&mut self, context: &dyn Context<S>) {
        self.cells.clear();
        self.calls = 1;
        self.whole.clear();
        self.dead.clear();
        // Its cells are boxes of values and of positions at once.
        if !context.space().is_curved()
            && let Some(bound) = context.lower_bound(&context.space().region())
        {
            self.cells.push(Self::new_cell(bound >= context.threshold(), 1.0));
        }
        self.inner.begin(context);
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        match self.cells.first() {
            None => return self.inner.ask(context, rng, out),
            Some(root) if root.dead => return Ask::Covered,
            Some(_) => {}
        }
        let space = context.space();
        let mut proposals = Batch::new(space.dimension());
        for round in 0..ROUNDS {
            proposals.clear();
            let answer = self.inner.ask(context, rng, &mut proposals);
            if proposals.is_empty() {
                return answer;
            }
            if self.sort(space, &mut proposals, out) == 0 {
                if round + 1 < ROUNDS || answer != Ask::More {
                    let outcomes = vec![Outcome::NonFinite; proposals.len()];
                    self.inner.tell(context, &proposals, &outcomes, Origin::Engine);
                    if answer != Ask::More {
                        return answer;
                    }
                    continue;
                }
                for i in 0..proposals.len() {
                    self.draw(space, rng, proposals.point_mut(i));
                    out.push(proposals.point(i));
                }
                self.dead.fill(false);
            }
            self.whole.clear();
            self.whole.extend(proposals.points().flatten());
            return answer;
        }
        Ask::More
    }

    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        if self.cells.is_empty() {
            self.inner.tell(context, batch, outcomes, origin);
            return;
        }
        if origin == Origin::Engine && self.dead.contains(&true) {
            // The engine sees all its proposals: the live ones as they were evaluated, in their places.
            let mut whole = Batch::new(context.space().dimension());
            let mut all = Vec::with_capacity(self.dead.len());
            let mut next = 0;
            for (i, point) in self.whole.chunks_exact(whole.dimension()).enumerate() {
                if self.dead.get(i) == Some(&false) && next < outcomes.len() {
                    whole.push(batch.point(next));
                    all.push(outcomes[next]);
                    next += 1;
                } else {
                    whole.push(point);
                    all.push(Outcome::NonFinite);
                }
            }
            self.inner.tell(context, &whole, &all, origin);
        } else {
            self.inner.tell(context, batch, outcomes, origin);
        }
        for (point, outcome) in batch.points().zip(outcomes) {
            if matches!(outcome, Outcome::Miss(_)) {
                self.visit(context, point);
            }
        }
    }

    fn deletes(&self) -> bool {
        self.inner.deletes()
    }
    fn warm_start(&self) -> WarmStart {
        self.inner.warm_start()
    }
    fn answers(&self) -> Answers {
        self.inner.answers().in_batches()
    }
    fn probes(&self) -> f64 {
        self.inner.probes()
    }
    fn sources(&self) -> Vec<SourceCount> {
        self.inner.sources()
    }

    fn save(&self, state: &mut State) {
        self.cells.save(state);
        self.calls.save(state);
        self.whole.save(state);
        self.dead.save(state);
        self.inner.save(state);
    }

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.cells = from.read()?;
        self.calls = from.read()?;
        self.whole = from.read()?;
        self.dead = from.read()?;
        let count = self.cells.len();
        let is_tree =
            |(i, cell): (usize, &Cell<S>)| cell.axis == 0 || (cell.lower > i && cell.lower + 1 < count);
        if !self.cells.iter().enumerate().all(is_tree) {
            return Err(Error::State("a tree of regions is damaged".to_owned()));
        }
        self.inner.restore(from)
    }
}

#[cfg(test)]
mod tests;

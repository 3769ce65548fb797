//! The view that an engine has of a running search.

use core::cell::{Cell, RefCell};
use core::ops::Range;

use crate::accounting::Ledger;
use crate::archive::Archive;
use crate::budget::Budget;
use crate::capability::{Components, Encoding, Neighbourhood};
use crate::context::Context;
use crate::identity::Identity;
use crate::problem::AnyProblem;
use crate::scalar::Real;
use crate::space::{Axis, AxisKind, Region, Space};

/// Calls that engines make through a view.
#[derive(Debug, Default)]
pub(crate) struct Calls {
    pub(crate) neighbours: Cell<u64>,
    pub(crate) bounds: Cell<u64>,
}

/// Memory for one position and its solution.
#[derive(Debug)]
pub(crate) struct Scratch<S, T> {
    values: Vec<S>,
    solution: Option<T>,
    neighbour: Option<T>,
}

/// Memory not in use: a list, because an engine may ask again while it visits neighbours.
pub(crate) type Scratches<S, T> = RefCell<Vec<Scratch<S, T>>>;

pub(crate) struct View<'a, S, T> {
    pub(crate) problem: &'a AnyProblem<'a, S, T>,
    pub(crate) previous: &'a Archive<T>,
    pub(crate) ledger: &'a Ledger<T>,
    pub(crate) calls: &'a Calls,
    pub(crate) scratches: &'a Scratches<S, T>,
}

impl<S: Real, T: Identity + Clone + Send + Sync> View<'_, S, T> {
    /// Lends memory that holds the position, brought inside.
    fn with_scratch<R>(&self, position: &[S], use_it: impl FnOnce(&mut Scratch<S, T>) -> R) -> R {
        self.lend(position, |scratch| {
            self.problem.space().keep_inside(&mut scratch.values);
            use_it(scratch)
        })
    }

    /// Lends memory that holds these numbers.
    fn lend<R>(&self, numbers: &[S], use_it: impl FnOnce(&mut Scratch<S, T>) -> R) -> R {
        let free = self.scratches.borrow_mut().pop();
        let mut scratch = free.unwrap_or(Scratch {
            values: Vec::new(),
            solution: None,
            neighbour: None,
        });
        scratch.values.clear();
        scratch.values.extend_from_slice(numbers);
        let result = use_it(&mut scratch);
        self.scratches.borrow_mut().push(scratch);
        result
    }

    /// Turns the position in `scratch` into values and decodes them.
    fn decode<'s>(&self, scratch: &'s mut Scratch<S, T>) -> (&'s T, &'s mut [S]) {
        let Scratch { values, solution, .. } = scratch;
        self.problem.space().to_values(values);
        let solution = match solution {
            Some(solution) => {
                self.problem.decode_into(values, solution);
                solution
            }
            None => solution.insert(self.problem.decode(values)),
        };
        (solution, values)
    }

    /// Lets `use_it` see the problem's neighbourhood with the solution at a position, and memory for values and for a neighbour; `None`
    /// without a neighbourhood, an encoding, or values that the solution is encoded by.
    fn with_own_neighbourhood<R>(
        &self,
        of: &[S],
        use_it: impl FnOnce(&OwnNeighbourhood<'_, S, T>, &T, &mut [S], &mut Option<T>) -> R,
    ) -> Option<R> {
        let own = OwnNeighbourhood {
            neighbourhood: self.problem.neighbourhood()?,
            encoding: self.problem.encoding()?,
        };
        self.with_scratch(of, |scratch| {
            let mut neighbour = scratch.neighbour.take();
            let (solution, values) = self.decode(scratch);
            let encoded = own.encoding.encode(solution, values);
            let result = encoded.then(|| use_it(&own, solution, values, &mut neighbour));
            scratch.neighbour = neighbour;
            result
        })
    }

    /// Index `2 j` is the lattice point below on axis j, `2 j + 1` the one above, around the circle where the axis is periodic;
    /// at a place of a permutation they are swaps with the next place and the one after it. Later indices are the other
    /// categories of each categorical axis.
    fn lattice_neighbours(&self, position: &[S], indices: Range<usize>, visit: &mut dyn FnMut(usize, &[S])) {
        let axes = self.problem.space().axes();
        // The first indices are known to be there, without a look at every axis.
        let count = if indices.end <= 2 * axes.len() {
            indices.end
        } else {
            lattice_count(axes)
        };
        let indices = indices.start..indices.end.min(count);
        let moves = |index: usize| {
            axes.get(index / 2)
                .is_none_or(|axis| axis.kind() != AxisKind::Continuous)
        };
        if !indices.clone().any(moves) {
            return;
        }
        self.with_scratch(position, |scratch| {
            let neighbour = &mut scratch.values;
            for (axis, x) in axes.iter().zip(&mut *neighbour) {
                *x = axis.position(axis.value(*x));
            }
            for index in indices {
                let Some((j, way)) = lattice_move(axes, index) else {
                    continue;
                };
                if axes[j].kind() == AxisKind::Place {
                    let other = j + if way < 0 { 1 } else { 2 };
                    if axes.get(other).is_some_and(|axis| axis.follows(&axes[j])) {
                        neighbour.swap(j, other);
                        visit(index, neighbour);
                        neighbour.swap(j, other);
                    }
                } else if let Some(there) = step(&axes[j], neighbour[j], way) {
                    let here = core::mem::replace(&mut neighbour[j], there);
                    visit(index, neighbour);
                    neighbour[j] = here;
                }
            }
        });
    }
}

/// Number of indices of lattice neighbours.
fn lattice_count<S: Real>(axes: &[Axis<S>]) -> usize {
    2 * axes.len() + axes.iter().map(more_categories).sum::<usize>()
}

/// Categories beyond those that are a step away.
fn more_categories<S: Real>(axis: &Axis<S>) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a u32, whole"
    )]
    match axis.kind() {
        AxisKind::Categorical => (axis.width().f64() as usize).saturating_sub(3),
        _ => 0,
    }
}

/// The axis of an index, and by how many values it moves; `None` on continuous axes.
fn lattice_move<S: Real>(axes: &[Axis<S>], index: usize) -> Option<(usize, i64)> {
    if let Some(axis) = axes.get(index / 2) {
        let way = if index.is_multiple_of(2) { -1 } else { 1 };
        return (axis.kind() != AxisKind::Continuous).then_some((index / 2, way));
    }
    let mut more = index - 2 * axes.len();
    for (j, axis) in axes.iter().enumerate() {
        let here = more_categories(axis);
        if more < here {
            return Some((j, i64::try_from(more).ok()? + 2));
        }
        more -= here;
    }
    None
}

/// The position so many values further on an integer axis; `None` beyond its end, and where it is the same value.
fn step<S: Real>(axis: &Axis<S>, here: S, way: i64) -> Option<S> {
    #[expect(clippy::cast_precision_loss, reason = "a number of categories")]
    let there = here + S::of(way as f64);
    let there = if axis.lower() <= there && there < axis.end() {
        there
    } else if !axis.is_periodic() {
        return None;
    } else if there < axis.lower() {
        there + axis.width()
    } else {
        there - axis.width()
    };
    // Two categories are a step apart both ways: one of these is enough.
    let again = way < 0 && axis.is_periodic() && axis.width() <= S::of(2.0);
    (there != here && !again).then_some(there)
}

/// The capabilities behind a problem's own neighbours.
struct OwnNeighbourhood<'a, S, T> {
    neighbourhood: &'a dyn Neighbourhood<T>,
    encoding: &'a dyn Encoding<S, T>,
}

impl<S: Real, T: Identity + Clone + Send + Sync> Context<S> for View<'_, S, T> {
    fn space(&self) -> &Space<S> {
        self.problem.space()
    }
    fn threshold(&self) -> S {
        self.problem.threshold()
    }
    fn elapsed_share(&self) -> f64 {
        self.ledger.share()
    }
    fn evaluations(&self) -> u64 {
        self.ledger.counts.evaluations
    }
    fn hits(&self) -> usize {
        self.ledger.archive.seen()
    }
    fn is_deleted(&self, position: &[S]) -> bool {
        !self.ledger.archive.is_empty()
            && self.with_scratch(position, |scratch| {
                self.ledger.archive.contains(self.decode(scratch).0)
            })
    }
    fn neighbour_count(&self, of: &[S]) -> usize {
        self.with_own_neighbourhood(of, |own, solution, _, _| own.neighbourhood.count(solution))
            .unwrap_or_else(|| lattice_count(self.problem.space().axes()))
    }
    fn neighbours(&self, of: &[S], indices: Range<usize>, visit: &mut dyn FnMut(usize, &[S])) {
        self.calls.neighbours.set(self.calls.neighbours.get() + 1);
        let space = self.problem.space();
        let own = self.with_own_neighbourhood(of, |own, solution, values, neighbour| {
            let neighbour = neighbour.get_or_insert_with(|| solution.clone());
            for index in indices.clone() {
                if own.neighbourhood.neighbour_into(solution, index, neighbour)
                    && own.encoding.encode(neighbour, values)
                {
                    space.positions(values);
                    visit(index, values);
                }
            }
        });
        if own.is_none() {
            self.lattice_neighbours(of, indices, visit);
        }
    }
    fn component_count(&self) -> usize {
        self.problem.components().map_or(0, Components::count)
    }
    fn components(&self, position: &[S], out: &mut [S]) {
        if let Some(components) = self.problem.components() {
            self.with_scratch(position, |scratch| components.write(self.decode(scratch).0, out));
        }
    }
    fn offers_neighbours(&self) -> bool {
        self.problem.neighbourhood().is_some() && self.problem.encoding().is_some()
    }
    fn lower_bound(&self, region: &Region<S>) -> Option<S> {
        let bound = self.problem.bounds()?.lower_bound(region)?;
        self.calls.bounds.set(self.calls.bounds.get() + 1);
        Some(bound)
    }
    fn covers(&self, region: &Region<S>) -> bool {
        if self.ledger.archive.is_empty() {
            return false;
        }
        let Some(encoding) = self.problem.encoding() else {
            return false;
        };
        self.lend(&region.lower, |scratch| {
            self.problem.space().positions(&mut scratch.values);
            let (corner, _) = self.decode(scratch);
            // A hit that covers the region is the same as its corner.
            self.ledger
                .archive
                .any_same(corner, |hit| encoding.covers(hit, region))
        })
    }
    fn evaluations_left(&self) -> u64 {
        let limit = self.ledger.budget.evaluations.unwrap_or(u64::MAX);
        limit.saturating_sub(self.ledger.counts.evaluations + self.calls.bounds.get())
    }
    fn evaluations_planned(&self) -> Option<u64> {
        let Budget {
            horizon, evaluations, ..
        } = &self.ledger.budget;
        let spent = self.ledger.counts.evaluations + self.calls.bounds.get();
        horizon.or(*evaluations).map(|limit| limit.saturating_sub(spent))
    }
    fn probe_share(&self) -> f64 {
        self.ledger.probe_share
    }
    fn islands(&self) -> usize {
        self.ledger.islands
    }
    fn parallel(&self) -> usize {
        self.ledger.budget.parallel.unwrap_or(1).max(self.ledger.at_once)
    }
    fn is_in_any_order(&self) -> bool {
        self.ledger.in_any_order
    }
    fn seconds_an_evaluation(&self) -> Option<f64> {
        let seconds = || self.ledger.seconds_an_evaluation();
        self.is_timed().then(seconds).flatten()
    }
    fn is_timed(&self) -> bool {
        self.ledger.budget.is_timed()
    }
    fn seconds_planned(&self) -> Option<f64> {
        self.ledger.budget.time.map(|time| time.as_secs_f64())
    }
    fn is_out_of_time(&self) -> bool {
        self.ledger.is_out_of_time()
    }
    fn previous_hits(&self) -> usize {
        self.previous.len()
    }
    fn previous_hit(&self, index: usize, position: &mut [S]) -> bool {
        let Some(hit) = self.previous.get(index) else {
            return false;
        };
        let encoding = self.problem.encoding();
        let encoded = encoding.is_some_and(|encoding| encoding.encode(hit.solution, position));
        if encoded {
            self.problem.space().positions(position);
        }
        encoded
    }
}

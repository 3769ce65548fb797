//! What an engine sees of a running search.

use core::cell::Cell;

use crate::archive::Archive;
use crate::context::Context;
use crate::problem::SatisficingProblem;
use crate::space::{Region, Space};

/// Calls that engines make through a view.
#[derive(Debug, Default)]
pub(crate) struct Calls {
    pub(crate) neighbours: Cell<u64>,
    pub(crate) bounds: Cell<u64>,
}

pub(crate) struct View<'a, P: SatisficingProblem> {
    pub(crate) problem: &'a P,
    pub(crate) archive: &'a Archive<P::Solution>,
    pub(crate) previous: &'a Archive<P::Solution>,
    pub(crate) evaluations: u64,
    pub(crate) share: f64,
    pub(crate) calls: &'a Calls,
    /// Memory for values; taken while in use, so that nested calls get their own.
    pub(crate) scratch: &'a Cell<Vec<P::Scalar>>,
}

impl<P: SatisficingProblem> View<'_, P> {
    fn with_values<R>(&self, position: &[P::Scalar], use_them: impl FnOnce(&mut [P::Scalar]) -> R) -> R {
        let mut values = self.scratch.take();
        values.clear();
        values.extend_from_slice(position);
        self.problem.space().keep_inside(&mut values);
        if self.problem.space().has_integers() {
            for (axis, x) in self.problem.space().axes().iter().zip(&mut values) {
                *x = axis.value(*x);
            }
        }
        let result = use_them(&mut values);
        self.scratch.set(values);
        result
    }

    fn own_neighbours(&self, values: &mut [P::Scalar], visit: &mut dyn FnMut(&[P::Scalar])) -> bool {
        let solution = self.problem.decode(values);
        // Neighbours without an encoding are of no use to an engine.
        if !self.problem.encode(&solution, values) {
            return false;
        }
        let space = self.problem.space();
        self.problem.neighbours(&solution, &mut |neighbour| {
            if self.problem.encode(&neighbour, values) {
                space.positions(values);
                visit(values);
            }
        })
    }

    fn lattice_neighbours(&self, position: &[P::Scalar], visit: &mut dyn FnMut(&[P::Scalar])) -> bool {
        let space = self.problem.space();
        let mut any = false;
        self.with_values(position, |neighbour| {
            space.positions(neighbour);
            for (j, axis) in space
                .axes()
                .iter()
                .enumerate()
                .filter(|(_, axis)| axis.is_integer())
            {
                let here = neighbour[j];
                for there in [here - num_traits::one(), here + num_traits::one()] {
                    if axis.lower() <= there && there < axis.end() {
                        any = true;
                        neighbour[j] = there;
                        visit(neighbour);
                    }
                }
                neighbour[j] = here;
            }
        });
        any
    }
}

impl<P: SatisficingProblem> Context<P::Scalar> for View<'_, P> {
    fn space(&self) -> &Space<P::Scalar> {
        self.problem.space()
    }
    fn threshold(&self) -> P::Scalar {
        self.problem.threshold()
    }
    fn elapsed_share(&self) -> f64 {
        self.share
    }
    fn evaluations(&self) -> u64 {
        self.evaluations
    }
    fn hits(&self) -> usize {
        self.archive.len()
    }
    fn is_deleted(&self, position: &[P::Scalar]) -> bool {
        !self.archive.is_empty()
            && self.with_values(position, |values| {
                self.archive.contains(&self.problem.decode(values))
            })
    }
    fn neighbours(&self, of: &[P::Scalar], visit: &mut dyn FnMut(&[P::Scalar])) -> bool {
        self.calls.neighbours.set(self.calls.neighbours.get() + 1);
        self.with_values(of, |values| self.own_neighbours(values, visit))
            || self.lattice_neighbours(of, visit)
    }
    fn lower_bound(&self, region: &Region<P::Scalar>) -> Option<P::Scalar> {
        self.calls.bounds.set(self.calls.bounds.get() + 1);
        self.problem.lower_bound(region)
    }
    fn previous_hits(&self) -> usize {
        self.previous.len()
    }
    fn previous_hit(&self, index: usize, position: &mut [P::Scalar]) -> bool {
        let Some(hit) = self.previous.get(index) else {
            return false;
        };
        let encoded = self.problem.encode(hit.solution, position);
        if encoded {
            self.problem.space().positions(position);
        }
        encoded
    }
}

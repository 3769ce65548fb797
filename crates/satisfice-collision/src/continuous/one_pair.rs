//! The questions about one pair of features of a step.

use super::advance::Goal;
use super::deadline::{CutShort, Deadline};
use super::query::{Impact, decide_during, free_until, within};
use super::step::{MovingContact, Step};
use super::{Decided, Separation};
use crate::Error;
use crate::distance::PairKind;
use crate::scene::Completeness;

impl Step {
    /// The first time of a hit of a pair of this kind within `tolerance`, or `None` if it does not hit or there is no such pair.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the kinds edge-triangle and triangle-triangle, and for a tolerance below 1e-12.
    pub fn impact_of(
        &self,
        kind: PairKind,
        contact: &MovingContact,
        separation: Separation,
        tolerance: f64,
    ) -> Result<Option<Impact>, Error> {
        let impact = self.impact_of_until(kind, contact, separation, tolerance, &|| false)?;
        Ok(impact.0)
    }

    /// The same, until `stop` says so, which is asked while a decision by integers takes long: then `None` and
    /// [`Completeness::Unknown`], which says nothing of the pair.
    ///
    /// # Errors
    /// As [`impact_of`](Self::impact_of).
    pub fn impact_of_until(
        &self,
        kind: PairKind,
        contact: &MovingContact,
        separation: Separation,
        tolerance: f64,
        stop: &dyn Fn() -> bool,
    ) -> Result<(Option<Impact>, Completeness), Error> {
        let lists = Self::lists(kind)?;
        let goal = Goal {
            tolerance: Goal::checked(tolerance)?,
            deadline: Deadline::until(stop),
            ..Goal::DECISION
        };
        let pair = self.numbers(lists, contact);
        let pair = pair.filter(|&[a, b]| self.may_pair(lists, a, b));
        let Some([a, b]) = pair else {
            return Ok((None, Completeness::Proved));
        };
        Ok(match self.impact(kind, a, b, separation, goal) {
            Ok(impact) => (impact, Completeness::Proved),
            Err(CutShort) => (None, Completeness::Unknown),
        })
    }

    /// The first hit of a pair during a part of the step.
    pub(super) fn impact(
        &self,
        kind: PairKind,
        a: u32,
        b: u32,
        separation: Separation,
        goal: Goal<'_>,
    ) -> Result<Option<Impact>, CutShort> {
        match kind {
            PairKind::VertexVertex => within(&self.vertex(a), &self.vertex(b), separation, goal),
            PairKind::VertexEdge => within(&self.vertex(a), &self.edge(b), separation, goal),
            PairKind::VertexTriangle | PairKind::EdgeTriangle | PairKind::TriangleTriangle => {
                within(&self.vertex(a), &self.triangle(b), separation, goal)
            }
            PairKind::EdgeEdge => within(&self.edge(a), &self.edge(b), separation, goal),
        }
    }

    /// Decides a pair of features by their numbers in the common lists.
    pub(super) fn decide(
        &self,
        kind: PairKind,
        [a, b]: [u32; 2],
        separation: Separation,
        goal: Goal<'_>,
    ) -> Result<Decided, CutShort> {
        match kind {
            PairKind::VertexVertex => decide_during(&self.vertex(a), &self.vertex(b), separation, goal),
            PairKind::VertexEdge => decide_during(&self.vertex(a), &self.edge(b), separation, goal),
            PairKind::VertexTriangle | PairKind::EdgeTriangle | PairKind::TriangleTriangle => {
                decide_during(&self.vertex(a), &self.triangle(b), separation, goal)
            }
            PairKind::EdgeEdge => decide_during(&self.edge(a), &self.edge(b), separation, goal),
        }
    }

    /// A time up to which a look proves a pair free of hits, if it is free up to `from`; at least that.
    #[cold]
    pub(super) fn free_until_of_one(
        &self,
        kind: PairKind,
        a: u32,
        b: u32,
        separation: Separation,
        from: f64,
    ) -> f64 {
        match kind {
            PairKind::VertexVertex => free_until(&self.vertex(a), &self.vertex(b), separation, from),
            PairKind::VertexEdge => free_until(&self.vertex(a), &self.edge(b), separation, from),
            PairKind::VertexTriangle | PairKind::EdgeTriangle | PairKind::TriangleTriangle => {
                free_until(&self.vertex(a), &self.triangle(b), separation, from)
            }
            PairKind::EdgeEdge => free_until(&self.edge(a), &self.edge(b), separation, from),
        }
    }
}

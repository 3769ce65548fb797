//! What one lane of several has found since the lanes exchanged their hits.

use super::Ledger;
use crate::identity::Identity;
use crate::problem::AnyProblem;
use crate::scalar::Real;

/// What the other lanes do not know of a lane.
///
/// Two lanes may find two hits within the separation of each other, and only one of these is listed. What a lane has rejected
/// because of the other one is then near nothing that is listed, and a hit of its own.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(crate) struct Unlisted<T> {
    /// Hits, with F, that were evaluated and rejected because of a later one.
    pub(crate) rejected: Vec<(T, f64)>,
}

impl<T> Unlisted<T> {
    /// Nothing, after an exchange.
    pub(crate) fn nothing() -> Self {
        Self { rejected: Vec::new() }
    }
}

impl<T: Identity + Clone + Send + Sync> Ledger<T> {
    /// Notes a solution that is rejected because it is the same as hit `index`, if that hit may turn out not to be listed.
    #[inline]
    pub(super) fn note_rejected<S: Real>(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        solution: &T,
        fitness: S,
        index: usize,
    ) {
        if self.unlisted.is_none() || index < self.archive.listed_count() {
            return;
        }
        let hit = self.archive.solution(index);
        if hit.is_some_and(|hit| hit.stands_for(solution)) {
            return;
        }
        let other = problem.canonical(solution);
        let other = other.and_then(|other| Self::if_hit(problem, other));
        let noted = other.unwrap_or_else(|| (solution.clone(), fitness));
        if let Some(unlisted) = &mut self.unlisted {
            unlisted.rejected.push((noted.0, noted.1.f64()));
        }
    }
}

//! Taking hits back: a lane keeps those that are listed.

use super::Archive;
use crate::identity::Identity;

impl<T: Identity> Archive<T> {
    /// Whether it holds a hit that stands for `solution`.
    pub(crate) fn holds(&self, solution: &T) -> bool {
        self.any_same(solution, |hit| hit.stands_for(solution))
    }

    /// Keeps the first so many hits.
    pub(crate) fn truncate(&mut self, hits: usize) {
        while self.solutions.len() > hits {
            let index = self.solutions.len() - 1;
            let number = u32::try_from(index).unwrap_or(u32::MAX);
            let key = self.key_of(number);
            for table in [&mut self.table, &mut self.probe_only] {
                if let Ok(entry) = table.find_entry(key, |&i| i == number) {
                    entry.remove();
                }
            }
            if let Some(near) = &mut self.near {
                near.remove(&self.solutions[index], number);
            }
            self.solutions.pop();
            self.fitness.pop();
            self.evaluations.pop();
            self.seconds.pop();
        }
    }
}

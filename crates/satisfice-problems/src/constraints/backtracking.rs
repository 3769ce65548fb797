//! Chronological backtracking: the exact rival of every engine on constraint problems.

/// A problem whose variables can be given values one after the other, with a check at each step.
pub trait Extendable {
    /// How many values variable `variable` has, `None` behind the last variable.
    fn values(&self, variable: usize) -> Option<u32>;
    /// Whether the last value of `partial` violates nothing together with those before it.
    fn extends(&self, partial: &[u32]) -> bool;
}

/// What [`backtrack`] did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Backtracking {
    /// Solutions visited.
    pub solutions: u64,
    /// Nodes of the search tree: consistent partial assignments, the empty one included.
    pub nodes: u64,
    /// Whether the whole tree was searched, so that there are no other solutions.
    pub complete: bool,
}

/// Visits the solutions in lexicographic order, until all are found or `limit` nodes were visited.
///
/// ```
/// use satisfice_problems::{Queens, backtrack};
/// let all = backtrack(&Queens::new(8)?, 1_000_000, &mut |_| ());
/// assert_eq!((all.solutions, all.nodes, all.complete), (92, 2057, true));
/// # Ok::<(), satisfice::Error>(())
/// ```
pub fn backtrack(problem: &impl Extendable, limit: u64, visit: &mut dyn FnMut(&[u32])) -> Backtracking {
    let mut result = Backtracking {
        solutions: 0,
        nodes: 1,
        complete: true,
    };
    // The last entry is the value to try next; a node is left when its variable has no more values.
    let mut partial = vec![0];
    while let Some(&value) = partial.last() {
        let Some(values) = problem.values(partial.len() - 1) else {
            partial.pop();
            result.solutions += 1;
            visit(&partial);
            advance(&mut partial);
            continue;
        };
        if value >= values {
            partial.pop();
            advance(&mut partial);
        } else if !problem.extends(&partial) {
            advance(&mut partial);
        } else if result.nodes >= limit {
            result.complete = false;
            break;
        } else {
            result.nodes += 1;
            partial.push(0);
        }
    }
    result
}

fn advance(partial: &mut [u32]) {
    if let Some(last) = partial.last_mut() {
        *last += 1;
    }
}

//! Chronological backtracking: the exact method that engines are compared with on constraint problems.

/// A problem whose variables can be assigned in order, with a check after each.
pub trait Extendable {
    /// The number of values of a variable; `None` past the last variable.
    fn values(&self, variable: usize) -> Option<u32>;
    /// Whether the last value of `partial` is consistent with those before it.
    fn extends(&self, partial: &[u32]) -> bool;
}

/// The outcome of [`backtrack`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Backtracking {
    /// Solutions visited.
    pub solutions: u64,
    /// Nodes of the search tree: consistent partial assignments, the empty one included.
    pub nodes: u64,
    /// Whether the whole tree was searched: then there are no other solutions.
    pub complete: bool,
}

/// Visits the solutions in lexicographic order, until all are found or `limit` nodes have been visited.
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

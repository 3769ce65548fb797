//! Puts the pairs that several tasks found into one order: a counting sort by the first number, then a sort of each row.

use super::pair::Pair;

/// Pairs with fewer than one in this many rows are sorted by comparisons.
const SPARSE: usize = 4;

/// Sorts pairs. Keeps its memory from call to call.
#[derive(Debug, Default)]
pub(crate) struct Sorter {
    /// Where the next pair of each row goes, or where the row ends.
    ends: Vec<u32>,
}

impl Sorter {
    /// Writes the pairs to `out`, sorted; which task found which does not matter.
    pub(crate) fn sort<'p>(&mut self, found: impl Iterator<Item = &'p [Pair]> + Clone, out: &mut Vec<Pair>) {
        out.clear();
        let n = found.clone().map(<[Pair]>::len).sum::<usize>();
        // list by list: one iterator over the pairs of all of them is slow
        let (mut least, mut greatest) = (u32::MAX, 0);
        for pairs in found.clone() {
            for pair in pairs {
                (least, greatest) = (least.min(pair.a), greatest.max(pair.a));
            }
        }
        let rows = greatest.saturating_sub(least) as usize + 1;
        let mut last = Pair { a: 0, b: 0 };
        let is_sorted = found.clone().all(|pairs| {
            let Some(first) = pairs.first() else { return true };
            let follows = last <= *first;
            last = pairs[pairs.len() - 1];
            follows && pairs.is_sorted()
        });
        if is_sorted || rows > SPARSE * n || u32::try_from(n).is_err() {
            for pairs in found {
                out.extend_from_slice(pairs);
            }
            if !is_sorted {
                // as one number: cheaper to compare than two
                out.sort_unstable_by_key(|pair| u64::from(pair.a) << 32 | u64::from(pair.b));
            }
            return;
        }
        let ends = &mut self.ends;
        ends.clear();
        ends.resize(rows, 0);
        for pairs in found.clone() {
            for pair in pairs {
                ends[(pair.a - least) as usize] += 1;
            }
        }
        let mut sum = 0;
        for end in &mut *ends {
            sum += std::mem::replace(end, sum);
        }
        out.resize(n, Pair { a: 0, b: 0 });
        for pairs in found {
            for &pair in pairs {
                let end = &mut ends[(pair.a - least) as usize];
                out[*end as usize] = pair;
                *end += 1;
            }
        }
        let mut start = 0;
        for &end in &*ends {
            out[start..end as usize].sort_unstable_by_key(|pair| pair.b);
            start = end as usize;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Pair, Sorter};

    /// Numbers that look random, below a limit.
    fn numbers(limit: u32, mut state: u64) -> impl Iterator<Item = u32> {
        std::iter::repeat_with(move || {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(1);
            ((state >> 32) % u64::from(limit)) as u32
        })
    }

    #[test]
    fn pairs_of_any_number_of_tasks_are_sorted() {
        let mut sorter = Sorter::default();
        let mut out = Vec::new();
        for n in [0, 1, 2, 5000, 100_000] {
            // all numbers, few of them, and one that is far from the others
            for limits in [
                [u32::MAX, u32::MAX],
                [3, 1_000_000],
                [1_000_000, 3],
                [1, 1],
                [70_000, 70_000],
            ] {
                let (mut a, mut b) = (numbers(limits[0], 1), numbers(limits[1], 2));
                let mut pair = |at: usize| Pair {
                    a: a.next().unwrap() / if limits[0] == 70_000 && at > 0 { 4096 } else { 1 },
                    b: b.next().unwrap(),
                };
                let found: Vec<Pair> = (0..n).map(&mut pair).collect();
                let mut sorted = found.clone();
                sorted.sort();
                for tasks in [1, 7] {
                    sorter.sort(found.chunks(n.div_ceil(tasks).max(1)), &mut out);
                    assert!(out == sorted, "{n} below {limits:?}, {tasks} tasks");
                }
            }
        }
    }
}

//! Sweep and prune: which boxes of two lists are near each other, without a tree.

use satisfice_collision::Aabb;

/// Work that may still be done, in about nanoseconds, so that no check takes longer than its user waits.
#[derive(Debug)]
pub(super) struct Effort(u64);

/// Why a sweep ended early.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SweepEnd {
    /// No more is wanted.
    Enough,
    /// That would take too long.
    TooLong,
}

impl Effort {
    pub(super) fn new(nanoseconds: u64) -> Self {
        Self(nanoseconds)
    }

    /// What is left of it.
    #[cfg(test)]
    pub(super) fn left(&self) -> u64 {
        self.0
    }

    pub(super) fn spend(&mut self, nanoseconds: u64) -> Result<(), SweepEnd> {
        self.0 = self.0.checked_sub(nanoseconds).ok_or(SweepEnd::TooLong)?;
        Ok(())
    }
}

/// Whether two boxes are at most `reach` apart along every axis. No pair of points closer than that is lost by rounding: a rounded
/// difference is above `reach` only if the difference is.
pub(super) fn are_near(a: &Aabb, b: &Aabb, reach: f64) -> bool {
    (0..3).all(|k| a.min[k] - b.max[k] <= reach && b.min[k] - a.max[k] <= reach)
}

/// Calls `visit` with each box of `a` and each box of `b` that are [near](are_near), by their numbers. Both lists may be the same one;
/// every two boxes then come in both orders, and each one with itself.
pub(super) fn sweep(
    a: &[Aabb],
    b: &[Aabb],
    reach: f64,
    effort: &mut Effort,
    visit: &mut impl FnMut(usize, usize, &mut Effort) -> Result<(), SweepEnd>,
) -> Result<(), SweepEnd> {
    let lists = [a, b];
    let starts = a.iter().chain(b).map(|bounds| bounds.min);
    let Some(axis) = Aabb::of_points(starts).map(|around| around.longest_axis()) else {
        return Ok(());
    };
    let numbers = |side: usize| (0..lists[side].len()).map(move |number| (side, number));
    let mut order: Vec<(usize, usize)> = numbers(0).chain(numbers(1)).collect();
    let start = |&(side, number): &(usize, usize)| lists[side][number].min[axis];
    order.sort_by(|one, two| start(one).total_cmp(&start(two)));
    // Those of each list that the front has not left behind.
    let mut open = [Vec::new(), Vec::new()];
    for (side, number) in order {
        let bounds = &lists[side][number];
        let others = &mut open[1 - side];
        effort.spend(2 * others.len() as u64)?;
        others.retain(|&other: &usize| bounds.min[axis] - lists[1 - side][other].max[axis] <= reach);
        for &other in &*others {
            if are_near(bounds, &lists[1 - side][other], reach) {
                let (i, j) = if side == 0 {
                    (number, other)
                } else {
                    (other, number)
                };
                visit(i, j, effort)?;
            }
        }
        open[side].push(number);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sweep_visits_what_brute_force_does() {
        let mut state = 1_u64;
        let mut number = || {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(1);
            (state >> 40) as f64 / f64::from(1 << 24)
        };
        let mut boxes = |count: usize| -> Vec<Aabb> {
            let of = |_| {
                let mut bounds = Aabb::point(std::array::from_fn(|_| number()));
                bounds.include(bounds.min.map(|c| c + 0.1 * number()));
                bounds
            };
            (0..count).map(of).collect()
        };
        let (a, b) = (boxes(60), boxes(80));
        for (a, b) in [(&a, &b), (&b, &a), (&a, &a), (&a, &Vec::new())] {
            for reach in [0.0, 0.05, f64::MAX] {
                let mut seen = Vec::new();
                let mut see = |i: usize, j: usize, _: &mut Effort| {
                    seen.push((i, j));
                    Ok(())
                };
                let mut effort = Effort::new(u64::MAX);
                assert_eq!(sweep(a, b, reach, &mut effort, &mut see), Ok(()));
                seen.sort_unstable();
                let all = (0..a.len()).flat_map(|i| (0..b.len()).map(move |j| (i, j)));
                let near: Vec<_> = all.filter(|&(i, j)| are_near(&a[i], &b[j], reach)).collect();
                assert_eq!(seen, near, "{reach}");
            }
        }
        let ended = sweep(&a, &b, 1.0, &mut Effort::new(100), &mut |_, _, _| Ok(()));
        assert_eq!(ended, Err(SweepEnd::TooLong));
        let ended = sweep(&a, &b, 1.0, &mut Effort::new(u64::MAX), &mut |_, _, _| {
            Err(SweepEnd::Enough)
        });
        assert_eq!(ended, Err(SweepEnd::Enough));
    }
}

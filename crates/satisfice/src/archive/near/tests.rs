//! The tree of hits against all distances, and how deep it becomes.

use super::*;
use crate::Located;

/// The longest way down.
fn depth(index: &NearIndex) -> usize {
    let tree = &index.trees[0];
    let (mut deepest, mut left) = (0, vec![(0, 1)]);
    while let Some((node, depth)) = left.pop() {
        deepest = deepest.max(depth);
        if let NodeKind::Split { first, .. } = tree.nodes[node].kind {
            left.extend([(first, depth + 1), (first + 1, depth + 1)]);
        }
    }
    let used = tree.nodes.len() - 2 * tree.free.len();
    assert_eq!(tree.nodes[0].count, index.count());
    assert!(used < index.count() / 4 + 2, "{used} nodes");
    deepest
}

impl NearIndex {
    /// Hits, counted leaf by leaf.
    fn count(&self) -> usize {
        let nodes = self.trees.iter().flat_map(|tree| &tree.nodes);
        let leaves = nodes.map(|node| match &node.kind {
            NodeKind::Leaf { numbers, .. } => numbers.len(),
            NodeKind::Split { .. } => 0,
        });
        leaves.sum()
    }
}

#[test]
fn hits_in_one_direction_do_not_make_it_deep() {
    let mut index = NearIndex::default();
    let at = |x: f64| Located::new(&[x, 2.0 * x, 0.0, 1.0, 0.0], 0.5);
    for number in 0..20_000 {
        index.insert(&at(f64::from(number)), number);
    }
    assert!(depth(&index) < 30, "{}", depth(&index));
    for number in (0..20_000).step_by(7) {
        assert!(index.any(&at(f64::from(number) + 0.1), |found| found == number));
        assert!(!index.any(&at(f64::from(number) + 0.5), |_| true));
    }
}

/// Steps along axes from places that wander, in the order in which a flood fill looks: against all distances.
#[test]
fn steps_along_axes_are_found_as_by_all_distances() {
    let mut rng = crate::SearchRng::new(3);
    for axes in [33, 70] {
        let (mut index, mut hits) = (NearIndex::default(), Vec::new());
        let mut centre = vec![0.0; axes];
        let (mut same, mut other, mut crowd) = (0, 0, 0);
        for number in 0..6000 {
            if number % 400 == 0 {
                // Elsewhere, near enough to see some hits.
                let axis = rng.below(axes);
                centre[axis] += 1.3;
            }
            let mut at = centre.clone();
            at[rng.below(axes)] += 2.4 * rng.uniform() - 1.2;
            let solution = Located::new(&at, 0.5);
            let expected: Vec<u32> = (0..)
                .zip(&hits)
                .filter(|(_, hit)| solution.same(hit))
                .map(|(n, _)| n)
                .collect();
            let mut found = Vec::new();
            let is_found = index.any(&solution, |number| {
                if solution.same(&hits[number as usize]) {
                    found.push(number);
                }
                false
            });
            found.sort_unstable();
            assert!(!is_found && found == expected, "{number}: {found:?} {expected:?}");
            same += usize::from(!expected.is_empty());
            other += usize::from(expected.is_empty());
            crowd = crowd.max(expected.len());
            if expected.len() < 2 {
                index.insert(&solution, u32::try_from(hits.len()).unwrap());
                hits.push(solution);
            }
        }
        assert!(same > 500 && other > 500 && crowd > 1, "{same} {other} {crowd}");
    }
}

/// Along each of many axes: most points are zero on each.
#[test]
fn a_star_is_searched_without_recursion() {
    let mut index = NearIndex::default();
    let at = |number: u32| {
        let mut x = vec![0.0; 200];
        x[number as usize % 200] = f64::from(1 + number / 200);
        Located::new(&x, 0.5)
    };
    for number in 0..8000 {
        index.insert(&at(number), number);
    }
    assert!(depth(&index) < 2000, "{}", depth(&index));
    for number in (0..8000).step_by(31) {
        assert!(index.any(&at(number), |found| found == number));
        assert!(!index.any(&at(number), |found| found != number));
    }
}

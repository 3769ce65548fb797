//! Niches by density: DBSCAN (Ester, Kriegel, Sander, Xu 1996, KDD-96, pp. 226-231).

/// No niche: an outlier.
pub(super) const OUTLIER: u32 = 0;

/// The niche of each of some points, numbered from 1 in the order of their first cores; [`OUTLIER`] for points in none.
///
/// A point with at least `min_points` points within `eps`, itself included, is a core; cores within `eps` of each other are
/// of one niche, and points within `eps` of a core are of the first such niche. O(n^2) distances.
///
/// They are written into `niches`; `memory` is used again from call to call.
pub(super) fn dbscan(
    points: usize,
    eps: f64,
    min_points: usize,
    distance: impl Fn(usize, usize) -> f64,
    memory: &mut ClusterMemory,
    niches: &mut Vec<u32>,
) {
    let ClusterMemory { seen, open, reached } = memory;
    // NaN is near nothing.
    let near = |i: usize, out: &mut Vec<usize>| {
        out.clear();
        out.extend((0..points).filter(|&j| i == j || distance(i, j) <= eps));
    };
    niches.clear();
    niches.resize(points, OUTLIER);
    seen.clear();
    seen.resize(points, false);
    let mut found = 0;
    for first in 0..points {
        if seen[first] {
            continue;
        }
        seen[first] = true;
        near(first, open);
        if open.len() < min_points {
            continue;
        }
        found += 1;
        niches[first] = found;
        while let Some(point) = open.pop() {
            if niches[point] == OUTLIER {
                niches[point] = found;
            }
            if !seen[point] {
                seen[point] = true;
                near(point, reached);
                if reached.len() >= min_points {
                    open.extend_from_slice(reached);
                }
            }
        }
    }
}

/// What [`dbscan`] works with.
#[derive(Debug, Default)]
pub(super) struct ClusterMemory {
    seen: Vec<bool>,
    open: Vec<usize>,
    reached: Vec<usize>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on_a_line(points: &[f64]) -> Vec<u32> {
        let mut niches = vec![7; 3];
        let distance = |i: usize, j: usize| (points[i] - points[j]).abs();
        dbscan(
            points.len(),
            1.0,
            3,
            distance,
            &mut ClusterMemory::default(),
            &mut niches,
        );
        niches
    }

    #[test]
    fn dense_points_are_niches_and_isolated_ones_are_outliers() {
        // All of 9, 9.5 and 10 are cores; of 0, 1 and 2 only the one in the middle is, which comes later.
        assert_eq!(
            on_a_line(&[0.0, 9.0, 1.0, 50.0, 9.5, 2.0, 10.0]),
            [2, 1, 2, OUTLIER, 1, 2, 1]
        );
        // An end of a chain is reached from a core, though it is none.
        assert_eq!(on_a_line(&[0.0, 1.0, 2.0, 3.0]), [1, 1, 1, 1]);
        assert_eq!(on_a_line(&[0.0, 1.0]), [OUTLIER, OUTLIER]);
        assert_eq!(on_a_line(&[f64::NAN, 0.0, 0.5, 0.7]), [OUTLIER, 1, 1, 1]);
        assert_eq!(on_a_line(&[]), [0; 0]);
    }
}

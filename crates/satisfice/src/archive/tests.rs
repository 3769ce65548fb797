//! Against an ordered set and all pairs; what probes do; memory at rest.

use std::collections::BTreeSet;

use super::*;
use crate::identity::Located;

#[test]
fn agrees_with_an_ordered_set() {
    let mut rng = crate::SearchRng::new(3);
    let (mut archive, mut set) = (Archive::default(), BTreeSet::new());
    for n in 0..200_000_u64 {
        let pair = [rng.below(600), rng.below(600)];
        assert_eq!(archive.contains(&pair), set.contains(&pair));
        if rng.uniform() < 0.6 {
            assert_eq!(archive.insert(pair, -1.0, n, 0.0), set.insert(pair));
        }
    }
    assert_eq!(archive.len(), set.len());
    assert!(archive.iter().all(|hit| set.contains(hit.solution)));
    assert!(archive.len() > FILTERED, "both regimes of the filter are passed");
}

#[test]
fn located_solutions_agree_with_all_pairs() {
    let mut rng = crate::SearchRng::new(4);
    for dimension in [1, 2, 5] {
        let mut archive = Archive::default();
        for n in 0..3000 {
            let point: Vec<f64> = (0..dimension).map(|_| rng.uniform() * 2.0 - 1.0).collect();
            let located = Located::new(&point, 0.05);
            let near = archive.solutions().iter().any(|other| located.same(other));
            assert_eq!(archive.contains(&located), near);
            assert_eq!(archive.insert(located, -1.0, n, 0.0), !near);
        }
    }
}

/// Hits are crowded in a part of six dimensions, so that fine keys come into use on the way.
#[test]
fn crowded_solutions_agree_with_all_pairs() {
    let mut rng = crate::SearchRng::new(5);
    let mut archive = Archive::default();
    for n in 0..3000 {
        let point: Vec<f64> = (0..6).map(|_| 0.3 * rng.uniform()).collect();
        let located = Located::new(&point, 0.05);
        let near = |all: bool| {
            let mut others = archive.solutions().iter().enumerate();
            others.any(|(i, other)| (all || !archive.is_probe_only(i)) && located.same(other))
        };
        let (known, probe) = (near(false), n % 50 == 0 && !near(true));
        assert_eq!(archive.contains(&located), known);
        let is_new = !known && archive.enter(located, -1.0, n, 0.0, probe) != Insertion::Known;
        assert_eq!(is_new, !known);
    }
    assert!(archive.fine && archive.probe_only() > 10);
    let found = (0..archive.len()).filter(|&i| archive.position(&archive.solutions()[i]) == Some(i));
    assert_eq!(found.count(), archive.len());
    archive.rest();
    assert!(archive.iter().all(|hit| archive.contains(hit.solution)));
}

#[test]
fn at_rest_it_stays_under_32_bytes_a_hit() {
    for hits in [1_000_u32, 60_000, 200_000, 458_753] {
        let mut archive = Archive::default();
        for n in 0..hits {
            archive.insert([n, n], -1.0, u64::from(n), 0.0);
        }
        archive.rest();
        let bytes = archive.overhead_bytes() as f64 / f64::from(hits);
        assert!(bytes < 32.0, "{bytes} bytes per hit at {hits}");
        assert!(archive.contains(&[hits - 1, hits - 1]) && !archive.contains(&[hits, hits]));
    }
}

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

/// Batches whose solutions are looked up together and entered one by one, probes among them, of which some are promoted.
#[test]
fn a_look_up_after_another_says_what_the_archive_says() {
    let mut rng = crate::SearchRng::new(6);
    let mut archive = Archive::default();
    let (mut cheap, mut promoted) = (0, 0);
    for n in 0..2000 {
        let (probing, size) = (n % 5 == 0, if n % 50 == 1 { 3 * LATEST } else { 8 });
        let mut draw = || (120.0 * rng.uniform()) as u8;
        let mut batch: Vec<[u8; 2]> = (0..size).map(|_| [draw(), draw()]).collect();
        batch.retain(|solution| !archive.contains(solution));
        let mark = archive.mark();
        for solution in batch {
            let (known, mut recent) = (archive.contains(&solution), usize::MAX);
            cheap += usize::from(archive.entered_since(mark).is_some());
            assert_eq!(archive.contains_again(&solution, Some(mark), &mut recent), known);
            assert_eq!(archive.solutions().get(recent) == Some(&solution), known);
            if !known {
                let entered = archive.enter(solution, -1.0, 1, 0.0, probing);
                promoted += usize::from(entered == Insertion::Promoted);
            }
        }
    }
    assert!(cheap > 1000 && promoted > 100, "{cheap} {promoted}");
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

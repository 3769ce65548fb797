//! How large a checkpoint is.

use satisfice::{Budget, Search, Space, from_fn};

use super::quick;

/// Bytes of a checkpoint for each hit, and beside them.
const A_HIT: usize = 200;
const BESIDE: usize = 1_000_000;

#[test]
fn a_checkpoint_takes_few_bytes_a_hit() {
    let shell = from_fn(Space::lattice(3, 60).unwrap(), 1.0, |x: &[f64]| {
        let square: f64 = x.iter().map(|x| (x - 29.5) * (x - 29.5)).sum();
        (square.sqrt() - 20.0).abs()
    });
    let mut most = 0;
    for entry in quick() {
        let mut search = Search::with(entry.configure([]).unwrap()).seed(5);
        let report = search.run(&shell, &Budget::evaluations(30_000)).unwrap();
        let bytes = serde_json::to_vec(&search.checkpoint()).unwrap().len();
        let hits = report.hit_count();
        assert!(
            bytes <= A_HIT * hits + BESIDE,
            "{}: {bytes} bytes for {hits} hits",
            entry.name
        );
        most = most.max(hits);
    }
    // With so many hits the rest is the smaller part.
    assert!(most > 8_000, "{most}");
}

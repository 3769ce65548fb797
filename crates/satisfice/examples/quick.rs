#![allow(missing_docs, clippy::unwrap_used)]
use satisfice::*;
fn main() {
    for entry in engine::all() {
        // islands-like lattice
        let p = from_fn(Space::lattice(2, 300).unwrap(), 6.0, |x: &[f64]| {
            [(50.0, 60.0), (200.0, 220.0), (250.0, 30.0)]
                .iter()
                .map(|c: &(f64, f64)| (x[0] - c.0).hypot(x[1] - c.1))
                .fold(f64::INFINITY, f64::min)
        });
        let r = Search::new(entry.build::<f64>([]).unwrap())
            .seed(1)
            .run(&p, &Budget::evaluations(20_000))
            .unwrap();
        let him = from_fn(Space::cube(2, -6.0, 6.0).unwrap(), 1e-2, |x: &[f64]| {
            (x[0] * x[0] + x[1] - 11.0).powi(2) + (x[0] + x[1] * x[1] - 7.0).powi(2)
        })
        .separation(0.5);
        let h = Search::new(entry.build::<f64>([]).unwrap())
            .seed(1)
            .run(&him, &Budget::evaluations(50_000))
            .unwrap();
        let c = from_fn(Space::cube(2, -2.0, 2.0).unwrap(), 0.01, |x: &[f64]| {
            (x[0].hypot(x[1]) - 1.0).abs()
        })
        .separation(0.02);
        let c = Search::new(entry.build::<f64>([]).unwrap())
            .seed(1)
            .run(&c, &Budget::evaluations(50_000))
            .unwrap();
        println!(
            "{:16} lattice {} of 339, {} dup; himmelblau {}; circle {}  {:.1} ns/ev {:.1} {:.1}",
            entry.name,
            r.hit_count(),
            r.counts.duplicates,
            h.hit_count(),
            c.hit_count(),
            r.elapsed.as_nanos() as f64 / 2e4,
            h.elapsed.as_nanos() as f64 / 5e4,
            c.elapsed.as_nanos() as f64 / 5e4
        );
    }
}

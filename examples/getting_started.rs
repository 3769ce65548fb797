//! A problem of your own: every gear train of four wheels with 12 to 60 teeth whose ratio is within 100 ppm of 1 : 6.931.
//!
//! `cargo run --release --example getting_started`

use satisfice::{Axis, Budget, SatisficingProblem, Search, Space};

/// Two pairs of wheels: `[driving, driving, driven, driven]`, the smaller wheel of each pair first.
struct GearTrain(Space<f64>);

impl SatisficingProblem for GearTrain {
    type Scalar = f64;
    type Solution = [u32; 4]; // anything with `Eq + Hash` counts once

    fn space(&self) -> &Space<f64> {
        &self.0
    }
    fn decode(&self, teeth: &[f64]) -> [u32; 4] {
        let [a, b, c, d] = std::array::from_fn(|wheel| teeth[wheel] as u32);
        [a.min(b), a.max(b), c.min(d), c.max(d)] // which of the two comes first makes no difference
    }
    fn fitness(&self, &[a, b, c, d]: &[u32; 4]) -> f64 {
        (6.931 * f64::from(a * b) / f64::from(c * d) - 1.0).abs() // relative error
    }
    fn threshold(&self) -> f64 {
        1e-4
    }
}

fn main() -> Result<(), satisfice::Error> {
    let problem = GearTrain(Space::new([Axis::integer(12, 60); 4])?);
    let mut search = Search::new().seed(1);
    let report = search.run(&problem, &Budget::evaluations(300_000))?;

    println!("{report}\nthe first hits:");
    for hit in report.hits().take(5) {
        let ([a, b, c, d], error) = (hit.solution, 1e6 * problem.fitness(hit.solution));
        println!(
            "  {a} x {b} : {c} x {d}, off by {error:.2} ppm, at evaluation {}",
            hit.evaluation
        );
    }
    check(&report);
    Ok(())
}

/// Counts all trains by enumeration in whole numbers: there are only 1,225^2.
fn check(report: &satisfice::Report<[u32; 4]>) {
    let pairs = || (12..=60_u64).flat_map(|a| (a..=60).map(move |b| (a, b)));
    // |6.931 ab/cd - 1| < 1e-4, times 1e4 cd.
    let is_hit = |a: u64, b: u64, c: u64, d: u64| (69_310 * a * b).abs_diff(10_000 * c * d) < c * d;
    let all = pairs().flat_map(|(a, b)| pairs().map(move |(c, d)| (a, b, c, d)));
    let count = all.filter(|&(a, b, c, d)| is_hit(a, b, c, d)).count();
    println!("{} of the {count} that exist", report.hit_count());
    for hit in report.hits() {
        let [a, b, c, d] = hit.solution.map(u64::from);
        assert!(is_hit(a, b, c, d), "{:?} is reported but is no hit", hit.solution);
    }
    let share = report.hit_count() as f64 / count as f64;
    // 300,000 uniform points would contain one or two hits.
    assert!(share >= 0.5, "no better than chance: {share}");
}

//! The numerical stress study: every family of hard pairs against rational arithmetic, and every family of motions against its known
//! answer, printed as Markdown tables.
//!
//! `cargo run --release --example numerical_stress [PAIRS] > docs/results/numerical-stress.md` (PAIRS a family, default 300, 60 with `SATISFICE_QUICK=1`;
//! under a minute). Exits with 1 if a decision is wrong, a distance is off by more than one unit in the last place, or a time is out of its bounds.
#![allow(clippy::unwrap_used)]

#[path = "../crates/satisfice-collision/tests/motions/mod.rs"]
mod motions;
#[path = "../crates/satisfice-collision/tests/stress/mod.rs"]
mod stress;

use std::process::ExitCode;

use motions::Case;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;
use satisfice_collision::distance::{DecidedBy, PairKind};
use stress::referee::squared_distance;
use stress::{Motion, Point, below, decide, families, orders, proximity, scaled, sizes, unit};

const SEED: u64 = 20_260_101;

/// The counts of one family or kind.
#[derive(Default, Clone)]
struct Tally {
    decisions: [u64; 2],
    by_filter: [u64; 2],
    by_extended: [u64; 2],
    by_exact: [u64; 2],
    wrong: u64,
    distances: u64,
    distances_exact: u64,
    off: f64,
    sum_off: f64,
}

impl Tally {
    /// One decision; `hard` thresholds lie near the distance.
    fn decision(&mut self, kind: PairKind, a: &[Point], b: &[Point], delta: f64, expected: bool, hard: bool) {
        let got = decide(kind, a, b, delta);
        let column = usize::from(hard);
        self.decisions[column] += 1;
        match got.by {
            DecidedBy::Filter => self.by_filter[column] += 1,
            DecidedBy::Extended => self.by_extended[column] += 1,
            DecidedBy::Exact => self.by_exact[column] += 1,
            DecidedBy::NotFinite => self.wrong += 1,
        }
        if got.within != expected {
            self.wrong += 1;
            eprintln!("wrong: {kind} {a:?} {b:?} {delta:e}");
        }
    }

    fn add(&mut self, other: &Self) {
        for k in 0..2 {
            self.decisions[k] += other.decisions[k];
            self.by_filter[k] += other.by_filter[k];
            self.by_extended[k] += other.by_extended[k];
            self.by_exact[k] += other.by_exact[k];
        }
        self.wrong += other.wrong;
        self.distances += other.distances;
        self.distances_exact += other.distances_exact;
        self.off = self.off.max(other.off);
        self.sum_off += other.sum_off;
    }

    fn row(&self, name: &str) -> String {
        let percent = |part: u64, all: u64| 100.0 * part as f64 / all.max(1) as f64;
        format!(
            "| {name} | {} | {} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.3} | {:.3} |",
            self.decisions[0] + self.decisions[1],
            self.wrong,
            percent(self.by_filter[0], self.decisions[0]),
            percent(self.by_filter[1], self.decisions[1]),
            percent(self.by_extended[1], self.decisions[1]),
            percent(self.by_exact[1], self.decisions[1]),
            percent(self.distances_exact, self.distances),
            self.sum_off / self.distances.max(1) as f64,
            self.off,
        )
    }
}

/// All vertex orders, both orders of the pair, and motions without rounding, at three thresholds.
fn study(kind: PairKind, a: &[Point], b: &[Point], rng: &mut Xoshiro256PlusPlus) -> Tally {
    let mut tally = Tally::default();
    let truth = squared_distance(a, b);
    let near = truth.approximate().min(f64::MAX);
    for pass in 0..3 {
        let hard = pass > 0;
        let delta = if hard {
            families::threshold_near(near, rng)
        } else {
            // If the features meet: a fraction of the largest coordinate.
            let extent = a
                .iter()
                .chain(b)
                .flatten()
                .fold(0.0_f64, |most, x| most.max(x.abs()));
            let scale = if near == 0.0 { 0.5 * extent } else { near };
            (scale * (1.0 + 0.9 * unit(rng))).clamp(f64::from_bits(1), f64::MAX)
        };
        let expected = truth.is_below(delta);
        for p in orders(a) {
            for q in orders(b) {
                tally.decision(kind, &p, &q, delta, expected, hard);
                if a.len() == b.len() {
                    tally.decision(kind, &q, &p, delta, expected, hard);
                }
            }
        }
        for _ in 0..8 {
            let motion = Motion::random(rng);
            let (p, q) = (motion.apply(a), motion.apply(b));
            tally.decision(kind, &p, &q, delta, expected, hard);
            let exponent = below(rng, 1601) as i32 - 800;
            if let (Some(p), Some(q), Some(d)) = (
                scaled(&p, exponent),
                scaled(&q, exponent),
                scaled(&[[delta; 3]], exponent),
            ) {
                tally.decision(kind, &p, &q, d[0][0], expected, hard);
            }
        }
    }
    for (p, q) in orders(a).iter().zip(orders(b).iter().rev()) {
        let computed = proximity(kind, p, q);
        let off = truth.error_in_ulp(computed.distance);
        tally.distances += 1;
        tally.distances_exact += u64::from(computed.by == DecidedBy::Exact);
        tally.off = tally.off.max(off);
        tally.sum_off += off;
        if off > 1.0 {
            eprintln!("off by {off} ulp: {kind} {p:?} {q:?}");
        }
    }
    tally
}

/// The exponents of the powers of two by which motions are scaled.
const SCALES: [i32; 25] = [
    -498, -400, -300, -200, -100, -60, -40, -30, -20, -10, -5, -1, 0, 1, 5, 10, 20, 30, 40, 60, 100, 200,
    300, 400, 498,
];
/// How close the bounds of a time are asked to be.
const TOLERANCE: f64 = 1e-9;

/// The counts of one family of motions.
#[derive(Default)]
struct Motions {
    decisions: u64,
    touching: u64,
    by_filter: u64,
    wrong: u64,
    impacts: u64,
    known: u64,
}

impl Motions {
    /// Motions of a family at every scale, each asked about in every order of vertices and features and in both directions of time.
    fn study(case: Case, count: usize, rng: &mut Xoshiro256PlusPlus) -> Self {
        let mut tally = Self::default();
        for exponent in SCALES {
            for _ in 0..count {
                let (query, touches) = case.sample(rng);
                let query = query.scaled(exponent);
                for variant in query.variants() {
                    let decided = variant.decide();
                    tally.decisions += 1;
                    tally.touching += u64::from(touches);
                    tally.by_filter += u64::from(decided.by == DecidedBy::Filter);
                    if decided.within != touches {
                        tally.wrong += 1;
                        eprintln!("wrong: {variant:?}");
                    }
                }
                let impact = query.impact(0.0, TOLERANCE);
                tally.impacts += 1;
                tally.known += u64::from(query.first_touch.is_some());
                let is_right = match impact {
                    None => !touches,
                    Some(impact) => {
                        let [low, high] = impact.time;
                        let is_known = query
                            .first_touch
                            .is_none_or(|known| low <= known && known <= high);
                        touches && low <= high && high - low <= TOLERANCE && is_known
                    }
                };
                if !is_right {
                    tally.wrong += 1;
                    eprintln!("wrong time: {query:?} {impact:?}");
                }
            }
        }
        tally
    }

    fn row(&self, name: &str) -> String {
        let percent = |part: u64| 100.0 * part as f64 / self.decisions.max(1) as f64;
        format!(
            "| {name} | {} | {:.1} | {} | {:.2} | {:.2} | {} | {} |",
            self.decisions,
            percent(self.touching),
            self.wrong,
            percent(self.by_filter),
            percent(self.decisions - self.by_filter),
            self.impacts,
            self.known,
        )
    }
}

/// Prints the table of motions; returns how many answers were wrong.
fn motions_in_time(pairs: usize, rng: &mut Xoshiro256PlusPlus) -> u64 {
    let count = pairs.div_ceil(SCALES.len());
    println!("\n## Motion\n");
    println!(
        "Touching during a step, {count} motions a family at each of {} scales from 2^{} to 2^{}, each in all orders of the vertices, both of \
         the pair and both directions of time. Families have known answers by construction. Shares are in percent of the decisions. The time \
         of each motion is asked for within {TOLERANCE:e}; *known* counts those whose first time is known and has to lie between the bounds.\n",
        SCALES.len(),
        SCALES[0],
        SCALES[SCALES.len() - 1]
    );
    println!("| family | decisions | touching | wrong | filter | exact | times | known |");
    println!("|---|---:|---:|---:|---:|---:|---:|---:|");
    let mut wrong = 0;
    for case in Case::ALL {
        let tally = Motions::study(case, count, rng);
        println!("{}", tally.row(case.name()));
        wrong += tally.wrong;
    }
    wrong
}

fn main() -> ExitCode {
    let pairs = match std::env::args().nth(1).map(|count| count.parse()) {
        None if std::env::var_os("SATISFICE_QUICK").is_some() => 60,
        None => 300,
        Some(Ok(count)) => count,
        Some(Err(error)) => {
            eprintln!("PAIRS must be a whole number: {error}");
            return ExitCode::from(2);
        }
    };
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(SEED);
    let mut by_kind = vec![Tally::default(); PairKind::ALL.len()];
    let mut by_family = Vec::new();
    for family in families::ALL {
        let mut of_family = Tally::default();
        for _ in 0..pairs {
            let (a, b) = (family.draw)(&mut rng);
            for (kind, of_kind) in PairKind::ALL.into_iter().zip(&mut by_kind) {
                let (m, n) = sizes(kind);
                let tally = study(kind, &a[..m], &b[..n], &mut rng);
                of_family.add(&tally);
                of_kind.add(&tally);
            }
        }
        by_family.push((family.name, of_family));
    }
    let mut all = Tally::default();
    for (_, tally) in &by_family {
        all.add(tally);
    }
    let head = |first: &str| {
        format!(
            "| {first} | decisions | wrong | filter, usual | filter, hard | extended, hard | exact, hard | \
             distance exact | ulp, mean | ulp, most |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|"
        )
    };
    println!("# Numerical stress of the feature-pair distances\n");
    println!(
        "`cargo run --release --example numerical_stress {pairs}`, seed {SEED}, {pairs} pairs of triangles a family.\n"
    );
    println!(
        "Each pair is asked as all six kinds of feature pairs, in all orders of the vertices and both of the pair, after axis \
         permutations, sign flips and scalings by powers of two up to 2^800. *Usual* thresholds are uniform \
         between 0.1 and 1.9 times the distance (where that is 0: half the largest coordinate); *hard* ones are d (1 +- 2^-k) with k up to 53, within 3 units in the last place, up to 2 d, \
         or tiny where the distance is 0. Shares are in percent of the decisions; \"distance exact\" is the share of \
         distances that needed integers. The referee is rational arithmetic by another method and another library.\n"
    );
    println!("{}", head("family"));
    for (name, tally) in &by_family {
        println!("{}", tally.row(name));
    }
    println!("{}\n", all.row("**all**"));
    println!("{}", head("kind"));
    for (kind, tally) in PairKind::ALL.iter().zip(&by_kind) {
        println!("{}", tally.row(kind.name()));
    }
    let wrong = motions_in_time(pairs, &mut rng);
    if all.wrong + wrong > 0 || all.off > 1.0 {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    }
}

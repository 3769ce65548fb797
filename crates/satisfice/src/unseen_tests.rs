//! Coverage and width of the intervals over seeded runs against a brute-force count, and edge cases.

use crate::Encoding;
use core::ops::ControlFlow;

use super::*;
use crate::engine::{self, Ask, ConfiguredEngine, Origin};
use crate::{
    Axis, Batch, Budget, Completeness, Context, Engine, Error, Outcome, Report, SatisficingProblem, Search,
    SearchRng, Space, from_fn,
};

const RUNS: u64 = 200;

/// Hits of a lattice problem by enumeration.
fn count<P: SatisficingProblem<Scalar = f64>>(problem: &P) -> u64 {
    let mut values: Vec<f64> = problem.space().axes().iter().map(Axis::lower).collect();
    let mut hits = 0;
    loop {
        hits += u64::from(problem.fitness(&problem.decode(&values)) < problem.threshold());
        let mut axis = 0;
        loop {
            if axis == values.len() {
                return hits;
            }
            values[axis] += 1.0;
            if values[axis] <= problem.space().axes()[axis].upper() {
                break;
            }
            values[axis] = problem.space().axes()[axis].lower();
            axis += 1;
        }
    }
}

/// No structure: every point is a hit with probability 0.02, independently of its neighbours.
fn needles(x: &[f64]) -> f64 {
    let mut word = (x[0] as u64) << 32 | x[1] as u64;
    for _ in 0..3 {
        word = (word ^ word >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    }
    (word >> 11) as f64 / (1_u64 << 53) as f64
}

/// The least distance to eight islands of different radii in three dimensions.
fn islands(x: &[f64]) -> f64 {
    (0..8)
        .map(|i| {
            let centre = [3 + 7 * i, 5 + 11 * i % 50, 50 - 6 * i].map(f64::from);
            let square: f64 = x.iter().zip(centre).map(|(a, b)| (a - b) * (a - b)).sum();
            square.sqrt() - f64::from(1 + i % 4)
        })
        .fold(f64::INFINITY, f64::min)
}

/// A ring: connected, thin, and a tenth of the space.
fn ring(x: &[f64]) -> f64 {
    ((x[0] - 99.5).hypot(x[1] - 99.5) - 70.0).abs()
}

/// One configuration over all seeds: how often the interval contained the true number, its median width, and that of the
/// Clopper-Pearson interval for the number of all hits from the same probes.
fn coverage<P: SatisficingProblem<Scalar = f64>>(
    problem: &P,
    truth: u64,
    engine: &str,
    budget: u64,
    share: f64,
) -> (f64, f64, f64) {
    let points = problem.space().cardinality().unwrap();
    let (mut held, mut widths, mut rival) = (0, Vec::new(), Vec::new());
    for seed in 0..RUNS {
        let report = run(problem, engine, budget, share, seed);
        let unseen = report.unseen.unwrap();
        assert_eq!(unseen.method, Method::Lattice);
        let (lower, upper) = (unseen.interval.0, unseen.interval.1.unwrap());
        let missing = truth as f64 - report.hit_count() as f64;
        held += u64::from(lower <= missing && missing <= upper);
        assert!(lower <= unseen.estimate && unseen.estimate <= upper, "{unseen:?}");
        widths.push(upper - lower);
        let (low, high) = clopper_pearson(unseen.recaptures + unseen.fresh, unseen.probes, CONFIDENCE);
        rival.push((high * points).floor() - (low * points).ceil());
    }
    let median = |mut of: Vec<f64>| {
        of.sort_by(f64::total_cmp);
        of[of.len() / 2]
    };
    (held as f64 / RUNS as f64, median(widths), median(rival))
}

fn run<P: SatisficingProblem<Scalar = f64>>(
    problem: &P,
    engine: &str,
    budget: u64,
    share: f64,
    seed: u64,
) -> Report<P::Solution> {
    Search::named(engine)
        .unwrap()
        .seed(seed)
        .probes(share)
        .run(problem, &Budget::evaluations(budget))
        .unwrap()
}

/// Prints the table of `docs/completeness.md` under `--nocapture`.
fn check_coverage<P: SatisficingProblem<Scalar = f64>>(name: &str, problem: &P) {
    let truth = count(problem);
    for engine in ["random", "latest-hit-qpso", "descent-flood"] {
        for (budget, share) in [(1_000, 0.05), (5_000, 0.03), (5_000, 0.2)] {
            let (held, width, rival) = coverage(problem, truth, engine, budget, share);
            println!(
                "| {name} | {truth} | {engine} | {budget} | {share} | {:.1} | {width} | {rival} |",
                100.0 * held
            );
            assert!(
                held >= 0.85,
                "{name}, {engine}, {budget}: the interval held in {held}"
            );
            assert!(
                width <= rival,
                "{name}, {engine}, {budget}: {width} is wider than {rival}"
            );
        }
    }
}

#[test]
fn the_interval_holds_and_is_narrow_on_needles() {
    check_coverage(
        "needles",
        &from_fn(Space::lattice(2, 200).unwrap(), 0.02, needles).boxed(),
    );
}

#[test]
fn the_interval_holds_and_is_narrow_on_islands() {
    check_coverage(
        "islands",
        &from_fn(Space::lattice(3, 60).unwrap(), 0.5, islands).boxed(),
    );
}

#[test]
fn the_interval_holds_and_is_narrow_on_a_ring() {
    check_coverage(
        "ring",
        &from_fn(Space::lattice(2, 200).unwrap(), 4.5, ring).boxed(),
    );
}

/// Unordered pairs: most solutions have two points, those of the diagonal one.
struct Pairs(Space<f64>);

impl SatisficingProblem for Pairs {
    type Scalar = f64;
    type Solution = [u32; 2];
    fn space(&self) -> &Space<f64> {
        &self.0
    }
    fn decode(&self, values: &[f64]) -> [u32; 2] {
        let (a, b) = (values[0] as u32, values[1] as u32);
        [a.min(b), a.max(b)]
    }
    fn fitness(&self, &[a, b]: &[u32; 2]) -> f64 {
        f64::from((a * 37 + b * 101) % 97)
    }
    fn threshold(&self) -> f64 {
        9.0
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, [u32; 2]>> {
        Some(self)
    }
}

impl Encoding<f64, [u32; 2]> for Pairs {
    fn encode(&self, &[a, b]: &[u32; 2], values: &mut [f64]) -> bool {
        values.copy_from_slice(&[f64::from(a), f64::from(b)]);
        true
    }
}

#[test]
fn solutions_of_several_points_count_once() {
    let problem = Pairs(Space::lattice(2, 120).unwrap());
    let truth = (0..120_u32)
        .flat_map(|a| (a..120).map(move |b| [a, b]))
        .filter(|pair| problem.fitness(pair) < 9.0)
        .count() as u64;
    for engine in ["random", "latest-hit-qpso"] {
        let (held, _, _) = coverage(&problem, truth, engine, 3_000, 0.1);
        assert!(held >= 0.85, "{engine}: the interval held in {held}");
    }
}

/// Discs of one size in the plane; the answer is the disc.
struct Discs(Space<f64>);

const DISCS: usize = 12;

impl SatisficingProblem for Discs {
    type Scalar = f64;
    type Solution = [usize; 2];
    fn space(&self) -> &Space<f64> {
        &self.0
    }
    /// The disc, and which of a million rings about its centre.
    fn decode(&self, values: &[f64]) -> [usize; 2] {
        let cell = |x: f64| (x as usize).min(DISCS - 1);
        let (i, j) = (cell(values[0]), cell(values[1]));
        let distance = (values[0] - i as f64 - 0.5).hypot(values[1] - j as f64 - 0.5);
        [i * DISCS + j, (distance * 1e6) as usize]
    }
    fn fitness(&self, &[_, distance]: &[usize; 2]) -> f64 {
        distance as f64 / 1e6
    }
    fn threshold(&self) -> f64 {
        0.2
    }
    fn canonical(&self, &[disc, _]: &[usize; 2]) -> Option<[usize; 2]> {
        Some([disc, 0])
    }
}

#[test]
fn recaptures_tell_how_many_equal_discs_there_are() {
    let problem = Discs(Space::cube(2, 0.0, DISCS as f64).unwrap());
    for engine in ["random", "latest-hit-qpso"] {
        for budget in [400, 2_000] {
            let mut held = 0;
            for seed in 0..RUNS {
                let report = run(&problem, engine, budget, 0.2, seed);
                let unseen = report.unseen.unwrap();
                let missing = (DISCS * DISCS - report.hit_count()) as f64;
                assert_eq!(unseen.method, Method::Recapture);
                held += u64::from(
                    unseen.interval.0 <= missing && unseen.interval.1.is_none_or(|upper| missing <= upper),
                );
            }
            assert!(
                held >= 170,
                "{engine}, {budget}: the interval held {held} times of {RUNS}"
            );
        }
    }
}

#[test]
fn points_that_are_one_answer_only_roughly_are_no_lattice() {
    let problem = from_fn(Space::lattice(2, 60).unwrap(), 15.0, |x: &[f64]| {
        (x[0] - 30.0).hypot(x[1] - 30.0)
    })
    .boxed()
    .separation(4.0);
    let unseen = run(&problem, "random", 2_000, 0.2, 1).unseen.unwrap();
    assert_eq!(unseen.method, Method::Recapture);
    assert!(unseen.interval.1.is_some_and(|upper| upper < 3600.0));
}

#[test]
fn without_a_hit_of_the_engine_repetitions_count() {
    // f1 = 4, f2 = 1: 4 * 3 / (2 * 2) = 3 unseen, times the factor 99 / 100.
    let sample = Sample {
        probes: 100,
        fresh: 6,
        own_fresh: 6,
        distinct: 5,
        once: 4,
        twice: 1,
        ..Sample::default()
    };
    let unseen = sample.estimate().unwrap();
    assert_eq!(unseen.method, Method::Chao);
    approx::assert_relative_eq!(unseen.estimate, 2.97, max_relative = 1e-12);
    let (lower, upper) = (unseen.interval.0, unseen.interval.1.unwrap());
    assert!(lower <= 1.0 && (8.0..40.0).contains(&upper), "{unseen:?}");
    let alone = Sample {
        fresh: 1,
        once: 1,
        distinct: 1,
        probes: 100,
        ..Sample::default()
    };
    assert_eq!(alone.estimate().unwrap().interval, (0.0, None));
}

#[test]
fn edges_of_the_lattice_estimate() {
    let sample = |points: f64, known, probes, recaptures, fresh, distinct| Sample {
        points: Some(points),
        known,
        probes,
        recaptures,
        own_recaptures: recaptures,
        fresh,
        own_fresh: fresh,
        distinct,
        ..Sample::default()
    };
    let interval = |sample: Sample| {
        let unseen = sample.estimate().unwrap();
        (unseen.estimate, unseen.interval.0, unseen.interval.1.unwrap())
    };
    assert_eq!(Sample::default().estimate(), None);
    // No hit at all: 1 - 0.05^(1/100) of 1,000 points.
    assert_eq!(interval(sample(1000.0, 0, 100, 0, 0, 0)), (0.0, 0.0, 29.0));
    // One probe that misses says almost nothing.
    assert_eq!(interval(sample(1000.0, 0, 1, 0, 0, 0)), (0.0, 0.0, 950.0));
    // One probe that hits: at least 5 % of the points, one of which it found.
    assert_eq!(interval(sample(1000.0, 0, 1, 0, 1, 1)), (999.0, 49.0, 999.0));
    // Every point is a hit and the engine has them all.
    assert_eq!(interval(sample(1000.0, 1000, 50, 50, 0, 0)), (0.0, 0.0, 0.0));
    // Every point is a hit and the engine has one of them; both probes found the same other one.
    assert_eq!(interval(sample(10.0, 1, 2, 0, 2, 1)), (8.0, 2.0, 8.0));
    // More probes than points, and no integer in the interval: the nearest one.
    assert_eq!(interval(sample(3.0, 0, 100_000, 0, 33_600, 1)), (0.0, 0.0, 0.0));
}

#[test]
fn a_space_of_hits_alone_and_one_without() {
    let all = from_fn(Space::lattice(2, 50).unwrap(), 1.0, |_: &[f64]| 0.0).boxed();
    let none = from_fn(Space::lattice(2, 50).unwrap(), 1.0, |_: &[f64]| f64::NAN).boxed();
    for seed in 0..20 {
        let report = run(&all, "random", 1_000, 0.1, seed);
        let (lower, upper) = report.unseen.unwrap().interval;
        let missing = 2500.0 - report.hit_count() as f64;
        assert!(lower <= missing && missing <= upper.unwrap());
        assert!(lower > 0.9 * missing, "nothing but hits");
        let unseen = run(&none, "random", 1_000, 0.1, seed).unseen.unwrap();
        assert_eq!((unseen.estimate, unseen.interval.0), (0.0, 0.0));
        assert!(unseen.interval.1.unwrap() < 100.0);
    }
}

/// The engine's hits do not depend on the probes: they are those of a run without.
#[test]
fn probes_do_not_disturb_the_engine() {
    let problem = from_fn(Space::lattice(2, 200).unwrap(), 4.5, ring).boxed();
    let mut compared = 0;
    for entry in engine::all() {
        if ConfiguredEngine::<f64>::named(entry.name).unwrap().is_scheduled() {
            continue; // a schedule follows the whole budget, probes included
        }
        if entry.expensive_proposals {
            continue;
        }
        let engine = entry.name;
        let probed = run(&problem, engine, 5_000, 0.3, 5);
        let (evaluations, probes) = (probed.counts.evaluations, probed.counts.probes);
        let share = probes as f64 / evaluations as f64;
        assert!(0.28 < share && share <= 0.3, "{engine}: {share} is not about 0.3");
        let plain = run(&problem, engine, evaluations - probes, 0.0, 5);
        assert_eq!((plain.counts.probes, plain.unseen), (0, None));
        // The probed run has every hit of the plain run; all its other hits were found by probes.
        let known = |hit: &crate::Hit<'_, crate::Located<f64>>| plain.archive.contains(hit.solution);
        let both = probed.hits().filter(known).count();
        assert_eq!(both, plain.hit_count(), "{engine}");
        let unseen = probed.unseen.unwrap();
        assert!(probed.hit_count() - both <= unseen.fresh as usize, "{engine}");
        compared += usize::from(unseen.fresh > 0 && unseen.recaptures > 0);
    }
    assert!(
        compared >= 8,
        "{compared} engines were told apart from their probes"
    );
}

#[test]
fn every_hit_is_announced_and_counted_once() {
    let problem = from_fn(Space::lattice(2, 200).unwrap(), 4.5, ring).boxed();
    let mut search = Search::with(engine::DescentFlood::default()).probes(0.3);
    let mut announced = Vec::new();
    let mut observer = |hit: crate::Hit<'_, crate::Located<f64>>, count: usize| {
        announced.push((hit.solution.clone(), count));
        ControlFlow::Continue(())
    };
    let report = search
        .run_with(
            &problem,
            &Budget::hits(500).and_evaluations(50_000),
            crate::RunOptions::new().observer(&mut observer),
        )
        .unwrap();
    assert_eq!(report.hit_count(), 500);
    assert_eq!(report.trace.last().unwrap().hits, 500);
    assert!(report.hits().map(|hit| hit.evaluation).is_sorted());
    let listed: Vec<_> = report
        .hits()
        .enumerate()
        .map(|(i, hit)| (hit.solution.clone(), i + 1))
        .collect();
    assert_eq!(announced, listed);
    assert!(
        report.hits().all(|hit| report.archive.contains(hit.solution)),
        "none is hidden"
    );
}

#[test]
fn driven_by_hand_and_on_threads_it_is_the_same() {
    let problem = from_fn(Space::lattice(3, 60).unwrap(), 0.5, islands).boxed();
    let whole = run(&problem, "latest-hit-qpso", 4_000, 0.1, 3);
    let budget = Budget::evaluations(4_000);
    let search = || Search::with(engine::LatestHitQpso::default()).seed(3).probes(0.1);
    let threaded = search().threads(2).run(&problem, &budget).unwrap();
    let mut by_hand = search();
    let mut by_hand = by_hand.start(&problem, &budget).unwrap();
    loop {
        let candidates = by_hand.ask().unwrap();
        if candidates.is_empty() {
            break;
        }
        let fitness: Vec<f64> = candidates.iter().map(|c| problem.fitness(c)).collect();
        by_hand.tell(&fitness).unwrap();
    }
    for other in [threaded, by_hand.finish()] {
        assert_eq!(other.unseen, whole.unseen);
        assert_eq!(other.counts, whole.counts);
        assert_eq!(other.archive.solutions(), whole.archive.solutions());
    }
}

/// Proposes every point of a plane lattice once, except those of one row, which it claims to have excluded.
struct Rows {
    next: usize,
    skipped: Option<usize>,
}

impl Engine<f64> for Rows {
    fn begin(&mut self, _: &dyn Context<f64>) {
        self.next = 0;
    }
    fn ask(&mut self, context: &dyn Context<f64>, _: &mut SearchRng, out: &mut Batch<f64>) -> Ask {
        let rows = context.space().axes()[0].width() as usize;
        if self.next == rows {
            return Ask::Covered;
        }
        if self.skipped != Some(self.next) {
            for j in 0..context.space().axes()[1].width() as usize {
                out.push(&[self.next as f64 + 0.5, j as f64 + 0.5]);
            }
        }
        self.next += 1;
        Ask::More
    }
    fn tell(&mut self, _: &dyn Context<f64>, _: &Batch<f64>, _: &[Outcome<f64>], _: Origin) {}
    crate::saved_fields!(next);
}

#[test]
fn what_is_covered_is_proved_unless_a_probe_belies_it() {
    let problem = from_fn(Space::lattice(2, 60).unwrap(), 10.0, |x: &[f64]| x[0] + x[1]).boxed();
    let covered = |skipped, share| {
        Search::with(ConfiguredEngine::custom("rows", move || Rows {
            next: 0,
            skipped,
        }))
        .probes(share)
        .run(&problem, &Budget::evaluations(1_000_000))
        .unwrap()
    };
    for share in [0.0, 0.5] {
        let report = covered(None, share);
        assert_eq!(report.completeness, Completeness::Proved);
        assert_eq!(report.hit_count(), 55);
        let unseen = report.unseen.unwrap();
        assert_eq!(
            (unseen.estimate, unseen.interval, unseen.method),
            (0.0, (0.0, Some(0.0)), Method::Proved)
        );
    }
    let report = covered(Some(0), 0.5);
    assert_eq!(report.completeness, Completeness::Unknown);
    assert!(report.unseen.unwrap().fresh > 0);
}

#[test]
fn a_share_that_is_none_is_refused() {
    let problem = from_fn(Space::lattice(1, 9).unwrap(), 1.0, |x: &[f64]| x[0]).boxed();
    for share in [-0.1, 0.51, f64::NAN, f64::INFINITY] {
        let result = Search::with(engine::Random::default())
            .probes(share)
            .run(&problem, &Budget::evaluations(10));
        assert!(matches!(result, Err(Error::Parameter { .. })), "{share}");
    }
}

#[test]
fn an_open_interval_survives_json() {
    let unseen = Sample {
        probes: 3,
        ..Sample::default()
    }
    .estimate()
    .unwrap();
    let text = serde_json::to_string(&unseen).unwrap();
    assert!(text.contains(r#""interval":[0.0,null]"#), "{text}");
    assert_eq!(serde_json::from_str::<Unseen>(&text).unwrap(), unseen);
}

//! Pins the sequence of every engine: the first eight points, a digest of a longer run and its hits, in `tests/pinned/`.
//!
//! A change of these files changes results for a seed and belongs in CHANGELOG.md under "Changes results". Write them with
//!
//! ```text
//! UPDATE=1 cargo test -p satisfice --test pinned
//! ```
//!
//! The values hold where they were taken, on 64-bit x86 under Linux: engines call `ln`, `exp` and `pow` of the system's
//! library, whose last bits differ between platforms.

#![cfg(all(target_os = "linux", target_arch = "x86_64"))]
#![allow(clippy::unwrap_used, reason = "a test")]

use core::fmt::Write as _;
use std::path::Path;
use std::sync::Mutex;

use satisfice::{
    Bounds, Budget, Encoding, Located, Neighbourhood, Real, Region, SatisficingProblem, Search, Space, engine,
};

/// Points shown bit by bit.
const SHOWN: usize = 8;
/// Evaluations of a run.
const RUN: u64 = 3000;
/// Evaluations of a run of an engine whose proposals are expensive.
const SHORT_RUN: u64 = 120;

/// The settings under which an engine is pinned beside its defaults.
const SETTINGS: &[(&str, &[(&str, &str)])] = &[
    ("random", &[("exhaust", "yes")]),
    ("portfolio", &[("without", "recombination")]),
    ("portfolio", &[("neighbours", "late")]),
    ("qpso", &[("alpha", "1"), ("alpha-end", "0.5"), ("batch", "7")]),
    ("latest-hit-qpso", &[("batch", "30")]),
    ("latest-hit-qpso", &[("prune", "yes"), ("exhaust", "yes")]),
    (
        "pso",
        &[("particles", "64"), ("batch", "64"), ("deletion", "yes")],
    ),
    ("spso-2011", &[("informed", "0"), ("c", "1.1")]),
];

/// F is the distance to the nearest of three points, in units of the axes. Every point evaluated is recorded.
struct Bowls<S> {
    space: Space<S>,
    delta: f64,
    /// Whether neighbours and bounds are offered.
    guides: bool,
    evaluated: Mutex<Vec<u64>>,
}

const BOTTOMS: [f64; 3] = [0.2, 0.5, 0.9];

impl<S: Real> Bowls<S> {
    fn new(space: Space<S>, delta: f64, guides: bool) -> Self {
        Self {
            space,
            delta,
            guides,
            evaluated: Mutex::new(Vec::new()),
        }
    }

    /// The distance of a box from the nearest bottom.
    fn distance(&self, lower: &[S], upper: &[S]) -> f64 {
        let square = |bottom: f64| -> f64 {
            let sides = lower.iter().zip(upper);
            self.space
                .axes()
                .iter()
                .zip(sides)
                .map(|(axis, (lower, upper))| {
                    let share = |x: S| (x.f64() - axis.lower().f64()) / axis.width().f64();
                    let nearest = bottom.max(share(*lower)).min(share(*upper));
                    (nearest - bottom).powi(2)
                })
                .sum()
        };
        BOTTOMS
            .map(square)
            .into_iter()
            .fold(f64::INFINITY, f64::min)
            .sqrt()
    }
}

impl<S: Real> SatisficingProblem for Bowls<S> {
    type Scalar = S;
    type Solution = Located<S>;
    fn space(&self) -> &Space<S> {
        &self.space
    }
    fn decode(&self, values: &[S]) -> Located<S> {
        let continuous = self.space.axes().iter().any(|axis| !axis.is_integer());
        Located::new(values, S::of(if continuous { 0.04 } else { 0.0 }))
    }
    fn fitness(&self, solution: &Located<S>) -> S {
        let x = &solution.coordinates;
        self.evaluated
            .lock()
            .unwrap()
            .extend(x.iter().map(|x| x.to_word()));
        S::of(self.distance(x, x))
    }
    fn threshold(&self) -> S {
        S::of(self.delta)
    }
    fn encoding(&self) -> Option<&dyn Encoding<S, Located<S>>> {
        Some(self)
    }
    fn neighbourhood(&self) -> Option<&dyn Neighbourhood<Located<S>>> {
        self.guides.then_some(self as _)
    }
    fn bounds(&self) -> Option<&dyn Bounds<S>> {
        self.guides.then_some(self as _)
    }
}

impl<S: Real> Encoding<S, Located<S>> for Bowls<S> {
    fn encode(&self, solution: &Located<S>, values: &mut [S]) -> bool {
        values.copy_from_slice(&solution.coordinates);
        true
    }
}

impl<S: Real> Neighbourhood<Located<S>> for Bowls<S> {
    fn count(&self, _: &Located<S>) -> usize {
        2 * self.space.dimension()
    }

    fn neighbour(&self, of: &Located<S>, index: usize) -> Option<Located<S>> {
        let axis = self.space.axes().get(index / 2)?;
        let step = if index.is_multiple_of(2) {
            -S::one()
        } else {
            S::one()
        };
        let mut neighbour = of.clone();
        let there = &mut neighbour.coordinates[index / 2];
        *there = *there + step;
        (axis.lower() <= *there && *there <= axis.upper()).then_some(neighbour)
    }
}

impl<S: Real> Bounds<S> for Bowls<S> {
    fn lower_bound(&self, region: &Region<S>) -> Option<S> {
        // A little less than the distance, because it is rounded.
        Some(S::of(0.999 * self.distance(&region.lower, &region.upper)))
    }
}

/// One run: its first points by their bits, and a digest of all of its points.
fn run<S: Real>(name: &str, settings: &[(&str, &str)], problem: &Bowls<S>, out: &mut String) {
    let engine = engine::find(name)
        .unwrap()
        .configure(settings.iter().copied())
        .unwrap();
    let expensive = engine::find(name).unwrap().expensive_proposals;
    let evaluations = if expensive { SHORT_RUN } else { RUN };
    let report = Search::with(engine)
        .seed(42)
        .run(problem, &Budget::evaluations(evaluations))
        .unwrap();
    let words = problem.evaluated.lock().unwrap();
    for point in words.chunks(problem.space.dimension()).take(SHOWN) {
        let bits: Vec<String> = point.iter().map(|word| format!("{word:x}")).collect();
        writeln!(out, "{}", bits.join(" ")).unwrap();
    }
    // FNV-1a, over words.
    let digest = words.iter().fold(0xcbf2_9ce4_8422_2325_u64, |digest, word| {
        (digest ^ word).wrapping_mul(0x0100_0000_01b3)
    });
    let (hits, counts) = (report.hit_count(), report.counts);
    writeln!(
        out,
        "{hits} hits, {} evaluations, {} fitness calls, digest {digest:016x}\n",
        counts.evaluations, counts.fitness_calls
    )
    .unwrap();
}

fn every_space<S: Real>(name: &str, settings: &[(&str, &str)], out: &mut String) {
    let cube = Space::cube(3, S::of(-1.0), S::of(3.0)).unwrap();
    let lattice = Space::<S>::lattice(2, 200).unwrap();
    for (space, problem) in [
        ("three continuous axes", Bowls::new(cube, 0.05, false)),
        ("two integer axes", Bowls::new(lattice.clone(), 0.03, false)),
        (
            "two integer axes with neighbours and bounds",
            Bowls::new(lattice, 0.03, true),
        ),
    ] {
        writeln!(out, "{}, {space} {settings:?}", S::NAME).unwrap();
        run(name, settings, &problem, out);
    }
}

fn pinned(name: &str) -> String {
    let mut text = String::new();
    let settings = SETTINGS.iter().filter(|(engine, _)| *engine == name);
    for settings in [&[][..]]
        .into_iter()
        .chain(settings.map(|(_, settings)| *settings))
    {
        every_space::<f32>(name, settings, &mut text);
        every_space::<f64>(name, settings, &mut text);
    }
    text
}

#[test]
fn every_engine_proposes_the_points_that_are_written_down() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pinned");
    let mut changed = Vec::new();
    let texts: Vec<String> = std::thread::scope(|scope| {
        let all = engine::all().iter();
        let running: Vec<_> = all.map(|spec| scope.spawn(|| pinned(spec.name))).collect();
        running.into_iter().map(|text| text.join().unwrap()).collect()
    });
    for (spec, now) in engine::all().iter().zip(texts) {
        let file = folder.join(format!("{}.txt", spec.name));
        if std::env::var_os("UPDATE").is_some() {
            std::fs::write(&file, &now).unwrap();
        }
        let before = std::fs::read_to_string(&file).unwrap_or_default();
        let differing = now
            .lines()
            .zip(before.lines())
            .find(|(now, before)| now != before);
        if now != before {
            changed.push(format!("{}: {differing:?}", spec.name));
        }
    }
    assert!(
        changed.is_empty(),
        "results changed (now, before): {}",
        changed.join("\n")
    );
}

#[test]
fn every_file_belongs_to_an_engine() {
    for file in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pinned")).unwrap() {
        let path = file.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        assert!(
            engine::all().iter().any(|spec| spec.name == name),
            "{name} is no engine"
        );
    }
}

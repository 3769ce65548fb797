//! The conformance suite over every engine of the registry, and over broken ones that it must detect.

#![allow(clippy::unwrap_used, reason = "a test")]

use core::sync::atomic::{AtomicUsize, Ordering};

use satisfice::engine::{self, Ask, ConfiguredEngine, Origin, Steps};
use satisfice::state::{Part, Reader, State};
use satisfice::testing::engine::{EngineLaw, check, check_spec};
use satisfice::{
    Batch, Budget, Context, Engine, Error, Outcome, Search, SearchRng, Space, from_fn, saved_fields,
};

type Settings = &'static [(&'static str, &'static str)];

/// Settings worth a run of their own, beside the defaults of every engine, and whether they search at all: one particle is its
/// own mean and attractor and stays where it is, and without a well (alpha = 0) a swarm collapses.
const SETTINGS: &[(&str, Settings, bool)] = &[
    ("random", &[("batch", "1")], true),
    ("latest-hit-qpso", &[("particles", "1")], false),
    ("latest-hit-qpso", &[("batch", "30")], true),
    ("latest-hit-qpso", &[("alpha", "10")], true),
    ("latest-hit-qpso", &[("alpha", "0")], false),
    (
        "qpso",
        &[("alpha", "1"), ("alpha-end", "0.5"), ("batch", "7")],
        true,
    ),
    (
        "pso",
        &[("particles", "64"), ("batch", "64"), ("deletion", "yes")],
        true,
    ),
    ("spso-2011", &[("batch", "40"), ("informed", "0")], true),
    ("walk", &[("uniform", "0.5")], true),
    ("descent", &[("step", "1"), ("shortest", "1")], true),
];

/// Settings in place of the defaults of engines that would take minutes: the laws hold for models of any size.
const INSTEAD_OF_DEFAULTS: &[(&str, Settings)] = &[(
    "surrogate",
    &[("batch", "3"), ("candidates", "32"), ("points", "24")],
)];

/// Checks an engine at its defaults and under its settings above.
fn keeps_the_laws(name: &str) {
    let settings = SETTINGS.iter().filter(|(engine, ..)| *engine == name);
    let settings = settings.map(|&(_, settings, searches)| (settings, searches));
    let instead = INSTEAD_OF_DEFAULTS.iter().find(|(engine, _)| *engine == name);
    let first = instead.map_or(Settings::default(), |&(_, settings)| settings);
    for (settings, searches) in [(first, true)].into_iter().chain(settings) {
        let mut violations = check_spec(engine::find(name).unwrap(), settings).unwrap();
        violations.retain(|violation| searches || violation.law != EngineLaw::HitCount);
        let listed: Vec<String> = violations.iter().take(10).map(ToString::to_string).collect();
        assert!(
            violations.is_empty(),
            "{name} {settings:?}: {} violations\n{}",
            violations.len(),
            listed.join("\n")
        );
    }
}

/// A test for each engine of the registry, by the name of its settings.
macro_rules! laws {
    ($($engine:ident)*) => {
        #[allow(non_snake_case, reason = "the names of types")]
        mod laws {
            use satisfice::engine::{self, EngineConfig as _};

            $(#[test]
            fn $engine() {
                super::keeps_the_laws(engine::$engine::NAME);
            })*
        }
    };
}

satisfice::for_each_engine!(laws);

#[test]
fn every_default_is_in_its_range_and_every_engine_says_where_it_comes_from() {
    for entry in engine::all() {
        assert!(
            entry
                .configure::<f64>([])
                .and_then(|engine| engine.build())
                .is_ok(),
            "{}",
            entry.name
        );
        assert!(!entry.summary.is_empty() && !entry.citation.is_empty());
        assert_eq!(engine::find(entry.name).unwrap().name, entry.name);
    }
    let mut names: Vec<_> = engine::all().iter().map(|entry| entry.name).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), engine::all().len(), "a name twice");
}

/// The laws that an engine is found to break.
fn broken(engine: &ConfiguredEngine<f64>) -> Vec<EngineLaw> {
    let violations = check(engine).unwrap();
    let mut laws = Vec::new();
    for violation in violations {
        if !laws.contains(&violation.law) {
            laws.push(violation.law);
        }
    }
    laws
}

/// What an engine of these tests does wrong.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Fault {
    None,
    ProposesNaN,
    ProposesTwoCoordinates,
    ForgetsWhenSaved,
    AcceptsShortStates,
    FollowsTheBudget,
    RemembersOtherRuns,
    GivesUpOnNaN,
    StandsStill,
    SaysCovered,
    ProposesNothing,
}

/// Uniform sampling, half of it round the best point so far; with a fault.
struct Faulty {
    fault: Fault,
    best: Vec<f64>,
    fitness: f64,
    gave_up: bool,
}

static RUNS: AtomicUsize = AtomicUsize::new(0);

impl Faulty {
    fn with(fault: Fault) -> ConfiguredEngine<f64> {
        ConfiguredEngine::custom("faulty", move || Self {
            fault,
            best: Vec::new(),
            fitness: f64::INFINITY,
            gave_up: false,
        })
    }
}

impl Engine<f64> for Faulty {
    fn begin(&mut self, _: &dyn Context<f64>) {
        self.best.clear();
        self.fitness = f64::INFINITY;
        self.gave_up = false;
        RUNS.fetch_add(1, Ordering::Relaxed);
    }

    fn ask(&mut self, context: &dyn Context<f64>, rng: &mut SearchRng, out: &mut Batch<f64>) -> Ask {
        if self.gave_up {
            return Ask::Exhausted;
        }
        let space = context.space();
        let share = match self.fault {
            Fault::FollowsTheBudget => context.elapsed_share(),
            Fault::RemembersOtherRuns => RUNS.load(Ordering::Relaxed) as f64 * 0.37 % 1.0,
            _ => 0.5,
        };
        match self.fault {
            Fault::ProposesTwoCoordinates => out.push(&[space.axes()[0].lower(), 0.0]),
            Fault::ProposesNaN if rng.uniform() < 0.1 => out.push_with(|x| x.fill(f64::NAN)),
            Fault::StandsStill => out.push_with(|x| x.copy_from_slice(&space.region().lower)),
            Fault::ProposesNothing => {}
            _ => out.push_with(|x| {
                rng.position(space, x);
                if rng.uniform() < share {
                    for (x, best) in x.iter_mut().zip(&self.best) {
                        *x = (*x + best) / 2.0;
                    }
                }
            }),
        }
        if self.fault == Fault::SaysCovered {
            Ask::Covered
        } else {
            Ask::More
        }
    }

    fn tell(&mut self, _: &dyn Context<f64>, batch: &Batch<f64>, outcomes: &[Outcome<f64>], _: Origin) {
        for (point, outcome) in batch.points().zip(outcomes) {
            if outcome.fitness() < self.fitness {
                self.fitness = outcome.fitness();
                self.best = point.to_vec();
            }
            if self.fault == Fault::GivesUpOnNaN && *outcome == Outcome::NonFinite {
                self.gave_up = true;
            }
        }
    }

    fn save(&self, state: &mut State) {
        if self.fault != Fault::ForgetsWhenSaved {
            Part::save(&self.best, state);
        }
        Part::save(&self.fitness, state);
        Part::save(&self.gave_up, state);
    }

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        if self.fault != Fault::ForgetsWhenSaved {
            self.best = from.read()?;
        }
        self.fitness = from.read()?;
        let last = from.read();
        self.gave_up = if self.fault == Fault::AcceptsShortStates {
            last.unwrap_or_default()
        } else {
            last?
        };
        Ok(())
    }
}

#[test]
fn a_broken_engine_is_found_out() {
    for (fault, expected) in [
        (Fault::None, None),
        (Fault::ProposesNaN, Some(EngineLaw::Proposals)),
        (Fault::ProposesTwoCoordinates, Some(EngineLaw::Proposals)),
        (Fault::ForgetsWhenSaved, Some(EngineLaw::Restore)),
        (Fault::AcceptsShortStates, Some(EngineLaw::Restore)),
        (Fault::FollowsTheBudget, Some(EngineLaw::Prefix)),
        (Fault::RemembersOtherRuns, Some(EngineLaw::SameSeed)),
        (Fault::GivesUpOnNaN, Some(EngineLaw::NonFinite)),
        (Fault::StandsStill, Some(EngineLaw::HitCount)),
        (Fault::SaysCovered, Some(EngineLaw::Covered)),
        (Fault::ProposesNothing, Some(EngineLaw::HitCount)),
    ] {
        let laws = broken(&Faulty::with(fault));
        match expected {
            Some(law) => assert!(laws.contains(&law), "{fault:?}: {laws:?}"),
            None => assert_eq!(laws, []),
        }
    }
}

#[test]
fn an_engine_of_ten_lines_keeps_the_laws() {
    struct Uniform;
    impl Engine<f64> for Uniform {
        fn begin(&mut self, _: &dyn Context<f64>) {}
        fn ask(&mut self, context: &dyn Context<f64>, rng: &mut SearchRng, out: &mut Batch<f64>) -> Ask {
            out.push_with(|x| rng.position(context.space(), x));
            Ask::More
        }
        fn tell(&mut self, _: &dyn Context<f64>, _: &Batch<f64>, _: &[Outcome<f64>], _: Origin) {}
        saved_fields!();
    }
    assert_eq!(broken(&ConfiguredEngine::custom("uniform", || Uniform)), []);
}

/// Goes on stepping when it has been told to stop.
struct Deaf;

impl Engine<f64> for Deaf {
    fn begin(&mut self, _: &dyn Context<f64>) {}
    fn ask(&mut self, context: &dyn Context<f64>, rng: &mut SearchRng, out: &mut Batch<f64>) -> Ask {
        out.push_with(|position| rng.position(context.space(), position));
        Ask::More
    }
    fn advance(&mut self, rng: &mut SearchRng, steps: &mut dyn Steps<f64>) -> bool {
        let mut more = true;
        while more {
            more = steps.take(&mut [rng.uniform(), rng.uniform()]).1;
        }
        for _ in 0..10 {
            assert_eq!(steps.take(&mut [0.0, 0.0]), (Outcome::NotEvaluated, false));
        }
        true
    }
    fn tell(&mut self, _: &dyn Context<f64>, _: &Batch<f64>, _: &[Outcome<f64>], _: Origin) {}
    saved_fields!();
}

#[test]
fn an_engine_that_does_not_listen_overruns_no_budget() {
    let square = from_fn(Space::cube(2, 0.0, 1.0).unwrap(), 0.5, |x: &[f64]| x[0]);
    let report = Search::with(ConfiguredEngine::custom("deaf", || Deaf))
        .run(&square, &Budget::evaluations(777))
        .unwrap();
    assert_eq!(report.counts.evaluations, 777);
}

//! Robustness against its definition by plain recursion, laws of the logic, and the two falsification problems.
#![allow(clippy::unwrap_used, missing_docs)]

use approx::assert_relative_eq;
use satisfice::catalogue::Catalogued;
use satisfice::{SatisficingProblem, SearchRng};
use satisfice_problems::{Falsification, Specification, Trace, Transmission};

fn random_trace(rng: &mut SearchRng, length: usize) -> Trace {
    Trace::new(
        (0..2)
            .map(|_| (0..length).map(|_| rng.normal()).collect())
            .collect(),
    )
    .unwrap()
}

/// The three temporal operators at sample `now`, from their definition.
fn always(x: &[f64], now: usize, from: usize, to: usize) -> f64 {
    (now + from..=now + to)
        .filter_map(|k| x.get(k))
        .copied()
        .fold(f64::INFINITY, f64::min)
}
fn eventually(x: &[f64], now: usize, from: usize, to: usize) -> f64 {
    (now + from..=now + to)
        .filter_map(|k| x.get(k))
        .copied()
        .fold(f64::NEG_INFINITY, f64::max)
}
fn until(a: &[f64], b: &[f64], from: usize, to: usize) -> f64 {
    let mut best = f64::NEG_INFINITY;
    for k in (from..=to).filter(|k| *k < b.len()) {
        best = best.max(a[..k].iter().copied().fold(b[k], f64::min));
    }
    best
}

#[test]
fn robustness_is_that_of_the_definition() {
    let mut rng = SearchRng::new(2);
    for trial in 0..2_000 {
        let length = 1 + trial % 12;
        let trace = random_trace(&mut rng, length);
        let (from, extra) = (rng.below(4), rng.below(5));
        let steps = from..=from + extra;
        let a: Vec<f64> = trace.signals()[0].iter().map(|x| x - 0.1).collect();
        let b: Vec<f64> = trace.signals()[1].iter().map(|x| 0.2 - x).collect();
        let (is_above, is_below) = (Specification::above(0, 0.1), Specification::below(1, 0.2));
        let check = |formula: Specification, value: f64| assert_eq!(formula.robustness(&trace), value);
        check(
            is_above.clone().always(steps.clone()),
            always(&a, 0, from, from + extra),
        );
        check(
            is_below.clone().eventually(steps.clone()),
            eventually(&b, 0, from, from + extra),
        );
        check(
            is_above.clone().until(is_below.clone(), steps.clone()),
            until(&a, &b, from, from + extra),
        );
        check(is_above.clone().implies(is_below.clone()), (-a[0]).max(b[0]));
        // Nested: at all of the next samples, soon.
        let inner: Vec<f64> = (0..length).map(|now| eventually(&b, now, 0, 2)).collect();
        check(
            is_below.clone().eventually(0..=2).always(steps.clone()),
            always(&inner, 0, from, from + extra),
        );
        // De Morgan.
        let one = is_above.clone().eventually(steps.clone()).not();
        check(
            one,
            is_above.clone().not().always(steps.clone()).robustness(&trace),
        );
        let both = is_above.clone().and(is_below.clone());
        check(both.not(), is_above.not().or(is_below.not()).robustness(&trace));
    }
}

#[test]
fn ends_and_mistakes() {
    let trace = Trace::new(vec![vec![1.0, 2.0]]).unwrap();
    assert_eq!(
        Specification::above(0, 0.0).always(5..=9).robustness(&trace),
        f64::INFINITY
    );
    assert_eq!(
        Specification::above(0, 0.0).eventually(5..=9).robustness(&trace),
        f64::NEG_INFINITY
    );
    assert_eq!(
        Specification::above(0, 0.0)
            .always(0..=usize::MAX)
            .robustness(&trace),
        1.0
    );
    #[expect(clippy::reversed_empty_ranges, reason = "an empty interval")]
    let empty = 3..=1;
    assert_eq!(
        Specification::above(0, 0.0).always(empty).robustness(&trace),
        f64::INFINITY
    );
    assert!(Specification::above(7, 0.0).robustness(&trace).is_nan());
    assert!(Trace::new(vec![]).is_err() && Trace::new(vec![vec![]]).is_err());
    assert!(Trace::new(vec![vec![1.0], vec![1.0, 2.0]]).is_err());
}

#[test]
fn the_oscillators_fitness_is_a_robustness() {
    let oscillator = Falsification::new(20, 2.25).unwrap();
    let inside = Specification::below(0, 2.25)
        .and(Specification::above(0, -2.25))
        .always(0..=100);
    let mut rng = SearchRng::new(3);
    for _ in 0..500 {
        let cells: Vec<u32> = (0..5).map(|_| rng.below(20) as u32).collect();
        let trace = Trace::new(vec![oscillator.trajectory(&cells)]).unwrap();
        assert_relative_eq!(
            oscillator.fitness(&cells),
            inside.robustness(&trace),
            max_relative = 1e-12
        );
    }
}

#[test]
fn a_car() {
    let car = Transmission::new("speed", 10).unwrap();
    let still = car.trace(&[0, 0, 0, 0, 0, 0]).unwrap();
    assert!(still.signals()[0].iter().all(|v| *v == 0.0) && still.signals()[1].iter().all(|w| *w == 800.0));
    let fast = car.trace(&[9, 9, 9, 9, 0, 0]).unwrap();
    assert!(fast.signals()[0].is_sorted() && fast.signals()[2].is_sorted());
    assert!(car.trace(&[0; 5]).is_none() && car.fitness(&vec![99; 6]).is_nan());
    // The specifications as plain conditions on the samples.
    let mut rng = SearchRng::new(5);
    for name in ["speed", "engine", "calm-start", "late-gear"] {
        let car = Transmission::new(name, 10).unwrap();
        let mut falsified = 0;
        for _ in 0..2_000 {
            let cells: Vec<u32> = (0..6)
                .map(|k| rng.below(if k < 4 { 10 } else { 4 }) as u32)
                .collect();
            let trace = car.trace(&cells).unwrap();
            let [v, w, gear] = trace.signals() else {
                panic!("three signals")
            };
            let holds = match name {
                "speed" => v.iter().all(|v| *v < 110.0),
                "engine" => w.iter().all(|w| *w < 4780.0),
                "calm-start" => w.iter().any(|w| *w > 3200.0) || v[..=80].iter().all(|v| *v < 40.0),
                _ => {
                    let low = |to: usize| gear[..to].iter().all(|g| *g < 3.5);
                    low(gear.len()) || (0..=200).any(|k| v[k] > 100.0 && low(k))
                }
            };
            assert_eq!(car.fitness(&cells) > 0.0, holds, "{name} {cells:?}");
            falsified += u32::from(!holds);
        }
        assert!(falsified > 0, "{name}");
        let coarse = Transmission::new(name, 4).unwrap();
        assert!(coarse.reference_hits().is_some());
    }
    assert!(
        Transmission::new("sped", 10)
            .unwrap_err()
            .to_string()
            .contains("did you mean `speed`")
    );
    assert!(Transmission::new("speed", 1).is_err());
}

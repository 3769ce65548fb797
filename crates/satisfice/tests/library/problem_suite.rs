//! The suite for problems over the framework's own, and over broken ones that it must detect.

#![allow(clippy::unwrap_used, reason = "a test")]

use core::sync::atomic::{AtomicU32, Ordering};
use satisfice::{Bounds, Components, Encoding, Neighbourhood};

use satisfice::testing::problem::{ProblemLaw, check};
use satisfice::{Axis, Region, SatisficingProblem, Space, from_fn};

#[test]
fn closures_keep_the_laws_in_either_scalar_and_on_any_space() {
    let lattice = from_fn(Space::lattice(3, 7).unwrap(), 2.0, |x: &[f64]| x[0] + x[1] - x[2]).boxed();
    assert_eq!(check(&lattice, 1), []);
    let square = from_fn(Space::cube(2, -1.0, 1.0).unwrap(), 0.1, |x: &[f32]| {
        x[0].hypot(x[1])
    })
    .boxed();
    assert_eq!(check(&square, 2), []);
    let mixed = Space::new([
        Axis::integer(-3, 3),
        Axis::continuous(0.0, 1e-9),
        Axis::continuous(5.0, 5.0),
    ]);
    let mixed = from_fn(mixed.unwrap(), 0.0, |x: &[f64]| {
        if x[0] == 0.0 { f64::NAN } else { x[1] / x[0] }
    })
    .boxed();
    assert_eq!(check(&mixed, 3), []);
}

#[derive(Clone, Copy, PartialEq, Debug)]
enum Fault {
    None,
    ThresholdIsNaN,
    DecodeIntoForgets,
    FitnessCounts,
    FitnessAllIsRounded,
    EncodeLeavesTheSpace,
    EncodeIsOffByOne,
    NeighboursLeaveTheSpace,
    NeighboursBeyondTheCount,
    NeighboursAlternate,
    NeighboursAreWrittenOtherwise,
    BoundIsTooHigh,
    BoundIsNaN,
    ComponentsAreNone,
    ComponentsCount,
    ComponentsExceedTheirLimits,
    RepresentativeIsNoHit,
    RepresentativesWander,
}

/// The points of a lattice below a line, with a fault.
struct Faulty {
    space: Space<f64>,
    fault: Fault,
    calls: AtomicU32,
}

impl Faulty {
    fn count(&self) -> u32 {
        self.calls.fetch_add(1, Ordering::Relaxed)
    }
}

impl SatisficingProblem for Faulty {
    type Scalar = f64;
    type Solution = [i64; 2];
    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> [i64; 2] {
        [values[0] as i64, values[1] as i64]
    }
    fn decode_into(&self, values: &[f64], solution: &mut [i64; 2]) {
        solution[0] = values[0] as i64;
        if self.fault != Fault::DecodeIntoForgets {
            solution[1] = values[1] as i64;
        }
    }
    fn fitness(&self, &[a, b]: &[i64; 2]) -> f64 {
        let count = if self.fault == Fault::FitnessCounts {
            self.count()
        } else {
            0
        };
        (a + b) as f64 / 3.0 + f64::from(count)
    }
    fn fitness_all(&self, solutions: &[[i64; 2]], fitness: &mut [f64]) {
        for (solution, f) in solutions.iter().zip(fitness) {
            *f = self.fitness(solution);
            if self.fault == Fault::FitnessAllIsRounded {
                *f = f64::from(*f as f32);
            }
        }
    }
    fn threshold(&self) -> f64 {
        if self.fault == Fault::ThresholdIsNaN {
            f64::NAN
        } else {
            3.0
        }
    }
    fn canonical(&self, hit: &[i64; 2]) -> Option<[i64; 2]> {
        match self.fault {
            Fault::RepresentativeIsNoHit => Some([19, 19]),
            Fault::RepresentativesWander => Some([hit[0], (hit[1] - 1).max(0)]),
            _ => None,
        }
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, [i64; 2]>> {
        Some(self)
    }
    fn neighbourhood(&self) -> Option<&dyn Neighbourhood<[i64; 2]>> {
        Some(self)
    }
    fn bounds(&self) -> Option<&dyn Bounds<f64>> {
        Some(self)
    }
    fn components(&self) -> Option<&dyn Components<f64, [i64; 2]>> {
        Some(self)
    }
}

impl Encoding<f64, [i64; 2]> for Faulty {
    fn encode(&self, &[a, b]: &[i64; 2], values: &mut [f64]) -> bool {
        values.copy_from_slice(&[a as f64, b as f64]);
        match self.fault {
            Fault::EncodeLeavesTheSpace => values[0] -= 1.0,
            Fault::EncodeIsOffByOne if a > 0 => values[0] -= 1.0,
            _ => {}
        }
        true
    }
}

impl Neighbourhood<[i64; 2]> for Faulty {
    fn count(&self, _: &[i64; 2]) -> usize {
        1
    }

    fn neighbour(&self, &[a, b]: &[i64; 2], index: usize) -> Option<[i64; 2]> {
        if self.fault == Fault::NeighboursAlternate && self.count() % 2 == 1 {
            return None;
        }
        let exists = index == 0 || self.fault == Fault::NeighboursBeyondTheCount;
        let inside = a < 19 || self.fault == Fault::NeighboursLeaveTheSpace;
        (exists && inside).then_some([a + 1, b])
    }

    fn neighbour_into(&self, of: &[i64; 2], index: usize, neighbour: &mut [i64; 2]) -> bool {
        let found = self.neighbour(of, index);
        // What was in it is left, where it should be written over.
        if let Some([a, b]) = found {
            neighbour[0] = a;
            if self.fault != Fault::NeighboursAreWrittenOtherwise {
                neighbour[1] = b;
            }
        }
        found.is_some()
    }
}

impl Bounds<f64> for Faulty {
    fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
        Some(match self.fault {
            Fault::BoundIsTooHigh => (region.upper[0] + region.lower[1]) / 3.0,
            Fault::BoundIsNaN => f64::NAN,
            _ => (region.lower[0] + region.lower[1]) / 3.0,
        })
    }
}

impl Components<f64, [i64; 2]> for Faulty {
    fn count(&self) -> usize {
        if self.fault == Fault::ComponentsAreNone {
            0
        } else {
            2
        }
    }

    fn write(&self, &[a, b]: &[i64; 2], components: &mut [f64]) {
        let limit = match self.fault {
            Fault::ComponentsAreNone => return,
            Fault::ComponentsCount => 9.0 + f64::from(self.count()),
            Fault::ComponentsExceedTheirLimits => 6.0,
            _ => 9.0,
        };
        components.copy_from_slice(&[a as f64 / limit, b as f64 / limit]);
    }
}

#[test]
fn a_broken_problem_is_found_out() {
    for (fault, expected) in [
        (Fault::None, None),
        (Fault::ThresholdIsNaN, Some(ProblemLaw::Threshold)),
        (Fault::DecodeIntoForgets, Some(ProblemLaw::Decode)),
        (Fault::FitnessCounts, Some(ProblemLaw::Fitness)),
        (Fault::FitnessAllIsRounded, Some(ProblemLaw::Fitness)),
        (Fault::EncodeLeavesTheSpace, Some(ProblemLaw::Encode)),
        (Fault::EncodeIsOffByOne, Some(ProblemLaw::Encode)),
        (Fault::NeighboursLeaveTheSpace, Some(ProblemLaw::Neighbours)),
        (Fault::NeighboursAlternate, Some(ProblemLaw::Neighbours)),
        (Fault::NeighboursAreWrittenOtherwise, Some(ProblemLaw::Neighbours)),
        (Fault::NeighboursBeyondTheCount, Some(ProblemLaw::Neighbours)),
        (Fault::BoundIsTooHigh, Some(ProblemLaw::LowerBound)),
        (Fault::BoundIsNaN, Some(ProblemLaw::LowerBound)),
        (Fault::ComponentsAreNone, Some(ProblemLaw::Components)),
        (Fault::ComponentsCount, Some(ProblemLaw::Components)),
        (Fault::ComponentsExceedTheirLimits, Some(ProblemLaw::Components)),
        (Fault::RepresentativeIsNoHit, Some(ProblemLaw::Canonical)),
        (Fault::RepresentativesWander, Some(ProblemLaw::Canonical)),
    ] {
        let problem = Faulty {
            space: Space::lattice(2, 20).unwrap(),
            fault,
            calls: AtomicU32::new(0),
        };
        let laws: Vec<ProblemLaw> = check(&problem, 7).iter().map(|violation| violation.law).collect();
        match expected {
            Some(law) => assert!(laws.contains(&law), "{fault:?}: {laws:?}"),
            None => assert_eq!(laws, []),
        }
    }
}

/// Near is not the same as equal: a sameness that is not symmetric loses hits.
#[test]
fn a_one_sided_sameness_is_found_out() {
    #[derive(Clone)]
    struct OneSided(f64);
    impl satisfice::Identity for OneSided {
        fn key(&self) -> u64 {
            0
        }
        fn same(&self, other: &Self) -> bool {
            self.0 >= other.0
        }
    }
    struct Problem(Space<f64>);
    impl SatisficingProblem for Problem {
        type Scalar = f64;
        type Solution = OneSided;
        fn space(&self) -> &Space<f64> {
            &self.0
        }
        fn decode(&self, values: &[f64]) -> OneSided {
            OneSided(values[0])
        }
        fn fitness(&self, solution: &OneSided) -> f64 {
            solution.0
        }
        fn threshold(&self) -> f64 {
            0.0
        }
    }
    let laws: Vec<ProblemLaw> = check(&Problem(Space::cube(1, 0.0, 1.0).unwrap()), 1)
        .iter()
        .map(|violation| violation.law)
        .collect();
    assert_eq!(laws, [ProblemLaw::Identity]);
}

//! The suite for problems where random points say nothing: permutations, and hits that are rare.

#![allow(clippy::unwrap_used, reason = "a test")]

use satisfice::testing::problem::{ProblemLaw, check};
use satisfice::{Axis, Bounds, Components, Located, Region, SatisficingProblem, Space, from_fn};

/// Orders of five things that decode accepts only if they are orders, beside a category and a real.
struct Orders(Space<f64>);

impl SatisficingProblem for Orders {
    type Scalar = f64;
    type Solution = [u8; 5];
    fn space(&self) -> &Space<f64> {
        &self.0
    }
    fn decode(&self, values: &[f64]) -> [u8; 5] {
        self.0.check_values(values).unwrap();
        std::array::from_fn(|i| values[i + 1] as u8)
    }
    fn fitness(&self, order: &[u8; 5]) -> f64 {
        (0..5).map(|i| (f64::from(order[i]) - i as f64).abs()).sum()
    }
    fn threshold(&self) -> f64 {
        3.0
    }
    fn bounds(&self) -> Option<&dyn Bounds<f64>> {
        Some(self)
    }
}

impl Bounds<f64> for Orders {
    fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
        let apart = |i: usize| {
            let place = i as f64;
            (region.lower[i + 1] - place)
                .max(place - region.upper[i + 1])
                .max(0.0)
        };
        Some((0..5).map(apart).sum())
    }
}

#[test]
fn permutations_are_examined_at_orders_only() {
    let axes = [Axis::categorical(3)].into_iter().chain(Axis::permutation(5));
    let orders = Orders(Space::new(axes.chain([Axis::continuous(0.0, 1.0)])).unwrap());
    for seed in 0..20 {
        let checked = check(&orders, seed);
        assert_eq!(checked, [], "{checked}");
        assert_eq!(checked.untested, []);
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Fault {
    None,
    RepresentativeIsNoHit,
    RepresentativeIsOutside,
    ComponentsExceedTheirLimits,
}

/// A few points around one of 10^9.
struct Rare(Space<f64>, Fault);

impl SatisficingProblem for Rare {
    type Scalar = f64;
    type Solution = Located<f64>;
    fn space(&self) -> &Space<f64> {
        &self.0
    }
    fn decode(&self, values: &[f64]) -> Located<f64> {
        Located::new(values, 0.0)
    }
    fn fitness(&self, at: &Located<f64>) -> f64 {
        let x = &at.coordinates;
        (x[0] - x[1]).abs() + (x[1] - 500.0).abs() * 0.1 + (x[2] - 30.0).abs()
    }
    fn threshold(&self) -> f64 {
        3.0
    }
    fn encoding(&self) -> Option<&dyn satisfice::Encoding<f64, Located<f64>>> {
        Some(self)
    }
    fn components(&self) -> Option<&dyn Components<f64, Located<f64>>> {
        Some(self)
    }
    fn canonical(&self, hit: &Located<f64>) -> Option<Located<f64>> {
        let representative: &[f64] = match self.1 {
            Fault::RepresentativeIsNoHit => &[0.0, 0.0, 0.0],
            // A hit by its F, were it in the space.
            Fault::RepresentativeIsOutside => &[500.5, 500.5, 30.0],
            _ => return None,
        };
        Some(Located::new(representative, hit.separation.clone()))
    }
}

impl satisfice::Encoding<f64, Located<f64>> for Rare {
    fn encode(&self, at: &Located<f64>, values: &mut [f64]) -> bool {
        values.copy_from_slice(&at.coordinates);
        true
    }
}

impl Components<f64, Located<f64>> for Rare {
    fn count(&self) -> usize {
        1
    }
    fn write(&self, at: &Located<f64>, components: &mut [f64]) {
        let scale = if self.1 == Fault::ComponentsExceedTheirLimits {
            5000.0
        } else {
            1.0 / 3.0
        };
        components[0] = self.fitness(at) * scale;
    }
}

#[test]
fn laws_about_hits_are_tested_where_hits_are_rare() {
    let laws = |fault| {
        let checked = check(&Rare(Space::lattice(3, 1000).unwrap(), fault), 1);
        assert!(checked.hits > 0 && checked.untested.is_empty(), "{checked}");
        checked.iter().map(|violation| violation.law).collect::<Vec<_>>()
    };
    assert_eq!(laws(Fault::None), []);
    assert_eq!(laws(Fault::RepresentativeIsNoHit), [ProblemLaw::Canonical]);
    assert_eq!(laws(Fault::RepresentativeIsOutside), [ProblemLaw::Canonical]);
    assert_eq!(laws(Fault::ComponentsExceedTheirLimits), [ProblemLaw::Components]);
}

#[test]
fn what_was_not_tested_for_want_of_hits_is_said() {
    let space = Space::lattice(5, 1000).unwrap();
    let needle = from_fn(space, 0.5, |x: &[f64]| {
        f64::from(x != [7.0, 70.0, 700.0, 77.0, 770.0])
    });
    let checked = check(&needle.clone().boxed(), 1);
    assert_eq!(checked, []);
    assert_eq!(
        (checked.hits, &checked.untested[..]),
        (0, &[ProblemLaw::Canonical][..])
    );
    assert_eq!(
        checked.to_string(),
        "0 laws broken, 0 hits examined; not tested for want of hits: [Canonical]"
    );
    let checked = check(&needle.components(1, |_, c| c[0] = 5000.0).boxed(), 1);
    assert_eq!(checked.untested, [ProblemLaw::Components, ProblemLaw::Canonical]);
}

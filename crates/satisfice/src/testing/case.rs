//! The problem that the engine suite runs on: a ball in any space, with whatever may go wrong.

use core::sync::atomic::{AtomicU64, Ordering};
use std::sync::Mutex;

use crate::capability::{Encoding, Neighbourhood};
use crate::error::Error;
use crate::identity::Located;
use crate::problem::SatisficingProblem;
use crate::scalar::Real;
use crate::space::{Axis, Boundary, Space};

/// Values of F that are none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Poison<S> {
    /// None of them.
    Never,
    /// This one, at about a third of the points.
    Third(S),
    /// This one, everywhere.
    Everywhere(S),
}

/// F is the root mean square distance from a centre, each axis measured by its width, plus a shift; and books are kept of
/// what the search does with it.
#[derive(Debug)]
pub(crate) struct Case<S> {
    pub(crate) name: String,
    pub(crate) space: Space<S>,
    centre: Vec<S>,
    radius: S,
    shift: S,
    separation: S,
    /// Whether neighbours are offered, and encodings.
    offers: bool,
    pub(crate) poison: Poison<S>,
    /// Rounds of arithmetic that make F slow.
    pub(crate) work: u32,
    calls: AtomicU64,
    outside: Mutex<Option<String>>,
}

impl<S: Real> Case<S> {
    /// A ball round the point at three tenths of every axis, hits being closer than `radius`.
    pub(crate) fn new(name: &str, space: Space<S>, radius: f64) -> Self {
        let centre: Vec<S> = space.axes().iter().map(|axis| axis.value(axis.at(0.3))).collect();
        let continuous = space.axes().iter().filter(|axis| !axis.is_integer());
        let longest = continuous.fold(S::zero(), |longest, axis| longest.max(axis.width()));
        Self {
            name: name.to_owned(),
            centre,
            radius: S::of(radius),
            shift: S::zero(),
            separation: longest * S::of(0.02),
            space,
            offers: true,
            poison: Poison::Never,
            work: 0,
            calls: AtomicU64::new(0),
            outside: Mutex::new(None),
        }
    }

    /// The same, called something more.
    fn called(mut self, what: &str) -> Self {
        self.name = format!("{}, {what}", self.name);
        self
    }

    /// The same without neighbours and encodings.
    pub(crate) fn offering_nothing(mut self) -> Self {
        self.offers = false;
        self.called("nothing offered")
    }

    /// The same with the threshold moved to `threshold`, and F with it.
    pub(crate) fn with_threshold(mut self, threshold: f64) -> Self {
        self.shift = S::of(threshold) - self.radius;
        self.called(&format!("threshold {threshold}"))
    }

    pub(crate) fn poisoned(mut self, poison: Poison<S>) -> Self {
        self.poison = poison;
        self.called(&format!("fitness {poison:?}"))
    }

    /// The same with the centre moved by a share of every axis.
    pub(crate) fn moved(mut self, share: f64) -> Self {
        for (axis, c) in self.space.axes().iter().zip(&mut self.centre) {
            *c = axis.value((*c + S::of(share) * axis.width()).min(axis.end()));
        }
        self.called(&format!("moved by {share}"))
    }

    /// How often F was called.
    pub(crate) fn calls(&self) -> u64 {
        self.calls.load(Ordering::Relaxed)
    }

    /// Values that were outside the space or not whole on an integer axis, if any were.
    pub(crate) fn outside(&self) -> Option<String> {
        self.outside.lock().ok().and_then(|outside| outside.clone())
    }

    /// F without its books.
    pub(crate) fn value(&self, values: &[S]) -> S {
        let bits = |sum: u64, x: &S| {
            (sum ^ x.to_word())
                .wrapping_mul(0x9e37_79b9_7f4a_7c15)
                .rotate_left(29)
        };
        match self.poison {
            Poison::Everywhere(value) => value,
            Poison::Third(value) if values.iter().fold(0, bits) % 3 == 0 => value,
            _ => self.plain(values),
        }
    }

    /// F without its poison either.
    fn plain(&self, values: &[S]) -> S {
        let mut sum = S::zero();
        for ((axis, &x), &c) in self.space.axes().iter().zip(values).zip(&self.centre) {
            if axis.width() > S::zero() {
                let d = (x - c) / axis.width();
                sum = sum + d * d;
            }
        }
        (sum / S::of(values.len() as f64)).sqrt() + self.shift
    }

    /// The number of hits of a space of integers only, by looking at each point.
    pub(crate) fn count(&self) -> u64 {
        let axes = self.space.axes();
        let mut values: Vec<S> = axes.iter().map(Axis::lower).collect();
        let mut count = 0;
        loop {
            count += u64::from(self.plain(&values) < self.threshold());
            // The next point, the last axis fastest.
            let Some(j) = (0..axes.len()).rfind(|&j| values[j] < axes[j].upper()) else {
                return count;
            };
            values[j] = values[j] + S::one();
            for later in j + 1..axes.len() {
                values[later] = axes[later].lower();
            }
        }
    }
}

impl<S: Real> SatisficingProblem for Case<S> {
    type Scalar = S;
    type Solution = Located<S>;

    fn space(&self) -> &Space<S> {
        &self.space
    }

    fn decode(&self, values: &[S]) -> Located<S> {
        let inside = values.len() == self.space.dimension()
            && self.space.axes().iter().zip(values).all(|(axis, &x)| {
                axis.lower() <= x && x <= axis.upper() && (!axis.is_integer() || x.fract() == S::zero())
            });
        if !inside && let Ok(mut outside) = self.outside.lock() {
            outside.get_or_insert_with(|| format!("{values:?}"));
        }
        Located::new(values, self.separation)
    }

    fn fitness(&self, solution: &Located<S>) -> S {
        self.calls.fetch_add(1, Ordering::Relaxed);
        let mut x = 1.0_f64;
        for _ in 0..self.work {
            x = core::hint::black_box(x + 1.0 / x);
        }
        self.value(&solution.coordinates)
    }

    fn threshold(&self) -> S {
        self.radius + self.shift
    }

    fn encoding(&self) -> Option<&dyn Encoding<S, Located<S>>> {
        self.offers.then_some(self as _)
    }

    fn neighbourhood(&self) -> Option<&dyn Neighbourhood<Located<S>>> {
        self.offers.then_some(self as _)
    }
}

impl<S: Real> Encoding<S, Located<S>> for Case<S> {
    fn encode(&self, solution: &Located<S>, values: &mut [S]) -> bool {
        values.copy_from_slice(&solution.coordinates);
        true
    }
}

impl<S: Real> Neighbourhood<Located<S>> for Case<S> {
    fn count(&self, _: &Located<S>) -> usize {
        2 * self.space.dimension()
    }

    fn neighbour(&self, of: &Located<S>, index: usize) -> Option<Located<S>> {
        let axis = self.space.axes().get(index / 2)?;
        let step = if axis.is_integer() {
            S::one()
        } else {
            axis.width() * S::of(0.03)
        };
        let here = of.coordinates[index / 2];
        let there = if index.is_multiple_of(2) {
            here - step
        } else {
            here + step
        };
        (axis.lower() <= there && there <= axis.upper()).then(|| {
            let mut neighbour = of.clone();
            neighbour.coordinates[index / 2] = there;
            neighbour
        })
    }
}

/// One case for each kind of space: one axis and fifty, integer, continuous and mixed, of width zero, of one point, under
/// each boundary rule.
pub(crate) fn spaces<S: Real>() -> Result<Vec<Case<S>>, Error> {
    let (zero, one) = (S::zero(), S::one());
    let fixed = Axis::continuous(one, one);
    Ok(vec![
        Case::new("one integer axis", Space::new([Axis::integer(-100, 99)])?, 0.02),
        Case::new("one continuous axis", Space::cube(1, -one, one)?, 0.02),
        Case::new("a 40 x 40 lattice", Space::lattice(2, 40)?, 0.1),
        Case::new("a square", Space::cube(2, -one, one)?, 0.05),
        Case::new(
            "mixed axes",
            Space::new([
                Axis::integer(0, 30),
                Axis::continuous(zero, one),
                Axis::integer(-5, 5),
            ])?,
            0.15,
        ),
        Case::new(
            "axes of width zero among others",
            Space::new([
                fixed,
                Axis::integer(0, 50),
                Axis::integer(7, 7),
                Axis::continuous(zero, one),
            ])?,
            0.08,
        ),
        Case::new("fifty continuous axes", Space::cube(50, -one, one)?, 0.3),
        Case::new("fifty integer axes", Space::lattice(50, 10)?, 0.3),
        Case::new("one point", Space::new([fixed, Axis::integer(3, 3)])?, 0.1),
        Case::new(
            "a clamped square",
            Space::cube(2, -one, one)?.with_boundary(Boundary::Clamp),
            0.05,
        ),
        Case::new(
            "a periodic lattice",
            Space::lattice(2, 40)?.with_boundary(Boundary::Wrap),
            0.1,
        ),
    ])
}

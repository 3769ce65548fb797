//! Constraint satisfaction: F counts violated constraints, a hit violates none.
//!
//! The alternative to a search is an exact method: a constraint solver that enumerates all solutions (CP-SAT, Gecode) or, for
//! these sizes, [`backtrack`].

mod backtracking;
mod costas;
mod dimacs;
mod graph_colouring;
mod langford;
mod latin_square;
mod lists;
mod magic_square;
mod queens;
mod sat;

pub use backtracking::{Backtracking, Extendable, backtrack};
pub use costas::Costas;
pub use graph_colouring::{Graph, GraphColouring};
pub use langford::Langford;
pub use latin_square::LatinSquare;
pub use magic_square::MagicSquare;
pub use queens::Queens;
pub use sat::{Formula, Sat};

use satisfice::Error;

use crate::lattice::Lattice;

/// The words of the parameter `encoding`.
const ENCODINGS: &[&str] = &["integer", "random-key"];

/// How the axes encode a permutation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Encoding {
    /// An integer axis for each place; values may repeat, which counts as a violation.
    #[default]
    Integer,
    /// A real axis for each place, whose rank among all is the value (Bean 1994, doi 10.1287/ijoc.6.2.154).
    RandomKey,
}

impl Encoding {
    fn of(word: &str) -> Self {
        if word == ENCODINGS[1] {
            Self::RandomKey
        } else {
            Self::Integer
        }
    }

    fn name(self) -> &'static str {
        ENCODINGS[usize::from(self == Self::RandomKey)]
    }

    fn lattice(self, n: usize) -> Result<Lattice, Error> {
        match self {
            Self::Integer => Lattice::new(vec![n; n]),
            Self::RandomKey => Lattice::permutations(n),
        }
    }
}

/// Number of violations among the variables that have a value; more values never make fewer violations.
trait Violations {
    fn violations(&self, value: impl Fn(usize) -> Option<u32>) -> u32;
}

/// The methods of `SatisficingProblem` from `Violations`, beside `lattice_methods!`; needs `constraint_bounds!`.
macro_rules! constraint_methods {
    () => {
        $crate::lattice::lattice_methods!();

        #[inline]
        fn fitness(&self, values: &Vec<u32>) -> f64 {
            if !self.lattice.holds(values) {
                return f64::NAN;
            }
            f64::from(self.violations(|variable| Some(values[variable])))
        }

        fn neighbourhood(&self) -> Option<&dyn satisfice::Neighbourhood<Vec<u32>>> {
            Some(&self.lattice)
        }

        fn bounds(&self) -> Option<&dyn satisfice::Bounds<f64>> {
            (!self.lattice.has_keys()).then_some(self as _)
        }
    };
}
use constraint_methods;

/// Lower bounds from `Violations`.
macro_rules! constraint_bounds {
    ($problem:ty) => {
        impl satisfice::Bounds<f64> for $problem {
            /// Violations among the variables that the region leaves no choice.
            fn lower_bound(&self, region: &satisfice::Region<f64>) -> Option<f64> {
                let n = self.lattice.space().dimension();
                if region.lower.len() != n || region.upper.len() != n {
                    return None;
                }
                let fixed = |variable: usize| {
                    let value = region.lower[variable];
                    (value == region.upper[variable]).then_some(value as u32)
                };
                Some(f64::from(self.violations(fixed)))
            }
        }
    };
}
use constraint_bounds;

/// Reference counts are made by backtracking within this many nodes: a second or two.
const NODES: u64 = 30_000_000;

pub(crate) fn counted(problem: &impl Extendable) -> Option<u64> {
    let result = backtrack(problem, NODES, &mut |_| ());
    result.complete.then_some(result.solutions)
}

//! Satisfiability of random and given formulas.

use core::fmt::Write;

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, SatisficingProblem, SearchRng};

use super::lists::Lists;
use super::{Extendable, Violations, constraint_bounds, constraint_methods, counted, dimacs};
use crate::lattice::{Lattice, description};

/// A formula in conjunctive normal form.
///
/// ```
/// use satisfice_problems::Formula;
/// let formula = Formula::random(20, 85, 1)?;
/// assert_eq!((formula.variables, formula.clauses.len()), (20, 85));
/// assert!(formula.dimacs().starts_with("p cnf 20 85"));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Formula {
    /// Number of variables, n.
    pub variables: usize,
    /// Clauses of literals: `v + 1` says that variable `v` is true, `-(v + 1)` that it is false.
    pub clauses: Vec<Vec<i32>>,
}

impl Formula {
    /// A uniform random 3-SAT formula: each clause has three different variables, each negated with probability 1/2.
    /// Satisfiable and unsatisfiable formulas are equally likely at 4.267 clauses per variable (Mézard, Parisi, Zecchina
    /// 2002, doi 10.1126/science.1073287), for many variables.
    ///
    /// # Errors
    /// [`Error::Parameter`] for fewer than 3 variables.
    pub fn random(variables: usize, clauses: usize, seed: u64) -> Result<Self, Error> {
        if !(3..=100_000).contains(&variables) {
            return Err(Error::parameter(
                "variables",
                variables,
                "a whole number from 3 to 100000",
            ));
        }
        let mut rng = SearchRng::new(seed);
        let mut clause = || {
            let mut clause: Vec<i32> = Vec::with_capacity(3);
            while clause.len() < 3 {
                let variable = rng.below(variables) as i32 + 1;
                let (_, negated) = rng.uniform_and_sign();
                if clause.iter().all(|literal| literal.abs() != variable) {
                    clause.push(if negated { -variable } else { variable });
                }
            }
            clause
        };
        Ok(Self {
            variables,
            clauses: (0..clauses).map(|_| clause()).collect(),
        })
    }

    /// The formula of a DIMACS `cnf` file.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the parameter `file` if it cannot be read, is malformed, or has not as many clauses
    /// as it announces.
    pub fn read_dimacs(path: &str) -> Result<Self, Error> {
        let (variables, clauses) = dimacs::clauses(path, &dimacs::read(path)?)?;
        Ok(Self { variables, clauses })
    }

    /// The formula in DIMACS `cnf` format.
    #[must_use]
    pub fn dimacs(&self) -> String {
        let mut text = format!("p cnf {} {}\n", self.variables, self.clauses.len());
        for clause in &self.clauses {
            for literal in clause {
                // Writing to a string does not fail.
                let _ = write!(text, "{literal} ");
            }
            text.push_str("0\n");
        }
        text
    }
}

/// All models of a formula in conjunctive normal form: random 3-SAT near the threshold by default, or a DIMACS file.
///
/// F is the number of unsatisfied clauses; a hit is F < 1. A solution is 0 or 1 for each variable; a neighbour has
/// one flipped. Reference counts are by backtracking over the variables with a check of every clause that is complete.
///
/// Source: Cook 1971, doi 10.1145/800157.805047; the random family: Mitchell, Selman, Levesque 1992.
///
/// ```
/// use satisfice::SatisficingProblem;
/// use satisfice_problems::{Formula, Sat};
/// // (x1 or not x2) and (x2 or x3)
/// let problem = Sat::new(&Formula { variables: 3, clauses: vec![vec![1, -2], vec![2, 3]] })?;
/// assert_eq!(problem.fitness(&vec![1, 1, 0]), 0.0);
/// assert_eq!(problem.fitness(&vec![0, 1, 0]), 1.0);
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Sat {
    lattice: Lattice,
    threshold: f64,
    description: Description,
    clauses: Lists<i32>,
    /// For each variable the clauses of which it is the last.
    ends: Lists<u32>,
    /// Clauses without a literal: never satisfied.
    empty: bool,
}

impl Sat {
    /// The models of `formula`.
    ///
    /// # Errors
    /// [`Error::NoAxis`] without variables, [`Error::Parameter`] for a literal of no variable.
    pub fn new(formula: &Formula) -> Result<Self, Error> {
        Self::described([("variables", formula.variables.to_string())], formula)
    }

    fn described<const N: usize>(parameters: [(&str, String); N], formula: &Formula) -> Result<Self, Error> {
        let outside = |literal: &&i32| !(1..=formula.variables).contains(&(literal.unsigned_abs() as usize));
        if let Some(literal) = formula.clauses.iter().flatten().find(outside) {
            let allowed = format!("from 1 to {}, or its negative", formula.variables);
            return Err(Error::parameter("literal", literal, allowed));
        }
        let clauses = Lists::new(formula.clauses.iter().map(Vec::as_slice)).ok_or_else(|| {
            Error::parameter(
                "clauses",
                formula.clauses.len(),
                "fewer than 2^32 literals in all",
            )
        })?;
        let last = |clause: &[i32]| clause.iter().map(|&literal| wanted(literal).0).max();
        Ok(Self {
            lattice: Lattice::new(vec![2; formula.variables])?,
            threshold: 1.0,
            description: description(Self::NAME, parameters),
            empty: formula.clauses.iter().any(Vec::is_empty),
            ends: Lists::positions(
                formula.variables,
                formula.clauses.iter().map(|clause| last(clause)),
            ),
            clauses,
        })
    }
}

/// The variable of a literal, and the value that makes it true.
#[inline]
fn wanted(literal: i32) -> (usize, u32) {
    (literal.unsigned_abs() as usize - 1, u32::from(literal > 0))
}

impl Violations for Sat {
    /// Cost: one step per literal.
    #[inline]
    fn violations(&self, value: impl Fn(usize) -> Option<u32>) -> u32 {
        let is_false = |&literal: &i32| {
            let (variable, wanted) = wanted(literal);
            value(variable).is_some_and(|value| value != wanted)
        };
        let falsified = |clause: &[i32]| match clause {
            // Values cannot be foreseen, so that a branch costs more than a literal: all three are looked at. That variables have none can.
            [a, b, c] => value(wanted(*a).0).is_some() && (is_false(a) & is_false(b) & is_false(c)),
            _ => clause.iter().all(is_false),
        };
        self.clauses
            .iter()
            .map(|clause| u32::from(falsified(clause)))
            .sum()
    }
}

impl Extendable for Sat {
    fn values(&self, variable: usize) -> Option<u32> {
        (variable < self.ends.len()).then_some(2)
    }
    fn extends(&self, partial: &[u32]) -> bool {
        let satisfied = |&clause: &u32| {
            self.clauses.get(clause as usize).iter().any(|&literal| {
                let (variable, wanted) = wanted(literal);
                partial[variable] == wanted
            })
        };
        !self.empty && self.ends.get(partial.len() - 1).iter().all(satisfied)
    }
}

impl SatisficingProblem for Sat {
    constraint_methods!();
}

constraint_bounds!(Sat);

impl Catalogued for Sat {
    const NAME: &'static str = "sat";
    const SUMMARY: &'static str = "models of a random 3-SAT formula near the threshold, or of a DIMACS file";
    const SOURCE: &'static str = "Mitchell, Selman, Levesque 1992 (AAAI); counts by backtracking";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer("variables", "number of variables, n", 20, 3, 100_000),
        Parameter::real(
            "ratio",
            "clauses per variable; half of all formulas are satisfiable near 4.267",
            4.267,
            0.0,
            100.0,
        ),
        Parameter::integer("formula-seed", "which random formula", 2, 0, i64::MAX),
        Parameter::text(
            "file",
            "path of a formula in DIMACS `cnf` format, instead of a random one",
            "",
        ),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        let file = params.text("file");
        if !file.is_empty() {
            return Self::described([("file", file.to_owned())], &Formula::read_dimacs(file)?);
        }
        let (variables, seed) = (params.count("variables"), params.count("formula-seed"));
        let clauses = (params.real("ratio") * variables as f64).round() as usize;
        let parameters = [
            ("variables", variables.to_string()),
            ("ratio", params.real("ratio").to_string()),
            ("formula-seed", seed.to_string()),
        ];
        Self::described(parameters, &Formula::random(variables, clauses, seed as u64)?)
    }

    fn reference_hits(&self) -> Option<u64> {
        counted(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Clauses of 0 to 5 literals, every assignment of six variables, with the referee that the definition is.
    #[test]
    fn unsatisfied_clauses_of_any_length_are_counted() {
        let mut rng = SearchRng::new(5);
        let literal = |rng: &mut SearchRng| {
            let variable = rng.below(6) as i32 + 1;
            if rng.below(2) == 0 { -variable } else { variable }
        };
        let clauses: Vec<Vec<i32>> = (0..60)
            .map(|clause| (0..clause % 6).map(|_| literal(&mut rng)).collect())
            .collect();
        let formula = Formula {
            variables: 6,
            clauses,
        };
        let problem = Sat::new(&formula).unwrap();
        for assignment in 0..64_u32 {
            let values: Vec<u32> = (0..6).map(|variable| assignment >> variable & 1).collect();
            let holds = |literal: &i32| (values[literal.unsigned_abs() as usize - 1] == 1) == (*literal > 0);
            let expected = formula.clauses.iter().filter(|clause| !clause.iter().any(holds));
            assert_eq!(
                problem.fitness(&values),
                expected.count() as f64,
                "{assignment:06b}"
            );
        }
    }
}

//! Whether a polynomial equation and strict inequalities of the time have a common solution: exact, and always decided.
//!
//! The step is halved. A piece is discarded if the signs of a form's coefficients exclude a solution, and accepted if they
//! prove one. Where an equation has one root, the signs of the inequalities there decide. What is left after a few halvings has repeated or
//! common roots, as a rule. It is prepared: roots are made simple and roots that violate an inequality are divided out. The halving of
//! what remains ends, because close to a simple root the signs of the coefficients change exactly once (Vincent's theorem; Collins and
//! Akritas 1976). It can take seconds where coordinates differ by hundreds of digits, so that every halving looks at the deadline.

use super::deadline::{CutShort, Deadline};
use super::divisors::{sign_at_root, squarefree, without_roots_of};
use super::form::Form;

/// Halvings before roots are made simple: few where an equation leaves only its roots to look at, more where the boundaries of
/// every inequality would have to be prepared.
const HALVINGS_WITH_EQUATION: u32 = 3;
const HALVINGS_WITHOUT: u32 = 12;

/// `equation = 0` (if there is one) and `positive > 0` for all of these, with `0 <= t <= 1`.
#[derive(Debug, Clone)]
pub(super) struct System {
    /// Not 0 everywhere.
    pub(super) equation: Option<Form>,
    pub(super) positive: Vec<Form>,
}

/// What the coefficients tell about a piece.
enum Solvability {
    Solvable,
    Unsolvable,
    Unclear,
}

impl System {
    /// Whether there is a solution.
    pub(super) fn is_solvable(&self, deadline: Deadline<'_>) -> Result<bool, CutShort> {
        if self.holds_at_start() || self.holds_at_end() {
            return Ok(true);
        }
        self.is_solvable_inside(self.plain_halvings(), deadline)
    }

    /// The first piece of the step cut into `2^levels` pieces that contains the infimum of the solutions, as its number.
    pub(super) fn earliest(&self, levels: u32, deadline: Deadline<'_>) -> Result<Option<u64>, CutShort> {
        if self.holds_at_start() {
            return Ok(Some(0));
        }
        let last = (1_u64 << levels) - 1;
        let inside = self.earliest_inside(levels, 0, deadline)?;
        Ok(inside.or_else(|| self.holds_at_end().then_some(last)))
    }

    fn earliest_inside(
        &self,
        levels: u32,
        number: u64,
        deadline: Deadline<'_>,
    ) -> Result<Option<u64>, CutShort> {
        match self.sight() {
            Solvability::Unsolvable => return Ok(None),
            // Without an equation solutions begin at once.
            Solvability::Solvable if self.equation.is_none() => return Ok(Some(number << levels)),
            Solvability::Solvable | Solvability::Unclear => {}
        }
        if let Some(equation) = self.only_root() {
            let holds = holds_at_root(equation, &self.positive, deadline)?;
            return Ok(holds.then(|| piece_of_root(equation, levels, number)));
        }
        deadline.check()?;
        if levels == 0 {
            let is_solvable = self.is_solvable_inside(self.plain_halvings(), deadline)?;
            return Ok(is_solvable.then_some(number));
        }
        let (first, second) = self.halves();
        if let Some(piece) = first.earliest_inside(levels - 1, 2 * number, deadline)? {
            return Ok(Some(piece));
        }
        if second.holds_at_start() && second.equation.is_some() {
            // The solution is the middle itself.
            return Ok(Some((2 * number + 1) << (levels - 1)));
        }
        second.earliest_inside(levels - 1, 2 * number + 1, deadline)
    }

    fn holds_at_start(&self) -> bool {
        self.equation
            .as_ref()
            .is_none_or(|form| form.sign_at_start() == 0)
            && self.positive.iter().all(|form| form.sign_at_start() > 0)
    }

    fn holds_at_end(&self) -> bool {
        self.equation.as_ref().is_none_or(|form| form.sign_at_end() == 0)
            && self.positive.iter().all(|form| form.sign_at_end() > 0)
    }

    fn plain_halvings(&self) -> u32 {
        if self.equation.is_some() {
            HALVINGS_WITH_EQUATION
        } else {
            HALVINGS_WITHOUT
        }
    }

    /// Whether there is a solution with `0 < t < 1`.
    fn is_solvable_inside(&self, halvings: u32, deadline: Deadline<'_>) -> Result<bool, CutShort> {
        match self.sight() {
            Solvability::Solvable => return Ok(true),
            Solvability::Unsolvable => return Ok(false),
            Solvability::Unclear => {}
        }
        if let Some(equation) = self.only_root() {
            return holds_at_root(equation, &self.positive, deadline);
        }
        deadline.check()?;
        if halvings == 0 {
            return self.is_solvable_with_simple_roots(deadline);
        }
        let (first, second) = self.halves();
        Ok(first.holds_at_end()
            || first.is_solvable_inside(halvings - 1, deadline)?
            || second.is_solvable_inside(halvings - 1, deadline)?)
    }

    /// The equation, if it has exactly one root with `0 < t < 1`.
    fn only_root(&self) -> Option<&Form> {
        self.equation.as_ref().filter(|form| form.sign_changes() == 1)
    }

    fn sight(&self) -> Solvability {
        if self.positive.iter().any(Form::is_nowhere_positive) {
            return Solvability::Unsolvable;
        }
        let changes = match &self.equation {
            None => 1,
            Some(form) => form.sign_changes(),
        };
        if changes == 0 {
            Solvability::Unsolvable
        } else if changes == 1 && self.positive.iter().all(Form::is_positive_inside) {
            Solvability::Solvable
        } else {
            Solvability::Unclear
        }
    }

    /// The system on each half of the step. Inequalities that hold inside the whole step are not tested again.
    fn halves(&self) -> (Self, Self) {
        let half = |part: fn(&Form) -> Form| Self {
            equation: self.equation.as_ref().map(part),
            positive: self
                .positive
                .iter()
                .filter(|form| !is_positive_everywhere(form))
                .map(part)
                .collect(),
        };
        (half(Form::first_half), half(Form::second_half))
    }

    fn is_solvable_with_simple_roots(&self, deadline: Deadline<'_>) -> Result<bool, CutShort> {
        if let Some(equation) = &self.equation {
            let mut roots = squarefree(equation, deadline)?;
            for form in &self.positive {
                roots = without_roots_of(&roots, form, deadline)?;
            }
            return has_accepted_root(&roots, &self.positive, deadline);
        }
        let Some((first, others)) = self.positive.split_first() else {
            return Ok(false);
        };
        let mut boundaries = squarefree(first, deadline)?;
        for form in others {
            let form = squarefree(form, deadline)?;
            boundaries = &boundaries * &without_roots_of(&form, &boundaries, deadline)?;
        }
        has_accepted_gap(&boundaries, &self.positive, deadline)
    }
}

fn is_positive_everywhere(form: &Form) -> bool {
    form.is_positive_inside() && form.sign_at_start() > 0 && form.sign_at_end() > 0
}

/// Whether all `positive` are above 0 at the only root of an equation with `0 < t < 1`.
fn holds_at_root(equation: &Form, positive: &[Form], deadline: Deadline<'_>) -> Result<bool, CutShort> {
    for form in positive.iter().filter(|form| !form.is_positive_inside()) {
        if sign_at_root(equation, form, deadline)? <= 0 {
            return Ok(false);
        }
    }
    Ok(true)
}

/// The piece, of `2^levels` of this one, that contains the only root of an equation with `0 < t < 1`, or begins with it.
fn piece_of_root(equation: &Form, levels: u32, mut number: u64) -> u64 {
    let mut equation = equation.clone();
    for level in (0..levels).rev() {
        let first = equation.first_half();
        number *= 2;
        if first.sign_at_end() == 0 {
            return (number + 1) << level;
        }
        if first.sign_changes() == 1 {
            equation = first;
        } else {
            equation = equation.second_half();
            number += 1;
        }
    }
    number
}

/// Whether all `positive` are above 0 at a root of `roots` with `0 < t < 1`. The roots are simple and no roots of `positive`.
fn has_accepted_root(roots: &Form, positive: &[Form], deadline: Deadline<'_>) -> Result<bool, CutShort> {
    deadline.check()?;
    if positive.iter().any(Form::is_nowhere_positive) {
        return Ok(false);
    }
    match roots.sign_changes() {
        0 => return Ok(false),
        1 => return holds_at_root(roots, positive, deadline),
        _ => {}
    }
    let first: Vec<Form> = positive.iter().map(Form::first_half).collect();
    let left = roots.first_half();
    if left.sign_at_end() == 0 && first.iter().all(|form| form.sign_at_end() > 0)
        || has_accepted_root(&left, &first, deadline)?
    {
        return Ok(true);
    }
    let second: Vec<Form> = positive.iter().map(Form::second_half).collect();
    has_accepted_root(&roots.second_half(), &second, deadline)
}

/// Whether all `positive` are above 0 somewhere with `0 < t < 1`. `boundaries` has all their roots, each once.
fn has_accepted_gap(boundaries: &Form, positive: &[Form], deadline: Deadline<'_>) -> Result<bool, CutShort> {
    deadline.check()?;
    if positive.iter().any(Form::is_nowhere_positive) {
        return Ok(false);
    }
    if positive.iter().all(Form::is_positive_inside) {
        return Ok(true);
    }
    let first: Vec<Form> = positive.iter().map(Form::first_half).collect();
    let at_the_middle = first.iter().all(|form| form.sign_at_end() > 0);
    match boundaries.sign_changes() {
        // No sign changes inside: one sample tells all.
        0 => return Ok(at_the_middle),
        // One root with a sample on each side.
        1 if boundaries.sign_at_start() != 0 && boundaries.sign_at_end() != 0 => {
            return Ok(positive.iter().all(|form| form.sign_at_start() > 0)
                || positive.iter().all(|form| form.sign_at_end() > 0));
        }
        _ => {}
    }
    if at_the_middle || has_accepted_gap(&boundaries.first_half(), &first, deadline)? {
        return Ok(true);
    }
    let second: Vec<Form> = positive.iter().map(Form::second_half).collect();
    has_accepted_gap(&boundaries.second_half(), &second, deadline)
}

//! Conditions with rounded coefficients: solved for sure, or left open.
//!
//! The step is halved, as with integers (`system`). The coefficients of a piece prove that it has a solution or none, or leave
//! that open. Pieces that stay open to the end leave the question to integers.

use super::conditions::Posed;
use super::rounded::{Bernstein, Rounded};

/// Pieces looked at before a question is left open.
const PIECES: u32 = 8;
/// The most conditions of a part: three equations, or one and four inequalities.
const MOST: usize = 5;

/// The answer to a question, if rounding leaves one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sight<T> {
    Some(T),
    None,
    Open,
}

/// Conditions on a piece of the step.
#[derive(Clone, Copy)]
struct Piece {
    conditions: [Option<Condition>; MOST],
}

#[derive(Clone, Copy)]
enum Condition {
    Zero(Bernstein),
    Positive(Bernstein),
}

/// A question about a part of the step, and how much work is left for it.
pub(super) struct Question {
    whole: Piece,
    pieces: u32,
}

impl Question {
    pub(super) fn new(posed: &Posed<Rounded>) -> Self {
        let zero = posed.zero.iter().map(|form| Condition::Zero(form.bernstein()));
        let positive = posed
            .positive
            .iter()
            .map(|form| Condition::Positive(form.bernstein()));
        let mut conditions = [None; MOST];
        for (place, condition) in conditions.iter_mut().zip(zero.chain(positive)) {
            *place = Some(condition);
        }
        Self {
            whole: Piece { conditions },
            pieces: PIECES,
        }
    }

    /// Whether there is a solution with `0 <= t <= 1`.
    pub(super) fn has_solution(&mut self) -> Sight<()> {
        let whole = self.whole;
        self.solution_in(&whole)
    }

    /// The first piece of the step, cut into `2^levels`, that contains the infimum of the solutions, by number.
    pub(super) fn first(&mut self, levels: u32) -> Sight<u64> {
        let whole = self.whole;
        self.first_in(&whole, levels, 0)
    }

    /// Whether an equation surely has no root with `0 <= t <= 1`.
    pub(super) fn is_without_root(&self) -> bool {
        self.whole.conditions().any(|condition| match condition {
            Condition::Zero(form) => form.is_positive() || form.is_negative(),
            Condition::Positive(_) => false,
        })
    }

    /// The inequalities that surely hold all the time, a bit each, in the order given.
    pub(super) fn holding(&self) -> u32 {
        let inequalities = self.whole.conditions().filter_map(|condition| match condition {
            Condition::Zero(_) => None,
            Condition::Positive(form) => Some(form.is_positive()),
        });
        inequalities
            .enumerate()
            .fold(0, |bits, (number, holds)| bits | u32::from(holds) << number)
    }

    fn solution_in(&mut self, piece: &Piece) -> Sight<()> {
        match piece.sight() {
            Sight::Open => {}
            sight => return sight,
        }
        let Some([first, second]) = self.halves(piece) else {
            return Sight::Open;
        };
        match self.solution_in(&first) {
            Sight::None => self.solution_in(&second),
            sight => sight,
        }
    }

    fn first_in(&mut self, piece: &Piece, levels: u32, number: u64) -> Sight<u64> {
        match piece.sight() {
            Sight::None => return Sight::None,
            // Without an equation solutions begin at once.
            Sight::Some(()) if piece.holds_at_start() => return Sight::Some(number << levels),
            Sight::Some(()) | Sight::Open => {}
        }
        if levels == 0 {
            return match self.solution_in(piece) {
                Sight::Some(()) => Sight::Some(number),
                Sight::None => Sight::None,
                Sight::Open => Sight::Open,
            };
        }
        let Some([first, second]) = self.halves(piece) else {
            return Sight::Open;
        };
        match self.first_in(&first, levels - 1, 2 * number) {
            Sight::None => self.first_in(&second, levels - 1, 2 * number + 1),
            sight => sight,
        }
    }

    /// Both halves of a piece, unless they promise nothing or the work is used up.
    fn halves(&mut self, piece: &Piece) -> Option<[Piece; 2]> {
        if self.pieces == 0 || piece.is_hidden() {
            return None;
        }
        self.pieces -= 1;
        let mut halves = [Piece {
            conditions: [None; MOST],
        }; 2];
        for (place, condition) in piece.conditions.iter().enumerate() {
            let forms = match condition {
                Some(Condition::Zero(form)) => form.halves().map(Condition::Zero),
                // what holds everywhere need not be asked again
                Some(Condition::Positive(form)) if !form.is_positive() => {
                    form.halves().map(Condition::Positive)
                }
                _ => continue,
            };
            for (half, form) in halves.iter_mut().zip(forms) {
                half.conditions[place] = Some(form);
            }
        }
        Some(halves)
    }
}

impl Piece {
    fn conditions(&self) -> impl Iterator<Item = &Condition> {
        self.conditions.iter().flatten()
    }

    /// Whether there is a solution.
    fn sight(&self) -> Sight<()> {
        let (mut equations, mut roots, mut all_hold) = (0, 0, true);
        for condition in self.conditions() {
            match condition {
                Condition::Zero(form) if form.is_positive() || form.is_negative() => return Sight::None,
                Condition::Positive(form) if form.is_negative() => return Sight::None,
                Condition::Zero(form) => {
                    equations += 1;
                    roots += u32::from(form.has_root());
                }
                Condition::Positive(form) => all_hold &= form.is_positive(),
            }
        }
        let is_solved = match equations {
            0 => all_hold || self.holds_at_start(),
            // several equations have no common root for sure
            1 => all_hold && roots == 1,
            _ => false,
        };
        if is_solved { Sight::Some(()) } else { Sight::Open }
    }

    /// Whether all conditions surely hold at the start of the piece; never with an equation.
    fn holds_at_start(&self) -> bool {
        self.conditions().all(|condition| match condition {
            Condition::Zero(_) => false,
            Condition::Positive(form) => form.is_positive_at_start(),
        })
    }

    /// Whether no half can tell more than the whole.
    fn is_hidden(&self) -> bool {
        self.conditions().all(|condition| match condition {
            Condition::Zero(form) => form.is_hidden(),
            Condition::Positive(form) => form.is_positive() || form.is_hidden(),
        })
    }
}

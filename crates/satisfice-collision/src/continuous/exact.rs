//! Decisions by polynomial conditions (`conditions`), a part of a hull after the other: in floating point, and by integers where
//! rounding leaves a part open.

use super::conditions::{Conditions, Part, Posed};
use super::deadline::{CutShort, Deadline};
use super::divisors::common;
use super::form::Form;
use super::hull::Parts;
use super::integers::{Interval, exact};
use super::motion::PairMotion;
use super::rounded::rounded;
use super::sight::{Question, Sight};
use super::system::System;
use crate::distance::DecidedBy;

/// Whether a hit happens during a part of the step: a distance below delta, or 0 for a delta of 0; and who says so.
#[cold]
pub(super) fn is_hit<const M: usize, const N: usize>(
    motion: &PairMotion<M, N>,
    delta: f64,
    parts: Parts,
    during: Interval,
    deadline: Deadline<'_>,
) -> Result<(bool, DecidedBy), CutShort> {
    let mut is_hit = false;
    let open = look(motion, delta, parts, during, |question| {
        let sight = question.has_solution();
        is_hit |= sight == Sight::Some(());
        sight
    });
    if is_hit || open.is_empty() {
        return Ok((is_hit, DecidedBy::Filter));
    }
    deadline.check()?;
    let conditions = exact(motion, delta, during);
    for part in &open {
        if part.system(&conditions, deadline)?.is_solvable(deadline)? {
            return Ok((true, DecidedBy::Exact));
        }
    }
    Ok((false, DecidedBy::Exact))
}

/// The first piece of a part of the step, cut into `2^levels` pieces, that contains the infimum of the hits, by number; and who says so.
#[cold]
pub(super) fn earliest<const M: usize, const N: usize>(
    motion: &PairMotion<M, N>,
    delta: f64,
    parts: Parts,
    during: Interval,
    levels: u32,
    deadline: Deadline<'_>,
) -> Result<(Option<u64>, DecidedBy), CutShort> {
    let mut first: Option<u64> = None;
    let mut found = |piece: u64| first = Some(first.map_or(piece, |first| first.min(piece)));
    let open = look(motion, delta, parts, during, |question| {
        match question.first(levels) {
            Sight::Some(piece) => found(piece),
            Sight::None => return Sight::None,
            Sight::Open => return Sight::Open,
        }
        // another part may come earlier
        Sight::None
    });
    if open.is_empty() {
        return Ok((first, DecidedBy::Filter));
    }
    deadline.check()?;
    let conditions = exact(motion, delta, during);
    for part in &open {
        let piece = part.system(&conditions, deadline)?.earliest(levels, deadline)?;
        piece.into_iter().for_each(&mut found);
    }
    Ok((first, DecidedBy::Exact))
}

/// A part that floating point leaves open.
struct OpenPart {
    part: Part,
    /// Of its inequalities those that floating point proves to hold all the time, a bit each.
    holding: u32,
}

/// Asks about the parts of a hull in floating point until one has a solution. Returns those that are left open.
fn look<const M: usize, const N: usize>(
    motion: &PairMotion<M, N>,
    delta: f64,
    parts: Parts,
    during: Interval,
    mut ask: impl FnMut(&mut Question) -> Sight<()>,
) -> Vec<OpenPart> {
    let conditions = rounded(motion, delta, during);
    let mut open = Vec::new();
    for part in parts.all(M * N) {
        let Some(conditions) = &conditions else {
            open.push(OpenPart { part, holding: 0 });
            continue;
        };
        let mut question = Question::new(&conditions.of(part, 0));
        match ask(&mut question) {
            Sight::Some(()) => break,
            // where its plane stays away from the origin, so do all parts
            Sight::None if matches!(part, Part::Face(_)) && question.is_without_root() => break,
            Sight::None => {}
            Sight::Open => open.push(OpenPart {
                part,
                holding: question.holding(),
            }),
        }
    }
    open
}

impl OpenPart {
    fn system(&self, conditions: &Conditions<Form>, deadline: Deadline<'_>) -> Result<System, CutShort> {
        let Posed { mut zero, positive } = conditions.of(self.part, self.holding);
        Ok(System {
            equation: match zero.len() {
                0 | 1 => zero.pop().filter(|form| !form.is_zero()),
                _ => common(&zero, deadline)?,
            },
            positive,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::distance::Point;

    const EDGES: [[usize; 2]; 4] = [[0, 1], [2, 3], [0, 2], [1, 3]];

    /// Edges that move, by numbers that look random: small integers, which meet in every degenerate way, or any numbers.
    fn motion(state: &mut u64, any: bool) -> PairMotion<2, 2> {
        let mut number = || {
            *state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(1);
            match any {
                true => (*state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5,
                false => ((*state >> 33) % 5) as f64 - 2.0,
            }
        };
        let mut edge = || -> [Point; 2] { [0, 1].map(|_| [0, 1, 2].map(|_| number())) };
        PairMotion {
            from_a: edge(),
            to_a: edge(),
            from_b: edge(),
            to_b: edge(),
        }
    }

    #[test]
    fn floating_point_says_what_integers_say_or_leaves_it_open() {
        let parts = Parts {
            edges: &EDGES,
            face: Some(super::super::hull::Face {
                corners: [0, 2, 1],
                is_parallelogram: true,
            }),
        };
        let part = Interval {
            from: 1,
            to: 7,
            shift: 3,
        };
        let mut state = 1;
        for (any, delta) in [(false, 0.0), (false, 0.5), (true, 0.0), (true, 0.1)] {
            let (mut solved, mut unsolved, mut open) = (0, 0, 0);
            for _ in 0..150 {
                let motion = motion(&mut state, any);
                let conditions = rounded(&motion, delta, part).expect("in range");
                let all = exact(&motion, delta, part);
                for of in parts.all(4) {
                    let question = || Question::new(&conditions.of(of, 0));
                    let system = |holding| {
                        let system = OpenPart { part: of, holding }.system(&all, Deadline::NONE);
                        system.expect("no deadline")
                    };
                    let (without, system) = (system(0), system(question().holding()));
                    let is_solvable =
                        |system: &System| system.is_solvable(Deadline::NONE).expect("no deadline");
                    let earliest = |system: &System| system.earliest(9, Deadline::NONE).expect("no deadline");
                    assert_eq!(is_solvable(&system), is_solvable(&without), "{motion:?} {of:?}");
                    assert_eq!(earliest(&system), earliest(&without), "{motion:?} {of:?}");
                    match question().has_solution() {
                        Sight::Some(()) => {
                            assert!(is_solvable(&without), "{motion:?} {of:?}");
                            solved += 1;
                        }
                        Sight::None => assert!(!is_solvable(&without), "{motion:?} {of:?}"),
                        Sight::Open => {}
                    }
                    match question().first(9) {
                        Sight::Some(piece) => {
                            assert_eq!(earliest(&without), Some(piece), "{motion:?} {of:?}");
                        }
                        Sight::None => {
                            assert_eq!(earliest(&without), None, "{motion:?} {of:?}");
                            unsolved += 1;
                        }
                        Sight::Open => open += 1,
                    }
                }
            }
            assert!(solved > 0 && unsolved > 300, "{solved} {unsolved} {open}");
        }
    }
}

//! How the candidates came about, from which they are made again.

use crate::error::Error;
use crate::scalar::Real;
use crate::state::{Reader, Saved, State, read_rows, write_rows};

/// The part of a step that enters a point.
const POINT: u32 = u32::MAX;

/// A point that is entered, or a part of its neighbours.
#[derive(Debug, Clone, Copy, serde::Serialize, serde::Deserialize)]
struct JournalStep {
    /// Its index, or of a point that was not met before the next free one.
    candidate: u32,
    part: u32,
    /// How many values had been counted before.
    counted: usize,
}

/// What is done next when candidates are made again.
pub(super) enum Entry<'a, S> {
    /// A point, by its index or by its position, with its fitness.
    Point(Result<u32, &'a [S]>, f64),
    /// A part of the neighbours of a point.
    Part(u32, u32),
    /// A value that is counted.
    Count(f64),
}

/// All steps that made candidates. An evaluation has dozens of neighbours, so that its step is a small part of what it makes: a million
/// candidates are saved in some hundred kilobytes.
#[derive(Debug, Default)]
pub(super) struct Journal<S> {
    steps: Vec<JournalStep>,
    /// The fitness of points, in the order of their steps.
    fitness: Vec<f64>,
    /// The positions of points that were not met before.
    positions: Vec<S>,
    counted: Vec<f64>,
}

impl<S: Real> Journal<S> {
    /// Adds a point; with its position, if it was not met before.
    pub(super) fn point(&mut self, candidate: u32, fitness: f64, position: Option<&[S]>) {
        self.part(candidate, POINT);
        self.fitness.push(fitness);
        self.positions.extend_from_slice(position.unwrap_or_default());
    }

    /// Adds a part of the neighbours of a point.
    pub(super) fn part(&mut self, candidate: u32, part: u32) {
        self.steps.push(JournalStep {
            candidate,
            part,
            counted: self.counted.len(),
        });
    }

    /// Adds a value that is counted.
    pub(super) fn count(&mut self, fitness: f64) {
        self.counted.push(fitness);
    }

    /// Goes through all of it, in order. `met` gives the number of candidates at that moment; steps that do not fit it, which only a
    /// damaged state has, are left out.
    pub(super) fn replay(&self, dimension: usize, mut act: impl FnMut(Entry<'_, S>) -> usize) {
        let mut counted = self.counted.iter();
        let (mut fitness, mut positions) = (self.fitness.iter(), self.positions.chunks_exact(dimension));
        let mut met = 0;
        for step in &self.steps {
            while self.counted.len() - counted.len() < step.counted
                && let Some(&value) = counted.next()
            {
                met = act(Entry::Count(value));
            }
            let is_known = (step.candidate as usize) < met;
            if step.part != POINT {
                if is_known {
                    met = act(Entry::Part(step.candidate, step.part));
                }
            } else if let Some(&fitness) = fitness.next() {
                let known = if is_known {
                    Some(Ok(step.candidate))
                } else {
                    positions.next().map(Err)
                };
                if let Some(point) = known {
                    met = act(Entry::Point(point, fitness));
                }
            }
        }
        for &value in counted {
            act(Entry::Count(value));
        }
    }

    /// Most points are counted right after they are entered: their fitness is written once.
    pub(super) fn save(&self, state: &mut State) {
        let mut next = 0;
        let mut counted_next = |step: &JournalStep, fitness: f64| {
            next = step.counted.max(next);
            let same = self
                .counted
                .get(next)
                .is_some_and(|&value| value.to_bits() == fitness.to_bits());
            next += usize::from(same);
            same
        };
        let points = self.steps.iter().filter(|step| step.part == POINT);
        let is_counted: Vec<bool> = points
            .zip(&self.fitness)
            .map(|(step, &fitness)| counted_next(step, fitness))
            .collect();
        let others = self
            .fitness
            .iter()
            .zip(&is_counted)
            .filter(|(_, counted)| !**counted);
        let others: Vec<f64> = others.map(|(&fitness, _)| fitness).collect();
        let mut before = 0;
        let steps: Vec<JournalStep> = self
            .steps
            .iter()
            .map(|&step| {
                let counted = step.counted - core::mem::replace(&mut before, step.counted);
                JournalStep { counted, ..step }
            })
            .collect();
        (steps, is_counted).save(state);
        write_rows(state, &others, 1);
        write_rows(state, &self.counted, 1);
        self.positions.save(state);
    }

    pub(super) fn restore(from: &mut Reader<'_>) -> Result<Self, Error> {
        let (mut steps, is_counted): (Vec<JournalStep>, Vec<bool>) = from.read()?;
        let others: Vec<f64> = read_rows(from)?;
        let counted: Vec<f64> = read_rows(from)?;
        let positions = from.read()?;
        let mut before = 0_usize;
        for step in &mut steps {
            before = before.saturating_add(step.counted);
            step.counted = before;
        }
        let mut others = others.iter();
        let mut next = 0;
        let points = steps.iter().filter(|step| step.part == POINT);
        let fitness = points.zip(&is_counted).map(|(step, &is_counted)| {
            next = step.counted.max(next);
            let fitness = if is_counted {
                counted.get(next)
            } else {
                others.next()
            };
            next = next.saturating_add(usize::from(is_counted));
            fitness.copied()
        });
        let fitness: Vec<f64> = fitness.map_while(|fitness| fitness).collect();
        Ok(Self {
            steps,
            fitness,
            positions,
            counted,
        })
    }

    /// Whether restored parts fit each other.
    pub(super) fn fits(&self, dimension: usize) -> bool {
        let points = self.steps.iter().filter(|step| step.part == POINT).count();
        self.fitness.len() == points && self.positions.len().is_multiple_of(dimension)
    }
}

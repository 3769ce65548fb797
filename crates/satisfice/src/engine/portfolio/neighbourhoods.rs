//! Breadth-first exhaustion of the neighbourhoods that the problem itself names.

use std::collections::VecDeque;

use super::visited::Visited;
use crate::context::Context;
use crate::scalar::Real;

/// Past trials are halved at this number.
const MEMORY: f64 = 400.0;

/// Hits in the order found, and the neighbours of the next of them.
#[derive(Debug, Clone)]
pub(super) struct Neighbourhoods<S> {
    /// Hits whose neighbours have been listed.
    cursor: usize,
    /// Points near to hits of the slice before, best first, and how many of them have been listed.
    near: Vec<S>,
    near_cursor: usize,
    /// Neighbours not proposed yet, flat.
    queue: VecDeque<S>,
    trials: f64,
    hits: f64,
}

crate::saved_struct!(Neighbourhoods<S: Real> { cursor, near, near_cursor, queue, trials, hits });

impl<S: Real> Neighbourhoods<S> {
    pub(super) fn new() -> Self {
        Self {
            cursor: 0,
            near: Vec::new(),
            near_cursor: 0,
            queue: VecDeque::new(),
            trials: 2.0,
            hits: 1.0,
        }
    }

    pub(super) fn begin(&mut self) {
        self.cursor = 0;
        self.near.clear();
        self.near_cursor = 0;
        self.queue.clear();
        self.trials = 2.0;
        self.hits = 1.0;
    }

    /// A point that is no hit any more, but near to being one; told best first.
    pub(super) fn note_near(&mut self, position: &[S]) {
        self.near.extend_from_slice(position);
    }

    /// Rate of hits as `(hits, trials)`, if there is a neighbour to try.
    pub(super) fn posterior(&self, hits: usize) -> Option<(f64, f64)> {
        let open = !self.queue.is_empty() || self.cursor < hits || self.near_cursor < self.near.len();
        open.then_some((self.hits, self.trials))
    }

    /// Writes the next neighbour that has not been proposed; `false` when there is none left. `hits` are all hits, flat.
    pub(super) fn propose(
        &mut self,
        context: &dyn Context<S>,
        hits: &[S],
        visited: Option<&mut Visited>,
        position: &mut [S],
    ) -> bool {
        let dimension = position.len();
        let mut visited = visited;
        while self.queue.len() < dimension {
            let start = self.cursor * dimension;
            let of = if let Some(hit) = hits.get(start..start + dimension) {
                self.cursor += 1;
                hit
            } else if let Some(near) = self.near.get(self.near_cursor..self.near_cursor + dimension) {
                self.near_cursor += dimension;
                near
            } else {
                return false;
            };
            let queue = &mut self.queue;
            context.neighbours(of, &mut |neighbour| {
                let new = match &mut visited {
                    Some(visited) => visited.insert(context.space(), neighbour),
                    None => !context.is_deleted(neighbour),
                };
                if new {
                    queue.extend(neighbour);
                }
            });
        }
        for (x, next) in position.iter_mut().zip(self.queue.drain(..dimension)) {
            *x = next;
        }
        true
    }

    /// Books a neighbour.
    pub(super) fn book(&mut self, hit: bool) {
        self.trials += 1.0;
        self.hits += f64::from(u8::from(hit));
        if self.trials > MEMORY {
            self.trials *= 0.5;
            self.hits *= 0.5;
        }
    }
}

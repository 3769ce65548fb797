//! One local search of the engine: where it starts, and by which of three ways it goes on.

use super::coordinate::{CoordinateSearch, Decisive, change};
use super::root::{RootMemory, RootSearch};
use super::search::{Memory, Proposal, QuadraticSearch};
use super::starts::{StartKind, Starts};
use crate::batch::Outcome;
use crate::context::Context;
use crate::scalar::Real;
use crate::space::Space;

/// How a search goes on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
enum Way {
    /// By a quadratic model of F.
    #[default]
    Quadratic,
    /// Along one axis at a time, where one axis decides F.
    Axes,
    /// By linear models of the components, where the problem tells them.
    Components,
}

/// One search, or the draws before it.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct QuadraticRun<S> {
    /// Points still to be drawn for the start, and whether one of them is out.
    pub(super) draws: usize,
    pub(super) is_drawn: bool,
    pub(super) kind: StartKind,
    /// The best of them, where the search starts; on axes that it does not move along it stays there.
    pub(super) start: Vec<S>,
    pub(super) value: f64,
    /// The axes that it moves along; none before it has started.
    pub(super) axes: Vec<usize>,
    way: Way,
    search: QuadraticSearch,
    /// How steep F was along the first axes, while the search begins with looks along all of them.
    slopes: Option<Vec<f64>>,
    coordinate: CoordinateSearch,
    root: RootSearch,
}

/// Memory of one proposal, of each way.
#[derive(Debug, Default)]
pub(super) struct Memories<S> {
    quadratic: Memory,
    root: RootMemory,
    components: Vec<S>,
}

impl<S: Real> Memories<S> {
    /// The components of F at a position.
    fn components(&mut self, context: &dyn Context<S>, position: &[S]) -> impl Iterator<Item = f64> {
        self.components.clear();
        self.components.resize(context.component_count(), S::nan());
        context.components(position, &mut self.components);
        self.components.iter().map(|x| x.f64())
    }
}

impl<S: Real> QuadraticRun<S> {
    pub(super) fn end(&mut self) {
        self.axes.clear();
        self.draws = 0;
        self.value = f64::INFINITY;
        self.slopes = None;
        self.way = Way::Quadratic;
    }

    /// Ends a search that went along the axes, or another one.
    pub(super) fn conclude(&mut self, is_hit: bool, decisive: &mut Decisive) {
        if self.way == Way::Axes {
            decisive.count_end(self.axes.len(), is_hit);
        }
        self.end();
    }

    /// Whether restored parts fit each other, so many axes of the space and so many components.
    pub(super) fn fits(&self, dimension: usize, components: usize) -> bool {
        let axes = self.axes.len();
        let is_started = axes == 0
            || match self.way {
                Way::Quadratic => self.search.fits(axes),
                Way::Axes => self.search.fits(axes) && self.coordinate.fits(axes),
                Way::Components => self.root.fits(axes, components),
            };
        let has_start = self.start.len() == dimension || axes == 0 && self.value.is_infinite();
        is_started && has_start && self.axes.iter().all(|&j| j < dimension)
    }

    /// Starts at its best point along these axes, with a trust region of this radius: by components, if the problem tells them there.
    pub(super) fn begin(
        &mut self,
        axes: &[usize],
        radius: f64,
        context: &dyn Context<S>,
        decisive: &Decisive,
        memories: &mut Memories<S>,
        mut normal: impl FnMut() -> f64,
    ) {
        let space = context.space();
        self.axes.extend_from_slice(axes);
        let shares = axes.iter().map(|&j| {
            let axis = &space.axes()[j];
            ((self.start[j] - axis.start()) / axis.width()).f64()
        });
        if context.component_count() > 0 {
            let components = memories.components(context, &self.start);
            self.root.start(shares.clone(), components, radius);
            // Of a point that was evaluated elsewhere they may not be known.
            if self.root.is_possible() {
                self.way = Way::Components;
                return;
            }
        }
        let (looks_along_axes, mut drawn) = (decisive.is_open(), 0);
        self.slopes = looks_along_axes.then(Vec::new);
        let direction = || {
            drawn += 1;
            match looks_along_axes {
                true => f64::from(u8::from((drawn - 1) % (axes.len() + 1) == 0)),
                false => normal(),
            }
        };
        self.search.start(shares, self.value, radius, direction);
    }

    /// Goes on along one axis at a time, if one axis decides F.
    fn turn_to_axes(&mut self, decisive: &Decisive) {
        if self.way == Way::Quadratic && decisive.is_one_axis() {
            let (point, value) = self.search.best();
            self.coordinate.start(point, value);
            self.way = Way::Axes;
        }
    }

    /// The next point of the search.
    pub(super) fn next(
        &mut self,
        (threshold, shortest): (f64, f64),
        periodic: &[bool],
        decisive: &Decisive,
        memories: &mut Memories<S>,
    ) -> Proposal {
        self.turn_to_axes(decisive);
        match self.way {
            Way::Quadratic => self
                .search
                .propose(threshold, shortest, periodic, &mut memories.quadratic),
            Way::Axes => self.coordinate.propose(shortest, &self.axes, periodic, decisive),
            Way::Components => self.root.propose(shortest, periodic, &mut memories.root),
        }
    }

    /// Takes what became of the last proposal.
    pub(super) fn learn(
        &mut self,
        position: &[S],
        outcome: Outcome<S>,
        context: &dyn Context<S>,
        (decisive, starts): (&mut Decisive, &mut Starts),
        memories: &mut Memories<S>,
    ) {
        match outcome {
            Outcome::NotEvaluated => return,
            Outcome::Miss(_) | Outcome::NonFinite => {
                let value = outcome.fitness().f64();
                if !self.is_drawn {
                    self.learn_miss(position, value, context, decisive, memories);
                } else if value < self.value {
                    self.value = value;
                    self.start.clear();
                    self.start.extend_from_slice(position);
                }
            }
            // The hit of this basin is found, or was found before.
            Outcome::Hit(_) | Outcome::Known(_) | Outcome::Deleted => self.conclude(true, decisive),
        }
        starts.count(self.kind, outcome.is_hit());
    }

    /// Takes F at a point of the search, or its components.
    fn learn_miss(
        &mut self,
        position: &[S],
        value: f64,
        context: &dyn Context<S>,
        decisive: &mut Decisive,
        memories: &mut Memories<S>,
    ) {
        match self.way {
            Way::Components => {
                let mut root = core::mem::take(&mut memories.root);
                self.root.learn(memories.components(context, position), &mut root);
                memories.root = root;
            }
            Way::Axes => {
                let threshold = context.threshold().f64();
                self.coordinate.learn(value, threshold, &self.axes, decisive);
            }
            Way::Quadratic => {
                if let Some(slopes) = &mut self.slopes {
                    slopes.push(change(self.search.best().1, value) / self.search.radius);
                    if slopes.len() == self.axes.len() {
                        decisive.count(&self.axes, slopes);
                        self.slopes = None;
                    }
                }
                self.search.learn(value);
            }
        }
    }

    /// Writes the position that the search has proposed.
    pub(super) fn place(&self, space: &Space<S>, position: &mut [S]) {
        position.copy_from_slice(&self.start);
        let proposed = match self.way {
            Way::Quadratic => &self.search.proposed,
            Way::Axes => &self.coordinate.proposed,
            Way::Components => &self.root.proposed,
        };
        for (&j, &share) in self.axes.iter().zip(proposed) {
            let axis = &space.axes()[j];
            position[j] = axis.start() + axis.width() * S::of(share);
        }
    }
}

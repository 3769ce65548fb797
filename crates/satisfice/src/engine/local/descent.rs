//! Greedy descent over neighbours, restarted.

use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::compiled::both_scalars;
use crate::engine::low_discrepancy::EvenPoints;
use crate::engine::{Ask, Engine, EngineConfig, Origin};
use crate::engine_settings;
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::Space;
use crate::state::{Part, Reader, State};

engine_settings! {
    /// From a start to the first neighbour that is better, as long as there is one; then from a new start. Starts are uniform on integer axes,
    /// and cover the continuous ones evenly.
    ///
    /// Neighbours are the problem's own, or else the next lattice points, and on continuous axes the points a step away in both
    /// directions of each axis (compass search, Kolda, Lewis, Torczon 2003, doi 10.1137/S003614450242889). They are tried in turn,
    /// beginning with the one that was better last: on a lattice, that continues in the same direction. If none is better, the step is
    /// halved. A descent ends at a hit; where no neighbour is better and the step is the shortest or there is none; or where none is
    /// better and a known hit is among them. Hits are deleted.
    ///
    /// After the descent of feature pairs in Guy, Debunne 2004 (INRIA RR-5136) and Kimmerle, Nesme, Faure 2004 (VMV). The first better
    /// neighbour is taken, not the best of all, because that finds more hits on the colliding teapots.
    ///
    /// ```
    /// use satisfice::{Budget, Search, Space, engine::Descent, from_fn};
    /// let disc = from_fn(Space::lattice(2, 100)?, 10.0, |x: &[f64]| (x[0] - 50.0).hypot(x[1] - 20.0));
    /// let engine = Descent { step: 0.1, ..Default::default() };
    /// let report = Search::with(engine).run(&disc, &Budget::evaluations(3000))?;
    /// assert!(report.hit_count() > 10);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    pub struct Descent {
        /// First step on continuous axes, as a share of each.
        pub step: f64 = 0.25, 1e-12..=1.0;
        /// Shortest step on continuous axes, as a share of each.
        pub shortest: f64 = 1e-6, 1e-15..=1.0;
    }
}

impl EngineConfig for Descent {
    const NAME: &'static str = "descent";
    const SUMMARY: &'static str = "greedy descent over neighbours, restarted at points that cover the space";
    const CITATION: &'static str =
        "after Guy, Debunne 2004, INRIA RR-5136, and Kimmerle, Nesme, Faure 2004, VMV";

    both_scalars!();
}

impl Descent {
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        Box::new(RestartedDescent::new(self.step, self.shortest))
    }
}

/// The engine of [`Descent`].
#[derive(Debug)]
pub(in crate::engine) struct RestartedDescent<S> {
    first_step: S,
    shortest: S,
    /// Empty before a start point has been told.
    point: Vec<S>,
    fitness: S,
    step: S,
    /// Number of indices of neighbours around the point; `None` before they are asked for. Compass steps follow them, two
    /// for each axis: back, forth.
    neighbours: Option<usize>,
    /// The index that is tried first, the one that is being tried, and how many have been tried.
    first: usize,
    current: usize,
    tried: usize,
    /// Whether only compass steps are left to try.
    only_compass: bool,
    /// Whether one of them was left out because it is in C.
    touches: bool,
    /// Where descents start that start at no point of the user.
    even: EvenPoints,
    /// Points given by the user, the best last, where the next descents start; with their fitness.
    starts: Vec<(S, Vec<S>)>,
}

/// At most so many given points are kept, the best ones.
const STARTS: usize = 1024;

impl<S: Real> RestartedDescent<S> {
    /// A descent with compass steps from `step` to `shortest`, as shares of each axis.
    pub(in crate::engine) fn new(step: f64, shortest: f64) -> Self {
        Self {
            first_step: S::of(step),
            shortest: S::of(shortest),
            point: Vec::new(),
            fitness: S::infinity(),
            step: S::zero(),
            neighbours: None,
            first: 0,
            current: 0,
            tried: 0,
            only_compass: false,
            touches: false,
            even: EvenPoints::default(),
            starts: Vec::new(),
        }
    }

    /// Begins a slice.
    pub(super) fn begin(&mut self) {
        self.restart();
        self.even = EvenPoints::default();
        self.starts.clear();
    }

    /// Ends the descent; the next one starts elsewhere.
    pub(in crate::engine) fn restart(&mut self) {
        self.point.clear();
        self.neighbours = None;
    }

    /// Keeps points that the user has given.
    pub(in crate::engine) fn keep_starts(&mut self, batch: &Batch<S>, outcomes: &[Outcome<S>]) {
        for (position, outcome) in batch.points().zip(outcomes) {
            if let Outcome::Miss(fitness) = *outcome {
                let place = self.starts.partition_point(|(other, _)| *other > fitness);
                self.starts.insert(place, (fitness, position.to_vec()));
            }
        }
        let excess = self.starts.len().saturating_sub(STARTS);
        self.starts.drain(..excess);
    }

    /// Goes to the best point that the user has given, where no descent has started; `false` without one.
    fn go_to_start(&mut self, dimension: usize) -> bool {
        let Some((fitness, position)) = self.starts.pop() else {
            return false;
        };
        if position.len() != dimension {
            return false; // of another space
        }
        self.fitness = fitness;
        self.point = position;
        self.step = self.first_step;
        self.neighbours = None;
        true
    }

    /// Proposes the next neighbour, or a start.
    pub(in crate::engine) fn propose(
        &mut self,
        context: &dyn Context<S>,
        rng: &mut SearchRng,
        out: &mut Batch<S>,
    ) {
        let dimension = out.dimension();
        loop {
            // A restored point may be of another space.
            while self.point.len() == dimension {
                let neighbours = self.look_around(context);
                let (from, count) = if self.only_compass {
                    (neighbours, 2 * dimension)
                } else {
                    (0, neighbours + 2 * dimension)
                };
                while self.tried < count {
                    self.current = from + (self.first + self.tried) % count;
                    self.tried += 1;
                    let mut proposed = false;
                    let mut propose = |neighbour: &[S]| {
                        if context.is_deleted(neighbour) {
                            self.touches = true;
                        } else {
                            out.push(neighbour);
                            proposed = true;
                        }
                    };
                    if self.current < neighbours {
                        let index = self.current;
                        context.neighbours(&self.point, index..index + 1, &mut |_, neighbour| {
                            propose(neighbour);
                        });
                    } else {
                        let step = compass_step(
                            context.space(),
                            &mut self.point,
                            self.step,
                            self.current - neighbours,
                        );
                        if let Some((axis, here)) = step {
                            propose(&self.point);
                            self.point[axis] = here;
                        }
                    }
                    if proposed {
                        return;
                    }
                }
                self.step = self.step / S::of(2.0);
                if self.touches || self.step < self.shortest || !has_compass(context.space()) {
                    break;
                }
                self.only_compass = true;
                self.tried = 0;
            }
            self.restart();
            if !self.go_to_start(dimension) {
                break;
            }
        }
        let even = &mut self.even;
        out.push_with(|position| even.draw(context.space(), rng, position));
    }

    /// The number of indices of neighbours around the point, asked for once.
    fn look_around(&mut self, context: &dyn Context<S>) -> usize {
        *self.neighbours.get_or_insert_with(|| {
            self.tried = 0;
            self.touches = false;
            self.only_compass = false;
            self.first = self.current;
            context.neighbour_count(&self.point)
        })
    }

    /// Goes on from what became of the proposal.
    pub(in crate::engine) fn learn(&mut self, position: &[S], outcome: Outcome<S>) {
        if outcome.is_hit() {
            return self.restart();
        }
        if self.point.is_empty() {
            if outcome.fitness() < S::infinity() {
                self.point.extend_from_slice(position);
                self.fitness = outcome.fitness();
                self.step = self.first_step;
            }
        } else if outcome.fitness() < self.fitness {
            self.fitness = outcome.fitness();
            self.point.clear();
            self.point.extend_from_slice(position);
            self.neighbours = None;
        }
    }
}

/// Moves a point along a continuous axis by compass step `index`: along axis `index / 2`, back or forth; beyond a bound, to
/// the bound. Returns the axis and where the point was on it; `None`, without a move, if there is no such step.
fn compass_step<S: Real>(space: &Space<S>, point: &mut [S], step: S, index: usize) -> Option<(usize, S)> {
    let j = index / 2;
    let axis = &space.axes()[j];
    if axis.is_integer() {
        return None;
    }
    let (here, length) = (point[j], step * axis.width());
    let there = if index.is_multiple_of(2) {
        here - length
    } else {
        here + length
    };
    let there = if space.is_periodic(j) {
        there
    } else {
        there.max(axis.start()).min(axis.end())
    };
    (there != here).then(|| {
        point[j] = there;
        (j, here)
    })
}

/// Whether any axis has compass steps.
fn has_compass<S: Real>(space: &Space<S>) -> bool {
    space
        .axes()
        .iter()
        .any(|axis| !axis.is_integer() && axis.width() > S::zero())
}

impl<S: Real> Part for RestartedDescent<S> {
    crate::saved_fields!(
        point,
        fitness,
        step,
        neighbours,
        tried,
        current,
        first,
        only_compass,
        touches,
        even,
        starts
    );
}

impl<S: Real> Engine<S> for RestartedDescent<S> {
    fn begin(&mut self, _: &dyn Context<S>) {
        Self::begin(self);
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        self.propose(context, rng, out);
        Ask::More
    }

    fn tell(&mut self, _: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        match origin {
            Origin::Engine => self.learn(batch.point(0), outcomes[0]),
            Origin::Start => self.keep_starts(batch, outcomes),
            Origin::Single { .. } | Origin::WarmStart | Origin::Exhaustion => {}
        }
    }

    fn save(&self, state: &mut State) {
        Part::save(self, state);
    }

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        Part::restore(self, from)
    }
}

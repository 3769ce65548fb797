//! Restarted local search by quadratic models, or by linear ones of the components of F: for isolated roots and minima.

mod coordinate;
mod eigen;
mod minimum;
mod root;
mod run;
mod search;
mod starts;

use coordinate::Decisive;
use run::{Memories, QuadraticRun};
use search::Proposal;
use starts::{StartKind, Starts};

use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::compiled::both_scalars;
use crate::engine::low_discrepancy::EvenPoints;
use crate::engine::{Ask, Engine, EngineConfig, Origin};
use crate::engine_settings;
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::state::{Part, Reader, State};

engine_settings! {
    /// Local searches, each from one point or the best of eight, whichever has yielded more, that go to the minimum of a quadratic model in
    /// a trust region. The points cover the space evenly.
    ///
    /// - The model interpolates F at the points evaluated near the best one. Of its second derivatives those are kept that the points do not
    ///   decide (least Frobenius norm updating, Powell 2004), so that it is of use from one point more than there are axes.
    /// - The trust region is an ellipsoid along the axes of the model: a narrow valley may be followed in long steps. It grows where the
    ///   model predicts well and shrinks where it does not.
    /// - Where F stays the same along most axes, as the largest of several distances does, quadratics are of no use. Then a search goes along
    ///   the one axis that changes F, to where F would be at the threshold, and looks for the next one. One look tells which it is: it moves
    ///   along all axes, along each so far that F would change by another amount.
    /// - Where the problem tells the [components](crate::Components) of F, each has a linear model instead: Gauss-Newton steps (Levenberg 1944),
    ///   with slopes that are looked up along the axes and then corrected by each step (Broyden 1965). A root takes a few evaluations more
    ///   than there are axes. The components are worked out beside F, which costs as much again.
    /// - A search ends at a hit; where a model that has predicted well promises a known hit or no hit; where its steps become shorter than
    ///   `shortest`; and after 150 evaluations and ten for each axis, by components after 30 and five.
    ///
    /// Integer axes stay where a search starts, and so do all but 30 continuous axes, drawn anew for each search. Hits are deleted. Cost
    /// of a proposal: O(m^3) for the m points of the model, 64 at most; some 10 microseconds on six axes.
    ///
    /// ```
    /// use satisfice::{Budget, Search, Space, engine::QuadraticDescent, from_fn};
    /// // The four roots of Himmelblau's equations.
    /// let far = |x: &[f64]| (x[0] * x[0] + x[1] - 11.0).hypot(x[0] + x[1] * x[1] - 7.0);
    /// let roots = from_fn(Space::cube(2, -6.0, 6.0)?, 1e-3, far).separation(0.1);
    /// let report = Search::with(QuadraticDescent::default()).run(&roots, &Budget::evaluations(1_000))?;
    /// assert_eq!(report.hit_count(), 4);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    pub struct QuadraticDescent {
        /// Searches at a time, and candidates of a batch: many feed more threads.
        pub searches: usize = 1, 1..=65_536;
        /// First radius of the trust region, as a share of the axes.
        pub step: f64 = 0.05, 1e-12..=1.0;
        /// Shortest radius, as a share of the axes.
        pub shortest: f64 = 1e-9, 1e-15..=1.0;
    }
}

impl EngineConfig for QuadraticDescent {
    const NAME: &'static str = "quadratic-descent";
    const SUMMARY: &'static str = "restarted descent by quadratic models of F, or linear ones of its components, for isolated roots and minima on continuous axes";
    const CITATION: &'static str = "after Powell 2004, doi 10.1007/s10107-003-0490-7, Powell 2006, doi 10.1007/0-387-30065-1_16, and Levenberg 1944, doi 10.1090/qam/10666";

    both_scalars!();
}

impl QuadraticDescent {
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        Box::new(QuadraticSearches {
            settings: self.clone(),
            axes: Vec::new(),
            periodic: Vec::new(),
            components: 0,
            starts: Starts::default(),
            even: EvenPoints::default(),
            decisive: Decisive::default(),
            descents: vec![QuadraticRun::default(); self.searches],
            given: Vec::new(),
            position: Vec::new(),
            sides: Vec::new(),
            memories: Memories::default(),
        })
    }
}

/// Axes of one search, at most.
const MOST_AXES: usize = 30;
/// At most so many points of the user are kept, the best ones.
const GIVEN: usize = 1024;

/// The engine of [`QuadraticDescent`].
#[derive(Debug)]
struct QuadraticSearches<S> {
    settings: QuadraticDescent,
    /// The continuous axes, in an order that changes with every start.
    axes: Vec<usize>,
    /// Which axes of the space are periodic.
    periodic: Vec<bool>,
    /// Number of components of F that the problem tells.
    components: usize,
    /// How searches start, and at which points.
    starts: Starts,
    even: EvenPoints,
    /// Whether one axis decides F.
    decisive: Decisive,
    descents: Vec<QuadraticRun<S>>,
    /// Points of the user, the best last, where the next searches start.
    given: Vec<(f64, Vec<S>)>,
    /// Memory of one proposal: the position, and which axes of the search are periodic.
    position: Vec<S>,
    sides: Vec<bool>,
    memories: Memories<S>,
}

impl<S: Real> QuadraticSearches<S> {
    /// Starts the search of run `index` at its best point.
    fn start(&mut self, index: usize, context: &dyn Context<S>, rng: &mut SearchRng) {
        let count = self.axes.len().min(MOST_AXES);
        if count < self.axes.len() {
            for k in 0..count {
                let other = k + rng.below(self.axes.len() - k);
                self.axes.swap(k, other);
            }
        }
        let (axes, radius) = (&self.axes[..count], self.settings.step);
        let run = &mut self.descents[index];
        run.begin(axes, radius, context, &self.decisive, &mut self.memories, || {
            rng.normal()
        });
    }

    /// Appends the next point of run `index`.
    fn propose(&mut self, index: usize, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) {
        let space = context.space();
        self.position.resize(space.dimension(), S::zero());
        loop {
            let run = &mut self.descents[index];
            run.is_drawn = false;
            if run.axes.is_empty() && run.draws == 0 {
                if run.value.is_finite() && !self.axes.is_empty() {
                    self.start(index, context, rng);
                } else if let Some((value, start)) = self.given.pop() {
                    (run.value, run.start) = (value, start);
                    run.kind = StartKind::Given;
                    if self.axes.is_empty() {
                        run.end();
                    }
                    continue;
                } else {
                    run.end();
                    run.kind = self.starts.next();
                    run.draws = run.kind.draws();
                }
            }
            let run = &mut self.descents[index];
            if run.draws > 0 {
                run.draws -= 1;
                run.is_drawn = true;
                let even = &mut self.even;
                return out.push_with(|position| even.draw(space, rng, position));
            }
            self.sides.clear();
            self.sides.extend(run.axes.iter().map(|&j| self.periodic[j]));
            let limits = (context.threshold().f64(), self.settings.shortest);
            let proposal = run.next(limits, &self.sides, &self.decisive, &mut self.memories);
            if proposal != Proposal::Ends {
                run.place(space, &mut self.position);
                if proposal != Proposal::Converges || !context.is_deleted(&self.position) {
                    return out.push(&self.position);
                }
            }
            run.conclude(proposal != Proposal::Ends, &mut self.decisive);
        }
    }
}

impl<S: Real> Engine<S> for QuadraticSearches<S> {
    fn begin(&mut self, context: &dyn Context<S>) {
        let space = context.space();
        self.axes = space
            .axes()
            .iter()
            .enumerate()
            .filter(|(_, axis)| !axis.is_integer() && axis.width() > S::zero())
            .map(|(j, _)| j)
            .collect();
        self.periodic = (0..space.dimension()).map(|j| space.is_periodic(j)).collect();
        self.components = context.component_count();
        self.starts = Starts::default();
        self.even = EvenPoints::default();
        self.given.clear();
        self.decisive.begin(space.dimension());
        for run in &mut self.descents {
            run.end();
        }
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        for index in 0..self.descents.len() {
            self.propose(index, context, rng, out);
        }
        Ask::More
    }

    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        match origin {
            Origin::Engine => {
                for ((run, position), &outcome) in self.descents.iter_mut().zip(batch.points()).zip(outcomes)
                {
                    let shared = (&mut self.decisive, &mut self.starts);
                    run.learn(position, outcome, context, shared, &mut self.memories);
                }
            }
            Origin::Start => {
                for (position, outcome) in batch.points().zip(outcomes) {
                    if let Outcome::Miss(value) = *outcome {
                        let value = value.f64();
                        let place = self.given.partition_point(|(other, _)| *other > value);
                        self.given.insert(place, (value, position.to_vec()));
                    }
                }
                let excess = self.given.len().saturating_sub(GIVEN);
                self.given.drain(..excess);
            }
            Origin::Single { .. } | Origin::WarmStart | Origin::Exhaustion => {}
        }
    }

    fn save(&self, state: &mut State) {
        Part::save(self, state);
    }

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        let searches = self.descents.len();
        Part::restore(self, from)?;
        let dimension = self.periodic.len();
        let are_axes = |axes: &[usize]| axes.iter().all(|&j| j < dimension);
        let fits = self.descents.len() == searches
            && self.decisive.fits(dimension)
            && are_axes(&self.axes)
            && self.given.iter().all(|(_, start)| start.len() == dimension)
            && self
                .descents
                .iter()
                .all(|run| run.fits(dimension, self.components));
        fits.then_some(())
            .ok_or_else(|| Error::State("its searches do not fit the space".to_owned()))
    }
}

impl<S: Real> Part for QuadraticSearches<S> {
    crate::saved_fields!(
        axes, periodic, components, starts, even, decisive, descents, given
    );
}

//! The default engine: sources of candidates that compete for evaluations by their yield.

pub(super) mod credit;
mod drought;
mod guests;
mod inner_grid;
mod levels;
mod near_misses;
mod neighbourhoods;
mod pace;
mod scan;
mod source;
mod sources;
mod swarms;
mod translations;
mod visited;

use sources::Sources;

use super::{Engine, EngineConfig};
use crate::engine::compiled::both_scalars;
use crate::scalar::Real;
use crate::{engine_choice, engine_settings};

engine_choice! {
    /// When the neighbours that a problem names become candidates of [`Portfolio`].
    pub enum NeighbourTiming {
        /// Late from when it is known that F takes less than 10 microseconds, where time is limited and evaluations are not; at once elsewhere.
        Auto = "auto",
        /// At once, best first by the mean of F at all evaluated points next to them: most hits for each evaluation. On a lattice late
        /// once two million were predicted.
        AtOnce = "at-once",
        /// When it is their turn, all those of the point with the least F first: a fraction of the time.
        Late = "late",
    }
}

engine_choice! {
    /// A source of candidates that [`Portfolio`] leaves out.
    pub enum Omitted {
        /// None: all sources compete.
        Nothing = "none",
        /// Small quantum-behaved swarms.
        Swarms = "swarms",
        /// Known steps from hit to hit.
        Steps = "steps",
        /// New steps, learned from differences of hits: `trial steps` in reports.
        Learning = "learning",
        /// Recombinations of two hits, and (1+1)-CMA-ES and niching, which recombine them, too.
        Recombination = "recombination",
        /// The neighbours that the problem names.
        Neighbours = "neighbours",
        /// The near misses of the slice before.
        NearMisses = "near-misses",
        /// Descents over neighbours and compass steps.
        Descents = "descents",
        /// (1+1)-CMA-ES with recombination of hits.
        CmaEs = "cma-es",
        /// The flood fill on continuous axes.
        FloodFill = "flood-fill",
        /// Regions by the problem's bounds.
        Regions = "regions",
        /// The Gaussian process, which takes most of the time where evaluations are limited.
        Model = "model",
        /// Descents by quadratic models.
        QuadraticDescents = "quadratic-descents",
        /// Niching in a drought.
        Niching = "niching",
    }
}

engine_settings! {
    /// A portfolio of sources of candidates, which compete for evaluations by their yield:
    ///
    /// - restarted descents over neighbours and compass steps, and where coordinates are real, as those of continuous axes and of permutations
    ///   are, (1+1)-CMA-ES with recombination of hits;
    /// - on continuous axes, descents by [quadratic models](super::QuadraticDescent), where the problem tells the
    ///   [components](crate::Components) of F, evaluations are limited or F takes more than 20 microseconds;
    /// - on continuous axes, [niching](super::Niching) once no source has found a hit for long: optima that are hard to reach;
    /// - a Gaussian process on at most 200 axes; where only time is limited, if F takes more than 2 ms: up to 1,000 proposals, of half a
    ///   millisecond to a few. Unless the problem tells the components of F, there is none where more than 10,000 evaluations are planned. Where F takes less than a proposal, and the time matters more than the number of evaluations, limit the
    ///   time, too: if the proposals would take longer than the limit, the model is not used. Of a batch it may propose all;
    /// - regions, best first, where the problem declares bounds; when none is left, the result is proved complete;
    /// - the points of a lattice, or the orders of a permutation, one by one, where the budget has room for all: then the result is proved
    ///   complete, too, and where there is no room for probes beside them, none are made. A lattice of at most
    ///   4,096 points is enumerated at once, a larger one once it is half visited, or the search finds no more than that would, or under a limit
    ///   of evaluations once it would no longer fit later;
    /// - from hits: a flood fill where coordinates are real, best first, steps that have led from hit to hit, steps learned from differences of hits,
    ///   recombinations of two hits, and the neighbours that the problem names, best first by predicted fitness or, where F is cheap and only
    ///   time is limited, by the fitness of the point that they are next to;
    /// - small swarms, each attracted by its own latest hit, after Chen et al. 2012;
    /// - uniform points, on a lattice without repetition, on continuous axes evenly and somewhat denser in the middle, of a step function on
    ///   finer and finer grids that no box inside the bounds slips through, unless the problem names neighbours;
    /// - in a slice that follows another: the near misses of that slice, best first, because a problem that moves turns them into
    ///   hits.
    ///
    /// # Which source is next
    ///
    /// - **In general** it is drawn by Thompson sampling on what each has yielded lately: hits for each evaluation, or, where time alone is limited,
    ///   for the time of an evaluation, the source's own thinking included.
    /// - **Before the first hit** descents and CMA-ES have the larger share. Beside a model one source leads and has nine of ten choices of the first 250
    ///   evaluations; the model, descents by quadratic models and other descents share the rest, and all later ones equally. On continuous axes the model leads, and has the first 50 evaluations, or a
    ///   quarter of up to 1,000 planned ones, alone. Where the problem names neighbours, or all axes are places of a permutation, descents along
    ///   neighbours and exchanges lead. The model comes first whenever it takes a hit to be more probable than not.
    /// - **After it** a source without a hit takes at most 4 % of the evaluations. Excepted are descents on a lattice, and on continuous axes
    ///   swarms, which may take a fifth: they have to converge first. Beside a model, the sources without a hit together take at most 6 % of the
    ///   evaluations that miss. Uniform points have no bound: they are evaluated whenever no other source may have or has a candidate, which can be
    ///   half of a search.
    /// - **The model** leads for 1,000 evaluations and then competes as the others do. On continuous axes, and where nothing else leads down, it
    ///   competes by the probability of a hit that it gives its next proposal, as far as its word was true so far. Once it is known to predict
    ///   less than a quarter of the variance of F, it has the bound of a source without a hit.
    /// - **Components** make the model lead from the first evaluation on; after 100, descents have a share of their own, of a fifth of the evaluations
    ///   that miss. While the model expects no hit of its latest proposals, descents by components lead.
    /// - **Step functions**, where the misses on continuous axes have at most four values, are for swarms and uniform points, which know more than
    ///   descents do, and more than the model until it is known to predict F.
    /// - **In a drought**, when no source has found a hit for 400 evaluations an axis and 2,000 more, and for 200 a hit, every other choice on
    ///   continuous axes is niching's until one does.
    ///
    /// All sources learn the hits of the others. No parameter depends on the problem.
    ///
    /// ```
    /// use satisfice::{Budget, Completeness, Search, Space, engine::Portfolio, from_fn};
    /// let problem = from_fn(Space::lattice(2, 40)?, 2.5, |x: &[f64]| (x[0] - 30.0).hypot(x[1] - 20.0));
    /// let report = Search::with(Portfolio::default()).run(&problem, &Budget::evaluations(5_000))?;
    /// // The budget has room for all 1,600 points.
    /// assert_eq!((report.hit_count(), report.completeness), (21, Completeness::Proved));
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    pub struct Portfolio {
        /// Candidates proposed at once. By default as many as evaluations go on at once, or more: one for every 2,048 evaluations made, up
        /// to 32, and 4 in the first batch, unless a model of F is at work. Under a limit of time alone it is 32 if F takes less than 2
        /// microseconds. Small batches learn sooner, large ones take less time.
        pub batch: Option<usize> = None, 1..=65_536;
        /// Number of swarms K.
        pub swarms: usize = 2, 1..=1000;
        /// Particles N of each swarm.
        pub particles: usize = 10, 1..=1000;
        /// Contraction-expansion coefficient alpha of the swarms, which stay bounded below 1.781.
        pub alpha: f64 = 0.75, 0.0..=10.0;
        /// Evaluations without a hit after which a swarm starts anew.
        pub restart: usize = 1000, 1..=1_000_000_000;
        /// When the neighbours that the problem names become candidates: `at-once` finds more per evaluation, `late` takes less time. By default
        /// `late` if only time is limited and F takes less than 10 microseconds, otherwise `at-once`. On a lattice always `late` after two
        /// million predicted neighbours.
        pub neighbours: NeighbourTiming = NeighbourTiming::Auto;
        /// A source to leave out: to measure what it contributes, or because it does not pay, as the model if F is cheap.
        pub without: Omitted = Omitted::Nothing;
    }
}

impl EngineConfig for Portfolio {
    const NAME: &'static str = "portfolio";
    const SUMMARY: &'static str = "descents, CMA-ES, quadratic models, niching, a model of expensive F, regions, flood fill, recombined hits and swarms that compete for evaluations by their yield";
    const CITATION: &'static str = "this project; parts after Chen et al. 2012, Igel et al. 2006, Powell 2004, Beyer, Sendhoff 2008, Ursem 1999, Luby et al. 1993, Agrawal, Goyal 2012";

    /// Whether a space is enumerated depends on how much the budget has left.
    fn is_scheduled(&self) -> bool {
        true
    }

    both_scalars!();
}

impl Portfolio {
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        Box::new(Sources::new(self))
    }
}

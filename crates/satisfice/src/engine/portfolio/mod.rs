//! The default engine: sources of candidates that compete for evaluations by their yield.

pub(super) mod bandit;
mod climbers;
mod moves;
mod near_misses;
mod neighbourhoods;
mod populations;
mod scan;
mod source;
mod sources;
mod swarms;
mod translations;
mod visited;

use sources::Sources;

use super::{Engine, EngineConfig};
use crate::scalar::Real;
use crate::{engine_choice, engine_settings};

engine_choice! {
    /// When the neighbours that a problem names become candidates of [`Portfolio`].
    pub enum NeighbourTiming {
        /// At once: most hits for each evaluation.
        AtOnce = "at-once",
        /// When it is their turn: a fraction of the time, for a fitness of less than a few microseconds with dozens of
        /// neighbours.
        Late = "late",
    }
}

engine_choice! {
    /// A source of candidates that [`Portfolio`] leaves out, for ablation.
    pub enum Omitted {
        /// None: all sources compete.
        Nothing = "none",
        /// Small quantum-behaved swarms.
        Swarms = "swarms",
        /// Restarted local searches.
        Climbers = "climbers",
        /// Populations that adapt their covariance.
        Populations = "populations",
        /// Known steps from hit to hit.
        Steps = "steps",
        /// New steps, learned from differences of hits.
        Learning = "learning",
        /// Recombinations of two hits.
        Recombination = "recombination",
        /// The neighbours that the problem names.
        Neighbours = "neighbours",
        /// The near misses of the slice before.
        NearMisses = "near-misses",
    }
}

engine_settings! {
    /// A portfolio of sources of candidates, which compete by their yield:
    ///
    /// - uniform points, on a lattice without repetition, so that a small one is covered and the result proved complete;
    /// - small swarms, each attracted by its own latest hit, after Chen et al. 2012;
    /// - restarted local searches by adaptive moves: along integer axes, to the problem's own neighbours, by a covariance-adapting
    ///   (1+1) strategy along continuous axes; a search that returns to a known hit ends at once;
    /// - steps that have led from hit to hit, applied to every hit: the short ones fill neighbourhoods, those learned from
    ///   differences of hits follow repetitions and manifolds of hits;
    /// - recombinations of two hits, which find the rest of a product of sets of coordinates; local searches start at those that
    ///   just miss;
    /// - populations that adapt their covariance, on continuous axes;
    /// - the neighbours that the problem names, best first by predicted fitness, from hits and across near misses;
    /// - in a slice that follows another: the near misses of that slice, best first, because a problem that moves turns them into
    ///   hits.
    ///
    /// The next source is drawn by Thompson sampling on fading counts of hits. No parameter depends on the problem.
    pub struct Portfolio {
        /// Candidates proposed at once, at most: few learn sooner, many feed more threads.
        pub batch: usize = 32, 1..=65_536;
        /// Number of swarms K.
        pub swarms: usize = 6, 1..=1000;
        /// Particles N of each swarm.
        pub particles: usize = 5, 1..=1000;
        /// Contraction-expansion coefficient alpha of the swarms, which stay bounded below 1.781.
        pub alpha: f64 = 0.75, 0.0..=10.0;
        /// Evaluations without a hit after which a swarm starts anew.
        pub restart: usize = 1000, 1..=1_000_000_000;
        /// When the neighbours that the problem names become candidates: at once for most hits an evaluation, late to save time
        /// on a cheap fitness with dozens of neighbours.
        pub neighbours: NeighbourTiming = NeighbourTiming::AtOnce;
        /// A source to leave out, for ablation.
        pub without: Omitted = Omitted::Nothing;
    }
}

impl EngineConfig for Portfolio {
    const NAME: &'static str = "portfolio";
    const SUMMARY: &'static str = "swarms, local searches, recombined hits, learned steps and uniform points that compete for evaluations by their yield";
    const CITATION: &'static str = "this project; parts after Chen et al. 2012, Igel et al. 2006, Beyer, Sendhoff 2017, Luby et al. 1993, Agrawal, Goyal 2012";

    /// Whether a space is enumerated depends on how much the budget has left.
    fn is_scheduled(&self) -> bool {
        true
    }

    fn build<S: Real>(&self) -> Box<dyn Engine<S>> {
        Box::new(Sources::new(self))
    }
}

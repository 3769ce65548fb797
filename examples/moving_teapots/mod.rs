//! Two teapots, one of them moving: the scene by which warm starts are judged.

use std::collections::BTreeSet;
use std::error::Error;

use satisfice::catalogue::{Catalogued, Params};
use satisfice::{Budget, Search, WarmStart, engine};
use satisfice_collision::problem::Teapots;
use satisfice_collision::{Placement, generate};

/// Which way the second teapot moves.
#[allow(
    dead_code,
    reason = "not every example that includes this file moves it both ways"
)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Way {
    /// Towards the first, along the longest extent: from frame to frame there are more hits.
    Towards,
    /// Past it, along the next axis, as far on one side in the first frame as on the other in the last: about as many hits in
    /// every frame.
    Past,
}

/// A teapot, one that moves, and the hits of each frame.
pub(crate) struct MovingTeapots {
    frames: Vec<Teapots>,
    hits: Vec<BTreeSet<(u32, u32)>>,
}

impl MovingTeapots {
    /// So many frames of the [`Teapots`] as they are by default; `step` in sizes a frame, where delta is 0.02.
    ///
    /// # Errors
    /// Any that building the scene gives, such as for a `step` that is not finite.
    pub(crate) fn new(frames: usize, step: f64, way: Way) -> Result<Self, Box<dyn Error>> {
        let teapot = generate::teapot(13)?;
        let size = teapot.size();
        let along = teapot.bounds().longest_axis();
        let mut problem = Teapots::from_params(&Params::defaults(Teapots::PARAMETERS)?)?;
        let mut scene = Self {
            frames: Vec::with_capacity(frames),
            hits: Vec::with_capacity(frames),
        };
        for frame in 0..frames {
            let mut offset = [0.0; 3];
            let moved = step * frame as f64;
            offset[along] = 0.45 * size;
            match way {
                Way::Towards => offset[along] -= moved * size,
                Way::Past => {
                    let half = 0.5 * step * frames.saturating_sub(1) as f64;
                    offset[(along + 1) % 3] = (moved - half) * size;
                }
            }
            let moved = Placement::from_translation(offset)?.place(&teapot)?;
            // Samples and indices stay: a pair keeps its place in the space.
            problem.pairs_mut().move_b(&moved)?;
            scene
                .hits
                .push(problem.pairs().reference_pairs().into_iter().collect());
            scene.frames.push(problem.clone());
        }
        Ok(scene)
    }

    /// Number of hits of a frame, by exact enumeration.
    ///
    /// # Panics
    /// If there is no such frame.
    #[must_use]
    pub(crate) fn hits(&self, frame: usize) -> usize {
        self.hits[frame].len()
    }

    /// Share of a frame's hits that were hits in the frame before; 0 for the first.
    ///
    /// # Panics
    /// If there is no such frame.
    #[must_use]
    pub(crate) fn kept(&self, frame: usize) -> f64 {
        let Some(before) = frame.checked_sub(1) else {
            return 0.0;
        };
        let both = self.hits[frame].intersection(&self.hits[before]).count();
        both as f64 / self.hits[frame].len().max(1) as f64
    }

    /// Mean recall of every frame by an engine with these settings, in percent, over the seeds 1 to `seeds`: one search each, one slice of so many
    /// evaluations per frame.
    ///
    /// # Errors
    /// As [`Search::run`], and for an engine that finds what is no hit.
    pub(crate) fn recalls(
        &self,
        (engine, settings): (&str, &[(&str, &str)]),
        rule: WarmStart,
        evaluations: u64,
        seeds: u64,
    ) -> Result<Vec<f64>, Box<dyn Error>> {
        let mut recalls = vec![0.0; self.frames.len()];
        for seed in 1..=seeds {
            let mut search = Search::with(engine::find(engine)?.configure(settings.iter().copied())?)
                .seed(seed)
                .warm_start(rule);
            for (frame, problem) in self.frames.iter().enumerate() {
                let report = search.run(problem, &Budget::evaluations(evaluations))?;
                if let Some(hit) = report.hits().find(|hit| !self.hits[frame].contains(hit.solution)) {
                    return Err(format!(
                        "{:?} was reported as a hit of frame {frame}, and is none",
                        hit.solution
                    )
                    .into());
                }
                recalls[frame] += 100.0 * report.hit_count() as f64 / self.hits(frame).max(1) as f64;
            }
        }
        for recall in &mut recalls {
            *recall /= seeds.max(1) as f64;
        }
        Ok(recalls)
    }
}

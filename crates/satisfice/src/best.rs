//! The least fitness seen so far, and where.

/// The candidate with the least finite fitness that a slice has evaluated, whether or not it is a hit.
///
/// When nothing hits, it shows how far the threshold is from what exists. Its fitness is never above that of any hit.
///
/// ```
/// use satisfice::{from_fn, Budget, Search, Space};
/// // No point of this space is below the threshold: the least F is 3.
/// let problem = from_fn(Space::lattice(2, 50)?, 1.0, |x: &[f64]| 3.0 + x[0] + x[1]);
/// let report = Search::new().run(&problem, &Budget::evaluations(5_000))?;
/// assert_eq!(report.hit_count(), 0);
/// let best = report.best().expect("F is finite everywhere");
/// assert_eq!((best.fitness, &best.solution.coordinates[..]), (3.0, &[0.0, 0.0][..]));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Best<T> {
    /// The solution. The first one, if several have the same fitness.
    pub solution: T,
    /// Its fitness F; `f32` values are widened exactly.
    pub fitness: f64,
    /// The evaluation that found it, counted from 1; under several lanes, the evaluations made by the exchange that
    /// reported it.
    pub evaluation: u64,
}

/// Keeps the [`Best`] while a slice runs. Offering costs one comparison unless the offer is better.
#[derive(Debug, Clone)]
pub(crate) struct BestSoFar<T> {
    least: f64,
    best: Option<Best<T>>,
}

impl<T> Default for BestSoFar<T> {
    fn default() -> Self {
        Self {
            least: f64::INFINITY,
            best: None,
        }
    }
}

impl<T> From<Option<Best<T>>> for BestSoFar<T> {
    fn from(best: Option<Best<T>>) -> Self {
        Self {
            least: best.as_ref().map_or(f64::INFINITY, |best| best.fitness),
            best,
        }
    }
}

impl<T: Clone> BestSoFar<T> {
    /// Keeps `solution` if `fitness`, which is finite, is less than every one before.
    #[inline]
    pub(crate) fn offer(&mut self, solution: &T, fitness: f64, evaluation: u64) {
        if fitness < self.least {
            self.replace(solution, fitness, evaluation);
        }
    }

    #[cold]
    fn replace(&mut self, solution: &T, fitness: f64, evaluation: u64) {
        self.least = fitness;
        match &mut self.best {
            // Reuses the memory of a solution that owns some.
            Some(best) => {
                best.solution.clone_from(solution);
                best.fitness = fitness;
                best.evaluation = evaluation;
            }
            None => {
                self.best = Some(Best {
                    solution: solution.clone(),
                    fitness,
                    evaluation,
                });
            }
        }
    }

    pub(crate) fn get(&self) -> Option<&Best<T>> {
        self.best.as_ref()
    }
}

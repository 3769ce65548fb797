//! Exact methods for pairs of vertices, reported like engines: hits, evaluations, seconds.

use std::time::Instant;

use satisfice::catalogue::Catalogued;
use satisfice::{SatisficingProblem, StopReason};
use satisfice_collision::FeatureKind;
use satisfice_collision::broad::{FeatureTree, Pair, PointGrid, TreeJoin};
use satisfice_collision::distance::Threshold;
use satisfice_collision::problem::{Prepared, Recipe};
use satisfice_collision::{Mesh, Placement, VertexPairs};

pub use crate::method::{METHODS, Method, find};

use crate::error::Error;
use crate::report::RunReport;
use crate::spec::RunSpec;

/// A problem whose solutions are pairs of vertices.
pub trait Geometric: Catalogued<Solution = (u32, u32)> {
    /// The vertex pairs.
    fn vertex_pairs(&self) -> &VertexPairs;
}

impl<R: Recipe<Pairs = VertexPairs>> Geometric for Prepared<R> {
    fn vertex_pairs(&self) -> &VertexPairs {
        self.pairs()
    }
}

/// Runs an exact method. All pairs are known when it ends, so every hit is listed with all evaluations and the whole time,
/// which includes building the structure that the method needs. The budget is ignored.
///
/// # Errors
/// [`Error::Search`] for an unknown method; [`Error::Json`] for a solution that is not representable.
pub(crate) fn run(pairs: &VertexPairs, spec: RunSpec) -> Result<RunReport, Error> {
    let scene = Scene::new(pairs)?;
    let ((found, evaluations), seconds) = match spec.engine.as_str() {
        "aabb" => scene.timed(Scene::by_trees)?,
        "grid" => scene.timed(Scene::by_grid)?,
        "brute-force" => scene.timed(Scene::by_brute_force)?,
        other => {
            let known = METHODS.iter().map(|method| method.name);
            return Err(satisfice::Error::unknown("exact method", other, known).into());
        }
    };
    report(pairs, spec, &found, (evaluations, seconds))
}

/// The chosen vertices of the two bodies, prepared for the methods before the clock starts.
struct Scene<'a> {
    problem: &'a VertexPairs,
    numbers: [Vec<u32>; 2],
    points: [Vec<[f64; 3]>; 2],
    clouds: [Mesh; 2],
    one_body: bool,
    threshold: Threshold,
}

type Found = (Vec<(u32, u32)>, u64);

impl<'a> Scene<'a> {
    fn new(problem: &'a VertexPairs) -> Result<Self, Error> {
        let axes = problem.space().axes();
        let (a, b) = (problem.a(), problem.b());
        // A problem within one body returns the same mesh twice.
        let one_body = std::ptr::eq(a, b);
        let vertex = |axis: usize, place: f64| {
            let mut values = [axes[0].upper(), axes[1].upper()];
            if one_body {
                // Pairs are decoded in ascending order: a place paired with itself is not a pair, but names its vertex twice.
                values = [place; 2];
            } else {
                values[axis] = place;
            }
            let pair = problem.decode(&values);
            if axis == 0 { pair.0 } else { pair.1 }
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole, below 2^32"
        )]
        let numbers = [0, 1].map(|axis| {
            (0..=axes[axis].upper() as u32)
                .map(|place| vertex(axis, f64::from(place)))
                .collect::<Vec<u32>>()
        });
        let of = |mesh: &Mesh, numbers: &[u32]| numbers.iter().map(|&v| mesh.vertex(v)).collect::<Vec<_>>();
        let points = [of(a, &numbers[0]), of(b, &numbers[1])];
        let cloud =
            |points: &[[f64; 3]]| Mesh::new(points.to_vec(), vec![], vec![]).map_err(Error::VertexPairs);
        let clouds = [cloud(&points[0])?, cloud(&points[1])?];
        let threshold = Threshold::new(problem.threshold()).map_err(Error::VertexPairs)?;
        Ok(Self {
            problem,
            numbers,
            points,
            clouds,
            one_body,
            threshold,
        })
    }

    #[expect(
        clippy::disallowed_methods,
        reason = "an exact method has no budget; its time is only reported"
    )]
    fn timed(
        &self,
        method: impl Fn(&Self) -> Result<Found, satisfice_collision::Error>,
    ) -> Result<(Found, f64), Error> {
        let start = Instant::now();
        let found = method(self);
        let seconds = start.elapsed().as_secs_f64();
        let found = found.map_err(Error::VertexPairs)?;
        Ok((found, seconds))
    }

    /// The solutions at these places; within one body without the excluded pairs.
    fn solutions(&self, places: &[Pair]) -> Vec<(u32, u32)> {
        let pairs = places
            .iter()
            .map(|pair| (self.numbers[0][pair.a as usize], self.numbers[1][pair.b as usize]));
        if self.one_body {
            let ordered = pairs.map(|pair| self.problem.canonical(&pair).unwrap_or(pair));
            ordered
                .filter(|pair| self.problem.fitness(pair) < self.problem.threshold())
                .collect()
        } else {
            pairs.collect()
        }
    }

    fn by_trees(&self) -> Result<Found, satisfice_collision::Error> {
        let a = FeatureTree::new(&self.clouds[0], FeatureKind::Vertex);
        let mut join = TreeJoin::new();
        let pairs = if self.one_body {
            self.solutions(join.within(&a, self.threshold, None))
        } else {
            let b = FeatureTree::new(&self.clouds[1], FeatureKind::Vertex);
            let rest = &Placement::IDENTITY;
            self.solutions(join.between((&a, rest), (&b, rest), self.threshold, None)?)
        };
        Ok((pairs, join.work().candidates))
    }

    fn by_grid(&self) -> Result<Found, satisfice_collision::Error> {
        let mut grid = PointGrid::new();
        let pairs = if self.one_body {
            self.solutions(grid.within(&self.points[0], self.threshold)?)
        } else {
            self.solutions(grid.between(&self.points[0], &self.points[1], self.threshold)?)
        };
        Ok((pairs, grid.work().tests))
    }

    fn by_brute_force(&self) -> Result<Found, satisfice_collision::Error> {
        let [a, b] = [self.points[0].len() as u64, self.points[1].len() as u64];
        Ok((
            self.problem.reference_pairs(),
            if self.one_body { a * (a - 1) / 2 } else { a * b },
        ))
    }
}

fn report(
    problem: &VertexPairs,
    spec: RunSpec,
    found: &[(u32, u32)],
    cost: (u64, f64),
) -> Result<RunReport, Error> {
    let hits: Vec<(serde_json::Value, f64)> = found
        .iter()
        .map(|pair| Ok((serde_json::to_value(pair)?, problem.fitness(pair))))
        .collect::<Result<_, Error>>()?;
    let mut report = RunReport::at_once(spec, problem.threshold(), hits, cost);
    report.stop_reason = StopReason::Covered;
    report.set_proved();
    Ok(report)
}

#[cfg(test)]
mod tests {
    use satisfice_collision::generate;

    use super::*;

    /// Brute force is the referee of the other two.
    #[test]
    fn exact_methods_find_the_same_pairs() {
        let ball = generate::icosphere(1.0, 3).unwrap();
        let other = Placement::from_translation([1.9, 0.1, 0.0])
            .unwrap()
            .place(&ball)
            .unwrap();
        let sheet = generate::cloth(1.0, 0.2, 30, 10).unwrap();
        let folded = sheet
            .vertices()
            .iter()
            .map(|&[x, y, _]| [x.abs(), y, 0.05 * (x + 0.5)])
            .collect();
        let folded = sheet.with_vertices(folded).unwrap();
        for (problem, least) in [
            (VertexPairs::between(&ball, &other, 0.2).unwrap(), 100),
            (
                VertexPairs::between(&ball, &other, 0.2)
                    .unwrap()
                    .with_vertices(&[3, 99, 641, 7], &(0..600).collect::<Vec<_>>())
                    .unwrap(),
                0,
            ),
            (VertexPairs::within(&folded, 0.06, 1).unwrap(), 100),
        ] {
            let found = METHODS.iter().map(|method| {
                let report = run(&problem, RunSpec::new(method.name)).unwrap();
                assert_eq!(report.hits as usize, report.solutions.len());
                let mut pairs: Vec<_> = report
                    .solutions
                    .iter()
                    .map(|hit| hit.solution.to_string())
                    .collect();
                pairs.sort_unstable();
                (pairs, report.counts.evaluations)
            });
            let found: Vec<_> = found.collect();
            assert!(found[2].0.len() >= least, "{}", found[2].0.len());
            assert!(found[0].0 == found[2].0 && found[1].0 == found[2].0);
            assert!(found[0].1 < found[2].1 && found[1].1 < found[2].1);
        }
        assert!(
            run(
                &VertexPairs::within(&folded, 0.06, 1).unwrap(),
                RunSpec::new("aab")
            )
            .is_err()
        );
    }
}

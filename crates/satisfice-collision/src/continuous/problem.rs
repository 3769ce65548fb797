//! The candidates of a step as a problem for the search engines: which pairs hit, the earliest first.

use std::sync::Arc;

use satisfice::catalogue::Description;
use satisfice::{Axis, Bounds, Region, SatisficingProblem, Space};

use super::Separation;
use super::advance::Goal;
use super::body_order::filled;
use super::boxes::{EVERYWHERE, MovingBox};
use super::step::{FeatureList, MovingContact, Step};
use super::tree::MovingTree;
use crate::Error;
use crate::distance::PairKind;

/// F of a pair that does not hit: later than every time of the step.
const NEVER: f64 = 2.0;
/// F of what is no pair: a feature with itself, with a neighbour, or of one rigid body.
const NO_PAIR: f64 = 3.0;
/// F below which a pair hits: every time of the step.
const HIT: f64 = 1.5;
/// How far F may be from the time of impact.
const TOLERANCE: f64 = 1e-6;

/// All pairs of a kind that hit during a step.
///
/// Two integer axes: positions in the order of the step's trees, so that neighbouring positions are neighbours in space. F is the time of
/// impact of a pair, from 0 to 1 and within 1e-6 below it, 2 for a pair that does not hit; the threshold is 1.5. A region has a lower
/// bound: the first time at which the boxes around its features meet.
///
/// ```
/// use satisfice::SatisficingProblem;
/// use satisfice_collision::continuous::{MovingPairs, Separation, Step};
/// use satisfice_collision::distance::PairKind;
/// use satisfice_collision::generate;
/// let sheet = generate::cloth(1.0, 1.0, 4, 4)?;
/// let ball = generate::icosphere(0.2, 1)?;
/// let to: Vec<_> = ball.vertices().iter().map(|&[x, y, z]| [x, y, z + 1.0]).collect();
/// let mut step = Step::new();
/// step.add_rigid(&ball, &to)?;
/// step.add_rigid(&sheet, sheet.vertices())?;
/// let problem = MovingPairs::new(&step, PairKind::EdgeEdge, Separation::TOUCHING)?;
/// let hits = step.hits(PairKind::EdgeEdge, Separation::TOUCHING)?;
/// let report = satisfice::Search::with(satisfice::engine::BranchAndBound::default())
///     .run(&problem, &satisfice::Budget::evaluations(1_000_000))?;
/// assert_eq!(report.hits().len(), hits.pairs.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct MovingPairs<'s> {
    step: &'s Step,
    kind: PairKind,
    lists: [FeatureList; 2],
    separation: Separation,
    margin: f32,
    space: Space<f64>,
    /// Over the features of all bodies.
    trees: [Arc<MovingTree>; 2],
    /// The lane of the feature at each position.
    lanes: [Vec<u32>; 2],
}

impl<'s> MovingPairs<'s> {
    /// The pairs of a kind that come nearer than delta, or touch for a delta of 0.
    ///
    /// # Errors
    /// [`Error::Parameter`] for kinds that [`Step::hits`] refuses, and if the step has no features of the kind.
    pub fn new(step: &'s Step, kind: PairKind, separation: Separation) -> Result<Self, Error> {
        let lists = Step::lists(kind)?;
        let trees = lists.map(|list| step.tree(list, EVERYWHERE));
        let lanes = [0, 1].map(|side| {
            let features = filled(&trees[side].order);
            features.map(|(lane, _)| lane as u32).collect::<Vec<_>>()
        });
        if lanes.iter().any(Vec::is_empty) {
            return Err(Error::EmptyMesh);
        }
        let axes = [0, 1].map(|side| Axis::integer(0, lanes[side].len() as i64 - 1));
        let space = Space::new(axes).map_err(|error| {
            Error::parameter(
                "features",
                error,
                "so many that their numbers are exact in double precision",
            )
        })?;
        Ok(Self {
            step,
            kind,
            lists,
            separation,
            margin: step.margin(separation.get()),
            space,
            trees,
            lanes,
        })
    }

    /// The number of positions on each axis.
    #[must_use]
    pub fn positions(&self) -> [u32; 2] {
        [0, 1].map(|side| self.lanes[side].len() as u32)
    }

    fn feature(&self, side: usize, position: f64) -> u32 {
        let lane = self.lanes[side][position as usize];
        self.trees[side].order[lane as usize]
    }

    /// The box around the features at positions on an axis.
    fn around(&self, side: usize, from: f64, to: f64) -> MovingBox {
        self.trees[side].box_of_range(self.lanes[side][from as usize], self.lanes[side][to as usize])
    }
}

impl SatisficingProblem for MovingPairs<'_> {
    type Scalar = f64;
    type Solution = MovingContact;

    fn space(&self) -> &Space<f64> {
        &self.space
    }

    fn decode(&self, values: &[f64]) -> MovingContact {
        let [mut a, mut b] = [0, 1].map(|side| self.feature(side, values[side]));
        if self.lists[0] == self.lists[1] && a > b {
            (a, b) = (b, a);
        }
        MovingContact {
            a: self.step.feature(self.lists[0], a),
            b: self.step.feature(self.lists[1], b),
        }
    }

    fn fitness(&self, contact: &MovingContact) -> f64 {
        let Some([a, b]) = self.step.numbers(self.lists, contact) else {
            return f64::NAN;
        };
        if !self.step.may_pair(self.lists, a, b) {
            return NO_PAIR;
        }
        let goal = Goal {
            tolerance: TOLERANCE,
            ..Goal::DECISION
        };
        // nothing cuts it short
        let impact = self
            .step
            .impact(self.kind, a, b, self.separation, goal)
            .unwrap_or_default();
        impact.map_or(NEVER, |impact| impact.time[0])
    }

    fn threshold(&self) -> f64 {
        HIT
    }

    fn bounds(&self) -> Option<&dyn Bounds<f64>> {
        Some(self)
    }

    fn description(&self) -> Description {
        Description {
            name: format!("moving-{}-pairs", self.kind),
            parameters: vec![
                ("delta".to_owned(), self.separation.to_string()),
                ("features-a".to_owned(), self.lanes[0].len().to_string()),
                ("features-b".to_owned(), self.lanes[1].len().to_string()),
            ],
        }
    }
}

impl Bounds<f64> for MovingPairs<'_> {
    fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
        let [a, b] = [0, 1].map(|side| self.around(side, region.lower[side], region.upper[side]));
        Some(
            a.grown(self.margin)
                .meeting(&b)
                .map_or(NEVER, |[first, _]| (first - TOLERANCE).max(0.0)),
        )
    }
}

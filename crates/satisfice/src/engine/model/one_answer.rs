//! Regions of hits that count as one answer, and what proposals beside them are worth.
//!
//! Where a problem represents hits by a point of its own choice, such as the optimum or the root that they belong to, all hits around
//! a point are one answer, and beside it there are often none. A model cannot know that: it has seen F below delta there, and where it
//! has seen no miss it expects more of the same.

use super::reach::{is_within, middle, reach, square};
use super::record::Record;
use super::units::Units;
use crate::context::Context;
use crate::error::Error;
use crate::scalar::Real;
use crate::state::{Part, Reader, State};

/// A hit is represented by another point if the middle of its region is at least so many reaches away.
const MOVED: f64 = 0.05;
/// Points within so many reaches of a middle are beside the region.
const BESIDE: f64 = 2.0;
/// The share of promised hits that came starts as if so many had been promised, and had come.
const PRIOR: f64 = 0.3;
/// A model of whose promised hits at least this share came is believed.
const ENOUGH: f64 = 0.5;
/// Regions that are known at most: the first ones.
const MOST: usize = 256;

/// The regions of hits that are represented by other points.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct OneAnswer {
    /// Whether the first hit was represented by another point, once there is one.
    represented: Option<bool>,
    /// For each hit, the middle of its region, then the reach along each axis.
    regions: Vec<f64>,
    /// Hits that were promised beside regions, and those that came.
    promised: f64,
    kept: f64,
}

impl OneAnswer {
    /// Looks at the regions of new hits. Cost: 60 look-ups an axis for the first hit, and for each one where hits are represented by other
    /// points.
    pub(super) fn follow<S: Real>(
        &mut self,
        context: &dyn Context<S>,
        units: &Units,
        record: &Record,
        position: &mut [S],
    ) {
        let axes = units.len();
        while axes > 0 && self.represented != Some(false) {
            let known = self.regions.len() / (2 * axes);
            let (Some(&hit), true) = (record.hits.get(known), known < MOST) else {
                return;
            };
            let hit = record.point(hit);
            let middle = middle(context, units, hit, position);
            let reach = reach(context, units, &middle, position);
            if self.represented.is_none() {
                let moved = square(units, hit, &middle, &reach) > MOVED * MOVED;
                self.represented = Some(moved && reach.iter().all(|&reach| reach > 0.0));
            }
            if self.represented == Some(true) {
                self.regions.extend(middle);
                self.regions.extend(reach);
            }
        }
    }

    /// Whether a point is beside the region of a hit.
    pub(super) fn is_beside(&self, units: &Units, x: &[f64]) -> bool {
        self.regions.chunks_exact(2 * x.len().max(1)).any(|region| {
            let (middle, reach) = region.split_at(x.len());
            is_within(units, middle, x, reach, BESIDE)
        })
    }

    /// What is left of a probability beside a region for somebody who compares the hits that came there with those that were promised.
    pub(super) fn belief(&self) -> f64 {
        let share = (PRIOR + self.kept) / (PRIOR + self.promised);
        if share < ENOUGH { share } else { 1.0 }
    }

    /// Counts a proposal beside a region that is this probable to hit by what is [believed](Self::belief).
    pub(super) fn count(&mut self, believed: f64) {
        self.promised += (believed / self.belief()).min(1.0);
    }

    /// Counts a proposal beside a region that has hit.
    pub(super) fn keep(&mut self) {
        self.kept += 1.0;
    }

    pub(super) fn save(&self, state: &mut State) {
        Part::save(&self.represented, state);
        Part::save(&self.regions, state);
        Part::save(&(self.promised, self.kept), state);
    }

    pub(super) fn restored(axes: usize, from: &mut Reader<'_>) -> Result<Self, Error> {
        let represented = from.read()?;
        let regions: Vec<f64> = from.read()?;
        let (promised, kept) = from.read()?;
        if regions.len().checked_rem(2 * axes).unwrap_or(regions.len()) != 0 {
            return Err(Error::State("its regions do not fit".to_owned()));
        }
        Ok(Self {
            represented,
            regions,
            promised,
            kept,
        })
    }
}

#[cfg(test)]
mod tests {
    use core::ops::Range;

    use super::*;
    use crate::engine::model::record::PointKind;
    use crate::space::{Axis, Region, Space};
    use crate::testing::BareContext;

    /// Points within a distance of a centre are the same hit.
    struct Ball {
        bare: BareContext<f64>,
        centre: [f64; 3],
        radius: f64,
    }

    impl Context<f64> for Ball {
        fn space(&self) -> &Space<f64> {
            self.bare.space()
        }
        fn threshold(&self) -> f64 {
            self.bare.threshold()
        }
        fn elapsed_share(&self) -> f64 {
            0.0
        }
        fn evaluations(&self) -> u64 {
            0
        }
        fn hits(&self) -> usize {
            1
        }
        fn is_deleted(&self, position: &[f64]) -> bool {
            let square = |(x, c): (&f64, &f64)| (x - c) * (x - c);
            position.iter().zip(&self.centre).map(square).sum::<f64>() < self.radius * self.radius
        }
        fn neighbour_count(&self, of: &[f64]) -> usize {
            self.bare.neighbour_count(of)
        }
        fn neighbours(&self, _: &[f64], _: Range<usize>, _: &mut dyn FnMut(usize, &[f64])) {}
        fn offers_neighbours(&self) -> bool {
            false
        }
        fn lower_bound(&self, _: &Region<f64>) -> Option<f64> {
            None
        }
        fn previous_hits(&self) -> usize {
            0
        }
        fn previous_hit(&self, _: usize, _: &mut [f64]) -> bool {
            false
        }
    }

    /// What is known after a hit at this point of a cube from 0 to 10, whose ball has a radius of 2.
    fn after(hit: [f64; 3], centre: [f64; 3]) -> (OneAnswer, Units) {
        let space = Space::new([Axis::continuous(0.0, 10.0); 3]).unwrap();
        let units = Units::of(&space);
        let context = Ball {
            bare: BareContext::new(space),
            centre,
            radius: 2.0,
        };
        let mut record = Record::default();
        record.clear(3);
        record.add(&hit.map(|x| x / 10.0), 0.0, PointKind::Hit);
        let mut one_answer = OneAnswer::default();
        one_answer.follow(&context, &units, &record, &mut [0.0; 3]);
        (one_answer, units)
    }

    #[test]
    fn the_region_of_a_hit_that_is_represented_elsewhere_is_found() {
        let (one_answer, units) = after([4.0, 6.0, 5.5], [5.0, 5.0, 5.0]);
        assert_eq!(one_answer.represented, Some(true));
        for (x, expected) in one_answer.regions.iter().zip([0.5, 0.5, 0.5, 0.2, 0.2, 0.2]) {
            approx::assert_abs_diff_eq!(*x, expected, epsilon = 1e-5);
        }
        assert!(one_answer.is_beside(&units, &[0.85, 0.6, 0.5]));
        assert!(!one_answer.is_beside(&units, &[0.85, 0.7, 0.5]));
    }

    #[test]
    fn a_hit_that_represents_itself_has_no_region() {
        let (one_answer, units) = after([5.0, 5.0, 5.0], [5.0, 5.0, 5.0]);
        assert_eq!(one_answer.represented, Some(false));
        assert!(!one_answer.is_beside(&units, &[0.5, 0.5, 0.71]));
        // Nor is one taken to be represented elsewhere because its ball ends where the space does.
        let (at_the_end, _) = after([9.5, 5.0, 0.2], [9.5, 5.0, 0.2]);
        assert_eq!(at_the_end.represented, Some(false));
    }

    #[test]
    fn it_is_believed_by_the_hits_that_came_beside_regions() {
        let mut one_answer = OneAnswer::default();
        assert_eq!(one_answer.belief(), 1.0);
        one_answer.count(0.9);
        assert_eq!(one_answer.belief(), 0.25);
        // By the model, a hit was certain again.
        one_answer.count(0.25);
        approx::assert_relative_eq!(one_answer.belief(), 0.3 / 2.2);
        one_answer.keep();
        assert_eq!(one_answer.belief(), 1.0);
    }
}

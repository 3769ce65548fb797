//! Search along one axis at a time, for an F that the worst axis alone decides, such as the largest of several distances.

use super::search::Proposal;

/// How far a look goes, as a share of the axes: so little that the axis which decides F is the same there.
const LOOK: f64 = 1e-3;
/// A look along several axes tells which of them decides where F changes by a whole number of units, up to this share of one.
const EXACT: f64 = 1e-2;
/// F is the same where it changes by no more than this share of itself: the way from shares of an axis to positions rounds.
const SAME: f64 = 1e-10;
/// How much further a step goes than to where F would be at the threshold; the longest step, as a share of the axes.
const BEYOND: f64 = 0.05;
const LONGEST: f64 = 0.5;
/// Times that a step is halved before the search leaves its axis.
const HALVES: u32 = 3;
/// Evaluations for each axis, and a few more, after which a search is given up.
const PATIENCE: usize = 6;

/// Whether one axis decides F, and how steep F is along each: known to all searches of a run.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Decisive {
    /// Looks along single axes from points where one at least changes F, and those that left F as it was, but for rounding. What became of
    /// searches along the axes counts as so many looks.
    looks: f64,
    flat: f64,
    /// How much F changes along the axes of the space, for the whole width; 0 where that is not known.
    slopes: Vec<f64>,
}

impl Decisive {
    pub(super) fn begin(&mut self, dimension: usize) {
        *self = Self::default();
        self.slopes.resize(dimension, 0.0);
    }

    pub(super) fn fits(&self, dimension: usize) -> bool {
        self.slopes.len() == dimension
    }

    /// Whether too little is known: searches begin with looks along the axes.
    pub(super) fn is_open(&self) -> bool {
        self.looks == 0.0
    }

    /// Whether F stays as it is along most axes.
    pub(super) fn is_one_axis(&self) -> bool {
        self.looks > 0.0 && 2.0 * self.flat >= self.looks
    }

    /// Counts looks along all these axes, one from the best point after the other: how much F changed for the whole width.
    pub(super) fn count(&mut self, axes: &[usize], slopes: &[f64]) {
        let flat = slopes.iter().filter(|slope| **slope == 0.0).count();
        if flat == slopes.len() {
            return; // a plateau
        }
        self.looks += slopes.len() as f64;
        self.flat += flat as f64;
        for (&axis, slope) in axes.iter().zip(slopes) {
            if slope.is_finite() && *slope != 0.0 {
                self.slopes[axis] = slope.abs();
            }
        }
    }

    /// Counts the end of a search along so many axes.
    pub(super) fn count_end(&mut self, axes: usize, is_hit: bool) {
        self.looks += axes as f64;
        self.flat += if is_hit { axes as f64 } else { 0.0 };
    }

    /// How steep F is along an axis; where nobody has seen that, as steep as along another.
    fn slope(&self, axis: usize) -> Option<f64> {
        let known = |slope: &&f64| **slope > 0.0;
        let own = self.slopes.get(axis).filter(known);
        own.or_else(|| self.slopes.iter().find(known)).copied()
    }
}

/// What is awaited.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
enum Awaited {
    #[default]
    Nothing,
    /// A look along the next axis, so far.
    Look(f64),
    /// A look along several axes at once; along each F would change by another number of these units.
    Group(f64),
    /// A step along an axis.
    Step { axis: usize, length: f64, halves: u32 },
}

/// A search from a point down to a hit, in shares of the axes.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct CoordinateSearch {
    point: Vec<f64>,
    value: f64,
    /// The axes; at the front those along which F is flat here, at the back the last ones that the search went along.
    order: Vec<usize>,
    flat: usize,
    /// The axes of a look along several, in the order of their units, and how far it goes along each.
    group: Vec<(usize, f64)>,
    /// Whether a look along several axes told nothing here.
    is_unclear: bool,
    evaluations: usize,
    awaited: Awaited,
    /// The step to take next.
    next: Option<(usize, f64, u32)>,
    pub(super) proposed: Vec<f64>,
}

impl CoordinateSearch {
    pub(super) fn start(&mut self, point: &[f64], value: f64) {
        self.point.clear();
        self.point.extend_from_slice(point);
        self.value = value;
        self.order.clear();
        self.order.extend(0..point.len());
        (self.flat, self.evaluations) = (0, 0);
        self.is_unclear = false;
        (self.awaited, self.next) = (Awaited::Nothing, None);
    }

    pub(super) fn fits(&self, axes: usize) -> bool {
        let is_axis = |&axis: &usize| axis < axes;
        self.point.len() == axes
            && self.order.len() == axes
            && self.flat <= axes
            && self.order.iter().all(is_axis)
            && self.group.iter().all(|(axis, _)| is_axis(axis))
            && self.next.is_none_or(|(axis, ..)| is_axis(&axis))
            && !matches!(self.awaited, Awaited::Step { axis, .. } if axis >= axes)
            && [0, axes].contains(&self.proposed.len())
    }

    /// Finds the next point of a search along `axes` of the space.
    pub(super) fn propose(
        &mut self,
        shortest: f64,
        axes: &[usize],
        periodic: &[bool],
        decisive: &Decisive,
    ) -> Proposal {
        self.proposed.clear();
        self.proposed.extend_from_slice(&self.point);
        if self.evaluations >= PATIENCE * (axes.len() + 2) {
            return Proposal::Ends;
        }
        self.evaluations += 1;
        if let Some((axis, length, halves)) = self.next.take() {
            let there = self.point[axis] + length;
            self.proposed[axis] = if periodic[axis] {
                there
            } else {
                there.clamp(0.0, 1.0)
            };
            if (self.proposed[axis] - self.point[axis]).abs() < shortest {
                return Proposal::Ends;
            }
            self.awaited = Awaited::Step { axis, length, halves };
            return Proposal::Converges;
        }
        let left = &self.order[self.flat..];
        let inside = |axis: usize, by: f64| if self.point[axis] + by > 1.0 { -by } else { by };
        self.group.clear();
        if !self.is_unclear && left.len() > 1 {
            // Along axis k of the group F changes by k + 1 units.
            let mut unit = f64::INFINITY;
            for (k, &axis) in left.iter().enumerate() {
                if let Some(slope) = decisive.slope(axes[axis]) {
                    unit = unit.min(LOOK * slope / (k + 1) as f64);
                    self.group.push((axis, slope));
                }
            }
            if self.group.len() == left.len() {
                for (k, (axis, by)) in self.group.iter_mut().enumerate() {
                    *by = inside(*axis, (k + 1) as f64 * unit / *by);
                    self.proposed[*axis] += *by;
                }
                self.awaited = Awaited::Group(unit);
                return Proposal::Looks;
            }
        }
        let Some(&axis) = left.first() else {
            return Proposal::Ends;
        };
        let by = inside(axis, LOOK);
        self.proposed[axis] += by;
        self.awaited = Awaited::Look(by);
        Proposal::Looks
    }

    /// Takes F at the point that was proposed.
    pub(super) fn learn(&mut self, value: f64, threshold: f64, axes: &[usize], decisive: &mut Decisive) {
        let change = change(self.value, value);
        match core::mem::take(&mut self.awaited) {
            Awaited::Nothing => {}
            Awaited::Look(_) | Awaited::Group(_) if change.is_nan() || change.is_infinite() => self.flat += 1,
            Awaited::Look(_) if change == 0.0 => self.flat += 1,
            Awaited::Look(by) => {
                let axis = self.order[self.flat];
                decisive.slopes[axes[axis]] = (change / by).abs();
                self.step(axis, change / by, threshold);
            }
            Awaited::Group(_) if change == 0.0 => self.flat = self.order.len(),
            Awaited::Group(unit) => {
                let units = (change / unit).abs();
                let k = units.round();
                let is_clear = (units - k).abs() < EXACT && k >= 1.0 && k <= self.group.len() as f64;
                self.is_unclear = !is_clear;
                if is_clear {
                    #[expect(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "a number of axes"
                    )]
                    let (axis, by) = self.group[k as usize - 1];
                    self.step(axis, change / by, threshold);
                }
            }
            // Where two axes decide, F stays the same until the second one is moved, too.
            Awaited::Step { axis, .. } if change <= 0.0 => {
                core::mem::swap(&mut self.point, &mut self.proposed);
                self.value = value;
                self.order.retain(|other| *other != axis);
                self.order.push(axis);
                self.flat = 0;
                self.is_unclear = false;
            }
            Awaited::Step { axis, length, halves } if halves < HALVES => {
                self.next = Some((axis, 0.5 * length, halves + 1));
            }
            Awaited::Step { axis, .. } => {
                // It counts as flat here.
                self.order.retain(|other| *other != axis);
                self.order.insert(0, axis);
                self.flat += 1;
            }
        }
    }

    /// Goes to where F, with this slope along an axis, would be a little below the threshold.
    fn step(&mut self, axis: usize, slope: f64, threshold: f64) {
        let length = (1.0 + BEYOND) * (threshold - self.value) / slope;
        self.next = Some((axis, length.clamp(-LONGEST, LONGEST), 0));
    }
}

/// By how much F changes from one value to another: 0 where only rounding differs.
pub(super) fn change(from: f64, to: f64) -> f64 {
    let change = to - from;
    if change.abs() <= SAME * from.abs() {
        0.0
    } else {
        change
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Evaluations until F is below the threshold, from the middle; `None` if the search ends before.
    fn evaluations(
        fitness: impl Fn(&[f64]) -> f64,
        axes: usize,
        threshold: f64,
        decisive: &mut Decisive,
    ) -> Option<usize> {
        let (all, periodic): (Vec<usize>, _) = ((0..axes).collect(), vec![false; axes]);
        let mut search = CoordinateSearch::default();
        let start = vec![0.5; axes];
        search.start(&start, fitness(&start));
        for count in 1.. {
            if search.propose(1e-9, &all, &periodic, decisive) == Proposal::Ends {
                break;
            }
            let value = fitness(&search.proposed);
            if value < threshold {
                return Some(count);
            }
            search.learn(value, threshold, &all, decisive);
        }
        None
    }

    fn decisive(axes: usize) -> Decisive {
        let mut decisive = Decisive::default();
        decisive.begin(axes);
        decisive
    }

    /// The distance of the coordinate that is furthest from a place, in units of another size for each.
    fn furthest(sizes: [f64; 6]) -> impl Fn(&[f64]) -> f64 {
        let place = [0.1, 0.9, 0.45, 0.73, 0.22, 0.61];
        move |x| {
            let distances = x
                .iter()
                .zip(place)
                .zip(sizes)
                .map(|((x, c), s)| (x - c).abs() / s);
            distances.fold(0.0, f64::max)
        }
    }

    /// One look and one step for each coordinate, once it is known how steep F is.
    #[test]
    fn the_worst_coordinate_is_told_from_the_others_by_one_look() {
        let mut decisive = decisive(6);
        let fitness = furthest([0.05; 6]);
        let first = evaluations(&fitness, 6, 1.0, &mut decisive).unwrap();
        let second = evaluations(&fitness, 6, 1.0, &mut decisive).unwrap();
        assert!(second <= 10 && first <= 20, "{first} {second}");
    }

    #[test]
    fn coordinates_may_have_units_of_different_sizes() {
        let mut decisive = decisive(6);
        let fitness = furthest([0.05, 0.02, 0.1, 0.04, 0.07, 0.03]);
        let first = evaluations(&fitness, 6, 1.0, &mut decisive).unwrap();
        let second = evaluations(&fitness, 6, 1.0, &mut decisive).unwrap();
        assert!(second <= 10 && first <= 40, "{first} {second}");
    }

    #[test]
    fn a_plateau_or_a_minimum_above_the_threshold_ends_the_search() {
        assert_eq!(evaluations(|_| 3.0, 4, 1.0, &mut decisive(4)), None);
        let furthest = furthest([0.05; 6]);
        assert_eq!(evaluations(|x| furthest(x) + 2.0, 6, 1.0, &mut decisive(6)), None);
    }

    /// Most looks along the axes leave the largest of distances as it is, none a sum; a plateau tells nothing.
    #[test]
    fn looks_along_the_axes_tell_whether_one_axis_decides() {
        let axes = [0, 1, 2];
        let mut decisive = decisive(3);
        decisive.count(&axes, &[0.0; 3]);
        assert!(decisive.is_open() && !decisive.is_one_axis());
        decisive.count(&axes, &[0.0, -4.0, 0.0]);
        assert!(!decisive.is_open() && decisive.is_one_axis());
        assert_eq!(decisive.slope(0), Some(4.0));
        // Two searches in vain weigh more than that.
        decisive.count_end(3, true);
        decisive.count_end(3, false);
        assert!(decisive.is_one_axis());
        decisive.count_end(3, false);
        decisive.count_end(3, false);
        assert!(!decisive.is_one_axis());
        assert_eq!(change(1e3, 1e3 + 1e-9), 0.0);
    }
}

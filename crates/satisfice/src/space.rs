//! Where candidates live: axes with bounds, and what happens to a position that leaves them.
//!
//! Engines move *positions*, which are real on every axis. Problems see *values*: on an integer axis the value is
//! the floor of the position, so that an axis of the integers `lower..=upper` has positions in `[lower, upper + 1)`
//! and every integer owns a cell of width one. On a logarithmic axis the position is the logarithm of the value; the positions
//! of a permutation are keys, whose ranks are the values. This module alone maps one to the other.

mod axis;
mod permutations;

use permutations::permutations;

use crate::error::Error;
use crate::scalar::{Real, floor};

pub use axis::{Axis, AxisKind};

/// The treatment of a position outside the bounds. An infinite position goes to the bound it points at, NaN to the
/// middle of its axis, under every rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub enum Boundary {
    /// Mirrored at the bounds as often as needed, in closed form: any overshoot ends inside.
    #[default]
    Reflect,
    /// Put on the bound.
    Clamp,
    /// Periodic: what leaves at one end enters at the other; for angles.
    Wrap,
}

/// The box of all candidates.
///
/// ```
/// use satisfice::{Axis, Space};
/// let space = Space::<f64>::new([Axis::integer(0, 9), Axis::continuous(-1.0, 1.0)])?;
/// let mut position = [-0.25, 1.75];
/// space.keep_inside(&mut position);
/// assert_eq!(position, [0.25, 0.25]); // reflected
/// let mut value = [0.0; 2];
/// space.values(&position, &mut value);
/// assert_eq!(value, [0.0, 0.25]);     // floored on the integer axis
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Space<S> {
    axes: Vec<Axis<S>>,
    boundary: Boundary,
    /// Whether values differ from positions.
    maps: bool,
    /// First axis and length of each permutation.
    permutations: Vec<(usize, usize)>,
}

impl<S: Real> Space<S> {
    /// A space with these axes and the rule [`Boundary::Reflect`].
    ///
    /// # Errors
    /// [`Error::NoAxis`] without axes; [`Error::Bounds`] if bounds are not finite, are the wrong way round, have a
    /// difference that overflows, or are integers that the scalar cannot hold exactly, and for no categories or places.
    pub fn new(axes: impl IntoIterator<Item = Axis<S>>) -> Result<Self, Error> {
        let axes: Vec<_> = axes.into_iter().collect();
        if axes.is_empty() {
            return Err(Error::NoAxis);
        }
        for (index, axis) in axes.iter().enumerate() {
            axis.check(index)?;
        }
        Ok(Self {
            maps: axes
                .iter()
                .any(|axis| axis.kind != AxisKind::Continuous || axis.logarithmic),
            permutations: permutations(&axes)?,
            axes,
            boundary: Boundary::default(),
        })
    }

    /// `dimension` continuous axes with the same bounds.
    ///
    /// # Errors
    /// As [`Space::new`].
    pub fn cube(dimension: usize, lower: S, upper: S) -> Result<Self, Error> {
        Self::new((0..dimension).map(|_| Axis::continuous(lower, upper)))
    }

    /// `dimension` integer axes `0..cells`.
    ///
    /// # Errors
    /// As [`Space::new`]; [`Error::Parameter`] for 0 cells.
    pub fn lattice(dimension: usize, cells: u32) -> Result<Self, Error> {
        if cells == 0 {
            return Err(Error::parameter(
                "cells",
                cells,
                "an axis without cells has no value: give at least 1",
            ));
        }
        Self::new((0..dimension).map(|_| Axis::integer(0, i64::from(cells) - 1)))
    }

    /// The same space under another boundary rule.
    #[must_use]
    pub fn with_boundary(mut self, boundary: Boundary) -> Self {
        self.boundary = boundary;
        self
    }

    /// The boundary rule.
    #[must_use]
    pub fn boundary(&self) -> Boundary {
        self.boundary
    }

    /// The axes, in order.
    #[must_use]
    pub fn axes(&self) -> &[Axis<S>] {
        &self.axes
    }

    /// Number of axes, D.
    #[inline]
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.axes.len()
    }

    /// Whether values differ from positions on any axis.
    #[inline]
    #[must_use]
    pub fn maps(&self) -> bool {
        self.maps
    }

    /// Whether equal shares of the values on some continuous axis are not equal shares of the positions: a box of values is
    /// then no box of positions of the same shape.
    #[must_use]
    pub(crate) fn is_curved(&self) -> bool {
        self.axes
            .iter()
            .any(|axis| axis.logarithmic || axis.kind == AxisKind::Place)
    }

    /// Whether what leaves axis `axis` at one end enters at the other: by its own rule or by that of the space.
    ///
    /// # Panics
    /// If there is no such axis.
    #[must_use]
    pub fn is_periodic(&self, axis: usize) -> bool {
        self.axes[axis].periodic || self.boundary == Boundary::Wrap
    }

    /// Number of points of a space of integers, categories and permutations, as a real because it may be huge: n! for a permutation of n.
    /// `None` with a continuous axis of positive width.
    #[must_use]
    pub fn cardinality(&self) -> Option<f64> {
        self.axes.iter().try_fold(1.0, |count, axis| match axis.kind {
            AxisKind::Continuous => (axis.width() == S::zero()).then_some(count),
            AxisKind::Integer | AxisKind::Categorical | AxisKind::Place => Some(count * axis.choices()),
        })
    }

    /// Whether no axis is continuous, so that points can be told apart.
    pub(crate) fn is_discrete(&self) -> bool {
        self.axes.iter().all(|axis| axis.kind != AxisKind::Continuous)
    }

    /// Whether every coordinate of a position is inside. Cost: O(D).
    #[must_use]
    pub fn contains(&self, position: &[S]) -> bool {
        position.len() == self.axes.len()
            && self
                .axes
                .iter()
                .zip(position)
                .all(|(axis, &x)| axis.start <= x && x <= axis.end)
    }

    /// Checks that these are values of the space: one per axis, inside the bounds, whole on integer axes. Cost: O(D).
    ///
    /// # Errors
    /// [`Error::Solution`] with the axis.
    pub fn check_values(&self, values: &[S]) -> Result<(), Error> {
        if values.len() != self.axes.len() {
            let (got, wanted) = (values.len(), self.axes.len());
            return Err(Error::Solution(format!("{got} values for {wanted} axes")));
        }
        for (j, (axis, &x)) in self.axes.iter().zip(values).enumerate() {
            let (lower, upper) = (axis.lower, axis.upper);
            if !(lower <= x && x <= upper) {
                return Err(Error::Solution(format!(
                    "{x} on axis {j}, which is [{lower}, {upper}]"
                )));
            }
            if axis.kind != AxisKind::Continuous && x.fract() != S::zero() {
                return Err(Error::Solution(format!("{x} on axis {j}, which is whole")));
            }
        }
        self.first_repeated(values).map_or(Ok(()), |(first, length)| {
            let last = first + length - 1;
            Err(Error::Solution(format!(
                "axes {first} to {last} are a permutation, in which a value is there twice"
            )))
        })
    }

    /// Brings a position inside by the boundary rule; one that is inside stays as it is. Cost: O(D).
    #[inline]
    pub fn keep_inside(&self, position: &mut [S]) {
        for (axis, x) in self.axes.iter().zip(position) {
            hold(x, axis, self.boundary);
        }
    }

    /// [`Space::keep_inside`] and [`Space::values`] in one go.
    #[inline(always)]
    pub(crate) fn keep_inside_with_values(&self, position: &mut [S], values: &mut [S]) {
        for ((axis, x), value) in self.axes.iter().zip(position).zip(&mut *values) {
            hold(x, axis, self.boundary);
            *value = if axis.is_integer() {
                let whole = floor(*x);
                if whole < axis.upper { whole } else { axis.upper }
            } else if axis.logarithmic {
                axis.exponential(*x)
            } else {
                *x
            };
        }
        if !self.permutations.is_empty() {
            self.rank(values);
        }
    }

    /// Writes the values at a position that is inside. Cost: O(D).
    #[inline]
    pub fn values(&self, position: &[S], values: &mut [S]) {
        for ((axis, &x), value) in self.axes.iter().zip(position).zip(&mut *values) {
            *value = axis.value(x);
        }
        if !self.permutations.is_empty() {
            self.rank(values);
        }
    }

    /// Turns a position that is inside into values, in place.
    #[inline]
    pub(crate) fn to_values(&self, position: &mut [S]) {
        if self.maps {
            for (axis, x) in self.axes.iter().zip(&mut *position) {
                *x = axis.value(*x);
            }
            if !self.permutations.is_empty() {
                self.rank(position);
            }
        }
    }

    /// Turns values into positions, in place: the inverse of [`Space::values`].
    #[inline]
    pub fn positions(&self, values: &mut [S]) {
        if self.maps {
            for (axis, x) in self.axes.iter().zip(&mut *values) {
                *x = axis.position(*x);
            }
            for &(first, length) in &self.permutations {
                for x in &mut values[first..first + length] {
                    *x = self.axes[first].key_of_rank(*x);
                }
            }
        }
    }

    /// Moves a position that is inside to that of its values: the centre of its cell on integer axes, and the keys of ranks in
    /// permutations.
    pub(crate) fn centre(&self, position: &mut [S]) {
        self.to_values(position);
        self.positions(position);
    }

    /// The whole space as a region.
    #[must_use]
    pub fn region(&self) -> Region<S> {
        Region {
            lower: self.axes.iter().map(Axis::lower).collect(),
            upper: self.axes.iter().map(Axis::upper).collect(),
        }
    }
}

/// Brings `x` inside the positions of its axis if it is not there.
#[inline(always)]
fn hold<S: Real>(x: &mut S, axis: &Axis<S>, boundary: Boundary) {
    if !(axis.start <= *x && *x <= axis.end) {
        let boundary = if axis.periodic { Boundary::Wrap } else { boundary };
        *x = bring_inside(*x, axis.start, axis.end, boundary);
    }
}

/// `x` brought into `[lower, end]`.
#[cold]
fn bring_inside<S: Real>(x: S, lower: S, end: S, boundary: Boundary) -> S {
    let width = end - lower;
    if x.is_nan() {
        return lower + width / S::of(2.0);
    }
    let overshoot = x - lower;
    // An overshoot that overflows has no mirror image: it goes to the bound it points at, as an infinite one does.
    if boundary == Boundary::Clamp || !overshoot.is_finite() || width == S::zero() {
        return if x < lower { lower } else { end };
    }
    let inside = match boundary {
        Boundary::Wrap => {
            let rest = overshoot % width; // exact, with the sign of the overshoot
            if rest < S::zero() { rest + width } else { rest }
        }
        Boundary::Reflect | Boundary::Clamp => {
            // Both ways out fold alike, with period 2 * width. Where that overflows, no finite overshoot reaches it.
            let period = width + width;
            let far = overshoot.abs();
            // Nearly all of them are less than a period out: no remainder to compute.
            let rest = if far < period || !period.is_finite() {
                far
            } else {
                far % period
            };
            if rest > width {
                width - (rest - width)
            } else {
                rest
            }
        }
    };
    (lower + inside).max(lower).min(end)
}

/// A closed box of values, inclusive on integer axes too.
///
/// ```
/// use satisfice::{Region, Space};
/// let space = Space::<f64>::lattice(2, 10)?;
/// let region = Region { lower: vec![0.0, 4.0], upper: vec![3.0, 9.0] };
/// assert_eq!(region.middle(&space, 0), 1.0);
/// assert!(region.contains(&[3.0, 4.0]));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Region<S> {
    /// Least value on each axis.
    pub lower: Vec<S>,
    /// Greatest value on each axis.
    pub upper: Vec<S>,
}

impl<S: Real> Region<S> {
    /// The value in the middle of axis `axis` of a region of `space`: rounded down on an integer axis, that of the mean logarithm on a
    /// logarithmic one.
    ///
    /// # Panics
    /// If region or space have no such axis.
    #[must_use]
    pub fn middle(&self, space: &Space<S>, axis: usize) -> S {
        let (lower, upper) = (self.lower[axis], self.upper[axis]);
        let half = (upper - lower) / S::of(2.0);
        let axis = &space.axes[axis];
        if axis.kind != AxisKind::Continuous {
            return lower + half.floor();
        }
        if axis.logarithmic {
            let middle = axis.value_between(lower, upper, S::of(0.5));
            // Where logarithms are too coarse to tell the ends apart, values may not be.
            if lower < middle && middle < upper {
                return middle;
            }
        }
        lower + half
    }

    /// Whether a point of values lies inside.
    #[must_use]
    pub fn contains(&self, values: &[S]) -> bool {
        self.lower
            .iter()
            .zip(&self.upper)
            .zip(values)
            .all(|((&l, &u), &x)| l <= x && x <= u)
    }
}

#[cfg(test)]
#[path = "space_tests.rs"]
mod tests;

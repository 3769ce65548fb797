//! How far apart two solutions have to be to be two.

use std::sync::Arc;

use crate::scalar::Real;

/// How far apart two points have to be to count as two: the same radius on all axes, or each axis by itself.
///
/// ```
/// use satisfice::{AxisSeparation, Located, Identity, Separation};
/// // The first axis is exact, the second counts to a tenth, the third is an angle in degrees.
/// let apart = Separation::axes([
///     AxisSeparation::exact(),
///     AxisSeparation::within(0.1),
///     AxisSeparation::within(5.0).periodic(360.0),
/// ]);
/// let at = |x: [f64; 3]| Located::new(&x, apart.clone());
/// assert!(at([1.0, 0.5, 359.0]).same(&at([1.0, 0.55, 1.0])));
/// assert!(!at([1.0, 0.5, 359.0]).same(&at([2.0, 0.5, 359.0])));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Separation<S> {
    /// Two are the same if their Euclidean distance is at most this; 0 means equal coordinates only.
    Radius(S),
    /// Two are the same if they are in an ellipsoid: if the squares of distance / radius of the axes sum to at most 1, and
    /// axes of radius 0 are equal.
    Axes(Arc<Vec<AxisSeparation<S>>>),
}

/// The part of one axis in [`Separation::Axes`].
///
/// ```
/// use satisfice::{AxisSeparation, Identity, Located, Separation};
/// let one_percent = Separation::axes([AxisSeparation::within(0.01).logarithmic()]);
/// let at = |x| Located::new(&[x], one_percent.clone());
/// assert!(at(1e6).same(&at(1.009e6)) && !at(1e-6).same(&at(1.02e-6)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisSeparation<S> {
    radius: S,
    /// 0 where the axis is not periodic.
    period: S,
    logarithmic: bool,
}

impl<S: Real> AxisSeparation<S> {
    /// Only equal coordinates are the same.
    #[must_use]
    pub fn exact() -> Self {
        Self::within(S::zero())
    }

    /// Coordinates up to `radius` apart may be the same. A negative radius or NaN counts as 0.
    #[must_use]
    pub fn within(radius: S) -> Self {
        Self {
            radius: radius.max(S::zero()),
            period: S::zero(),
            logarithmic: false,
        }
    }

    /// Coordinates a period apart are the same. A period that is not positive and finite counts as none.
    #[must_use]
    pub fn periodic(mut self, period: S) -> Self {
        self.period = if period > S::zero() && period.is_finite() {
            period
        } else {
            S::zero()
        };
        self
    }

    /// The distance is that of the natural logarithms: a radius of 0.01 is about one percent.
    #[must_use]
    pub fn logarithmic(mut self) -> Self {
        self.logarithmic = true;
        self
    }

    /// The radius.
    #[must_use]
    pub fn radius(&self) -> S {
        self.radius
    }

    /// Whether distances are differences.
    pub(super) fn is_plain(&self) -> bool {
        self.period == S::zero() && !self.logarithmic
    }

    /// Whether solutions that are the same have the very same coordinate.
    #[inline]
    pub(super) fn is_hashed_exactly(&self) -> bool {
        self.radius == S::zero() && self.period == S::zero()
    }

    /// A number by whose cells a coordinate is hashed, and how far apart it is at most for solutions that are the same. Where a radius is
    /// small beside the period, that is how far the coordinate is from a multiple of the period, which differs by no more than the
    /// distance. `None` on exact axes, and for other periodic ones, which are [`on_circle`](Self::on_circle).
    #[inline]
    pub(super) fn in_cells(&self, x: S) -> Option<(S, S)> {
        let x = self.measured(x);
        if self.period == S::zero() {
            return (self.radius > S::zero()).then_some((x, self.radius));
        }
        if !self.is_small_beside_period() {
            return None;
        }
        let beyond = (x % self.period).abs();
        // far more than rounding
        let apart = self.radius.max(S::epsilon().sqrt() * self.period);
        Some((beyond.min(self.period - beyond), apart))
    }

    /// Whether rounding of a place on the circle would not be small beside the radius.
    fn is_small_beside_period(&self) -> bool {
        self.radius.f64() <= 1e4 * S::epsilon().f64() * self.period.f64()
    }

    /// Where a periodic coordinate is on a circle of its period: a chord is no longer than the arc. `None` on other axes, and where
    /// rounding is not small beside the radius.
    pub(super) fn on_circle(&self, x: S) -> Option<[f64; 2]> {
        let period = self.period.f64();
        if period <= 0.0 || self.is_small_beside_period() {
            return None;
        }
        let turn = core::f64::consts::TAU / period;
        let (sine, cosine) = (self.measured(x).f64() % period * turn).sin_cos();
        Some([cosine / turn, sine / turn])
    }

    /// The coordinate that distances are measured by.
    #[inline]
    pub(super) fn measured(&self, x: S) -> S {
        if self.logarithmic { x.ln() } else { x }
    }

    /// The distance of two coordinates.
    #[inline]
    fn distance(&self, a: S, b: S) -> S {
        let d = (self.measured(a) - self.measured(b)).abs();
        if self.period > S::zero() {
            let d = d % self.period;
            d.min(self.period - d)
        } else {
            d
        }
    }

    /// No less than the distance of `x` from any coordinate between two: what a distance may be wrong by is added.
    fn farthest(&self, x: S, lower: S, upper: S) -> S {
        let [x, lower, upper] = [x, lower, upper].map(|x| self.measured(x));
        let rounding = S::of(8.0) * S::epsilon() * (x.abs() + lower.abs() + upper.abs() + self.period);
        if self.period == S::zero() {
            return (x - lower).abs().max((x - upper).abs()) + rounding;
        }
        let half = self.period / S::of(2.0);
        // How far the point opposite is ahead of the lower end.
        let turns = (x + half - lower) / self.period;
        let opposite = (turns - turns.floor()) * self.period;
        if opposite <= upper - lower {
            return half + rounding;
        }
        let around = |end: S| {
            let d = (x - end).abs() % self.period;
            d.min(self.period - d)
        };
        around(lower).max(around(upper)) + rounding
    }

    /// The square of the distance / radius of `x` from the farthest coordinate between two, or more; exact where distances are differences.
    pub(super) fn farthest_square(&self, x: S, lower: S, upper: S) -> S {
        if lower == upper {
            return self.square(x, lower);
        }
        if self.is_plain() {
            let is_lower = (x - lower).abs() > (x - upper).abs();
            return self.square(x, if is_lower { lower } else { upper });
        }
        let d = self.farthest(x, lower, upper) / self.radius;
        d * d
    }

    /// The square of distance / radius; infinite if the axis is exact and they differ.
    #[inline]
    pub(super) fn square(&self, a: S, b: S) -> S {
        if a == b {
            return S::zero();
        }
        if self.is_hashed_exactly() {
            return S::infinity();
        }
        let d = self.distance(a, b);
        if self.radius == S::zero() {
            return if d == S::zero() { d } else { S::infinity() };
        }
        let d = d / self.radius;
        d * d
    }
}

impl<S: Real> Separation<S> {
    /// Each axis by itself.
    #[must_use]
    pub fn axes(axes: impl IntoIterator<Item = AxisSeparation<S>>) -> Self {
        Self::Axes(Arc::new(axes.into_iter().collect()))
    }

    /// Becomes another one, without counting references to the same axes.
    #[inline]
    pub(super) fn set(&mut self, other: &Self) {
        match (&mut *self, other) {
            (Self::Radius(radius), Self::Radius(other)) => *radius = *other,
            (Self::Axes(axes), Self::Axes(other)) if Arc::ptr_eq(axes, other) => {}
            _ => self.clone_from(other),
        }
    }

    /// The radius of an axis.
    #[must_use]
    pub fn radius(&self, axis: usize) -> S {
        match self {
            Self::Radius(radius) => *radius,
            Self::Axes(axes) => axes.get(axis).map_or(S::zero(), |axis| axis.radius),
        }
    }
}

impl<S: Real> From<S> for Separation<S> {
    fn from(radius: S) -> Self {
        Self::Radius(radius)
    }
}

mod serial {
    //! A radius is written as a number, axes as a list.

    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::{AxisSeparation, Separation};
    use crate::scalar::Real;

    #[derive(Serialize, Deserialize)]
    #[serde(untagged, bound(deserialize = "S: Real"))]
    enum Plain<S> {
        Radius(S),
        Axes(Vec<PlainAxis<S>>),
    }

    #[derive(Serialize, Deserialize)]
    #[serde(untagged, bound(deserialize = "S: Real"))]
    enum PlainAxis<S> {
        Radius(S),
        AxisRecord(AxisRecord<S>),
    }

    #[derive(Serialize, Deserialize)]
    #[serde(bound(deserialize = "S: Real"))]
    enum Tagged<S> {
        Radius(S),
        Axes(Vec<AxisRecord<S>>),
    }

    #[derive(Serialize, Deserialize)]
    #[serde(bound(deserialize = "S: Real"))]
    struct AxisRecord<S> {
        radius: S,
        period: S,
        logarithmic: bool,
    }

    impl<S: Real> From<&AxisSeparation<S>> for AxisRecord<S> {
        fn from(axis: &AxisSeparation<S>) -> Self {
            Self {
                radius: axis.radius,
                period: axis.period,
                logarithmic: axis.logarithmic,
            }
        }
    }

    impl<S: Real> From<AxisRecord<S>> for AxisSeparation<S> {
        fn from(axis: AxisRecord<S>) -> Self {
            let one = Self::within(axis.radius).periodic(axis.period);
            if axis.logarithmic { one.logarithmic() } else { one }
        }
    }

    fn plain<S: Real>(axis: &AxisSeparation<S>) -> PlainAxis<S> {
        if axis.is_plain() {
            PlainAxis::Radius(axis.radius)
        } else {
            PlainAxis::AxisRecord(axis.into())
        }
    }

    fn read<S: Real>(axis: PlainAxis<S>) -> AxisSeparation<S> {
        match axis {
            PlainAxis::Radius(radius) => AxisSeparation::within(radius),
            PlainAxis::AxisRecord(axis) => axis.into(),
        }
    }

    impl<S: Real> Serialize for Separation<S> {
        fn serialize<W: Serializer>(&self, serializer: W) -> Result<W::Ok, W::Error> {
            match (self, serializer.is_human_readable()) {
                (Self::Radius(radius), true) => radius.serialize(serializer),
                (Self::Axes(axes), true) => serializer.collect_seq(axes.iter().map(plain)),
                (Self::Radius(radius), false) => Tagged::Radius(*radius).serialize(serializer),
                (Self::Axes(axes), false) => {
                    Tagged::Axes(axes.iter().map(AxisRecord::from).collect()).serialize(serializer)
                }
            }
        }
    }

    impl<'de, S: Real> Deserialize<'de> for Separation<S> {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            Ok(if deserializer.is_human_readable() {
                match Plain::deserialize(deserializer)? {
                    Plain::Radius(radius) => Self::Radius(radius),
                    Plain::Axes(axes) => Self::axes(axes.into_iter().map(read)),
                }
            } else {
                match Tagged::deserialize(deserializer)? {
                    Tagged::Radius(radius) => Self::Radius(radius),
                    Tagged::Axes(axes) => Self::axes(axes.into_iter().map(AxisSeparation::from)),
                }
            })
        }
    }
}

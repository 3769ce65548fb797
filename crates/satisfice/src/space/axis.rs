//! One axis: its bounds, what its values are, and how positions become values.

use crate::error::Error;
use crate::scalar::{Real, floor};

/// What the values of an axis are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum AxisKind {
    /// Every real in `[lower, upper]`.
    Continuous,
    /// The integers `lower..=upper`.
    Integer,
    /// Categories, written as the integers `0..n`: they have no order.
    Categorical,
    /// A place of a permutation, whose value is one of the integers `0..n`, each once.
    Place,
}

/// One axis of a [`Space`](crate::Space), checked by [`Space::new`](crate::Space::new).
///
/// ```
/// use satisfice::{from_fn, Axis, Budget, Search, Space};
/// // A rate over six decades, an angle, a number of layers, one of three kinds, and an order of four steps.
/// let space = Space::<f64>::new(
///     [
///         Axis::continuous(1e-6, 1.0).logarithmic(),
///         Axis::continuous(0.0, 360.0).periodic(),
///         Axis::integer(1, 8),
///         Axis::categorical(3),
///     ]
///     .into_iter()
///     .chain(Axis::permutation(4)),
/// )?;
/// let problem = from_fn(space, 1.0, |x: &[f64]| {
///     let order = (x[4], x[5], x[6], x[7]) == (3.0, 2.0, 1.0, 0.0);
///     (x[0] / 1e-4).ln().abs() + x[1].min(360.0 - x[1]) / 60.0 + if x[3] == 1.0 && order { 0.0 } else { 9.0 }
/// });
/// let report = Search::new().run(&problem, &Budget::evaluations(20_000))?;
/// assert!(report.hits().all(|hit| hit.solution.coordinates[4..] == [3.0, 2.0, 1.0, 0.0]));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Axis<S> {
    pub(super) lower: S,
    pub(super) upper: S,
    /// Ends of the positions.
    pub(super) start: S,
    pub(super) end: S,
    pub(super) kind: AxisKind,
    pub(super) logarithmic: bool,
    pub(super) periodic: bool,
    /// Which place of its permutation it is, from 0.
    pub(super) place: u32,
}

impl<S: Real> Axis<S> {
    /// All reals in `[lower, upper]`; equal bounds fix the value.
    #[must_use]
    pub fn continuous(lower: S, upper: S) -> Self {
        Self {
            lower,
            upper,
            start: lower,
            end: upper,
            kind: AxisKind::Continuous,
            logarithmic: false,
            periodic: false,
            place: 0,
        }
    }

    /// The integers `lower..=upper`.
    #[must_use]
    #[expect(
        clippy::cast_precision_loss,
        reason = "`Space::new` refuses integers that are not exact"
    )]
    pub fn integer(lower: i64, upper: i64) -> Self {
        let (lower, upper) = (S::of(lower as f64), S::of(upper as f64));
        Self {
            end: upper + S::one(),
            kind: AxisKind::Integer,
            ..Self::continuous(lower, upper)
        }
    }

    /// `count` categories without an order, whose values are the integers `0..count`. The neighbours of one are all others;
    /// a model measures 0 or 1 between two.
    #[must_use]
    pub fn categorical(count: u32) -> Self {
        Self {
            kind: AxisKind::Categorical,
            periodic: true, // no category is at an end
            ..Self::integer(0, i64::from(count) - 1)
        }
    }

    /// The places of a permutation of the integers `0..count`, one axis each; they stand together, in this order: `x[i]` is what
    /// stands at place `i`, such as the job that is done as number `i`. Different orders are different answers, whatever a separation
    /// says. Engines move
    /// a key for each place: values are the ranks of the keys (Bean 1994, doi 10.1287/ijoc.6.2.154). A `count` of 0 is refused by
    /// [`Space::new`](crate::Space::new).
    pub fn permutation(count: u32) -> impl Iterator<Item = Self> {
        // One axis without values stands for no places, so that it is refused and not left out.
        (0..count.max(1)).map(move |place| Self {
            start: S::zero(),
            end: S::one(),
            kind: AxisKind::Place,
            place,
            ..Self::integer(0, i64::from(count) - 1)
        })
    }

    /// The same reals, searched by their logarithm: an axis of several orders of magnitude. [`Space::new`](crate::Space::new) refuses it unless
    /// the axis is continuous with a lower bound above 0.
    #[must_use]
    pub fn logarithmic(mut self) -> Self {
        self.logarithmic = true;
        self.start = self.lower.ln();
        self.end = self.upper.ln();
        self
    }

    /// The same axis as a circle: what leaves at one end enters at the other, whatever the boundary rule of the space. The ends
    /// of a continuous axis are one point. [`Space::new`](crate::Space::new) refuses it on logarithmic axes and on places of a permutation.
    #[must_use]
    pub fn periodic(mut self) -> Self {
        self.periodic = true;
        self
    }

    /// Least value.
    #[must_use]
    pub fn lower(&self) -> S {
        self.lower
    }

    /// Greatest value.
    #[must_use]
    pub fn upper(&self) -> S {
        self.upper
    }

    /// What its values are.
    #[must_use]
    pub fn kind(&self) -> AxisKind {
        self.kind
    }

    /// Whether positions fall into cells, one for each integer or category.
    #[inline]
    #[must_use]
    pub fn is_integer(&self) -> bool {
        matches!(self.kind, AxisKind::Integer | AxisKind::Categorical)
    }

    /// Whether the position is the logarithm of the value.
    #[inline]
    #[must_use]
    pub fn is_logarithmic(&self) -> bool {
        self.logarithmic
    }

    /// Whether it is a later place of the permutation that `place` is a place of.
    pub(crate) fn follows(&self, place: &Self) -> bool {
        let both = self.kind == AxisKind::Place && place.kind == AxisKind::Place;
        both && self.place > place.place
    }

    /// Whether [it is a circle](Axis::periodic).
    #[inline]
    #[must_use]
    pub fn is_periodic(&self) -> bool {
        self.periodic
    }

    /// Least position: that of `lower`, or 0 for a place of a permutation.
    #[inline]
    #[must_use]
    pub fn start(&self) -> S {
        self.start
    }

    /// End of the positions: that of `upper`; `upper + 1` on an integer axis (excluded there), 1 for a place of a permutation.
    #[inline]
    #[must_use]
    pub fn end(&self) -> S {
        self.end
    }

    /// Length of the positions, `end - start`; the number of values on an integer axis.
    #[inline]
    #[must_use]
    pub fn width(&self) -> S {
        self.end - self.start
    }

    /// The value at a position that is inside: its floor on an integer axis, its exponential on a logarithmic one, else
    /// itself. At a place of a permutation that is the key, whose rank only [`Space::values`](crate::Space::values) knows.
    #[inline]
    #[must_use]
    pub fn value(&self, position: S) -> S {
        match self.kind {
            AxisKind::Integer | AxisKind::Categorical => floor(position).min(self.upper),
            AxisKind::Continuous if self.logarithmic => self.exponential(position),
            AxisKind::Continuous | AxisKind::Place => position,
        }
    }

    /// The value on a logarithmic axis; exact at the bounds.
    pub(super) fn exponential(&self, position: S) -> S {
        if position <= self.start {
            self.lower
        } else if position >= self.end {
            self.upper
        } else {
            position.exp().max(self.lower).min(self.upper)
        }
    }

    /// A position whose value is `value`: the centre of its cell on an integer axis. A key of a place of a permutation is
    /// itself.
    #[inline]
    #[must_use]
    pub fn position(&self, value: S) -> S {
        match self.kind {
            AxisKind::Integer | AxisKind::Categorical => {
                // Where halves are not representable, the value itself.
                let centre = value + S::of(0.5);
                if floor(centre) == value { centre } else { value }
            }
            AxisKind::Continuous if self.logarithmic => value.ln().max(self.start).min(self.end),
            AxisKind::Continuous | AxisKind::Place => value,
        }
    }

    /// The positions of the values from `lower` to `upper`: half open on an integer axis, whose last position is left out.
    #[must_use]
    pub(crate) fn positions_between(&self, lower: S, upper: S) -> (S, S) {
        match self.kind {
            // The last cell is half open; its middle is inside whatever the rounding.
            AxisKind::Integer | AxisKind::Categorical => (lower, upper + S::of(0.999)),
            AxisKind::Continuous => (self.position(lower), self.position(upper)),
            AxisKind::Place => {
                let count = self.upper + S::one();
                (lower / count, (upper + S::one()) / count)
            }
        }
    }

    /// The share of the axis between two values: of its logarithms on a logarithmic one. NaN on an axis of one value.
    pub(crate) fn share_between(&self, lower: S, upper: S) -> S {
        if self.logarithmic {
            (self.position(upper) - self.position(lower)) / self.width()
        } else {
            (upper - lower) / (self.upper - self.lower)
        }
    }

    /// The value of a continuous axis at `share` in `[0, 1]` of the way from one value to another, by their logarithms on a logarithmic one.
    pub(crate) fn value_between(&self, lower: S, upper: S, share: S) -> S {
        let (start, end) = self.positions_between(lower, upper);
        let value = self.value(start + share * (end - start));
        value.max(lower).min(upper)
    }

    /// The position at `share` in `[0, 1)` of the axis: how uniform draws become positions. It is no value of the axis: on a
    /// logarithmic axis it is a logarithm, on an integer axis it has a fraction. [`Axis::value`] gives the value there.
    ///
    /// ```
    /// use satisfice::Axis;
    /// let rate = Axis::continuous(1e-4_f64, 1.0).logarithmic();
    /// assert!(rate.at(0.5) < 0.0 && (rate.value(rate.at(0.5)) - 0.01).abs() < 1e-12);
    /// let teeth = Axis::<f64>::integer(10, 19);
    /// assert_eq!((teeth.at(0.25), teeth.value(teeth.at(0.25))), (12.5, 12.0));
    /// ```
    #[inline]
    #[must_use]
    pub fn at(&self, share: f64) -> S {
        let position = self.start + S::of(share) * self.width();
        // Rounding may reach the end, which an integer axis excludes; `value` mends that.
        position.min(self.end)
    }

    pub(super) fn check(&self, axis: usize) -> Result<(), Error> {
        let (lower, upper) = (self.lower.f64(), self.upper.f64());
        let bad = |reason| {
            Err(Error::Bounds {
                axis,
                lower,
                upper,
                reason,
            })
        };
        if !self.lower.is_finite() || !self.upper.is_finite() {
            return bad("both have to be finite");
        }
        if self.lower > self.upper {
            return bad(match self.kind {
                AxisKind::Categorical => "there is no category: give at least 1",
                AxisKind::Place => "a permutation of nothing: give at least 1 place",
                AxisKind::Integer | AxisKind::Continuous => {
                    "the lower one is above the upper one, so that there is no value between them"
                }
            });
        }
        if !(self.upper - self.lower).is_finite() {
            return bad("their difference overflows");
        }
        if self.logarithmic && (self.kind != AxisKind::Continuous || self.lower <= S::zero()) {
            return bad("a logarithmic axis is continuous, with a lower bound above 0");
        }
        if self.periodic && (self.logarithmic || self.kind == AxisKind::Place) {
            return bad("a periodic axis is continuous or integer, and not logarithmic");
        }
        #[expect(clippy::cast_precision_loss, reason = "powers of two")]
        let largest = S::MAX_INTEGER as f64;
        if self.kind != AxisKind::Continuous && lower.abs().max(upper.abs()) >= largest {
            return bad("integers have to be below 2^53 in f64 and 2^24 in f32, where they are exact");
        }
        Ok(())
    }
}

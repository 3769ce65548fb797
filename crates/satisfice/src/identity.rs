//! Identity: when two solutions are the same answer.

mod cells;
mod separation;
#[cfg(test)]
mod tests;

use core::hash::{BuildHasher, Hash, Hasher};

use foldhash::fast::FixedState;

use crate::scalar::{Real, copy_row};
use crate::space::Region;

use cells::{cells_near, next_cell, own_cell};
pub use separation::{AxisSeparation, Separation};

/// The seed of every key; fixed, so that a run is the same on every machine.
const KEYS: FixedState = FixedState::with_seed(0x5a71_5f1c_e000_2012);

/// Defines whether two solutions count as one answer, and gives the keys under which an archive finds them.
///
/// It is implemented for every type that is `Eq + Hash` (a pair of indices, a vector of integers): there, *same* is *equal*.
/// For real coordinates use [`Located`], which is the same as another one within a radius.
///
/// Law: if `a.same(&b)`, then `a.key()` is among the keys that `b.visit_keys` visits, and vice versa.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not define when two solutions are the same answer",
    label = "`Identity` is not implemented for `{Self}`",
    note = "types that are `Eq + Hash`, such as `[u32; 2]` or `Vec<u32>`, implement it: there, same is equal",
    note = "for real coordinates, such as `Vec<f64>`, use `satisfice::Located`: points within a radius are the same"
)]
pub trait Identity {
    /// The hash under which the solution is filed.
    fn key(&self) -> u64;
    /// Whether both are the same answer. It must be symmetric.
    fn same(&self, other: &Self) -> bool;
    /// Whether one stands for the other: whether both are the same as the very same solutions. Equal ones do. `false`, the default,
    /// where that is not known: several [islands](crate::Search::islands) then prove less.
    #[inline]
    fn stands_for(&self, _other: &Self) -> bool {
        false
    }
    /// Visits the keys under which a solution that is the same may be filed, until `visit` returns `true`; returns
    /// whether it did.
    #[inline]
    fn visit_keys(&self, visit: &mut impl FnMut(u64) -> bool) -> bool {
        visit(self.key())
    }
    /// For an archive where one key has come to stand for many: visits coordinates, each with a radius, and returns whether they tell
    /// more apart than keys do. Solutions that are the same have the same radii, and coordinates at most one apart: the Euclidean
    /// distance, in radii. Where a radius is zero they are equal. The default has no coordinates.
    #[inline]
    fn visit_place(&self, _visit: &mut impl FnMut(f64, f64)) -> bool {
        false
    }
}

// Without this the compiler asks for `f64: Eq`, where `Located` is the answer.
#[diagnostic::do_not_recommend]
impl<T: Eq + Hash> Identity for T {
    #[inline]
    fn key(&self) -> u64 {
        KEYS.hash_one(self)
    }
    #[inline]
    fn same(&self, other: &Self) -> bool {
        self == other
    }
    #[inline]
    fn stands_for(&self, other: &Self) -> bool {
        self == other
    }
}

/// A point that counts once per separation, which a problem gives all its solutions alike.
///
/// Two are the same if they are near enough by [`Separation`]: by their Euclidean distance, or axis by axis.
///
/// ```
/// use satisfice::{Identity, Located};
/// let a = Located::new(&[1.0, 2.0], 0.5); // counts once within a radius of 0.5
/// assert!(a.same(&Located::new(&[1.3, 2.4], 0.5)));
/// assert!(!a.same(&Located::new(&[1.4, 2.4], 0.5)));
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(bound(serialize = "S: Real", deserialize = "S: Real"))]
pub struct Located<S> {
    /// Coordinates, in the units of the space.
    pub coordinates: Vec<S>,
    /// The separation within which another one counts as the same.
    pub separation: Separation<S>,
}

/// At most this many coordinates with a radius are hashed, by cells; the true distance decides, so more would only cost more
/// look-ups. Exact coordinates are all hashed.
const HASHED: usize = 3;

/// Two points are not the same where one coordinate alone differs by so many radii: by more than rounding could hide.
const FAR: f64 = 1.01;

impl<S: Real> Located<S> {
    /// A solution at these coordinates; a number is a separation radius, >= 0.
    #[must_use]
    pub fn new(coordinates: &[S], separation: impl Into<Separation<S>>) -> Self {
        Self {
            coordinates: coordinates.to_vec(),
            separation: separation.into(),
        }
    }

    /// Becomes the solution at other coordinates, in the same memory.
    #[inline]
    pub fn set(&mut self, coordinates: &[S], separation: &Separation<S>) {
        if self.coordinates.len() == coordinates.len() {
            copy_row(&mut self.coordinates, coordinates);
        } else {
            self.coordinates.clear();
            self.coordinates.extend_from_slice(coordinates);
        }
        self.separation.set(separation);
    }

    /// Whether all points of `region` are the same as this one: whether its farthest corner is; on axes that are periodic or
    /// logarithmic, whether even a point that is farther than that by rounding would be.
    ///
    /// That decides for all of them, rounding included: differences, quotients, squares and sums are monotone in every
    /// coordinate on either side of this point, and rounding keeps the order.
    #[must_use]
    pub fn covers(&self, region: &Region<S>) -> bool {
        if region.lower.len() != self.coordinates.len() {
            return false;
        }
        let ends = region.lower.iter().zip(&region.upper);
        let sides = self.coordinates.iter().zip(ends);
        let square = match &self.separation {
            Separation::Radius(_) => {
                let farther = |(&x, (&lower, &upper)): (&S, (&S, &S))| {
                    let is_lower = (x - lower).abs() > (x - upper).abs();
                    if is_lower { lower } else { upper }
                };
                return self.is_within(sides.map(farther));
            }
            Separation::Axes(axes) => {
                let pairs = sides.zip(axes.iter());
                pairs.fold(S::zero(), |sum, ((&x, (&lower, &upper)), axis)| {
                    sum + axis.farthest_square(x, lower, upper)
                })
            }
        };
        square <= S::one()
    }

    #[inline]
    fn is_within(&self, other: impl Iterator<Item = S>) -> bool {
        let mut pairs = self.coordinates.iter().zip(other);
        let square = match &self.separation {
            Separation::Radius(radius) if *radius == S::zero() => return pairs.all(|(&a, b)| a == b),
            Separation::Radius(radius) => {
                let (far, mut sum) = (S::of(FAR) * *radius, S::zero());
                for (&a, b) in pairs {
                    let d = a - b;
                    if d.abs() > far {
                        return false;
                    }
                    // Divided before it is squared: the square of a small or of a large radius is no number of use.
                    let d = d / *radius;
                    sum = sum + d * d;
                }
                sum
            }
            Separation::Axes(axes) => squares(pairs, axes),
        };
        square <= S::one()
    }

    /// Whether every coordinate is exact.
    #[inline]
    fn is_exact(&self) -> bool {
        matches!(&self.separation, Separation::Radius(radius) if *radius == S::zero())
    }

    /// A hash of the exact coordinates; 0 if there are none.
    #[inline]
    fn exact_key(&self) -> u64 {
        let mut hasher = KEYS.build_hasher();
        match &self.separation {
            Separation::Radius(radius) if *radius == S::zero() => {
                for &x in &self.coordinates {
                    hasher.write_u64((x + S::zero()).to_word()); // -0.0 and 0.0 are one
                }
            }
            Separation::Radius(_) => return 0,
            Separation::Axes(axes) => {
                let mut has_exact = false;
                for (&x, axis) in self.coordinates.iter().zip(axes.iter()) {
                    if axis.is_hashed_exactly() {
                        has_exact = true;
                        hasher.write_u64((x + S::zero()).to_word());
                    }
                }
                if !has_exact {
                    return 0;
                }
            }
        }
        hasher.finish()
    }

    /// Visits the first coordinates with a radius, at most so many: index, coordinate and radius.
    #[inline]
    fn visit_blurred(&self, most: usize, mut visit: impl FnMut(usize, S, S)) {
        match &self.separation {
            Separation::Radius(radius) => {
                let first = self.coordinates.iter().take(most).enumerate();
                first.for_each(|(j, &x)| visit(j, x, *radius));
            }
            Separation::Axes(axes) => {
                let all = self.coordinates.iter().zip(axes.iter());
                let blurred = all.filter_map(|(&x, axis)| axis.in_cells(x));
                let first = blurred.take(most).enumerate();
                first.for_each(|(j, (x, radius))| visit(j, x, radius));
            }
        }
    }

    /// Their cells.
    #[inline]
    fn own_cells(&self) -> [S; HASHED] {
        let mut cells = [S::zero(); HASHED];
        self.visit_blurred(HASHED, |j, x, radius| cells[j] = own_cell(x, radius));
        cells
    }
}

/// The squared distance, axis by axis in units of the axes' radii. Apart from [`Located::is_within`], so that this is inlined where
/// all axes have one radius.
#[inline(never)]
fn squares<'a, S: Real>(pairs: impl Iterator<Item = (&'a S, S)>, axes: &[AxisSeparation<S>]) -> S {
    pairs
        .zip(axes)
        .fold(S::zero(), |sum, ((&a, b), axis)| sum + axis.square(a, b))
}

/// One word after the other: hashing them as an array costs three times as much.
#[inline]
fn hash_cells<S: Real>(exact: u64, cells: [S; HASHED]) -> u64 {
    let mut hasher = KEYS.build_hasher();
    if exact != 0 {
        hasher.write_u64(exact);
    }
    for cell in cells {
        hasher.write_u64(cell.to_word());
    }
    hasher.finish()
}

impl<S: Real> Identity for Located<S> {
    fn key(&self) -> u64 {
        let exact = self.exact_key();
        if self.is_exact() {
            exact
        } else {
            hash_cells(exact, self.own_cells())
        }
    }

    #[inline]
    fn same(&self, other: &Self) -> bool {
        self.is_within(other.coordinates.iter().copied())
    }

    #[inline]
    fn stands_for(&self, other: &Self) -> bool {
        self == other
    }

    fn visit_keys(&self, visit: &mut impl FnMut(u64) -> bool) -> bool {
        let exact = self.exact_key();
        if self.is_exact() {
            return visit(exact);
        }
        // For each coordinate its own cell, and the first and the last one that a solution within the radius may be in.
        let mut near = [[S::zero(); 3]; HASHED];
        self.visit_blurred(HASHED, |j, x, radius| near[j] = cells_near(x, radius));
        let own = near.map(|[own, _, _]| own);
        let ends = near.map(|[_, first, last]| [first, last]);
        let mut cells = ends.map(|[first, _]| first);
        // Its own first: what is the same is most often filed there.
        if visit(hash_cells(exact, own)) {
            return true;
        }
        loop {
            if cells != own && visit(hash_cells(exact, cells)) {
                return true;
            }
            // The next combination, the first axis fastest.
            let Some(axis) = (0..HASHED).find(|&axis| cells[axis] < ends[axis][1]) else {
                return false;
            };
            cells[axis] = next_cell(cells[axis]).min(ends[axis][1]);
            for earlier in 0..axis {
                cells[earlier] = ends[earlier][0];
            }
        }
    }

    fn visit_place(&self, visit: &mut impl FnMut(f64, f64)) -> bool {
        let (mut by_cells, mut around) = (0, 0);
        match &self.separation {
            Separation::Radius(radius) => {
                by_cells = usize::from(*radius > S::zero()) * self.coordinates.len();
                for x in &self.coordinates {
                    visit(x.f64(), radius.f64());
                }
            }
            Separation::Axes(axes) => {
                for (&x, axis) in self.coordinates.iter().zip(axes.iter()) {
                    if axis.is_hashed_exactly() {
                        visit(axis.measured(x).f64(), axis.radius().f64());
                    } else if let Some((x, radius)) = axis.in_cells(x) {
                        by_cells += 1;
                        visit(x.f64(), radius.f64());
                    } else if let Some(ends) = axis.on_circle(x) {
                        around += 1;
                        for end in ends {
                            visit(end, axis.radius().f64());
                        }
                    }
                }
            }
        }
        around > 0 || by_cells > HASHED
    }
}

//! Vertex orders: which position a vertex has on an axis of a search space.
//!
//! A search over positions profits from an order in which neighbouring positions are neighbouring points.

mod hilbert;
mod morton;

use std::fmt;
use std::str::FromStr;

pub use hilbert::hilbert_key;
pub use morton::morton_key;

use crate::error::Error;
use crate::mesh::Aabb;
use crate::sampling;

/// Bits per axis of the grid of the space-filling curves: three times 21 fit a `u64`.
pub const BITS: u32 = 21;

/// An order of the vertices of a body.
///
/// ```
/// use satisfice_collision::VertexOrder;
/// let points = [[0.0, 0.0, 0.0], [9.0, 9.0, 9.0], [1.0, 0.0, 0.0]];
/// assert_eq!(VertexOrder::Hilbert.permutation(&points), [0, 2, 1]);
/// assert_eq!("random".parse::<VertexOrder>()?, VertexOrder::Random { seed: 0 });
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum VertexOrder {
    /// The order of the file.
    File,
    /// A random order.
    Random {
        /// Seed of the shuffle.
        seed: u64,
    },
    /// Along the Morton (Z) curve.
    Morton,
    /// Along the Hilbert curve.
    #[default]
    Hilbert,
}

impl VertexOrder {
    /// The names in the order of the variants, as [`VertexOrder::from_str`] reads them.
    pub const NAMES: [&'static str; 4] = ["file", "random", "morton", "hilbert"];

    /// The permutation: item `k` of the result is the number of the point at position `k`.
    ///
    /// The curves run through a grid of 2^21 cells per axis that fills the bounding box. Points in one cell keep their
    /// order. The points must be finite, as those of a [`crate::Mesh`] are. Cost: O(n log n).
    #[must_use]
    pub fn permutation(&self, points: &[[f64; 3]]) -> Vec<u32> {
        match *self {
            Self::File => (0..points.len() as u32).collect(),
            Self::Random { seed } => sampling::permutation(points.len() as u32, seed),
            Self::Morton => by_key(points, |cell| morton_key(cell, BITS)),
            Self::Hilbert => by_key(points, |cell| hilbert_key(cell, BITS)),
        }
    }

    /// The same order with another seed, if it has one.
    #[must_use]
    pub fn with_seed(self, seed: u64) -> Self {
        match self {
            Self::Random { .. } => Self::Random { seed },
            other => other,
        }
    }

    /// The name without the seed.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::File => "file",
            Self::Random { .. } => "random",
            Self::Morton => "morton",
            Self::Hilbert => "hilbert",
        }
    }
}

impl fmt::Display for VertexOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for VertexOrder {
    type Err = Error;

    /// Reads a name; `random` gets seed 0 (see [`VertexOrder::with_seed`]).
    fn from_str(name: &str) -> Result<Self, Error> {
        match name {
            "file" => Ok(Self::File),
            "random" => Ok(Self::Random { seed: 0 }),
            "morton" => Ok(Self::Morton),
            "hilbert" => Ok(Self::Hilbert),
            _ => Err(Error::parameter("order", name, "file, random, morton or hilbert")),
        }
    }
}

fn by_key(points: &[[f64; 3]], key: impl Fn([u32; 3]) -> u64) -> Vec<u32> {
    let Some(bounds) = Aabb::of_points(points.iter().copied()) else {
        return Vec::new();
    };
    let mut keyed: Vec<(u64, u32)> = points
        .iter()
        .enumerate()
        .map(|(i, &p)| (key(cell(p, &bounds)), i as u32))
        .collect();
    keyed.sort_unstable();
    keyed.into_iter().map(|(_, i)| i).collect()
}

/// The cell of a point. The grid fills the box on each axis, but stretches no axis more than fourfold compared with the
/// longest one: otherwise noise would determine the order of a nearly flat body.
fn cell(point: [f64; 3], bounds: &Aabb) -> [u32; 3] {
    const STRETCH: f64 = 4.0;
    let last = (1_u32 << BITS) - 1;
    // Halved, because the extent of finite coordinates may overflow.
    let half: [f64; 3] = std::array::from_fn(|k| bounds.max[k] / 2.0 - bounds.min[k] / 2.0);
    let least = half.iter().fold(0.0_f64, |m, &h| m.max(h)) / STRETCH;
    std::array::from_fn(|k| {
        let share = (point[k] / 2.0 - bounds.min[k] / 2.0) / half[k].max(least);
        // A body of no extent gives NaN, which `as` converts to 0; `as` also saturates.
        ((share * f64::from(1_u32 << BITS)) as u32).min(last)
    })
}

#[cfg(test)]
mod tests;

//! Vertex orders: which serial number a vertex gets in a search space.
//!
//! A search over serial numbers profits from an order in which near numbers are near points.

mod hilbert;
mod morton;

use std::fmt;
use std::str::FromStr;

pub use hilbert::hilbert_key;
pub use morton::morton_key;

use crate::error::Error;
use crate::mesh::Aabb;
use crate::sampling;

/// Bits an axis of the grid on which the space-filling curves run: three times 21 fit a `u64`.
pub const BITS: u32 = 21;

/// An order of the vertices of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum VertexOrder {
    /// As in the file.
    File,
    /// Shuffled.
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

    /// The permutation: item k of the answer is the number of the point at position k.
    ///
    /// The curves run over a grid of 2^21 cells an axis that fills the bounding box; points in one cell keep their
    /// order. Meant for finite points (a [`crate::Mesh`] has no others). O(n log n).
    #[must_use]
    pub fn permutation(&self, points: &[[f64; 3]]) -> Vec<u32> {
        match *self {
            Self::File => (0..points.len() as u32).collect(),
            Self::Random { seed } => sampling::permutation(points.len() as u32, seed),
            Self::Morton => by_key(points, |cell| morton_key(cell, BITS)),
            Self::Hilbert => by_key(points, |cell| hilbert_key(cell, BITS)),
        }
    }

    /// With another seed, where the order has one.
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

/// The cell of a point. The grid fills the box, axis by axis, but stretches no axis more than fourfold against the longest
/// one: a nearly flat body would otherwise be ordered by its noise.
///
/// Filling the box was measured against cubic cells on two teapots (4 samples, 16 seeds each, 1M evaluations): a
/// latest-hit swarm that never meets a hit was seen 5 times in 64 against 21.
fn cell(point: [f64; 3], bounds: &Aabb) -> [u32; 3] {
    const STRETCH: f64 = 4.0;
    let last = (1_u32 << BITS) - 1;
    // Halved, because the extent of finite coordinates may be infinite.
    let half: [f64; 3] = std::array::from_fn(|k| bounds.max[k] / 2.0 - bounds.min[k] / 2.0);
    let least = half.iter().fold(0.0_f64, |m, &h| m.max(h)) / STRETCH;
    std::array::from_fn(|k| {
        let share = (point[k] / 2.0 - bounds.min[k] / 2.0) / half[k].max(least);
        // A body of no extent gives NaN, which `as` takes to 0; `as` saturates, too.
        ((share * f64::from(1_u32 << BITS)) as u32).min(last)
    })
}

#[cfg(test)]
mod tests;

//! Seeded samples of a body: vertices uniformly or by area, points of the surface by area.
//!
//! The generator is Xoshiro256++. The draws are implemented here without transcendental functions, so that a seed gives the
//! same sample on every platform and with every version of the libraries.

mod surface;
mod weights;

use rand::Rng;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

pub use surface::{SurfacePoint, surface_points, vertex_areas, vertices_by_area};

use crate::error::Error;

/// Draws `count` of the numbers `0..population` uniformly without replacement and returns them sorted.
///
/// # Errors
/// [`Error::Parameter`] if `count` exceeds `population`.
///
/// Cost: O(population).
///
/// ```
/// use satisfice_collision::sampling::uniform_vertices;
/// let sample = uniform_vertices(1000, 10, 42)?;
/// assert_eq!(sample.len(), 10);
/// assert_eq!(sample, uniform_vertices(1000, 10, 42)?);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
pub fn uniform_vertices(population: u32, count: u32, seed: u64) -> Result<Vec<u32>, Error> {
    if count > population {
        return Err(Error::parameter(
            "sample size",
            count,
            "at most the number of vertices",
        ));
    }
    let mut numbers: Vec<u32> = (0..population).collect();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    shuffle_front(&mut numbers, count as usize, &mut rng);
    numbers.truncate(count as usize);
    numbers.sort_unstable();
    Ok(numbers)
}

/// A random permutation of `0..n`.
pub(crate) fn permutation(n: u32, seed: u64) -> Vec<u32> {
    let mut numbers: Vec<u32> = (0..n).collect();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    shuffle_front(&mut numbers, n as usize, &mut rng);
    numbers
}

/// The first `front` steps of the Fisher-Yates shuffle. They give a uniform sample in random order.
fn shuffle_front(numbers: &mut [u32], front: usize, rng: &mut impl Rng) {
    for k in 0..front {
        let rest = (numbers.len() - k) as u64;
        let other = k + below(rest, rng) as usize;
        numbers.swap(k, other);
    }
}

/// A uniform draw from `0..n` for `n > 0`, without bias: the high half of a product, redrawn in the rare short interval
/// (Lemire 2019, doi 10.1145/3230636).
fn below(n: u64, rng: &mut impl Rng) -> u64 {
    let band = n.wrapping_neg() % n;
    loop {
        let product = u128::from(rng.next_u64()) * u128::from(n);
        if product as u64 >= band {
            return (product >> 64) as u64;
        }
    }
}

/// A uniform draw from [0, 1) in steps of 2^-53.
fn unit(rng: &mut impl Rng) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests;

//! Samples in proportion to the area of the triangles.

use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::unit;
use super::weights::WeightTree;
use crate::error::Error;
use crate::mesh::Mesh;

/// A point on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// The triangle it lies on.
    pub triangle: u32,
    /// Its barycentric coordinates: not negative, with a sum of 1 within rounding.
    pub barycentric: [f64; 3],
    /// Its position, in the unit of the mesh.
    pub position: [f64; 3],
}

/// Draws `count` points uniformly by area from the triangles of `mesh`, independently.
///
/// # Errors
/// [`Error::Parameter`] if the mesh has no triangle of positive area.
///
/// Cost: O(T + count log T). The square-root map from the unit square to the triangle: Osada et al. 2002,
/// doi 10.1145/571647.571648.
pub fn surface_points(mesh: &Mesh, count: usize, seed: u64) -> Result<Vec<SurfacePoint>, Error> {
    let tree = WeightTree::new(&relative_areas(mesh));
    if tree.total() <= 0.0 {
        return Err(Error::parameter(
            "surface area",
            0,
            "at least one triangle of positive area",
        ));
    }
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    Ok((0..count)
        .map(|_| {
            let triangle = tree.draw(&mut rng);
            let root = unit(&mut rng).sqrt();
            let v = unit(&mut rng);
            let barycentric = [1.0 - root, root * (1.0 - v), root * v];
            let [a, b, c] = mesh.triangle(triangle);
            let [p, q, r] = barycentric;
            let position = std::array::from_fn(|k| p * a[k] + q * b[k] + r * c[k]);
            SurfacePoint {
                triangle: triangle as u32,
                barycentric,
                position,
            }
        })
        .collect())
}

/// Draws `count` vertices without replacement, each with a probability in proportion to its share of the area
/// ([`vertex_areas`]), and returns them sorted.
///
/// # Errors
/// [`Error::Parameter`] if fewer than `count` vertices have a positive share.
///
/// Cost: O(V + T + count log V).
pub fn vertices_by_area(mesh: &Mesh, count: u32, seed: u64) -> Result<Vec<u32>, Error> {
    let shares = vertex_areas(mesh);
    let drawable = shares.iter().filter(|&&share| share > 0.0).count();
    if count as usize > drawable {
        return Err(Error::parameter(
            "sample size",
            count,
            "at most the number of vertices with a positive share of the area",
        ));
    }
    let mut tree = WeightTree::new(&shares);
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut sample: Vec<u32> = (0..count)
        .map(|_| {
            let v = tree.draw(&mut rng);
            tree.remove(v);
            v as u32
        })
        .collect();
    sample.sort_unstable();
    Ok(sample)
}

/// A third of the area of the triangles around each vertex. The unit of length is the next power of two above the largest
/// coordinate, so that no product overflows.
#[must_use]
pub fn vertex_areas(mesh: &Mesh) -> Vec<f64> {
    let mut shares = vec![0.0; mesh.vertices().len()];
    for (corners, area) in mesh.triangles().iter().zip(relative_areas(mesh)) {
        for &v in corners {
            shares[v as usize] += area / 3.0;
        }
    }
    shares
}

/// The areas of the triangles. The unit of length is a power of two near the largest difference of coordinates.
fn relative_areas(mesh: &Mesh) -> Vec<f64> {
    let greatest = mesh
        .vertices()
        .iter()
        .flatten()
        .fold(0.0_f64, |m, c| m.max(c.abs()));
    let scale = power_of_two_below_inverse(greatest);
    (0..mesh.triangles().len())
        .map(|t| {
            // Two factors stay normal numbers even for coordinates near the ends of the range.
            let [a, b, c] = mesh.triangle(t).map(|p| p.map(|x| x * scale[0] * scale[1]));
            let u: [f64; 3] = std::array::from_fn(|k| b[k] - a[k]);
            let v: [f64; 3] = std::array::from_fn(|k| c[k] - a[k]);
            let cross = [
                u[1] * v[2] - u[2] * v[1],
                u[2] * v[0] - u[0] * v[2],
                u[0] * v[1] - u[1] * v[0],
            ];
            0.5 * (cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]).sqrt()
        })
        .collect()
}

/// Two powers of two whose product scales `greatest` into [1/2, 1); ones for zero.
fn power_of_two_below_inverse(greatest: f64) -> [f64; 2] {
    let mut scale = [1.0, 1.0];
    if greatest > 0.0 {
        while greatest * scale[0] * scale[1] >= 1.0 {
            let k = usize::from(scale[0] < 1e-300);
            scale[k] *= 0.5;
        }
        while greatest * scale[0] * scale[1] < 0.5 {
            let k = usize::from(scale[0] > 1e300);
            scale[k] *= 2.0;
        }
    }
    scale
}

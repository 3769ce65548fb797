//! Generated bodies: the Utah teapot, spheres, a torus, a cloth and a pleated cloth.

mod cloth;
mod pleats;
mod sphere;
mod teapot;
mod teapot_net;
mod torus;

pub use cloth::cloth;
pub use pleats::pleats;
pub use sphere::{icosphere, uv_sphere};
pub use teapot::teapot;
pub use torus::torus;

use crate::error::Error;

/// The most vertices of a generated body. A larger number is taken for a typing error.
pub const MAX_VERTICES: usize = 1 << 24;

fn checked_length(parameter: &'static str, value: f64) -> Result<f64, Error> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(Error::parameter(parameter, value, "a finite length above 0"))
    }
}

fn checked_count(
    parameter: &'static str,
    value: usize,
    least: usize,
    allowed: &'static str,
) -> Result<usize, Error> {
    if value < least {
        Err(Error::parameter(parameter, value, allowed))
    } else {
        Ok(value)
    }
}

/// Returns `a * b + c` if a body may have so many vertices.
fn checked_vertices(a: usize, b: usize, c: usize) -> Result<usize, Error> {
    a.checked_mul(b)
        .and_then(|n| n.checked_add(c))
        .filter(|&n| n <= MAX_VERTICES)
        .ok_or_else(|| Error::parameter("number of vertices", format!("{a} x {b} + {c}"), "at most 2^24"))
}

/// A vertex number. It fits because [`checked_vertices`] limits the count.
fn number(i: usize) -> u32 {
    i as u32
}

#[cfg(test)]
mod tests;

//! Generated bodies: the Utah teapot, spheres, the torus, a cloth and a pleated one.

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

/// More vertices than this are taken for a slip of the keyboard.
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

/// `a * b + c` vertices, if they are not too many.
fn checked_vertices(a: usize, b: usize, c: usize) -> Result<usize, Error> {
    a.checked_mul(b)
        .and_then(|n| n.checked_add(c))
        .filter(|&n| n <= MAX_VERTICES)
        .ok_or_else(|| Error::parameter("number of vertices", format!("{a} x {b} + {c}"), "at most 2^24"))
}

/// A vertex number; [`checked_vertices`] has made sure that it fits.
fn number(i: usize) -> u32 {
    i as u32
}

#[cfg(test)]
mod tests;

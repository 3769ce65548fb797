//! Meshes, close pairs, worlds and moving meshes. What users see is `python/satisfice/collision.py`.

mod guard;
mod mesh;
mod pairs;
mod step;
mod world;

pub(crate) use mesh::Mesh;
pub(crate) use pairs::close_pairs;
pub(crate) use step::Step;
pub(crate) use world::{Body, World};

use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use satisfice_collision::Placement;
use satisfice_collision::distance::{PairKind, Threshold};

use crate::refused;

/// A placement: a quaternion (w, x, y, z) and a translation.
pub(crate) type Pose = ([f64; 4], [f64; 3]);

fn placement(pose: Option<Pose>) -> PyResult<Placement> {
    match pose {
        None => Ok(Placement::IDENTITY),
        Some((quaternion, translation)) => Placement::from_quaternion(quaternion)
            .and_then(|placement| placement.moved(translation))
            .map_err(refused),
    }
}

fn kind(name: &str) -> PyResult<PairKind> {
    name.parse().map_err(refused)
}

fn threshold(delta: f64) -> PyResult<Threshold> {
    Threshold::new(delta).map_err(refused)
}

/// Rows of three numbers as an array of shape (n, 3).
fn rows<T: numpy::Element, const N: usize>(py: Python<'_>, rows: Vec<[T; N]>) -> PyResult<Py<PyArray2<T>>> {
    let count = rows.len();
    Ok(rows
        .into_flattened()
        .into_pyarray(py)
        .reshape([count, N])?
        .unbind())
}

/// An array of shape (n, 3) as points.
fn points(array: &numpy::PyReadonlyArray2<'_, f64>) -> PyResult<Vec<[f64; 3]>> {
    let (chunks, _) = array.as_slice()?.as_chunks::<3>();
    Ok(chunks.to_vec())
}

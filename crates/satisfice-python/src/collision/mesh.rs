//! Meshes from arrays.

use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyType;
use satisfice_collision::Mesh as Inner;
use satisfice_collision::scene::SharedMesh;

use super::{points, rows};
use crate::refused;

/// A checked mesh and the trees over its features, which are built when a query first needs them.
#[pyclass(frozen, module = "satisfice.collision")]
pub(crate) struct Mesh(pub(super) SharedMesh);

/// Vertices, faces, and edges that are not sides of faces.
type Arrays = (Py<PyArray2<f64>>, Py<PyArray2<i64>>, Py<PyArray2<i64>>);

/// An index of an array as that of a vertex; the mesh checks the upper end.
fn vertex(index: i64, row: usize, vertices: usize) -> PyResult<u32> {
    u32::try_from(index).map_err(|_| {
        PyValueError::new_err(format!(
            "face or edge {row} names vertex {index}; the vertices are 0 to {}",
            vertices.saturating_sub(1)
        ))
    })
}

fn elements<const N: usize>(
    array: Option<&PyReadonlyArray2<'_, i64>>,
    vertices: usize,
) -> PyResult<Vec<[u32; N]>> {
    let Some(array) = array else {
        return Ok(Vec::new());
    };
    let (rows, _) = array.as_slice()?.as_chunks::<N>();
    let mut elements = Vec::with_capacity(rows.len());
    for (number, row) in rows.iter().enumerate() {
        let mut element = [0; N];
        for (to, &index) in element.iter_mut().zip(row) {
            *to = vertex(index, number, vertices)?;
        }
        elements.push(element);
    }
    Ok(elements)
}

#[pymethods]
impl Mesh {
    #[new]
    #[pyo3(signature = (vertices, faces=None, edges=None))]
    fn new(
        vertices: PyReadonlyArray2<'_, f64>,
        faces: Option<PyReadonlyArray2<'_, i64>>,
        edges: Option<PyReadonlyArray2<'_, i64>>,
    ) -> PyResult<Self> {
        let vertices = points(&vertices)?;
        let count = vertices.len();
        let mesh = Inner::new(
            vertices,
            elements(edges.as_ref(), count)?,
            elements(faces.as_ref(), count)?,
        );
        Ok(Self(mesh.map_err(refused)?.into()))
    }

    /// Positions of the vertices.
    #[getter]
    fn vertices(&self, py: Python<'_>) -> PyResult<Py<PyArray2<f64>>> {
        rows(py, self.0.mesh().vertices().to_vec())
    }

    /// The triangles by their vertices.
    #[getter]
    fn faces(&self, py: Python<'_>) -> PyResult<Py<PyArray2<u32>>> {
        rows(py, self.0.mesh().triangles().to_vec())
    }

    /// So that it can be sent to another process; the trees are built again there.
    fn __reduce__(slf: &Bound<'_, Self>) -> PyResult<(Py<PyType>, Arrays)> {
        let (py, mesh) = (slf.py(), slf.get().0.mesh());
        let arrays = (
            rows(py, mesh.vertices().to_vec())?,
            rows(py, mesh.triangles().iter().map(|t| t.map(i64::from)).collect())?,
            rows(py, mesh.lines().iter().map(|l| l.map(i64::from)).collect())?,
        );
        Ok((slf.get_type().unbind(), arrays))
    }

    fn __repr__(&self) -> String {
        let mesh = self.0.mesh();
        format!(
            "<satisfice.collision.Mesh of {} vertices and {} triangles>",
            mesh.vertices().len(),
            mesh.triangles().len()
        )
    }
}

//! Meshes that move during a step.

use std::sync::{Mutex, MutexGuard, PoisonError};

use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use satisfice_collision::continuous::{self, FeatureOf, Impact, Moving, MovingContact, Separation};
use satisfice_collision::distance::PairKind;
use satisfice_collision::scene::SharedMesh;
use satisfice_collision::{Error, FeatureKind};

use super::guard::{Guard, pool_of};
use super::{Mesh, kind, points, rows};
use crate::refused;

/// The bodies of a step.
#[derive(Default)]
struct Bodies {
    step: continuous::Step,
    meshes: Vec<(SharedMesh, [Vec<[f64; 3]>; 2])>,
}

/// Meshes at both ends of a step.
#[pyclass(frozen, module = "satisfice.collision")]
pub(crate) struct Step(Mutex<Bodies>);

/// Columns of impacts: bodies and features, bounds of the times, closest points, normals, whether these are all.
type Columns = (
    [Py<PyArray1<u32>>; 4],
    [Py<PyArray1<f64>>; 2],
    [Py<PyArray2<f64>>; 3],
    bool,
);

impl Bodies {
    fn corner(&self, body: u32, vertex: u32) -> ([f64; 3], [f64; 3]) {
        let [from, to] = &self.meshes[body as usize].1;
        (from[vertex as usize], to[vertex as usize])
    }

    fn vertex(&self, of: FeatureOf) -> Moving<[f64; 3]> {
        let (from, to) = self.corner(of.body, of.index);
        Moving::new(from, to)
    }

    fn edge(&self, of: FeatureOf) -> Moving<[[f64; 3]; 2]> {
        let mesh = self.meshes[of.body as usize].0.mesh();
        let [a, b, _] = mesh.features(FeatureKind::Edge).corners(of.index);
        let ends = [a, b].map(|vertex| self.corner(of.body, vertex));
        Moving::new(ends.map(|end| end.0), ends.map(|end| end.1))
    }

    fn triangle(&self, of: FeatureOf) -> Moving<[[f64; 3]; 3]> {
        let mesh = self.meshes[of.body as usize].0.mesh();
        let corners = mesh.features(FeatureKind::Triangle).corners(of.index);
        let corners = corners.map(|vertex| self.corner(of.body, vertex));
        Moving::new(corners.map(|corner| corner.0), corners.map(|corner| corner.1))
    }

    fn impact(
        &self,
        kind: PairKind,
        contact: MovingContact,
        separation: Separation,
        tolerance: f64,
    ) -> Result<Option<Impact>, Error> {
        let MovingContact { a, b } = contact;
        match kind {
            PairKind::VertexVertex => {
                continuous::impact(&self.vertex(a), &self.vertex(b), separation, tolerance)
            }
            PairKind::VertexEdge => continuous::impact(&self.vertex(a), &self.edge(b), separation, tolerance),
            PairKind::EdgeEdge => continuous::impact(&self.edge(a), &self.edge(b), separation, tolerance),
            // `Step::hits` has refused the others.
            _ => continuous::impact(&self.vertex(a), &self.triangle(b), separation, tolerance),
        }
    }
}

impl Step {
    fn lock(&self) -> MutexGuard<'_, Bodies> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Step {
    #[new]
    fn new() -> Self {
        Self(Mutex::default())
    }

    fn add(
        &self,
        py: Python<'_>,
        mesh: &Bound<'_, Mesh>,
        to: PyReadonlyArray2<'_, f64>,
        self_collision: bool,
    ) -> PyResult<usize> {
        let (mesh, to) = (mesh.get().0.clone(), points(&to)?);
        py.detach(|| {
            let mut bodies = self.lock();
            let number = if self_collision {
                bodies.step.add_deforming(mesh.mesh(), &to)?
            } else {
                bodies.step.add_rigid(mesh.mesh(), &to)?
            };
            let from = mesh.mesh().vertices().to_vec();
            bodies.meshes.push((mesh, [from, to]));
            Ok(number)
        })
        .map_err(|error: Error| refused(error))
    }

    fn set_motion(
        &self,
        py: Python<'_>,
        body: usize,
        start: PyReadonlyArray2<'_, f64>,
        end: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<()> {
        let ends = [points(&start)?, points(&end)?];
        py.detach(|| {
            let mut bodies = self.lock();
            bodies.step.set_motion(body, &ends[0], &ends[1])?;
            bodies.meshes[body].1 = ends;
            Ok(())
        })
        .map_err(|error: Error| refused(error))
    }

    fn impacts(
        &self,
        py: Python<'_>,
        pairs: &str,
        delta: f64,
        tolerance: f64,
        time: Option<f64>,
        threads: usize,
    ) -> PyResult<Columns> {
        let kind = kind(pairs)?;
        let separation = Separation::new(delta).map_err(refused)?;
        let guard = Guard::new(time, None)?;
        // A step works on all threads of the pool that it finds itself in.
        let pool = pool_of(threads)?;
        let (found, complete) = guard.run(py, Some(&pool), || {
            let bodies = self.lock();
            let hits = bodies.step.hits_until(kind, separation, &mut || guard.stops(0))?;
            let mut found = Vec::with_capacity(hits.pairs.len());
            let mut complete = hits.undecided == 0;
            let until = guard.measuring_until();
            for pair in hits.pairs {
                if guard.stops_at(until) {
                    complete = false;
                    break;
                }
                if let Some(impact) = bodies.impact(kind, pair, separation, tolerance)? {
                    found.push((pair, impact));
                }
            }
            Ok((found, complete))
        })?;
        let numbers: [fn(&MovingContact) -> u32; 4] = [
            |pair| pair.a.body,
            |pair| pair.b.body,
            |pair| pair.a.index,
            |pair| pair.b.index,
        ];
        let numbers = numbers.map(|of| {
            let column: Vec<u32> = found.iter().map(|(pair, _)| of(pair)).collect();
            column.into_pyarray(py).unbind()
        });
        let times = [0, 1].map(|end| {
            let column: Vec<f64> = found.iter().map(|(_, impact)| impact.time[end]).collect();
            column.into_pyarray(py).unbind()
        });
        let vectors: [fn(&Impact) -> [f64; 3]; 3] = [
            |impact| impact.point_a,
            |impact| impact.point_b,
            |impact| impact.normal,
        ];
        let [a, b, normal] = vectors.map(|of| rows(py, found.iter().map(|(_, impact)| of(impact)).collect()));
        Ok((numbers, times, [a?, b?, normal?], complete))
    }

    /// Bounds of the time of the first impact, the pair and its kind, and whether that is proved.
    fn earliest(
        &self,
        py: Python<'_>,
        delta: f64,
        tolerance: f64,
        time: Option<f64>,
    ) -> PyResult<([f64; 2], Option<(&'static str, [u32; 4])>, bool)> {
        let separation = Separation::new(delta).map_err(refused)?;
        let guard = Guard::new(time, None)?;
        let earliest = guard.run(py, None, || {
            let bodies = self.lock();
            bodies
                .step
                .earliest_until(separation, tolerance, &mut || guard.stops(0))
        })?;
        let first = earliest
            .first
            .map(|(kind, MovingContact { a, b }, _)| (kind.name(), [a.body, b.body, a.index, b.index]));
        Ok((earliest.time, first, earliest.is_proved))
    }

    /// A time up to which the step is free of impacts.
    fn free_step(&self, py: Python<'_>, delta: f64, time: Option<f64>) -> PyResult<f64> {
        let separation = Separation::new(delta).map_err(refused)?;
        let guard = Guard::new(time, None)?;
        guard.run(py, None, || {
            self.lock()
                .step
                .free_step_until(separation, &mut || guard.stops(0))
        })
    }
}

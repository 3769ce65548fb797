//! Meshes that move during a step.

use std::sync::{Mutex, MutexGuard, PoisonError};

use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use satisfice_collision::Error;
use satisfice_collision::continuous::{self, Impact, MovingContact, Separation};
use satisfice_collision::scene::Completeness;

use super::guard::{Guard, pool_of};
use super::{Mesh, kind, points, rows};
use crate::refused;

/// Meshes at both ends of a step.
#[pyclass(frozen, module = "satisfice.collision")]
pub(crate) struct Step(Mutex<continuous::Step>);

/// Columns of impacts: bodies and features, bounds of the times, closest points, normals; how many are of each kind; whether these are all.
type Columns = (
    [Py<PyArray1<u32>>; 4],
    [Py<PyArray1<f64>>; 2],
    [Py<PyArray2<f64>>; 3],
    Vec<(&'static str, usize)>,
    bool,
);

impl Step {
    fn lock(&self) -> MutexGuard<'_, continuous::Step> {
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
            let mut step = self.lock();
            match self_collision {
                true => step.add_deforming(mesh.mesh(), &to),
                false => step.add_rigid(mesh.mesh(), &to),
            }
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
        py.detach(|| self.lock().set_motion(body, &ends[0], &ends[1]))
            .map_err(refused)
    }

    fn impacts(
        &self,
        py: Python<'_>,
        pairs: Option<&str>,
        delta: f64,
        tolerance: f64,
        time: Option<f64>,
        threads: usize,
    ) -> PyResult<Columns> {
        let asked = pairs.map(kind).transpose()?;
        let separation = Separation::new(delta).map_err(refused)?;
        let guard = Guard::new(time, None)?;
        // A step works on all threads of the pool that it finds itself in.
        let pool = pool_of(threads)?;
        let (found, counts, complete) = guard.run(py, Some(&pool), || {
            let step = self.lock();
            let kinds = asked.map_or_else(|| step.kinds(), |kind| vec![kind]);
            let (mut found, mut counts, mut complete) = (Vec::new(), Vec::new(), true);
            for kind in kinds {
                let before = found.len();
                let hits = step.hits_until(kind, separation, &mut || guard.stops(0))?;
                complete &= hits.undecided == 0;
                let until = guard.measuring_until();
                let stop = || guard.stops_at(until);
                for pair in hits.pairs {
                    let (impact, known) = match stop() {
                        true => (None, Completeness::Unknown),
                        false => step.impact_of_until(kind, &pair, separation, tolerance, &stop)?,
                    };
                    if known != Completeness::Proved {
                        complete = false;
                        break;
                    }
                    found.extend(impact.map(|impact| (pair, impact)));
                }
                counts.push((kind.name(), found.len() - before));
            }
            Ok((found, counts, complete))
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
        Ok((numbers, times, [a?, b?, normal?], counts, complete))
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
            self.lock()
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
            self.lock().free_step_until(separation, &mut || guard.stops(0))
        })
    }
}

//! Worlds of bodies that move from frame to frame.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use rayon::ThreadPool;
use satisfice_collision::distance::Proximity;
use satisfice_collision::scene::{self, BodyId, ChangeKind, Completeness, Contact};
use satisfice_collision::{Aabb, Error};

use super::guard::{Guard, pool};
use super::pairs::measure;
use super::{Mesh, Pose, kind, placement, points, rows, threshold};
use crate::refused;

/// A handle of a body in its world.
#[pyclass(frozen, eq, hash, module = "satisfice.collision")]
#[derive(PartialEq, Eq, Hash)]
pub(crate) struct Body {
    id: BodyId,
    /// The number of its world.
    world: u64,
}

#[pymethods]
impl Body {
    /// Its place in the world: 0, 1, 2, ... in the order of addition.
    #[getter]
    fn index(&self) -> usize {
        self.id.index()
    }

    fn __repr__(&self) -> String {
        format!("<satisfice.collision.Body {}>", self.id)
    }
}

/// Bodies, a kind of feature pair and a threshold.
#[pyclass(frozen, module = "satisfice.collision")]
pub(crate) struct World {
    /// No other world of the process has it.
    number: u64,
    inner: Mutex<scene::World>,
    pool: Option<ThreadPool>,
}

/// Columns of contacts: bodies, features, distances, closest points.
type Columns = (
    [Py<PyArray1<u32>>; 4],
    Py<PyArray1<f64>>,
    Py<PyArray2<f64>>,
    Py<PyArray2<f64>>,
);

/// Index of the body, the feature, the distance and the closest points of one pair.
type Nearest = (u32, u32, u32, u32, f64, [f64; 3], [f64; 3]);

impl World {
    /// The handle of a body of this world.
    fn body(&self, id: BodyId) -> Body {
        Body {
            id,
            world: self.number,
        }
    }

    /// The body of a handle; a body of the same index may be another one in the world that the handle is of.
    fn id(&self, body: &Bound<'_, Body>) -> PyResult<BodyId> {
        let body = body.get();
        if body.world != self.number {
            return Err(refused(format!(
                "body {} is of another world: give a handle that `add` of this world returned",
                body.id
            )));
        }
        Ok(body.id)
    }

    fn lock(&self) -> MutexGuard<'_, scene::World> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the world, without the interpreter's lock: another thread may hold the world and wait for that.
    fn change<T: Send>(
        &self,
        py: Python<'_>,
        change: impl FnOnce(&mut scene::World) -> Result<T, Error> + Send,
    ) -> PyResult<T> {
        py.detach(|| change(&mut self.lock())).map_err(refused)
    }

    /// Asks the world something that can take long.
    fn ask<T: Send>(
        &self,
        py: Python<'_>,
        time: Option<f64>,
        limit: Option<usize>,
        query: impl FnOnce(&mut scene::World, &Guard) -> Result<T, Error> + Send,
    ) -> PyResult<T> {
        let guard = Guard::new(time, limit)?;
        guard.run(py, self.pool.as_ref(), || query(&mut self.lock(), &guard))
    }
}

fn bodies(py: Python<'_>, contacts: &[Contact]) -> [Py<PyArray1<u32>>; 4] {
    let columns: [fn(&Contact) -> u32; 4] = [
        |contact| contact.body_a.index() as u32,
        |contact| contact.body_b.index() as u32,
        |contact| contact.a,
        |contact| contact.b,
    ];
    columns.map(|of| {
        let column: Vec<u32> = contacts.iter().map(of).collect();
        column.into_pyarray(py).unbind()
    })
}

fn columns(py: Python<'_>, found: Vec<(Contact, Proximity)>) -> PyResult<Columns> {
    let contacts: Vec<Contact> = found.iter().map(|(contact, _)| *contact).collect();
    let distances: Vec<f64> = found.iter().map(|(_, near)| near.distance).collect();
    let a = found.iter().map(|(_, near)| near.point_a).collect();
    let b = found.iter().map(|(_, near)| near.point_b).collect();
    Ok((
        bodies(py, &contacts),
        distances.into_pyarray(py).unbind(),
        rows(py, a)?,
        rows(py, b)?,
    ))
}

fn one((contact, near): (Contact, Proximity)) -> Nearest {
    (
        contact.body_a.index() as u32,
        contact.body_b.index() as u32,
        contact.a,
        contact.b,
        near.distance,
        near.point_a,
        near.point_b,
    )
}

#[pymethods]
impl World {
    #[new]
    fn new(pairs: &str, delta: f64, threads: usize) -> PyResult<Self> {
        let pool = pool(threads)?;
        let mut inner = scene::World::new(kind(pairs)?, threshold(delta)?);
        if pool.is_some() {
            inner = inner.parallel();
        }
        static WORLDS: AtomicU64 = AtomicU64::new(0);
        Ok(Self {
            number: WORLDS.fetch_add(1, Ordering::Relaxed),
            inner: Mutex::new(inner),
            pool,
        })
    }

    #[expect(clippy::too_many_arguments, reason = "the Python method has keywords")]
    fn add(
        &self,
        py: Python<'_>,
        mesh: &Bound<'_, Mesh>,
        motion: &str,
        pose: Option<Pose>,
        groups: (u32, u32),
        self_collision: bool,
        ring: usize,
    ) -> PyResult<Body> {
        let mesh = mesh.get().0.clone();
        let mut body = match motion {
            "fixed" => scene::Body::fixed(mesh),
            "rigid" => scene::Body::rigid(mesh),
            "deforming" => scene::Body::deforming(mesh),
            other => {
                return Err(refused(format!(
                    "motion = {other:?} is not allowed: one of fixed, rigid, deforming"
                )));
            }
        };
        body = body
            .at(placement(pose)?)
            .in_groups(groups.0, groups.1)
            .beyond_ring(ring);
        if !self_collision {
            body = body.without_self_collision();
        }
        let id = self.change(py, |world| world.add(body))?;
        Ok(self.body(id))
    }

    fn place(&self, py: Python<'_>, body: &Bound<'_, Body>, pose: Option<Pose>) -> PyResult<()> {
        let (body, placement) = (self.id(body)?, placement(pose)?);
        self.change(py, |world| world.place(body, placement))
    }

    fn translate(&self, py: Python<'_>, body: &Bound<'_, Body>, translation: [f64; 3]) -> PyResult<()> {
        let body = self.id(body)?;
        self.change(py, |world| world.translate(body, translation))
    }

    fn deform(
        &self,
        py: Python<'_>,
        body: &Bound<'_, Body>,
        vertices: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<()> {
        let (body, vertices) = (self.id(body)?, points(&vertices)?);
        self.change(py, |world| world.deform(body, &vertices))
    }

    fn remove(&self, py: Python<'_>, body: &Bound<'_, Body>) -> PyResult<()> {
        let body = self.id(body)?;
        self.change(py, |world| world.remove(body))
    }

    fn replace(&self, py: Python<'_>, body: &Bound<'_, Body>, mesh: &Bound<'_, Mesh>) -> PyResult<()> {
        let (body, mesh) = (self.id(body)?, mesh.get().0.clone());
        self.change(py, |world| world.replace(body, mesh))
    }

    fn set_groups(&self, py: Python<'_>, body: &Bound<'_, Body>, groups: u32, mask: u32) -> PyResult<()> {
        let body = self.id(body)?;
        self.change(py, |world| world.set_groups(body, groups, mask))
    }

    fn exclude(&self, py: Python<'_>, a: &Bound<'_, Body>, b: &Bound<'_, Body>) -> PyResult<()> {
        let (a, b) = (self.id(a)?, self.id(b)?);
        self.change(py, |world| world.exclude(a, b))
    }

    fn include(&self, py: Python<'_>, a: &Bound<'_, Body>, b: &Bound<'_, Body>) -> PyResult<()> {
        let (a, b) = (self.id(a)?, self.id(b)?);
        self.change(py, |world| world.include(a, b))
    }

    fn threshold(&self, py: Python<'_>) -> f64 {
        py.detach(|| self.lock().threshold().get())
    }

    fn set_threshold(&self, py: Python<'_>, delta: f64) -> PyResult<()> {
        let threshold = threshold(delta)?;
        self.change(py, |world| {
            world.set_threshold(threshold);
            Ok(())
        })
    }

    fn __len__(&self, py: Python<'_>) -> usize {
        py.detach(|| self.lock().len())
    }

    fn bodies(&self, py: Python<'_>) -> Vec<Body> {
        py.detach(|| self.lock().bodies().collect::<Vec<_>>())
            .into_iter()
            .map(|id| self.body(id))
            .collect()
    }

    /// Whether all contacts are known, how many pairs of bodies were looked at, and what was skipped.
    fn update(
        &self,
        py: Python<'_>,
        time: Option<f64>,
        limit: Option<usize>,
    ) -> PyResult<(bool, usize, Vec<(&'static str, u64)>)> {
        let update = self.ask(py, time, limit, |world, guard| {
            world.update_until(&|found| guard.stops(found))
        })?;
        let skips = update.skips.by_reason().to_vec();
        Ok((
            update.completeness == Completeness::Proved,
            update.recomputed,
            skips,
        ))
    }

    fn contacts(
        &self,
        py: Python<'_>,
        measured: bool,
    ) -> PyResult<([Py<PyArray1<u32>>; 4], Option<Py<PyArray1<f64>>>)> {
        let (contacts, distances) = self.ask(py, None, None, |world, guard| {
            let contacts = world.sorted_contacts();
            let distances = if measured {
                Some(measure(world, &contacts, false, guard)?.distances)
            } else {
                None
            };
            Ok((contacts, distances))
        })?;
        Ok((
            bodies(py, &contacts),
            distances.map(|column| column.into_pyarray(py).unbind()),
        ))
    }

    fn changes(&self, py: Python<'_>) -> PyResult<([Py<PyArray1<u32>>; 4], Vec<&'static str>)> {
        let changes: Vec<_> = self.change(py, |world| Ok(world.changes().collect()))?;
        let contacts: Vec<Contact> = changes
            .iter()
            .map(|change: &scene::Change| change.contact)
            .collect();
        let name = |change: &scene::Change| match change.kind {
            ChangeKind::Begun => "begun",
            ChangeKind::Persisting => "persisting",
            ChangeKind::Ended => "ended",
        };
        Ok((bodies(py, &contacts), changes.iter().map(name).collect()))
    }

    fn touching(&self, py: Python<'_>, time: Option<f64>) -> PyResult<(Vec<(Body, Body)>, bool)> {
        let (found, completeness) = self.ask(py, time, None, |world, guard| {
            world.witnesses_until(&|found| guard.stops(found))
        })?;
        let mut pairs: Vec<_> = found.iter().map(Contact::bodies).collect();
        pairs.sort_unstable();
        let pairs = pairs
            .into_iter()
            .map(|(a, b)| (self.body(a), self.body(b)))
            .collect();
        Ok((pairs, completeness == Completeness::Proved))
    }

    /// Some contact: bodies and features.
    fn first(&self, py: Python<'_>, time: Option<f64>) -> PyResult<(Option<(u32, u32, u32, u32)>, bool)> {
        let (contact, completeness) = self.ask(py, time, None, |world, guard| {
            world.first_until(&|found| guard.stops(found))
        })?;
        let contact = contact.map(|c| (c.body_a.index() as u32, c.body_b.index() as u32, c.a, c.b));
        Ok((contact, completeness == Completeness::Proved))
    }

    fn nearest(&self, py: Python<'_>, count: usize, time: Option<f64>) -> PyResult<(Columns, bool)> {
        let (found, completeness) = self.ask(py, time, None, |world, guard| {
            world.nearest_until(count, &|found| guard.stops(found))
        })?;
        Ok((columns(py, found)?, completeness == Completeness::Proved))
    }

    fn distance(
        &self,
        py: Python<'_>,
        a: &Bound<'_, Body>,
        b: &Bound<'_, Body>,
    ) -> PyResult<Option<Nearest>> {
        let (a, b) = (self.id(a)?, self.id(b)?);
        let found = self.ask(py, None, None, |world, _| world.distance(a, b))?;
        Ok(found.map(one))
    }

    /// The body, its feature, the distance and the closest point of it.
    fn nearest_to_point(
        &self,
        py: Python<'_>,
        point: [f64; 3],
    ) -> PyResult<Option<(Body, u32, f64, [f64; 3])>> {
        let found = self.ask(py, None, None, |world, _| world.nearest_to_point(point))?;
        Ok(found.map(|near| {
            (
                self.body(near.body),
                near.feature,
                near.proximity.distance,
                near.proximity.point_b,
            )
        }))
    }

    /// The body, its triangle, the part of the way and the point.
    fn cast_ray(
        &self,
        py: Python<'_>,
        from: [f64; 3],
        to: [f64; 3],
    ) -> PyResult<Option<(Body, u32, f64, [f64; 3])>> {
        let hit = self.ask(py, None, None, |world, _| world.cast_ray(from, to))?;
        Ok(hit.map(|hit| (self.body(hit.body), hit.triangle, hit.part, hit.point)))
    }

    fn bodies_in(&self, py: Python<'_>, min: [f64; 3], max: [f64; 3]) -> PyResult<Vec<Body>> {
        let found = self.ask(py, None, None, |world, _| world.bodies_in(&Aabb { min, max }))?;
        Ok(found.into_iter().map(|id| self.body(id)).collect())
    }
}

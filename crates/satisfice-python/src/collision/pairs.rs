//! All close pairs of two meshes, or of one with itself.

use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::prelude::*;
use satisfice_collision::scene::{Body, BodyId, Completeness, Contact, World};

use super::guard::{Guard, pool};
use super::{Mesh, Pose, kind, placement, rows, threshold};

/// So many distances are measured between two looks at the clock.
const LOOK_AFTER: usize = 256;

/// Columns of the pairs: features, distances, closest points where they are wanted, and whether these are all.
type Columns = (
    Py<PyArray1<u32>>,
    Py<PyArray1<u32>>,
    Py<PyArray1<f64>>,
    Option<(Py<PyArray2<f64>>, Py<PyArray2<f64>>)>,
    bool,
);

/// All pairs of features within the threshold; `satisfice.collision.close_pairs` has the documentation.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the Python function has keywords")]
pub(crate) fn close_pairs(
    py: Python<'_>,
    a: &Bound<'_, Mesh>,
    b: Option<&Bound<'_, Mesh>>,
    pairs: &str,
    delta: f64,
    poses: (Option<Pose>, Option<Pose>),
    ring: usize,
    witnesses: bool,
    time: Option<f64>,
    limit: Option<usize>,
    threads: usize,
) -> PyResult<Columns> {
    let kind = kind(pairs)?;
    let threshold = threshold(delta)?;
    let guard = Guard::new(time, limit)?;
    let pool = pool(threads)?;
    let mut world = World::new(kind, threshold);
    if pool.is_some() {
        world = world.parallel();
    }
    let mesh = a.get().0.clone();
    let first = match b {
        Some(_) => Body::rigid(mesh).at(placement(poses.0)?),
        None => Body::deforming(mesh).beyond_ring(ring),
    };
    world.add(first).map_err(crate::refused)?;
    if let Some(b) = b {
        let second = Body::rigid(b.get().0.clone()).at(placement(poses.1)?);
        world.add(second).map_err(crate::refused)?;
    }
    let found = guard.run(py, pool.as_ref(), || {
        let mut frame = world.frame_until(&|found| guard.stops_before_measuring(found))?;
        // The first feature is one of `a`.
        frame.contacts.retain(|contact| contact.body_a == BodyId::nth(0));
        let mut complete = frame.completeness == Completeness::Proved;
        if let Some(limit) = limit
            && frame.contacts.len() > limit
        {
            frame.contacts.truncate(limit);
            complete = false;
        }
        let measured = measure(&world, &frame.contacts, witnesses, &guard)?;
        complete &= measured.distances.len() == frame.contacts.len();
        frame.contacts.truncate(measured.distances.len());
        Ok((frame.contacts, measured, complete))
    })?;
    let (contacts, measured, complete) = found;
    let column = |of: fn(&Contact) -> u32| {
        let column: Vec<u32> = contacts.iter().map(of).collect();
        column.into_pyarray(py).unbind()
    };
    let points = if witnesses {
        Some((rows(py, measured.points_a)?, rows(py, measured.points_b)?))
    } else {
        None
    };
    Ok((
        column(|contact| contact.a),
        column(|contact| contact.b),
        measured.distances.into_pyarray(py).unbind(),
        points,
        complete,
    ))
}

/// Distances of contacts, and their closest points.
#[derive(Default)]
pub(super) struct Measured {
    pub(super) distances: Vec<f64>,
    pub(super) points_a: Vec<[f64; 3]>,
    pub(super) points_b: Vec<[f64; 3]>,
}

/// Measures contacts in the last frame: all of them, or the first ones if the guard stops it.
pub(super) fn measure(
    world: &World,
    contacts: &[Contact],
    witnesses: bool,
    guard: &Guard,
) -> Result<Measured, satisfice_collision::Error> {
    let mut measured = Measured {
        distances: Vec::with_capacity(contacts.len()),
        ..Measured::default()
    };
    let until = guard.measuring_until();
    for some in contacts.chunks(LOOK_AFTER) {
        if guard.stops_at(until) {
            break;
        }
        if !witnesses {
            world.contact_distances(some, &mut measured.distances)?;
            continue;
        }
        for &contact in some {
            let proximity = world.proximity(contact)?;
            measured.distances.push(proximity.distance);
            measured.points_a.push(proximity.point_a);
            measured.points_b.push(proximity.point_b);
        }
    }
    Ok(measured)
}

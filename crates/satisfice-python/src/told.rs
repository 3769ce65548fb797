//! Components of F that come with its values, kept until the engine asks for them.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// So many points are kept, the latest ones: more than are told before an engine learns of the first.
const MOST: usize = 4096;
/// By how much rounding may lift a component of a hit above 1.
const ROUNDING: f64 = 1e-6;

/// The bits of the coordinates of a point, and those of its components.
pub(crate) type SavedPoint = (Vec<u64>, Vec<u64>);

/// The components that were told lately, by their points. Clones share them.
#[derive(Clone)]
pub(crate) struct ToldComponents {
    count: usize,
    delta: f64,
    points: Arc<Mutex<Points>>,
}

#[derive(Default)]
struct Points {
    components: BTreeMap<Vec<u64>, Vec<f64>>,
    /// The oldest first.
    order: VecDeque<Vec<u64>>,
}

impl Points {
    fn insert(&mut self, key: Vec<u64>, components: Vec<f64>) {
        if self.components.insert(key.clone(), components).is_some() {
            return;
        }
        self.order.push_back(key);
        if self.order.len() > MOST
            && let Some(oldest) = self.order.pop_front()
        {
            self.components.remove(&oldest);
        }
    }
}

fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|x| x.to_bits()).collect()
}

impl ToldComponents {
    /// None yet, of a function with so many components.
    pub(crate) fn new(count: usize, delta: f64) -> Self {
        Self {
            count,
            delta,
            points: Arc::default(),
        }
    }

    fn lock(&self) -> MutexGuard<'_, Points> {
        self.points.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Number of components of a value; 0 where the function tells none.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Refuses components that cannot be those of a value.
    pub(crate) fn check(&self, point: &[f64], value: f64, components: &[f64]) -> PyResult<()> {
        let is_hit = value.is_finite() && value < self.delta;
        if is_hit && !components.iter().all(|x| x.abs() <= 1.0 + ROUNDING) {
            return Err(PyValueError::new_err(format!(
                "f is {value} at x = {point:?}, a hit, and its components are {components:?}: divide each by its limit, so that at every hit all are from -1 to 1"
            )));
        }
        Ok(())
    }

    /// Keeps the components of a value.
    pub(crate) fn keep(&self, point: &[f64], components: &[f64]) {
        self.lock().insert(bits(point), components.to_vec());
    }

    /// Writes the components at a point, NaN where they were not told.
    pub(crate) fn write(&self, point: &[f64], components: &mut [f64]) {
        match self.lock().components.get(&bits(point)) {
            Some(told) => components.copy_from_slice(told),
            None => components.fill(f64::NAN),
        }
    }

    /// Forgets all: the engine was told of every value.
    pub(crate) fn clear(&self) {
        if self.count > 0 {
            *self.lock() = Points::default();
        }
    }

    /// What a saved search has to hold of them.
    pub(crate) fn saved(&self) -> Vec<SavedPoint> {
        let points = self.lock();
        let known = points.order.iter().filter_map(|key| {
            let components = points.components.get(key)?;
            Some((key.clone(), bits(components)))
        });
        known.collect()
    }

    /// Takes what a saved search held.
    pub(crate) fn restore(&self, saved: Vec<SavedPoint>) {
        let mut points = self.lock();
        for (key, components) in saved {
            if components.len() == self.count {
                points.insert(key, components.into_iter().map(f64::from_bits).collect());
            }
        }
    }
}

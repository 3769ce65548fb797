//! Engines are compiled with this library, for both types of coordinates, and not again in every program that names one.
//!
//! Generic code calls functions of either type here: [`Real`] is sealed, so there are no others.

use std::any::{Any, TypeId};

use super::decorate::{FloodFill, Pruned};
use super::{ConfiguredEngine, Engine, EngineSpec, registry};
use crate::scalar::Real;

/// The two functions of [`EngineConfig`](super::EngineConfig) that build an engine, from the generic function `engine` of its settings.
macro_rules! both_scalars {
    () => {
        fn build_f64(&self) -> Box<dyn Engine<f64>> {
            self.engine()
        }

        fn build_f32(&self) -> Box<dyn Engine<f32>> {
            self.engine()
        }
    };
}

pub(super) use both_scalars;

/// Whether coordinates of type `S` are of type `f64`; else they are of type `f32`.
pub(super) fn is_f64<S: Real>() -> bool {
    TypeId::of::<S>() == TypeId::of::<f64>()
}

/// The value, whose type is `T` under another name.
///
/// # Panics
/// If it is not: call it where [`is_f64`] has told the types apart.
pub(super) fn same<A: 'static, T: 'static>(value: A) -> T {
    let value: Box<dyn Any> = Box::new(value);
    *value.downcast().expect("two names of one type")
}

/// The engine of a spec with the default of each parameter.
pub(super) fn default_of<S: Real>(spec: &EngineSpec) -> Option<ConfiguredEngine<S>> {
    if is_f64::<S>() {
        same(default_of_f64(spec))
    } else {
        same(default_of_f32(spec))
    }
}

fn default_of_f64(spec: &EngineSpec) -> Option<ConfiguredEngine<f64>> {
    registry::default_of(spec)
}

fn default_of_f32(spec: &EngineSpec) -> Option<ConfiguredEngine<f32>> {
    registry::default_of(spec)
}

/// The engine with a flood fill around it.
pub(super) fn flood_fill<S: Real>(engine: Box<dyn Engine<S>>) -> Box<dyn Engine<S>> {
    if is_f64::<S>() {
        same(flood_fill_f64(same(engine)))
    } else {
        same(flood_fill_f32(same(engine)))
    }
}

fn flood_fill_f64(engine: Box<dyn Engine<f64>>) -> Box<dyn Engine<f64>> {
    Box::new(FloodFill::around(engine))
}

fn flood_fill_f32(engine: Box<dyn Engine<f32>>) -> Box<dyn Engine<f32>> {
    Box::new(FloodFill::around(engine))
}

/// The engine, kept out of regions that bounds exclude.
pub(super) fn pruned<S: Real>(engine: Box<dyn Engine<S>>) -> Box<dyn Engine<S>> {
    if is_f64::<S>() {
        same(pruned_f64(same(engine)))
    } else {
        same(pruned_f32(same(engine)))
    }
}

fn pruned_f64(engine: Box<dyn Engine<f64>>) -> Box<dyn Engine<f64>> {
    Box::new(Pruned::around(engine))
}

fn pruned_f32(engine: Box<dyn Engine<f32>>) -> Box<dyn Engine<f32>> {
    Box::new(Pruned::around(engine))
}

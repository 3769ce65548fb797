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

/// The result of the function for the type `S`, of an input that has the type's own form: an engine, or nothing.
pub(super) fn for_scalar<
    S: Real,
    Input: 'static,
    I64: 'static,
    I32: 'static,
    O64: 'static,
    O32: 'static,
    Output: 'static,
>(
    input: Input,
    in_f64: impl FnOnce(I64) -> O64,
    in_f32: impl FnOnce(I32) -> O32,
) -> Output {
    if TypeId::of::<S>() == TypeId::of::<f64>() {
        same(in_f64(same(input)))
    } else {
        same(in_f32(same(input)))
    }
}

/// The value, whose type is `T` under another name.
fn same<A: 'static, T: 'static>(value: A) -> T {
    let value: Box<dyn Any> = Box::new(value);
    *value
        .downcast()
        .expect("`Real` is sealed: `f64` and `f32` are all there is")
}

/// The engine of a spec with the default of each parameter.
pub(super) fn default_of<S: Real>(spec: &EngineSpec) -> Option<ConfiguredEngine<S>> {
    for_scalar::<S, _, _, _, _, _, _>((), |()| default_of_f64(spec), |()| default_of_f32(spec))
}

fn default_of_f64(spec: &EngineSpec) -> Option<ConfiguredEngine<f64>> {
    registry::default_of(spec)
}

fn default_of_f32(spec: &EngineSpec) -> Option<ConfiguredEngine<f32>> {
    registry::default_of(spec)
}

/// The engine with a flood fill around it.
pub(super) fn flood_fill<S: Real>(engine: Box<dyn Engine<S>>) -> Box<dyn Engine<S>> {
    for_scalar::<S, _, _, _, _, _, _>(engine, flood_fill_f64, flood_fill_f32)
}

fn flood_fill_f64(engine: Box<dyn Engine<f64>>) -> Box<dyn Engine<f64>> {
    Box::new(FloodFill::around(engine))
}

fn flood_fill_f32(engine: Box<dyn Engine<f32>>) -> Box<dyn Engine<f32>> {
    Box::new(FloodFill::around(engine))
}

/// The engine, kept out of regions that bounds exclude.
pub(super) fn pruned<S: Real>(engine: Box<dyn Engine<S>>) -> Box<dyn Engine<S>> {
    for_scalar::<S, _, _, _, _, _, _>(engine, pruned_f64, pruned_f32)
}

fn pruned_f64(engine: Box<dyn Engine<f64>>) -> Box<dyn Engine<f64>> {
    Box::new(Pruned::around(engine))
}

fn pruned_f32(engine: Box<dyn Engine<f32>>) -> Box<dyn Engine<f32>> {
    Box::new(Pruned::around(engine))
}

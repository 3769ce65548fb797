//! A whole engine in its box: the model is told apart, because it may turn out to be of no use.

use crate::engine::Engine;
use crate::engine::model::ModelledSearch;
use crate::scalar::Real;

/// The model, or another engine.
pub(super) enum Member<S> {
    Model(Box<ModelledSearch<S>>),
    Other(Box<dyn Engine<S>>),
}

impl<S: Real> core::ops::Deref for Member<S> {
    type Target = dyn Engine<S>;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Model(model) => &**model,
            Self::Other(engine) => &**engine,
        }
    }
}

impl<S: Real> core::ops::DerefMut for Member<S> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Self::Model(model) => &mut **model,
            Self::Other(engine) => &mut **engine,
        }
    }
}
